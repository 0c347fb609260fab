"""What jaws do to an object at given poses, as linear maps of the forces at their contacts.

Both maps come out of the generated statics, one unit force at a contact after the other: nothing of a robot
is known here but its functions.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from krhpr.errors import InvalidInput
from krhpr.generated.python.runtime import Status
from krhpr.grasping import GraspingRobot
from krhpr.robot import Robot

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Grip:
    """Maps of the contact forces (jaw by jaw: normal into the object, then along the face), a batch of poses
    first."""

    balance: Floats
    """(..., 3 or 6, contacts * d): force and moment about the mass centre on the object, base frame."""
    actuators: Floats
    """(..., legs, n, contacts * d): what the actuators give."""
    status: NDArray[np.int64]
    """(...): where a pose is out of reach or singular the actuators are NaN."""
    dimension: int

    @property
    def contacts(self) -> int:
        """How many jaws there are."""
        return int(self.balance.shape[-1]) // self.dimension

    def at(self, index: tuple[int, ...]) -> Grip:
        """The grip of one pose."""
        return Grip(self.balance[index], self.actuators[index], self.status[index], self.dimension)


def grip_of(
    robot: GraspingRobot | Robot,
    pose: Sequence[Any],
    contacts: ArrayLike,
    faces: ArrayLike | None,
    mass_centre: ArrayLike | None,
    theta: ArrayLike | None,
) -> Grip:
    """The grip of any robot that has one; arguments as `grasp_capability` takes them."""
    if "grasp" not in robot.functions:
        raise InvalidInput(
            f"{robot.name} has no gripper; arrangements (b) and (c) and the grasping robots have one"
        )
    d = 2 if robot.planar else 3
    jaws = 2 if isinstance(robot, GraspingRobot) else 3
    at = finite("contacts", contacts, (jaws, d))
    centre = np.zeros(d) if mass_centre is None else finite("mass_centre", mass_centre, (d,))
    joints = None if theta is None else np.asarray(theta, dtype=float)
    if isinstance(robot, GraspingRobot):
        if faces is None:
            raise InvalidInput(
                f"{robot.name} needs faces: the directions of the jaws' normals, as grasp takes them"
            )
        pivot, angles = _of_pose(pose, 2)
        return _of_jaws(robot, pivot, angles, at, finite("faces", faces, (2,)), centre, joints)
    if faces is not None:
        raise InvalidInput(
            f"faces are those of the grasping robots; jaws of {robot.name} are normal to their slides"
        )
    p, turned, redundant = _of_pose(pose, 3)
    return _of_slides(robot, p, turned, redundant, at, centre, joints)


def finite(name: str, value: ArrayLike, shape: tuple[int, ...]) -> Floats:
    """An input as an array of that shape.

    Raises:
        InvalidInput: another shape, NaN, or infinite.
    """
    array = np.asarray(value, dtype=float)
    if array.shape != shape:
        raise InvalidInput(f"{name} has the shape {array.shape}; expected {shape}")
    if not np.isfinite(array).all():
        raise InvalidInput(f"{name} is NaN or infinite: {array.tolist()}")
    return array


def _of_pose(pose: Sequence[Any], count: int) -> list[Floats]:
    if len(pose) != count:
        names = "pivot, angles" if count == 2 else "p, Q (phi in the plane), redundant"
        raise InvalidInput(f"the pose has {len(pose)} parts; expected {count}: {names}")
    return [np.asarray(part, dtype=float) for part in pose]


def _joints(
    robot: GraspingRobot | Robot, pose: Sequence[Floats], s: Floats, theta: Floats | None
) -> tuple[Floats, Any]:
    """The joints of a pose, those of the default working mode unless given, and a status for each pose."""
    if theta is None:
        joints, status = robot.inverse(*pose, status=True)
        return joints, status
    return theta, np.zeros(np.broadcast_shapes(s.shape[:-2], theta.shape[:-2]), dtype=int)


def _turns(angle: Floats) -> Floats:
    """Rotation matrices (..., 2, 2)."""
    c, s = np.cos(angle), np.sin(angle)
    return np.stack([np.stack([c, -s], -1), np.stack([s, c], -1)], -2)


def _moments(arms: Floats, forces: Floats) -> Floats:
    """arm x force, (..., 1) in the plane and (..., 3) in space."""
    if arms.shape[-1] == 3:
        return np.cross(arms, forces)
    return (arms[..., 0] * forces[..., 1] - arms[..., 1] * forces[..., 0])[..., None]


def _of_jaws(
    robot: GraspingRobot,
    pivot: Floats,
    angles: Floats,
    contacts: Floats,
    faces: Floats,
    centre: Floats,
    theta: Floats | None,
) -> Grip:
    s = robot.end_points(pivot, angles)
    theta, reach = _joints(robot, (pivot, angles), s, theta)
    batch = np.shape(reach)
    turns = np.broadcast_to(_turns(angles), (*batch, 2, 2, 2))
    arms = np.einsum("...jik,jk->...ji", turns, contacts)
    middle = np.einsum("...ik,k->...i", turns[..., 0, :, :], centre)
    normals = np.einsum("...jik,jk->...ji", turns, np.stack([np.cos(faces), np.sin(faces)], -1))
    along = np.stack([-normals[..., 1], normals[..., 0]], -1)
    forces = np.stack([normals, along], -2).reshape(*batch, 4, 2)
    arms = np.repeat(arms, 2, axis=-2)
    about = _moments(arms, forces)
    of_jaw = np.repeat(np.eye(2), 2, axis=0)
    loads = np.concatenate([forces, about * of_jaw], -1)
    found, status = robot.inverse_statics_n(
        pivot[..., None, :], s[..., None, :, :], theta[..., None, :, :], loads, status=True
    )
    across = arms[..., 0, :] - arms[..., 2, :]  # from the left contact to the right one
    inside = [-np.sum(across * normals[..., 0, :], -1), np.sum(across * normals[..., 1, :], -1)]
    overlap = np.where(np.min(inside, axis=0) < 0, Status.NO_GRASP, Status.OK)
    return _grip(forces, arms - middle[..., None, :], found, reach, status, overlap)


def _of_slides(
    robot: Robot, p: Floats, turned: Floats, redundant: Floats, contacts: Floats, centre: Floats, theta: Any
) -> Grip:
    s = robot.end_points(p, turned, redundant)
    theta, reach = _joints(robot, (p, turned, redundant), s, theta)
    batch, d = np.shape(reach), s.shape[-1]
    frame = np.broadcast_to(_turns(turned) if robot.planar else turned, (*batch, d, d))
    # end points are linear in the slides; jaws close against them
    x = np.broadcast_to(s - robot.end_points(p, turned, redundant + 1.0), (*batch, 3, d))
    if robot.planar:
        axes = [x, np.stack([-x[..., 1], x[..., 0]], -1)]
    else:
        z = np.broadcast_to(frame[..., None, :, 2], x.shape)
        axes = [x, np.cross(z, x), z]
    forces = np.stack(axes, -2).reshape(*batch, 3 * d, d)
    arms = np.repeat(np.einsum("...ik,jk->...ji", frame, contacts), d, axis=-2)
    wrenches = np.concatenate([forces, _moments(arms, forces)], -1)
    pressed = np.zeros((3 * d, 3))
    pressed[np.arange(0, 3 * d, d), np.arange(3)] = -1.0
    found, status = robot.inverse_statics(
        p[..., None, :],
        turned[..., None] if robot.planar else turned[..., None, :, :],
        s[..., None, :, :],
        theta[..., None, :, :],
        wrenches,
        pressed,
        status=True,
    )
    middle = np.einsum("...ik,k->...i", frame, centre)
    return _grip(forces, arms - middle[..., None, :], found, reach, status)


def _grip(
    forces: Floats, arms: Floats, actuators: Floats, reach: Any, statics: Any, jaws: Any = Status.OK
) -> Grip:
    """The maps, and the first status that is not OK."""
    balance = np.swapaxes(np.concatenate([forces, _moments(arms, forces)], -1), -1, -2)
    status = np.asarray(reach)
    for more in (np.max(np.asarray(statics), axis=-1), jaws):
        status = np.where(status == Status.OK, more, status)
    return Grip(balance, np.moveaxis(actuators, -3, -1), status, forces.shape[-1])
