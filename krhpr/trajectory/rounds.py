"""Solving in rounds: limits that are exceeded between samples are tightened, links that come close kept
apart."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from krhpr.trajectory import baselines
from krhpr.trajectory.clearance import Pair
from krhpr.trajectory.examine import Coordinates, Examined, Lines, examine, separators_along, turns_along
from krhpr.trajectory.paths import Path, PathError
from krhpr.trajectory.point import PointFunctions
from krhpr.trajectory.search import Start, global_starts
from krhpr.trajectory.timing import Retimed
from krhpr.trajectory.transcription import Curve, Programme, Solved, uniform_knots

Floats = NDArray[np.float64]

FINER = 10
"""How many times finer than the spline's intervals the grid is on which limits are checked."""
ROUNDS = 8
"""The most solutions."""


@dataclass(frozen=True)
class Task:
    """What is asked for, and how it is held to its limits."""

    point: PointFunctions
    path: Path
    intervals: int
    apart: tuple[Pair, ...]

    def grid(self, finer: int) -> Floats:
        """Times that many times finer than the spline's intervals."""
        return np.linspace(self.path.times[0], self.path.times[-1], finer * self.intervals + 1)

    def judged(self, coordinates: Coordinates) -> Judged:
        """Redundant coordinates along the path, held to the limits."""
        examined = examine(self.point, self.path, coordinates, self.grid(FINER), self.apart)
        return Judged(examined, coordinates, self.path)


@dataclass(frozen=True)
class Judged:
    """A trajectory, held to its limits."""

    examined: Examined
    coordinates: Coordinates
    path: Path | Retimed
    """With its timing."""

    @property
    def rank(self) -> tuple[float, float]:
        """The less the better: the violation, and among feasible ones the objective."""
        objective = self.examined.objective
        return self.examined.worst, objective if self.examined.feasible and np.isfinite(objective) else np.inf


class Found:
    """The best of several trajectories: the least objective among feasible ones, else the least violation."""

    def __init__(self, first: Judged) -> None:
        self.best = first
        self.solved: Solved | None = None
        self.iterations = self.rounds = 0

    def offer(self, other: Judged, solved: Solved | None) -> None:
        """Another one."""
        if other.rank < self.best.rank:
            self.best, self.solved = other, solved


class Rounds:
    """Solves the programme, tightens limits where they are exceeded between samples, keeps links apart."""

    def __init__(self, task: Task, progress: Callable[[str], None], options: dict[str, Any]) -> None:
        self.task, self.progress, self.options = task, progress, options
        self.times = task.grid(2)
        self.weights = np.full(len(self.times), self.times[1] - self.times[0])
        self.weights[[0, -1]] /= 2

    def run(self, start: Found | None) -> Found:
        """From a former solution with a spline, or from the global search."""
        task, former = self.task, None
        others: list[Curve] = []
        if start is not None and isinstance(start.best.coordinates, Curve):
            first, former = start.best.coordinates, start.solved
            if first.intervals != task.intervals:
                raise PathError(
                    f"the trajectory to start from has {first.intervals} intervals, not {task.intervals}"
                )
            if (
                first.coefficients.shape[1] != task.point.width
            ):  # swivels that were not chosen then, or are not now
                wider = task.point.coordinates(first.coefficients[:, :3])
                first, former = replace(first, coefficients=wider), None
        else:
            self.progress("global search")
            first, *others = map(self._curve, global_starts(task.point, task.path))
        found = Found(self._first(first))
        self._solve(found, first, former)
        for other in others:
            self._solve(found, other, None)
        self._from_baselines(found)
        return found

    def _from_baselines(self, found: Found) -> None:
        """The grid of the search is coarse, and the thesis' methods may lead elsewhere."""
        task = self.task
        methods: list[Callable[[PointFunctions, Path, Floats], Lines]] = [baselines.constant]
        if task.point.objective.of_poses:
            methods.append(baselines.scan)
        for method in methods:
            lines = method(task.point, task.path, task.grid(1))
            other = task.judged(lines)
            if other.rank < found.best.rank:
                self._solve(found, self._curve(Start(lines.times, lines.values, 0.0)), None)
            found.offer(other, None)

    def _curve(self, start: Start) -> Curve:
        task = self.task
        ends = (task.path.times[0], task.path.times[-1])
        curve = Curve.near(*ends, task.intervals, start.times, start.redundant)
        coefficients = curve.coefficients.copy()
        if (grip := task.point.bounds.grip) is not None:
            coefficients[:, :3] = grip.nearest(task.point.robot, coefficients[:, :3])
        return replace(curve, coefficients=np.clip(coefficients, *task.point.box))

    def _solve(self, found: Found, curve: Curve, former: Solved | None) -> None:
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
            q = point.parameters(motion, turns)
            self._prepare(programme, q, curve)
            arguments = (q, self.weights, curve, separators, tighter)
            solved = programme.solve(*arguments, former)
            if not solved.converged and former is not None:  # what was near may lead nowhere
                solved = programme.solve(*arguments)
            found.rounds += 1
            found.iterations += solved.iterations
            judged, beyond = self._judge(programme, solved)
            examined = judged.examined
            found.offer(judged, solved)
            if examined.feasible or not solved.converged:
                return
            curve, former, separators = solved.curve, solved, solved.separators
            self._tighten(tighter, beyond, point, examined)
            new = [pair for pair in examined.close if pair not in point.pairs]
            if new:
                self.progress(f"keep apart {', '.join(pair.name for pair in new)}")
                point, former = point.with_pairs((*point.pairs, *new)), None
                programme, separators, tighter = self._programme(point, curve, tighter)

    def _programme(
        self, point: PointFunctions, curve: Curve, tighter: Floats | None
    ) -> tuple[Programme, Floats, Floats]:
        """A programme, vectors of its pairs to begin with, and its limits as tight as they are."""
        programme = self._make(point)
        wider = np.zeros((len(self.times), len(point.quantities)))
        if tighter is not None:  # quantities of new pairs are the last ones
            wider[:, : tighter.shape[1]] = tighter
        return programme, separators_along(point, self.task.path.at(self.times), curve.at(self.times)), wider

    # -- what another kind of programme does in its own way -------------------------------------------------

    @property
    def _knots(self) -> Floats:
        return uniform_knots(self.task.path.times[0], self.task.path.times[-1], self.task.intervals)

    def _first(self, curve: Curve) -> Judged:
        """What the search began with."""
        return self.task.judged(curve)

    def _make(self, point: PointFunctions) -> Programme:
        return Programme(point, self._knots, self.times, self.options)

    def _prepare(self, programme: Programme, q: Floats, curve: Curve) -> None:
        """Before it is solved from a curve: where other variables begin."""
        point, largest = programme.point, [k for k, one in enumerate(programme.point.quantities) if one.peak]
        if largest:
            z = np.zeros((point.size, len(self.times)))
            z[: point.width * point.order] = np.hstack(
                [curve.at(self.times, order) for order in range(point.order)]
            ).T
            _, scaled = point.function.map(len(self.times))(z, q.T)
            programme.peaks = np.nanmax(scaled.full()[largest], axis=1)

    def _judge(self, programme: Programme, solved: Solved) -> tuple[Judged, tuple[Floats, Floats]]:
        """What came of it; and where quantities that the point functions begin with are how far beyond their
        limits: times among those of the samples (n), and (n, quantities)."""
        judged = self.task.judged(solved.curve)
        return judged, (judged.examined.motion.times, judged.examined.beyond)

    # -------------------------------------------------------------------------------------------------------

    def _tighten(
        self, tighter: Floats, beyond: tuple[Floats, Floats], point: PointFunctions, examined: Examined
    ) -> None:
        """Move limits inwards at the samples beside those times at which they are exceeded."""
        fine, columns = beyond
        place = np.clip(np.searchsorted(self.times, fine, side="right") - 1, 0, len(self.times) - 2)
        for k, column in enumerate(columns.T):
            excess = np.where(np.isfinite(column), np.maximum(column, 0.0), 0.0)
            worst = np.zeros(len(self.times))
            np.maximum.at(worst, place, excess)
            np.maximum.at(worst, place + 1, excess)
            tighter[:, k] += 1.2 * worst
        gaps = {one.name: one.relative for one in examined.violations}
        for k, one in enumerate(point.quantities):
            if one.of_pair:
                tighter[:, k] += 1.2 * gaps.get(one.name, 0.0)
