"""Re-planning while the robot moves: redundant coordinates over a horizon that recedes.

    planner = RecedingHorizon(robot, path, "eta_1", bounds, horizon=1.0)
    plan = planner.plan(0.0)
    while ...:
        plan = planner.plan(time, path)     # way-points may have changed; goes on from where `plan` is then

The programme and its solvers are made once, with compiled functions where there is a compiler; a step changes
parameters alone and starts from the last solution, moved on in time.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from time import perf_counter
from typing import Any

import numpy as np
from numpy.typing import NDArray

from krhpr.branches import Branch
from krhpr.errors import TrajectoryError
from krhpr.native import NoCompiler, find_compiler
from krhpr.robot import Robot
from krhpr.trajectory.clearance import Pair, kept_apart
from krhpr.trajectory.compiled import Evaluation
from krhpr.trajectory.examine import Examined, examine, separators_along, turns_along
from krhpr.trajectory.paths import Motion, Path, PathError
from krhpr.trajectory.point import PointFunctions
from krhpr.trajectory.reach import check_path, signs_at_start
from krhpr.trajectory.refusals import ContradictoryLimits, UnknownObjective
from krhpr.trajectory.search import global_start
from krhpr.trajectory.terms import Bounds, Objective
from krhpr.trajectory.transcription import Curve, Programme, Solved, beginning, uniform_knots

Floats = NDArray[np.float64]

INTERVALS = 20
"""Of the spline over the horizon, unless told."""
UNSCALED = {"mumps_permuting_scaling": 0, "mumps_scaling": 0}
"""Quantities are over their scales as it is; looking for scalings takes a third of a step's time."""
FINER = 5
"""How many times finer than the intervals `Plan.examined` looks."""


class BadState(TrajectoryError):
    """A state from which nothing can be planned."""


@dataclass(frozen=True)
class State:
    """Where the robot is."""

    redundant: Floats
    """Redundant coordinates (3), rad or m."""
    rate: Floats
    """Their rates (3)."""
    acceleration: Floats
    """Their accelerations (3)."""
    theta: Floats | None = None
    """Actuated joints (3, n), of which the full turns are counted on; the plan begins within half a turn of
    them."""

    @classmethod
    def at_rest(cls, redundant: Any, theta: Any = None) -> State:
        """Redundant coordinates that do not move."""
        still = np.zeros(3)
        joints = None if theta is None else np.asarray(theta, dtype=float)
        return cls(np.asarray(redundant, dtype=float), still, still, joints)


@dataclass(frozen=True)
class Window:
    """A part of a path; the platform stands before the path's beginning and after its end."""

    path: Path
    start: float
    end: float

    @property
    def times(self) -> Floats:
        """When the part begins and ends, s."""
        return np.array([self.start, self.end])

    def at(self, times: Any) -> Motion:
        """Poses, twists and their rates at times (n)."""
        wanted = np.asarray(times, dtype=float)
        begin, end = self.path.times[0], self.path.times[-1]
        found = self.path.at(np.clip(wanted, begin, end))
        moves = ((wanted >= begin) & (wanted <= end))[:, None]
        return replace(found, times=wanted, twist=found.twist * moves, twist_rate=found.twist_rate * moves)


@dataclass(frozen=True)
class Plan:
    """Redundant coordinates from `start` on, over the horizon."""

    planner: RecedingHorizon
    path: Window
    curve: Curve
    theta: Floats
    """Actuated joints (3, n) at its start, with their full turns."""
    converged: bool
    """Whether IPOPT found the optimum, and thus limits hold at all samples (twice as many as intervals)."""
    message: str
    """IPOPT's last word."""
    iterations: int
    seconds: float
    """What planning took."""

    @property
    def start(self) -> float:
        """When it begins, s."""
        return self.curve.start

    @property
    def end(self) -> float:
        """When the horizon ends, s."""
        return float(self.curve.knots[-1])

    def at(self, times: Any, order: int = 0) -> Floats:
        """Redundant coordinates (n, 3), or their derivatives of an order."""
        return self.curve.at(np.asarray(times, dtype=float), order)

    def state(self, time: float) -> State:
        """Where the robot is at a time within the horizon, full turns of joints counted on."""
        if not self.start - 1e-9 <= time <= self.end + 1e-9:
            raise BadState(f"the plan reaches from {self.start:g} to {self.end:g} s; {time:g} s is outside")
        steps = max(2, int(np.ceil((time - self.start) / self.planner.step)) * 2 + 1)
        times = np.linspace(self.start, max(time, self.start), steps)
        theta, _ = turns_along(self.planner.point, self.path.at(times), self.at(times), self.theta)
        value, rate, acceleration = (self.at([time], order)[0] for order in range(3))
        return State(value, rate, acceleration, theta[-1])

    @cached_property
    def examined(self) -> Examined:
        """The plan on a finer grid: indices, joints, and limits that do not hold between samples."""
        return self.planner.examine(self)


class RecedingHorizon:
    """Plans the redundant coordinates over the next seconds, again and again.

    What holds: a plan begins with value, rate and acceleration of the state it is given, by default those of
    the last plan at that time; limits hold at all samples where it has `converged`; and planning again from
    the same state is the same optimum, however it was started.
    """

    def __init__(
        self,
        robot: Robot,
        path: Path,
        objective: Objective | str | Mapping[str, Any],
        bounds: Bounds,
        *,
        horizon: float,
        intervals: int = INTERVALS,
        mode: Branch | None = None,
        characteristic_length: float = 1.0,
        apart: Sequence[Pair] = (),
        evaluation: Evaluation | str | None = None,
        solver: Mapping[str, Any] | None = None,
    ) -> None:
        """Build the programme.

        Args:
            robot: as `optimise` takes it, as are objective, bounds, mode and characteristic length.
            path: the first one.
            horizon: how far to plan, s.
            intervals: of the spline.
            apart: pairs of links to keep apart (of a trajectory: `solved.pairs`); `Plan.examined` looks at
                all pairs.
            evaluation: compiled where there is a compiler, unless told.
            solver: further options of IPOPT.

        Raises:
            PathError: a horizon that is not positive, or fewer than four intervals.
            LeavesWorkspace, ContradictoryLimits, UnknownObjective, NoClosedForm: as `optimise`.
        """
        if not 0 < horizon < np.inf:
            raise PathError(f"the horizon is {horizon:g} s; it must be positive")
        if intervals < 4:
            raise PathError(
                f"{intervals} intervals; a horizon takes four or more, three coefficients are given"
            )
        wanted = Objective.of(objective)
        if wanted.time:
            raise UnknownObjective("a receding horizon follows the path's own timing; give time no weight")
        if wanted.largest:
            named = ", ".join(wanted.largest)
            raise UnknownObjective(f"{named}: what is largest on a horizon is not what is so on the path")
        bounds = bounds.of(robot)
        if bounds.swivel is not None:
            raise ContradictoryLimits("a receding horizon leaves swivels at zero; give no limits of swivels")
        wanted.check(robot)
        check_path(robot, path, bounds, mode)
        if evaluation is None:
            evaluation = Evaluation.COMPILED if _compiles() else Evaluation.SX
        self.robot, self.bounds, self.mode = robot, bounds, mode
        self.horizon, self.intervals, self.step = horizon, intervals, horizon / intervals
        self.point = PointFunctions(
            robot,
            wanted,
            bounds,
            signs_at_start(robot, path, bounds, mode),
            mode=mode,
            characteristic_length=characteristic_length,
            pairs=tuple(apart),
            evaluation=Evaluation(evaluation),
        )
        self._samples = np.linspace(0.0, horizon, 2 * intervals + 1)
        self._weights = np.full(len(self._samples), self._samples[1])
        self._weights[[0, -1]] /= 2
        knots = uniform_knots(0.0, horizon, intervals)
        self._programme = Programme(self.point, knots, self._samples, {**UNSCALED, **(solver or {})})
        self._path, self._pairs = path, kept_apart(robot, bounds)
        self._last: tuple[Plan, Solved] | None = None

    @property
    def last(self) -> Plan | None:
        """The last plan."""
        return self._last[0] if self._last else None

    def plan(self, time: float, path: Path | None = None, state: State | None = None) -> Plan:
        """Plan from a time on.

        Args:
            time: when the plan begins, s.
            path: another one from now on; it should go on from where the platform is.  After its end the
                platform stands.
            state: where the robot is; by default where the last plan has it at this time, and free at first.

        Raises:
            BadState: the last plan does not reach that far, or the state is not finite.
            PathError, LeavesWorkspace: a new path that a leg cannot follow.
        """
        begin = perf_counter()
        if path is not None and path is not self._path:
            check_path(self.robot, path, self.bounds, self.mode)
            self._path = path
        if state is None and self._last is not None:
            state = self._last[0].state(time)
        window = Window(self._path, time, time + self.horizon)
        pinned, near = self._pinned(state), None if state is None else state.theta
        curve, former = self._start(window, state)
        times = time + self._samples
        motion, redundant = window.at(times), curve.at(times)
        _, turns = turns_along(self.point, motion, redundant, near)
        tighter = np.zeros((len(times), len(self.point.quantities)))
        vectors = former.separators if former else separators_along(self.point, motion, redundant)
        arguments = (self.point.parameters(motion, turns), self._weights, curve, vectors, tighter)
        solved = self._programme.solve(*arguments, former, pinned)
        iterations = solved.iterations
        if not solved.converged and former is not None:  # what was near may lead nowhere
            solved = self._programme.solve(*arguments, None, pinned)
            iterations += solved.iterations
        placed = Curve(uniform_knots(time, time + self.horizon, self.intervals), solved.curve.coefficients)
        if near is None:
            near = turns_along(self.point, window.at(times[:1]), placed.at(times[:1]))[0][0]
        seconds = perf_counter() - begin
        plan = Plan(self, window, placed, near, solved.converged, solved.message, iterations, seconds)
        self._last = (plan, solved)
        return plan

    def examine(self, plan: Plan) -> Examined:
        """A plan held to its limits on a grid finer than the samples, and all pairs of links."""
        times = np.linspace(plan.start, plan.end, FINER * self.intervals + 1)
        return examine(self.point, plan.path, plan.curve, times, self._pairs)

    def _pinned(self, state: State | None) -> Floats | None:
        """The coefficients with which the spline has to begin."""
        if state is None:
            return None
        three = (state.redundant, state.rate, state.acceleration)
        if any(np.shape(one) != (3,) for one in three) or not np.isfinite(three).all():
            raise BadState(
                "the state has values that are not finite, or not three of each: redundant coordinates "
                f"{state.redundant}, rates {state.rate}, accelerations {state.acceleration}"
            )
        return beginning(self.step, *three)

    def _start(self, window: Window, state: State | None) -> tuple[Curve, Solved | None]:
        """Where to begin: the last plan moved on in time, what the state has, or the global search."""
        span = (window.start, window.end, self.intervals)
        dense = np.linspace(window.start, window.end, 8 * self.intervals + 1)
        low, high = self.bounds.box()
        if self._last is not None:
            plan, solved = self._last
            curve = Curve.near(*span, dense, plan.curve.at(dense))
            ahead = (window.start - plan.start) / self.step
            if 0 <= ahead < self.intervals:
                curve = replace(curve, coefficients=np.clip(curve.coefficients, low, high))
                return curve, self._moved_on(solved, curve, ahead)
            return curve, None
        if state is not None:
            return Curve.near(
                *span, dense, np.tile(np.clip(state.redundant, low, high), (len(dense), 1))
            ), None
        found = global_start(self.point, window)
        return Curve.near(*span, found.times, found.redundant), None

    def _moved_on(self, solved: Solved, curve: Curve, ahead: float) -> Solved:
        """A solution with its multipliers moved by intervals of time; the last ones stay at the end."""
        of_x, of_g = (np.array(one).ravel() for one in solved.state[1:])
        coefficients, samples = len(curve.coefficients), len(self._samples)
        main = 3 * coefficients
        vectors = _moved(solved.separators, round(2 * ahead))
        of_box = _moved(of_x[:main].reshape(coefficients, 3), round(ahead))
        of_vectors = _moved(of_x[main:].reshape(samples, -1), round(2 * ahead))
        count = samples * len(self.point.quantities)
        of_samples = _moved(of_g[:count].reshape(samples, -1), round(2 * ahead))
        state = (
            np.concatenate([curve.coefficients.ravel(), vectors.ravel()]),
            np.concatenate([of_box.ravel(), of_vectors.ravel()]),
            np.concatenate([of_samples.ravel(), of_g[count:]]),
        )
        return replace(solved, separators=vectors, state=state)


def _moved(rows: Floats, by: int) -> Floats:
    """Rows moved to the front; the last one is repeated."""
    return rows[np.minimum(np.arange(len(rows)) + by, len(rows) - 1)]


def _compiles() -> bool:
    try:
        find_compiler()
    except NoCompiler:
        return False
    return True
