"""Numbers for running printed code without rounding: rationals, rational angles and 300-bit balls.

A printed kernel equals its derivation if both give the same numbers, and only arithmetic without rounding can
say "the same".  Three types behave like floats through the ordinary operators and through the methods that
NumPy calls on the elements of object arrays (`x.sqrt()`, `x.sin()`, `y.arctan2(x)`, ...):

`Exact`   a rational number; roots exist only where they are rational.
`Angle`   an angle known by its rational cosine and sine; sums, differences and integer multiples are exact.
`Ball`    a real number enclosed by an interval, for roots, arctangents and decimal constants.

None of them converts to `float` by itself (there is no `__float__`), so that a float array, `math.sqrt` or
`float(...)` in the code under test raises instead of rounding silently.  Not-a-number does not exist: what
has no value raises.  `Arithmetic` bundles what an evaluator needs to know about a type; the functions at the
end of the module (`sqrt`, `divide`, ...) apply to these types and, with the semantics of C, to floats.
"""

from __future__ import annotations

import math
import operator
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from fractions import Fraction
from typing import Any, NoReturn, TypeAlias, Union

from flint import arb, ctx, fmpq, fmpz

DEFAULT_BITS = 300
DEFAULT_TOLERANCE = Fraction(1, 10**60)


class ExactError(ArithmeticError):
    """Exact arithmetic cannot give the answer that was asked for."""


class NotRational(ExactError):
    """The result (or the operand) is no rational number."""


class Undecidable(ExactError):
    """The enclosures are too wide to decide a comparison or to choose a branch."""


class Undefined(ExactError):
    """The operation has no value there: the direction of the zero vector, the root of a negative ball."""


def _rational(value: object) -> fmpq | None:
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
        number = _rational(Fraction(value.replace("_", "")) if isinstance(value, str) else value)
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
        number = _rational(other)
        return NotImplemented if number is None else Exact._of(self._value + number)

    __radd__ = __add__

    def __sub__(self, other: object) -> Exact:
        number = _rational(other)
        return NotImplemented if number is None else Exact._of(self._value - number)

    def __rsub__(self, other: object) -> Exact:
        number = _rational(other)
        return NotImplemented if number is None else Exact._of(number - self._value)

    def __mul__(self, other: object) -> Exact:
        number = _rational(other)
        return NotImplemented if number is None else Exact._of(self._value * number)

    __rmul__ = __mul__

    def __truediv__(self, other: object) -> Exact:
        number = _rational(other)
        return NotImplemented if number is None else _quotient(self._value, number)

    def __rtruediv__(self, other: object) -> Exact:
        number = _rational(other)
        return NotImplemented if number is None else _quotient(number, self._value)

    def __pow__(self, exponent: object) -> Exact:
        number = _rational(exponent)
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
        number = _rational(other)
        return NotImplemented if number is None else bool(self._value == number)

    def __ne__(self, other: object) -> bool:
        number = _rational(other)
        return NotImplemented if number is None else bool(self._value != number)

    def __lt__(self, other: object) -> bool:
        number = _rational(other)
        return NotImplemented if number is None else bool(self._value < number)

    def __le__(self, other: object) -> bool:
        number = _rational(other)
        return NotImplemented if number is None else bool(self._value <= number)

    def __gt__(self, other: object) -> bool:
        number = _rational(other)
        return NotImplemented if number is None else bool(self._value > number)

    def __ge__(self, other: object) -> bool:
        number = _rational(other)
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
        if isinstance(value, Ball):
            return None
        number = _rational(value)
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
        number = None if isinstance(other, Angle | Ball) else _rational(other)
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
    if isinstance(value, Angle):
        return None
    number = _rational(value)
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
        number = _rational(exponent)
        if number is None:
            return NotImplemented
        if number.q != 1:
            raise NotRational(f"power with the exponent {number}: only whole exponents are supported")
        if number < 0:
            return 1 / self ** Exact._of(-number)
        return Ball._of(self._value ** int(number.p))

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


Number: TypeAlias = Union[Exact, Angle, Ball, float]  # noqa: UP007 (evaluated by name in the documentation)


@dataclass(frozen=True)
class Arithmetic:
    """What an evaluator needs to know of a number type.

    `real` makes a number from an int, Fraction or finite float, by its exact value.  `pi` is the value of
    M_PI and np.pi.  `fixed` says that numbers do not depend on a precision in force, so that constants may be
    converted once.
    """

    name: str
    real: Callable[[Any], Any]
    pi: Callable[[], Any]
    fixed: bool = True

    def lift(self, value: Any) -> Any:
        """`value` as a number of this type if it is a plain one; not-a-number and infinities stay floats."""
        if isinstance(value, float) and not math.isfinite(value):
            return float(value)
        if isinstance(value, Exact | Angle | Ball):
            return value
        return self.real(value)


FLOAT = Arithmetic("float", float, lambda: math.pi)
EXACT = Arithmetic("exact", Exact, Angle.half_turn)
BALL = Arithmetic("ball", Ball, Ball.pi, fixed=False)


def _call(method: str, operand: Any, *others: Any) -> Any:
    function = getattr(operand, method, None)
    if function is None:
        raise TypeError(f"no {method} of {operand!r} ({type(operand).__name__})")
    return function(*others)


def _matched(a: Any, b: Any) -> tuple[Any, Any]:
    """The operands, a float that meets an exact type being converted to it (raises for infinities)."""
    if isinstance(a, float) and isinstance(b, Exact | Ball):
        return type(b)(a), b
    return a, b


def sqrt(x: Any) -> Any:
    """The square root; for floats as in C."""
    if isinstance(x, float):
        return math.nan if x < 0 else math.sqrt(x)
    return _call("sqrt", x)


def sin(x: Any) -> Any:
    """The sine; for floats as in C."""
    if isinstance(x, float):
        return math.sin(x) if math.isfinite(x) else math.nan
    return _call("sin", x)


def cos(x: Any) -> Any:
    """The cosine; for floats as in C."""
    if isinstance(x, float):
        return math.cos(x) if math.isfinite(x) else math.nan
    return _call("cos", x)


def arctan2(y: Any, x: Any) -> Any:
    """The direction of (x, y); for floats as in C."""
    if isinstance(y, float) and isinstance(x, float):
        return math.atan2(y, x)
    y, x = _matched(y, x)
    return _call("arctan2", y, x)


def hypot(x: Any, y: Any) -> Any:
    """The length of (x, y); for floats as in C, but for the last bit (Python has a hypot of its own)."""
    if isinstance(x, float) and isinstance(y, float):
        return math.hypot(x, y)
    x, y = _matched(x, y)
    return _call("hypot", x, y)


def fabs(x: Any) -> Any:
    """The absolute value."""
    return abs(x)


def floor(x: Any) -> Any:
    """The largest whole number that is not larger; for floats as in C."""
    if isinstance(x, float):
        return float(math.floor(x)) if math.isfinite(x) else x
    return _call("floor", x)


def fmin(x: Any, y: Any) -> Any:
    """The smaller number, ignoring a float that is not a number, as in C."""
    return _extreme("minimum", min, x, y)


def fmax(x: Any, y: Any) -> Any:
    """The larger number, ignoring a float that is not a number, as in C."""
    return _extreme("maximum", max, x, y)


def _extreme(method: str, of_floats: Callable[[float, float], float], x: Any, y: Any) -> Any:
    if isnan(x):
        return y
    if isnan(y):
        return x
    if isinstance(x, float) and isinstance(y, float):
        return of_floats(x, y)
    x, y = _matched(x, y)
    return _call(method, x, y)


def isfinite(x: Any) -> bool:
    """Whether `x` is a finite number: all but two floats are."""
    return not isinstance(x, float) or math.isfinite(x)


def isnan(x: Any) -> bool:
    """Whether `x` is not a number: one float is."""
    return isinstance(x, float) and math.isnan(x)


def divide(x: Any, y: Any) -> Any:
    """The quotient; for floats by IEEE 754, so that x / 0 is infinite or not a number."""
    if isinstance(x, float) and isinstance(y, float) and y == 0:
        if x == 0 or math.isnan(x):
            return math.nan
        return math.copysign(math.inf, x) * math.copysign(1.0, y)
    return x / y


def same(a: Any, b: Any, tolerance: object = DEFAULT_TOLERANCE) -> bool:
    """Whether two results agree: equal rationals, congruent angles, balls certainly within `tolerance`."""
    if isinstance(a, Angle):
        return a.congruent(b)
    if isinstance(b, Angle):
        return b.congruent(a)
    if isinstance(a, Ball):
        return a.close(b, tolerance)
    if isinstance(b, Ball):
        return b.close(a, tolerance)
    if isnan(a) or isnan(b):
        return isnan(a) and isnan(b)
    return bool(a == b)
