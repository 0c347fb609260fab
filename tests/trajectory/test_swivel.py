"""Swivels of redundant sub-legs, chosen along a path."""

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
from krhpr.trajectory import Bounds, ContradictoryLimits
from krhpr.trajectory.files import read_request
from krhpr.trajectory.point import PointFunctions
from krhpr.trajectory.terms import Objective

PLANAR, SPATIAL = "planar_rrr_b", "spatial_rrrr_a"


@cache
def robot(name: str) -> krhpr.Robot:
    return krhpr.load(name, backend="numpy")


@cache
def path(name: str) -> trajectory.Path:
    home = np.asarray(robot(name).home.p)
    p = home + np.array([[0, 0, 0], [0.05, 0.03, 0], [0.08, -0.02, 0.04]])[:, : len(home)]
    turns: Any = [0.0, 0.2, 0.4]
    if not robot(name).planar:
        turns = Rotation.from_euler("xyz", [[0, 0, 0], [0.2, 0.2, 0], [0.4, 0.2, 0.2]]).as_matrix()
    return trajectory.way_points([0, 1, 2], p, turns)


def limits(name: str, **changes: Any) -> Bounds:
    d = robot(name).home.redundant
    box = np.radians([50, 150]) if name == SPATIAL else (0.6 * min(d), 1.5 * max(d))
    given: dict[str, Any] = {
        "redundant": tuple(box),
        "redundant_rate": 1.0,
        "actuator_rate": 2.0,
        "swivel": (-1.5, 1.2),
        "swivel_rate": 1.0,
    }
    return Bounds(**{**given, **changes})


@cache
def chosen(name: str, objective: str = "eta_1") -> trajectory.Trajectory:
    return trajectory.optimise(robot(name), path(name), objective, limits(name))


@pytest.mark.parametrize("name", [PLANAR, pytest.param(SPATIAL, marks=pytest.mark.full)])
def test_it_pays(name: str) -> None:
    still = trajectory.optimise(robot(name), path(name), "eta_1", limits(name, swivel=None))
    found = chosen(name)
    assert still.swivel is None and found.feasible and found.swivel is not None
    assert found.examined.objective < 0.8 * still.examined.objective


@pytest.mark.parametrize(
    ("name", "objective"), [(PLANAR, "eta_1"), (PLANAR, "joint_rates"), (SPATIAL, "eta_1")]
)
def test_joints_and_limits_by_plain_kinematics(name: str, objective: str) -> None:
    found = chosen(name, objective)
    times = np.linspace(0, 2, 2001)
    motion, all_six = found.path.at(times), found.coordinates.at(times)
    redundant, swivel = all_six[:, :3], all_six[:, 3:]
    theta = robot(name).inverse(motion.p, motion.Q, redundant, swivel=swivel)
    theta, step = np.unwrap(theta, axis=0), times[1]
    np.testing.assert_allclose(theta[::20], found.theta[np.arange(101) * 3], atol=1e-9)
    back = robot(name).swivel(robot(name).end_points(motion.p, motion.Q, redundant), theta)
    np.testing.assert_allclose(np.sin(back - swivel), 0, atol=1e-9)
    assert swivel.min() > -1.5 - 1e-5 and swivel.max() < 1.2 + 1e-5
    assert np.abs(np.diff(swivel, axis=0) / step).max() < 1.001
    assert np.abs(np.diff(theta, axis=0) / step).max() < 2.002
    rates = np.gradient(found.theta, found.times, axis=0, edge_order=2)
    assert np.abs(rates - found.examined.theta_rate).max() < 0.01 * np.abs(rates).max()
    again = np.gradient(found.examined.theta_rate, found.times, axis=0, edge_order=2)
    smooth = np.arange(len(found.times)) % 10 != 0
    error = np.abs(again - found.examined.theta_acceleration)[smooth]
    assert error.max() < 0.02 * max(np.abs(again).max(), 0.1)


@pytest.mark.parametrize("name", [PLANAR, SPATIAL])
def test_what_the_programme_sees_is_the_robot(name: str) -> None:
    """Integrand and rates of the point functions against the robot's own functions, at random coordinates."""
    one, source = robot(name), np.random.default_rng(8)
    point = PointFunctions(one, Objective(eta_2=1.0), limits(name), np.ones((3, 4)))
    motion = path(name).at(np.linspace(0, 2, 5))
    redundant = np.asarray(one.home.redundant) * source.uniform(0.9, 1.1, (5, 3))
    swivel, rates = source.uniform(-0.5, 0.5, (5, 3)), source.normal(size=(5, 6))
    z = np.hstack([redundant, swivel, rates]).T
    turns = np.zeros((5, 3, len(point.actuators)))
    f, g = (out.full() for out in point.function.map(5)(z, point.parameters(motion, turns).T))
    theta = one.inverse(motion.p, motion.Q, redundant, swivel=swivel)
    assert np.isfinite(theta).all()
    at = (motion.p, motion.Q, one.end_points(motion.p, motion.Q, redundant), theta)
    wanted = one.index_bounds(*at).eta_2 ** 2 + 1e-3 * (rates**2).sum(axis=1)
    np.testing.assert_allclose(f[0], wanted, rtol=1e-9)
    theta_rate = one.joint_rates(*at, motion.twist, rates[:, :3], swivel_rates=rates[:, 3:])
    rows = [k for k, quantity in enumerate(point.quantities) if quantity.name.startswith("rate of theta")]
    np.testing.assert_allclose(g[rows].T, theta_rate.reshape(5, -1) / 2.0, rtol=1e-9, atol=1e-12)
    swivels = [k for k, quantity in enumerate(point.quantities) if "swivel" in quantity.name]
    np.testing.assert_allclose(g[swivels].T, rates[:, 3:], rtol=1e-12)


def test_the_fastest_timing() -> None:
    quick = limits(PLANAR, actuator_acceleration=10.0)
    free = trajectory.optimise(robot(PLANAR), path(PLANAR), "time", quick, intervals=12)
    held = trajectory.optimise(robot(PLANAR), path(PLANAR), "time", replace(quick, swivel=None), intervals=12)
    assert free.feasible and held.feasible and free.duration < 0.98 * held.duration
    assert np.abs(free.examined.theta_rate).max() < 2.0 + 1e-5


def test_it_begins_with_a_trajectory_without_swivels() -> None:
    still = trajectory.optimise(robot(PLANAR), path(PLANAR), "eta_1", limits(PLANAR, swivel=None))
    found = trajectory.optimise(robot(PLANAR), path(PLANAR), "eta_1", limits(PLANAR), start=still)
    assert found.feasible and found.examined.objective == pytest.approx(
        chosen(PLANAR).examined.objective, rel=1e-3
    )
    back = trajectory.optimise(robot(PLANAR), path(PLANAR), "eta_1", limits(PLANAR, swivel=None), start=found)
    assert back.feasible and back.swivel is None


def test_files(tmp_path: Path) -> None:
    paths = trajectory.save(chosen(PLANAR), tmp_path / "it")
    again = trajectory.load_result(paths[0])
    np.testing.assert_array_equal(again.arrays["swivel"], chosen(PLANAR).swivel)
    assert again.about["limits"]["swivel"] == [[-1.5] * 3, [1.2] * 3]
    assert "swivel_3 [rad]" in paths[1].read_text()
    file = tmp_path / "asked.yaml"
    file.write_text(
        "path: T2\nlimits: {redundant: [55 deg, 175 deg], swivel: [-30 deg, 45 deg], swivel_rate: 60 deg}\n"
    )
    asked = read_request(file, planar=False, slides=False).bounds
    np.testing.assert_allclose(asked.swivel, np.radians([-30, 45]))
    assert asked.swivel_rate == pytest.approx(np.radians(60))


@pytest.mark.parametrize(
    ("name", "changes", "message"),
    [
        ("planar_rr_b", {}, "planar_rr_b has no redundant sub-legs, and no swivels to choose"),
        (
            PLANAR,
            {"swivel": (1.0, (2.0, 0.5, 2.0))},
            r"swivel of leg 2: the least value 1 is above the largest 0\.5",
        ),
        (PLANAR, {"swivel_rate": 0.0}, "swivel_rate is 0; it must be positive"),
    ],
)
def test_contradictions(name: str, changes: dict[str, Any], message: str) -> None:
    with pytest.raises(ContradictoryLimits, match=message):
        trajectory.optimise(robot(name), path(PLANAR), "eta_1", limits(PLANAR, **changes))


def test_a_horizon_leaves_them_alone() -> None:
    with pytest.raises(ContradictoryLimits, match="a receding horizon leaves swivels at zero"):
        trajectory.RecedingHorizon(robot(PLANAR), path(PLANAR), "eta_1", limits(PLANAR), horizon=1.0)
