"""Volumes under refinement: what coarser maps say of the workspaces of Section 1.7, and of their errors."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from krhpr import workspace
from krhpr.robot import Robot
from krhpr.workspace import Measure, Redundancy, WorkspaceLimits

MILLIMETRE, DEGREE = 1e-3, np.pi / 180
LOW, HIGH = 0.05, 0.6
"""Heights of the first and of the last layer (m)."""
LAYERS = 110
"""Between them, for steps of 1 mm and 1 degree: every 5 mm."""
STEPS = (2, 3, 4, 6, 8, 12)
"""How many times wider steps are than 1 mm and 1 degree."""


@dataclass(frozen=True)
class Refinement:
    """Both volumes by maps of one step."""

    times: int
    """Steps of so many millimetres and degrees, layers every 5 times as many millimetres."""
    positions: Measure
    orientations: Measure


def convergence(
    robot: Robot,
    limits: WorkspaceLimits,
    redundancy: Redundancy,
    *,
    times: Sequence[int] = STEPS,
    farthest: float = 1.0,
    progress: Callable[[int, int], None] | None = None,
) -> tuple[Refinement, ...]:
    """The volumes with each step, which divides 360."""
    found = []
    for n in times:
        layers = workspace.translational(
            robot,
            np.linspace(LOW, HIGH, max(2, round(LAYERS / n)) + 1),
            limits=limits,
            redundancy=redundancy,
            step=n * MILLIMETRE,
            rays=360 // n,
            farthest=farthest,
        )
        tilts = workspace.orientational(
            robot, limits=limits, redundancy=redundancy, step=n * DEGREE, rays=360 // n
        )
        found.append(Refinement(n, workspace.volume(layers), workspace.volume(tilts)))
        if progress is not None:
            progress(len(found), len(times))
    return tuple(found)
