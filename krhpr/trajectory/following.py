"""A whole path by re-planning: what a robot does that sees the next seconds alone.

A plan is made at every knot of the path's spline and followed up to the next one.  Plans begin with value,
rate and acceleration of the one before, so that what is followed is one cubic spline over the path.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from krhpr.branches import Branch
from krhpr.trajectory.clearance import Pair
from krhpr.trajectory.compiled import Evaluation
from krhpr.trajectory.horizon import Plan, RecedingHorizon
from krhpr.trajectory.paths import PathError
from krhpr.trajectory.rounds import Found, Task
from krhpr.trajectory.transcription import Curve

LEAST = 4
"""Intervals of a horizon at least: three coefficients are given."""
SHARE = 3
"""A horizon is the path's duration over this, unless told."""


@dataclass(frozen=True)
class Following:
    """How to follow a path."""

    task: Task
    horizon: float | None
    """How far plans look ahead, s; in whole intervals of the path."""
    mode: Branch | None
    evaluation: Evaluation
    solver: dict[str, Any]
    progress: Callable[[str], None]

    def run(self) -> tuple[Found, str]:
        """The trajectory, and the last word of IPOPT: of the first plan that is none, if there is one.

        Links that come too close are kept apart in a second run.
        """
        found, plans = self._followed(())
        if found.best.examined.close:
            self.progress(f"keep apart {', '.join(pair.name for pair in found.best.examined.close)}")
            other, again = self._followed(found.best.examined.close)
            if other.best.rank < found.best.rank:
                other.iterations, other.rounds = (
                    found.iterations + other.iterations,
                    found.rounds + other.rounds,
                )
                found, plans = other, again
        return found, next((plan.message for plan in plans if not plan.converged), plans[-1].message)

    def _intervals(self) -> int:
        """Of a horizon."""
        task = self.task
        if self.horizon is None:
            wanted = round(task.intervals / SHARE)
        elif 0 < self.horizon < np.inf:
            wanted = round(self.horizon / task.path.duration * task.intervals)
        else:
            raise PathError(f"the horizon is {self.horizon:g} s; it must be positive")
        if task.intervals < LEAST:
            raise PathError(f"{task.intervals} intervals; plans take {LEAST} or more")
        return min(max(wanted, LEAST), task.intervals)

    def _followed(self, apart: tuple[Pair, ...]) -> tuple[Found, list[Plan]]:
        task, point, intervals = self.task, self.task.point, self._intervals()
        knots = task.grid(1)
        planner = RecedingHorizon(
            point.robot,
            task.path,
            point.objective,
            point.bounds,
            horizon=float(knots[intervals] - knots[0]),
            intervals=intervals,
            mode=self.mode,
            characteristic_length=point.length,
            apart=apart,
            evaluation=self.evaluation,
            solver=self.solver,
        )
        plans: list[Plan] = []
        for time in knots[: task.intervals - intervals + 1]:
            self.progress(f"plan {len(plans) + 1}")
            plans.append(planner.plan(float(time)))
        times = task.grid(8)
        which = np.clip(np.searchsorted(knots, times, side="right") - 1, 0, len(plans) - 1)
        values = np.vstack([plan.at(times[which == k]) for k, plan in enumerate(plans)])
        found = Found(task.judged(Curve.near(knots[0], knots[-1], task.intervals, times, values)))
        found.rounds, found.iterations = len(plans), sum(plan.iterations for plan in plans)
        return found, plans
