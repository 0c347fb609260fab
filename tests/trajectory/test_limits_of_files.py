"""Limits that a robot's file gives: passive joints, redundant coordinates, links as cylinders."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import krhpr
from krhpr import trajectory
from krhpr.limits import Interval, Limits
from krhpr.trajectory import Bounds, ContradictoryLimits
from krhpr.trajectory.clearance import kept_apart, separations
from krhpr.trajectory.point import PointFunctions
from krhpr.trajectory.terms import Objective

ROOT = Path(__file__).resolve().parents[2]
BOX = Bounds(redundant=np.radians([35, 145]), redundant_rate=1.0)
CHAPTER_4 = trajectory.chapter_4()
T1 = trajectory.translation()


def own(**limits: Any) -> krhpr.Robot:
    """The robot of the example, without its limits but for those given."""
    robot = krhpr.load(str(ROOT / "examples" / "my_robot.yaml"), backend="numpy")
    robot.limits = Limits(**limits)
    return robot


def path() -> trajectory.Path:
    turned = Rotation.from_rotvec([0.0, 0.5, 0.0]).as_matrix()
    return trajectory.way_points([0.0, 2.0], [[0, 0, 0.28], [0.03, 0, 0.28]], np.array([np.eye(3), turned]))


@cache
def free() -> trajectory.Trajectory:
    return trajectory.optimise(own(), path(), "eta_2", BOX)


def passive(found: trajectory.Trajectory, name: str) -> np.ndarray:
    robot, motion = found.robot, found.examined.motion
    k = robot.signature("passive_joints").outputs[0].labels.index(name)
    s = robot.end_points(motion.p, motion.Q, found.redundant)
    return np.asarray(robot.passive_joints(motion.p, motion.Q, s, found.theta).passive[:, :, k])


@pytest.mark.parametrize(("name", "upper"), [("crank_2", True), ("rod", False)])
def test_passive_joints(name: str, upper: bool) -> None:
    """An interval one turn further is the same one."""
    angle, wide, held = passive(free(), name)[:, 0], Interval(-2.9, 2.9), []
    low, high = (angle.max() - 2.0, angle.max() - 0.02) if upper else (angle.min() + 0.02, angle.min() + 2.0)
    for turn in (0.0, 2 * np.pi):
        robot = own(passive={name: (Interval(low + turn, high + turn), wide, wide)})
        one = trajectory.optimise(robot, path(), "eta_2", BOX)
        inside = passive(one, name)[:, 0]
        assert one.feasible and low - 1e-5 < inside.min() and inside.max() < high + 1e-5
        assert min(high - inside.max(), inside.min() - low) < 1e-4  # which it does reach
        held.append(one)
    np.testing.assert_allclose(held[0].redundant, held[1].redundant, atol=1e-6)


def test_a_violated_passive_joint_is_told() -> None:
    angle = passive(free(), "rod")
    high = float(angle.min()) - 0.1
    narrow = Interval(high - 0.5, high)
    found = trajectory.optimise(
        own(passive={"rod": (narrow,) * 3}), path(), "eta_2", BOX, method="constant", constant=1.7
    )
    names = {one.name: one for one in found.violations}
    assert not found.feasible and names["rod of leg 1"].unit == "rad"
    assert names["rod of leg 1"].limit == high


def test_units_of_passive_slides_and_whole_turns() -> None:
    robot = krhpr.load("spatial_cpr3_c", backend="numpy")
    metres = (Interval(0.0, 0.3),) * 3
    robot.limits = Limits(passive={"travel_1": metres, "turn_1": (Interval(-4.0, 4.0),) * 3})
    point = PointFunctions(robot, Objective(eta_2=1), Bounds((0.05, 0.2)), np.ones((3, 1)))
    units = {one.name: one.unit for one in point.quantities}
    assert units["travel_1 of leg 2"] == "m" and "turn_1 of leg 1" not in units


def test_the_redundant_coordinate() -> None:
    platform = tuple(Interval(*np.radians(x)) for x in ([80, 120], [35, 100], [95, 145]))
    found = trajectory.optimise(own(passive={"platform_joint": platform}), path(), "eta_2", BOX)
    low, high = found.bounds.box()
    np.testing.assert_allclose(np.degrees([low, high]), [[80, 35, 95], [120, 100, 145]])
    assert found.feasible and (found.redundant > low - 1e-6).all() and (found.redundant < high + 1e-6).all()
    away = (Interval(*np.radians([150, 170])),) * 3
    with pytest.raises(
        ContradictoryLimits,
        match=r"leg 1: 0\.610865 to 2\.53073 is asked for, and the file of my_robot allows 2\.61799 to",
    ):
        trajectory.optimise(own(passive={"platform_joint": away}), path(), "eta_2", BOX)


def test_links_as_cylinders() -> None:
    """Surfaces keep their distance; each link has its own radius, and legs may differ."""
    robot = krhpr.load("spatial_rrr_a", backend="numpy")
    bounds = replace(CHAPTER_4, clearance=None)
    blind = trajectory.optimise(robot, T1, "eta_3", bounds)
    thick = robot.with_geometry()
    thick.limits = Limits(link_radii={"l_3": (0.02, 0.01, 0.01), "l_r": (0.005,) * 3}, clearance=0.003)
    least = {pair.name: pair.least for pair in kept_apart(thick, bounds)}
    assert least["l_3 of leg 1 and l_3 of leg 2"] == pytest.approx(0.033)
    assert least["l_3 of leg 1 and platform edge 1-2"] == pytest.approx(0.023)
    assert least["l_2 of leg 2 and redundant link of leg 3"] == pytest.approx(0.008)
    both = kept_apart(thick, replace(bounds, clearance=0.025))
    assert {pair.name: pair.least for pair in both}["l_2 of leg 2 and redundant link of leg 3"] == 0.025
    assert kept_apart(robot, bounds) == () and len(kept_apart(robot, CHAPTER_4)) == len(both)
    held = trajectory.optimise(thick, T1, "eta_3", bounds)
    assert held.feasible and held.solved is not None and held.solved.pairs

    def shortest(found: trajectory.Trajectory) -> float:
        """Distances of surfaces beyond what is asked for."""
        motion, every = found.examined.motion, kept_apart(thick, bounds)
        s = robot.end_points(motion.p, motion.Q, found.redundant)
        points = robot.link_points(motion.p, motion.Q, s, found.theta)
        gaps = np.linalg.norm(separations(robot, every, points.points, points.attachment), axis=-1)
        return float((gaps.min(axis=1) - [pair.least for pair in every]).min())

    assert shortest(held) > -1e-6 and shortest(blind) < -1e-4


def test_accelerations_are_derivatives_of_the_rates() -> None:
    found = free()
    again = np.gradient(found.examined.theta_rate, found.times, axis=0, edge_order=2)
    error = np.abs(again - found.examined.theta_acceleration)
    smooth = np.arange(len(found.times)) % 10 != 0  # in the spline's knots accelerations have kinks
    assert error[smooth].max() < 1e-3 * np.abs(again).max() and error.max() < 0.03 * np.abs(again).max()
