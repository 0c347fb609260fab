"""The grasp capability of a pose, and its map over poses."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from krhpr.capability.answer import Extreme, GraspCapability
from krhpr.capability.grip import Grip, finite, grip_of
from krhpr.capability.programme import Bounds, Programme
from krhpr.errors import InvalidInput, NoGrasp
from krhpr.generated.python.runtime import Status
from krhpr.grasping import GraspingRobot
from krhpr.robot import Robot

Floats = NDArray[np.float64]

FACETS = 32
"""Of the pyramid in a friction cone: up to 0.5 % of the friction is given away."""


def grasp_capability(
    robot: GraspingRobot | Robot,
    pose: Sequence[Any],
    contacts: ArrayLike,
    *,
    actuator_limits: ArrayLike,
    friction: ArrayLike,
    faces: ArrayLike | None = None,
    weight: ArrayLike | None = None,
    mass_centre: ArrayLike | None = None,
    wrench: ArrayLike | None = None,
    disturbance: ArrayLike | None = None,
    theta: ArrayLike | None = None,
    facets: int = FACETS,
) -> GraspCapability:
    """What the jaws of a grasping robot, or of a robot of arrangement (b) or (c), can do to an object at a
    pose.

    `pose` is (pivot, angles) or (p, Q or phi, redundant), and `contacts`, `faces` (of grasping robots
    alone), `mass_centre` and `weight` are those of `robot.grasp`.  `actuator_limits` (legs, n), or one
    number, are the largest forces (N) or torques (N m) either way, infinite where there is none; `friction`
    is a number, or one of each contact.  `wrench` is what acts on the object from outside beside its weight:
    force and moment about the mass centre, base frame; a force of zero leaves a pure moment.  `theta` are the
    joints at the pose, those of the default working mode unless given.

    The grasping forces are those with the weight and the wrench.  `disturbance` is a wrench that may come on
    top of them, and `scale` its factors that can be resisted with forces of the jaws' own choice: 1 is among
    them where it is resisted, and the larger one is the margin.

    Friction is that of points.  In space cones are pyramids of `facets` inside them.

    Raises:
        Unreachable, Singular: a pose out of reach, or in which actuators do not bear all loads.
        NoGrasp: jaws that overlap.
        InvalidInput: shapes, NaN, negative limits or friction, or a disturbance of zero.
    """
    bounds = _bounds(robot, actuator_limits, friction, facets)
    load, more = _loads(robot, weight, wrench, disturbance)
    grip = grip_of(robot, pose, contacts, faces, mass_centre, theta)
    if grip.status.shape:
        raise InvalidInput(f"one pose at a time; these are {grip.status.shape}: use grasp_capability_map")
    if grip.status != Status.OK:
        _refuse(robot, pose, theta, grip.status)
    return _capability(grip, bounds, load, more)


@dataclass(frozen=True)
class GraspCapabilityMap:
    """The capability of every pose, in the shape of the batch."""

    least: Floats
    """The least grasping force; NaN where a pose is out of reach or singular, or does not hold the loads."""
    most: Floats
    scale: Floats
    """(..., 2): the least and the largest factor of the disturbance that are resisted; NaN without one."""
    status: NDArray[np.int64]
    """Of the poses: 0 where actuators bear all loads."""
    stopped_by: NDArray[np.object_]
    """The limits (a tuple) of the largest grasping force, or those in conflict where nothing holds the
    loads."""
    scale_stopped_by: NDArray[np.object_]
    """The limits of the largest factor."""


def grasp_capability_map(
    robot: GraspingRobot | Robot,
    poses: Sequence[Any],
    contacts: ArrayLike,
    *,
    actuator_limits: ArrayLike,
    friction: ArrayLike,
    faces: ArrayLike | None = None,
    weight: ArrayLike | None = None,
    mass_centre: ArrayLike | None = None,
    wrench: ArrayLike | None = None,
    disturbance: ArrayLike | None = None,
    theta: ArrayLike | None = None,
    facets: int = FACETS,
) -> GraspCapabilityMap:
    """`grasp_capability` at every pose of a batch: the parts of `poses` broadcast as those of other
    functions do.

    Poses out of reach and singular ones have their status.  Some ten milliseconds a pose.
    """
    bounds = _bounds(robot, actuator_limits, friction, facets)
    load, more = _loads(robot, weight, wrench, disturbance)
    grip = grip_of(robot, poses, contacts, faces, mass_centre, theta)
    shape = grip.status.shape
    least, most, scale = np.full(shape, np.nan), np.full(shape, np.nan), np.full((*shape, 2), np.nan)
    stopped, scale_stopped = (np.full(shape, None, dtype=object) for _ in range(2))
    for index in np.ndindex(shape):
        stopped[index] = scale_stopped[index] = ()
        if grip.status[index] != Status.OK:
            continue
        one = _capability(grip.at(index), bounds, load, more)
        least[index], most[index] = one.grasp_force
        stopped[index] = one.conflict if one.most is None else one.most.stopped_by
        if one.scale is not None:
            scale[index] = one.scale
        if one.strongest is not None:
            scale_stopped[index] = one.strongest.stopped_by
    return GraspCapabilityMap(least, most, scale, grip.status, stopped, scale_stopped)


def _bounds(
    robot: GraspingRobot | Robot, actuator_limits: ArrayLike, friction: ArrayLike, facets: int
) -> Bounds:
    """Limits, checked."""
    jaws = 2 if isinstance(robot, GraspingRobot) else 3
    strength = _not_negative("actuator_limits", actuator_limits, (robot.legs, len(robot.angular)))
    rough = _not_negative("friction", friction, (jaws,))
    if np.isinf(rough).any():
        raise InvalidInput("friction is infinite; expected coefficients")
    if facets < 3:
        raise InvalidInput(f"facets are {facets}; a pyramid has three or more")
    return Bounds(strength, rough, facets)


def _loads(
    robot: GraspingRobot | Robot,
    weight: ArrayLike | None,
    wrench: ArrayLike | None,
    disturbance: ArrayLike | None,
) -> tuple[Floats, Floats | None]:
    """Weight and wrench together, and the disturbance."""
    d = 2 if robot.planar else 3
    load = np.zeros(3 if d == 2 else 6)
    if weight is not None:
        load[:d] += finite("weight", weight, (d,))
    if wrench is not None:
        load += finite("wrench", wrench, load.shape)
    if disturbance is None:
        return load, None
    more = finite("disturbance", disturbance, load.shape)
    if not more.any():
        raise InvalidInput("the disturbance is zero; leave it out where there is none")
    return load, more


def _not_negative(name: str, value: ArrayLike, shape: tuple[int, ...]) -> Floats:
    given = np.asarray(value, dtype=float)
    try:
        array = np.broadcast_to(given, shape)
    except ValueError:
        raise InvalidInput(f"{name} has the shape {given.shape}; expected a number or {shape}") from None
    if not (array >= 0).all():
        raise InvalidInput(f"{name} is {given.tolist()}; expected numbers that are not negative")
    return array


def _refuse(robot: GraspingRobot | Robot, pose: Sequence[Any], theta: ArrayLike | None, status: Any) -> None:
    """The error of a pose at which forces have no answer: that of the function which has none."""
    if status == Status.NO_GRASP:
        raise NoGrasp(
            "the jaws overlap: a contact lies behind the face of the other jaw; check contacts and faces"
        )
    joints: Any = robot.inverse(*pose, check=True) if theta is None else theta
    s = robot.end_points(*pose)
    if isinstance(robot, GraspingRobot):
        robot.inverse_statics_n(pose[0], s, joints, np.ones(4), check=True)
    else:
        robot.inverse_statics(pose[0], pose[1], s, joints, np.ones(3 if robot.planar else 6), check=True)


def _capability(grip: Grip, bounds: Bounds, load: Floats, disturbance: Floats | None) -> GraspCapability:
    programme = Programme(grip, bounds, load)
    strongest: Extreme | None = None
    scale: tuple[float, float] | None = None
    if disturbance is not None:
        weakest, strongest = programme.scale(disturbance, -1.0), programme.scale(disturbance, 1.0)
        scale = (float("nan"), float("nan"))
        if weakest is not None and strongest is not None:
            scale = (weakest.value, strongest.value)
    most = programme.most_grasp()
    least = None if most is None else programme.least_grasp()
    if most is None or least is None:
        shortage, conflict = programme.shortage()
        return GraspCapability((float("nan"),) * 2, None, None, conflict, shortage, scale, strongest)
    return GraspCapability((least.value, most.value), least, most, (), 0.0, scale, strongest)
