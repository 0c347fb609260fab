"""What cannot be asked for: objectives that nobody knows, and limits that nothing can meet."""

from __future__ import annotations

from krhpr.errors import TrajectoryError


class UnknownObjective(TrajectoryError):
    """No objective has this name, or its weights are none."""


class ContradictoryLimits(TrajectoryError):
    """Limits that nothing can meet, or that are not the robot's."""
