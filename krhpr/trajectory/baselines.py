"""The thesis' own methods of Section 4.3: equal redundant coordinates, constant or scanned, and smoothed.

None of them looks at limits; `examine` says which they violate.  Where a gripper keeps an opening there is
one choice left: the object's centre in O'.
"""

from __future__ import annotations

from math import radians

import numpy as np
from numpy.typing import NDArray

from krhpr.trajectory.examine import Lines
from krhpr.trajectory.paths import Path
from krhpr.trajectory.point import PointFunctions
from krhpr.trajectory.refusals import ContradictoryLimits

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


def _table(point: PointFunctions, path: Path, times: Floats, choices: Floats) -> Floats:
    """The objective (times, choices) with the true indices; infinite where a leg is out of reach."""
    robot, motion = point.robot, path.at(times)
    p, Q = motion.p[:, None], motion.Q[:, None]
    theta = robot.inverse(p, Q, choices, mode=point.mode)
    found = robot.indices(p, Q, robot.end_points(p, Q, choices), theta, characteristic_length=point.length)
    with np.errstate(all="ignore"):
        table = np.asarray(point.objective.value(found.eta_1, found.eta_2, found.eta_3))
    return np.where(np.isfinite(table), table, np.inf)


def constant(point: PointFunctions, path: Path, times: Floats, value: float | None = None) -> Lines:
    """The same value all along: the one given, or the one with the least integral."""
    if value is not None:
        return Lines(times, np.full((len(times), 3), value))
    choices = _choices(point)
    with np.errstate(invalid="ignore"):
        integrals = np.trapezoid(_table(point, path, times, choices), times, axis=0)
    best = choices[np.argmin(np.where(np.isfinite(integrals), integrals, np.inf))]
    return Lines(times, np.tile(best, (len(times), 1)))


def scan(
    point: PointFunctions, path: Path, times: Floats, within: tuple[float, float] | None = None
) -> Lines:
    """At each time by itself the value with the least objective, in the box or `within` a reduced range."""
    choices = _choices(point, within)
    return Lines(times, choices[_table(point, path, times, choices).argmin(axis=1)])


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
