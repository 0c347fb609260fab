"""How formulas are written over the two kinds of numbers of the C text: one double, or lanes side by side."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass

from krhpr.codegen.composition import Guard, Relation


@dataclass(frozen=True)
class Writing(ABC):
    """The types, and the few functions that differ."""

    real: str
    array: str
    """The type of the elements of arrays that are parameters."""
    ints: str
    prefix: str
    suffix: str
    """Behind the names of kernels."""

    fabs: str
    copysign: str

    @abstractmethod
    def all(self, constant: str) -> str:
        """A constant by itself."""

    @abstractmethod
    def less(self, a: str, b: str) -> str:
        """Whether a < b."""

    @abstractmethod
    def at_most(self, a: str, b: str) -> str:
        """Whether a <= b."""

    @abstractmethod
    def at_least(self, a: str, b: str) -> str:
        """Whether a >= b."""

    @abstractmethod
    def where(self, condition: str, then: str, otherwise: str) -> str:
        """One of two values."""


class Number(Writing):
    """One double."""

    def all(self, constant: str) -> str:
        return constant

    def less(self, a: str, b: str) -> str:
        return f"{a} < {b}"

    def at_most(self, a: str, b: str) -> str:
        return f"{a} <= {b}"

    def at_least(self, a: str, b: str) -> str:
        return f"{a} >= {b}"

    def where(self, condition: str, then: str, otherwise: str) -> str:
        return f"({condition} ? {then} : {otherwise})"


class Lanes(Writing):
    """Lanes, of krhpr_lanes.h."""

    def all(self, constant: str) -> str:
        return f"krhpr_all({constant})"

    def less(self, a: str, b: str) -> str:
        return f"krhpr_less({a}, {b})"

    def at_most(self, a: str, b: str) -> str:
        return f"krhpr_at_most({a}, {b})"

    def at_least(self, a: str, b: str) -> str:
        return f"krhpr_at_most({b}, {a})"

    def where(self, condition: str, then: str, otherwise: str) -> str:
        return f"krhpr_where({condition}, {then}, {otherwise})"


NUMBER = Number("double", "double", "int", "krhpr_", "", "fabs", "copysign")
LANES = Lanes(
    "krhpr_lanes",
    "krhpr_lanes_at",
    "krhpr_ints",
    "krhpr_lanes_",
    "_lanes",
    "krhpr_lanes_fabs",
    "krhpr_lanes_copysign",
)


def holds(guard: Guard, value: str, writing: Writing) -> str:
    """The condition that a value keeps its limit."""
    compare = writing.at_least if guard.relation is Relation.AT_LEAST else writing.at_most
    return compare(value, writing.all(repr(guard.limit)))
