"""Limits of a robot's joints and links: what a robot file says of them, as values that cannot be changed.

SI units throughout: radians for revolute joints, metres for slides, radii and clearances.  Legs may differ:
every entry has a value for each of the three.  What is not limited is not there.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Any


@dataclass(frozen=True)
class Interval:
    """Where the coordinate of a revolute joint (rad) or of a slide (m) may be: from `low` to `high`."""

    low: float
    high: float


@dataclass(frozen=True)
class Cone:
    """Where a spherical joint may be: the angle between stud and socket is at most `tilt` (rad).

    `socket` is the socket's axis in the frame of the sub-leg's last link (x towards S_i, z = e_2), `stud` the
    stud's axis in the frame of the redundant link (x from S_i, z = q_z), both of length one; turning about
    the stud is free.  With the rotation R that `passive_joints` gives for the joint, the angle is that
    between `socket` and R `stud`.
    """

    tilt: float
    socket: tuple[float, float, float] = (1.0, 0.0, 0.0)
    stud: tuple[float, float, float] = (0.0, 0.0, 1.0)


Intervals = tuple[Interval, Interval, Interval]
"""An interval for each leg."""

Numbers = tuple[float, float, float]
"""A number for each leg."""


def _nothing() -> Mapping[str, Any]:
    return MappingProxyType({})


@dataclass(frozen=True)
class Limits:
    """Limits of joints by name, radii of links by name, and the clearance between links."""

    actuators: Mapping[str, Intervals] = field(default_factory=_nothing)
    """Of actuated joints (rad or m), named as the sub-leg names its actuators."""
    passive: Mapping[str, Intervals] = field(default_factory=_nothing)
    """Of passive revolute joints and slides (rad or m), named as `passive_joints` names them."""
    spherical: tuple[Cone, Cone, Cone] | None = None
    """Of the spherical joints; None where they are not limited, and for planar robots."""
    link_radii: Mapping[str, Numbers] = field(default_factory=_nothing)
    """Radii (m) of links as cylinders, named as `robot.links` names them, or as the redundant link;
    `platform`: of the platform's edges."""
    clearance: float | None = None
    """The least distance (m) between the surfaces of links that no joint joins."""
    axis_distance: float | None = None
    """The least distance (m) of S_i from the first axis of its leg, for type I singularities."""
    elbow: Interval | None = None
    """The least and the largest angle (rad) between the links that an elbow joins, for the same."""

    def __post_init__(self) -> None:
        for name in ("actuators", "passive", "link_radii"):
            object.__setattr__(self, name, MappingProxyType(dict(getattr(self, name))))

    def __bool__(self) -> bool:
        return bool(self.actuators or self.passive or self.spherical or self.link_radii) or any(
            value is not None for value in (self.clearance, self.axis_distance, self.elbow)
        )

    def __hash__(self) -> int:
        tables = (tuple(sorted(table.items())) for table in (self.actuators, self.passive, self.link_radii))
        return hash((*tables, self.spherical, self.clearance, self.axis_distance, self.elbow))

    def __reduce__(self) -> tuple[Any, ...]:
        tables = (dict(self.actuators), dict(self.passive), dict(self.link_radii))
        of_legs = (tables[0], tables[1], self.spherical, tables[2])
        return Limits, (*of_legs, self.clearance, self.axis_distance, self.elbow)
