"""What the prototype of Section 5.5 can hold, and how hard, over the height of its pivot and the turn of its
jaws.

The jaws stand as far apart as the object is wide, and turn together.  With the prototype's slides along one
line nothing depends on where along it the pivot is.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from krhpr.capability import GraspCapability, GraspCapabilityMap, grasp_capability, grasp_capability_map
from krhpr.grasping import GraspingRobot
from krhpr.study.claims import Claim
from krhpr.study.grasp import PROTOTYPE, Setup, contacts

Floats = NDArray[np.float64]

TORQUE = 0.01
"""Largest torque of a motor's shaft, N m: about what a motor of that size gives for long (not in the
thesis)."""
MOMENT = 1.0
"""The disturbance is a moment about the mass centre of 1 N m, so that its factors are in N m."""
TURNS = np.radians(np.arange(-180, 181, 10))
"""Of both jaws, from those of the setup."""
ROWS = 11
"""Heights for each turn."""
REACH, STEP = 0.2, 0.001
"""Heights are looked for this far above and below the setup's pivot, in such steps, m."""


@dataclass(frozen=True)
class CapabilityStudy:
    """The study's results; arrays have a row for each share of the way up, and a column for each turn."""

    setup: Setup
    torque: float
    turns: Floats
    """(columns,)"""
    heights: Floats
    """(rows, columns) of the pivot, from the lowest to the highest that is within reach and on the setup's
    side of all singularities; NaN where none is."""
    made: GraspCapabilityMap
    at_pose: GraspCapability
    """At the setup's pose."""

    @property
    def moment(self) -> Floats:
        """The largest moment (N m) that is resisted either way, (rows, columns)."""
        return np.minimum(-self.made.scale[..., 0], self.made.scale[..., 1])

    def claims(self) -> list[Claim]:
        """What must hold of any setup."""
        least, most = self.at_pose.grasp_force
        force = self.setup.force
        return [
            Claim(
                f"the grasping force of {force:g} N is among those that are possible at the pose: "
                f"{least:.3g} to {most:.3g} N",
                least <= force <= most,
            )
        ]


def capability_study(
    setup: Setup = PROTOTYPE, torque: float = TORQUE, turns: Floats = TURNS, rows: int = ROWS
) -> CapabilityStudy:
    """Maps over height and turn, and the pose itself."""
    robot = setup.build()
    touch, faces, centre = contacts(setup)
    what: dict[str, Any] = {
        "faces": faces,
        "mass_centre": centre,
        "actuator_limits": torque * setup.drive.ratio / setup.drive.radius,
        "friction": setup.held.friction,
        "weight": [0.0, -setup.held.weight],
        "disturbance": [0.0, 0.0, MOMENT],
    }
    heights = _heights(robot, setup, turns, rows)
    pivot = np.stack([np.full_like(heights, setup.pivot[0]), heights], -1)
    made = grasp_capability_map(robot, (pivot, _angles(setup, turns)), touch, **what)
    found = grasp_capability(robot, (setup.pivot, (setup.phi, setup.beta)), touch, **what)
    return CapabilityStudy(setup, torque, turns, heights, made, found)


def _angles(setup: Setup, turns: Floats) -> Floats:
    return np.array([setup.phi, setup.beta]) + turns[..., None]


def _heights(robot: GraspingRobot, setup: Setup, turns: Floats, rows: int) -> Floats:
    """From the lowest to the highest of the longest piece, for every turn."""
    y = setup.pivot[1] + np.arange(-REACH, REACH + STEP / 2, STEP)
    pivot = np.stack(np.broadcast_arrays(setup.pivot[0], y[:, None]), -1)
    side = _sides(robot, np.array(setup.pivot), _angles(setup, np.array(0.0)))
    within = (_sides(robot, pivot, _angles(setup, turns)) == side).all(axis=-1)
    found = np.full((rows, len(turns)), np.nan)
    for column, good in enumerate(within.T):
        edges = np.flatnonzero(np.diff(np.concatenate([[False], good, [False]])))
        if len(edges):
            first, last = max(edges.reshape(-1, 2).tolist(), key=lambda piece: piece[1] - piece[0])
            found[:, column] = np.linspace(y[first], y[last - 1], rows)
    return found


def _sides(robot: GraspingRobot, pivot: Floats, angles: Floats) -> Floats:
    """On which side of its singularities each sub-leg is, (..., 2); NaN out of reach."""
    s, theta = robot.end_points(pivot, angles), robot.inverse(pivot, angles)
    M = robot.subleg_jacobian(s, theta)
    return np.asarray(np.sign(M[..., 0, 0] * M[..., 1, 1] - M[..., 0, 1] * M[..., 1, 0]))
