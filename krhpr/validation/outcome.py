"""What carrying out a check yields: the worst error, over how many samples, and where it was."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from enum import StrEnum
from typing import Any

import numpy as np

from krhpr.validation.numbers import Angle, Ball, ExactError, same
from krhpr.validation.plan import EXACT, Check
from krhpr.validation.subject import Subject


class State(StrEnum):
    """How a check ended."""

    PASSED = "passed"
    FAILED = "failed"
    NOT_RUN = "not run"


@dataclass
class Measured:
    """The worst error that a check found; `worse` keeps it up to date."""

    check: Check
    worst: float = 0.0
    samples: int = 0
    where: str = ""
    notes: list[str] = field(default_factory=list)

    def worse(self, error: Any, where: Callable[[], str] | str = "") -> None:
        """Take an error (or the largest of an array; not-a-number counts as infinite) into account."""
        array = np.asarray(error, dtype=float)
        value = float(np.nan_to_num(array, nan=math.inf, posinf=math.inf).max()) if array.size else 0.0
        if value > self.worst:
            self.worst, self.where = value, where if isinstance(where, str) else where()

    def equal(self, found: Any, wanted: Any, where: Callable[[], str] | str = "") -> None:
        """Compare exact numbers: rationals and angles without tolerance, balls within the check's tolerance."""
        for index, (a, b) in enumerate(zip(flat(found), flat(wanted), strict=True)):
            place = f"{where if isinstance(where, str) else where()}[{index}]"
            self.worse(_distance(a, b, self.check.tolerance), lambda place=place, a=a, b=b: f"{place}: {a!r} is not {b!r}")

    @property
    def ok(self) -> bool:
        """Whether the check holds; one that looked at nothing does not."""
        return self.worst <= self.check.tolerance and self.samples > 0


Runner = Callable[[Subject, Check, int], Measured]
"""Carries out a check on so many samples."""


def flat(value: Any) -> list[Any]:
    """The numbers of nested sequences and arrays, row by row."""
    if isinstance(value, np.ndarray):
        return list(value.flat)
    if isinstance(value, list | tuple):
        return [item for part in value for item in flat(part)]
    return [value]


def _distance(a: Any, b: Any, tolerance: float) -> float:
    """Zero for equal exact numbers; for balls the distance of their centres, infinite if it is not certainly small."""
    try:
        if isinstance(a, Ball) or isinstance(b, Ball):
            centre = abs(float((_ball(a) - _ball(b)).enclosure.mid()))
            return centre if same(a, b, max(tolerance, 1e-60)) else max(centre, 2 * max(tolerance, 1e-60))
        if same(a, b):
            return 0.0
        if isinstance(a, Angle) or isinstance(b, Angle):
            return math.inf
        return max(abs(float((a - b).fraction)) if hasattr(a - b, "fraction") else abs(float(a - b)), 1e-300)
    except ExactError:
        return math.inf


def _ball(value: Any) -> Ball:
    return value if isinstance(value, Ball) else Ball(value)


def is_exact(check: Check) -> bool:
    """Whether a check allows no error at all."""
    return check.tolerance == EXACT
