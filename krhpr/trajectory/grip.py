"""An opening that the gripper of arrangements (b) and (c) keeps while the platform moves.

The opening is a linear function of the three slides (`opening`), so that one of their three freedoms is
given away; the two that are left move the object's centre in the platform's plane.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from krhpr.robot import Robot
from krhpr.trajectory.refusals import ContradictoryLimits

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Grip:
    """What the gripper holds: a round object between its jaws."""

    opening: float
    """Its diameter, m."""
    jaws: Any = 0.0
    """How far the jaws' faces are from S_i, as `opening` takes it: a number, or three; m."""
    play: float | None = None
    """How far the object's centre may be from O' in the platform's plane, m; as far as slides go unless
    given."""

    def condition(self, robot: Robot) -> tuple[Floats, float]:
        """A row (3) and a value of which row @ redundant = value says that the opening is kept."""
        at_zero = robot.opening(np.zeros(3), self.jaws)
        return 2 * np.asarray(at_zero.shares), float(self.opening - at_zero.opening)

    def centred(self, robot: Robot) -> Floats:
        """Redundant coordinates (3) that hold the object with its centre in O'."""
        return np.asarray(robot.redundant_of_opening(self.opening, np.zeros(2), self.jaws))

    def nearest(self, robot: Robot, redundant: Floats) -> Floats:
        """The redundant coordinates (..., 3) with the opening that are nearest to given ones."""
        row, value = self.condition(robot)
        beyond = (redundant @ row - value) / (row @ row)
        return np.asarray(redundant - beyond[..., None] * row)

    def check(self, robot: Robot, low: Floats, high: Floats) -> None:
        """Whether the gripper can hold it with redundant coordinates from `low` to `high` (3).

        Raises:
            ContradictoryLimits: the robot has no gripper, its jaws do not surround anything, or the slides do
                not go that far; it says how far they go.
        """
        if "opening" not in robot.functions:
            raise ContradictoryLimits(
                f"{robot.name} has no gripper to hold an opening with; arrangements (b) and (c) have one"
            )
        for name in ("opening", "play"):
            value = getattr(self, name)
            if value is not None and not 0 <= value < np.inf:
                raise ContradictoryLimits(f"{name} of the grip is {value:g}; it must not be negative")
        row, value = self.condition(robot)
        if not np.isfinite(row).all():
            raise ContradictoryLimits(
                f"{robot.name}: its slides' directions lie on one side; jaws on them grip nothing"
            )
        least, most = (float(robot.opening(side, self.jaws).opening) for side in (low, high))
        if not least <= self.opening <= most:
            raise ContradictoryLimits(
                f"an opening of {self.opening:g} m cannot be held: with slides within their limits the jaws "
                f"open from {least:.6g} to {most:.6g} m"
            )
        if self.play is not None and (away := self._least_play(robot, low, high)) > self.play + 1e-9:
            raise ContradictoryLimits(
                f"with slides within their limits the centre of an object of {self.opening:g} m is "
                f"{away:.6g} m or more from O'; play is {self.play:g} m"
            )

    def _least_play(self, robot: Robot, low: Floats, high: Floats) -> float:
        """The least distance of the object's centre from O' within limits of the slides (Lawson and Hanson's
        least distance programming)."""
        from scipy.optimize import nnls

        start = self.centred(robot)
        moves = [
            np.asarray(robot.redundant_of_opening(self.opening, unit, self.jaws)) - start
            for unit in np.eye(2)
        ]
        inward = np.vstack([np.column_stack(moves), -np.column_stack(moves)])
        least = np.concatenate([low - start, start - high])  # inward @ centre >= least
        scale = max(float(np.abs(least).max()), 1e-12)
        table = np.vstack([inward.T, least / scale])
        wanted = np.array([0.0, 0.0, 1.0])
        dual, _ = nnls(table, wanted)
        rest = table @ dual - wanted
        if np.linalg.norm(rest) < 1e-9:  # wherever the centre is, a slide is beyond its limits
            return float(np.inf)
        return float(scale * np.linalg.norm(rest[:2]) / -rest[2])
