"""Robots as robot files: what is written is read again, to the last bit."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import krhpr
from krhpr import design, workspace
from krhpr.errors import DesignError
from krhpr.limits import Cone, Interval, Limits
from krhpr.robot_files import RobotFileError
from krhpr.robot_files.writer import robot_file_text, write_robot_file


def test_robots_of_the_catalogue_are_read_as_they_were_written(tmp_path: Path) -> None:
    for name in krhpr.catalogue()[::7]:
        robot = krhpr.load(name)
        robot = robot.with_home(robot.home.p, robot.home.redundant, name="own_robot")
        again = krhpr.load(write_robot_file(tmp_path / f"{name}.yaml", robot, remarks=["Of a test."]))
        assert (again.name, again.identifier) == ("own_robot", name)
        assert again.geometry == robot.geometry and not again.limits
        assert again.home.p == robot.home.p and again.home.redundant == robot.home.redundant


def test_limits_and_legs_that_differ(tmp_path: Path) -> None:
    source = np.random.default_rng(0)
    limits = Limits(
        {"theta_1": (Interval(-1 / 3, 0.7), Interval(-0.3, 0.7), Interval(-0.3, 2 / 3))},
        {"crank_1": (Interval(-3.1, -1e-5),) * 3},
        (Cone(0.5), Cone(2.0, (1.0, 0.0, 0.0), (0.0, 1.0, 0.0)), Cone(1.0)),
        {"l_1": (0.01, 0.01, 0.01), "platform": (0.0075, 0.008, 0.009)},
        0.005,
        0.02,
        Interval(0.1, 3.0),
    )
    robot = krhpr.load("spatial_r_fivebar_a").with_limits(limits)
    robot = robot.with_geometry(l_1=source.uniform(0.04, 0.06, 3), alpha=source.uniform(2.0, 2.1, 3))
    robot = robot.with_home((0.01, -0.02, 1 / 3), (1.6, 1.7, 1.8), name="own_robot")
    again = krhpr.load(write_robot_file(tmp_path / "a.yaml", robot))
    assert again.limits == limits and again.geometry == robot.geometry
    assert again.home.p == robot.home.p and again.home.redundant == robot.home.redundant
    assert robot_file_text(again) == robot_file_text(robot)


def test_a_file_of_an_example_is_written_as_it_was_read(tmp_path: Path) -> None:
    robot = krhpr.load("examples/my_robot.yaml")
    again = krhpr.load(write_robot_file(tmp_path / "a.yaml", robot))
    assert (again.geometry, again.limits, again.home[::2]) == (robot.geometry, robot.limits, robot.home[::2])


@pytest.mark.parametrize("name", ["spatial_rrr_a", "spatial_r_fivebar_a", "spatial_prr_b", "spatial_rrr_c"])
def test_limits_of_the_section_in_a_file_stop_the_same_poses(name: str, tmp_path: Path) -> None:
    """Node by node: what no file can say is given beside it."""
    robot = krhpr.load(name)
    limits = workspace.section_1_7(robot)
    own, rest = design.held(robot.with_home(robot.home.p, robot.home.redundant, name="own"), limits)
    again = krhpr.load(write_robot_file(tmp_path / "own.yaml", own))
    source = np.random.default_rng(1)
    p = source.uniform((-0.4, -0.4, -0.1), (0.4, 0.4, 0.7), (4000, 3))
    Q = workspace.tilt_torsion(*source.uniform(-1, 1, (3, 4000)) * [[0.5], [3.0], [0.8]])
    redundant = np.broadcast_to(robot.home.redundant, p.shape)
    before = workspace.Examiner(robot, limits).examine(p, Q, redundant)
    after = workspace.Examiner(again, rest).examine(p, Q, redundant)
    assert np.array_equal(before.stops, after.stops) and np.array_equal(before.which, after.which)
    assert len(np.unique(before.stops)) > 3


def test_two_limits_of_spherical_joints() -> None:
    with pytest.raises(DesignError, match="its file limits spherical joints, and `cone` does so too"):
        design.held(krhpr.load("examples/my_robot.yaml"), workspace.WorkspaceLimits(cone=1.0))


def test_sizes_that_no_file_may_have(tmp_path: Path) -> None:
    """They are written, and refused when they are read: the search never gets there."""
    robot = krhpr.load("spatial_rrr_a").with_geometry(l_r=0.16)
    path = write_robot_file(tmp_path / "long.yaml", robot.with_home(robot.home.p, 1.7, name="long_links"))
    with pytest.raises(RobotFileError, match=r"\(1.35\)|collinear"):
        krhpr.load(path)
