"""Words of the field as types: spaces, joints, branches, factors of determinants."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum
from itertools import product
from typing import Any

import sympy as sp


class Space(StrEnum):
    """Where a robot moves."""

    SPATIAL = "spatial"
    PLANAR = "planar"

    @property
    def dimension(self) -> int:
        """Dimension of the space in which the platform moves."""
        return 3 if self is Space.SPATIAL else 2

    @property
    def degrees_of_freedom(self) -> int:
        """The platform's degrees of freedom."""
        return 6 if self is Space.SPATIAL else 3

    @property
    def rows_per_leg(self) -> int:
        """Constraint equations that one leg gives the platform."""
        return 2 if self is Space.SPATIAL else 1


class JointKind(StrEnum):
    """How a joint's coordinate behaves: angles differ by full turns, slides do not."""

    REVOLUTE = "revolute"
    PRISMATIC = "prismatic"


@dataclass(frozen=True)
class Joint:
    """An actuated or passive joint of a leg."""

    name: str
    kind: JointKind
    doc: str


@dataclass(frozen=True)
class Sign:
    """A choice of sign in a closed form (a branch), with the words for +1 and -1."""

    name: str
    plus: str
    minus: str
    doc: str


@dataclass(frozen=True)
class Mode:
    """A branch: a readable label and the sign of every choice."""

    label: str
    signs: tuple[int, ...]


ONLY = "only"
"""The label of a branch where there is no choice."""


def branches(signs: tuple[Sign, ...]) -> tuple[Mode, ...]:
    """Every combination of signs, the first choice varying slowest and +1 before -1; `only` without one."""
    if not signs:
        return (Mode(ONLY, ()),)
    modes = []
    for values in product((1, -1), repeat=len(signs)):
        words = [sign.plus if value > 0 else sign.minus for sign, value in zip(signs, values, strict=True)]
        modes.append(Mode("/".join(words), values))
    return tuple(modes)


class LinkKind(StrEnum):
    """What a link is, which decides how it is drawn."""

    FIXED = "fixed"
    SLIDE = "slide"
    PROXIMAL = "proximal"
    DISTAL = "distal"
    CRANK = "crank"
    ROD = "rod"
    STRUT = "strut"
    PARALLELOGRAM = "parallelogram"


@dataclass(frozen=True)
class Link:
    """A straight link of a leg between two of its named points, named as its length is."""

    name: str
    kind: LinkKind
    start: str
    end: str
    between: tuple[str, ...] = ()
    """Other joints that lie on it."""

    @property
    def joints(self) -> tuple[str, ...]:
        """All joints on it, its ends first."""
        return (self.start, self.end, *self.between)


@dataclass(frozen=True)
class Factor:
    """A dimensionless factor of a leg's determinant: the leg is singular where it vanishes."""

    name: str
    value: Any
    doc: str


@dataclass(frozen=True)
class Pose:
    """Position and orientation as they stand in formulas: p and the rotation matrix Q (2 x 2 in the
    plane).
    """

    p: sp.Matrix
    Q: sp.Matrix
