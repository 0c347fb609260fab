"""Truncated Taylor series: the calculus of polynomials, exactly."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from krhpr.validation.jets import Jet, accelerations, coefficients, straight, turning
from krhpr.validation.linear import identity, matrix, times, transpose
from krhpr.validation.numbers import Angle, Ball, Exact, NotRational, ball_precision

rationals = st.fractions(min_value=-4, max_value=4, max_denominator=9)
jets = st.tuples(rationals, rationals, rationals).map(lambda c: Jet(*(Exact(x) for x in c)))
half_tangents = st.fractions(min_value=-3, max_value=3, max_denominator=7)


def polynomial(jet: Jet, time: Fraction) -> Fraction:
    a, b, c = (value.fraction for value in jet.c)
    return a + b * time + c * time**2


def same(a: Jet, b: Jet) -> bool:
    return all(x == y for x, y in zip(a.c, b.c, strict=True))


@given(jets, jets)
def test_products_are_those_of_polynomials(a: Jet, b: Jet) -> None:
    first, second = ([value.fraction for value in jet.c] for jet in (a, b))
    wanted = [sum(first[i] * second[k - i] for i in range(k + 1)) for k in range(3)]
    assert [value.fraction for value in (a * b).c] == wanted
    assert [value.fraction for value in (a + b).c] == [x + y for x, y in zip(first, second, strict=True)]
    assert same(a - b, a + (-b)) and same(2 * a, a + a) and same(1 - a, -(a - 1))
    assert polynomial(a, Fraction(1, 3)) == a.value + a.rate / 3 + a.acceleration / 18


@given(jets, jets)
def test_division_undoes_multiplication(a: Jet, b: Jet) -> None:
    if b.value == 0:
        with pytest.raises(ZeroDivisionError):
            _ = a / b
        return
    assert same(a / b * b, a)
    assert same(1 / b * b, Jet(Exact(1)))


@given(half_tangents, rationals, rationals)
def test_sine_and_cosine(half: Fraction, rate: Fraction, second: Fraction) -> None:
    angle = Jet.motion(Angle.from_half_tangent(half), Exact(rate), Exact(second))
    sine, cosine = angle.sin(), angle.cos()
    assert same(sine * sine + cosine * cosine, Jet(Exact(1)))
    assert sine.rate == cosine.value * rate
    assert cosine.acceleration == -sine.value * second - cosine.value * rate * rate
    back = sine.arctan2(cosine)
    assert back.value.congruent(angle.value) and back.rate == rate and back.acceleration == second
    doubled = angle + angle
    assert same(doubled.sin(), 2 * sine * cosine)


@given(jets)
def test_roots(a: Jet) -> None:
    square = a * a
    if a.value == 0:
        return
    root = square.sqrt()
    assert same(root, a if a.value > 0 else -a)
    with pytest.raises(NotRational):
        (square * 2).sqrt()


def test_the_smaller_and_the_larger_keep_their_rates() -> None:
    low, high = Jet(Exact(1), Exact(5), Exact(7)), Jet(Exact(2), Exact(-3), Exact(0))
    assert low.minimum(high) is low and high.minimum(low) is low
    assert low.maximum(high) is high and high.maximum(low) is high
    assert low.maximum(3).c == (3, 0, 0)
    with pytest.raises(ValueError, match="kink"):
        low.minimum(Exact(1))


def test_balls_may_stand_in() -> None:
    with ball_precision():
        root = Jet(Ball(2), Ball(1), Ball(0)).sqrt()
        assert (root * root).rate.close(Ball(1)) and root.value.close(Ball(2).sqrt())


def test_a_turning_matrix_stays_a_rotation() -> None:
    q = [Exact(x) for x in ("3/5", "-4/5", 0, "4/5", "3/5", 0, 0, 0, 1)]
    turned = turning(q, [Exact(1), Exact(2), Exact("1/3")], [Exact(-1), Exact("1/2"), Exact(4)])
    m = matrix(turned, 3)
    product = [entry for row in times(transpose(m), m) for entry in row]
    assert coefficients(product, 0) == [entry for row in identity(3) for entry in row]
    assert coefficients(product, 1) == [0] * 9 and coefficients(product, 2) == [0] * 9


def test_motions() -> None:
    motion = straight([Exact(1), Exact(2)], [Exact(3), Exact(4)], [Exact(5), Exact(6)])
    assert coefficients(motion, 0) == [1, 2] and coefficients(motion, 1) == [3, 4]
    assert accelerations(motion) == [5, 6] and accelerations([Exact(7)]) == [0]
    values: list[Any] = [motion[0].derivative().value, motion[0].derivative().rate]
    assert values == [3, 5] and "Jet" in repr(motion[0])
