"""Choose the redundant coordinates along a path: the thesis' methods, and an NLP that is better than they
are."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from enum import StrEnum
from time import perf_counter
from typing import Any

import numpy as np
from numpy.typing import NDArray

from krhpr.calls import Branch
from krhpr.robot import Robot
from krhpr.trajectory import baselines
from krhpr.trajectory.clearance import Pair, pairs
from krhpr.trajectory.compiled import Evaluation
from krhpr.trajectory.examine import (
    Coordinates,
    Examined,
    Violation,
    examine,
    separators_along,
    turns_along,
)
from krhpr.trajectory.paths import Path, PathError
from krhpr.trajectory.point import PointFunctions
from krhpr.trajectory.reach import check_path, signs_at_start
from krhpr.trajectory.search import Start, global_start
from krhpr.trajectory.terms import Bounds, Objective
from krhpr.trajectory.transcription import Curve, Programme, Solved, uniform_knots

Floats = NDArray[np.float64]

INTERVALS = 30
"""Of the spline, unless told."""
FINER = 10
"""How many times finer than the spline's intervals the grid is on which limits are checked."""
ROUNDS = 8
"""The most solutions: limits are tightened where they are exceeded between samples, links kept apart."""


class Method(StrEnum):
    """How redundant coordinates are chosen."""

    NLP = "nlp"
    """Each leg's by itself, by the nonlinear programme."""
    CONSTANT = "constant"
    """Equal and constant: the value given, or the best one on the grid."""
    SCAN = "scan"
    """Section 4.3: at each time the equal value on the grid (whole degrees) with the least objective."""
    ONE = "one"
    """Method one of Section 4.3: the same over a reduced range, given by `reduced`."""
    TWO = "two"
    """Method two of Section 4.3: the scan smoothed exponentially with the factor `alpha`, (4.2) corrected."""


@dataclass(frozen=True)
class Trajectory:
    """Redundant coordinates and joints along a path, with what was asked for and what came of it."""

    robot: Robot
    path: Path
    method: Method
    objective: Objective
    bounds: Bounds
    examined: Examined
    """The trajectory on a grid ten times finer than the spline, with its violations."""
    coordinates: Coordinates
    """Redundant coordinates as a function of time."""
    seconds: float
    """What it took."""
    iterations: int
    """Of IPOPT, in all rounds."""
    rounds: int
    """How often the programme was solved."""
    message: str
    """IPOPT's last word; empty for other methods."""
    solved: Solved | None = None

    @property
    def feasible(self) -> bool:
        """Whether all limits are met; if not it is the least infeasible trajectory that was found."""
        return self.examined.feasible

    @property
    def violations(self) -> tuple[Violation, ...]:
        """Limits that are not met, the worst first."""
        return self.examined.violations

    @property
    def integrals(self) -> dict[str, float]:
        """Over time, of eta_1^2 (m^2 s), eta_2^2 (s) and log eta_3 (s)."""
        return self.examined.integrals

    @property
    def times(self) -> Floats:
        """Of the grid (n), s."""
        return self.examined.motion.times

    @property
    def redundant(self) -> Floats:
        """Redundant coordinates (n, 3), rad or m."""
        return self.examined.redundant

    @property
    def theta(self) -> Floats:
        """Actuated joints (n, 3, actuators) without jumps of full turns, rad or m."""
        return self.examined.theta

    def report(self) -> str:
        """In words: whether limits are met, and if not which, where and by how much."""
        head = f"{self.path.name}, {self.robot.name}, method {self.method}"
        values = ", ".join(f"integral of {name} {value:.6g}" for name, value in self.integrals.items())
        if self.feasible:
            return f"{head}: all limits met; {values}"
        lines = [f"{head}: NOT feasible, the least infeasible trajectory found; {values}"]
        return "\n".join([*lines, *(f"  {one}" for one in self.violations)])


def optimise(
    robot: Robot,
    path: Path,
    objective: Objective | str | Mapping[str, float],
    bounds: Bounds,
    *,
    method: Method | str = Method.NLP,
    mode: Branch | None = None,
    characteristic_length: float = 1.0,
    intervals: int = INTERVALS,
    start: Trajectory | None = None,
    constant: float | None = None,
    reduced: tuple[float, float] | None = None,
    alpha: float = 0.2,
    progress: Callable[[str], None] = lambda step: None,
    solver: Mapping[str, Any] | None = None,
    evaluation: Evaluation | str = Evaluation.SX,
) -> Trajectory:
    """Choose the redundant coordinates of a robot along a path.

    Args:
        robot: any with an inverse in closed form; redundant sub-legs stand at a swivel of zero.
        path: of its platform.
        objective: integrals to minimise: "eta_1", "eta_2", "eta_3" (of eta_1^2, eta_2^2, log eta_3), weights
            by these names, or an `Objective`.  The programme minimises smooth bounds of the indices; what is
            reported are the indices.
        bounds: limits to keep; those of the robot's file are kept as well.
        method: the programme, or one of the thesis' methods, which do not look at limits.
        mode: the working mode, as `inverse` takes it; it is kept where `bounds.factors` say so.
        characteristic_length: of `indices`, m.
        intervals: of the spline, or steps of the thesis' methods.
        start: a trajectory of the same robot and as many intervals, from which the programme begins in place
            of the global search.
        constant: the value for `Method.CONSTANT`, rad or m; the best one unless given.
        reduced: the range for `Method.ONE`, rad or m.
        alpha: the smoothing factor for `Method.TWO`.
        progress: is told what begins.
        solver: further options of IPOPT.
        evaluation: "compiled" makes C of the programme's functions, which takes seconds once and pays where
            many trajectories of one robot with the same limits and objective are wanted.

    Returns:
        The trajectory; where limits cannot be met, the least infeasible one found, with `feasible` false and
        its `violations`.

    Raises:
        PathError: a planar path for a spatial robot, or the other way round.
        LeavesWorkspace: where and which leg, and by what distance.
        ContradictoryLimits, UnknownObjective, NoClosedForm: what cannot be asked for.
        NoCompiler: there is none to compile with.
    """
    begin = perf_counter()
    wanted, how = Objective.of(objective), Method(method)
    bounds.check(robot)
    if intervals < 2:
        raise PathError(f"{intervals} intervals; a trajectory takes two or more")
    progress("workspace")
    check_path(robot, path, bounds, mode)
    point = PointFunctions(
        robot,
        wanted,
        bounds,
        signs_at_start(robot, path, bounds, mode),
        mode=mode,
        characteristic_length=characteristic_length,
        evaluation=Evaluation(evaluation),
    )
    task = _Task(point, path, intervals, pairs(robot) if bounds.clearance and not robot.planar else ())
    if how is Method.NLP:
        found = _Search(task, progress, dict(solver or {})).run(start)
    else:
        progress(f"method {how}")
        found = _Found(task.examined(_baseline(task, how, constant, reduced, alpha)))
    return Trajectory(
        robot,
        path,
        how,
        wanted,
        bounds,
        found.examined,
        found.coordinates,
        perf_counter() - begin,
        found.iterations,
        found.rounds,
        found.solved.message if found.solved else "",
        found.solved,
    )


@dataclass(frozen=True)
class _Task:
    """What is asked for, and how it is held to its limits."""

    point: PointFunctions
    path: Path
    intervals: int
    apart: tuple[Pair, ...]

    def grid(self, finer: int) -> Floats:
        return np.linspace(self.path.times[0], self.path.times[-1], finer * self.intervals + 1)

    def examined(self, coordinates: Coordinates) -> tuple[Examined, Coordinates]:
        return examine(self.point, self.path, coordinates, self.grid(FINER), self.apart), coordinates


class _Found:
    """The best of several trajectories: the least objective among feasible ones, else the least violation."""

    def __init__(self, first: tuple[Examined, Coordinates]) -> None:
        self.examined, self.coordinates = first
        self.solved: Solved | None = None
        self.iterations = self.rounds = 0

    def offer(self, examined: Examined, coordinates: Coordinates, solved: Solved) -> None:
        """Another one."""
        if _rank(examined) < _rank(self.examined):
            self.examined, self.coordinates, self.solved = examined, coordinates, solved


def _rank(one: Examined) -> tuple[float, float]:
    objective = one.objective if np.isfinite(one.objective) else np.inf
    return (one.worst, objective if one.feasible else 0.0)


class _Search:
    """Solves the programme, tightens limits where they are exceeded between samples, keeps links apart."""

    def __init__(self, task: _Task, progress: Callable[[str], None], options: dict[str, Any]) -> None:
        self.task, self.progress, self.options = task, progress, options
        self.times = task.grid(2)
        self.weights = np.full(len(self.times), self.times[1] - self.times[0])
        self.weights[[0, -1]] /= 2

    def run(self, start: Trajectory | None) -> _Found:
        """From a trajectory, or from the global search."""
        task, former = self.task, None
        if start is not None and isinstance(start.coordinates, Curve):
            first, former = start.coordinates, start.solved
            if first.intervals != task.intervals:
                raise PathError(
                    f"the trajectory to start from has {first.intervals} intervals, not {task.intervals}"
                )
        else:
            self.progress("global search")
            first = self._curve(global_start(task.point, task.path))
        found = _Found(task.examined(first))
        self._solve(found, first, former)
        for method in (baselines.constant, baselines.scan):
            lines = method(task.point, task.path, task.grid(1))
            other, _ = task.examined(lines)
            if _rank(other) < _rank(found.examined):  # the grid is coarse, and they may lead elsewhere
                self._solve(found, self._curve(Start(lines.times, lines.values, 0.0)), None)
            if _rank(other) < _rank(found.examined):
                found.examined, found.coordinates, found.solved = other, lines, None
        return found

    def _curve(self, start: Start) -> Curve:
        task = self.task
        ends = (task.path.times[0], task.path.times[-1])
        curve, bounds = Curve.near(*ends, task.intervals, start.times, start.redundant), task.point.bounds
        coefficients = curve.coefficients
        if bounds.grip is not None:
            coefficients = bounds.grip.nearest(task.point.robot, coefficients)
        return replace(curve, coefficients=np.clip(coefficients, *bounds.box()))

    def _solve(self, found: _Found, curve: Curve, former: Solved | None) -> None:
        """Solve until limits hold on the fine grid too."""
        task = self.task
        known = [pair for pair in former.pairs if pair in task.apart] if former else []
        point = task.point.with_pairs(tuple(known)) if known else task.point
        programme, separators, tighter = self._programme(point, curve, None)
        motion = task.path.at(self.times)
        if former is not None and programme.fits(former):
            separators, tighter = former.separators, former.tighter.copy()
        else:
            former = None
        for _ in range(ROUNDS):
            self.progress(f"solve, round {found.rounds + 1}")
            _, turns = turns_along(point, motion, curve.at(self.times))
            arguments = (point.parameters(motion, turns), self.weights, curve, separators, tighter)
            solved = programme.solve(*arguments, former)
            if not solved.converged and former is not None:  # what was near may lead nowhere
                solved = programme.solve(*arguments)
            found.rounds += 1
            found.iterations += solved.iterations
            examined, _ = task.examined(solved.curve)
            found.offer(examined, solved.curve, solved)
            if examined.feasible or not solved.converged:
                return
            curve, former, separators = solved.curve, solved, solved.separators
            self._tighten(tighter, examined, point)
            new = [pair for pair in examined.close if pair not in point.pairs]
            if new:
                self.progress(f"keep apart {', '.join(pair.name for pair in new)}")
                point, former = point.with_pairs((*point.pairs, *new)), None
                programme, separators, tighter = self._programme(point, curve, tighter)

    def _programme(
        self, point: PointFunctions, curve: Curve, tighter: Floats | None
    ) -> tuple[Programme, Floats, Floats]:
        """A programme, vectors of its pairs to begin with, and its limits as tight as they are."""
        ends = (self.task.path.times[0], self.task.path.times[-1])
        programme = Programme(point, uniform_knots(*ends, self.task.intervals), self.times, self.options)
        wider = np.zeros((len(self.times), len(point.quantities)))
        if tighter is not None:  # quantities of new pairs are the last ones
            wider[:, : tighter.shape[1]] = tighter
        return programme, separators_along(point, self.task.path.at(self.times), curve.at(self.times)), wider

    def _tighten(self, tighter: Floats, examined: Examined, point: PointFunctions) -> None:
        """Move limits inwards at the samples beside those times at which they are exceeded."""
        fine = examined.motion.times
        place = np.clip(np.searchsorted(self.times, fine, side="right") - 1, 0, len(self.times) - 2)
        own = [k for k, one in enumerate(point.quantities) if not one.of_pair]
        for k, column in zip(own, examined.beyond.T, strict=True):
            beyond = np.where(np.isfinite(column), np.maximum(column, 0.0), 0.0)
            worst = np.zeros(len(self.times))
            np.maximum.at(worst, place, beyond)
            np.maximum.at(worst, place + 1, beyond)
            tighter[:, k] += 1.2 * worst
        gaps = {one.name: one.relative for one in examined.violations}
        for k, one in enumerate(point.quantities):
            if one.of_pair:
                tighter[:, k] += 1.2 * gaps.get(one.name, 0.0)


def _baseline(
    task: _Task, how: Method, constant: float | None, reduced: tuple[float, float] | None, alpha: float
) -> Coordinates:
    point, path, times = task.point, task.path, task.grid(1)
    if how is Method.CONSTANT:
        return baselines.constant(point, path, times, constant)
    if how is Method.SCAN:
        return baselines.scan(point, path, times)
    if how is Method.ONE:
        return baselines.scan(point, path, times, reduced or baselines.REDUCED)
    return baselines.smoothed(baselines.scan(point, path, times), alpha)
