"""The generated controller in C: equal to the one in Python, strict C99, and safe with any input."""

from __future__ import annotations

import re
import subprocess
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from krhpr.backend import c_sources
from krhpr.codegen.pipeline import Derived, derive, print_all
from krhpr.codegen.standalone import standalone_files
from krhpr.codegen.targets.c_control import ENOUGH_FRICTION as IN_C
from krhpr.codegen.targets.c_control import CControlTarget
from krhpr.control.compiled_controller import CompiledController
from krhpr.control.controller import ENOUGH_FRICTION, Controller, Wanted
from krhpr.control.parameters import PROTOTYPE as CONTROL
from krhpr.control.parameters import Scheme
from krhpr.control.plant import Plant
from krhpr.control.simulation import simulate
from krhpr.derivations.grasping.catalogue import grasping
from krhpr.errors import ControlError, KrhprError
from krhpr.study.grasp import PROTOTYPE, Setup
from tests.c.support import COMPILERS, CONFORMANCE, program, run
from tests.control.support import STRUTS, plant, pose, risen

pytestmark = pytest.mark.compiler

SOURCES = c_sources()
ROBOTS = ("planar_grasp_prr", "planar_grasp_rpr")
SETUPS = {"prr": PROTOTYPE, "rpr": STRUTS}
HOSTILE = Path(__file__).with_name("hostile.c")


def both(setup: Setup, scheme: Scheme) -> tuple[Controller, CompiledController]:
    one = plant() if setup is PROTOTYPE else Plant(setup, CONTROL)
    given = (one.robot, setup, CONTROL, scheme, one.branch)
    return Controller(*given), CompiledController(*given)


@pytest.mark.parametrize("name", SETUPS)
@pytest.mark.parametrize("scheme", Scheme)
def test_every_step_is_equal(name: str, scheme: Scheme) -> None:
    """Random measurements and references, one after the other, with saturation and clamps; to rounding."""
    setup, rng = SETUPS[name], np.random.default_rng(7)
    python, c = both(setup, scheme)
    pivot, angles = pose(setup)
    largest = 0.0
    for _ in range(60):
        wanted = Wanted(
            pivot + rng.normal(0, 3e-3, 2), angles + rng.normal(0, 0.05, 2), rng.uniform(-1.0, 12.0)
        )
        theta = python.robot.inverse(pivot + rng.normal(0, 3e-3, 2), angles + rng.normal(0, 0.05, 2))
        force = rng.normal(2.0, 3.0)
        expected, found = python.step(wanted, theta, force), c.step(wanted, theta, force)
        assert np.abs(expected - found).max() <= 1e-13 * max(np.abs(expected).max(), 1e-4)
        largest = max(largest, np.abs(found).max())
    assert largest == CONTROL.motor.torque_limit
    python.reset()
    c.reset()
    wanted = Wanted(pivot, angles, 2.0)
    theta = python.robot.inverse(pivot, angles)
    assert np.abs(python.step(wanted, theta, 1.9) - c.step(wanted, theta, 1.9)).max() < 1e-17


@pytest.mark.parametrize("scheme", Scheme)
def test_a_whole_run_is_equal(scheme: Scheme) -> None:
    """The closed loop with quantised encoders and noise."""
    one = plant()
    found = [simulate(one, controller, risen(PROTOTYPE, 2.0), 0.8) for controller in both(PROTOTYPE, scheme)]
    assert np.abs(found[0].torques - found[1].torques).max() < 1e-12 * np.abs(found[0].torques).max()
    assert np.abs(found[0].states - found[1].states).max() < 1e-12
    assert np.array_equal(found[0].measured_theta, found[1].measured_theta)


def test_no_answer_keeps_the_state() -> None:
    """Both refuse the same steps and go on as if these had not been."""
    python, c = both(PROTOTYPE, Scheme.COMBINED)
    pivot, angles = pose(PROTOTYPE)
    theta = python.robot.inverse(pivot, angles)
    good = Wanted(pivot, angles, 2.0)
    bad = [
        (Wanted(pivot + 1.0, angles, 2.0), theta, 2.0, "UNREACHABLE_LEG_1"),
        (good, theta + np.array([[0.0, 1.0], [0.0, 0.0]]), 2.0, "UNREACHABLE|NO_ASSEMBLY|SINGULAR"),
        (good, theta * np.nan, 2.0, "INVALID_INPUT"),
        (good, theta, np.nan, "INVALID_INPUT"),
        (Wanted(pivot, angles, np.inf), theta, 2.0, "INVALID_INPUT"),
    ]
    for scheme in (python, c):
        scheme.step(good, theta, 1.0)
    for wanted, joints, force, said in bad:
        with pytest.raises(KrhprError):
            python.step(wanted, joints, force)
        with pytest.raises(ControlError, match=said):
            c.step(wanted, joints, force)
    assert np.abs(python.step(good, theta, 1.5) - c.step(good, theta, 1.5)).max() < 1e-17


def test_a_geometry_that_is_none_is_told() -> None:
    one = plant()
    wrong = one.robot.with_geometry()
    wrong.geometry.fields["l_1"] = np.array([-1.0, 0.12])
    with pytest.raises(ControlError, match="does not take the geometry"):
        CompiledController(wrong, PROTOTYPE, CONTROL, Scheme.COMBINED, one.branch)


@pytest.mark.parametrize("change", ["period", "gains"])
def test_settings_that_are_none_have_no_answer(change: str) -> None:
    """Settings that the dataclasses refuse are refused in C as well."""
    _, c = both(PROTOTYPE, Scheme.COMBINED)
    pivot, angles = pose(PROTOTYPE)
    theta = plant().robot.inverse(pivot, angles)
    if change == "period":
        c._settings.period = 0.0
    else:
        c._settings.force_integral = float("nan")
    with pytest.raises(ControlError, match="INVALID_INPUT"):
        c.step(Wanted(pivot, angles, 2.0), theta, 2.0)


def test_the_same_friction_is_assumed() -> None:
    assert IN_C == ENOUGH_FRICTION


@pytest.mark.parametrize("robot", ROBOTS)
@pytest.mark.parametrize("compiler", COMPILERS)
def test_strict_c99_without_state(robot: str, compiler: str, tmp_path: Path) -> None:
    """No warning, nothing allocated, nothing exported or needed but functions of the robot."""
    target = tmp_path / "control.o"
    flags = (*CONFORMANCE, "-O2", "-fPIC", "-fno-stack-protector")
    run([program(compiler), *flags, "-c", SOURCES / f"krhpr_{robot}_control.c", "-o", target])
    lines = [line.split()[-2:] for line in run([program("nm"), target]).splitlines()]
    needed = {name for letter, name in lines if letter == "U"}
    assert all(name.startswith(f"krhpr_{robot}_") for name in needed - {"_GLOBAL_OFFSET_TABLE_"})
    exported = {(letter, name) for letter, name in lines if letter.isupper() and letter != "U"}
    step, statics = (f"krhpr_{robot}_control_{name}" for name in ("step", "statics"))
    assert exported == {("T", step), ("T", statics)}
    assert not re.search(r" [bdBDC] ", run([program("nm"), target]))


@pytest.mark.parametrize("robot", [ROBOTS[1], pytest.param(ROBOTS[0], marks=pytest.mark.full)])
def test_hostile_input(robot: str, tmp_path: Path) -> None:
    """Steps with NaN, infinities and huge numbers under sanitizers: a finite answer, or NaN and a status."""
    sources = [SOURCES / f"krhpr_{robot}{ending}.c" for ending in ("", "_control")]
    binary = tmp_path / "hostile"
    flags = ["-std=c11", "-O0", "-g", "-Wall", "-Wextra", "-Werror", "-fsanitize=address,undefined"]
    flags += ["-fno-sanitize-recover=all", f"-DROBOT(name)=krhpr_{robot}_##name"]
    mode = "NULL," if robot.endswith("prr") else ""
    flags += [f'-DHEADER="krhpr_{robot}_control.h"', f"-DMODE={mode}", f"-I{SOURCES}"]
    run([program("gcc"), *flags, HOSTILE, *sources, "-o", binary, "-lm"])
    done = subprocess.run([binary], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr[-2000:]
    answered, refused = map(int, done.stdout.split())
    assert answered > 500 and refused > 500


@pytest.fixture(scope="module")
def derived() -> Derived:
    return derive([grasping()[0]])


def test_baked_robots_take_no_geometry(derived: Derived) -> None:
    """With --bake the step is called without one."""
    (robot,) = derived.robots
    header, source = CControlTarget().robot(replace(robot, baked=True))
    assert "geometry" not in header.text + source.text
    assert re.search(r"_forward\(theta, c->assembly, c->side, pivot, angles\)", source.text)


def test_it_comes_along_where_a_robot_is_gathered(derived: Derived, tmp_path: Path) -> None:
    """`krhpr generate planar_grasp_prr --out arm`: a folder that stands alone has the controller in it."""
    files = standalone_files(derived, print_all(derived), "arm")
    for file in files:
        if file.path.startswith("c/krhpr_") and "batch" not in file.path:
            (tmp_path / file.path.removeprefix("c/")).write_text(file.text)
    found = {path.name for path in tmp_path.iterdir()}
    assert found == {f"krhpr_planar_grasp_prr{ending}" for ending in (".h", ".c", "_control.h", "_control.c")}
    source = tmp_path / "krhpr_planar_grasp_prr_control.c"
    run([program("cc"), *CONFORMANCE, "-fsyntax-only", source])
    assert 'include "krhpr_control.h"' not in (tmp_path / "krhpr_planar_grasp_prr_control.h").read_text()
    (cmake,) = (file.text for file in files if file.path == "c/CMakeLists.txt")
    assert "krhpr_controlled" in cmake
