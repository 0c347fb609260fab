"""Exactness: rationals, balls, literals and constants."""

from __future__ import annotations

import math
from fractions import Fraction
from pathlib import Path

import pytest

from krhpr.validation.c_interpreter import Array, CProgram
from krhpr.validation.numbers import BALL, FLOAT, Angle, Ball, Exact, NotRational, ball_precision
from tests.validation.c_interpreter.sample import ANGLES, geometry


def test_the_leg_is_exact(files: list[Path]) -> None:
    program = CProgram.from_files(files)
    program.check()
    g = geometry(program, lambda k: Fraction(k + 1, 3))
    s, m = Array.unset(9), Array.unset(27)
    assert program.call("sample_robot_forward", g, ANGLES, s, m) == 0
    for i in range(3):
        leg, (t0, t1, t2) = g.leg[i], ANGLES[3 * i : 3 * i + 3]
        azimuth = t0 + Angle(leg.cos_psi, leg.sin_psi)
        radius = leg.l2 * t1.cos() + leg.l3 * (t1 + t2).cos()
        height = leg.l2 * t1.sin() + leg.l3 * (t1 + t2).sin()
        assert s[3 * i] == leg.c[0] + radius * azimuth.cos()
        assert s[3 * i + 1] == leg.c[1] + radius * azimuth.sin()
        assert s[3 * i + 2] == leg.c[2] + height
        assert m[9 * i] == -radius * azimuth.sin()
        assert m[9 * i + 6] == 0 and isinstance(m[9 * i + 6], Exact)


def test_the_inverse_is_exact_where_it_is_rational(files: list[Path]) -> None:
    program = CProgram.from_files(files)
    leg = program.new_struct("sample_leg")
    leg.c, leg.cos_psi, leg.sin_psi, leg.l2, leg.l3 = [0, 0, 0], 1, 0, 3, 4
    out = Array.unset(3)
    # A right angle at the elbow and a distance of five.
    assert program.call("sample_leg_inverse", leg, [3, 0, 4], 0, out) == 0
    assert out[2].congruent(Angle(0, 1)) and out[0].congruent(0)
    assert out[1].congruent(Angle("3/5", "4/5") - Angle("3/5", "4/5"))
    assert program.call("sample_leg_inverse", leg, [30, 0, 4], 1, out) == 11
    assert all(math.isnan(value) for value in out)
    with pytest.raises(NotRational) as raised:
        program.call("sample_leg_inverse", leg, [1, 1, 4], 0, out)
    assert any("sample.c:" in note for note in raised.value.__notes__)


def test_balls_give_the_same_point_back(files: list[Path]) -> None:
    with ball_precision():
        program = CProgram.from_files(files, BALL)
        g = geometry(program, lambda k: Fraction(1 + k % 5, 10))
        for leg in g.leg:
            leg.l2, leg.l3 = 1, Fraction(4, 5)
        theta, s, m = Array.unset(9), Array.unset(9), Array.unset(27)
        target = [Fraction(k, 10) for k in (3, 5, 8, 7, -4, 2, -6, 9, 6)]
        for i in range(3):
            point = target[3 * i : 3 * i + 3]
            part = Array.unset(3)
            assert program.call("sample_leg_inverse", g.leg[i], point, i % 2, part) == 0
            for k in range(3):
                theta[3 * i + k] = part[k]
        assert program.call("sample_robot_forward", g, theta, s, m) == 0
        assert all(isinstance(x, Ball) and x.close(y) for x, y in zip(s, target, strict=True))


def test_literals_are_the_decimals_that_they_show() -> None:
    text = "double f(double x) { return 0.1*x + 1e-3 + .5 + 2. + 0x1.8p1 + 1.25e2; }"
    expected = Fraction(1, 10) * 10 + Fraction(1, 1000) + Fraction(5, 2) + 3 + 125
    assert CProgram.from_text(text).call("f", 10) == expected
    assert CProgram.from_text(text, FLOAT).call("f", 10) == 0.1 * 10 + 1e-3 + 0.5 + 2.0 + 3.0 + 125.0
    with ball_precision():
        assert CProgram.from_text(text, BALL).call("f", 10).close(expected)


def test_constants_can_be_configured() -> None:
    text = """
    double f(void) { return 2*M_PI; }
    int g(double x) { return x > TINY; }
    double h(void) { return NAN; }
    """
    program = CProgram.from_text(text, constants={"TINY": Fraction(1, 10**6)})
    assert program.call("f").congruent(0)
    assert program.call("g", Fraction(2, 10**6)) == 1 and program.call("g", 0) == 0
    assert math.isnan(program.call("h"))
    with ball_precision():
        assert CProgram.from_text("double f(void) { return M_PI; }", BALL).call("f").close(Ball.pi())
    replaced = CProgram.from_text("double f(void) { return NAN; }", constants={"NAN": 0})
    assert replaced.call("f") == 0


def test_a_choice_between_equal_balls_encloses_both() -> None:
    program = CProgram.from_text("double larger(double a, double b) { return a > b ? a : b; }", BALL)
    with ball_precision():
        root = Ball(2).sqrt()
        assert program.call("larger", root, Ball(8).sqrt() / 2).close(root)
        assert program.call("larger", root, Ball(1)).close(root)
