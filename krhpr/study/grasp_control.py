"""Section 5.5 as closed-loop simulations: the grasping force under the control schemes i, ii and iii.

Schemes i and ii are led slowly from one input to the next and held there (Figs. 5.7, 5.9); ii a second time
without friction in the gears.  Scheme iii gets a step (Fig. 5.10), and holds the object along the
trajectories (5.73) to (5.75) (Fig. 5.11).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from krhpr.control.closed_forms import Grip, Line, grip_of, line, settled
from krhpr.control.compiled_controller import CompiledController
from krhpr.control.controller import Controller, Steps, Wanted
from krhpr.control.parameters import PROTOTYPE as CONTROL
from krhpr.control.parameters import ControlSetup, Scheme
from krhpr.control.plant import Plant
from krhpr.control.simulation import Trace, simulate
from krhpr.study.claims import Claim
from krhpr.study.grasp import PROTOTYPE, Motion, Setup

Floats = NDArray[np.float64]

RAMP, HOLD, LOOK = 1.5, 0.6, 0.2
"""Seconds from one input to the next, how long it is held, and over which last part of that is averaged."""
SHARES = (0.25, 0.5, 0.75, 1.0, 1.25, 1.5)
"""Inputs of schemes i and ii, as shares of the grasping force of the setup."""
BEFORE, AFTER = 0.2, 2.0
"""Seconds before and after the step."""
SETTLING = 1.0
"""Seconds of rest before a trajectory begins."""


@dataclass(frozen=True)
class Loop:
    """A plant, and who controls it."""

    plant: Plant
    make: Callable[[Plant, Scheme], Steps]

    def run(self, scheme: Scheme, reference: Callable[[float], Wanted], duration: float) -> Trace:
        """One run under a scheme."""
        return simulate(self.plant, self.make(self.plant, scheme), reference, duration)


def in_python(plant: Plant, scheme: Scheme) -> Steps:
    """The controller in Python."""
    return Controller(plant.robot, plant.setup, plant.control, scheme, plant.branch)


def in_c(plant: Plant, scheme: Scheme) -> Steps:
    """The generated controller in C, compiled."""
    return CompiledController(plant.robot, plant.setup, plant.control, scheme, plant.branch)


CONTROLLERS: dict[str, Callable[[Plant, Scheme], Steps]] = {"python": in_python, "c": in_c}


@dataclass(frozen=True)
class Staircase:
    """Inputs one after the other, and the grasping force that each came to."""

    inputs: Floats
    forces: Floats
    trace: Trace

    @property
    def line(self) -> Line:
        """The straight line through the inputs and their forces."""
        return line(self.inputs, self.forces)


@dataclass(frozen=True)
class Along:
    """A trajectory under scheme iii; times begin with the motion."""

    motion: Motion
    trace: Trace

    @property
    def moving(self) -> slice:
        """The rows in which the robot moves."""
        return slice(int(np.searchsorted(self.trace.times, SETTLING)), None)

    @property
    def error(self) -> Floats:
        """Of the true grasping force while moving."""
        rows = self.moving
        error: Floats = self.trace.seen.grasp_force[rows] - self.trace.wanted_force[rows]
        return error

    @property
    def friction_needed(self) -> float:
        """Largest coefficient of friction that the contacts need; infinite where one does not press."""
        return float(self.trace.seen.friction[self.moving].max())

    @property
    def position_error(self) -> float:
        """Largest distance of the pivot from where it should be (m)."""
        rows = self.moving
        away = self.trace.seen.pivot[rows] - self.trace.wanted_pivot[rows]
        return float(np.linalg.norm(away, axis=-1).max())


@dataclass(frozen=True)
class GraspControl:
    """The study's results."""

    setup: Setup
    control: ControlSetup
    grip: Grip
    position: Staircase
    feedforward: Staircase
    easy_position: Staircase
    """Scheme i without friction in the gears."""
    easy_feedforward: Staircase
    """Scheme ii without it."""
    step: Trace
    along: tuple[Along, ...]

    @property
    def expected_slope(self) -> float:
        """k of (5.72) in closed form where the gears rub: slowly, so that friction is that at rest."""
        friction = self.control.friction
        return self.grip.stiffness(friction.load_share * friction.stiction)

    @property
    def settling(self) -> float:
        """How long the step takes to come within a twentieth of the reference for good (s)."""
        after = self.step.between(BEFORE, np.inf)
        force, aim = self.step.seen.grasp_force[after], self.setup.force
        return settled(self.step.times[after], force, aim, aim / 20)

    @property
    def step_error(self) -> float:
        """Mean error of the last second of the step (N)."""
        last = self.step.between(BEFORE + AFTER - 1.0, np.inf)
        return float((self.step.seen.grasp_force - self.step.wanted_force)[last].mean())

    def claims(self) -> list[Claim]:
        """What the thesis measured, and whether it came out."""
        aim = self.setup.force
        inputs, forces = self.feedforward.inputs, self.feedforward.forces
        ideal = inputs / (1 + self.grip.held_back)
        return [
            Claim(
                "scheme i: the grasping force is near-linear in the angle error (Fig. 5.7)",
                self.position.line.away < 0.05 * aim,
            ),
            Claim(
                "(5.72): its slope is that of the closed form within 10 %, and without friction within 3 %",
                abs(self.position.line.slope / self.expected_slope - 1) < 0.1
                and abs(self.easy_position.line.slope / self.grip.stiffness() - 1) < 0.03,
            ),
            Claim(
                "scheme ii: far below the reference, because of friction (Fig. 5.9)",
                bool((forces < 0.75 * inputs).all()),
            ),
            Claim(
                "scheme ii without friction: on the reference, but for what the contacts give",
                bool(np.abs(self.easy_feedforward.forces - ideal).max() < 0.02 * aim),
            ),
            Claim(
                "scheme iii: a step settles within half a second and leaves no error (Fig. 5.10)",
                self.settling < 0.5 and abs(self.step_error) < 0.01 * aim,
            ),
            *(
                Claim(
                    f"scheme iii: on the reference along {one.motion.name} (Fig. 5.11)",
                    bool(np.sqrt((one.error**2).mean()) < 0.05 * aim),
                )
                for one in self.along
            ),
            Claim(
                "scheme iii: friction on the faces holds the object along the trajectories",
                all(one.friction_needed < self.setup.held.friction for one in self.along),
            ),
        ]


def grasp_control(
    setup: Setup = PROTOTYPE,
    control: ControlSetup = CONTROL,
    make: Callable[[Plant, Scheme], Steps] = in_python,
) -> GraspControl:
    """Run every simulation.

    Raises:
        ControlError: the object does not fit, or the plant cannot be integrated.
        Unreachable, Singular, NoGrasp: a controller has no answer.
    """
    robot = setup.build()
    loop = Loop(Plant(setup, control, robot), make)
    smooth = replace(control, friction=replace(control.friction, torque=0.0, load_share=0.0, viscous=0.0))
    easy = Loop(Plant(setup, smooth, robot), make)
    grip = grip_of(robot, setup, control)
    forces = setup.force * np.array(SHARES)
    angles = forces / grip.stiffness()
    return GraspControl(
        setup,
        control,
        grip,
        position_staircase(loop, angles),
        force_staircase(loop, forces),
        position_staircase(easy, angles),
        force_staircase(easy, forces),
        step_response(loop),
        tuple(along(loop, motion) for motion in setup.motions),
    )


def position_staircase(loop: Loop, angles: Sequence[float] | Floats) -> Staircase:
    """Scheme i: phi is told to be larger by these angles than the object lets it."""
    pivot, held = _pose(loop.plant.setup)
    closing = np.array([1.0, 0.0]) * _closing(loop.plant.setup)
    return _staircase(loop, Scheme.POSITION, angles, lambda value: Wanted(pivot, held + value * closing, 0.0))


def force_staircase(loop: Loop, forces: Sequence[float] | Floats) -> Staircase:
    """Scheme ii: these grasping forces are wanted."""
    pivot, held = _pose(loop.plant.setup)
    return _staircase(loop, Scheme.FEEDFORWARD, forces, lambda value: Wanted(pivot, held, value))


def step_response(loop: Loop) -> Trace:
    """Scheme iii: the grasping force is wanted at once."""
    setup = loop.plant.setup
    pivot, held = _pose(setup)
    return loop.run(
        Scheme.COMBINED,
        lambda t: Wanted(pivot, held, setup.force if t >= BEFORE - 1e-9 else 0.0),
        BEFORE + AFTER,
    )


def along(loop: Loop, motion: Motion, duration: float | None = None) -> Along:
    """Scheme iii along a motion, after a second of rest."""
    setup = loop.plant.setup

    def wanted(t: float) -> Wanted:
        pivot, angles = setup.poses(motion, np.array([max(t - SETTLING, 0.0)]))
        return Wanted(pivot[0], angles[0], setup.force)

    length = setup.duration if duration is None else duration
    return Along(motion, loop.run(Scheme.COMBINED, wanted, SETTLING + length))


def _staircase(
    loop: Loop, scheme: Scheme, inputs: Sequence[float] | Floats, wanted: Callable[[float], Wanted]
) -> Staircase:
    values = np.asarray(inputs, dtype=float)
    length = RAMP + HOLD
    corners = np.concatenate([[length * k, length * k + RAMP] for k in range(len(values))])
    heights = np.concatenate([[0.0], np.repeat(values, 2)[:-1]])
    trace = loop.run(
        scheme,
        lambda t: wanted(float(np.interp(t, corners, heights))),
        length * len(values),
    )
    forces = [
        trace.seen.grasp_force[trace.between(length * (k + 1) - LOOK, length * (k + 1))].mean()
        for k in range(len(values))
    ]
    return Staircase(values, np.array(forces), trace)


def _pose(setup: Setup) -> tuple[Floats, Floats]:
    return np.array(setup.pivot), np.array([setup.phi, setup.beta])


def _closing(setup: Setup) -> float:
    """Which way the right jaw turns into the object: up where gamma is below 180 deg."""
    return float(np.sign(np.sin(setup.beta - setup.phi)))
