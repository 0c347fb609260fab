"""Balls enclose, and what they leave open raises."""

from __future__ import annotations

import operator
from collections.abc import Iterator
from fractions import Fraction

import mpmath
import pytest
from flint import ctx
from hypothesis import given

from krhpr.validation.numbers import Ball, Exact, Undecidable, Undefined, ball_precision
from tests.validation.numbers.strategies import floats, rationals


@pytest.fixture
def ball_bits() -> Iterator[None]:
    with ball_precision():
        yield


@given(rationals, rationals)
def test_balls_enclose_exact_results(a: Fraction, b: Fraction) -> None:
    with ball_precision(100):
        x, y = Ball(a), Ball(b)
        for operate in (operator.add, operator.sub, operator.mul):
            for result in (operate(x, y), operate(x, b), operate(a, y), operate(Exact(a), y)):
                assert isinstance(result, Ball)
                assert result.close(operate(a, b), 1e-20)
        if b:
            assert (x / y).close(a / b, 1e-20) and (a / y).close(a / b, 1e-20)
            assert (y**-3).close(Exact(b) ** -3, Fraction(1, 10**9))
        assert (-x).close(-a, 1e-20) and abs(x).close(abs(a), 1e-20)
        assert x.minimum(y).close(min(a, b), 1e-20) and x.maximum(b).close(max(a, b), 1e-20)
        if a != b:
            assert (x < y) is (a < b)
            assert (x >= b) is (a >= b)
            assert (x == y) is False and (x != y) is True


@given(rationals, rationals)
def test_ball_functions_agree_with_mpmath(a: Fraction, b: Fraction) -> None:
    with ball_precision(), mpmath.workdps(95):
        x, y = mpmath.mpf(a.numerator) / a.denominator, mpmath.mpf(b.numerator) / b.denominator
        pairs = [(Ball(a).sin(), mpmath.sin(x)), (Ball(a).cos(), mpmath.cos(x))]
        pairs.append((abs(Ball(a)).sqrt(), mpmath.sqrt(abs(x))))
        pairs.append((Ball(a).hypot(b), mpmath.sqrt(x * x + y * y)))
        pairs.append((Ball.pi(), +mpmath.pi))
        if a:
            pairs.append((Ball(a).arctan2(b), mpmath.atan2(x, y)))
        for ball, reference in pairs:
            assert ball.close(Exact(mpmath.nstr(reference, 93)), Fraction(1, 10**80))


@pytest.mark.usefixtures("ball_bits")
def test_powers_of_balls_around_zero() -> None:
    around = Ball.around(0, Fraction(1, 8))
    for power in (1, 2, 3):
        for inside in (Fraction(-1, 8), Fraction(0), Fraction(1, 8)):
            assert (around**power).overlaps(inside**power)
        assert abs(around**power) < Fraction(1, 8) ** power + Fraction(1, 1000)
    assert around**0 == 1
    with pytest.raises(ZeroDivisionError):
        _ = around**-1


@given(floats)
def test_balls_take_floats_by_their_exact_value(f: float) -> None:
    with ball_precision(10):
        assert Ball(f) == Fraction(f)


def test_the_precision_is_not_leaked() -> None:
    before = ctx.prec
    with pytest.raises(KeyError), ball_precision(500):
        assert ctx.prec == 500
        with ball_precision():
            assert ctx.prec == 300
        assert ctx.prec == 500
        raise KeyError
    assert ctx.prec == before


@pytest.mark.usefixtures("ball_bits")
def test_open_comparisons_raise() -> None:
    wide, third = Ball.around(0, 1), Ball(Fraction(1, 3))
    for compare in (operator.lt, operator.le, operator.gt, operator.ge, operator.eq, operator.ne):
        with pytest.raises(Undecidable):
            compare(wide, 0)
    with pytest.raises(Undecidable):
        assert third == Fraction(1, 3)
    with pytest.raises(Undecidable):
        bool(wide)
    assert wide < 2 and wide > -2 and wide != 2
    assert Ball(2) == 2 and operator.ne(Ball(2), 2) is False
    assert third.overlaps(Fraction(1, 3)) and not third.overlaps(Fraction(1, 3) + Fraction(1, 10**80))
    assert third.close(Fraction(1, 3)) and third.close(Fraction(1, 3) + Fraction(1, 10**61))
    assert not third.close(Fraction(1, 3) + Fraction(1, 10**59))
    with pytest.raises(Undecidable):
        wide.close(0)


@pytest.mark.usefixtures("ball_bits")
def test_ball_functions_at_the_edge_of_their_domain() -> None:
    wide = Ball.around(0, 1)
    with pytest.raises(ZeroDivisionError):
        1 / wide
    with pytest.raises(ZeroDivisionError):
        wide / Exact(0)
    with pytest.raises(Undecidable):
        wide.sqrt()
    with pytest.raises(Undefined):
        Ball(-1).sqrt()
    assert Ball(0).sqrt() == 0
    assert Ball(-2).floor() == -2 and Ball(Fraction(-7, 3)).floor() == -3
    with pytest.raises(Undecidable):
        wide.floor()
    assert wide.hypot(0) < 1.5
    with pytest.raises(Undecidable):
        wide.arctan2(-1)
    with pytest.raises(Undefined):
        Ball(0).arctan2(0)
    assert Ball(0).arctan2(-1).close(Ball.pi())
    assert wide.arctan2(2) < 1
    assert Ball(1).arctan2(wide) > 0
