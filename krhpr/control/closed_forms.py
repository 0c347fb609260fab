"""What the schemes come to where nothing moves, in closed form; the simulation is held against it.

Turning one jaw into the object by e, or pressing with a grasping force f_g, loads the actuators with
f_g h v where v = A^-T g, A = K_n^-1 J_n, g = [0, 0, 1, -1]^T: the forces of a unit moment between the jaws.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from krhpr.control.controller import ENOUGH_FRICTION
from krhpr.control.parameters import ControlSetup
from krhpr.grasping import GraspingRobot
from krhpr.study.grasp import Setup, contacts

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Grip:
    """A robot's grip on an object whose weight is parallel to the jaws, in one pose."""

    per_moment: Floats
    """v (4,): forces of the actuators for a unit moment between the jaws (1/m)."""
    per_angle: Floats
    """(4,): how the actuators move where the right jaw is turned into the object (m/rad)."""
    of_weight: Floats
    """(4,): forces of the actuators that carry the object's weight alone (N)."""
    height: float
    """h (m)."""
    position_stiffness: float
    """k_p (N/m)."""
    contact_stiffness: float
    """Of both contacts one behind the other (N/m)."""

    @property
    def rigid_stiffness(self) -> float:
        """k of (5.72) for a rigid object (N/rad): k_p / (h |v|^2)."""
        return float(self.position_stiffness / (self.height * (self.per_moment**2).sum()))

    def stiffness(self, load_share: float = 0.0) -> float:
        """k of (5.72) with contacts that give, in series with k_c h (N/rad): f_g = k e.

        With friction that takes its share of the load it is the slope with which f_g grows: friction adds to
        the actuators that push, and takes from those that are pushed (`drag`).
        """
        give = 1.0 / (self.contact_stiffness * self.height)
        return 1.0 / ((1.0 + self.drag * load_share) / self.rigid_stiffness + give)

    @property
    def sag(self) -> float:
        """By how much the jaws open under the object's weight in scheme i (rad): f_g = k (e - sag)."""
        return float(self.per_moment @ self.of_weight / self.position_stiffness)

    @property
    def drag(self) -> float:
        """Between -1 and 1: which share of the friction works against the grip while scheme i turns the right
        jaw into the object.  Negative: the actuators that are pushed back are held by their friction.
        """
        frictionless = 1.0 / (1.0 / self.rigid_stiffness + 1.0 / (self.contact_stiffness * self.height))
        bent = frictionless * self.height * self.per_moment / self.position_stiffness
        moving = np.sign(self.per_angle - bent)
        size = np.abs(self.per_moment)
        return float((self.per_moment * size * moving).sum() / (size**2).sum())

    def dead_band(self, coulomb: float) -> float:
        """By which grasping force Coulomb's friction of all actuators lowers or raises another (N)."""
        per_force = np.abs(self.per_moment) * self.height
        return float(coulomb * per_force.sum() / (per_force**2).sum())

    @property
    def held_back(self) -> float:
        """How much of the grasping force position control takes back in scheme ii where the contacts give:
        f_g = f_d / (1 + held_back), without friction.
        """
        return self.rigid_stiffness / (self.contact_stiffness * self.height)

    def band(self, wanted: float, coulomb: float, load_share: float, stiction: float) -> tuple[float, float]:
        """Between which grasping forces scheme ii can come to rest: friction holds each actuator up to
        stiction (coulomb + load_share |f|) to either side.
        """
        dry = stiction * self.dead_band(coulomb)
        share = stiction * load_share
        least = (wanted - dry) / (1.0 + self.held_back + share)
        most = (wanted + dry) / max(1.0 + self.held_back - share, 0.0)
        return max(least, 0.0), most


def grip_of(robot: GraspingRobot, setup: Setup, control: ControlSetup) -> Grip:
    """The grip in the pose of a setup."""
    pivot, angles = np.array(setup.pivot), np.array([setup.phi, setup.beta])
    theta = robot.inverse(pivot, angles, check=True)
    s = robot.end_points(pivot, angles)
    touch, faces, mass_centre = contacts(setup)
    loads = [
        robot.grasp(
            angles,
            touch,
            faces,
            setup.force,
            weight=[0.0, weight],
            mass_centre=mass_centre,
            friction=ENOUGH_FRICTION,
            check=True,
        ).loads
        for weight in (0.0, -setup.held.weight)
    ]
    turning = [np.sign(np.sin(setup.beta - setup.phi)), 0.0]
    return Grip(
        per_moment=np.ravel(robot.inverse_statics_n(pivot, s, theta, [0.0, 0.0, 1.0, -1.0], check=True)),
        per_angle=np.ravel(robot.joint_rates(pivot, s, theta, [0.0, 0.0], turning, check=True)),
        of_weight=np.ravel(robot.inverse_statics_n(pivot, s, theta, loads[1] - loads[0], check=True)),
        height=setup.held.height,
        position_stiffness=control.position.stiffness,
        contact_stiffness=control.contact.stiffness / 2,
    )


@dataclass(frozen=True)
class Line:
    """A straight line y = slope x + offset, and by how much points are away from it at most."""

    slope: float
    offset: float
    away: float


def line(x: Floats, y: Floats) -> Line:
    """The line that is nearest to points."""
    a, b = np.polyfit(x, y, 1)
    return Line(float(a), float(b), float(np.abs(a * x + b - y).max()))


def settled(times: Floats, values: Floats, aim: float, tolerance: float) -> float:
    """How long values take to come within a tolerance of an aim for good; infinity where they do not."""
    outside = np.flatnonzero(np.abs(values - aim) > tolerance)
    if len(outside) == 0:
        return 0.0
    last = int(outside[-1])
    return float(times[last + 1] - times[0]) if last + 1 < len(times) else float("inf")
