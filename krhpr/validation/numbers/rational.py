"""Rational numbers, and the angles whose cosine and sine are rational."""

from __future__ import annotations

import math
import operator
from fractions import Fraction
from typing import NoReturn

from flint import fmpq, fmpz

from krhpr.validation.numbers.errors import NotRational, Undefined


def rational(value: object) -> fmpq | None:
    """`value` as a rational number, floats by their exact value; None if it is of another kind."""
    if isinstance(value, Exact):
        return value._value
    if isinstance(value, int):
        return fmpq(int(value))
    if isinstance(value, float):
        if not math.isfinite(value):
            raise NotRational(f"{float(value)} is no rational number")
        return fmpq(*value.as_integer_ratio())
    if isinstance(value, Fraction):
        return fmpq(value.numerator, value.denominator)
    if isinstance(value, fmpq):
        return value
    if isinstance(value, fmpz):
        return fmpq(value)
    try:
        return fmpq(operator.index(value))  # type: ignore[arg-type]
    except TypeError:
        return None


class Exact:
    """A rational number that stands in for a float."""

    __slots__ = ("_value",)
    _value: fmpq

    def __init__(self, value: object = 0) -> None:
        number = rational(Fraction(value.replace("_", "")) if isinstance(value, str) else value)
        if number is None:
            raise TypeError(f"no rational number: {value!r}")
        self._value = number

    @classmethod
    def _of(cls, value: fmpq) -> Exact:
        self = cls.__new__(cls)
        self._value = value
        return self

    @property
    def fraction(self) -> Fraction:
        """The value as a `Fraction`."""
        return Fraction(int(self._value.p), int(self._value.q))

    def to_float(self) -> float:
        """The nearest float; by name only, since a silent conversion would be a rounding error."""
        return float(self.fraction)

    def is_integer(self) -> bool:
        """Whether the value is a whole number."""
        return bool(self._value.q == 1)

    def __repr__(self) -> str:
        return f"Exact({str(self._value)!r})"

    def __str__(self) -> str:
        return str(self._value)

    def __hash__(self) -> int:
        return hash(self.fraction)

    def __bool__(self) -> bool:
        return bool(self._value != 0)

    # Arithmetic

    def __add__(self, other: object) -> Exact:
        number = rational(other)
        return NotImplemented if number is None else Exact._of(self._value + number)

    __radd__ = __add__

    def __sub__(self, other: object) -> Exact:
        number = rational(other)
        return NotImplemented if number is None else Exact._of(self._value - number)

    def __rsub__(self, other: object) -> Exact:
        number = rational(other)
        return NotImplemented if number is None else Exact._of(number - self._value)

    def __mul__(self, other: object) -> Exact:
        number = rational(other)
        return NotImplemented if number is None else Exact._of(self._value * number)

    __rmul__ = __mul__

    def __truediv__(self, other: object) -> Exact:
        number = rational(other)
        return NotImplemented if number is None else _quotient(self._value, number)

    def __rtruediv__(self, other: object) -> Exact:
        number = rational(other)
        return NotImplemented if number is None else _quotient(number, self._value)

    def __pow__(self, exponent: object) -> Exact:
        number = rational(exponent)
        if number is None:
            return NotImplemented
        if number.q != 1:
            raise NotRational(f"power with the exponent {number}: only whole exponents are rational")
        if self._value == 0 and number < 0:
            raise ZeroDivisionError("negative power of zero")
        return Exact._of(self._value ** int(number.p))

    def __neg__(self) -> Exact:
        return Exact._of(-self._value)

    def __pos__(self) -> Exact:
        return self

    def __abs__(self) -> Exact:
        return Exact._of(abs(self._value))

    # Comparisons

    def __eq__(self, other: object) -> bool:
        number = rational(other)
        return NotImplemented if number is None else bool(self._value == number)

    def __ne__(self, other: object) -> bool:
        number = rational(other)
        return NotImplemented if number is None else bool(self._value != number)

    def __lt__(self, other: object) -> bool:
        number = rational(other)
        return NotImplemented if number is None else bool(self._value < number)

    def __le__(self, other: object) -> bool:
        number = rational(other)
        return NotImplemented if number is None else bool(self._value <= number)

    def __gt__(self, other: object) -> bool:
        number = rational(other)
        return NotImplemented if number is None else bool(self._value > number)

    def __ge__(self, other: object) -> bool:
        number = rational(other)
        return NotImplemented if number is None else bool(self._value >= number)

    # Functions, under the names by which NumPy looks for them

    def fabs(self) -> Exact:
        """The absolute value."""
        return abs(self)

    def sqrt(self) -> Exact:
        """The root, if it is rational."""
        numerator, denominator = int(self._value.p), int(self._value.q)
        if numerator >= 0:
            root = Exact._of(fmpq(math.isqrt(numerator), math.isqrt(denominator)))
            if root._value * root._value == self._value:
                return root
        raise NotRational(f"the square root of {self} is not rational")

    def hypot(self, other: object) -> Exact:
        """The length of (self, other), if it is rational."""
        square: Exact = self * self + _exact(other) * _exact(other)
        return square.sqrt()

    def sin(self) -> Exact:
        """The sine, which is rational at zero only; angles are of type `Angle`."""
        if self:
            raise NotRational(f"the sine of {self} is not rational (angles are of type Angle)")
        return Exact(0)

    def cos(self) -> Exact:
        """The cosine, which is rational at zero only; angles are of type `Angle`."""
        if self:
            raise NotRational(f"the cosine of {self} is not rational (angles are of type Angle)")
        return Exact(1)

    def arctan2(self, x: object) -> Angle:
        """The direction of the vector (x, self), if its length is rational."""
        abscissa = _exact(x)
        length = self.hypot(abscissa)
        if not length:
            raise Undefined("arctan2(0, 0): the zero vector has no direction")
        return Angle(abscissa / length, self / length)

    def minimum(self, other: object) -> Exact:
        """The smaller of the two."""
        number = _exact(other)
        return self if self._value <= number._value else number

    def maximum(self, other: object) -> Exact:
        """The larger of the two."""
        number = _exact(other)
        return self if self._value >= number._value else number

    def floor(self) -> Exact:
        """The largest whole number that is not larger."""
        return Exact(math.floor(self.fraction))


def _exact(value: object) -> Exact:
    return value if isinstance(value, Exact) else Exact(value)


def _quotient(numerator: fmpq, denominator: fmpq) -> Exact:
    if denominator == 0:
        raise ZeroDivisionError(f"{numerator} / 0 in exact arithmetic")
    return Exact._of(numerator / denominator)


class Angle:
    """An angle known by its cosine and sine, both rational; full turns are not tracked.

    Angles add, subtract, change sign and take integer multiples.  They have no size, so that comparing or
    scaling them raises TypeError; `congruent` says whether two of them differ by full turns only.
    """

    __slots__ = ("_cos", "_sin")
    _cos: Exact
    _sin: Exact

    __hash__ = None  # type: ignore[assignment]

    def __init__(self, cosine: object, sine: object) -> None:
        self._cos, self._sin = _exact(cosine), _exact(sine)
        if self._cos * self._cos + self._sin * self._sin != 1:
            raise ValueError(f"({self._cos}, {self._sin}) is not on the unit circle")

    @classmethod
    def _of(cls, cosine: Exact, sine: Exact) -> Angle:
        self = cls.__new__(cls)
        self._cos, self._sin = cosine, sine
        return self

    @classmethod
    def from_half_tangent(cls, t: object) -> Angle:
        """The angle whose half has the tangent `t`: every rational angle but the half turn."""
        tangent = _exact(t)
        square: Exact = tangent * tangent
        return cls._of((1 - square) / (1 + square), 2 * tangent / (1 + square))

    @classmethod
    def zero(cls) -> Angle:
        """The zero angle."""
        return cls._of(Exact(1), Exact(0))

    @classmethod
    def half_turn(cls) -> Angle:
        """The angle pi."""
        return cls._of(Exact(-1), Exact(0))

    @classmethod
    def _lift(cls, value: object) -> Angle | None:
        """`value` as an angle: angles themselves, and the number zero."""
        if isinstance(value, Angle):
            return value
        number = rational(value)
        return cls.zero() if number is not None and number == 0 else None

    def __repr__(self) -> str:
        return f"Angle({str(self._cos)!r}, {str(self._sin)!r})"

    def sin(self) -> Exact:
        """The sine."""
        return self._sin

    def cos(self) -> Exact:
        """The cosine."""
        return self._cos

    def to_float(self) -> float:
        """The nearest float to the representative in (-pi, pi], but for rounding."""
        return math.atan2(self._sin.to_float(), self._cos.to_float())

    def congruent(self, other: object) -> bool:
        """Whether the two angles differ by full turns only (`other` may be the number zero)."""
        angle = Angle._lift(other)
        return angle is not None and self._cos == angle._cos and self._sin == angle._sin

    def __add__(self, other: object) -> Angle:
        angle = Angle._lift(other)
        if angle is None:
            _refuse("added to", other)
        return Angle._of(
            self._cos * angle._cos - self._sin * angle._sin, self._sin * angle._cos + self._cos * angle._sin
        )

    __radd__ = __add__

    def __sub__(self, other: object) -> Angle:
        angle = Angle._lift(other)
        if angle is None:
            _refuse("subtracted from or by", other)
        return self + (-angle)

    def __rsub__(self, other: object) -> Angle:
        return -self + other

    def __neg__(self) -> Angle:
        return Angle._of(self._cos, -self._sin)

    def __pos__(self) -> Angle:
        return self

    def __mul__(self, other: object) -> Angle | Exact:
        number = rational(other)
        if number is None or number.q != 1:
            _refuse("multiplied by", other)
        if number == 0 and isinstance(other, float | Exact):
            return Exact(0)  # 0.0 times anything finite is the number zero: how generated code tests for NaN
        count = int(number.p)
        power, result = (self if count >= 0 else -self), Angle.zero()
        count = abs(count)
        while count:
            if count & 1:
                result = result + power
            power, count = power + power, count >> 1
        return result

    __rmul__ = __mul__

    def __truediv__(self, other: object) -> NoReturn:
        _refuse("divided by", other)

    def __rtruediv__(self, other: object) -> NoReturn:
        _refuse("the divisor of", other)

    def __pow__(self, other: object) -> NoReturn:
        _refuse("raised to", other)

    def __eq__(self, other: object) -> bool:
        _refuse("compared with", other)

    def __ne__(self, other: object) -> bool:
        _refuse("compared with", other)

    def __lt__(self, other: object) -> bool:
        _refuse("compared with", other)

    def __le__(self, other: object) -> bool:
        _refuse("compared with", other)

    def __gt__(self, other: object) -> bool:
        _refuse("compared with", other)

    def __ge__(self, other: object) -> bool:
        _refuse("compared with", other)

    def __bool__(self) -> bool:  # noqa: PLE0304 (it never returns)
        _refuse("compared with", 0)

    def __abs__(self) -> NoReturn:
        raise TypeError("an Angle is known up to full turns and has no absolute value")


def _refuse(action: str, other: object) -> NoReturn:
    raise TypeError(
        f"an Angle cannot be {action} {other!r}: only sums, differences and integer multiples of angles "
        "are known from cosine and sine (congruent() tells whether two angles agree)"
    )
