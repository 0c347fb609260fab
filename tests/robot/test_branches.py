"""Working modes and assembly modes, by name, by sign and by continuity."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from krhpr import Robot, UnknownBranch
from tests.robot.support import assert_same, poses


def test_every_mode_by_label_labels_or_signs(robot: Robot) -> None:
    pose = poses(robot, 2)
    everything = robot.inverse_all(*pose)
    assert everything.shape[-2] == len(robot.modes)
    for n, mode in enumerate(robot.modes):
        theta = robot.inverse(*pose, mode=mode)
        assert_same(theta, everything[..., n, :], 1e-13)
        assert_same(robot.inverse(*pose, mode=[mode] * 3), theta)
        assert_same(robot.inverse(*pose, mode=robot.mode_signs(mode)), theta)
        assert_same(robot.inverse(*pose, mode=robot.mode_signs(mode).astype(int).tolist()), theta)
    assert_same(robot.inverse(*pose), robot.inverse(*pose, mode=robot.default_mode))


def test_each_leg_and_each_element_may_have_its_own_mode(robot: Robot) -> None:
    pose = poses(robot)
    everything = robot.inverse_all(*pose)
    choice = [0, len(robot.modes) - 1, 1]
    labels = tuple(robot.modes[n] for n in choice)
    assert_same(robot.inverse(*pose, mode=labels), everything[range(3), choice], 1e-13)
    signs = np.stack([robot.mode_signs(mode) for mode in robot.modes])
    assert_same(np.moveaxis(robot.inverse(*pose, mode=signs), 0, 1), everything, 1e-13)


@pytest.mark.parametrize("mode", ["upwards", ["elbow+", "elbow+"], ["elbow+"] * 2 + ["down"], "", []])
def test_an_unknown_mode_names_those_there_are(planar: Robot, mode: Any) -> None:
    with pytest.raises(ValueError, match=r"give one of elbow\+, elbow-, or one for each|has shape"):
        planar.inverse(*poses(planar), mode=mode)


@pytest.mark.parametrize("wrong", [0, 0.5, np.nan])
def test_signs_are_plus_or_minus_one(planar: Robot, wrong: float) -> None:
    with pytest.raises(UnknownBranch, match=r"the signs of a working mode are \+1 or -1, got"):
        planar.inverse(*poses(planar), mode=[[1], [wrong], [-1]])


def test_assembly_modes(fivebar: Robot, planar: Robot) -> None:
    theta = fivebar.inverse(*poses(fivebar))
    found = {label: fivebar.subleg_forward(theta, label) for label in fivebar.assemblies}
    s = fivebar.end_points(*poses(fivebar))
    assert any(np.allclose(answer, s, rtol=0, atol=1e-12) for answer in found.values())
    left, right = fivebar.assemblies
    mixed = fivebar.subleg_forward(theta, [left, right, left])
    assert_same(mixed, np.stack([found[left][0], found[right][1], found[left][2]]), 1e-13)
    with pytest.raises(UnknownBranch, match="'up' is not an assembly mode; give one of left, right"):
        fivebar.subleg_forward(theta, "up")
    with pytest.raises(UnknownBranch, match="no assembly modes of its sub-legs are told apart by signs"):
        planar.subleg_forward(planar.inverse(*poses(planar)), "left")


def test_near_chooses_the_mode_and_continues_beyond_a_half_turn(robot: Robot) -> None:
    pose = poses(robot)
    angles = np.array(robot._module.ANGULAR)
    for mode in robot.modes:
        theta = robot.inverse(*pose, mode=mode)
        for turns in (-2, 0, 1):
            shifted = theta + 2 * np.pi * turns * angles
            near = shifted + 0.01
            assert_same(robot.inverse(*pose, near=near), shifted, 1e-13)
    with pytest.raises(UnknownBranch, match="either a mode or joints to stay near, not both"):
        robot.inverse(*pose, near=theta, mode=robot.default_mode)


def test_a_path_followed_near_its_last_joints_is_continuous(robot: Robot) -> None:
    start, end = poses(robot, seed=1), poses(robot, seed=2)
    theta = robot.inverse(*start)
    for share in np.linspace(0, 1, 60):
        p, redundant = (a + share * (b - a) for a, b in ((start.p, end.p), (start.redundant, end.redundant)))
        following = robot.inverse(p, start.orientation, redundant, near=theta)
        assert np.abs(following - theta).max() < 0.2
        theta = following
