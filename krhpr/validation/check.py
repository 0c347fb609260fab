"""One thing that is checked of a robot: the words of the plan."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum
from zlib import crc32


class Kind(StrEnum):
    """Ways of checking; the order is that of reports."""

    PROOF = "proof"
    PASSES = "passes"
    IDENTITY = "identity"
    DIFFERENCES = "finite differences"
    AGREEMENT = "agreement"
    DIGITS = "fifty digits"
    INVARIANT = "invariant"
    REFERENCE = "reference"


class Target(StrEnum):
    """What is checked."""

    DERIVATION = "derivation"
    C = "C"
    NUMPY = "NumPy"
    CASADI = "CasADi"


@dataclass(frozen=True)
class Samples:
    """How many random configurations (of a batch, or of exact numbers) a check takes."""

    small: int
    large: int

    def of(self, size: str) -> int:
        """The number for `small` or `large`."""
        return self.large if size == "large" else self.small


EXACT = 0.0
"""Equality of rational numbers, no tolerance."""
BALL = 1e-60
"""Enclosures of 300 bits equal to this: what has roots or arctangents in it."""

ROOTS = 1e-9
ROUNDING = 1e-13
"""A function in doubles."""
ROUND_TRIP = 1e-11
"""Functions in doubles, one after the other, there and back."""
FIRST = 1e-8
"""First differences."""
SECOND = 1e-6
"""Second differences."""


@dataclass(frozen=True)
class Check:
    """One thing that is checked of one robot.

    `function` is the robot's function, or a kernel as `part.kernel`; `also` are others that take
    part.  `shared` names the part that the check is about where it does not depend on the rest of the
    robot: robots that share the part share the result.
    """

    kind: Kind
    robot: str
    function: str
    target: Target
    tolerance: float
    samples: Samples
    statement: str
    name: str
    also: tuple[str, ...] = ()
    shared: str = ""
    same_text: str = ""
    """The part whose kernels alone a robot's function calls: robots that share the part have the same text of
    the function, but for their names, and share the result too.
    """

    @property
    def subject(self) -> str:
        """What the check is about: a part, or the robot."""
        return self.shared or self.same_text or self.robot

    @property
    def once(self) -> tuple[str, ...]:
        """What checks of several robots that are one have in common."""
        return self.subject, self.kind, self.name, self.function, self.target

    @property
    def identifier(self) -> str:
        """A readable name that is unique among the checks of a robot."""
        return f"{self.robot}: {self.kind}, {self.name}, {self.function}, {self.target}"

    @property
    def seed(self) -> int:
        """Where random numbers of this check start; the same on every machine, and for all robots that
        share it.
        """
        return crc32(f"{self.subject}/{self.kind}/{self.name}/{self.function}".encode())

    @property
    def compiles(self) -> bool:
        """Whether the check needs a C compiler."""
        return self.target is Target.C and self.kind is not Kind.IDENTITY

    @property
    def closeness(self) -> str:
        """The tolerance in words."""
        return "exact" if self.tolerance == EXACT else f"{self.tolerance:.0e}".replace("e-0", "e-")
