"""What the grasp capability of a pose is: forces at their extremes, and the limits that stop them."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


class LimitKind(StrEnum):
    """What stops a force."""

    ACTUATOR = "actuator"
    """An actuator gives all that it can."""
    FRICTION = "friction"
    """A contact is about to slip."""
    CONTACT = "contact"
    """A jaw is about to leave the object."""


@dataclass(frozen=True, order=True)
class Limit:
    """One limit: an actuator by its place in `actuator_forces` (leg, n), or a contact by its jaw, from 0."""

    kind: LimitKind
    index: tuple[int, ...]

    def __str__(self) -> str:
        numbers = [i + 1 for i in self.index]
        if self.kind is LimitKind.ACTUATOR:
            return f"actuator {numbers[1]} of leg {numbers[0]} gives all it can"
        if self.kind is LimitKind.FRICTION:
            return f"contact {numbers[0]} slips"
        return f"jaw {numbers[0]} leaves the object"


@dataclass(frozen=True)
class Extreme:
    """Forces that reach an extreme, and what stops them there."""

    value: float
    """What was made as small or as large as it can be; infinite where nothing stops it."""
    contact_forces: Floats
    """(contacts, d): those that `grasp` has; NaN where nothing stops them."""
    actuator_forces: Floats
    """(legs, n), that the actuators give."""
    stopped_by: tuple[Limit, ...]
    """The limits that together stop it: those with a multiplier in the linear programme.  Where more are
    reached at once than it takes, as in symmetric poses, enough of them."""


@dataclass(frozen=True)
class GraspCapability:
    """What a grip can do at one pose."""

    grasp_force: tuple[float, float]
    """The least and the most that the jaws can grasp with: of the forces normal to the faces the smallest,
    (5.70).  All values between are possible.  NaN where the loads cannot be held."""
    least: Extreme | None
    """At the least grasping force; None where the loads cannot be held."""
    most: Extreme | None
    conflict: tuple[Limit, ...]
    """Where the loads cannot be held: limits that contradict one another.  It is empty where no forces at the
    contacts balance the loads at all."""
    shortage: float
    """By how many newtons of force at the contacts every one of them would have to be wider, at least; zero
    where the loads can be held, infinite where no forces balance them."""
    scale: tuple[float, float] | None
    """The factors of the disturbance between which it is resisted beside the loads; NaN where none is, None
    where none was given."""
    strongest: Extreme | None
    """At the largest factor."""

    @property
    def held(self) -> bool:
        """Whether the object can be held with its weight and the external wrench."""
        return self.least is not None
