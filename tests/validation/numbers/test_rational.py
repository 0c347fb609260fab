"""The laws of rational numbers and of angles, and what they refuse to do."""

from __future__ import annotations

import math
import operator
from fractions import Fraction
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from krhpr.validation import numbers
from krhpr.validation.numbers import Angle, Ball, Exact, NotRational, Undefined
from tests.validation.numbers.strategies import floats, rationals

tangents = st.fractions(min_value=-50, max_value=50, max_denominator=50)
angles = st.builds(Angle.from_half_tangent, tangents)


@given(rationals, rationals)
def test_exact_operations_are_those_of_fractions(a: Fraction, b: Fraction) -> None:
    x, y = Exact(a), Exact(b)
    for operate in (operator.add, operator.sub, operator.mul):
        for result in (operate(x, y), operate(x, b), operate(a, y)):
            assert isinstance(result, Exact)
            assert result.fraction == operate(a, b)
    for compare in (operator.eq, operator.ne, operator.lt, operator.le, operator.gt, operator.ge):
        assert compare(x, y) is compare(a, b)
        assert compare(a, y) is compare(a, b)
        assert compare(x, b) is compare(a, b)
    if b:
        assert (x / y).fraction == (a / y).fraction == (x / b).fraction == a / b
    assert (-x).fraction == -a
    assert abs(x).fraction == x.fabs().fraction == abs(a)
    assert (x**3).fraction == a**3
    assert hash(x) == hash(a)
    assert x.floor() == math.floor(a)
    assert x.minimum(y).fraction == min(a, b) and x.maximum(b).fraction == max(a, b)


@given(rationals, rationals, rationals)
def test_exact_numbers_are_a_field(a: Fraction, b: Fraction, c: Fraction) -> None:
    x, y, z = Exact(a), Exact(b), Exact(c)
    assert (x + y) + z == x + (y + z)
    assert x * (y + z) == x * y + x * z
    assert x - x == 0
    if x:
        assert x / x == 1
        assert x**-2 == 1 / (x * x)


@given(floats, rationals)
def test_floats_count_by_their_exact_value(f: float, a: Fraction) -> None:
    x, value = Exact(a), Fraction(f)
    assert (x + f).fraction == (f + x).fraction == a + value
    assert (f - x).fraction == value - a
    assert (x * np.float64(f)).fraction == a * value
    assert (np.float64(f) * x).fraction == a * value
    assert (x < f) is (a < value)
    assert Exact(f).to_float() == f


@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf])
def test_floats_that_are_no_numbers_raise(value: float) -> None:
    for operate in (operator.add, operator.mul, operator.lt, operator.eq):
        with pytest.raises(NotRational):
            operate(Exact(1), value)
    with pytest.raises(NotRational):
        Ball(value)


def test_exact_reads_text_and_integers() -> None:
    assert Exact("0.1") == Fraction(1, 10)
    assert Exact("2/6") == Fraction(1, 3)
    assert Exact("1_000.5e1") == 10005
    assert Exact(np.int64(7)) + np.int32(1) == 8
    with pytest.raises(TypeError):
        Exact(1j)
    with pytest.raises(TypeError):
        Exact(1) + "1"


@given(rationals, rationals)
def test_roots_exist_where_they_are_rational(a: Fraction, b: Fraction) -> None:
    assert Exact(a * a).sqrt() == abs(a)
    for square in (2 * a * a, -a * a):
        if a:
            with pytest.raises(NotRational):
                Exact(square).sqrt()
    # (m^2 - n^2, 2 m n) is of the length m^2 + n^2.
    leg, other = Exact(a * a - b * b), Exact(2 * a * b)
    assert leg.hypot(other) == a * a + b * b
    if a or b:
        angle = other.arctan2(leg)
        assert angle.cos() * leg.hypot(other) == leg
        assert angle.sin() * leg.hypot(other) == other


def test_what_is_not_rational_raises() -> None:
    with pytest.raises(ZeroDivisionError):
        Exact(1) / 0
    with pytest.raises(ZeroDivisionError):
        1 / Exact(0)
    with pytest.raises(ZeroDivisionError):
        Exact(0) ** -1
    with pytest.raises(NotRational):
        Exact(4) ** 0.5
    with pytest.raises(NotRational):
        Exact(1).sin()
    with pytest.raises(NotRational):
        Exact(1).arctan2(1)
    with pytest.raises(Undefined):
        Exact(0).arctan2(0)
    assert Exact(0).sin() == 0 and Exact(0).cos() == 1


@given(angles, angles, angles)
def test_angles_are_a_group(a: Angle, b: Angle, c: Angle) -> None:
    assert ((a + b) + c).congruent(a + (b + c))
    assert (a + b).congruent(b + a)
    assert (a - a).congruent(0)
    assert (a - b).congruent(-(b - a))
    exact_zero: Any = Exact(0)
    assert (a + 0).congruent(a) and (0 + a).congruent(a) and (exact_zero + a).congruent(a)
    assert (0 - a).congruent(-a) and (0.0 - a).congruent(-a) and (a - 0).congruent(a)
    assert a.cos() ** 2 + a.sin() ** 2 == 1


@given(angles, st.integers(-6, 6))
def test_multiples_of_angles(a: Angle, n: int) -> None:
    expected = Angle.zero()
    for _ in range(abs(n)):
        expected = expected + (a if n > 0 else -a)
    assert (n * a).congruent(expected)
    if n:
        assert (a * Exact(n)).congruent(expected)
        assert (float(n) * a).congruent(expected)
    else:  # a real zero times anything finite is the number zero
        assert a * Exact(0) == 0 and 0.0 * a == 0


@given(tangents, tangents)
def test_angles_agree_with_floats(s: Fraction, t: Fraction) -> None:
    a, b = Angle.from_half_tangent(s), Angle.from_half_tangent(t)
    alpha, beta = 2 * math.atan(s), 2 * math.atan(t)
    for angle, value in ((a, alpha), (a + b, alpha + beta), (a - 3 * b, alpha - 3 * beta)):
        assert angle.sin().to_float() == pytest.approx(math.sin(value), abs=1e-12)
        assert angle.cos().to_float() == pytest.approx(math.cos(value), abs=1e-12)
    assert a.to_float() == pytest.approx(alpha, abs=1e-12)


def test_half_and_full_turns() -> None:
    assert (2 * Angle.half_turn()).congruent(0)
    assert Exact(0).arctan2(-1).congruent(Angle.half_turn())
    assert Exact(3).arctan2(-4).congruent(Angle("-4/5", "3/5"))
    assert not Angle(0, 1).congruent(Angle(0, -1))
    with pytest.raises(ValueError, match="unit circle"):
        Angle(1, 1)


@pytest.mark.parametrize(
    "misuse",
    [
        lambda a: a * Exact("1/2"),
        lambda a: 0.5 * a,
        lambda a: a * a,
        lambda a: a / 2,
        lambda a: 1 / a,
        lambda a: a**2,
        lambda a: a + 1,
        lambda a: Exact(1) - a,
        lambda a: Ball(0) + a,
        lambda a: a * Ball(2),
        lambda a: a < 1,
        lambda a: a >= a,
        lambda a: a == 0,
        lambda a: a != a,
        abs,
        bool,
        lambda a: numbers.fmin(a, a),
        numbers.sqrt,
    ],
)
def test_angles_refuse_what_needs_their_size(misuse: Any) -> None:
    with pytest.raises(TypeError, match=r"[Aa]ngle|minimum|sqrt"):
        misuse(Angle("3/5", "4/5"))
