"""The walker over CasADi functions: agreement with CasADi's own evaluation, and exactness."""

from __future__ import annotations

import math
from fractions import Fraction
from typing import Any

import casadi as ca
import numpy as np
import pytest

from krhpr.validation.casadi_exact import UnknownOperation, evaluate
from krhpr.validation.numbers import BALL, FLOAT, Angle, Ball, Exact, NotRational, ball_precision


def leg() -> ca.Function:
    """A leg with three joints: end point and Jacobian, by CasADi's differentiation."""
    c, lengths, theta = ca.SX.sym("c", 3), ca.SX.sym("l", 2), ca.SX.sym("theta", 3)
    elbow = theta[1] + theta[2]
    radius = lengths[0] * ca.cos(theta[1]) + lengths[1] * ca.cos(elbow)
    height = lengths[0] * ca.sin(theta[1]) + lengths[1] * ca.sin(elbow)
    s = c + ca.vertcat(radius * ca.cos(theta[0]), radius * ca.sin(theta[0]), height)
    return ca.Function(
        "leg", [c, lengths, theta], [s, ca.jacobian(s, theta)], ["c", "l", "theta"], ["s", "M"]
    )


def everything() -> ca.Function:
    """One output for each operation that the walker knows."""
    x, y = ca.SX.sym("x"), ca.SX.sym("y")
    outputs = [
        x + y,
        x - y,
        x * y,
        x / y,
        -x,
        x * x,
        2 * x,
        x + x,
        1 / x,
        x**5,
        x**-3,
        x ** ca.SX(101),
        ca.sqrt(ca.fabs(x)),
        ca.sin(x),
        ca.cos(y),
        ca.atan2(x, y),
        ca.hypot(x, y),
        ca.fmin(x, y),
        ca.fmax(x, y),
        ca.sign(x),
        ca.floor(x),
        x < y,
        x <= y,
        ca.eq(x, y),
        ca.ne(x, y),
        ca.logic_and(x > 0, y > 0),
        ca.logic_or(x > 0, y > 0),
        ca.logic_not(x > 0),
        ca.if_else(x > y, x * y, x + y),
        0.75 * x + 3,
        ca.gradient(ca.fabs(x) * ca.fmax(x, y), x),
        ca.gradient(ca.hypot(x, y) * ca.atan2(y, x), x),
    ]
    return ca.Function("everything", [x, y], outputs)


def test_floats_agree_with_casadi(full: bool) -> None:
    f, rng = everything(), np.random.default_rng(3)
    for _ in range(1000 if full else 50):
        x, y = (float(value) for value in rng.uniform(-2, 2, 2))
        expected = [float(value) for value in f(x, y)]
        results = [matrix[0][0] for matrix in evaluate(f, [x, y], FLOAT)]
        assert results == pytest.approx(expected, rel=1e-14)
        with ball_precision():
            balls = [matrix[0][0] for matrix in evaluate(f, [x, y], BALL)]
            assert [value.to_float() for value in balls] == pytest.approx(expected, rel=1e-12)


def test_the_leg_is_exact() -> None:
    f = leg()
    angles = [Angle.from_half_tangent(Fraction(k, 5)) for k in (2, -3, 7)]
    lengths = [Fraction(1, 3), Fraction(2, 7)]
    s, m = evaluate(f, [[1, 2, 3], lengths, angles])
    radius = lengths[0] * angles[1].cos() + lengths[1] * (angles[1] + angles[2]).cos()
    assert s[0][0] == 1 + radius * angles[0].cos()
    assert [len(row) for row in s] == [1, 1, 1] and [len(row) for row in m] == [3, 3, 3]
    assert m[1][0] == radius * angles[0].cos() and m[2][1] == radius
    assert m[2][0] == 0 and all(isinstance(item, Exact) for row in m for item in row)
    expected = f(ca.DM([1, 2, 3]), ca.DM([1 / 3, 2 / 7]), ca.DM([angle.to_float() for angle in angles]))
    for ours, theirs in zip((s, m), expected, strict=True):
        floats = np.array([[item.to_float() for item in row] for row in ours])
        assert np.allclose(floats, np.array(theirs), atol=1e-14)


def test_matrices_are_column_major_and_may_be_sparse() -> None:
    a, b = ca.SX.sym("a", 2, 3), ca.SX.sym("b", ca.Sparsity.lower(2))
    f = ca.Function("f", [a, b], [b @ a, ca.SX(2, 3), 2 * b])
    rows: list[list[Any]] = [[1, 2, 3], [4, 5, 6]]
    flat = [1, 4, 2, 5, 3, 6]
    for argument in (flat, rows, np.array(rows), ca.DM(rows).elements()):
        # The entry 9 lies where b is structurally zero.
        product, zero, double = evaluate(f, [argument, [[1, 9], [2, 3]]])
        assert product == [[1, 2, 3], [14, 19, 24]]
        assert zero == [[0] * 3] * 2 and double == [[2, 0], [4, 6]]
    with pytest.raises(ValueError, match="6 entries"):
        evaluate(f, [flat[:5], [1, 2, 3, 4]])
    with pytest.raises(ValueError, match="2 x 3"):
        evaluate(f, [[[1, 2], [3, 4], [5, 6]], [1, 2, 3, 4]])
    with pytest.raises(ValueError, match="2 arguments"):
        evaluate(f, [flat])


def test_constants_are_doubles_unless_the_caller_knows_better() -> None:
    x = ca.SX.sym("x")
    f = ca.Function("f", [x], [x / 3 + 0.1])
    assert evaluate(f, [3])[0][0][0] == 1 + Fraction(0.1)
    known = {0.1: Fraction(1, 10)}
    assert evaluate(f, [3], constant=lambda c: known.get(c, c))[0][0][0] == Fraction(11, 10)


def test_what_cannot_be_done_raises() -> None:
    x, y = ca.SX.sym("x"), ca.MX.sym("y")
    with pytest.raises(UnknownOperation, match="OP_EXP"):
        evaluate(ca.Function("f", [x], [ca.exp(x)]), [1])
    with pytest.raises(UnknownOperation, match="no SX function"):
        evaluate(ca.Function("f", [y], [y + 1]), [1])
    with ball_precision(), pytest.raises(UnknownOperation, match="exponent"):
        evaluate(ca.Function("f", [x], [x**1.5]), [1], BALL)
    with pytest.raises(NotRational):
        evaluate(ca.Function("f", [x], [x**1.5]), [4])
    with pytest.raises(NotRational):
        evaluate(ca.Function("f", [x], [ca.sqrt(x)]), [2])
    with pytest.raises(ZeroDivisionError):
        evaluate(ca.Function("f", [x], [1 / x]), [0])
    power = ca.Function("f", [x], [x**1.5])
    assert math.isnan(evaluate(power, [-1.0], FLOAT)[0][0][0])
    with ball_precision():
        root = ca.Function("f", [x], [ca.sqrt(x)])
        assert evaluate(root, [2], BALL)[0][0][0].close(Ball(2).sqrt())
