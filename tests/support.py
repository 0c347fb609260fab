"""What tests of several folders share."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

if TYPE_CHECKING:
    from krhpr.codegen.pipeline import Derived
    from krhpr.codegen.robot_code import RobotCode
    from krhpr.codegen.targets.base import File

ROOT = Path(__file__).resolve().parent.parent
FOLDERS = {"derivations": "derivations", "templates": "templates", "generated": "generated"}


def cover(robots: Sequence[str]) -> tuple[str, ...]:
    """One robot of each sub-leg, the arrangements in turns: every part is among theirs."""
    by_subleg: dict[str, list[str]] = {}
    for robot in robots:
        by_subleg.setdefault(robot.rpartition("_")[0], []).append(robot)
    return tuple(found[place % len(found)] for place, found in enumerate(by_subleg.values()))


def with_cover(robots: Sequence[str], some: Sequence[str] = ()) -> list[Any]:
    """Parameters of a test: every robot, but in small samples `some` (one of each sub-leg unless given)."""
    some = some or cover(robots)
    return [pytest.param(robot, marks=() if robot in some else pytest.mark.full) for robot in robots]


THOROUGH = (
    "spatial_rrr_a",
    "spatial_r_fivebar_a",
    "spatial_rrrr_b",
    "spatial_cpr3_c",
    "planar_rr_a",
    "planar_rrr_c",
    "planar_prr2_b",
)
"""Robots that large samples are drawn of: serial and closed, redundant, without a closed form, all
arrangements.
"""

SOME = ("spatial_rrr_a", "spatial_r_fivebar_a", "spatial_cpr3_c", "planar_rrr_c")
"""Those of them that small samples compile."""


def large(robot: str, full: bool) -> bool:
    """Whether this robot is tested on large samples; the others always have small ones."""
    return full and robot in THOROUGH


COMPILERS = {"cc": ".c", "gcc": ".c", "clang": ".c", "c++": ".cpp", "g++": ".cpp", "clang++": ".cpp"}
"""Compilers that tests call by name, and the ending of what they compile."""


@cache
def lacking(program: str) -> str:
    """Why a program cannot be used here; empty where it can.  A compiler must compile."""
    found = shutil.which(program)
    if found is None:
        return f"{program} is not installed"
    if program not in COMPILERS:
        return ""
    with tempfile.TemporaryDirectory() as folder:
        source = Path(folder) / f"probe{COMPILERS[program]}"
        source.write_text("int main(void) { return 0; }\n")
        command = [found, str(source), "-o", f"{folder}/probe"]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
    said = (done.stderr or done.stdout).strip().splitlines() or ["nothing"]
    return "" if done.returncode == 0 else f"{program} does not compile; it said: {said[0]}"


def need(*programs: str) -> None:
    """Skip the test, and say why, where one of the programs cannot be used."""
    for program in programs:
        if reason := lacking(program):
            pytest.skip(reason)


@cache
def derived_robots() -> Derived:
    """Every robot of the catalogue, derived once in this process."""
    from krhpr.codegen.pipeline import derive

    return derive()


def catalogued() -> list[RobotCode]:
    """Those that robot files choose from: the catalogue's, with three legs."""
    return [robot for robot in derived_robots().robots if robot.legs == 3]


@cache
def printed_files() -> tuple[File, ...]:
    """Every file that they generate."""
    from krhpr.codegen.pipeline import print_all

    return tuple(print_all(derived_robots()))


def run_python(*arguments: str, **options: object) -> subprocess.CompletedProcess[str]:
    """Run a Python of its own that finds the same packages; `env` adds to the environment."""
    added: dict[str, str] = options.pop("env", {})  # type: ignore[assignment]
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(filter(None, sys.path)), **added}
    run = subprocess.run(
        [sys.executable, *arguments],
        env=environment,
        capture_output=True,
        text=True,
        check=False,
        **options,  # type: ignore[call-overload]
    )
    return run  # type: ignore[no-any-return]


def unpack_package(site: Path) -> Path:
    """A copy of the package as a wheel has it, to be changed; returns the folder for PYTHONPATH."""
    ignore = shutil.ignore_patterns("__pycache__")
    shutil.copytree(ROOT / "krhpr", site / "krhpr", ignore=ignore)
    for name, folder in FOLDERS.items():
        shutil.copytree(ROOT / folder, site / "krhpr" / name, ignore=ignore)
    return site


def contents(folder: Path) -> dict[str, bytes]:
    """Every file of a folder and what is in it; caches apart."""
    return {
        path.relative_to(folder).as_posix(): path.read_bytes()
        for path in sorted(folder.rglob("*"))
        if path.is_file() and "__pycache__" not in path.parts
    }
