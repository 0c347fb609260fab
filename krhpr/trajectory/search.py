"""The global start: dynamic programming over a grid of redundant coordinates.

Each leg's joints depend on its own redundant coordinate alone, so that rates of joints and redundant
coordinates limit the steps of each leg by itself; what joins the legs is the objective and the margins at
each node.  Limits that are not met cost much in place of being forbidden, so that there always is a path:
the least infeasible one.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from krhpr.trajectory.paths import Motion
from krhpr.trajectory.point import PointFunctions
from krhpr.trajectory.worth import of_poses, of_steps, short_way

Floats = NDArray[np.float64]

POINTS = 13
"""Grid points for each leg."""
SWIVELS = (None, 0.1, 0.3, 0.7, 0.9)
"""Constant swivels that are tried: near zero, and shares of what they may be."""
PENALTY = 1e3
"""Cost of a violation as large as a limit, in units of the objective's median."""


@dataclass(frozen=True)
class Start:
    """Coordinates (n, 3), with swivels (n, 6), at times (n), and by how much they violate limits (relative; 0
    for none)."""

    times: Floats
    redundant: Floats
    violation: float


class Bounded(Protocol):
    """Poses of the platform from a time to another: a path, or a part of one."""

    @property
    def times(self) -> Floats:
        """The first and the last of them count, s."""

    def at(self, times: Any) -> Motion:
        """Poses, twists and their rates at times (n)."""


def global_start(point: PointFunctions, path: Bounded) -> Start:
    """The best path over the grid."""
    return global_starts(point, path)[0]


def global_starts(
    point: PointFunctions, path: Bounded, stages: int = 31, points: int = POINTS
) -> tuple[Start, ...]:
    """The best path over a grid of `points` values for each leg, at up to `stages` times.

    Where swivels are chosen, all legs have the same constant one in each search; first comes the best of
    them, then that with swivels near zero, as legs may do better with unequal ones.
    """
    low, high = point.bounds.box()
    grid = np.linspace(low, high, points)  # (points, 3)
    step, rate = float((high - low).max()) / (points - 1), point.bounds.redundant_rate
    if rate is not None and step > 0:  # a step of the grid takes some time
        stages = max(4, min(stages, int((path.times[-1] - path.times[0]) / (1.5 * step / rate)) + 1))
    motion = path.at(np.linspace(path.times[0], path.times[-1], stages))
    made: list[tuple[float, Start]] = []
    unit: float | None = None
    for share in SWIVELS if point.width == 6 else SWIVELS[:1]:
        theta = point.inverse(motion.p[:, None], motion.Q[:, None], point.coordinates(grid, share))
        nodes, violation, unit = _nodes(point, motion, grid, theta, share, unit)
        moves = [_moves(point, grid[:, leg], theta[:, :, leg], motion.times, unit) for leg in range(3)]
        choice, cost = _cheapest(nodes, moves)
        worst = max(float(violation[k][tuple(index)]) for k, index in enumerate(choice))
        found = np.stack([grid[choice[:, leg], leg] for leg in range(3)], axis=1)
        made.append((cost, Start(motion.times, point.coordinates(found, share), worst)))
    best = min(range(len(made)), key=lambda k: made[k][0])
    return tuple(made[k][1] for k in dict.fromkeys((best, 0)))


def _nodes(
    point: PointFunctions,
    motion: Motion,
    grid: Floats,
    theta: Floats,
    share: float | None,
    unit: float | None,
) -> tuple[Floats, Floats, float]:
    """Cost and violation at every node (stages, points, points, points) with swivels at a share, and the cost
    that is the unit."""
    robot, (stages, points) = point.robot, theta.shape[:2]
    index = np.stack(np.meshgrid(*[np.arange(points)] * 3, indexing="ij"), axis=-1).reshape(-1, 3)
    mesh = np.stack([grid[index[:, leg], leg] for leg in range(3)], axis=-1)
    p, Q = motion.p[:, None], motion.Q[:, None]
    joints = np.stack([theta[:, index[:, leg], leg] for leg in range(3)], axis=2)
    at = (p, Q, robot.end_points(p, Q, mesh), joints)
    found = robot.index_bounds(*at, characteristic_length=point.length)
    cost = of_poses(robot, point.objective, found, at, point.length)
    violation = np.zeros(cost.shape)
    margins = robot.type_2_of_redundant(mesh).margins
    for k, least in enumerate(point.bounds.margins):
        violation += np.maximum(least - margins[:, k], 0) / max(abs(least), 1e-9)
    violation += _of_grip(point, grid, mesh)
    single = _of_legs(point, motion, grid, share)
    for leg in range(3):
        violation += single[:, index[:, leg], leg]
    there = np.isfinite(cost)
    if unit is None:
        unit = (float(np.median(cost[there])) if there.any() else 1.0) or 1.0
    nodes = np.where(there, cost / unit + PENALTY * violation, 1e3 * PENALTY)
    shape = (stages, points, points, points)
    return nodes.reshape(shape), np.where(there, violation, np.inf).reshape(shape), unit


def _of_grip(point: PointFunctions, grid: Floats, mesh: Floats) -> Floats:
    """How far nodes (nodes, 3) are from holding the gripper's opening, and the object's centre from where it
    may be, in steps of the grid; what the grid is too coarse for does not count."""
    grip = point.bounds.grip
    if grip is None:
        return np.zeros(len(mesh))
    robot, (row, value) = point.robot, grip.condition(point.robot)
    step = max(float(np.ptp(grid, axis=0).max()) / (len(grid) - 1), 1e-9)
    unit = float(np.abs(row).min()) * step
    violation = np.maximum(np.abs(mesh @ row - value) / unit - 0.51, 0.0)
    if grip.play is not None:
        centre = np.asarray(robot.opening(grip.nearest(robot, mesh), grip.jaws).centre)
        violation = violation + np.maximum(np.linalg.norm(centre, axis=1) - grip.play, 0.0) / step
    return np.asarray(violation)


def _of_legs(point: PointFunctions, motion: Motion, grid: Floats, share: float | None) -> Floats:
    """Violations of limits that concern one leg at rest (stages, points, 3)."""
    stages, points = len(motion.times), len(grid)
    q = point.parameters(motion, np.zeros((stages, 3, len(point.actuators))))
    z = np.zeros((point.size, stages * points))
    # all legs at the same place of the grid
    z[: point.width] = np.tile(point.coordinates(grid, share).T, stages)
    _, scaled = point.function.map(stages * points)(z, np.repeat(q.T, points, axis=1))
    values = scaled.full().reshape(-1, stages, points)
    total = np.zeros((stages, points, 3))
    for value, one in zip(values, point.quantities, strict=True):
        if one.leg is None or one.moving:
            continue
        low, high = one.low / one.scale, one.high / one.scale
        size = max(abs(x) for x in (low, high) if np.isfinite(x))
        beyond = np.maximum(np.maximum(low - value, value - high), 0) / max(size, 1e-9)
        total[..., one.leg] += np.where(np.isnan(beyond), 1e3, beyond)
    return total


def _moves(point: PointFunctions, grid: Floats, theta: Floats, times: Floats, unit: float) -> Floats:
    """Costs of one leg's steps from a grid point to another, (stages - 1, from, to)."""
    step = np.diff(times)[:, None, None]
    rate = np.abs(grid[None, :, None] - grid[None, None, :]) / step
    cost = point.objective.rates * rate**2 * step
    if (most := point.bounds.redundant_rate) is not None:
        cost = cost + PENALTY * np.maximum(rate / most - 1 - 1e-9, 0)
    change = short_way(point.robot, theta[1:, None, :, :] - theta[:-1, :, None, :])
    worth = of_steps(point.robot, point.objective, change, step, point.length)
    cost = cost + np.nan_to_num(worth) / (unit * step)  # nodes have no times either
    if (most := point.bounds.actuator_rate) is not None:
        fastest = np.abs(change).max(axis=-1) / step
        cost = cost + PENALTY * np.nan_to_num(np.maximum(fastest / most - 1, 0), nan=1e3)
    return np.asarray(cost)


def _cheapest(nodes: Floats, moves: list[Floats]) -> tuple[NDArray[np.int64], float]:
    """Indices (stages, 3) of the cheapest path, and its cost: steps of the legs add up, so each is minimised
    by itself."""
    stages, count = nodes.shape[0], nodes.shape[1]
    total, choices = nodes[0], []
    for k in range(1, stages):
        chosen = []
        for leg in range(3):
            # (..., from) + (from, to) over the leg's axis
            axis = np.moveaxis(total, leg, -1)
            options = axis[..., :, None] + moves[leg][k - 1]
            chosen.append(np.moveaxis(options.argmin(axis=-2), -1, leg))
            total = np.moveaxis(options.min(axis=-2), -1, leg)
        choices.append(chosen)
        total = total + nodes[k]
    index = list(np.unravel_index(int(total.argmin()), (count,) * 3))
    path = [tuple(int(i) for i in index)]
    for chosen in reversed(choices):
        at = list(path[-1])
        for leg in (2, 1, 0):  # the last leg was minimised last
            at[leg] = int(chosen[leg][tuple(at)])
        path.append(tuple(at))
    return np.array(path[::-1]), float(total.min())
