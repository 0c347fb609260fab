"""The thesis' own methods of Section 4.3: equal redundant coordinates, constant or scanned, and smoothed.

None of them looks at limits; `examine` says which they violate.  Where a gripper keeps an opening there is
one choice left: the object's centre in O'.
"""

from __future__ import annotations

from math import radians
from typing import Any

import numpy as np
from numpy.typing import NDArray

from krhpr.trajectory.examine import Lines
from krhpr.trajectory.paths import Path
from krhpr.trajectory.point import PointFunctions
from krhpr.trajectory.refusals import ContradictoryLimits, UnknownObjective
from krhpr.trajectory.worth import of_poses, of_steps, short_way

Floats = NDArray[np.float64]

REDUCED = (radians(140), radians(160))
"""The range of method one in Section 4.3."""


def candidates(point: PointFunctions, within: tuple[float, float] | None = None) -> Floats:
    """Equal values to choose from: whole degrees in the box of all legs, or 121 values of a slide."""
    low, high = (float(x) for x in (point.bounds.box()[0].max(), point.bounds.box()[1].min()))
    if within is not None:
        low, high = max(low, within[0]), min(high, within[1])
    if point.robot.signature("end_points").inputs[2].unit != "rad":
        return np.linspace(low, high, 121)
    degrees = np.arange(np.ceil(np.degrees(low) - 1e-9), np.floor(np.degrees(high) + 1e-9) + 1)
    if not len(degrees):
        raise ContradictoryLimits(f"no whole degree from {np.degrees(low):g} to {np.degrees(high):g}")
    return np.radians(degrees)


def _choices(point: PointFunctions, within: tuple[float, float] | None = None) -> Floats:
    """Redundant coordinates (choices, 3): equal ones, or those that hold the gripper's object in O'."""
    if (grip := point.bounds.grip) is not None:
        return grip.centred(point.robot)[None, :]
    return np.repeat(candidates(point, within)[:, None], 3, axis=1)


def _joints(point: PointFunctions, path: Path, times: Floats, choices: Floats) -> tuple[Any, ...]:
    """p, Q, s and theta (times, choices, ...)."""
    robot, motion = point.robot, path.at(times)
    p, Q = motion.p[:, None], motion.Q[:, None]
    return p, Q, robot.end_points(p, Q, choices), point.inverse(p, Q, point.coordinates(choices))


def _table(point: PointFunctions, at: tuple[Any, ...]) -> Floats:
    """The objective (times, choices) with the true indices; infinite where a leg is out of reach."""
    found = point.robot.indices(*at, characteristic_length=point.length)
    table = of_poses(point.robot, point.objective, found, at, point.length)
    return np.where(np.isfinite(table), table, np.inf)


def constant(point: PointFunctions, path: Path, times: Floats, value: float | None = None) -> Lines:
    """The same value all along: the one given, or the one with the least integral."""
    if value is not None:
        return Lines(times, point.coordinates(np.full((len(times), 3), value)))
    choices = _choices(point)
    at = _joints(point, path, times, choices)
    change = short_way(point.robot, np.diff(at[3], axis=0))
    steps = of_steps(point.robot, point.objective, change, np.diff(times)[:, None, None], point.length)
    with np.errstate(invalid="ignore"):
        integrals = np.trapezoid(_table(point, at), times, axis=0) + steps.sum(axis=(0, 2))
    best = choices[np.argmin(np.where(np.isfinite(integrals), integrals, np.inf))]
    return Lines(times, point.coordinates(np.tile(best, (len(times), 1))))


def scan(
    point: PointFunctions, path: Path, times: Floats, within: tuple[float, float] | None = None
) -> Lines:
    """At each time by itself the value with the least objective, in the box or `within` a reduced range."""
    if not point.objective.of_poses:
        raise UnknownObjective("a scan looks at one pose after the other, which travel and rates do not tell")
    choices = _choices(point, within)
    best = choices[_table(point, _joints(point, path, times, choices)).argmin(axis=1)]
    return Lines(times, point.coordinates(best))


def smoothed(given: Lines, alpha: float) -> Lines:
    """Exponential smoothing: beta_t = alpha a_t + (1 - alpha) beta_{t-1}, beta_0 = a_0.

    (4.2) of the thesis has a_{t-1} in place of beta_{t-1}: an average of two values, which does not smooth.
    """
    if not 0 < alpha < 1:
        raise ContradictoryLimits(f"alpha is {alpha:g}; it must be between 0 and 1")
    values = given.values.copy()
    for k in range(1, len(values)):
        values[k] = alpha * values[k] + (1 - alpha) * values[k - 1]
    return Lines(given.times, values)
