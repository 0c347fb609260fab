"""The planar grasping robot with an object between its jaws, as it moves: Lagrange's equations in CasADi.

The four actuators have the masses of their motors, links and jaws have none, and the object is a point mass
in the middle between its two contacts.  Positions come from the generated `forward`; forces are gradients of
energies, so that nothing of the static model, on which the controllers are built, has a part in it:

    M theta_ddot + m G^T (G theta_dot)' = u - friction + P d(distance)/d(theta) - G^T m g,
    M = mass I + m G^T G,   G = d(mass centre)/d(theta),   P = stiffness/2 delta (1 + damping delta_dot)

with u the forces of the motors at the belts and delta what the distance of the contacts lacks of the object's
width.  Friction on the faces is taken to hold the object there, as the thesis does (after Fig. 5.3);
`Observation.friction` says how much it takes.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from itertools import product
from math import ceil, log2, sqrt
from typing import Any

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from krhpr.control.parameters import ControlSetup
from krhpr.errors import ControlError, KrhprError
from krhpr.grasping import GraspingRobot
from krhpr.study.grasp import Setup, contacts

Floats = NDArray[np.float64]

GRAVITY = 9.80665
ACTUATORS = 4
STATES = 3 * ACTUATORS
"""theta, theta_dot, and the bend of the gears' bristles; each a row for each sub-leg, flat."""

STEPS_PER_RADIAN = 8.0
"""Of the integrator (Runge-Kutta, fourth order) for the quickest oscillation of contacts and bristles."""
STEPS_PER_BEND = 0.5
"""And while an actuator slides as far as its bristles bend: stable, and exact where it slides steadily; where
it turns round it is slow, and the bristles are followed closely."""
MOST_STEPS = 4096
"""In one period of the controller."""
OPENED = np.radians(1.0)
"""The jaws must open by so much beyond the object."""


@dataclass(frozen=True)
class Branch:
    """Which of the eight solutions of the forward kinematics the robot is assembled in."""

    assembly: tuple[float, float]
    side: float


@dataclass(frozen=True)
class Observation:
    """What the plant shows in one state; the first axis is time where there are several."""

    pivot: Floats
    angles: Floats
    normal_forces: Floats
    """(..., 2): of the right and the left jaw on the object (N)."""
    grasp_force: Floats
    """The normal force of the jaw from which the weight pulls the object away, (5.70)."""
    compression: Floats
    """delta; negative where the jaws do not touch the object (m)."""
    friction: Floats
    """Coefficient of friction that the contacts need; infinite where a jaw does not press."""
    energy: Floats
    """Kinetic, of contacts, of bristles, and of the object's weight (J)."""


def branch_of(robot: GraspingRobot, pivot: Floats, angles: Floats) -> Branch:
    """The branch of the forward kinematics that leads back to a pose.

    Raises:
        ControlError: none does, as at a singular pose.
    """
    theta = robot.inverse(pivot, angles)
    for first, second, side in product((1.0, -1.0), repeat=3):
        found = robot.forward(theta, [[first], [second]], side=side)
        wrong = np.abs(np.r_[found.pivot - pivot, np.sin((found.angles - angles) / 2)]).max()
        if wrong < 1e-6 * max(1.0, float(np.abs(pivot).max())):
            return Branch((first, second), side)
    raise ControlError("no solution of the forward kinematics leads back to the pose; it is singular")


def check_grasp(robot: GraspingRobot, setup: Setup) -> None:
    """Whether the object goes between the jaws, and the robot reaches it and can open beyond it.

    The widest that jaws open is the distance of their ends P and S where they are aligned, b + l.

    Raises:
        ControlError: what is out of reach, or that the object is too wide.
    """
    pivot, angles = np.array(setup.pivot), np.array([setup.phi, setup.beta])
    width, lengths = setup.held.width, robot.geometry.fields["l_j"]
    if not width < sum(lengths):
        jaws = " and ".join(f"{1e3 * length:g}" for length in lengths)
        raise ControlError(
            f"the object is wider than the jaws open: {1e3 * width:g} mm, and jaws of {jaws} mm open to less "
            f"than {1e3 * sum(lengths):g} mm"
        )
    gamma = angles[1] - angles[0]
    if abs(np.sin(gamma)) < np.sin(OPENED):
        raise ControlError(
            f"the jaws are aligned at the pose with the object (gamma is {np.degrees(gamma):.3g} deg)"
        )
    try:
        robot.inverse(pivot, angles, check=True)
    except KrhprError as error:
        raise ControlError(f"the pose with the object is out of reach: {error}") from error
    try:
        robot.inverse(pivot, angles + np.sign(np.sin(gamma)) * OPENED / 2 * np.array([-1.0, 1.0]), check=True)
    except KrhprError as error:
        raise ControlError(
            f"the jaws do not open beyond the object: opened by {np.degrees(OPENED):g} deg, {error}"
        ) from error


class _Called:
    """A function (state, forces) -> (state, number) without the detour over CasADi's matrices."""

    def __init__(self, function: Any) -> None:
        # the buffer works for as long as it and the arrays are there
        self._buffer, self._trigger = function.buffer()
        self._given = np.zeros(STATES), np.zeros(ACTUATORS)
        self._found = np.zeros(STATES), np.zeros(1)
        for place, (argument, result) in enumerate(zip(self._given, self._found, strict=True)):
            self._buffer.set_arg(place, argument.data)
            self._buffer.set_res(place, result.data)

    def __call__(self, state: Floats, force: Floats) -> tuple[Floats, float]:
        self._given[0][:], self._given[1][:] = state, force
        self._trigger()
        return self._found[0].copy(), float(self._found[1][0])


class Plant:
    """The plant; states are arrays (12,), forces of the motors are at the belts, (4,)."""

    def __init__(self, setup: Setup, control: ControlSetup, robot: GraspingRobot | None = None) -> None:
        self.setup, self.control = setup, control
        self.robot = setup.build() if robot is None else robot
        check_grasp(self.robot, setup)
        self.branch = branch_of(self.robot, np.array(setup.pivot), np.array([setup.phi, setup.beta]))
        self.mass = control.mass(setup.drive)
        self.object_mass = setup.held.weight / GRAVITY
        self._state, self._force = ca.SX.sym("state", STATES), ca.SX.sym("force", ACTUATORS)
        self._build()

    # -- use ------------------------------------------------------------------------------------------------

    def at_rest(self, pivot: Floats, angles: Floats) -> Floats:
        """The state of rest at a pose, with bristles that are not bent."""
        theta = self.robot.inverse(pivot, angles, check=True)
        return np.concatenate([np.ravel(theta), np.zeros(2 * ACTUATORS)])

    def observe(self, state: Floats, force: Floats) -> Observation:
        """What can be seen in a state, with these forces of the motors (contact forces depend on them)."""
        values = [np.array(value.full()).ravel() for value in self._observe(state, force)]
        pivot, angles, normal, grasp, compression, friction, energy = values
        return Observation(pivot, angles, normal, grasp[0], compression[0], friction[0], energy[0])

    def observe_all(self, states: Floats, forces: Floats) -> Observation:
        """The same along a path: states (n, 12), forces (n, 4)."""
        mapped = self._observe.map(len(states))
        values = [np.array(value.full()).T for value in mapped(states.T, forces.T)]
        pivot, angles, normal, grasp, compression, friction, energy = values
        return Observation(
            pivot, angles, normal, grasp[:, 0], compression[:, 0], friction[:, 0], energy[:, 0]
        )

    def grasp_force(self, state: Floats, force: Floats) -> float:
        """The true grasping force."""
        return float(self._grasp_force(state, force))

    def rates(self, state: Floats, force: Floats) -> Floats:
        """The time derivative of a state."""
        return np.array(self._rates(state, force).full()).ravel()

    def advance(self, state: Floats, force: Floats) -> tuple[Floats, float]:
        """One period of the controller later, with forces that stay as they are: the state, and the true
        grasping force there.

        Raises:
            ControlError: the plant is too quick, or the robot has come out of its reach.
        """
        after, grasp_force = self._over_a_period(self._steps(state))(state, force)
        if not np.isfinite(after).all():
            raise ControlError(f"the motion leaves the robot's reach, near theta = {state[:ACTUATORS]} m")
        return after, grasp_force

    # -- equations ------------------------------------------------------------------------------------------

    def _build(self) -> None:
        x, u = self._state, self._force
        rates = x[ACTUATORS : 2 * ACTUATORS]
        acceleration = self._acceleration
        self._power = ca.cse(ca.vertcat(rates, acceleration, self._friction[1]))
        self._rates = ca.Function("rates", [x, u], [self._power])
        self._integrators: dict[int, _Called] = {}
        pivot, angles = self._pose
        right, left = self._contacts
        along = (right - left) / self._distance
        # what each jaw bears of the object's weight and inertia, the half of it
        centre_acceleration = self._centre_jacobian @ acceleration + self._centre_drift
        share = self.object_mass * (centre_acceleration + ca.DM([0.0, GRAVITY])) / 2
        normal = ca.vertcat(self._press - ca.dot(share, along), self._press + ca.dot(share, along))
        parallel = ca.dot(share, ca.vertcat(-along[1], along[0]))
        pulled_left = self.object_mass * -GRAVITY * along[1] >= 0  # the weight presses on the right jaw
        grasp = ca.if_else(pulled_left, normal[1], normal[0])
        friction = ca.if_else(ca.mmin(normal) > 0, ca.fabs(parallel) / ca.mmin(normal), ca.inf)
        self._observe = ca.Function(
            "observe",
            [x, u],
            [pivot, angles, normal, grasp, self._compression, friction, self._energy],
        )
        self._grasp_force = ca.Function("grasp_force", [x, u], [grasp])

    def _steps(self, state: Floats) -> int:
        """How many steps the integrator takes in a period: a power of two, so that few are ever made."""
        speed = float(np.abs(state[ACTUATORS : 2 * ACTUATORS]).max())
        gear = self.control.friction
        per_second = max(
            STEPS_PER_RADIAN * self._quickest,
            STEPS_PER_BEND * speed / gear.presliding if gear.slides else 0.0,
            gear.viscous / self.mass,
        )
        needed = self.control.period * per_second
        if not needed <= MOST_STEPS:
            raise ControlError(
                f"the plant is too quick to be integrated: {needed:.3g} steps in a period of "
                f"{1e3 * self.control.period:g} ms (at most {MOST_STEPS}); look at the stiffness of the "
                "contacts, the bend of the gears' bristles (presliding), and the motors' inertia"
            )
        return 1 << max(0, ceil(log2(needed)))

    @cached_property
    def _quickest(self) -> float:
        """Angular frequency of the grip on contacts and bristles, about (rad/s)."""
        pose = self.at_rest(np.array(self.setup.pivot), np.array([self.setup.phi, self.setup.beta]))
        gradient = ca.Function("gradient", [self._state], [self._opening])(pose)
        stiffness = self.control.contact.stiffness / 2 * float(ca.sumsqr(gradient))
        gear = self.control.friction
        bristles = self.control.coulomb(self.setup.drive) / gear.presliding
        return sqrt((stiffness + bristles) / self.mass)

    def _over_a_period(self, steps: int) -> _Called:
        """The integrator with so many steps, made on first use."""
        if steps not in self._integrators:
            begin, held = ca.MX.sym("begin", STATES), ca.MX.sym("held", ACTUATORS)
            equations = {"x": self._state, "p": self._force, "ode": self._power}
            options = {"number_of_finite_elements": steps}
            one = ca.integrator("plant", "rk", equations, 0.0, self.control.period, options)
            after = one(x0=begin, p=held)["xf"]
            self._integrators[steps] = _Called(
                ca.Function("advance", [begin, held], [after, self._grasp_force(after, held)])
            )
        return self._integrators[steps]

    @cached_property
    def _pose(self) -> tuple[Any, Any]:
        theta = self._state[:ACTUATORS].reshape((2, 2)).T
        found = self.robot.casadi.forward(theta=theta, assembly=self.branch.assembly, side=self.branch.side)
        return found["pivot"], found["angles"]

    @cached_property
    def _contacts(self) -> tuple[Any, Any]:
        """Of the right and the left jaw, fixed in them."""
        pivot, angles = self._pose
        touch, _, _ = contacts(self.setup)
        found = []
        for jaw, (x, y) in enumerate(touch):
            c, s = ca.cos(angles[jaw]), ca.sin(angles[jaw])
            found.append(pivot + ca.vertcat(c * x - s * y, s * x + c * y))
        return found[0], found[1]

    @cached_property
    def _distance(self) -> Any:
        right, left = self._contacts
        return ca.norm_2(right - left)

    @cached_property
    def _compression(self) -> Any:
        """delta."""
        return self.setup.held.width - self._distance

    @cached_property
    def _opening(self) -> Any:
        """d(distance)/d(theta)."""
        return ca.gradient(self._distance, self._state[:ACTUATORS])

    @cached_property
    def _press(self) -> Any:
        """P, with which the object presses the contacts apart."""
        contact = self.control.contact
        rate = -ca.dot(self._opening, self._state[ACTUATORS : 2 * ACTUATORS])
        spring = contact.stiffness / 2 * ca.fmax(self._compression, 0.0)
        return spring * ca.fmax(1.0 + contact.damping * rate, 0.0)

    @cached_property
    def _centre(self) -> Any:
        right, left = self._contacts
        return (right + left) / 2

    @cached_property
    def _centre_jacobian(self) -> Any:
        return ca.jacobian(self._centre, self._state[:ACTUATORS])

    @cached_property
    def _centre_drift(self) -> Any:
        """The mass centre's acceleration where those of the actuators are zero."""
        theta, rates = self._state[:ACTUATORS], self._state[ACTUATORS : 2 * ACTUATORS]
        return ca.jtimes(self._centre_jacobian @ rates, theta, rates)

    @cached_property
    def _load(self) -> Any:
        """Forces of the object and its weight on the actuators."""
        weight = ca.DM([0.0, -self.object_mass * GRAVITY])
        return self._press * self._opening + self._centre_jacobian.T @ weight

    @cached_property
    def _friction(self) -> tuple[Any, Any]:
        """Friction of the gears, and the rates of their bristles."""
        gear, rates, bend = self.control.friction, self._state[4:8], self._state[8:]
        viscous = gear.viscous * rates
        if not gear.slides:
            return viscous, ca.DM.zeros(ACTUATORS)
        coulomb = self.control.coulomb(self.setup.drive)
        sigma = coulomb / gear.presliding
        at_rest = 1.0 + (gear.stiction - 1.0) * ca.exp(-((rates / gear.stribeck_speed) ** 2))
        most = (coulomb + gear.load_share * ca.fabs(self._load)) * at_rest
        return sigma * bend + viscous, rates - sigma * ca.fabs(rates) * bend / most

    @cached_property
    def _acceleration(self) -> Any:
        jacobian, mass = self._centre_jacobian, self.object_mass
        force = self._force - self._friction[0] + self._load - mass * jacobian.T @ self._centre_drift
        # (mass I + m G^T G)^-1 with a 2 x 2 inverse instead of a 4 x 4 one (Woodbury)
        inner = self.mass * ca.DM.eye(2) + mass * jacobian @ jacobian.T
        return (force - mass * jacobian.T @ ca.solve(inner, jacobian @ force)) / self.mass

    @cached_property
    def _energy(self) -> Any:
        rates, bend = self._state[4:8], self._state[8:]
        velocity = self._centre_jacobian @ rates
        kinetic = (self.mass * ca.sumsqr(rates) + self.object_mass * ca.sumsqr(velocity)) / 2
        spring = self.control.contact.stiffness / 4 * ca.fmax(self._compression, 0.0) ** 2
        gear = self.control.friction
        sigma = self.control.coulomb(self.setup.drive) / gear.presliding
        return kinetic + spring + self.object_mass * GRAVITY * self._centre[1] + sigma * ca.sumsqr(bend) / 2
