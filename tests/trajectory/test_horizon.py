"""Re-planning from the present state: continuous with the past, within limits, the optimum, in time."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from pathlib import Path
from time import process_time

import numpy as np
import pytest
from scipy.interpolate import BSpline
from scipy.spatial.transform import Rotation

import krhpr
from krhpr import trajectory
from krhpr.trajectory import BadState, Bounds, Evaluation, Grip, LeavesWorkspace, PathError, State
from krhpr.trajectory.files import read_request
from krhpr.trajectory.horizon import RecedingHorizon, Window
from krhpr.trajectory.transcription import DEGREE, beginning, uniform_knots

ROOT = Path(__file__).resolve().parents[2]
LIMITS = trajectory.chapter_4()
T1 = trajectory.translation()


@cache
def robot() -> krhpr.Robot:
    return krhpr.load("spatial_rrr_a", backend="numpy")


def planner(
    evaluation: Evaluation = Evaluation.SX, objective: str = "eta_1", horizon: float = 2.0
) -> RecedingHorizon:
    return RecedingHorizon(robot(), T1, objective, LIMITS, horizon=horizon, evaluation=evaluation)


def elsewhere(time: float) -> trajectory.Path:
    """From where T1 is at a time, with its velocity, up and aside with a turn."""
    here = T1.at([time])
    p = here.p[0] + np.array([[0, 0, 0], [0.01, 0, 0], [0.04, 0.03, 0.02], [0.05, 0.06, 0.03]])
    turns = Rotation.from_rotvec([[0, 0, 0], [0, 0, 0], [0.1, 0.1, 0], [0.2, 0.2, 0.1]]).as_matrix()
    return trajectory.way_points(time + np.array([0, 0.2, 1.2, 2.2]), p, turns, name="elsewhere")


def test_how_a_spline_begins() -> None:
    source = np.random.default_rng(1)
    value, rate, acceleration = source.normal(size=(3, 3))
    knots = uniform_knots(2.0, 5.0, 7)
    coefficients = source.normal(size=(10, 3))
    coefficients[:3] = beginning(3 / 7, value, rate, acceleration)
    spline = BSpline(knots, coefficients, DEGREE)
    for order, wanted in enumerate((value, rate, acceleration)):
        np.testing.assert_allclose(spline(2.0, nu=order), wanted, atol=1e-9)


def test_plans_go_on_from_one_another() -> None:
    """Values, rates and accelerations are continuous, whatever the step; limits hold by plain kinematics."""
    one = planner()
    times, values, joints = [], [], []
    before = one.plan(0.0)
    for time in (0.1, 0.2, 0.37, 0.9, 1.0, 1.35):
        within = np.linspace(before.start, time, 41)[:-1]
        times.append(within)
        values.append(before.at(within))
        now = one.plan(time, elsewhere(0.9) if time >= 0.9 else None)
        assert now.converged and now.start == time and now.end == pytest.approx(time + 2.0)
        for order in range(3):
            np.testing.assert_allclose(now.at([time], order), before.at([time], order), atol=1e-9)
        np.testing.assert_allclose(now.theta, before.state(time).theta, atol=1e-12)
        joints.append(now.theta)
        before = now
    at, beta = np.concatenate(times), np.concatenate(values)
    rates = np.diff(beta, axis=0) / np.diff(at)[:, None]
    assert np.abs(np.degrees(rates)).max() < 60.1
    first = at < 0.9
    motion = T1.at(at[first])
    theta = np.unwrap(robot().inverse(motion.p, motion.Q, beta[first]), axis=0)
    assert np.abs(np.diff(theta, axis=0) / np.diff(at[first])[:, None, None]).max() < 2.001
    np.testing.assert_allclose(
        joints[1], robot().inverse(*_pose(T1, 0.2), one_value(at, beta, 0.2)), atol=1e-9
    )


def _pose(path: trajectory.Path, time: float) -> tuple[np.ndarray, np.ndarray]:
    here = path.at([time])
    return here.p[0], here.Q[0]


def one_value(times: np.ndarray, values: np.ndarray, time: float) -> np.ndarray:
    return np.array([np.interp(time, times, column) for column in values.T])


def test_the_optimum_does_not_depend_on_the_start() -> None:
    """Where nothing changes, and after moving on: as from cold with the same state."""
    one = planner()
    one.plan(0.0)
    moved = one.plan(0.3)
    state = State(*(moved.at([0.3], order)[0] for order in range(3)))
    again = one.plan(0.3)
    assert again.iterations <= 1
    cold = planner().plan(0.3, state=state)
    for other in (again, cold):
        np.testing.assert_allclose(other.curve.coefficients, moved.curve.coefficients, atol=2e-5)
        assert other.examined.objective == pytest.approx(moved.examined.objective, rel=1e-6)
    whole = trajectory.optimise(robot(), T1, "eta_1", LIMITS, intervals=20, method="constant")
    assert moved.examined.feasible and whole.feasible
    times = moved.examined.motion.times
    constant = np.interp(times, whole.times, whole.examined.indices["eta_1"] ** 2)
    assert moved.examined.integrals["eta_1^2"] < float(np.trapezoid(constant, times))


@pytest.mark.compiler
def test_compiled_functions_are_the_same() -> None:
    plans = []
    for evaluation in Evaluation:
        one = planner(evaluation)
        one.plan(0.0)
        plans.append(one.plan(0.25))
    np.testing.assert_allclose(*(plan.curve.coefficients for plan in plans), atol=1e-8)
    assert plans[0].iterations == plans[1].iterations


@pytest.mark.compiler
def test_a_step_takes_less_than_50_ms() -> None:
    one = RecedingHorizon(krhpr.load("spatial_rrr_a"), T1, "eta_1", LIMITS, horizon=2.0)
    one.plan(0.0)
    taken = []
    for k in range(1, 21):
        begin = process_time()
        plan = one.plan(0.1 * k)
        taken.append(process_time() - begin)
        assert plan.converged and plan.iterations <= 8
    assert one.intervals == 20 and np.median(taken) < 0.05


def test_after_the_path_the_platform_stands() -> None:
    one = planner(horizon=1.0)
    late = one.plan(5.7)
    assert late.converged and late.path.at([7.0]).twist.tolist() == [[0.0] * 6]
    last = Window(T1, 5.0, 7.0).at([5.99, 6.5])
    np.testing.assert_allclose(last.p[1], [0.3, 0, 0.35], atol=1e-12)
    assert last.twist[0, 0] == pytest.approx(0.05)
    resting = one.plan(6.5)
    assert resting.converged and np.abs(resting.examined.motion.twist).max() == 0


def test_full_turns_are_counted_on() -> None:
    """A planner that is told of joints one turn further counts limits from there."""
    one = planner()
    free = one.plan(0.0)
    state = replace(free.state(0.5), theta=free.state(0.5).theta + 2 * np.pi)
    told = one.plan(0.5, state=state)
    np.testing.assert_allclose(told.theta, state.theta, atol=1e-12)
    np.testing.assert_allclose(
        told.state(0.9).theta - told.theta, free.state(0.9).theta - free.state(0.5).theta, atol=0.05
    )
    motion = T1.at([0.9])
    here = robot().inverse(motion.p[0], motion.Q[0], told.at([0.9])[0])
    np.testing.assert_allclose(told.state(0.9).theta, here + 2 * np.pi, atol=1e-9)


def test_links_are_kept_apart() -> None:
    whole = trajectory.optimise(robot(), T1, "eta_3", LIMITS)
    assert whole.solved is not None and whole.solved.pairs
    blind = planner(objective="eta_3").plan(4.0)
    seeing = RecedingHorizon(
        robot(), T1, "eta_3", LIMITS, horizon=2.0, apart=whole.solved.pairs, evaluation=Evaluation.SX
    )
    gaps = []
    for plan in (blind, seeing.plan(4.0), seeing.plan(4.2)):
        short = [one for one in plan.examined.violations if "distance" in one.name]
        gaps.append(max((one.limit - one.value for one in short), default=0.0))
        assert plan.converged
    assert gaps[0] > 4e-4 and max(gaps[1:]) < 1e-5  # between samples


def test_a_gripper_keeps_its_opening() -> None:
    asked = read_request(ROOT / "examples" / "carry.yaml", planar=False, slides=True)
    gripper = krhpr.load(str(ROOT / "examples" / "gripper.yaml"), backend="numpy")
    bounds = replace(asked.bounds, clearance=None, grip=Grip(0.06, 0.08, 0.02))
    one = RecedingHorizon(gripper, asked.path, "eta_1", bounds, horizon=1.0, intervals=8, evaluation="sx")
    first = one.plan(1.0)
    second = one.plan(1.2)
    for plan in (first, second):
        assert plan.converged
        np.testing.assert_allclose(gripper.opening(plan.examined.redundant, 0.08).opening, 0.06, atol=1e-9)


# -- what cannot be planned ---------------------------------------------------------------------------------


def test_states() -> None:
    one = planner()
    one.plan(0.0)
    with pytest.raises(BadState, match=r"reaches from 0 to 2 s; 2\.5 s is outside"):
        one.plan(2.5)
    with pytest.raises(BadState, match="values that are not finite, or not three of each"):
        one.plan(0.1, state=State.at_rest([1.7, np.nan, 1.7]))
    with pytest.raises(BadState, match="not three of each"):
        one.plan(0.1, state=State.at_rest([1.7, 1.7]))
    far = one.plan(0.1, state=State(np.full(3, 1.7), np.full(3, 50.0), np.zeros(3)))
    assert not far.converged and one.last is far and not far.examined.feasible


def test_paths() -> None:
    one = planner()
    far = trajectory.way_points([0, 2], [[0, 0, 0.35], [0.9, 0, 0.35]], [np.eye(3)] * 2)
    with pytest.raises(LeavesWorkspace, match="cannot reach"):
        one.plan(0.0, far)
    with pytest.raises(PathError, match="is a planar path"):
        one.plan(0.0, trajectory.way_points([0, 1], [[0, 0], [0.1, 0]], [0, 0.1]))
    assert one.plan(0.0).path.path is T1  # what was refused is forgotten
    for horizon, intervals, message in (
        (0.0, 20, "the horizon is 0 s; it must be positive"),
        (1.0, 3, "3 intervals; a horizon takes four or more"),
    ):
        with pytest.raises(PathError, match=message):
            RecedingHorizon(robot(), T1, "eta_1", LIMITS, horizon=horizon, intervals=intervals)
    with pytest.raises(trajectory.ContradictoryLimits):
        RecedingHorizon(robot(), T1, "eta_1", Bounds((2.0, 1.0)), horizon=1.0)


# -- a whole path -------------------------------------------------------------------------------------------


def test_following_a_path_is_nearly_as_good_as_knowing_it() -> None:
    """With a third of the path in sight; continuous where one plan takes over from another."""
    whole = trajectory.optimise(robot(), T1, "eta_1", LIMITS, intervals=12)
    followed = trajectory.optimise(robot(), T1, "eta_1", LIMITS, intervals=12, method="receding")
    assert followed.rounds == 9 and followed.feasible
    best, found = (one.integrals["eta_1^2"] for one in (whole, followed))
    assert best * (1 - 1e-6) <= found <= best * 1.01
    assert followed.coordinates.intervals == 12
    kinks = followed.coordinates.at(T1.duration / 12 * np.arange(1, 12)[:, None] + [-1e-9, 1e-9], 2)
    np.testing.assert_allclose(kinks[:, 0], kinks[:, 1], atol=1e-6)


def test_the_first_plan_of_a_horizon_as_long_as_the_path_is_the_programme() -> None:
    whole = trajectory.optimise(robot(), T1, "eta_2", LIMITS, intervals=8)
    once = trajectory.optimise(robot(), T1, "eta_2", LIMITS, intervals=8, method="receding", horizon=1e3)
    assert once.rounds == 1
    assert once.integrals["eta_2^2"] == pytest.approx(whole.integrals["eta_2^2"], rel=1e-3)


@pytest.mark.parametrize(("horizon", "intervals", "said"), [(0.0, 8, "positive"), (None, 3, "4 or more")])
def test_horizons_that_cannot_be(horizon: float | None, intervals: int, said: str) -> None:
    with pytest.raises(PathError, match=said):
        trajectory.optimise(
            robot(), T1, "eta_1", LIMITS, method="receding", horizon=horizon, intervals=intervals
        )
