"""Real numbers enclosed by intervals."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from fractions import Fraction

from flint import arb, ctx

from krhpr.validation.numbers.errors import NotRational, Undecidable, Undefined
from krhpr.validation.numbers.rational import Exact, rational

DEFAULT_BITS = 300
DEFAULT_TOLERANCE = Fraction(1, 10**60)


@contextmanager
def ball_precision(bits: int = DEFAULT_BITS) -> Iterator[None]:
    """Within the context, balls are computed with `bits` bits; the former precision comes back after it.

    The precision is a global of the library, hence shared by all threads.  Outside such a context the
    enclosures stay true but are as wide as the library's 53 bits make them.
    """
    former = ctx.prec
    ctx.prec = bits
    try:
        yield
    finally:
        ctx.prec = former


def _enclosure(value: object) -> arb | None:
    if isinstance(value, Ball):
        return value._value
    if isinstance(value, arb):
        return value
    number = rational(value)
    if number is None:
        return None
    denominator = int(number.q)
    if denominator & (denominator - 1) == 0:  # floats, integers: exact at every precision
        return arb((int(number.p), 1 - denominator.bit_length()))
    return arb(number)


class Ball:
    """A real number enclosed by an interval: what holds for all of it holds, all else is `Undecidable`."""

    __slots__ = ("_value",)
    _value: arb

    __hash__ = None  # type: ignore[assignment]

    def __init__(self, value: object = 0) -> None:
        number = _enclosure(Fraction(value.replace("_", "")) if isinstance(value, str) else value)
        if number is None:
            raise TypeError(f"no real number: {value!r}")
        self._value = number

    @classmethod
    def _of(cls, value: arb) -> Ball:
        if not value.is_finite():
            raise Undefined("a ball operation has no finite enclosure")
        self = cls.__new__(cls)
        self._value = value
        return self

    @classmethod
    def around(cls, centre: object, radius: object) -> Ball:
        """The ball of all numbers within `radius` of `centre`."""
        return cls._of(arb(cls(centre)._value, cls(radius)._value))

    @classmethod
    def pi(cls) -> Ball:
        """An enclosure of pi at the present precision."""
        return cls._of(arb.pi())

    @property
    def enclosure(self) -> arb:
        """The value as a flint `arb`."""
        return self._value

    def to_float(self) -> float:
        """A float near the centre; by name only, since a silent conversion would be a rounding error."""
        return float(self._value.mid())

    def __repr__(self) -> str:
        return f"Ball({self._value.str(25)})"

    def __bool__(self) -> bool:
        return self != 0

    # Arithmetic

    def __add__(self, other: object) -> Ball:
        number = _enclosure(other)
        return NotImplemented if number is None else Ball._of(self._value + number)

    __radd__ = __add__

    def __sub__(self, other: object) -> Ball:
        number = _enclosure(other)
        return NotImplemented if number is None else Ball._of(self._value - number)

    def __rsub__(self, other: object) -> Ball:
        number = _enclosure(other)
        return NotImplemented if number is None else Ball._of(number - self._value)

    def __mul__(self, other: object) -> Ball:
        number = _enclosure(other)
        return NotImplemented if number is None else Ball._of(self._value * number)

    __rmul__ = __mul__

    def __truediv__(self, other: object) -> Ball:
        number = _enclosure(other)
        return NotImplemented if number is None else _ball_quotient(self._value, number)

    def __rtruediv__(self, other: object) -> Ball:
        number = _enclosure(other)
        return NotImplemented if number is None else _ball_quotient(number, self._value)

    def __pow__(self, exponent: object) -> Ball:
        number = rational(exponent)
        if number is None:
            return NotImplemented
        if number.q != 1:
            raise NotRational(f"power with the exponent {number}: only whole exponents are supported")
        if number < 0:
            return 1 / self ** Exact(-number)
        power = int(number.p)
        if power and self._value.mid() == 0:  # the library has no power of a ball around zero itself
            return Ball._of(arb(0, self._value.rad() ** power))
        return Ball._of(self._value**power)

    def __neg__(self) -> Ball:
        return Ball._of(-self._value)

    def __pos__(self) -> Ball:
        return self

    def __abs__(self) -> Ball:
        return Ball._of(abs(self._value))

    # Comparisons

    def __eq__(self, other: object) -> bool:
        number = _enclosure(other)
        if number is None:
            return NotImplemented
        return _decided(bool(self._value == number), not self._value.overlaps(number), self, "==", other)

    def __ne__(self, other: object) -> bool:
        number = _enclosure(other)
        if number is None:
            return NotImplemented
        return _decided(not self._value.overlaps(number), bool(self._value == number), self, "!=", other)

    def __lt__(self, other: object) -> bool:
        number = _enclosure(other)
        if number is None:
            return NotImplemented
        return _decided(bool(self._value < number), bool(self._value >= number), self, "<", other)

    def __le__(self, other: object) -> bool:
        number = _enclosure(other)
        if number is None:
            return NotImplemented
        return _decided(bool(self._value <= number), bool(self._value > number), self, "<=", other)

    def __gt__(self, other: object) -> bool:
        number = _enclosure(other)
        if number is None:
            return NotImplemented
        return _decided(bool(self._value > number), bool(self._value <= number), self, ">", other)

    def __ge__(self, other: object) -> bool:
        number = _enclosure(other)
        if number is None:
            return NotImplemented
        return _decided(bool(self._value >= number), bool(self._value < number), self, ">=", other)

    def overlaps(self, other: object) -> bool:
        """Whether the two enclosures have a number in common."""
        return bool(self._value.overlaps(_ball(other)._value))

    def hull(self, other: object) -> Ball:
        """The smallest ball around both."""
        return Ball._of(self._value.union(_ball(other)._value))

    def close(self, other: object, tolerance: object = DEFAULT_TOLERANCE) -> bool:
        """Whether the two numbers differ by `tolerance` at most; raises where the enclosures leave it open.

        The tolerance is absolute: scale the numbers, or it, if they are far from one.
        """
        difference: arb = abs(self._value - _ball(other)._value)
        bound = _ball(tolerance)._value
        within, beyond = bool(difference <= bound), bool(difference > bound)
        return _decided(within, beyond, self, f"within {float(bound.mid()):.3g} of", other)

    # Functions, under the names by which NumPy looks for them

    def fabs(self) -> Ball:
        """The absolute value."""
        return abs(self)

    def sqrt(self) -> Ball:
        """The root; raises unless the whole ball is non-negative."""
        if self._value >= 0:
            return Ball._of(self._value.sqrt())
        if self._value < 0:
            raise Undefined(f"the square root of the negative number {self!r}")
        raise Undecidable(f"the square root of {self!r}, which may be negative")

    def hypot(self, other: object) -> Ball:
        """The length of (self, other)."""
        number = _ball(other)._value
        square = self._value * self._value + number * number
        if not square >= 0:  # the enclosure is wider than the square, which is not negative
            return Ball._of(arb(0).union(square.upper().sqrt()))
        return Ball._of(square.sqrt())

    def sin(self) -> Ball:
        """The sine."""
        return Ball._of(self._value.sin())

    def cos(self) -> Ball:
        """The cosine."""
        return Ball._of(self._value.cos())

    def arctan2(self, x: object) -> Ball:
        """The direction of the vector (x, self); raises where the ball lies across the cut at pi."""
        ordinate, abscissa = self._value, _ball(x)._value
        if ordinate == 0 and abscissa == 0:
            raise Undefined("arctan2(0, 0): the zero vector has no direction")
        on_axis = ordinate == 0 and abscissa < 0
        if not (on_axis or abscissa > 0 or not ordinate.contains(0)):
            raise Undecidable(f"arctan2({self!r}, {x!r}) lies across the branch cut")
        return Ball._of(arb.atan2(ordinate, abscissa))

    def centre(self) -> Ball:
        """The middle of the enclosure, as a number without an error."""
        return Ball._of(self._value.mid())

    def minimum(self, other: object) -> Ball:
        """An enclosure of the smaller of the two, whichever it is."""
        return Ball._of(self._value.min(_ball(other)._value))

    def maximum(self, other: object) -> Ball:
        """An enclosure of the larger of the two, whichever it is."""
        return Ball._of(self._value.max(_ball(other)._value))

    def floor(self) -> Ball:
        """The largest whole number that is not larger; raises where the ball leaves it open."""
        low, high = self._value.lower().floor(), self._value.upper().floor()
        if not low == high:
            raise Undecidable(f"the floor of {self!r}")
        return Ball._of(low)


def _ball(value: object) -> Ball:
    return value if isinstance(value, Ball) else Ball(value)


def _ball_quotient(numerator: arb, denominator: arb) -> Ball:
    if denominator.contains(0):
        raise ZeroDivisionError("division by a ball that contains zero")
    return Ball._of(numerator / denominator)


def _decided(certain: bool, impossible: bool, left: object, relation: str, right: object) -> bool:
    if certain == impossible:
        raise Undecidable(f"{left!r} {relation} {right!r} is open at this precision")
    return certain
