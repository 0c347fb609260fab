"""How long the trajectories of Section 4.3 take on one core: from cold, again, and re-planned step by step.

Functions are loaded and programmes have been solved once before anything is timed.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass
from functools import partial
from statistics import median
from typing import Any

import numpy as np

import krhpr
from krhpr import trajectory

ROBOT = "spatial_rrr_a"
OBJECTIVES = ("eta_1", "eta_2")
SEED = 4
STEPS = 25
"""Steps of the receding horizon, of each kind."""
HORIZON, EVERY = 2.0, 0.1
"""Of the receding horizon, s."""
AROUND = 0.03
"""How far new way-points are from a point ahead at most, m in each coordinate."""


@dataclass(frozen=True)
class Row:
    """One kind of solution."""

    what: str
    count: int
    seconds: float
    """Of the process, the median."""
    most: float
    """The most."""
    iterations: float
    """Of IPOPT, the median."""

    def as_json(self) -> dict[str, Any]:
        """For results.json."""
        return asdict(self)


def measure(repeat: int = 3, steps: int = STEPS) -> list[Row]:
    """Both trajectories with both objectives, and the receding horizon along the first."""
    robot, bounds = krhpr.load(ROBOT), trajectory.chapter_4()
    rows = []
    for path in (trajectory.translation(), trajectory.tilt()):
        for objective in OBJECTIVES:
            solve = partial(trajectory.optimise, robot, path, objective, bounds)
            first = solve()
            for what, again in (("cold", solve), ("again, from its solution", partial(solve, start=first))):
                rows.append(_row(f"{path.name}, {objective}, {what}", [_timed(again) for _ in range(repeat)]))
    return rows + _horizon(robot, bounds, steps)


def _horizon(robot: krhpr.Robot, bounds: trajectory.Bounds, steps: int) -> list[Row]:
    path = trajectory.translation()
    planner = trajectory.RecedingHorizon(robot, path, OBJECTIVES[0], bounds, horizon=HORIZON)
    planner.plan(0.0)
    planner.plan(EVERY)  # makes the solver that begins next to a solution
    times = EVERY * np.arange(2, 2 + steps)
    on = [_timed(partial(planner.plan, time)) for time in times]
    random = np.random.default_rng(SEED)
    new, now, reference = [], float(times[-1]), path
    for _ in range(steps):
        here = path.at([now, now + EVERY]).p
        now += EVERY
        ends = now + np.array([HORIZON / 2, HORIZON])
        ahead = reference.at(np.minimum(ends, reference.times[-1])).p + random.uniform(
            -AROUND, AROUND, (2, 3)
        )
        path = trajectory.way_points(
            [now - EVERY, now, *ends], np.vstack([here, ahead]), np.stack([np.eye(3)] * 4)
        )
        new.append(_timed(partial(planner.plan, now, path)))
    named = f"horizon of {planner.intervals} intervals"
    return [_row(f"{named}, along the path", on), _row(f"{named}, new way-points", new)]


def _timed(solve: Callable[[], Any]) -> tuple[float, int]:
    begin = time.process_time()
    found = solve()
    return time.process_time() - begin, found.iterations


def _row(what: str, found: Sequence[tuple[float, int]]) -> Row:
    seconds, iterations = zip(*found, strict=True)
    return Row(what, len(found), median(seconds), max(seconds), median(iterations))


def section(rows: Sequence[Row]) -> str:
    """A table of the report."""
    lines = [
        f"| {row.what} | {row.count} | {1e3 * row.seconds:.0f} | {1e3 * row.most:.0f} | {row.iterations:g} |"
        for row in rows
    ]
    head = [
        "## Trajectories\n",
        "| Solution | times | ms | at most | iterations |",
        "|---|---:|---:|---:|---:|",
    ]
    return "\n".join([*head, *lines, ""])
