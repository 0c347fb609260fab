"""The least duration along a path: cases with known answers, limits by plain kinematics, derivatives."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from pathlib import Path

import casadi as ca
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import krhpr
from krhpr import trajectory
from krhpr.trajectory import Bounds, ContradictoryLimits, PathError, UnknownObjective
from krhpr.trajectory.clearance import pairs
from krhpr.trajectory.files import read_request
from krhpr.trajectory.terms import Objective
from krhpr.trajectory.timing import Clock, Retimed, TimedFunctions, TimedProgramme
from krhpr.trajectory.transcription import uniform_knots

LIMITS = replace(trajectory.chapter_4(), actuator_acceleration=10.0)
RIGHT = float(np.radians(90))
STRAIGHT = 0.06
"""m."""


@cache
def flat() -> krhpr.Robot:
    """Two slides in each leg: joints move in proportion to the platform along a straight line."""
    return krhpr.load("planar_pp_a", backend="numpy")


def line() -> tuple[trajectory.Path, float]:
    """A straight line, and the longest way of an actuator along it with angles of 90 degrees."""
    p = np.asarray(flat().home.p) + np.array([[0.0, 0.0], [STRAIGHT, 0.0]])
    theta = flat().inverse(p, np.zeros(2), np.full(3, RIGHT))
    return trajectory.way_points([0, 1], p, np.zeros(2), name="line"), float(
        np.abs(theta[1] - theta[0]).max()
    )


def curved() -> trajectory.Path:
    turns = Rotation.from_rotvec([[0, 0, 0], [0, 0.5, 0], [0.3, 0.5, 0.0]]).as_matrix()
    return trajectory.way_points(
        [0, 2, 4], [[0, 0, 0.35], [0.1, 0.0, 0.35], [0.1, 0.08, 0.3]], turns, name="curved"
    )


@cache
def fastest() -> trajectory.Trajectory:
    return trajectory.optimise(krhpr.load("spatial_rrr_a"), curved(), "time", LIMITS)


def test_bang_bang() -> None:
    """One actuator's acceleration is the limit: half of the way with the one sign, half with the other."""
    path, way = line()
    limits = Bounds(redundant=(RIGHT, RIGHT), actuator_acceleration=0.5)
    found = trajectory.optimise(flat(), path, "time", limits)
    assert found.feasible and found.duration == pytest.approx(2 * np.sqrt(way / 0.5), rel=1e-5)
    inside = found.times[5:-5]
    rates = [found.path.at(inside + side).twist[:, 0] for side in (-1e-4, 1e-4)]
    acceleration = (rates[1] - rates[0]) / 2e-4 * way / STRAIGHT
    away = np.abs(inside - found.duration / 2) > 1e-3
    np.testing.assert_allclose(
        acceleration[away], np.where(inside < found.duration / 2, 0.5, -0.5)[away], rtol=1e-3
    )


@pytest.mark.parametrize(("acceleration", "tolerance"), [(0.5, 1e-4), (None, 1e-6)])
def test_a_rate_is_the_limit(acceleration: float | None, tolerance: float) -> None:
    """A trapezoid, and without limits of accelerations a constant rate."""
    path, way = line()
    limits = Bounds(redundant=(RIGHT, RIGHT), actuator_acceleration=acceleration, actuator_rate=0.1)
    found = trajectory.optimise(flat(), path, "time", limits)
    wanted = way / 0.1 + (0.1 / acceleration if acceleration else 0.0)
    assert found.feasible and found.duration == pytest.approx(wanted, rel=tolerance)
    assert found.duration >= wanted * (1 - 1e-7)  # nothing is faster than the limits allow
    assert np.abs(found.examined.theta_rate).max() == pytest.approx(0.1, rel=1e-5)


def test_redundancy_makes_it_faster() -> None:
    path, way = line()
    limits = Bounds(redundant=(np.radians(40), np.radians(140)), actuator_acceleration=0.5, margins=(0.3,))
    found = trajectory.optimise(flat(), path, "time", limits)
    assert found.feasible and found.duration < 0.9 * 2 * np.sqrt(way / 0.5)
    held = trajectory.optimise(flat(), path, "time", replace(limits, redundant_rate=0.05), start=found)
    assert held.feasible and found.duration < held.duration
    assert np.abs(held.examined.redundant_rate).max() < 0.05 * (1 + 1e-5)


def test_limits_hold_by_plain_kinematics() -> None:
    found = fastest()
    assert found.feasible and found.duration < 0.8
    robot, times = found.robot, np.linspace(0, found.duration, 2001)
    motion, beta = found.path.at(times), found.coordinates.at(times)
    theta = np.unwrap(robot.inverse(motion.p, motion.Q, beta), axis=0)
    step = times[1]
    assert np.abs(np.diff(theta, axis=0) / step).max() < 2.001
    again = np.abs(np.diff(theta, 2, axis=0) / step**2)
    assert again.max() < 10.1 and again.max() > 9.5
    assert np.abs(np.degrees(np.diff(beta, axis=0) / step)).max() < 60.1
    s = robot.end_points(motion.p, motion.Q, beta)
    assert robot.singularity(motion.p, motion.Q, s, theta).margins[:, 0].min() > 0.5
    ends = np.abs(np.diff(theta, axis=0) / step)[[0, -1]]
    assert ends.max() < 10 * step  # from rest to rest
    np.testing.assert_allclose(motion.p[[0, -1]], curved().p[[0, -1]], atol=1e-9)


def test_other_terms_count_over_the_path() -> None:
    both = trajectory.optimise(fastest().robot, curved(), {"time": 1.0, "eta_2": 0.01}, LIMITS)
    assert both.feasible and both.duration > fastest().duration

    def over_path(one: trajectory.Trajectory) -> float:
        places = np.linspace(0, 4, 201)
        assert isinstance(one.path, Retimed)
        over = one.coordinates.over_u  # type: ignore[attr-defined]
        here, beta = curved().at(places), over.at(places)
        s, theta = one.robot.end_points(here.p, here.Q, beta), one.robot.inverse(here.p, here.Q, beta)
        eta = one.robot.indices(here.p, here.Q, s, theta).eta_2
        return float(np.trapezoid(eta**2, places))

    assert over_path(both) < 0.8 * over_path(fastest())


def test_a_clock() -> None:
    clock = Clock(np.array([1.0, 1.5, 3.0]), np.array([0.0, 2.0, 1.0]))
    np.testing.assert_allclose(clock.times, [0, 0.5, 1.5])
    at, h = np.array([0.2, 0.7, 1.3]), 1e-6
    u, speed, gained = clock.at(at)
    np.testing.assert_allclose((clock.at(at + h)[0] - clock.at(at - h)[0]) / (2 * h), speed, rtol=1e-8)
    np.testing.assert_allclose((clock.at(at + h)[1] - clock.at(at - h)[1]) / (2 * h), gained, rtol=1e-6)
    np.testing.assert_allclose(clock.at([0, 0.5, 1.5, 9.0])[0], [1, 1.5, 3, 3])
    np.testing.assert_allclose(clock.slower(2.0).at(2 * at)[0], u)
    path = Retimed(curved(), Clock(np.linspace(0, 4, 5), np.array([0.0, 1.0, 3.0, 2.0, 0.0])))
    at = np.array([0.7, 2.2, 3.1])
    here, before, after = path.at(at), path.at(at - 1e-5), path.at(at + 1e-5)
    np.testing.assert_allclose(here.twist[:, :3], (after.p - before.p) / 2e-5, atol=1e-6)
    np.testing.assert_allclose(here.twist_rate, (after.twist - before.twist) / 2e-5, atol=1e-4)


def test_derivatives_of_the_programme() -> None:
    """With speeds, two pairs of links and all kinds of limits, against central differences."""
    robot = krhpr.load("spatial_rrr_a", backend="numpy")
    objective = Objective(eta_2=0.1, time=1.0)
    signs = np.array([[1.0, -1.0]] * 3)
    point = TimedFunctions(robot, objective, LIMITS, signs, pairs=pairs(robot)[20:22])
    times = np.linspace(0, 4, 9)
    programme = TimedProgramme(point, uniform_knots(0, 4, 4), times, {})
    source = np.random.default_rng(5)
    q = point.parameters(curved().at(times), np.zeros((9, 3, 3)))
    p = np.concatenate([q.ravel(), np.full(9, 0.5)])
    x = np.concatenate([source.uniform(1.5, 1.9, 21), source.normal(size=54), source.uniform(1, 2, 7)])
    assert programme._nlp["x"].numel() == len(x)
    given, values = programme._options[False], [programme._nlp[name] for name in "fg"]
    plain = ca.Function("plain", [programme._nlp["x"], programme._nlp["p"]], values)
    direction, h = source.normal(size=len(x)), 1e-6
    ahead, behind = (plain(x + sign * h * direction, p) for sign in (1, -1))
    _, gradient = given["grad_f"](x, p)
    _, jacobian = given["jac_g"](x, p)
    slope = (ahead[0] - behind[0]).full()[0, 0] / (2 * h)
    assert gradient.full().ravel() @ direction == pytest.approx(slope, rel=1e-6)
    slopes = (ahead[1] - behind[1]).full() / (2 * h)
    np.testing.assert_allclose((jacobian @ direction).full(), slopes, atol=1e-6 * np.abs(slopes).max())
    multipliers = source.normal(size=jacobian.size1())

    def lagrangian(at: np.ndarray) -> ca.DM:
        return 0.7 * given["grad_f"](at, p)[1] + given["jac_g"](at, p)[1].T @ multipliers

    upper = given["hess_lag"](x, p, 0.7, multipliers)
    hessian = upper + ca.triu(upper, False).T
    difference = (lagrangian(x + h * direction) - lagrangian(x - h * direction)).full() / (2 * h)
    np.testing.assert_allclose((hessian @ direction).full(), difference, atol=1e-5 * np.abs(difference).max())


def test_files(tmp_path: Path) -> None:
    file = tmp_path / "quick.yaml"
    file.write_text(
        "path: T2\nobjective: {time: 1, eta_2: 0.01}\n"
        "limits: {redundant: [55 deg, 175 deg], actuator_rate: 2}\n"
    )
    asked = read_request(file, planar=False, slides=False)
    assert asked.objective == Objective(time=1.0, eta_2=0.01)
    again = trajectory.load_result(trajectory.save(fastest(), tmp_path / "quick")[0])
    assert again.about["objective"]["time"] == 1.0 and again.arrays["times"][-1] == fastest().duration
    assert f"{fastest().duration:.6g} s: all limits met" in fastest().report()


# -- what has no fastest timing -----------------------------------------------------------------------------


def test_refusals() -> None:
    robot = krhpr.load("spatial_rrr_a", backend="numpy")
    still = replace(LIMITS, actuator_rate=None, actuator_acceleration=None)
    with pytest.raises(ContradictoryLimits, match="the duration cannot be least where nothing limits it"):
        trajectory.optimise(robot, curved(), "time", still)
    with pytest.raises(PathError, match="721 way-points joined by straight lines are corners"):
        trajectory.optimise(robot, trajectory.example(), "time", LIMITS)
    with pytest.raises(UnknownObjective, match="method scan chooses no timing; nlp makes"):
        trajectory.optimise(robot, curved(), "time", LIMITS, method="scan")
    with pytest.raises(UnknownObjective, match="a receding horizon follows the path's own timing"):
        trajectory.RecedingHorizon(robot, curved(), {"time": 1, "eta_1": 1}, LIMITS, horizon=1.0)


def test_limits_that_cannot_be_met_are_told() -> None:
    path, _ = line()
    limits = Bounds(redundant=(RIGHT, RIGHT), actuator_acceleration=0.5, margins=(9.0,))
    found = trajectory.optimise(flat(), path, "time", limits)
    assert not found.feasible and found.violations[0].name == "margin of det J_a"
    assert np.isfinite(found.duration) and "NOT feasible" in found.report()
