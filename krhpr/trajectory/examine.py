"""A trajectory of the redundant coordinates held to its limits on a fine grid, and what it is worth."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from krhpr.trajectory.clearance import Pair, separations
from krhpr.trajectory.paths import Motion
from krhpr.trajectory.point import PointFunctions, Quantity
from krhpr.trajectory.worth import per_length, squared_torques

Floats = NDArray[np.float64]

TOLERANCE = 1e-6
"""By how much a quantity may be beyond its limit, relative to its scale."""


class Moves(Protocol):
    """Poses of the platform as a function of time: a path, or a part of one."""

    def at(self, times: Any) -> Motion:
        """Poses, twists and their rates at times (n)."""


class Coordinates(Protocol):
    """Redundant coordinates as a function of time."""

    def at(self, times: Floats, order: int = 0) -> Floats:
        """Their values (n, 3), or their derivatives of an order."""


@dataclass(frozen=True)
class Lines:
    """Redundant coordinates on straight lines between values (n, 3) at times (n)."""

    times: Floats
    values: Floats

    def at(self, times: Floats, order: int = 0) -> Floats:
        """Their values (n, 3), or their derivatives of an order."""
        if order == 0:
            return np.column_stack([np.interp(times, self.times, column) for column in self.values.T])
        if order > 1:
            return np.zeros((len(times), self.values.shape[1]))
        slopes = np.diff(self.values, axis=0) / np.diff(self.times)[:, None]
        place = np.searchsorted(self.times, times, side="right") - 1
        return np.asarray(slopes[np.clip(place, 0, len(slopes) - 1)])


@dataclass(frozen=True)
class Violation:
    """A limit that is not kept: what, where it is worst, and by how much."""

    name: str
    unit: str
    time: float
    value: float
    limit: float
    relative: float
    """Beyond the limit, relative to the quantity's scale."""

    def __str__(self) -> str:
        if np.isnan(self.value):
            return f"{self.name} does not exist at {self.time:.4g} s"
        return (
            f"{self.name} is {self.value:.6g} at {self.time:.4g} s, beyond its limit {self.limit:.6g} by "
            f"{abs(self.value - self.limit):.3g} {self.unit}"
        )


@dataclass(frozen=True)
class Examined:
    """A trajectory on a grid of times."""

    motion: Motion
    redundant: Floats
    """(n, 3); rad or m."""
    redundant_rate: Floats
    swivel: Floats | None
    """Of redundant sub-legs (n, 3), rad, where they are chosen."""
    theta: Floats
    """(n, 3, actuators), without jumps of full turns."""
    theta_rate: Floats
    theta_acceleration: Floats
    indices: dict[str, Floats]
    """eta_1 (m), eta_2, eta_3 at each time: the true ones, not their bounds."""
    integrals: dict[str, float]
    """Over time, of eta_1^2 (m^2 s), eta_2^2 (s), log eta_3 (s); and, where the objective has them, of
    squared torques ((N m)^2 s), of absolute rates of actuators, which is their travel (rad), and of squared
    rates (rad^2/s).
    """
    objective: float
    """The objective with the true indices."""
    beyond: Floats
    """How far quantities are beyond their limits, over their scales (n, quantities); negative inside."""
    violations: tuple[Violation, ...]
    """The worst of each quantity, the worst first."""
    close: tuple[Pair, ...]
    """Pairs of links that come too close."""

    @property
    def maxima(self) -> dict[str, float]:
        """The largest eta_1 (m), eta_2 and eta_3 on the grid."""
        return {name: float(values.max()) for name, values in self.indices.items()}

    @property
    def feasible(self) -> bool:
        """Whether all limits are met."""
        return not self.violations

    @property
    def worst(self) -> float:
        """The largest relative violation; 0 where all limits are met."""
        return max((one.relative for one in self.violations), default=0.0)


def turns_along(
    point: PointFunctions, motion: Motion, coordinates: Floats, near: Floats | None = None
) -> tuple[Floats, Floats]:
    """Joints along a trajectory without jumps (n, 3, actuators), and the full turns that were added (rad).

    It begins within half a turn of `near` (3, actuators), or in (-pi, pi].
    """
    theta = point.inverse(motion.p, motion.Q, coordinates)
    there = np.nan_to_num(theta)
    unwrapped = np.where(point.robot.angular, np.unwrap(there, axis=0), there)
    if near is not None:
        before = np.round((near - unwrapped[0]) / (2 * np.pi))
        unwrapped = unwrapped + 2 * np.pi * np.where(point.robot.angular, before, 0.0)
    turns = 2 * np.pi * np.round((unwrapped - there) / (2 * np.pi))
    return theta + turns, turns


def separators_along(point: PointFunctions, motion: Motion, coordinates: Floats) -> Floats:
    """Unit vectors along the shortest distances of the pairs that are kept apart (n, pairs, 3)."""
    if not point.pairs:
        return np.zeros((len(coordinates), 0, 3))
    robot = point.robot
    theta, _ = turns_along(point, motion, coordinates)
    s = robot.end_points(motion.p, motion.Q, coordinates[:, :3])
    points = robot.link_points(motion.p, motion.Q, s, theta)
    gaps = separations(robot, point.pairs, points.points, points.attachment)
    sizes = np.linalg.norm(gaps, axis=-1, keepdims=True)
    return np.moveaxis(gaps / np.maximum(sizes, 1e-9), 0, 1)


def examine(
    point: PointFunctions, path: Moves, coordinates: Coordinates, times: Floats, of: Sequence[Pair] = ()
) -> Examined:
    """Hold a trajectory to its limits at some times; `of` are the pairs of links to keep apart."""
    robot, motion = point.robot, path.at(times)
    chosen, rates, bend = (coordinates.at(times, order) for order in range(3))
    theta, turns = turns_along(point, motion, chosen)
    redundant, rate = chosen[:, :3], rates[:, :3]
    at = (motion.p, motion.Q, robot.end_points(motion.p, motion.Q, redundant), theta)
    swivels = point.width == 6
    theta_rate = np.asarray(
        robot.joint_rates(*at, motion.twist, rate, swivel_rates=rates[:, 3:] if swivels else None)
    )
    theta_acceleration = robot.joint_accelerations(
        *at,
        motion.twist,
        rate,
        theta_rate,
        motion.twist_rate,
        bend[:, :3],
        swivel_accelerations=bend[:, 3:] if swivels else None,
    )
    found = robot.indices(*at, characteristic_length=point.length)
    indices = {"eta_1": found.eta_1, "eta_2": found.eta_2, "eta_3": found.eta_3}
    integrands = {
        "eta_1^2": found.eta_1**2,
        "eta_2^2": found.eta_2**2,
        "log eta_3": np.log(found.eta_3),
        **_of_joints(point, at, theta_rate),
    }
    integrals = {name: float(np.trapezoid(values, times)) for name, values in integrands.items()}
    objective = point.objective.value(found.eta_1, found.eta_2, found.eta_3)
    objective = objective + point.objective.rates * (rates**2).sum(axis=1) + point.objective.time
    worth = float(np.trapezoid(objective, times))
    peaks = point.objective.peaks(found.eta_1, found.eta_2, found.eta_3)
    worth += sum(getattr(point.objective, name) * float(np.max(values)) for name, values in peaks.items())
    worth += sum(
        getattr(point.objective, name) * integrals[term]
        for name, term in JOINT_TERMS.items()
        if term in integrals
    )
    orders = [coordinates.at(times, order) for order in range(point.order)]
    z = np.column_stack([*orders, np.zeros((len(times), point.size - point.width * point.order))])
    _, scaled = point.function.map(len(times))(z.T, point.parameters(motion, turns).T)
    rows = [k for k, one in enumerate(point.quantities) if not one.inner]
    quantities = [point.quantities[k] for k in rows]
    values = scaled.full().T[:, rows]
    violations, beyond = _violations(times, quantities, values)
    kinds = [("redundant coordinate", robot.signature("end_points").inputs[2].unit), ("swivel", "rad")]
    box = [
        Quantity(f"{kinds[k // 3][0]} of leg {k % 3 + 1}", kinds[k // 3][1], float(low), float(high))
        for k, (low, high) in enumerate(zip(*point.box, strict=True))
    ]
    violations += _violations(times, box, chosen)[0]
    if (grip := point.bounds.grip) is not None:
        opening = np.asarray(robot.opening(redundant, grip.jaws).opening)
        held = Quantity("opening of the gripper", "m", grip.opening, grip.opening, 0.1)
        violations += _violations(times, [held], opening[:, None] / held.scale)[0]
    close: list[Pair] = []
    if of:
        points = robot.link_points(*at)
        gaps = np.linalg.norm(separations(robot, tuple(of), points.points, points.attachment), axis=-1)
        apart = [Quantity(f"distance of {pair.name}", "m", pair.least, scale=0.1) for pair in of]
        short, _ = _violations(times, apart, gaps.T / 0.1)
        violations += short
        names = {one.name for one in short}
        close = [pair for pair, one in zip(of, apart, strict=True) if one.name in names]
    return Examined(
        motion,
        redundant,
        rate,
        chosen[:, 3:] if swivels else None,
        theta,
        theta_rate,
        np.asarray(theta_acceleration),
        indices,
        integrals,
        worth,
        beyond,
        tuple(sorted(violations, key=lambda one: -one.relative)),
        tuple(close),
    )


JOINT_TERMS = {"torques": "torques^2", "travel": "travel", "joint_rates": "joint_rates^2"}
"""Integrals by the name of their weight."""


def _of_joints(point: PointFunctions, at: tuple[Any, ...], theta_rate: Floats) -> dict[str, Floats]:
    """Integrands of those terms that have a weight."""
    robot, objective, length = point.robot, point.objective, point.length
    comparable = theta_rate * per_length(robot, length)
    made: dict[str, Floats] = {}
    if objective.torques:
        made["torques"] = squared_torques(robot, objective, at, length)
    if objective.travel:
        made["travel"] = np.abs(comparable).sum(axis=(1, 2))
    if objective.joint_rates:
        made["joint_rates"] = (comparable**2).sum(axis=(1, 2))
    return {JOINT_TERMS[name]: term for name, term in made.items()}


def _violations(times: Floats, quantities: Sequence[Quantity], scaled: Any) -> tuple[list[Violation], Floats]:
    """The worst violation of each quantity from its values over its scale (n, quantities)."""
    found, columns = [], []
    for one, column in zip(quantities, np.asarray(scaled).T, strict=True):
        low, high = one.low / one.scale, one.high / one.scale
        with np.errstate(invalid="ignore"):
            beyond = np.maximum(low - column, column - high)
        beyond = np.where(np.isnan(column), np.inf, beyond)
        columns.append(beyond)
        k = int(np.argmax(beyond))
        if beyond[k] > TOLERANCE:
            limit = one.low if low - column[k] >= column[k] - high else one.high
            value = float(column[k] * one.scale)
            found.append(Violation(one.name, one.unit, float(times[k]), value, limit, float(beyond[k])))
    return found, np.stack(columns, axis=1) if columns else np.zeros((len(times), 0))
