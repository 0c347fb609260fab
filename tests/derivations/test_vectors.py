"""Small vector algebra: exact identities at random rational points."""

from __future__ import annotations

from fractions import Fraction

import pytest
import sympy as sp
from hypothesis import assume, given
from hypothesis import strategies as st

from krhpr.derivations.vectors import E, cross, cross2, determinant3, dot, solve3, solve_structured

rationals = st.fractions(min_value=-4, max_value=4, max_denominator=6).map(
    lambda x: sp.Rational(x.numerator, x.denominator)
)
vectors = st.lists(rationals, min_size=3, max_size=3).map(sp.Matrix)
matrices = st.lists(rationals, min_size=9, max_size=9).map(lambda v: sp.Matrix(3, 3, v))
patterns = st.lists(st.booleans(), min_size=9, max_size=9)


@given(vectors, vectors)
def test_products(a: sp.Matrix, b: sp.Matrix) -> None:
    assert dot(a, b) == (a.T * b)[0]
    assert cross(a, b) == a.cross(b)
    assert cross2(a[:2, 0], b[:2, 0]) == dot(E * a[:2, 0], b[:2, 0])


@given(matrices, vectors)
def test_cramers_rule(m: sp.Matrix, right: sp.Matrix) -> None:
    scaled, determinant = solve3(m, right)
    assert determinant == determinant3(m) == m.det()
    assert m * scaled == determinant * right


@given(matrices, patterns, vectors)
def test_structured_systems_are_solved_by_their_zeros(
    m: sp.Matrix, pattern: list[bool], right: sp.Matrix
) -> None:
    for index, kept in enumerate(pattern):
        if not kept:
            m[index] = 0
    assume(m.det() != 0)
    assert m * solve_structured(m, right) == right


def test_two_coupled_rows_and_more_than_three() -> None:
    m = sp.Matrix([[0, 0, 1], [2, 3, 5], [4, 5, 0]])
    assert m * solve_structured(m, sp.Matrix([1, 2, 3])) == sp.Matrix([1, 2, 3])
    with pytest.raises(ValueError, match="4 coupled rows"):
        solve_structured(sp.ones(4, 4), sp.Matrix([1, 2, 3, 4]))


@pytest.mark.parametrize("alone", [0, 1])
def test_a_quotient_that_is_used_twice_gets_a_name(alone: int) -> None:
    m, right = sp.Matrix([[2, 3], [5, 7]]), sp.Matrix([11, 0] if alone == 0 else [0, 11])
    named: list[sp.Expr] = []

    def name(quotient: sp.Expr) -> sp.Symbol:
        named.append(quotient)
        return sp.Symbol("q")

    solution = solve_structured(m, right, name)
    assert named == [sp.Rational(11, m.det())]
    assert m * solution.subs("q", named[0]) == right
    assert sum(entry.has(sp.Symbol("q")) for entry in solution) == 2


def test_the_quarter_turn() -> None:
    assert E * sp.Matrix([1, 0]) == sp.Matrix([0, 1]) and -sp.eye(2) == E * E
    assert dot(sp.Matrix([Fraction(1, 2)]), sp.Matrix([2])) == 1
