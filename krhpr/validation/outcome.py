"""What carrying out a check yields: the worst error, over how many samples, and where it was."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from enum import StrEnum
from typing import Any

import numpy as np

from krhpr.validation.check import BALL, Check
from krhpr.validation.numbers import Ball, Exact, ExactError, same
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

    def worse(self, error: Any, where: Callable[[], str] | str = "") -> None:
        """Take an error (or the largest of an array; not-a-number counts as infinite) into account."""
        array = np.asarray(error, dtype=float)
        value = float(np.nan_to_num(array, nan=math.inf, posinf=math.inf).max()) if array.size else 0.0
        if value > self.worst:
            self.worst = value
            if value > self.check.tolerance:  # saying where may cost something
                self.where = where if isinstance(where, str) else where()

    def equal(self, found: Any, wanted: Any, where: str = "") -> None:
        """Compare exact numbers: rationals and angles without tolerance, balls within the check's."""
        for index, (a, b) in enumerate(zip(flat(found), flat(wanted), strict=True)):
            error = _distance(a, b, self.check.tolerance)
            if error > 0.0:
                self.worse(error, f"{where}[{index}]: {_short(a)} is not {_short(b)}")

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


def _short(value: Any) -> str:
    text = repr(value)
    return text if len(text) <= 60 else f"{text[:57]}..."


def _distance(a: Any, b: Any, tolerance: float) -> float:
    """Zero for equal exact numbers; for balls the distance of their centres, if it is certainly small enough.

    Where a check that is exact by itself meets balls (the joints of a sub-leg that no exact configuration is
    known for), enclosures that agree to 1e-60 count as equal.
    """
    try:
        if isinstance(a, Ball) or isinstance(b, Ball):
            centre = abs(float((_ball(a) - _ball(b)).enclosure.mid()))
            if same(a, b, max(tolerance, BALL)):
                return centre if tolerance else 0.0
            return max(centre, 2 * BALL)
        if same(a, b):
            return 0.0
        gap = a - b
        return max(abs(float(gap.fraction)), 1e-300) if isinstance(gap, Exact) else math.inf
    except ExactError:
        return math.inf


def _ball(value: Any) -> Ball:
    return value if isinstance(value, Ball) else Ball(value)
