"""The prototype of Section 5.5 with an object in its jaws: what its actuators and motors give along the
trajectories (5.73) to (5.75) for a wanted grasping force.

Forces are static: inertia is a thousandth of a newton there (errata).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from math import radians

import numpy as np
from numpy.typing import NDArray

from krhpr.generated.python.runtime import Status
from krhpr.grasping import GraspingRobot, measured_force
from krhpr.loading import load_grasping

Floats = NDArray[np.float64]

SAMPLES_PER_SECOND = 20


@dataclass(frozen=True)
class Held:
    """A rigid object between the jaws, as the load cell with its brackets (Fig. 5.6): flat contacts that
    touch in one point each.
    """

    width: float
    """d, between the contacts."""
    height: float
    """h, from the pivot to the middle between the contacts, which is the mass centre."""
    weight: float
    friction: float = 0.5


@dataclass(frozen=True)
class Drive:
    """A motor with a gear and a belt on a pulley, (5.69)."""

    radius: float
    ratio: float

    def torques(self, forces: Floats) -> Floats:
        """At the motor's shaft, r f / N."""
        return self.radius / self.ratio * forces


@dataclass(frozen=True)
class Motion:
    """The pose and a sine: the pivot moves by (x, y), both jaws turn about it."""

    name: str
    frequency: float
    x: float = 0.0
    y: float = 0.0
    turn: float = 0.0


@dataclass(frozen=True)
class Setup:
    """A robot, what it holds and how it moves."""

    robot: str
    geometry: Mapping[str, tuple[float, float]]
    pivot: tuple[float, float]
    phi: float
    beta: float
    held: Held
    drive: Drive
    force: float
    """The grasping force f_g, of the jaw that the weight presses on less."""
    motions: tuple[Motion, ...]
    duration: float

    def build(self) -> GraspingRobot:
        """The robot with its sizes."""
        return load_grasping(self.robot).with_geometry(**self.geometry)

    def poses(self, motion: Motion, times: Floats) -> tuple[Floats, Floats]:
        """Pivots (n, 2) and angles (n, 2) along a motion."""
        sine = np.sin(motion.frequency * times)
        pivot = np.array(self.pivot) + np.outer(sine, [motion.x, motion.y])
        return pivot, np.array([self.phi, self.beta]) + motion.turn * sine[:, None]


PROTOTYPE = Setup(
    robot="planar_grasp_prr",
    geometry={"l_1": (0.12, 0.12), "l_2": (0.12, 0.12), "l_j": (0.0424, 0.0424)},
    pivot=(0.0, 0.09),
    phi=radians(45),
    beta=radians(135),
    held=Held(width=0.0427, height=0.0425, weight=0.3),
    drive=Drive(radius=0.0045, ratio=29.0),
    force=2.0,
    motions=(
        Motion("(5.73) along x", 1.0, x=0.02),
        Motion("(5.74) along y", 1.0, y=0.02),
        Motion("(5.75) about B", 0.3, turn=radians(10)),
    ),
    duration=20.0,
)
"""Section 5.5; the weight and the friction are not in the thesis."""


@dataclass(frozen=True)
class Along:
    """What comes of one motion with one weight; the first axis is time, (..., 2, 2) are the actuators."""

    motion: Motion
    weight: float
    times: Floats
    theta: Floats
    forces: Floats
    torques: Floats
    links: Floats
    """Tension of the links to P and S, positive where they pull."""
    pin: Floats
    """Force in the pivot B."""
    contact_forces: Floats
    slip: Floats
    """f_p / f_o, the friction that each contact needs."""
    trouble: str = ""
    """The first moment without an answer, and its status."""


@dataclass(frozen=True)
class GraspStudy:
    """The study's results."""

    setup: Setup
    along: tuple[Along, ...]
    span: Floats
    """Distance of a sub-leg's actuators at the pose, rho_2 - rho_1 and rho_4 - rho_3, (5.71)."""
    stiffness: float
    """k of (5.72) for actuators of unit stiffness k_p, in metres: f_g = stiffness k_p e_phi, where e_phi is
    the angle by which a jaw is turned into the object, whichever it is.
    """
    unreachable: tuple[str, ...] = field(default=())

    def claims(self) -> list[tuple[str, bool]]:
        """What must hold of any setup, and what the thesis prints of the prototype."""
        found = [("every pose is within reach and the object is held", not self.unreachable)]
        if replace(self.setup, held=PROTOTYPE.held, drive=PROTOTYPE.drive) == PROTOTYPE:
            found.append(
                (
                    "(5.71): rho_2 - rho_1 = rho_4 - rho_3 = 207.8 mm",
                    bool(np.abs(self.span - 0.2078).max() < 5e-5),
                )
            )
        return found


def grasp_study(setup: Setup = PROTOTYPE) -> GraspStudy:
    """Hold the object along every motion, without weight and with it."""
    robot = setup.build()
    pivot, angles = np.array(setup.pivot), np.array([setup.phi, setup.beta])
    theta = robot.inverse(pivot, angles, check=True)
    found = [_along(robot, setup, motion, weight) for motion in setup.motions for weight in _weights(setup)]
    bad = tuple(
        one.motion.name
        for one in found
        if not (np.isfinite(one.theta).all() and np.isfinite(one.forces).all())
    )
    s = robot.end_points(pivot, angles)
    grip = robot.inverse_statics_n(pivot, s, theta, [0.0, 0.0, 1.0, -1.0])
    stiffness = float(1.0 / (setup.held.height * (grip**2).sum()))
    return GraspStudy(setup, tuple(found), theta[:, 1] - theta[:, 0], stiffness, bad)


def _weights(setup: Setup) -> Sequence[float]:
    return tuple(dict.fromkeys((0.0, setup.held.weight)))


def contacts(setup: Setup) -> tuple[Floats, Floats, Floats]:
    """Contacts (2, 2) and faces (2,) in the jaws' frames, and the mass centre (2,) in the right one's.

    The object lies symmetrically about the bisector of the jaws, on the side to which they point from P and
    S, and the faces are parallel to the bisector.
    """
    angles = np.array([setup.phi, setup.beta])
    axes = np.column_stack([np.cos(angles), np.sin(angles)])
    up = axes.sum(axis=0) / np.linalg.norm(axes.sum(axis=0))
    across = np.array([up[1], -up[0]])
    centre = setup.held.height * up
    touch = [centre + side * setup.held.width / 2 * across for side in (1, -1)]
    frames = [np.array([axis, [-axis[1], axis[0]]]) for axis in axes]
    inward = [frame @ (-side * across) for frame, side in zip(frames, (1, -1), strict=True)]
    return (
        np.array([frame @ point for frame, point in zip(frames, touch, strict=True)]),
        np.array([np.arctan2(n[1], n[0]) for n in inward]),
        frames[0] @ centre,
    )


def _along(robot: GraspingRobot, setup: Setup, motion: Motion, weight: float) -> Along:
    times = np.linspace(0.0, setup.duration, round(SAMPLES_PER_SECOND * setup.duration) + 1)
    pivot, angles = setup.poses(motion, times)
    s = robot.end_points(pivot, angles)
    theta, reach = robot.inverse(pivot, angles, status=True)
    touch, faces, centre = contacts(setup)
    held, grip = robot.grasp(
        angles,
        touch,
        faces,
        setup.force,
        measured_force(angles[:, 0]),
        weight=[0.0, -weight],
        mass_centre=centre,
        friction=setup.held.friction,
        status=True,
    )
    forces, statics = robot.inverse_statics_n(pivot, s, theta, held.loads, status=True)
    # of the sub-legs on P and S, and along their chains
    J, _ = robot.jacobians_n(pivot, s, theta)
    chains = J[:, :, :2].reshape(-1, 2, 2, 2)
    ends = np.einsum(
        "...ij,...j", np.linalg.inv(np.swapaxes(robot.subleg_jacobian(s, theta), -1, -2)), forces
    )
    unit = chains / np.linalg.norm(chains, axis=-1, keepdims=True)
    pushes = np.einsum("...ij,...j", np.linalg.inv(np.swapaxes(unit, -1, -2)), ends)
    on_object = _in_base(angles, faces, held.contact_forces)
    return Along(
        motion,
        weight,
        times,
        theta,
        forces,
        setup.drive.torques(forces),
        -pushes,
        np.linalg.norm(on_object[:, 0] - ends[:, 0], axis=-1),
        held.contact_forces,
        np.abs(held.contact_forces[..., 1]) / held.contact_forces[..., 0],
        _trouble(times, reach, grip, statics),
    )


def _trouble(times: Floats, *statuses: NDArray[np.int64]) -> str:
    """The first moment with a status that is not OK, and the first such status there."""
    bad = np.array(statuses) != Status.OK
    if not bad.any():
        return ""
    first = int(np.argmax(bad.any(axis=0)))
    status = int(np.array(statuses)[np.argmax(bad[:, first]), first])
    return f"{Status(status).name} at {times[first]:g} s"


def _in_base(angles: Floats, faces: Floats, forces: Floats) -> Floats:
    """[f_o, f_p] of both jaws as vectors of the base frame."""
    turned = angles + faces
    normal = np.stack([np.cos(turned), np.sin(turned)], axis=-1)
    parallel = np.stack([-normal[..., 1], normal[..., 0]], axis=-1)
    found: Floats = forces[..., :1] * normal + forces[..., 1:] * parallel
    return found
