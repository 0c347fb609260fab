"""Robot files on the command line: `info`, `eval`, `generate`."""

from __future__ import annotations

import json
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest

import krhpr
from tests.cli.support import Cli
from tests.files.support import EXAMPLE, FIVEBAR, PLANAR, Write
from tests.support import contents, run_python

INPUT = json.dumps({"p": [0.0, 0.0, 0.28], "Q": np.eye(3).tolist(), "redundant": [1.7, 1.6, 1.5]})

USE = """
import sys

for name in ("krhpr", "sympy", "jinja2", "rich", "yaml", "casadi"):
    sys.modules[name] = None
sys.path.insert(0, sys.argv[1])
from my_robot import my_robot, spatial_rrr_c

print(my_robot.inverse([0.0, 0.0, 0.28], [[1, 0, 0], [0, 1, 0], [0, 0, 1]], [1.7, 1.6, 1.5]).tolist())
print(my_robot.IDENTIFIER, my_robot.LIMITS.clearance, spatial_rrr_c.IDENTIFIER)
"""


@pytest.fixture
def expected() -> np.ndarray:
    robot = krhpr.load(EXAMPLE, backend="numpy")
    found: np.ndarray = robot.inverse([0.0, 0.0, 0.28], np.eye(3), [1.7, 1.6, 1.5])
    return found


def test_eval_takes_a_file(cli: Cli, expected: np.ndarray) -> None:
    result = cli("eval", EXAMPLE, "inverse", stdin=INPUT)
    assert result.code == 0, result.err
    assert np.array_equal(json.loads(result.out)["theta"], expected)
    changed = cli("eval", EXAMPLE, "inverse", "--geometry", "l_2=0.13", stdin=INPUT)
    assert changed.code == 0 and json.loads(changed.out) != json.loads(result.out)


def test_info_shows_the_files_name_sizes_and_limits(cli: Cli) -> None:
    text = cli("info", EXAMPLE).out
    assert text.startswith("my_robot: spatial_r_fivebar_a  3-[R(RR-RRR)SR]\n")
    for words in (
        "R_b = 0.2 m",
        "theta_1         -1.309 to 1.309",
        "radius of l_2   0.0075",
        "clearance       0.005",
    ):
        assert words in text
    facts = json.loads(cli("info", EXAMPLE, "--json").out)
    assert (facts["name"], facts["robot"]) == ("my_robot", "spatial_r_fivebar_a")
    assert facts["limits"]["link_radii"]["l_2"] == [0.0075] * 3
    assert (
        "krhpr_my_robot_inverse and ..._batch in krhpr_my_robot.h"
        in cli("info", EXAMPLE, "--function", "inverse").out
    )
    assert json.loads(cli("info", "planar_rr_a", "--json").out)["limits"] == {}


@pytest.mark.parametrize("command", [("info",), ("eval",), ("generate", "--out", "folder")])
def test_a_mistake_is_wrong_use_and_nothing_is_written(
    command: tuple[str, ...],
    cli: Cli,
    write: Write,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.chdir(tmp_path)
    path = write(FIVEBAR + "geometry:\n  l_2: -1\n")
    arguments = [command[0], path, *(["inverse"] if command == ("eval",) else command[1:])]
    result = cli(*arguments, stdin=INPUT)
    assert (result.code, result.out) == (2, "")
    assert result.err == f"krhpr: {path}, line 5: geometry.l_2: found -1, expected a length greater than 0\n"
    assert not (tmp_path / "folder").exists()


def test_a_suspicion_is_a_short_warning(cli: Cli, write: Write) -> None:
    result = cli("info", write(PLANAR + "geometry: {azimuth: 210}\n"))
    assert result.code == 0
    assert result.err.startswith("krhpr: warning: ") and "with degrees in mind write `210 deg`" in result.err


def test_files_that_are_not_there(cli: Cli) -> None:
    assert cli("info", "nothing.yaml").err == "krhpr: nothing.yaml: No such file or directory\n"
    assert "no robot is called 'my_robot'" in cli("info", "my_robot").err


@pytest.mark.parametrize("options", [(), pytest.param(("--bake",), marks=pytest.mark.full)])
def test_generate_writes_a_folder_that_works_alone(
    options: tuple[str, ...],
    cli: Cli,
    tmp_path: Path,
    expected: np.ndarray,
) -> None:
    folder = tmp_path / "my_robot"
    result = cli("generate", EXAMPLE, "spatial_rrr_c", "--out", folder, *options)
    assert result.code == 0, result.err
    assert result.out.splitlines()[2].startswith("my_robot ") and "22 files in" not in result.err
    printed = run_python("-c", USE, str(tmp_path)).stdout.splitlines()
    assert np.allclose(json.loads(printed[0]), expected, rtol=0, atol=1e-14)
    assert printed[1] == "my_robot 0.005 spatial_rrr_c"
    assert {"c/krhpr_my_robot.c", "casadi/my_robot.py", "python/limits.py"} <= contents(folder).keys()
    assert not [path for path in contents(folder) if "schema" in path or "r_fivebar_a" in path]
    assert cli("generate", EXAMPLE, "spatial_rrr_c", "--out", folder, "--check", *options).code == 0
    assert (
        cli("generate", EXAMPLE, "spatial_rrr_c", "--out", folder, "--check", *({"--bake"} - {*options})).code
        == 3
    )


@pytest.mark.compiler
@pytest.mark.parametrize("options", [(), pytest.param(("--bake",), marks=pytest.mark.full)])
def test_generate_writes_c_that_cmake_builds(options: tuple[str, ...], cli: Cli, tmp_path: Path) -> None:
    if shutil.which("cmake") is None:
        pytest.skip("needs CMake")
    folder, build = tmp_path / "my_robot", tmp_path / "build"
    assert cli("generate", EXAMPLE, "--out", folder, *options).code == 0
    options_of_build = ("-DKRHPR_CASADI=ON", "-DCMAKE_BUILD_TYPE=Debug")  # that is quicker
    for command in (("-S", folder / "c", "-B", build, *options_of_build), ("--build", build)):
        subprocess.run(["cmake", *map(str, command)], check=True, capture_output=True)
    assert list(build.rglob("*krhpr_my_robot.a")) and list(build.rglob("krhpr_my_robot_casadi.*"))


def test_the_catalogue_can_be_baked_too(cli: Cli, tmp_path: Path) -> None:
    assert cli("generate", "planar_rr_a", "--bake", "--out", tmp_path / "arm").code == 0
    assert b"(const krhpr_planar_rr_a_geometry" not in (tmp_path / "arm/c/krhpr_planar_rr_a.h").read_bytes()


def test_what_generate_refuses(cli: Cli, write: Write, tmp_path: Path) -> None:
    path = write(FIVEBAR)
    twin = tmp_path / "twin" / "arm.yaml"
    twin.parent.mkdir()
    twin.write_text(PLANAR)
    result = cli("generate", path, twin, "--out", tmp_path / "both")
    assert (result.code, result.err) == (
        2,
        f"krhpr: {path} and {twin} are both called arm; rename one of them\n",
    )
    result = cli("generate", "planar_rr_a", "--bake")
    assert result.code == 2 and "add --out DIR" in result.err
    result = cli("generate", path)
    assert result.code == 2 and "add --out DIR" in result.err
    result = cli("generate", "planar_r_a", path, "--out", tmp_path / "both")
    assert result.code == 2 and "did you mean planar_rr_a" in result.err
    assert not (tmp_path / "both").exists()


def test_two_files_of_one_robot_share_its_kernels(cli: Cli, write: Write, tmp_path: Path) -> None:
    other = tmp_path / "other.yaml"
    other.write_text(FIVEBAR + "geometry: {l_2: 0.16}\n")
    folder = tmp_path / "both"
    assert cli("generate", write(FIVEBAR), other, "spatial_r_fivebar_a", "--out", folder).code == 0
    found = contents(folder)
    assert {"python/arm.py", "python/other.py", "python/spatial_r_fivebar_a.py"} <= found.keys()
    assert len([name for name in found if "subleg" in name]) == 2  # NumPy's and CasADi's
    assert b'"l_2": (0.16, 0.16, 0.16)' in found["python/other.py"]
