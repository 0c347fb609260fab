"""Optimised redundant coordinates: values of the reference, limits held by plain kinematics, and failures."""

from __future__ import annotations

import json
from dataclasses import replace
from functools import cache
from pathlib import Path
from time import process_time
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import krhpr
from krhpr import trajectory
from krhpr.trajectory import Bounds, ContradictoryLimits, LeavesWorkspace, Method, PathError, UnknownObjective
from krhpr.trajectory.baselines import smoothed
from krhpr.trajectory.clearance import pairs, separation, separations
from krhpr.trajectory.examine import Lines, turns_along
from krhpr.trajectory.point import PointFunctions
from krhpr.trajectory.terms import Objective
from krhpr.trajectory.transcription import Programme, uniform_knots
from tests.trajectory.derivatives import check_derivatives

REFERENCE = json.loads(
    (Path(__file__).parents[1] / "reference" / "trajectories.json").read_text(encoding="utf-8")
)
PATHS = {"T1": trajectory.translation(), "T2": trajectory.tilt()}
OBJECTIVES: dict[str, Any] = {
    "eta1": "eta_1",
    "eta2": "eta_2",
    "eta3": "eta_3",
    "mix": {"eta_1": 11.4, "eta_2": 0.12, "eta_3": 0.67},
}
INTEGRALS = {
    "eta_1^2": ("int_eta1_sq", 1e-6),
    "eta_2^2": ("int_eta2_sq", 1.0),
    "log eta_3": ("int_log_eta3", 1.0),
}
LIMITS = trajectory.chapter_4()
RUNS = pytest.mark.parametrize(
    "run", REFERENCE["runs"], ids=lambda run: f"{run['trajectory']}-{run['objective']}"
)


@cache
def robot() -> krhpr.Robot:
    return krhpr.load("spatial_rrr_a")


@cache
def optimised(path: str, objective: str) -> trajectory.Trajectory:
    return trajectory.optimise(robot(), PATHS[path], OBJECTIVES[objective], LIMITS)


def reference(run: Any, row: str) -> dict[str, float]:
    return {name: run["metrics"][row][key] * unit for name, (key, unit) in INTEGRALS.items()}


def worth(integrals: dict[str, float], objective: str) -> float:
    """The objective's integral without rates."""
    weights = OBJECTIVES[objective]
    weights = {weights: 1.0} if isinstance(weights, str) else weights
    names = {"eta_1": "eta_1^2", "eta_2": "eta_2^2", "eta_3": "log eta_3"}
    return sum(weight * integrals[names[name]] for name, weight in weights.items())


@RUNS
def test_values_of_the_reference_within_one_percent(run: Any) -> None:
    found = optimised(run["trajectory"], run["objective"])
    assert found.feasible and not found.violations
    wanted = worth(reference(run, "NLP independent"), run["objective"])
    assert worth(found.integrals, run["objective"]) == pytest.approx(wanted, rel=0.01)


@pytest.mark.parametrize(("path", "objective"), [("T1", "eta1"), ("T2", "eta2"), ("T1", "eta3")])
def test_limits_hold_by_plain_kinematics(path: str, objective: str) -> None:
    """On a grid of its own, with rates by differences and distances by sampling."""
    found = optimised(path, objective)
    times = np.linspace(PATHS[path].times[0], PATHS[path].times[-1], 1501)
    here, beta = PATHS[path].at(times), found.coordinates.at(times)
    theta = np.unwrap(robot().inverse(here.p, here.Q, beta), axis=0)
    step = times[1] - times[0]
    assert np.degrees(beta).min() > 55 - 1e-3 and np.degrees(beta).max() < 175 + 1e-3
    assert np.abs(np.degrees(np.diff(beta, axis=0) / step)).max() < 60.01
    assert np.abs(np.diff(theta, axis=0) / step).max() < 2.001
    s = robot().end_points(here.p, here.Q, beta)
    margins = robot().singularity(here.p, here.Q, s, theta).margins
    assert margins[:, 0].min() > 0.5 - 1e-5
    area = np.linalg.norm(np.cross(s[:, 1] - s[:, 0], s[:, 2] - s[:, 0]), axis=1) / 2
    assert area.min() > 0.005 - 1e-7
    points, attachment = robot().link_points(here.p, here.Q, s, theta)
    elbow, distal, link = points[:, :, 2], s - points[:, :, 2], attachment - s
    cosine = (distal * link).sum(-1) / np.linalg.norm(distal, axis=-1) / np.linalg.norm(link, axis=-1)
    assert np.degrees(np.arccos(cosine)).max() < 150.01
    proximal = elbow - points[:, :, 1]
    bend = (distal * proximal).sum(-1) / np.linalg.norm(distal, axis=-1) / np.linalg.norm(proximal, axis=-1)
    assert np.degrees(np.arccos(bend)).min() > 10 and np.degrees(np.arccos(bend)).max() < 170
    axis = points[0, :, 1] - points[0, :, 0]
    off = np.linalg.norm(np.cross(s - points[:, :, 1], axis), axis=-1) / np.linalg.norm(axis, axis=-1)
    assert off.min() > 0.02 - 1e-5
    every = pairs(robot())
    gaps = separations(robot(), every, points, attachment)
    assert len(every) == 15 * 14 // 2 - 9 - 9 and np.linalg.norm(gaps, axis=-1).min() > 0.02 - 1e-5


def test_links_are_kept_apart_where_they_come_close() -> None:
    found = optimised("T1", "eta3")
    assert found.rounds > 1 and found.solved is not None and found.solved.pairs
    free = trajectory.optimise(robot(), PATHS["T1"], "eta_3", replace(LIMITS, clearance=None))
    held = trajectory.optimise(robot(), PATHS["T1"], "eta_3", LIMITS, start=free)
    assert held.feasible and worth(free.integrals, "eta3") < worth(held.integrals, "eta3")


def test_distances_of_segments() -> None:
    source = np.random.default_rng(3)
    ends = source.normal(size=(4, 40, 3))
    ends[1, :5] = ends[0, :5] + (ends[3, :5] - ends[2, :5])  # parallel
    gaps = np.linalg.norm(separation((ends[0], ends[1]), (ends[2], ends[3])), axis=-1)
    at = np.linspace(0, 1, 201)[:, None, None]
    first, second = ends[0] + at * (ends[1] - ends[0]), ends[2] + at * (ends[3] - ends[2])
    sampled = np.linalg.norm(first[:, None] - second[None], axis=-1).min(axis=(0, 1))
    assert (gaps <= sampled + 1e-12).all() and np.abs(gaps - sampled).max() < 0.01


@RUNS
def test_the_thesis_methods_have_the_values_of_the_reference(run: Any) -> None:
    path, objective = PATHS[run["trajectory"]], OBJECTIVES[run["objective"]]
    times = np.linspace(path.times[0], path.times[-1], 31)
    here = path.at(times)

    def integrals(beta: Any) -> dict[str, float]:
        theta = robot().inverse(here.p, here.Q, beta)
        eta = robot().indices(here.p, here.Q, robot().end_points(here.p, here.Q, beta), theta)
        values = (eta.eta_1**2, eta.eta_2**2, np.log(eta.eta_3))
        return {name: float(np.trapezoid(x, times)) for name, x in zip(INTEGRALS, values, strict=True)}

    scan = trajectory.optimise(robot(), path, objective, LIMITS, method="scan")
    chosen = scan.coordinates.at(times)
    np.testing.assert_allclose(
        np.degrees(chosen), np.repeat(np.array(run["scan_deg"])[:, None], 3, 1), atol=1e-9
    )
    assert integrals(chosen) == pytest.approx(reference(run, "equal-integer scan"), rel=1e-5)
    two = trajectory.optimise(robot(), path, objective, LIMITS, method=Method.TWO, alpha=0.2)
    smooth = two.coordinates.at(times)
    assert integrals(smooth) == pytest.approx(reference(run, "exponential smoothing, alpha 0.2"), rel=1e-5)
    (row,) = [name for name in run["metrics"] if name.startswith("best const")]
    best = trajectory.optimise(robot(), path, objective, LIMITS, method="constant")
    assert round(np.degrees(best.redundant[0, 0]), 6) == float(row.split()[-1])
    for other in (scan, two, best):
        if other.feasible:
            mine = worth(optimised(run["trajectory"], run["objective"]).integrals, run["objective"])
            assert mine < worth(other.integrals, run["objective"]) * (1 + 1e-6)


def test_what_the_thesis_methods_violate() -> None:
    scan = trajectory.optimise(robot(), PATHS["T1"], "eta_1", LIMITS, method="scan")
    assert not scan.feasible and scan.violations[0].name.startswith("redundant rate")
    assert np.degrees(abs(scan.violations[0].value)) == pytest.approx(340)
    assert "NOT feasible" in scan.report() and "beyond its limit" in scan.report()
    one = trajectory.optimise(robot(), PATHS["T1"], "eta_1", LIMITS, method="one")
    assert np.degrees(one.redundant).min() >= 140 - 1e-9 and np.degrees(one.redundant).max() <= 160 + 1e-9


def test_smoothing_takes_many_steps_after_a_jump() -> None:
    jump = Lines(np.arange(5.0), np.repeat([[0.0], [1.0], [1.0], [1.0], [1.0]], 3, axis=1))
    np.testing.assert_allclose(smoothed(jump, 0.5).values[:, 0], [0, 0.5, 0.75, 0.875, 0.9375])


def test_solving_again_is_fast() -> None:
    begin = process_time()
    first = trajectory.optimise(robot(), PATHS["T1"], "eta_1", LIMITS)
    cold = process_time() - begin
    begin = process_time()
    again = trajectory.optimise(robot(), PATHS["T1"], "eta_1", LIMITS, start=first)
    assert cold < 5 and process_time() - begin < 0.5
    assert again.feasible and again.integrals == pytest.approx(first.integrals, rel=1e-6)
    moved = replace(LIMITS, redundant_rate=np.radians(50))
    other = trajectory.optimise(robot(), PATHS["T1"], "eta_1", moved, start=first)
    assert other.feasible and np.degrees(np.abs(other.examined.redundant_rate)).max() < 50.001


def test_derivatives_of_the_programme() -> None:
    """Gradient, Jacobian and Hessian against central differences of values and slopes."""
    every = pairs(robot())
    limits = replace(LIMITS, actuator_acceleration=3.0)
    signs = np.array([[1.0, -1.0]] * 3)
    point = PointFunctions(robot(), Objective.of(OBJECTIVES["mix"]), limits, signs, pairs=every[20:22])
    times = np.linspace(0, 4, 9)
    programme = Programme(point, uniform_knots(0, 4, 4), times, {})
    motion = PATHS["T2"].at(times)
    source = np.random.default_rng(0)
    q = point.parameters(motion, np.zeros((9, 3, 3)))
    p = np.concatenate([q.ravel(), np.full(9, 0.5)])
    x = np.concatenate([source.uniform(1.5, 1.9, 21), source.normal(size=54)])
    check_derivatives(programme, x, p, source)


@pytest.mark.parametrize(
    "name",
    [
        "spatial_rrr_c",
        "spatial_r_fivebar_b",
        "planar_rp_c",
        "spatial_prr_a",
        "spatial_rrrr_a",
        pytest.param("spatial_cpr3_c", marks=pytest.mark.full),
        pytest.param("spatial_delta_b", marks=pytest.mark.full),
        pytest.param("planar_rrr_b", marks=pytest.mark.full),
    ],
)
def test_robots_of_every_kind(name: str) -> None:
    other = krhpr.load(name, backend="numpy")  # nothing to compile for once
    home = np.array(other.home.p)
    step = np.array([[0, 0, 0], [0.02, 0.01, 0], [0.03, -0.01, 0.02]])[:, : len(home)]
    turns: Any = [0.0, 0.1, 0.2]
    if not other.planar:
        turns = Rotation.from_euler("xyz", [[0, 0, 0], [0.1, 0.1, 0], [0.2, 0.1, 0.1]]).as_matrix()
    path = trajectory.way_points([0.0, 1.0, 2.0], home + step, turns)
    angles = other.signature("end_points").inputs[2].unit == "rad"
    box = (
        (np.radians(35), np.radians(145))
        if angles
        else (0.6 * min(other.home.redundant), 1.5 * max(other.home.redundant))
    )
    limits = Bounds(redundant=box, redundant_rate=1.0 if angles else 0.1, actuator_rate=2.0)
    found = trajectory.optimise(other, path, "eta_2", limits)
    best = trajectory.optimise(other, path, "eta_2", limits, method="constant")
    assert found.feasible
    assert found.examined.objective <= best.examined.objective * (1 + 1e-6)
    s = other.end_points(found.examined.motion.p, found.examined.motion.Q, found.redundant)
    eta = other.indices(found.examined.motion.p, found.examined.motion.Q, s, found.theta)
    assert found.integrals["eta_2^2"] == pytest.approx(float(np.trapezoid(eta.eta_2**2, found.times)))
    rates = np.gradient(found.theta, found.times, axis=0, edge_order=2)
    assert np.abs(rates - found.examined.theta_rate).max() < 0.02 * np.abs(rates).max() + 1e-6


def test_accelerations_and_unwrapped_joints() -> None:
    """Joint 3 of the five-bar crosses pi; limits count full turns."""
    five = krhpr.load("spatial_r_fivebar_a", backend="numpy")
    limits = Bounds(redundant=np.radians([60, 130]), redundant_rate=1.0, actuator_acceleration=1.0)
    whole = trajectory.example()
    part = slice(180, 540, 10)
    path = trajectory.way_points(whole.times[part] - whole.times[180], whole.p[part], whole.Q[part])
    found = trajectory.optimise(five, path, "eta_1", limits)
    assert found.feasible and found.theta.max() > np.pi
    again = np.gradient(found.examined.theta_rate, found.times, axis=0, edge_order=2)
    assert np.abs(again).max() < 1.02
    _, turns = turns_along(_plain(five, limits), found.examined.motion, found.redundant)
    assert turns.max() == pytest.approx(2 * np.pi)


def test_limits_of_a_robot_file() -> None:
    """Of actuated joints, and between the socket's and the stud's axis of spherical joints."""
    own = krhpr.load(str(Path(__file__).parents[2] / "examples" / "my_robot.yaml"), backend="numpy")
    assert own.limits.spherical is not None
    p = np.array(own.home.p)
    turned = Rotation.from_rotvec([0.0, 0.5, 0.0]).as_matrix()
    path = trajectory.way_points([0.0, 2.0], [p, p + np.array([0.03, 0, 0])], np.array([np.eye(3), turned]))
    limits = Bounds(redundant=np.radians([35, 145]), redundant_rate=1.0)
    free = trajectory.optimise(own, path, "eta_2", limits)
    tight = {**own.limits.actuators}
    most = float(free.theta[:, 0, 1].max()) - 0.02
    tight["theta_2"] = (krhpr.Interval(-0.6, most), *own.limits.actuators["theta_2"][1:])
    strict = own.with_geometry()
    strict.limits = replace(own.limits, actuators=tight)
    held = trajectory.optimise(strict, path, "eta_2", limits)
    assert free.feasible and held.feasible and held.theta[:, 0, 1].max() < most + 1e-5
    assert held.integrals["eta_2^2"] > free.integrals["eta_2^2"]
    for name, intervals in own.limits.actuators.items():
        k = free.robot.signature("inverse").outputs[0].labels.index(name)
        for leg, interval in enumerate(intervals):
            inside = (interval.low - 1e-5 < free.theta[:, leg, k]) & (
                free.theta[:, leg, k] < interval.high + 1e-5
            )
            assert inside.all()
    motion = free.examined.motion
    s = own.end_points(motion.p, motion.Q, free.redundant)
    spherical = own.passive_joints(motion.p, motion.Q, s, free.theta).spherical
    for leg, cone in enumerate(own.limits.spherical):
        cosine = np.einsum("i,nij,j->n", cone.socket, spherical[:, leg], cone.stud)
        assert np.arccos(cosine).max() < cone.tilt + 1e-5


def _plain(one: krhpr.Robot, limits: Bounds) -> PointFunctions:
    return PointFunctions(one, Objective(eta_1=1), limits, np.ones((3, 4)))


# -- failures ------------------------------------------------------------------------------------------------


def test_limits_that_cannot_be_met_are_told() -> None:
    found = trajectory.optimise(robot(), PATHS["T1"], "eta_2", replace(LIMITS, margins=(3.0,)))
    assert not found.feasible
    margin = next(one for one in found.violations if one.name == "margin of det J_a")
    assert margin.value < 2.6 and margin.limit == 3.0 and 0 <= margin.time <= 6
    assert "margin of det J_a is 2.5" in found.report() and "least infeasible" in found.report()


def test_a_path_out_of_reach() -> None:
    far = trajectory.way_points([0, 2], [[0, 0, 0.35], [0.9, 0, 0.35]], [np.eye(3)] * 2)
    with pytest.raises(
        LeavesWorkspace, match=r"leaves the workspace at .* s: leg [123] cannot reach"
    ) as caught:
        trajectory.optimise(robot(), far, "eta_1", LIMITS)
    assert 0.5 < caught.value.time < 2 and caught.value.distance > 0.05
    assert caught.value.leg in (2, 3)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        (
            {"redundant": (2.0, 1.0)},
            "redundant coordinate of leg 1: the least value 2 is above the largest 1",
        ),
        ({"actuator_rate": -1.0}, "actuator_rate is -1; it must be positive"),
        ({"factors": {"shouldr": 0.1}}, "no factor of det M_i is called 'shouldr'; did you mean shoulder"),
        ({"margins": (1.0, 1.0, 1.0)}, "3 margins; there are det J_a, det J_n"),
    ],
)
def test_contradictory_limits(changes: Any, message: str) -> None:
    with pytest.raises(ContradictoryLimits, match=message):
        trajectory.optimise(robot(), PATHS["T1"], "eta_1", replace(LIMITS, **changes))


@pytest.mark.parametrize(
    ("objective", "message"),
    [
        ("eta_4", "no objective is called 'eta_4'; did you mean"),
        ({"eta_1": -1.0}, "weights of an objective are not negative"),
        ({"rates": 1.0}, "the objective has no weight"),
    ],
)
def test_unknown_objectives(objective: Any, message: str) -> None:
    with pytest.raises(UnknownObjective, match=message):
        trajectory.optimise(robot(), PATHS["T1"], objective, LIMITS)


def test_paths_and_robots_that_do_not_go_together() -> None:
    flat = trajectory.way_points([0, 1], [[0, 0], [0.1, 0]], [0, 0.1])
    with pytest.raises(PathError, match="path is a planar path, and spatial_rrr_a is a spatial robot"):
        trajectory.optimise(robot(), flat, "eta_1", LIMITS)
