"""Boxes of redundant coordinates."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from krhpr.errors import InvalidInput

LEGS = 3
TURN = 2 * math.pi
FARTHEST = 2 * TURN
"""Bounds of angles beyond this have no use, and their sines lose digits."""

FARTHEST_SLIDE = 1e50
"""Determinants of slides beyond this would not be doubles."""

Triple = tuple[float, float, float]


@dataclass(frozen=True)
class Box:
    """low_i to high_i for i = 1, 2, 3 (radians or metres), with its faces if it is closed."""

    low: Triple
    high: Triple
    closed: bool = True

    @property
    def centre(self) -> Triple:
        """Its middle."""
        return triple([low + (high - low) / 2 for low, high in zip(self.low, self.high, strict=True)])

    @property
    def widths(self) -> Triple:
        """Its edges' lengths."""
        return triple([high - low for low, high in zip(self.low, self.high, strict=True)])

    def contains(self, point: Sequence[float]) -> bool:
        """Whether a point lies in it."""
        if self.closed:
            return all(a <= x <= b for a, x, b in zip(self.low, point, self.high, strict=True))
        return all(a < x < b for a, x, b in zip(self.low, point, self.high, strict=True))


def triple(values: Sequence[float]) -> Triple:
    """Three numbers as a tuple of floats."""
    first, second, third = (float(value) for value in values)
    return first, second, third


def per_leg(name: str, given: ArrayLike) -> Triple:
    """One number for all legs, or one for each; a clear error for anything else."""
    try:
        values = np.asarray(given, dtype=float)
    except (TypeError, ValueError):
        raise InvalidInput(f"{name} is no array of numbers: {given!r}") from None
    if values.shape not in ((), (LEGS,)):
        raise InvalidInput(f"{name} has shape {values.shape}; expected a number, or three: one for each leg")
    if not np.isfinite(values).all():
        raise InvalidInput(f"{name} is {values.tolist()}; it must be finite")
    return triple(np.broadcast_to(values, (LEGS,)).tolist())


def make_box(low: ArrayLike, high: ArrayLike, *, angular: bool, closed: bool) -> Box:
    """A box from its bounds, after checking them."""
    box = Box(per_leg("low", low), per_leg("high", high), closed)
    for leg, (a, b) in enumerate(zip(box.low, box.high, strict=True), start=1):
        if not a < b:
            raise InvalidInput(f"leg {leg}: low is {a:.17g} and high is {b:.17g}; low must be below high")
        if angular and b - a > TURN * (1 + 1e-15):
            raise InvalidInput(
                f"leg {leg}: from {a:.6g} to {b:.6g} rad is more than a full turn; give at most 2 pi"
            )
        if angular and max(abs(a), abs(b)) > FARTHEST:
            raise InvalidInput(f"leg {leg}: {a:.6g} to {b:.6g} rad; subtract full turns, to within 4 pi")
        if max(abs(a), abs(b)) > FARTHEST_SLIDE:
            raise InvalidInput(f"leg {leg}: {a:.6g} to {b:.6g} is no slide's displacement")
    return box
