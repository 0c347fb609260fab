"""Numbers a + b sqrt(3) with a bound of their error: what generated functions are evaluated on for a proof.

Lengths are rational numbers, as doubles are, and sines and cosines of whole multiples of 30 degrees lie in
the field of sqrt(3), so that values for legs at 120 degrees and boxes such as (30, 150) degrees are exact,
zeros included.  Sines and cosines of other angles are doubles with a bound of their error.  Nothing else is
rounded.

An angle that is the double nearest to a whole multiple of 30 degrees (within `NOMINAL`) means that multiple.
"""

from __future__ import annotations

import math
from fractions import Fraction
from typing import Any

NOMINAL = 2.0**-51
"""Error, relative to the angle or to one radian, within which an angle is a multiple of 30 degrees."""

_LIBRARY = Fraction(1, 2**50)
"""More than the error of a sine or cosine from the C library, which is below one unit in the last place."""

_BITS = 256
_ROOT = Fraction(math.isqrt(3 << (2 * _BITS)), 1 << _BITS)
_ROOT_ABOVE = _ROOT + Fraction(1, 1 << _BITS)


class Number:
    """A real number within `error` of a + b sqrt(3)."""

    __slots__ = ("a", "b", "error")
    __hash__ = None  # type: ignore[assignment]

    def __init__(self, a: Fraction, b: Fraction = Fraction(0), error: Fraction = Fraction(0)) -> None:
        self.a, self.b, self.error = a, b, error

    def __repr__(self) -> str:
        return f"Number({float(self.a + self.b * _ROOT)!r} within {float(self.error):.3g})"

    # -- arithmetic -----------------------------------------------------------------------------------------

    def __add__(self, other: Any) -> Number:
        x = number(other)
        return Number(self.a + x.a, self.b + x.b, self.error + x.error)

    __radd__ = __add__

    def __neg__(self) -> Number:
        return Number(-self.a, -self.b, self.error)

    def __sub__(self, other: Any) -> Number:
        return self + (-number(other))

    def __rsub__(self, other: Any) -> Number:
        return number(other) - self

    def __mul__(self, other: Any) -> Number:
        x = number(other)
        error = Fraction(0)
        if self.error or x.error:
            error = self._size() * x.error + x._size() * self.error + self.error * x.error
        return Number(self.a * x.a + 3 * self.b * x.b, self.a * x.b + self.b * x.a, error)

    __rmul__ = __mul__

    def __truediv__(self, other: Any) -> Number:
        x = number(other)
        if x.sign() in (0, None):
            raise ZeroDivisionError(f"division by {x!r}")
        norm = x.a * x.a - 3 * x.b * x.b
        inverse = Number(x.a / norm, -x.b / norm)
        if x.error:
            least = min(abs(x.low()), abs(x.high()))
            inverse.error = x.error / (least * least)
        return self * inverse

    def __rtruediv__(self, other: Any) -> Number:
        return number(other) / self

    def __eq__(self, other: object) -> bool:
        x = number(other)
        return (self.a, self.b, self.error) == (x.a, x.b, x.error)

    def sqrt(self) -> Number:
        """The square root of a number that is not negative."""
        low, high = max(self.low(), Fraction(0)), self.high()
        if high < 0:
            raise ValueError(f"square root of {self!r}")
        bottom, top = Fraction(_down(math.sqrt(_below(low)))), Fraction(_up(math.sqrt(_above(high))))
        return Number((bottom + top) / 2, error=(top - bottom) / 2)

    # -- bounds ---------------------------------------------------------------------------------------------

    def low(self) -> Fraction:
        """A rational number that is not above it, and within 1e-70 of the largest one."""
        return self.a - self.error + self.b * (_ROOT if self.b >= 0 else _ROOT_ABOVE)

    def high(self) -> Fraction:
        """A rational number that is not below it, and within 1e-70 of the smallest one."""
        return self.a + self.error + self.b * (_ROOT_ABOVE if self.b >= 0 else _ROOT)

    def sign(self) -> int | None:
        """+1, -1 or 0; None where the error leaves it open."""
        if self.error:
            return 1 if self.low() > 0 else -1 if self.high() < 0 else None
        if not self.b or not self.a or (self.a > 0) == (self.b > 0):
            leading = self.a or self.b
        else:
            leading = self.a if self.a * self.a > 3 * self.b * self.b else self.b
        return (leading > 0) - (leading < 0)

    def nearest(self) -> float:
        """The double next to its middle."""
        return float(self.a + self.b * _ROOT)

    def below(self) -> float:
        """A double that is not above it."""
        return _below(self.low())

    def _size(self) -> Fraction:
        """At least the absolute value of its middle."""
        return abs(self.a) + abs(self.b) * _ROOT_ABOVE


def number(value: Any) -> Number:
    """A number of the ordinary kinds, by its exact value."""
    return value if isinstance(value, Number) else Number(Fraction(value))


class Angle:
    """An angle as its cosine and sine."""

    __slots__ = ("_cos", "_sin")

    def __init__(self, cosine: Number, sine: Number) -> None:
        self._cos, self._sin = cosine, sine

    @classmethod
    def of(cls, radians: float) -> Angle:
        """An angle given as a double; see `multiple` for those that mean a multiple of 30 degrees."""
        count = multiple(radians)
        if count is not None:
            return cls(_COSINES[count % 12], _COSINES[(count - 3) % 12])
        cosine, sine = Fraction(math.cos(radians)), Fraction(math.sin(radians))
        return cls(Number(cosine, error=_LIBRARY), Number(sine, error=_LIBRARY))

    def cos(self) -> Number:
        """The cosine."""
        return self._cos

    def sin(self) -> Number:
        """The sine."""
        return self._sin


def multiple(radians: float) -> int | None:
    """How many times 30 degrees an angle is, None where it is no whole multiple."""
    count = round(radians / (math.pi / 6))
    return count if abs(radians - count * (math.pi / 6)) <= NOMINAL * max(1.0, abs(radians)) else None


def _cosines() -> tuple[Number, ...]:
    half, root = Fraction(1, 2), Fraction(1, 2)
    quarter = [Number(Fraction(1)), Number(Fraction(0), root), Number(half), Number(Fraction(0))]
    first = [*quarter, -quarter[2], -quarter[1]]
    return (*first, *(-value for value in first))


_COSINES = _cosines()
"""Cosines of 0, 30, ..., 330 degrees."""


def _below(value: Fraction) -> float:
    near = float(value)
    return near if Fraction(near) <= value else _down(near)


def _above(value: Fraction) -> float:
    near = float(value)
    return near if Fraction(near) >= value else _up(near)


def _down(value: float) -> float:
    return math.nextafter(value, -math.inf)


def _up(value: float) -> float:
    return math.nextafter(value, math.inf)
