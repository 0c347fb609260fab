"""What exact arithmetic raises where it has no answer."""

from __future__ import annotations


class ExactError(ArithmeticError):
    """Exact arithmetic cannot give the answer that was asked for."""


class NotRational(ExactError):
    """The result (or the operand) is no rational number."""


class Undecidable(ExactError):
    """The enclosures are too wide to decide a comparison or to choose a branch."""


class Undefined(ExactError):
    """The operation has no value there: the direction of the zero vector, the root of a negative ball."""
