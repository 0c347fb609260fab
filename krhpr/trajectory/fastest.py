"""Rounds of the programme whose timing is free."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from krhpr.trajectory.examine import TOLERANCE, examine, turns_along
from krhpr.trajectory.point import PointFunctions
from krhpr.trajectory.rounds import FINER, Found, Judged, Rounds, Task
from krhpr.trajectory.timing import (
    Clock,
    Retimed,
    RetimedCoordinates,
    TimedFunctions,
    TimedProgramme,
    first_speeds,
)
from krhpr.trajectory.transcription import Curve, Programme, Solved

Floats = NDArray[np.float64]


class FastestRounds(Rounds):
    """Rates and accelerations that are beyond their limits between samples are met by a slower clock; all
    other limits are tightened as in other rounds."""

    def __init__(self, task: Task, *given: Any) -> None:
        super().__init__(task, *given)
        self.plain = task.point
        self.task = Task(self._timed(task.point), task.path, task.intervals, task.apart)

    def _timed(self, point: PointFunctions) -> TimedFunctions:
        return TimedFunctions(
            point.robot,
            point.objective,
            point.bounds,
            point.signs,
            mode=point.mode,
            characteristic_length=point.length,
            pairs=point.pairs,
            evaluation=point.evaluation,
        )

    def run(self, start: Found | None) -> Found:
        """From the global search, or the redundant coordinates of a former solution."""
        if start is None or not isinstance(start.best.coordinates, RetimedCoordinates):
            return super().run(None)
        curve, clock = start.best.coordinates.over_u, start.best.coordinates.clock
        assert isinstance(curve, Curve)
        found = Found(self._slow_enough(curve, clock))
        self._solve(found, curve, start.solved)
        return found

    def _from_baselines(self, found: Found) -> None:
        """The thesis' methods choose no timing."""

    def _first(self, curve: Curve) -> Judged:
        point, motion = self.task.point, self.task.path.at(self.times)
        assert isinstance(point, TimedFunctions)
        _, turns = turns_along(point, motion, curve.at(self.times))
        squared = first_speeds(point, point.parameters(motion, turns), curve, self.times)
        return self._with_clock(curve, Clock(self.times, np.sqrt(squared)))

    def _make(self, point: PointFunctions) -> Programme:
        assert isinstance(point, TimedFunctions)
        return TimedProgramme(point, self._knots, self.times, self.options)

    def _prepare(self, programme: Programme, q: Floats, curve: Curve) -> None:
        assert isinstance(programme, TimedProgramme) and isinstance(programme.point, TimedFunctions)
        programme.initial = first_speeds(programme.point, q, curve, self.times)

    def _judge(self, programme: Programme, solved: Solved) -> tuple[Judged, tuple[Floats, Floats]]:
        assert isinstance(programme, TimedProgramme)
        judged = self._slow_enough(solved.curve, programme.speeds(solved))
        assert isinstance(judged.path, Retimed)
        places, _, _ = judged.path.clock.at(judged.examined.motion.times)
        still = [k for k, one in enumerate(self._own) if not one.order]
        return judged, (places, judged.examined.beyond[:, still])

    def _slow_enough(self, curve: Curve, clock: Clock) -> Judged:
        """With the clock, or as much slower as rates and accelerations ask for."""
        judged, factor = self._with_clock(curve, clock), 1.0
        for one, column in zip(self._own, judged.examined.beyond.T, strict=True):
            beyond = float(np.nan_to_num(column, posinf=0.0).max())
            if one.order and beyond > TOLERANCE / 2:
                factor = max(factor, (1 + beyond) ** (1 / one.order))
        return self._with_clock(curve, clock.slower(factor * (1 + 1e-9))) if factor > 1 else judged

    @property
    def _own(self) -> list[Any]:
        """Quantities of the plain functions without those of pairs, as `Examined.beyond` has them."""
        return [one for one in self.plain.quantities if not one.inner]

    def _with_clock(self, curve: Curve, clock: Clock) -> Judged:
        path, coordinates = Retimed(self.task.path, clock), RetimedCoordinates(curve, clock)
        times = np.linspace(0.0, path.duration, FINER * self.task.intervals + 1)
        return Judged(examine(self.plain, path, coordinates, times, self.task.apart), coordinates, path)
