"""Functions of all types, and what an evaluator knows of a type."""

from __future__ import annotations

import math
from fractions import Fraction
from typing import Any

import numpy as np
import pytest

from krhpr.validation import numbers
from krhpr.validation.numbers import BALL, EXACT, FLOAT, Angle, Ball, Exact, ball_precision, same


@pytest.mark.parametrize("number", [Exact(1), Angle.zero(), Ball(1)])
def test_nothing_turns_into_a_float_silently(number: Any) -> None:
    with pytest.raises(TypeError):
        float(number)
    with pytest.raises(TypeError):
        math.sqrt(number)
    with pytest.raises(TypeError):
        np.zeros(2)[0] = number
    with pytest.raises(TypeError):
        np.array([number]).astype(float)
    assert isinstance(number.to_float(), float)


def test_float_functions_are_those_of_c() -> None:
    assert math.isnan(numbers.sqrt(-1.0)) and math.isnan(numbers.sin(math.inf))
    assert math.isnan(numbers.cos(-math.inf))
    assert numbers.divide(1.0, 0.0) == math.inf and numbers.divide(1.0, -0.0) == -math.inf
    assert math.isnan(numbers.divide(0.0, 0.0))
    assert numbers.fmin(math.nan, 1.0) == numbers.fmax(1.0, math.nan) == 1.0
    assert numbers.fmax(math.nan, Exact(2)) == 2
    assert numbers.hypot(3.0, Exact(4)) == 5
    assert numbers.arctan2(0.0, Exact(-1)).congruent(Angle.half_turn())


def test_same_compares_each_type_in_its_way() -> None:
    assert same(Exact(1), 1) and same(1, Exact(1)) and not same(Exact(1), 2)
    assert same(Angle.zero(), 0) and same(0, Angle.zero()) and not same(Angle.half_turn(), 0)
    assert same(math.nan, math.nan) and not same(math.nan, 1.0) and same(0.5, Exact("1/2"))
    with ball_precision():
        assert same(Ball(2).sqrt() ** 2, 2) and same(2, Ball(2).sqrt() ** 2)
        assert not same(Ball(2).sqrt(), 1.4142135623730951)


def test_arithmetics_lift_plain_numbers() -> None:
    tenth = Fraction(1, 10)
    assert EXACT.lift(tenth) == tenth and isinstance(EXACT.lift(2), Exact)
    assert isinstance(BALL.lift(Exact(2)), Exact) and isinstance(BALL.lift(2), Ball)
    assert FLOAT.lift(tenth) == 0.1 and type(FLOAT.lift(np.float64(1))) is float
    assert math.isnan(EXACT.lift(math.nan))
    angle = Angle.half_turn()
    assert EXACT.lift(angle) is angle
