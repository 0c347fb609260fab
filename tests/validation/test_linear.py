"""Linear algebra without rounding, and the field of rationals with the root of three."""

from __future__ import annotations

from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st

from krhpr.validation.linear import (
    apply,
    cross,
    determinant,
    dot,
    identity,
    matrix,
    minus,
    plus,
    scaled,
    solve,
    times,
    transpose,
)
from krhpr.validation.numbers import Angle, Ball, Exact, ball_precision
from krhpr.validation.proofs.surd import ROOT, THIRDS, Surd, SurdAngle, rational_angle, surd

rationals = st.fractions(min_value=-3, max_value=3, max_denominator=5)
squares = st.lists(rationals, min_size=9, max_size=9).map(lambda v: matrix([Exact(x) for x in v], 3))
surds = st.tuples(rationals, rationals).map(lambda c: Surd(*c))


@given(squares, squares)
def test_determinants_multiply(a: list[list[Exact]], b: list[list[Exact]]) -> None:
    assert determinant(times(a, b)) == determinant(a) * determinant(b)
    assert determinant(transpose(a)) == determinant(a)
    assert determinant(a) == dot(a[0], cross(a[1], a[2]))


@given(squares, squares)
def test_solving(a: list[list[Exact]], b: list[list[Exact]]) -> None:
    if determinant(a) == 0:
        with pytest.raises(ZeroDivisionError):
            solve(a, b)
        return
    assert times(a, solve(a, b)) == b
    assert solve(a, a) == identity(3)


def test_vectors() -> None:
    v, w = [Exact(1), Exact(2), Exact(3)], [Exact(-1), Exact(0), Exact(5)]
    assert minus(plus(v, w), w) == v and scaled(2, v) == plus(v, v)
    assert dot(cross(v, w), v) == 0 and apply(identity(3), w) == w
    assert determinant([[Exact(0), Exact(2)], [Exact(3), Exact(1)]]) == -6


def test_balls_pivot_too() -> None:
    with ball_precision():
        a = [[Ball(0), Ball(2)], [Ball(3), Ball(1)]]
        assert determinant(a).close(Ball(-6))
        (x,), (y,) = solve(a, [[Ball(4)], [Ball(11)]])
        assert x.close(Ball(3)) and y.close(Ball(2))


@given(surds, surds, surds)
def test_surds_are_a_field(a: Surd, b: Surd, c: Surd) -> None:
    assert a + b == b + a and (a + b) * c == a * c + b * c and a - a == Surd(0)
    assert 1 - a == -(a - 1) and 2 * a == a + a
    if b != Surd(0):
        assert a / b * b == a and 1 / b * b == Surd(1)


def test_the_root_of_three() -> None:
    assert Surd(3) == ROOT * ROOT and surd(Fraction(1, 2)) + ROOT == Surd(Fraction(1, 2), 1)
    total = THIRDS[0]
    for angle in THIRDS:
        assert angle.cos() * angle.cos() + angle.sin() * angle.sin() == Surd(1)
        total = THIRDS[1] + angle
    assert total.cos() == Surd(1) and total.sin() == Surd(0)
    angle = rational_angle(Angle("3/5", "4/5"))
    both = THIRDS[1] + angle
    assert (both - angle).cos() == THIRDS[1].cos() and isinstance(angle - both, SurdAngle)
