"""Boxes with one solution of the forward kinematics: what is proven holds, what does not hold is not."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import krhpr
from krhpr.certificate import certify_unique
from krhpr.certificate.unique import _area, _diagonal, _Leg
from krhpr.validation.sampling import rotations

ROBOTS = ["spatial_rrr_a", "planar_rr_a"]
SHARE = st.floats(-0.15, 0.15)


def unequal(identifier: str, changes: Any) -> krhpr.Robot:
    robot = krhpr.load(identifier, backend="numpy")
    sizes, lengths, turns = np.reshape(changes, (3, 3))
    return robot.with_geometry(
        R_p=robot.geometry.R_p * (1 + sizes),
        l_r=robot.geometry.l_r * (1 + lengths),
        platform_azimuth=robot.geometry.platform_azimuth + turns,
    )


def ends(robot: krhpr.Robot, redundant: Any) -> Any:
    """S_i in the platform frame."""
    if robot.planar:
        return robot.end_points((0.0, 0.0), 0.0, redundant)
    return robot.end_points((0.0, 0.0, 0.0), np.eye(3), redundant)[..., :2]


@pytest.mark.parametrize("identifier", ROBOTS)
def test_the_factors_are_the_derivatives(identifier: str) -> None:
    robot = unequal(identifier, np.linspace(-0.1, 0.1, 9))
    legs = [_Leg(robot, leg) for leg in range(3)]
    rng = np.random.default_rng(1)
    step = 1e-6
    for beta in rng.uniform(-3, 3, (20, 3)):
        for i in range(3):
            move = step * np.eye(3)[i]
            near = [ends(robot, beta + sign * move) for sign in (1, -1)]
            squares = [np.sum((s[i] - s[(i + 1) % 3]) ** 2) for s in near]
            # half of it: of |S_i - S_i+1|^2 / 2
            slope = (squares[0] - squares[1]) / (4 * step)
            assert float(_diagonal(legs, i).near(beta)) == pytest.approx(slope, abs=1e-9)
        s = ends(robot, beta)
        a, b = s[1] - s[0], s[2] - s[0]
        assert float(_area(legs).near(beta)) == pytest.approx(a[0] * b[1] - a[1] * b[0], abs=1e-14)


@pytest.mark.parametrize("identifier", ROBOTS)
@settings(max_examples=15)
@given(changes=st.lists(SHARE, min_size=9, max_size=9), width=st.floats(20, 58))
def test_what_is_proven_holds(identifier: str, changes: list[float], width: float) -> None:
    """In a box that is free every pose is the only solution with its angles in it."""
    robot = unequal(identifier, changes)
    low, high = np.radians(90 - width), np.radians(90 + width)
    if not certify_unique(robot, low, high).free:
        return
    rng = np.random.default_rng(2)
    redundant = rng.uniform(low, high, (200, 3))
    p = np.array(robot.home.p) + 0.02 * rng.normal(size=(200, len(robot.home.p)))
    Q = 0.2 * rng.normal(size=200) if robot.planar else rotations(0.2 * rng.normal(size=(200, 3)))
    every = robot.forward_all(robot.end_points(p, Q, redundant))
    inside = ((every.redundant >= low) & (every.redundant <= high)).all(axis=-1).sum(axis=-1)
    assert (inside <= 1).all()


@pytest.mark.parametrize("identifier", ROBOTS)
def test_boxes_that_are_proven_and_boxes_that_are_not(identifier: str) -> None:
    robot = krhpr.load(identifier, backend="numpy")
    assert certify_unique(robot, np.radians(31), np.radians(149)).free
    slightly = unequal(identifier, [0.05, 0, -0.03, 0.2, 0, -0.1, 0.05, 0, 0])
    assert certify_unique(slightly, np.radians(45), np.radians(135)).free
    wide = certify_unique(robot, np.radians(10), np.radians(170))
    assert not wide.free and wide.point is not None
    # there two solutions are found indeed
    rng = np.random.default_rng(3)
    redundant = rng.uniform(np.radians(10), np.radians(170), (3000, 3))
    pose = (robot.home.p, robot.home.orientation)
    every = robot.forward_all(robot.end_points(*pose, redundant))
    inside = ((every.redundant >= np.radians(10)) & (every.redundant <= np.radians(170))).all(axis=-1)
    assert inside.sum(axis=-1).max() > 1


def test_slides_are_told_by_their_side() -> None:
    robot = krhpr.load("spatial_rrr_c", backend="numpy")
    assert certify_unique(robot, 0.01, 0.1).free
    assert not certify_unique(robot, -0.1, 0.1).free
