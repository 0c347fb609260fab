"""Numbers a + b sqrt(3) with rational a, b: the field in which an equilateral platform lives."""

from __future__ import annotations

from typing import Any

from krhpr.validation.numbers import Angle, Exact


class Surd:
    """a + b sqrt(3), computed without rounding."""

    __slots__ = ("a", "b")
    __hash__ = None  # type: ignore[assignment]

    def __init__(self, a: Any, b: Any = 0) -> None:
        self.a, self.b = Exact(a), Exact(b)

    def __repr__(self) -> str:
        return f"Surd({self.a}, {self.b})"

    def __add__(self, other: Any) -> Surd:
        x = surd(other)
        return Surd(self.a + x.a, self.b + x.b)

    __radd__ = __add__

    def __neg__(self) -> Surd:
        return Surd(-self.a, -self.b)

    def __sub__(self, other: Any) -> Surd:
        return self + (-surd(other))

    def __rsub__(self, other: Any) -> Surd:
        return surd(other) - self

    def __mul__(self, other: Any) -> Surd:
        x = surd(other)
        return Surd(self.a * x.a + 3 * self.b * x.b, self.a * x.b + self.b * x.a)

    __rmul__ = __mul__

    def __truediv__(self, other: Any) -> Surd:
        x = surd(other)
        norm = x.a * x.a - 3 * x.b * x.b
        return self * Surd(x.a / norm, -x.b / norm)

    def __rtruediv__(self, other: Any) -> Surd:
        return surd(other) / self

    def __eq__(self, other: object) -> bool:
        x = surd(other)
        return self.a == x.a and self.b == x.b


def surd(value: Any) -> Surd:
    """A rational number as an element of the field."""
    return value if isinstance(value, Surd) else Surd(value)


ROOT = Surd(0, 1)
"""The square root of three."""


class SurdAngle:
    """An angle whose cosine and sine are of the field."""

    __slots__ = ("_cos", "_sin")

    def __init__(self, cosine: Any, sine: Any) -> None:
        self._cos, self._sin = surd(cosine), surd(sine)

    def cos(self) -> Surd:
        """The cosine."""
        return self._cos

    def sin(self) -> Surd:
        """The sine."""
        return self._sin

    def __neg__(self) -> SurdAngle:
        return SurdAngle(self._cos, -self._sin)

    def __add__(self, other: Any) -> SurdAngle:
        c, s = surd(other.cos()), surd(other.sin())
        return SurdAngle(self._cos * c - self._sin * s, self._sin * c + self._cos * s)

    __radd__ = __add__

    def __sub__(self, other: Any) -> SurdAngle:
        return self.__add__(-other)

    def __rsub__(self, other: Any) -> SurdAngle:
        return (-self).__add__(other)


def rational_angle(angle: Angle) -> SurdAngle:
    """A rational angle as one of the field."""
    return SurdAngle(angle.cos(), angle.sin())


THIRDS = (
    SurdAngle(1, 0),
    SurdAngle(Exact("-1/2"), Surd(0, Exact("1/2"))),
    SurdAngle(Exact("-1/2"), Surd(0, Exact("-1/2"))),
)
"""0, 120 and 240 degrees."""
