"""Largest values, torques, travel and rates of joints as objectives: by plain kinematics; which is best."""

from __future__ import annotations

import json
from functools import cache
from pathlib import Path
from typing import Any

import casadi as ca
import numpy as np
import pytest
from scipy.optimize import minimize
from scipy.spatial.transform import Rotation

import krhpr
from krhpr import trajectory
from krhpr.trajectory import Bounds, Load, PathError, UnknownObjective
from krhpr.trajectory.files import read_request
from krhpr.trajectory.point import PointFunctions
from krhpr.trajectory.results import about
from krhpr.trajectory.terms import MAXIMA, TERMS, Objective
from krhpr.trajectory.transcription import Programme, uniform_knots

LIMITS = trajectory.chapter_4()
LOAD = Load([0.0, 3.0, -20.0, 0.5, 0.0, 0.0], [0.2, 0.0, -0.1])
OBJECTIVES: dict[str, Any] = {
    "max_eta_1": "max_eta_1",
    "max_eta_2": "max_eta_2",
    "eta_2": "eta_2",
    "travel": "travel",
    "joint_rates": "joint_rates",
    "torques": {"torques": 1.0, "load": LOAD},
}


@cache
def robot() -> krhpr.Robot:
    return krhpr.load("spatial_rrr_a")


@cache
def optimised(name: str) -> trajectory.Trajectory:
    return trajectory.optimise(robot(), trajectory.tilt(), OBJECTIVES[name], LIMITS)


def measured(found: trajectory.Trajectory) -> dict[str, float]:
    """All terms of a trajectory from positions alone, joints by differences, torques by virtual work."""
    times = np.linspace(found.times[0], found.times[-1], 2001)
    motion, beta = found.path.at(times), found.coordinates.at(times)
    at = (motion.p, motion.Q, robot().end_points(motion.p, motion.Q, beta))
    theta = np.unwrap(robot().inverse(*at[:2], beta), axis=0)
    J, K = robot().jacobians(*at, theta)
    U = np.linalg.solve(J, K)
    step = times[1] - times[0]
    change = np.diff(theta, axis=0)
    squares = np.zeros(len(times))
    for k in range(0, len(times), 20):
        pose = tuple(x[k] for x in at)
        # virtual work: f theta_dot = F t + phi rho_dot for all motions
        moves = [robot().joint_rates(*pose, theta[k], t, np.zeros(3)).ravel() for t in np.eye(6)]
        moves += [robot().joint_rates(*pose, theta[k], np.zeros(6), unit).ravel() for unit in np.eye(3)]
        work = np.concatenate([LOAD.wrench, LOAD.redundant_forces])
        squares[k] = np.sum(np.linalg.solve(np.array(moves), work) ** 2)
    singular = [np.linalg.svd(part, compute_uv=False) for part in (U[:, :3], U[:, 3:])]
    bounds = [(values**16).sum(axis=1) ** (1 / 8) for values in singular]  # what is minimised, squared
    return {
        "max_eta_1": float(bounds[0].max()),
        "max_eta_2": float(bounds[1].max()),
        "largest_eta_1": float(singular[0].max()),
        "largest_eta_2": float(singular[1].max()),
        "eta_2": float(np.trapezoid(np.linalg.norm(U[:, 3:], 2, axis=(1, 2)) ** 2, times)),
        "travel": float(np.abs(change).sum()),
        "joint_rates": float((change**2).sum() / step),
        "torques": float(np.trapezoid(squares[::20], times[::20])),
    }


@cache
def table() -> dict[str, dict[str, float]]:
    return {name: measured(optimised(name)) for name in OBJECTIVES}


@pytest.mark.parametrize("name", OBJECTIVES)
def test_each_is_the_best_in_its_own_measure(name: str) -> None:
    assert optimised(name).feasible
    best = table()[name][name]
    for other in OBJECTIVES:
        assert best <= table()[other][name] * (1 + 1e-4), other
    constant = trajectory.optimise(robot(), trajectory.tilt(), OBJECTIVES[name], LIMITS, method="constant")
    assert best <= measured(constant)[name] * (1 + 1e-6) or not constant.feasible


@pytest.mark.parametrize("name", OBJECTIVES)
def test_what_is_reported_is_what_is_measured(name: str) -> None:
    found, plain = optimised(name), table()[name]
    reported = {
        "largest_eta_1": found.maxima["eta_1"],
        "largest_eta_2": found.maxima["eta_2"],
        "eta_2": found.integrals["eta_2^2"],
        "travel": found.integrals.get("travel"),
        "joint_rates": found.integrals.get("joint_rates^2"),
        "torques": found.integrals.get("torques^2"),
    }
    name = name.replace("max", "largest")
    assert reported[name] == pytest.approx(plain[name], rel=2e-3)
    rates = 1e-3 * float(np.trapezoid((found.examined.redundant_rate**2).sum(axis=1), found.times))
    worth = reported[name] ** (2 if "largest" in name else 1)
    assert found.examined.objective == pytest.approx(worth + rates, rel=1e-9)
    assert json.loads(json.dumps(about(found)))["objective_value"] == found.examined.objective


def test_travel_is_never_shorter_than_the_way() -> None:
    found = optimised("travel")
    assert table()["travel"]["travel"] >= np.abs(found.theta[-1] - found.theta[0]).sum() - 1e-9


def test_a_largest_value_is_that_of_its_worst_pose() -> None:
    """No angles make eta_1 smaller at the end of T1, where it is largest, than a search there finds."""
    found = trajectory.optimise(robot(), trajectory.translation(), "max_eta_1", LIMITS)
    assert found.feasible and np.argmax(found.examined.indices["eta_1"]) > 250
    p, Q = np.array([0.3, 0.0, 0.35]), np.eye(3)

    def eta_1(beta: np.ndarray) -> float:
        s, theta = robot().end_points(p, Q, beta), robot().inverse(p, Q, beta)
        return float(robot().indices(p, Q, s, theta).eta_1)

    box = [(np.radians(55), np.radians(175))] * 3
    starts = np.radians([[100, 130, 100], [135, 145, 130], [90, 90, 90], [130, 150, 110]])
    least = min(minimize(eta_1, x, method="Nelder-Mead", bounds=box).fun for x in starts)
    assert least * (1 - 1e-6) <= found.maxima["eta_1"] < 1.02 * least


def test_derivatives_with_largest_values_and_joints() -> None:
    """Gradient, Jacobian and Hessian against central differences, all terms with weights."""
    weights = {name: 0.3 + 0.1 * k for k, name in enumerate(TERMS) if name != "time"}
    objective = Objective.of({**weights, "load": LOAD})
    point = PointFunctions(robot(), objective, LIMITS, np.array([[1.0, -1.0]] * 3))
    times = np.linspace(0, 4, 9)
    programme = Programme(point, uniform_knots(0, 4, 4), times, {})
    source = np.random.default_rng(7)
    q = point.parameters(trajectory.tilt().at(times), np.zeros((9, 3, 3)))
    p = np.concatenate([q.ravel(), np.full(9, 0.5)])
    x = np.concatenate([source.uniform(1.5, 1.9, 21), source.uniform(1, 2, len(MAXIMA))])
    nlp, given = programme._nlp, programme._options[False]
    plain = ca.Function("plain", [nlp["x"], nlp["p"]], [nlp["f"], nlp["g"]])
    direction, h = source.normal(size=len(x)), 1e-6
    ahead, behind = (plain(x + sign * h * direction, p) for sign in (1, -1))
    _, gradient = given["grad_f"](x, p)
    slope = (ahead[0] - behind[0]).full()[0, 0] / (2 * h)
    assert gradient.full().ravel() @ direction == pytest.approx(slope, rel=1e-6)
    _, jacobian = given["jac_g"](x, p)
    slopes = (ahead[1] - behind[1]).full() / (2 * h)
    np.testing.assert_allclose((jacobian @ direction).full(), slopes, atol=1e-6 * np.abs(slopes).max())
    multipliers = source.normal(size=jacobian.size1())

    def lagrangian(at: np.ndarray) -> ca.DM:
        return 0.7 * given["grad_f"](at, p)[1] + given["jac_g"](at, p)[1].T @ multipliers

    upper = given["hess_lag"](x, p, 0.7, multipliers)
    hessian = upper + ca.triu(upper, False).T
    difference = (lagrangian(x + h * direction) - lagrangian(x - h * direction)).full() / (2 * h)
    np.testing.assert_allclose((hessian @ direction).full(), difference, atol=1e-5 * np.abs(difference).max())


@pytest.mark.parametrize("name", ["spatial_prr_c", "planar_rp_b"])
def test_slides_count_by_the_characteristic_length(name: str) -> None:
    """Joints of both kinds: with a tenth of the length rates of slides count ten times, forces a tenth."""
    other = krhpr.load(name, backend="numpy")
    p = np.asarray(other.home.p) + np.array([[0.0] * len(other.home.p), [0.02] * len(other.home.p)])
    turns: Any = [0.0, 0.2]
    if not other.planar:
        turns = Rotation.from_rotvec([[0, 0, 0], [0.1, 0.1, 0.2]]).as_matrix()
    path = trajectory.way_points([0.0, 1.0], p, turns)
    box = (0.9 * min(other.home.redundant), 1.1 * max(other.home.redundant))
    objective = {"joint_rates": 1.0, "torques": 1.0, "load": Load(np.ones(3 if other.planar else 6))}
    found = {}
    for length in (1.0, 0.1):
        one = trajectory.optimise(
            other,
            path,
            objective,
            Bounds(box),
            method="constant",
            constant=max(other.home.redundant),
            characteristic_length=length,
        )
        slides = ~np.array(other.angular)
        at = one.examined.motion.p, one.examined.motion.Q
        s = other.end_points(*at, one.redundant)
        torques = other.inverse_statics(*at, s, one.theta, objective["load"].wrench)
        squares = (torques * np.where(slides, length, 1.0)) ** 2
        assert one.integrals["torques^2"] == pytest.approx(np.trapezoid(squares.sum(axis=(1, 2)), one.times))
        rates = (one.examined.theta_rate / np.where(slides, length, 1.0)) ** 2
        assert one.integrals["joint_rates^2"] == pytest.approx(
            np.trapezoid(rates.sum(axis=(1, 2)), one.times)
        )
        found[length] = one
    assert slides.any() and not slides.all()
    best = trajectory.optimise(other, path, objective, Bounds(box), characteristic_length=0.1)
    assert best.feasible and best.examined.objective <= found[0.1].examined.objective


# -- what is no objective -----------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("objective", "message"),
    [
        ("torques", "torques have a weight and there is no load: give both"),
        ({"eta_1": 1, "load": LOAD}, "a load without torques: give both"),
        (
            {"torques": 1, "load": Load([1.0, 2.0])},
            r"wrench of the load is \[1\.0, 2\.0\]; spatial_rrr_a takes 6",
        ),
        ({"torques": 1, "load": Load([np.nan] * 6)}, "takes 6 finite numbers"),
        ({"time": 1, "max_eta_2": 1}, "time and max_eta_2 cannot be weighed together"),
        ({"traval": 1}, "no objective is called 'traval'; did you mean travel"),
        ({"rates": 1}, "the objective has no weight; give one to eta_1, eta_2, eta_3, max_eta_1"),
    ],
)
def test_mistakes(objective: Any, message: str) -> None:
    with pytest.raises(UnknownObjective, match=message):
        trajectory.optimise(robot(), trajectory.tilt(), objective, LIMITS)


def test_methods_that_cannot_see_it() -> None:
    with pytest.raises(UnknownObjective, match="a scan looks at one pose after the other"):
        trajectory.optimise(robot(), trajectory.tilt(), "travel", LIMITS, method="scan")
    with pytest.raises(UnknownObjective, match="max_eta_1: what is largest on a horizon is not"):
        trajectory.RecedingHorizon(robot(), trajectory.tilt(), "max_eta_1", LIMITS, horizon=1.0)


def test_files(tmp_path: Path) -> None:
    file = tmp_path / "lift.yaml"
    text = (
        "path: T2\nobjective: {torques: 1, max_eta_2: 0.1, load: {wrench: [0, 3, -20, 0.5, 0, 0], "
        "redundant_forces: [0.2, 0, -0.1]}}\nlimits: chapter-4\n"
    )
    file.write_text(text)
    asked = read_request(file, planar=False, slides=False)
    assert asked.objective == Objective(torques=1.0, max_eta_2=0.1, load=LOAD)
    for old, new, message in (
        (
            "[0, 3, -20, 0.5, 0, 0]",
            "[0, 3]",
            "objective.load.wrench: found a list of 2, expected a list of 6",
        ),
        ("wrench:", "wrensh:", "objective.load: found wrensh, redundant_forces, expected wrench and"),
    ):
        file.write_text(text.replace(old, new))
        with pytest.raises(PathError, match=message):
            read_request(file, planar=False, slides=False)
