"""Truncated Taylor series in time over exact numbers: what a formula does along a motion, to second
order, exactly.

A `Jet` is x(t) = x_0 + x_1 t + x_2 t^2 with coefficients of `Exact`, `Ball` or, for x_0,
`Angle`.  Formulas evaluated on jets give value, rate and half the acceleration at once, without anybody
having derived them.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from krhpr.validation.numbers import Ball, Exact

HALF = Exact("1/2")


class Jet:
    """x_0 + x_1 t + x_2 t^2, all higher powers dropped."""

    __slots__ = ("c",)

    def __init__(self, value: Any, rate: Any = 0, half_acceleration: Any = 0) -> None:
        self.c = (value, _number(rate), _number(half_acceleration))

    @classmethod
    def motion(cls, value: Any, rate: Any, acceleration: Any) -> Jet:
        """The series of something with this value, rate and acceleration."""
        return cls(value, rate, HALF * acceleration)

    @property
    def value(self) -> Any:
        """x(0)."""
        return self.c[0]

    @property
    def rate(self) -> Any:
        """The first derivative at 0."""
        return self.c[1]

    @property
    def acceleration(self) -> Any:
        """The second derivative at 0."""
        return 2 * self.c[2]

    def __repr__(self) -> str:
        return f"Jet{self.c!r}"

    def __abs__(self) -> Jet:
        return self if self.value > 0 else -self

    def __add__(self, other: Any) -> Jet:
        a, b = self.c, _jet(other).c
        return Jet(a[0] + b[0], a[1] + b[1], a[2] + b[2])

    __radd__ = __add__

    def __sub__(self, other: Any) -> Jet:
        return self.__add__(-_jet(other))

    def __rsub__(self, other: Any) -> Jet:
        return (-self).__add__(other)

    def __neg__(self) -> Jet:
        return Jet(-self.c[0], -self.c[1], -self.c[2])

    def __mul__(self, other: Any) -> Jet:
        a, b = self.c, _jet(other).c
        return Jet(a[0] * b[0], a[0] * b[1] + a[1] * b[0], a[0] * b[2] + a[1] * b[1] + a[2] * b[0])

    __rmul__ = __mul__

    def __truediv__(self, other: Any) -> Jet:
        a, b = self.c, _jet(other).c
        q_0 = a[0] / b[0]
        q_1 = (a[1] - q_0 * b[1]) / b[0]
        return Jet(q_0, q_1, (a[2] - q_0 * b[2] - q_1 * b[1]) / b[0])

    def __rtruediv__(self, other: Any) -> Jet:
        return _jet(other) / self

    # functions, under the names by which the evaluation of graphs looks for them

    def sqrt(self) -> Jet:
        """The root, where its value is one of the same kind of number."""
        a = self.c
        r_0 = a[0].sqrt()
        r_1 = a[1] / (2 * r_0)
        return Jet(r_0, r_1, (a[2] - r_1 * r_1) / (2 * r_0))

    def sin(self) -> Jet:
        """The sine."""
        a, s, c = self.c, self.c[0].sin(), self.c[0].cos()
        return Jet(s, c * a[1], c * a[2] - HALF * s * a[1] * a[1])

    def cos(self) -> Jet:
        """The cosine."""
        a, s, c = self.c, self.c[0].sin(), self.c[0].cos()
        return Jet(c, -s * a[1], -s * a[2] - HALF * c * a[1] * a[1])

    def arctan2(self, x: Any) -> Jet:
        """The direction of (x, self)."""
        y, x = self, _jet(x)
        rate = (x * y.derivative() - y * x.derivative()) / (x * x + y * y)
        return Jet(y.c[0].arctan2(x.c[0]), rate.c[0], HALF * rate.c[1])

    def minimum(self, other: Any) -> Jet:
        """The series with the smaller value; the values must differ, for there is a kink where they meet."""
        other = _jet(other)
        return self if _less(self, other) else other

    def maximum(self, other: Any) -> Jet:
        """The series with the larger value; the values must differ."""
        other = _jet(other)
        return other if _less(self, other) else self

    def derivative(self) -> Jet:
        """The rate as a series of its own, one order shorter."""
        return Jet(self.c[1], 2 * self.c[2])


def _less(a: Jet, b: Jet) -> bool:
    if a.value == b.value:
        raise ValueError(f"{a!r} and {b!r} meet: there is a kink")
    return bool(a.value < b.value)


def _jet(value: Any) -> Jet:
    return value if isinstance(value, Jet) else Jet(value)


def _number(value: Any) -> Any:
    return value if isinstance(value, Exact | Ball) else Exact(value)


def coefficients(jets: Sequence[Any], order: int) -> list[Any]:
    """One coefficient of each of several series; constants have none but the first."""
    return [_jet(item).c[order] for item in jets]


def accelerations(jets: Sequence[Any]) -> list[Any]:
    """Second derivatives."""
    return [_jet(item).acceleration for item in jets]


def straight(values: Sequence[Any], rates: Sequence[Any], second: Sequence[Any]) -> list[Jet]:
    """Motions with these values, rates and accelerations."""
    return [Jet.motion(*entry) for entry in zip(values, rates, second, strict=True)]


def turning(q: Sequence[Any], omega: Sequence[Any], alpha: Sequence[Any]) -> list[Jet]:
    """A rotation matrix (3 x 3, row by row) that turns with omega and its rate alpha: Q_dot = Omega Q."""
    spin, change = _skew(omega), _skew(alpha)
    first = _product(spin, q, 3)
    second = [a + b for a, b in zip(_product(change, q, 3), _product(spin, first, 3), strict=True)]
    return straight(q, first, second)


def _skew(v: Sequence[Any]) -> list[Any]:
    x, y, z = v
    return [0, -z, y, z, 0, -x, -y, x, 0]


def _product(a: Sequence[Any], b: Sequence[Any], n: int) -> list[Any]:
    return [
        sum((a[n * i + k] * b[n * k + j] for k in range(n)), Exact(0)) for i in range(n) for j in range(n)
    ]
