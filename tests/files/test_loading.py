"""`krhpr.load("arm.yaml")`: the catalogue's kernels with the file's name, geometry and limits."""

from __future__ import annotations

import pickle
from pathlib import Path

import numpy as np
import pytest

import krhpr
from krhpr import Limits, UnknownRobot
from tests.files.support import EXAMPLE, FIVEBAR, Write
from tests.support import run_python

POSE = (np.array([0.01, -0.02, 0.28]), np.eye(3), np.radians([97.0, 90.0, 80.0]))


@pytest.mark.parametrize("backend", ["numpy", "compiled"])
def test_a_loaded_robot_computes_with_the_files_sizes(backend: str) -> None:
    robot = krhpr.load(EXAMPLE, backend=backend)
    same = krhpr.load("spatial_r_fivebar_a", backend=backend).with_geometry(
        R_b=0.2, l_1=0.04, l_2=0.12, l_3=0.24, l_4=0.24, l_5=0.36, l_6=0.24, R_p=0.1, l_r=0.04
    )
    assert robot.geometry == same.geometry
    theta = robot.inverse(*POSE)
    assert np.isfinite(theta).all() and np.array_equal(theta, same.inverse(*POSE))


def test_it_has_the_files_name_and_limits_and_the_catalogues_identifier() -> None:
    robot = krhpr.load(str(EXAMPLE))
    assert (robot.name, robot.identifier) == ("my_robot", "spatial_r_fivebar_a")
    assert robot.limits.clearance == 0.005
    assert "my_robot, spatial_r_fivebar_a" in repr(robot)


def test_the_examples_home_keeps_its_limits() -> None:
    robot = krhpr.load(EXAMPLE, backend="numpy")
    p, Q, redundant = np.array([0.0, 0.0, 0.28]), np.eye(3), np.radians([97.0] * 3)
    theta, s = robot.inverse(p, Q, redundant), robot.end_points(p, Q, redundant)
    passive = robot.passive_joints(p, Q, s, theta)
    names = robot.signature("passive_joints").outputs[0].labels
    values = {"platform_joint": passive.platform_joint, **dict(zip(names, passive.passive.T, strict=True))}
    values |= dict(zip(robot.signature("inverse").outputs[0].labels, theta.T, strict=True))
    for table in (robot.limits.actuators, robot.limits.passive):
        for name, legs in table.items():
            assert all(leg.low < value < leg.high for leg, value in zip(legs, values[name], strict=True)), (
                name
            )
    assert robot.limits.spherical is not None
    for cone, rotation in zip(robot.limits.spherical, passive.spherical, strict=True):
        assert np.arccos(np.dot(cone.socket, rotation @ np.array(cone.stud))) < cone.tilt


def test_robots_of_the_catalogue_have_their_identifier_for_a_name_and_no_limits() -> None:
    for identifier in krhpr.catalogue():
        robot = krhpr.load(identifier, backend="numpy")
        assert robot.name == identifier and robot.limits == Limits()


def test_changes_and_pickles_keep_name_and_limits() -> None:
    robot = krhpr.load(EXAMPLE, backend="numpy")
    for other in (robot.with_geometry(l_2=0.13), pickle.loads(pickle.dumps(robot))):
        assert (other.name, other.limits) == (robot.name, robot.limits)


def test_casadi_has_the_files_sizes() -> None:
    robot = krhpr.load(EXAMPLE, backend="numpy")
    p, Q, redundant = POSE
    theta = np.array(robot.casadi.inverse(p, Q, redundant, robot.mode_signs()))
    assert np.allclose(theta, robot.inverse(p, Q, redundant), rtol=0, atol=1e-13)


def test_a_file_that_is_not_there() -> None:
    with pytest.raises(FileNotFoundError, match=r"no_such\.yaml"):
        krhpr.load("no_such.yaml")
    with pytest.raises(UnknownRobot):
        krhpr.load("no_such")
    with pytest.raises(ValueError, match="no backend is called"):
        krhpr.load(EXAMPLE, backend="fast")


def test_without_pyyaml_the_error_says_what_to_install(write: Write) -> None:
    code = (
        "import sys; sys.modules['yaml'] = None\nimport krhpr\n"
        "krhpr.load('planar_rr_a')\n"
        "try:\n    krhpr.load(sys.argv[1])\nexcept ModuleNotFoundError as error:\n    print(error)\n"
    )
    run = run_python("-c", code, str(write(FIVEBAR)))
    assert run.stdout == "robot files need PyYAML: pip install 'krhpr[files]'\n", run.stderr
    code = "import sys; sys.modules['yaml'] = None\nfrom krhpr.cli import main\nsys.exit(main(sys.argv[1:]))"
    run = run_python("-c", code, "info", str(write(FIVEBAR)))
    assert (run.returncode, run.stderr) == (1, "krhpr: yaml is not installed: pip install 'krhpr[files]'\n")


def test_loading_needs_numpy_and_pyyaml_alone(write: Write, tmp_path: Path) -> None:
    code = (
        "import sys\nfor name in ('sympy', 'jinja2', 'rich', 'casadi', 'mpmath'): sys.modules[name] = None\n"
        "import krhpr; print(krhpr.load(sys.argv[1], backend='numpy').name)"
    )
    run = run_python("-c", code, str(write(FIVEBAR)), cwd=tmp_path)
    assert run.stdout == "arm\n", run.stderr
