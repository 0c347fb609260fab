"""The real-root solver, in C and NumPy: counts against exact Sturm sequences, places against many digits."""

from __future__ import annotations

import ctypes
from fractions import Fraction
from functools import cache
from itertools import pairwise
from math import gcd
from pathlib import Path
from typing import Any

import mpmath
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from krhpr.backend import c_sources
from krhpr.generated.python.roots import real_roots
from krhpr.native import compile_library, load_library

DEGREES = range(2, 9)
DRIVER = """
#include "krhpr_roots.h"
void many(int n, int count, const double *c, double error, double *x, double *y, int *found, int *doubtful);
void many(int n, int count, const double *c, double error, double *x, double *y, int *found, int *doubtful)
{
    for (int i = 0; i < count; ++i) {
        found[i] = krhpr_real_roots(n, c + (n + 1) * i, error, x + n * i, y + n * i, doubtful + i);
    }
}
"""


@cache
def library(folder: Path, steps: int) -> ctypes.CDLL:
    """The header, compiled, with at most so many steps to a root."""
    text, bound = (c_sources() / "krhpr_roots.h").read_text(), "step < 96"
    assert text.count(bound) == 1
    (folder / "krhpr_roots.h").write_text(text.replace(bound, f"step < {steps}"))
    source = folder / "driver.c"
    source.write_text(DRIVER)
    return load_library(compile_library("krhpr_roots_test", [source], include_dirs=[folder, c_sources()]))


@pytest.fixture(scope="session")
def in_c(tmp_path_factory: pytest.TempPathFactory) -> Any:
    return solver(tmp_path_factory.mktemp("roots"))


def solver(folder: Path, steps: int = 96) -> Any:
    """krhpr_real_roots for coefficients (count, n + 1): x, y, count, doubtful."""
    compiled = library(folder, steps)

    def run(coefficients: Any, error: float = 0.0) -> tuple[Any, Any, Any, Any]:
        c = np.ascontiguousarray(np.atleast_2d(coefficients), dtype=float)
        count, n = len(c), c.shape[1] - 1
        x, y = np.empty((count, n)), np.empty((count, n))
        found, doubtful = np.empty(count, np.intc), np.empty(count, np.intc)
        pointers = [a.ctypes.data_as(ctypes.c_void_p) for a in (c, x, y, found, doubtful)]
        compiled.many(n, count, pointers[0], ctypes.c_double(error), *pointers[1:])
        return x, y, found, doubtful

    return run


def exact_count(coefficients: Any) -> int:
    """Distinct real roots on the projective line, by a Sturm sequence of rational numbers."""
    p = [Fraction(float(value)) for value in coefficients]
    degree = len(p)
    while p and p[-1] == 0:
        p.pop()
    sequence = [_primitive(p), _primitive([j * value for j, value in enumerate(p)][1:])]
    while len(sequence[-1]) > 1:
        rest, divisor = list(sequence[-2]), sequence[-1]
        while len(rest) >= len(divisor):
            factor, shift = rest[-1] / divisor[-1], len(rest) - len(divisor)
            for j, value in enumerate(divisor):
                rest[j + shift] -= factor * value
            rest.pop()
        while rest and rest[-1] == 0:
            rest.pop()
        if not rest:
            break
        sequence.append(_primitive([-value for value in rest]))
    low = _variations([q[-1] * (-1) ** (len(q) - 1) for q in sequence])
    return low - _variations([q[-1] for q in sequence]) + (len(p) < degree)


def _primitive(q: list[Fraction]) -> list[Fraction]:
    """The same times a positive number, with small integers."""
    denominator = 1
    for value in q:
        denominator = denominator * value.denominator // gcd(denominator, value.denominator)
    whole = [int(value * denominator) for value in q]
    factor = 0
    for number in whole:
        factor = gcd(factor, number)
    return [Fraction(number, factor or 1) for number in whole]


def _variations(values: list[Fraction]) -> int:
    signs = [value > 0 for value in values if value != 0]
    return sum(a != b for a, b in pairwise(signs))


def residual(c: Any, x: Any, y: Any) -> Any:
    """|P(x, y)| over the sum of the coefficients' sizes; 0 where there is no root."""
    n = c.shape[-1] - 1
    value = sum(c[..., j, None] * x**j * y ** (n - j) for j in range(n + 1))
    return np.nan_to_num(np.abs(value) / np.abs(c).sum(axis=-1)[..., None])


def near_double(rng: np.random.Generator, apart: float, count: int, degree: int = 6) -> Any:
    """Polynomials with a factor (T - a)^2 -+ apart."""
    found = []
    for _ in range(count):
        a, sign = rng.normal(), rng.choice((-1, 1))
        found.append(np.convolve(rng.normal(size=degree - 1), [a * a - sign * apart, -2 * a, 1.0]))
    return np.array(found)


@pytest.mark.compiler
@pytest.mark.parametrize("degree", DEGREES)
def test_random_polynomials(degree: int, in_c: Any, full: bool) -> None:
    """Every count is exact and in no doubt; C and NumPy find the same."""
    rng = np.random.default_rng(degree)
    c = rng.normal(size=(1_000_000 // 7 if full else 4_000, degree + 1))
    x, y, count, doubtful = in_c(c)
    assert not doubtful.any()
    assert (np.isfinite(x).sum(axis=1) == count).all() and (np.isfinite(y).sum(axis=1) == count).all()
    assert np.nanmax(np.maximum(np.abs(x), np.abs(y))) == 1.0
    assert residual(c, x, y).max() < 1e-14
    exact = [exact_count(row) for row in c[: 2_000 if full else 200]]
    assert exact == count[: len(exact)].tolist()
    some = slice(0, 20_000)
    found = real_roots(c[some])
    assert (found.count == count[some]).all() and not found.doubtful.any()
    assert (
        np.nanmax(np.abs(np.sort(found.x) - np.sort(x[some]))) < 1e-7
    )  # near-double roots lose half the digits


@pytest.mark.compiler
@pytest.mark.parametrize("degree", [2, 6, 8])
@pytest.mark.parametrize("power", range(1, 15))
def test_close_to_a_double_root(power: int, degree: int, in_c: Any, full: bool) -> None:
    """No count is wrong however close; down to 1e-10 from the double root hardly any is in doubt."""
    c = near_double(np.random.default_rng(power), 10.0**-power, 500 if full else 100, degree)
    _, _, count, doubtful = in_c(c)
    found = real_roots(c)
    exact = np.array([exact_count(row) for row in c])
    for counts, doubts in ((count, doubtful), (found.count, found.doubtful)):
        sure = doubts == 0
        assert (counts[sure] == exact[sure]).all()
        if power <= 10:
            assert sure.mean() > 0.99


def test_places_are_those_of_many_digits() -> None:
    rng = np.random.default_rng(3)
    for degree in DEGREES:
        for c in rng.normal(size=(6, degree + 1)):
            found = real_roots(c)
            with mpmath.workdps(50):
                every = mpmath.polyroots([mpmath.mpf(float(v)) for v in c[::-1]], maxsteps=300, extraprec=300)
                wanted = sorted(
                    float(mpmath.re(r)) for r in every if abs(mpmath.im(r)) < mpmath.mpf(10) ** -30
                )
            got = np.sort((found.x / found.y)[: found.count])
            assert got == pytest.approx(wanted, rel=1e-11, abs=1e-13)


def test_few_steps_lead_to_a_root(in_c: Any, tmp_path: Path) -> None:
    """Newton's steps from the crossing of the control polygon: hardly a root needs more than eight."""
    c = np.random.default_rng(17).normal(size=(4_000, 7))
    x, _, count, _ = in_c(c)
    quick, _, same, _ = solver(tmp_path, 8)(c)
    assert np.array_equal(count, same)
    assert (np.abs(quick - x)[np.isfinite(x)] < 1e-9).mean() > 0.995


@pytest.mark.parametrize("degree", DEGREES)
def test_places_are_as_good_as_doubles(degree: int, in_c: Any, full: bool) -> None:
    """At every place the polynomial is zero but for its rounding errors, also beside double roots."""
    rng = np.random.default_rng(degree)
    rows = [rng.normal(size=(200 if full else 25, degree + 1))]
    rows += [near_double(rng, 10.0**-power, 40 if full else 8, degree) for power in (2, 4, 6)]
    c = np.concatenate(rows)
    found = real_roots(c)
    for x, y, count in ((found.x, found.y, found.count), in_c(c)[:3]):
        for row, xs, ys, n in zip(c, x, y, count, strict=True):
            for a, b in zip(xs[:n], ys[:n], strict=True):
                terms = [
                    Fraction(float(v)) * Fraction(float(a)) ** j * Fraction(float(b)) ** (degree - j)
                    for j, v in enumerate(row)
                ]
                assert abs(sum(terms)) <= 2 * degree * Fraction(1, 2**53) * sum(abs(term) for term in terms)


@pytest.mark.parametrize(
    ("coefficients", "roots"),
    [
        ([-1, 0, 0, 0, 0, 0, 1], [-1, 1]),  # where charts meet
        ([0, -1, 0, 1], [-1, 0, 1]),
        ([1, 0, -1], [-1, 1]),
        ([0, 1, 0], [0, np.inf]),
        ([-1, 2, 0], [0.5, np.inf]),
        ([-1, 3, -2], [0.5, 1]),  # where intervals are halved
        ([1, 0, 1], []),
        ([3, -16, 16], [0.25, 0.75]),
        ([1e-300, -3e-300, 2e-300], [0.5, 1]),
        ([1e300, -3e300, 2e300], [0.5, 1]),
    ],
)
def test_roots_at_special_places(coefficients: list[float], roots: list[float]) -> None:
    found = real_roots(coefficients)
    assert (found.count, found.doubtful) == (len(roots), 0)
    with np.errstate(divide="ignore"):
        got = np.sort(np.abs(found.x / found.y) * np.sign(found.x / np.where(found.y == 0, found.x, found.y)))
    assert got[: len(roots)] == pytest.approx(roots, abs=1e-15)


@given(st.integers(-4, 4), st.integers(-4, 4), st.lists(st.integers(-6, 6), min_size=2, max_size=4))
def test_double_roots_are_in_doubt(a: int, b: int, others: list[int]) -> None:
    """A double root is no simple one, and never two."""
    c = np.convolve(np.convolve([a, b], [a, b]), others).astype(float)
    if not c.any() or (a, b) == (0, 0):
        return
    found = real_roots(c)
    assert found.doubtful > 0


@pytest.mark.compiler
def test_what_is_no_polynomial(in_c: Any) -> None:
    hostile = np.array([[np.nan, 1, 1], [np.inf, 1, 1], [0, 0, 0], [1e308, 1e308, 1e308], [1, -3, 2.0]])
    found, (x, _, count, _) = real_roots(hostile), in_c(hostile)
    for counts, places in ((found.count, found.x), (count, x)):
        assert counts.tolist() == [-1, -1, -1, -1, 2]
        assert np.isnan(places[:4]).all()
    assert in_c(np.ones((1, 10)))[2] == -1
    for shape in ((2,), (10,), ()):
        with pytest.raises(ValueError, match=r"expected \(\.\.\., n \+ 1\) with n from 2 to 8"):
            real_roots(np.ones(shape))


def test_batches_have_any_shape() -> None:
    c = np.random.default_rng(0).normal(size=(2, 3, 7))
    found = real_roots(c)
    assert found.x.shape == (2, 3, 6) and found.count.shape == (2, 3)
    assert np.array_equal(found.x[1, 2], real_roots(c[1, 2]).x, equal_nan=True)
    assert real_roots(np.empty((0, 7))).x.shape == (0, 6)


@given(st.floats(0, 1e-6), st.integers(0, 10_000))
def test_within_the_error_of_the_coefficients(error: float, seed: int) -> None:
    """Where nothing is in doubt every polynomial within the error has as many roots."""
    rng = np.random.default_rng(seed)
    c = near_double(rng, 10.0 ** rng.uniform(-9, -1), 1)[0]
    found = real_roots(c, error)
    if found.doubtful == 0:
        size = error * np.abs(c).sum() / c.size
        for change in rng.choice((-1.0, 1.0), size=(4, c.size)) * size:
            assert exact_count(c + change) == found.count
