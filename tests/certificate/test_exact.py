"""Numbers of certificates: no rounding but what their errors say, and factors that equal the derivation."""

from __future__ import annotations

import math
from fractions import Fraction

import mpmath
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from krhpr.certificate.exact import Angle, Number, multiple, number
from krhpr.certificate.factors import Form, factors
from krhpr.derivations.catalogue import catalogue
from krhpr.validation.numbers import Angle as RationalAngle
from krhpr.validation.numbers import Exact
from krhpr.validation.proofs.singularities import closed_form
from tests.certificate.support import ROBOTS, load, margins

rationals = st.fractions(-5, 5, max_denominator=99)
errors = st.fractions(0, Fraction(1, 10), max_denominator=999)
numbers = st.builds(Number, rationals, rationals, errors)

mpmath.mp.dps = 60


def real(a: Fraction, b: Fraction = Fraction(0)) -> mpmath.mpf:
    root = mpmath.sqrt(3)
    return mpmath.mpf(a.numerator) / a.denominator + root * b.numerator / b.denominator


def holds(value: Number, wanted: mpmath.mpf) -> bool:
    tiny = mpmath.mpf(10) ** -40
    return bool(real(value.low()) - tiny <= wanted <= real(value.high()) + tiny)


@given(numbers, numbers, st.floats(-1, 1), st.floats(-1, 1))
def test_results_hold_what_they_stand_for(x: Number, y: Number, s: float, t: float) -> None:
    a = real(x.a, x.b) + mpmath.mpf(s) * real(x.error)
    b = real(y.a, y.b) + mpmath.mpf(t) * real(y.error)
    assert holds(x + y, a + b) and holds(x - y, a - b) and holds(x * y, a * b) and holds(-x, -a)
    assert holds(2.5 * x, 2.5 * a) and holds(1 - x, 1 - a)
    if y.sign() in (1, -1):
        assert holds(x / y, a / b) and holds(1 / y, 1 / b)
    if x.sign() == 1:
        assert holds(x.sqrt(), mpmath.sqrt(a))


@given(numbers)
def test_signs_are_proven(x: Number) -> None:
    low, high = real(x.a, x.b) - real(x.error), real(x.a, x.b) + real(x.error)
    sign = x.sign()
    assert sign == (1 if low > 0 else -1 if high < 0 else 0 if low == high == 0 else None)
    assert real(Fraction(x.below())) <= low


@given(rationals, rationals)
def test_signs_are_told_however_small(a: Fraction, b: Fraction) -> None:
    tiny = Fraction(1, 10**60)
    assert (Number(a, b) - Number(a - tiny, b)).sign() == 1
    assert (Number(a, b) - Number(a, b)).sign() == 0
    near = Fraction(math.isqrt(3 * 10**120), 10**60)
    assert Number(-near, Fraction(1)).sign() == 1
    assert Number(near + tiny, Fraction(-1)).sign() == 1


@pytest.mark.parametrize("count", range(-13, 26))
def test_multiples_of_30_degrees_are_exact(count: int) -> None:
    for value in (math.radians(30 * count), count * math.pi / 6, math.radians(30 * count + 60) - math.pi / 3):
        assert multiple(value) == count
        angle = Angle.of(value)
        assert angle.cos().error == angle.sin().error == 0
        assert abs(angle.cos().nearest() - math.cos(value)) < 1e-14
        assert abs(angle.sin().nearest() - math.sin(value)) < 1e-14
        assert angle.cos() * angle.cos() + angle.sin() * angle.sin() == number(1)


@given(st.floats(-13, 13))
def test_sines_and_cosines_hold(value: float) -> None:
    angle = Angle.of(value)
    if multiple(value) is None:
        assert holds(angle.cos(), mpmath.cos(value)) and holds(angle.sin(), mpmath.sin(value))


def test_other_angles_are_no_multiples() -> None:
    assert multiple(math.radians(30 + 1e-12)) is None
    assert multiple(1.0) is None


# -- factors -------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("identifier", ROBOTS)
def test_factors_equal_the_closed_forms_of_the_derivation(identifier: str) -> None:
    """Legs of different sizes at 0, 90 and 180 degrees, angles (3, 4, 5): rational, and equal to the last
    bit.
    """
    platform = next(entry for entry in catalogue() if entry.identifier == identifier).robot.platform
    robot, source = load(identifier), np.random.default_rng(3)
    names = [field.name for field in platform.geometry().fields]
    plate = {name: source.uniform(0.05, 0.2, 3) for name in names}
    plate["platform_azimuth"] = np.array([0.0, np.pi / 2, np.pi])
    robot = robot.with_geometry(**plate)
    geometry = {name: [Exact(float(x)) for x in values] for name, values in plate.items()}
    quarter = RationalAngle(0, 1)
    geometry["platform_azimuth"] = [RationalAngle(1, 0), quarter, quarter + quarter]
    pythagorean = [(3, 4, 5), (-5, 12, 13), (8, -15, 17)]
    if factors(robot)[0].form is Form.AFFINE:
        here = [number(Fraction(a, c)) for a, _, c in pythagorean]
        there = [Exact(Fraction(a, c)) for a, _, c in pythagorean]
    else:
        here = [Angle(number(Fraction(a, c)), number(Fraction(b, c))) for a, b, c in pythagorean]
        there = [RationalAngle(Fraction(a, c), Fraction(b, c)) for a, b, c in pythagorean]
    wanted = closed_form(platform, there, geometry)
    for factor, value in zip(factors(robot), wanted, strict=True):
        found = factor.at(here)
        assert (found.a, found.b, found.error) == (value.fraction, 0, 0)


@pytest.mark.parametrize("identifier", ROBOTS)
def test_factors_in_doubles_are_those_of_the_generated_function(identifier: str) -> None:
    robot = load(identifier)
    points = np.random.default_rng(5).uniform(0.02, 3.0, (50, 3))
    found = np.stack([factor.near(points) * factor.margin for factor in factors(robot)], axis=-1)
    assert np.allclose(found, margins(robot, points), rtol=1e-12, atol=1e-12)
    for factor in factors(robot):
        assert factor.rounding < 1e-15
        exact = [factor.at([factor.coordinate(x) for x in point]).nearest() for point in points[:5].tolist()]
        assert np.allclose(exact, factor.near(points[:5]), rtol=1e-12, atol=1e-15)


def test_factors_carry_their_names_and_planar_robots_have_one() -> None:
    assert [factor.name for factor in factors(load("spatial_rrr_a"))] == ["det J_a", "det J_n"]
    assert [factor.name for factor in factors(load("planar_rr_a"))] == ["det J_a"]
