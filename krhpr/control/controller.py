"""One step of the control schemes i, ii and iii of Section 5.5, on the generated functions alone (Fig. 5.8).

    error     e = theta_d - theta                     theta_d: `inverse` of the wanted pose
    position  f_p = k_p e + k_d e_dot                   PD at the belt; e_dot a filtered difference
    force     f = f_d + K_p (f_d - f_m) + K_i int (f_d - f_m) - K_d f_m_dot    PID, scheme iii alone
    statics   f_s = `inverse_statics_n`(`grasp`(f))     at the pose that `forward` finds; schemes ii and iii
    torques   tau = r / N (f_p + f_s), within the motor's limit

f_m is the measured grasping force, f_d the wanted one; both are of the jaw from which the weight pulls the
object away, (5.70), which `grasp` tells by its `pulls`.  The same step exists in generated C
(krhpr_<robot>_control.c, `CompiledController`), equal to rounding.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from krhpr.control.parameters import ControlSetup, Scheme
from krhpr.control.plant import Branch
from krhpr.errors import ControlError
from krhpr.grasping import GraspingRobot
from krhpr.study.grasp import Setup, contacts

Floats = NDArray[np.float64]

ENOUGH_FRICTION = 1e6
"""The static model takes friction to hold the object, as the thesis does; the simulation tells how much."""


@dataclass(frozen=True)
class Wanted:
    """What the robot is told: where to be, and how hard to grasp."""

    pivot: Floats
    angles: Floats
    grasp_force: float


class Steps(Protocol):
    """A controller: it keeps its own state from step to step."""

    def reset(self) -> None:
        """Forget all that was."""

    def step(self, wanted: Wanted, theta: Floats, measured_force: float) -> Floats:
        """Torques (2, 2) of the motors from the measured joints (2, 2) and the measured grasping force."""


class Controller:
    """The schemes in Python."""

    def __init__(
        self, robot: GraspingRobot, setup: Setup, control: ControlSetup, scheme: Scheme, branch: Branch
    ) -> None:
        self.robot, self.setup, self.control = robot, setup, control
        self.scheme, self.branch = Scheme(scheme), branch
        self._touch, self._faces, self._mass_centre = contacts(setup)
        self._weight = np.array([0.0, -setup.held.weight])
        self._transmission = setup.drive.radius / setup.drive.ratio
        self.reset()

    def reset(self) -> None:
        """Forget all that was."""
        self._started = False
        self._error, self._error_rate = np.zeros((2, 2)), np.zeros((2, 2))
        self._force = self._integral = 0.0

    def step(self, wanted: Wanted, theta: Floats, measured_force: float) -> Floats:
        """Torques (2, 2) of the motors.

        Raises:
            Unreachable, Singular, NoGrasp: the wanted or the measured pose has no answer.
            ControlError: something measured is not a number.  Nothing is kept of such a step.
        """
        if not np.isfinite([*np.ravel(theta), measured_force, wanted.grasp_force]).all():
            raise ControlError(
                f"joints {np.ravel(theta)}, measured {measured_force:g} N, wanted {wanted.grasp_force:g} N: "
                "all must be finite"
            )
        error = self.robot.inverse(wanted.pivot, wanted.angles, check=True) - theta
        force, integral = self._force, self._integral
        if not self._started:
            self._error, force = error, measured_force
        period, gains = self.control.period, self.control.position
        blend = period / (period + gains.filter_time)
        rate = self._error_rate + blend * ((error - self._error) / period - self._error_rate)
        belt = gains.stiffness * error + gains.damping * rate
        command = wanted.grasp_force
        if self.scheme is Scheme.COMBINED:
            pid = self.control.force
            change = period / (period + pid.filter_time) * (measured_force - force)
            force += change
            lacking = wanted.grasp_force - force
            integral = min(max(integral + pid.integral * period * lacking, -pid.most), pid.most)
            command += pid.proportional * lacking + integral - pid.derivative * (change / period)
        if self.scheme is not Scheme.POSITION:
            command = min(max(command, self.control.force.least), self.control.force.most)
            belt = belt + self.static_forces(theta, command)
        self._started = True
        self._error, self._error_rate, self._force, self._integral = error, rate, force, integral
        limit = self.control.motor.torque_limit
        torques: Floats = np.clip(self._transmission * belt, -limit, limit)
        return torques

    def static_forces(self, theta: Floats, grasp_force: float) -> Floats:
        """Forces (2, 2) of the actuators that hold the object with a grasping force, (5.38) to (5.44)."""
        robot, branch = self.robot, self.branch
        signs = [[branch.assembly[0]], [branch.assembly[1]]]
        pose = robot.forward(theta, signs, side=branch.side, check=True)
        held = self._grasp(pose.angles, grasp_force, "lo")
        if held.pulls[0] > held.pulls[1]:  # the weight pulls it away from the right jaw
            held = self._grasp(pose.angles, grasp_force, "ro")
        s = robot.end_points(pose.pivot, pose.angles)
        forces: Floats = robot.inverse_statics_n(pose.pivot, s, theta, held.loads, check=True)
        return forces

    def _grasp(self, angles: Floats, force: float, measured: str) -> Any:
        return self.robot.grasp(
            angles,
            self._touch,
            self._faces,
            force,
            measured,
            weight=self._weight,
            mass_centre=self._mass_centre,
            friction=ENOUGH_FRICTION,
            check=True,
        )
