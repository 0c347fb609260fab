"""Whether a robot can follow a path at all, and in which posture it begins."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from krhpr.branches import Branch
from krhpr.errors import TrajectoryError
from krhpr.robot import Robot
from krhpr.trajectory.paths import Path, PathError
from krhpr.trajectory.terms import Bounds

Floats = NDArray[np.float64]


class LeavesWorkspace(TrajectoryError):
    """A path that a leg cannot follow: `leg` (1 to 3), `time` (s), `distance` (m) by which it is out of
    reach."""

    def __init__(self, message: str, leg: int, time: float, distance: float) -> None:
        super().__init__(message, leg, time, distance)
        self.leg, self.time, self.distance = leg, time, distance


def check_path(robot: Robot, path: Path, bounds: Bounds, mode: Branch | None) -> None:
    """Whether it is a path for this robot, along which every leg reaches its end point within its box.

    Raises:
        PathError: a planar path for a spatial robot, or the other way round.
        LeavesWorkspace: where and which leg, and by what distance.
    """
    if path.planar != robot.planar:
        kinds = ("planar", "spatial") if path.planar else ("spatial", "planar")
        raise PathError(f"{path.name} is a {kinds[0]} path, and {robot.name} is a {kinds[1]} robot")
    low, high = bounds.box()
    grid = np.linspace(low, high, 61)
    motion = path.at(np.linspace(path.times[0], path.times[-1], 121))
    swivels: Any = [None] if bounds.swivel is None else np.linspace(*bounds.swivel, 9)
    short = [
        robot.inverse_status(motion.p[:, None], motion.Q[:, None], grid, mode=mode, swivel=swivel)[1]
        for swivel in swivels
    ]
    least = np.asarray(short).min(axis=(0, 2))  # (times, 3)
    if (least <= 0).all():
        return
    k = int(np.argmax((least > 0).any(axis=1)))
    leg = int(np.argmax(least[k]))
    worst = float(least[:, leg].max())
    raise LeavesWorkspace(
        f"{path.name} leaves the workspace at {motion.times[k]:.4g} s: leg {leg + 1} cannot reach its end "
        f"point with any redundant coordinate from {low[leg]:.4g} to {high[leg]:.4g}; it is up to "
        f"{worst:.4g} m short along the path. Change the path or the sizes",
        leg + 1,
        float(motion.times[k]),
        worst,
    )


def signs_at_start(robot: Robot, path: Path, bounds: Bounds, mode: Branch | None) -> Floats:
    """Signs of the factors of det M_i at the path's start, in the middle of the box where it is reached."""
    first = path.at(path.times[:1])
    grid = np.linspace(*bounds.box(), 61)
    theta = np.asarray(robot.inverse(first.p, first.Q, grid, mode=mode))
    there = np.isfinite(theta).all(axis=-1)
    middle = np.abs(np.arange(61) - 30)[:, None] + 1e3 * ~there
    best = middle.argmin(axis=0)
    redundant = grid[best, np.arange(3)]
    theta = robot.inverse(first.p, first.Q, redundant, mode=mode)
    s = robot.end_points(first.p, first.Q, redundant)
    return np.where(np.asarray(robot.singularity(first.p, first.Q, s, theta).factors)[0] < 0, -1.0, 1.0)
