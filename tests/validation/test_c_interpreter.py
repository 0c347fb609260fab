"""The C interpreter: agreement with a compiler, exactness, memory checks, and what it refuses."""

from __future__ import annotations

import ctypes
import math
import subprocess
from collections.abc import Callable
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from krhpr.validation.c_interpreter import (
    Array,
    CError,
    CProgram,
    OutOfBounds,
    Struct,
    UninitialisedRead,
    Unsupported,
)
from krhpr.validation.numbers import (
    BALL,
    EXACT,
    FLOAT,
    Angle,
    Arithmetic,
    Ball,
    Exact,
    NotRational,
    ball_precision,
)
from tests.support import lacking, need

HEADER = """
/* A leg with three revolute joints: header. */
#ifndef SAMPLE_LEG_H
#define SAMPLE_LEG_H

#include <math.h>
#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

#define SAMPLE_LEGS 3   // legs of the robot
#define SAMPLE_JOINTS (3)
#ifndef M_PI
#define M_PI 3.14159265358979323846
#endif

typedef enum { SAMPLE_OK, SAMPLE_UNREACHABLE = 10, SAMPLE_INVALID = SAMPLE_UNREACHABLE + 10 } sample_status;

typedef struct {
    double c[3];            /* shoulder */
    double cos_psi, sin_psi;
    double l2;
    double l3;
} sample_leg;

typedef struct sample_geometry {
    sample_leg leg[SAMPLE_LEGS];
    double tool[2][3];
    int modes[SAMPLE_LEGS];
} sample_geometry;

int sample_robot_forward(const sample_geometry *g, const double theta[9], double s[9], double M[27]);

#ifdef __cplusplus
}
#endif
#endif
"""

SOURCE = r"""
#include "sample_leg.h"

static const double unit[3][3] = {{1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, {0.0, 0.0, 1.0}};

/* The leg kernel: straight-line. */
static inline void sample_leg_kernel(const sample_leg *restrict g, const double theta[3],
                                     double *restrict s, double *restrict M)
{
    const double x0 = sin(theta[0]), x1 = cos(theta[0]);
    const double x2 = sin(theta[1]);
    const double x3 = cos(theta[1]);
    const double x4 = theta[1] + theta[2];
    const double x5 = g->l3*sin(x4);
    const double x6 = g->l3*cos(x4);
    const double x7 = g->l2*x3 + x6;  /* radius */
    const double x8 = -(g->l2*x2 + x5);
    const double x9 = x1*g->cos_psi - x0*g->sin_psi;
    const double x10 = x1*g->sin_psi + x0*g->cos_psi;
    s[0] = g->c[0] + x7*x9;
    s[1] = g->c[1] + x7*x10;
    s[2] = g->c[2] - x8;
    M[0] = -x7*x10; M[1] = x8*x9;   M[2] = -x5*x9;
    M[3] = x7*x9;   M[4] = x8*x10;  M[5] = -x5*x10;
    M[6] = 0.0;     M[7] = x7;      M[8] = x6;
}

int sample_robot_forward(const sample_geometry *g, const double theta[9], double s[9], double M[27])
{
    int i;
    size_t k;
    for (k = 0; k < 9; k += 1) {
        if (!isfinite(theta[k])) {
            for (size_t j = 0; j < 9; ++j) s[j] = NAN;
            return SAMPLE_INVALID;
        }
    }
    for (i = 0; i < SAMPLE_LEGS; ++i) {
        const sample_leg *const leg = &g->leg[i];
        sample_leg_kernel(leg, theta + SAMPLE_JOINTS*i, s + 3*i, &M[9*i]);
    }
    return SAMPLE_OK;
}

double sample_wrapped(double angle)
{
    return atan2(sin(angle), cos(angle)) + 2*M_PI*floor(angle/(2*M_PI) + 0.5);
}

double sample_distance(double x, double y)
{
    return hypot(x, y);
}

/* Inverse of the last two joints, with branches, casts, conditionals and compound assignments. */
int sample_leg_inverse(const sample_leg *g, const double s[3], int mode, double theta[3])
{
    double v[3], radius, square = 0.0;
    double sum[2] = {0};
    for (int k = 0; k < 3; k++) {
        v[k] = s[k] - g->c[k];
        square += v[k]*v[k];
    }
    radius = sqrt(v[0]*v[0] + v[1]*v[1]);
    const double cosine = (square - g->l2*g->l2 - g->l3*g->l3)/(2*g->l2*g->l3);
    const double rest = 1 - cosine*cosine;
    if (rest < 0.0 || fabs(cosine) > 1.0) {
        for (int k = 0; k != 3; ++k)
            theta[k] = NAN;
        return SAMPLE_UNREACHABLE + mode;
    } else if (radius == 0) {
        return SAMPLE_INVALID;
    }
    const double sine = (mode ? -1 : 1)*sqrt(rest);
    theta[2] = atan2(sine, cosine);
    theta[1] = atan2(v[2], radius) - atan2(g->l3*sine, g->l2 + g->l3*cosine);
    theta[0] = atan2(v[1]*g->cos_psi - v[0]*g->sin_psi, v[0]*g->cos_psi + v[1]*g->sin_psi);
    sum[0] += fmax(v[0], fmin(v[1], v[2]));
    sum[1] -= (double)(7/2)/4;
    sum[0] *= 1e1;
    sum[1] /= 0.5;
    theta[0] += 0*(sum[0] + sum[1]);
    return SAMPLE_OK;
}

static double trace(const double A[3][3], double (*B)[3])
{
    double t = 0;
    for (int i = 0; i < 3; ++i) {
        double *row = B[i];
        for (int j = 0; j < 3; ++j) {
            if (i == j) t += A[i][j];
            row[j] = 2*A[j][i] - (i < j ? unit[i][j] : unit[i][i]);
            if (j > 1 && i > 1) continue;
        }
    }
    return t;
}

double sample_trace(const double A[9], double B[9])
{
    double local[3][3], other[3][3] = {{0}};
    sample_leg leg = {{1, 2, 3}, .l2 = 0.25, .l3 = 3.5e-1}, copy;
    copy = leg;
    copy.c[1] = -leg.c[2];
    for (size_t i = 0, n = 9; i < n; i++) local[i/3][i%3] = A[i];
    double t = trace(local, other);
    for (int i = 8; i >= 0; i--) {
        B[i] = other[i/3][i%3] + copy.c[1]*copy.cos_psi + leg.c[1] + copy.l2;
        if (i < 3) { if (t > 1e300) break; }
    }
    return t;
}

int sample_integers(int a, int b, double *out)
{
    const double *p = out;
    unsigned int u = 0u;
    u -= 1;
    const int bits = ((a << 3) | (b & 5)) ^ (~a >> 1);
    *out++ = a/b;
    *out = (double)a/b;
    out[1] = a%b;
    out[2] = (double)(u >> 16);
    out[3] = (double)(out - p) + (a > b) + 2*(a == b) + !a + -b;
    out[4] = (int)(a*0.75) + bits;
    return p == NULL ? -1 : a < 0 && b > 0 ? 1 : 2;
}
"""

ANGLES = [Angle.from_half_tangent(Fraction(k, 7)) for k in (1, -3, 5, 2, 9, -8, 4, -1, 6)]


@pytest.fixture(scope="module")
def files(tmp_path_factory: pytest.TempPathFactory) -> list[Path]:
    folder = tmp_path_factory.mktemp("sample")
    (folder / "sample_leg.h").write_text(HEADER)
    (folder / "sample.c").write_text(SOURCE)
    return [folder / "sample_leg.h", folder / "sample.c"]


def geometry(program: CProgram, values: Callable[[int], Any]) -> Struct:
    """A geometry whose fields are `values(0)`, `values(1)`, ..."""
    g = program.new_struct("sample_geometry")
    for i in range(3):
        leg = g.leg[i]
        leg.c = [values(9 * i + k) for k in range(3)]
        leg.cos_psi, leg.sin_psi = Fraction(3, 5), Fraction(4, 5)
        leg.l2, leg.l3 = values(9 * i + 3), values(9 * i + 4)
    g.tool = [[1, 2, 3], [4, 5, 6]]
    g.modes = [0, 1, 2]
    return g


# Agreement with the compiler


class LegStruct(ctypes.Structure):
    _fields_ = [
        ("c", ctypes.c_double * 3),
        ("cos_psi", ctypes.c_double),
        ("sin_psi", ctypes.c_double),
        ("l2", ctypes.c_double),
        ("l3", ctypes.c_double),
    ]


class GeometryStruct(ctypes.Structure):
    _fields_ = [("leg", LegStruct * 3), ("tool", ctypes.c_double * 6), ("modes", ctypes.c_int * 3)]


@pytest.fixture(scope="module")
def library(files: list[Path]) -> ctypes.CDLL:
    compiler = "cc" if lacking("gcc") else "gcc"
    need(compiler)
    target = files[1].with_suffix(".so")
    flags = ["-std=c99", "-D_GNU_SOURCE", "-O0", "-ffp-contract=off", "-shared", "-fPIC"]
    subprocess.run([compiler, *flags, str(files[1]), "-o", str(target), "-lm"], check=True)
    loaded = ctypes.CDLL(str(target))
    for function in (loaded.sample_trace, loaded.sample_wrapped, loaded.sample_distance):
        function.restype = ctypes.c_double
    return loaded


def doubles(values: Any) -> Any:
    return (ctypes.c_double * len(values))(*values)


def random_geometry(rng: np.random.Generator, program: CProgram) -> tuple[Struct, GeometryStruct]:
    numbers = rng.uniform(0.1, 1.0, 27)
    ours, theirs = geometry(program, lambda k: float(numbers[k])), GeometryStruct()
    for i in range(3):
        leg, source = theirs.leg[i], ours.leg[i]
        leg.c = doubles(list(source.c))
        for name in ("cos_psi", "sin_psi", "l2", "l3"):
            setattr(leg, name, getattr(source, name))
    return ours, theirs


def identical(a: float, b: float) -> bool:
    return a == b or (math.isnan(a) and math.isnan(b))


def test_floats_are_those_of_the_compiled_text(files: list[Path], library: ctypes.CDLL, full: bool) -> None:
    program = CProgram.from_files(files, FLOAT)
    rng = np.random.default_rng(1)
    seen = set()
    for sample in range(2000 if full else 100):
        ours, theirs = random_geometry(rng, program)
        theta = list(rng.uniform(-3, 3, 9))
        if sample % 10 == 0:
            theta[5] = math.nan
        s, m, out, matrix = (Array.unset(n) for n in (9, 27, 3, 9))
        c_s, c_m, c_out, c_matrix = (doubles([math.nan] * n) for n in (9, 27, 3, 9))

        status = program.call("sample_robot_forward", ours, theta, s, m)
        expected = library.sample_robot_forward(ctypes.byref(theirs), doubles(theta), c_s, c_m)
        assert status == expected == (20 if sample % 10 == 0 else 0)
        assert all(map(identical, s, c_s))
        if status == 0:
            assert all(map(identical, m, c_m))

        target = list(rng.uniform(-1, 1, 3))
        mode = sample % 2
        status = program.call("sample_leg_inverse", ours.leg[1], target, mode, out)
        leg = ctypes.byref(theirs.leg[1])
        assert status == library.sample_leg_inverse(leg, doubles(target), mode, c_out)
        assert all(map(identical, out, c_out))
        seen.add(status)

        a = list(rng.uniform(-1, 1, 9))
        assert program.call("sample_trace", a, matrix) == library.sample_trace(doubles(a), c_matrix)
        assert all(map(identical, matrix, c_matrix))
        assert program.call("sample_wrapped", theta[0]) == library.sample_wrapped(ctypes.c_double(theta[0]))

        # Python's hypot is not the C library's: they differ in the last bit now and then.
        distance = program.call("sample_distance", *a[:2])
        expected = library.sample_distance(ctypes.c_double(a[0]), ctypes.c_double(a[1]))
        assert abs(distance - expected) <= math.ulp(expected)
    assert seen == {0, 10, 11}


@pytest.mark.parametrize("a", [-17, -4, 0, 3, 12])
@pytest.mark.parametrize("b", [-5, -1, 3, 4])
def test_integers_are_those_of_the_compiled_text(
    files: list[Path], library: ctypes.CDLL, a: int, b: int
) -> None:
    out, c_out = Array.unset(6), doubles([0.0] * 6)
    expected = library.sample_integers(a, b, c_out)
    for arithmetic in (FLOAT, EXACT):
        program = CProgram.from_files(files, arithmetic)
        out = Array.unset(6)
        if arithmetic is EXACT:
            assert program.call("sample_integers", a, b, out) == expected
            assert out[1] == Fraction(a, b)
        else:
            assert program.call("sample_integers", a, b, out) == expected
            assert list(out) == list(c_out)


# Exactness


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


def test_integer_division_is_not_that_of_doubles() -> None:
    text = "double f(double x) { return 1/2*x + (1/2.0)*x + (x > 0 ? 1 : 0.5)/2; }"
    assert CProgram.from_text(text).call("f", 3) == 2
    # Integers that Python hands over for doubles are doubles.
    text = "double f(const double x[2], double y) { return x[0]/x[1] + y/2; }"
    assert CProgram.from_text(text).call("f", [1, 2], 1) == 1


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


@given(st.integers(-50, 50), st.integers(-50, 50))
def test_conditions(a: int, b: int) -> None:
    text = """
    int f(double a, double b) {
        if (a < b && b > 0) return 1;
        else if (a == b || !(a > b)) return 2;
        return a >= 0 ? 3 : 4;
    }
    """
    expected = 1 if a < b and b > 0 else 2 if a <= b else 3 if a >= 0 else 4
    assert CProgram.from_text(text).call("f", a, b) == expected


# The memory checker


@pytest.mark.parametrize(
    ("body", "message"),
    [
        ("double a; return a + 1;", r"text\.c:3: a is read before"),
        ("double a[3]; a[0] = 1; return a[2];", r"text\.c:3: a\[2\] is read before"),
        ("double a[2][2]; a[1][0] = 1; return a[1][1];", r"a\[3\] is read before"),
        ("pair p; p.x = 1; return p.y[1];", r"p\.y\[1\] is read before"),
        ("pair p[2]; p[1].x = 1; return p[0].x;", r"p\[0\]\.x is read before"),
        ("double a; a += 1; return a;", "a is read before"),
        ("for (int i = 0; i < 2; ++i) { double a; if (i == 0) a = 1; q[0] = a; } return 0;", "a is read"),
        ("return q[1];", r"q\[1\] is read before"),
        ("pair p, r; p.x = 1; r = p; return r.y[0];", r"r\.y\[0\] is read before"),
    ],
)
def test_uninitialised_reads_are_found(body: str, message: str) -> None:
    text = f"typedef struct {{ double x; double y[2]; }} pair;\ndouble f(double *q)\n{{ {body} }}"
    with pytest.raises(UninitialisedRead, match=message):
        CProgram.from_text(text).call("f", Array.unset(3))


@pytest.mark.parametrize(
    ("body", "message"),
    [
        ("return p[3];", r"text\.c:3: index 3 of p"),
        ("return p[-1];", r"index -1 of p"),
        ("q[5] = 1; return 0;", r"index 5 of q"),
        ("double *r = q + 3; return r[2];", r"index 2 of q"),
        ("double *r = q + 6; return 0;", r"a pointer outside q"),
        ("double *r = &q[2]; r[-2] = 1; return r[-3];", r"index -3 of q"),
        ("double a[2][3] = {{1, 2, 3}, {4, 5, 6}}; return a[0][3];", r"index 3 of 3 elements of a"),
        ("double a[2][3] = {{0}}; return g(a[1] + 1);", r"argument v of g needs 3 elements, a has 2 left"),
        ("return g(p + 1);", "argument v of g needs 3 elements, p has 2 left"),
        ("double *r = NULL; return *r;", "null pointer"),
        ("return n.x[2];", r"index 2 of 2 elements of n\.x"),
    ],
)
def test_accesses_out_of_bounds_are_found(body: str, message: str) -> None:
    text = (
        "typedef struct { double x[2]; } pair; double g(const double v[3]) { return v[0]; }\n"
        f"double f(const double p[3], double *q, pair n)\n{{ {body} }}"
    )
    program = CProgram.from_text(text)
    pair = program.new_struct("pair")
    pair.x = [1, 2]
    # The array is longer than the parameter promises: the promise counts.
    with pytest.raises(OutOfBounds, match=message):
        program.call("f", Array([1, 2, 3, 4], "p"), Array.unset(5), pair)


def test_a_short_argument_is_found() -> None:
    program = CProgram.from_text("double f(const double A[2][3]) { return A[0][0]; }")
    with pytest.raises(OutOfBounds, match="argument A of f needs 6 elements"):
        program.call("f", [1, 2, 3])


def test_errors_name_the_file_and_the_way_there(tmp_path: Path) -> None:
    header, source = tmp_path / "kernel.h", tmp_path / "robot.c"
    header.write_text("/* two\n lines */\nstatic void kernel(double *x)\n{\n    x[1] = 0;\n}\n")
    source.write_text('#include "kernel.h"\nvoid robot(void)\n{\n    double x;\n    kernel(&x);\n}\n')
    with pytest.raises(OutOfBounds, match=r"kernel\.h:5: index 1 of x, 1 elements") as raised:
        CProgram.from_files([header, source]).call("robot")
    assert raised.value.__notes__ == ["called from robot.c:5"]


@pytest.mark.parametrize(
    ("body", "message"),
    [
        ("int i = 2147483647; i += 1; return i;", "overflows"),
        ("return 1/(x > 5);", "division by zero"),
        ("return 1 << 40;", "shift"),
        ("if (x > 5) return 1;", "without returning"),
    ],
)
def test_undefined_behaviour_of_integers_is_found(body: str, message: str) -> None:
    with pytest.raises(CError, match=message):
        CProgram.from_text(f"int f(double x) {{ {body} }}").call("f", 1)


def test_division_by_zero_is_located() -> None:
    with pytest.raises(ZeroDivisionError) as raised:
        CProgram.from_text("double f(double x)\n{\n    return 1/x;\n}").call("f", 0)
    assert raised.value.__notes__ == ["at text.c:3"]
    assert CProgram.from_text("double f(double x) { return 1/x; }", FLOAT).call("f", 0) == math.inf


# What is outside the subset


@pytest.mark.parametrize(
    ("body", "message"),
    [
        ("while (x > 0) x -= 1;", "While"),
        ("do x -= 1; while (x > 0);", "DoWhile"),
        ("switch (1) { default: return 1; }", "Switch"),
        ("goto end; end: return 1;", "Goto"),
        ("float y = 1; return y;", "the type float"),
        ("return 1.0f;", r"literal 1\.0f"),
        ("return sizeof(x);", "sizeof"),
        ("return exp(x);", "exp is called but not defined"),
        ("return y;", "y is not declared"),
        ("return 'a';", "the literal 'a'"),
        ("static double y = 1; return y;", "static"),
        ("int n = 3; double y[n]; return 1;", "not an integer constant"),
        ("double y[2] = {1, 2, 3}; return 1;", "3 initialisers for 2"),
        ("double y[2] = {{1}, 2}; return 1;", "braces around a scalar"),
        ("return f(x - 1);", "recursive"),
        ("return sin(x, x);", "sin takes 1 arguments"),
        ("return x % 2;", "% on double"),
        ("double *p = &x; int *q = p; return 1;", "where pointer to 32-bit integer is expected"),
        ("return hidden(x);", "hidden is called but not defined"),
    ],
)
def test_what_is_unsupported_is_said_with_its_line(body: str, message: str) -> None:
    program = CProgram.from_text(f"double hidden(double);\ndouble f(double x)\n{{\n{body}\n}}")
    with pytest.raises(Unsupported, match=message) as raised:
        program.call("f", 1)
    if "recursive" not in message:
        assert "text.c:4" in str(raised.value)


@pytest.mark.parametrize(
    "text",
    [
        "double counter = 0;",
        "#define TEXT(x) #x",
        "#define ALL(...) f(__VA_ARGS__)",
        "#define SQUARE(x) ((x)*(x))\nint n[SQUARE(1, 2)];",
        "#define SQUARE(x) ((x)*(x))\nint n[SQUARE(1",
        "#error no",
        "double f( { }",
        "union u { int i; };",
        "struct s { int i : 3; };",
        "#if 1",
    ],
)
def test_texts_that_are_refused(text: str) -> None:
    with pytest.raises(Unsupported):
        CProgram.from_text(text)


def test_the_preprocessor() -> None:
    text = r"""
    #define TWO 2
    #define FOUR (TWO*TWO) // a comment
    #define LONG_ONE 1 + \
        FOUR
    #if defined(TWO) && !defined(THREE) && __STDC_VERSION__ >= 199901L
    #  define PICK 10
    #elif 1
    #  error unreachable
    #else
    #  error unreachable
    #endif
    #ifdef THREE
    #  if 1
    #    error unreachable
    #  else
    #    error unreachable
    #  endif
    #else
    #  pragma STDC FP_CONTRACT OFF
    #endif
    #undef TWO
    enum { TWO = 1 << 1, /* after
       the macro */ SIX = TWO*3, SEVEN };
    #define HIDDEN TWO
    int f(void) { return PICK + LONG_ONE + SEVEN + HIDDEN/* * 100 */; } // "
    """
    program = CProgram.from_text(text)
    assert program.enumerators == {"TWO": 2, "SIX": 6, "SEVEN": 7}
    # FOUR speaks of TWO when it is used: by then, the enumerator.
    assert program.call("f") == 10 + 1 + 4 + 7 + 2


def test_macros_with_parameters() -> None:
    text = """
    #define LANES 4
    #define PADDED(n) (((n) + LANES - 1) / LANES * LANES)
    #define SUM(a, b) ((a) + (b))
    #define NOTHING() 7
    #define PADDED_SUM(a, b) PADDED(SUM(a, b))
    int PADDED_length(void)
    {
        int PADDED = 1;
        double x[PADDED(5)];
        _Pragma("GCC unroll 1")
        for (int i = 0; i < PADDED(SUM(1, (2, 3))); ++i) {
            x[i] = 1.0;
        }
        x[0] = 2.0;
        return PADDED_SUM(4, 5) + PADDED + NOTHING();
    }
    """
    assert CProgram.from_text(text).call("PADDED_length") == 12 + 1 + 7


def test_a_choice_between_equal_balls_encloses_both() -> None:
    program = CProgram.from_text("double larger(double a, double b) { return a > b ? a : b; }", BALL)
    with ball_precision():
        root = Ball(2).sqrt()
        assert program.call("larger", root, Ball(8).sqrt() / 2).close(root)
        assert program.call("larger", root, Ball(1)).close(root)


def test_macros_can_be_defined_beforehand() -> None:
    text = """
    #ifdef LIBRARY
    double f(double x) { return sin(x)*FACTOR; }
    #else
    double f(double x) { return x; }
    #endif
    """
    angle = Angle("3/5", "4/5")
    assert CProgram.from_text(text).call("f", angle) is angle
    assert CProgram.from_text(text, macros={"LIBRARY": "", "FACTOR": "5.0"}).call("f", angle) == 4


# Python's side


def test_structs_and_arrays_from_python(files: list[Path]) -> None:
    program = CProgram.from_files(files)
    assert program.functions[:2] == ("sample_leg_kernel", "sample_robot_forward")
    assert program.enumerators["SAMPLE_INVALID"] == 20
    g = program.new_struct("sample_geometry")
    with pytest.raises(UninitialisedRead, match=r"leg\[1\]\.l2"):
        _ = g.leg[1].l2
    g.leg[1].l2 = 0.5
    assert g.leg[1].l2 == Fraction(1, 2) and isinstance(g.leg[1].l2, Exact)
    g.tool = [[1, 2, 3], [4, 5, 6]]
    g.tool[4] = 7
    assert list(g.tool) == [1, 2, 3, 4, 7, 6] and isinstance(g.tool[4], Exact)
    assert len(g.leg) == 3 and dir(g) == ["leg", "modes", "tool"]
    g.leg[2] = g.leg[1]
    g.leg[1].l2 = 2
    assert g.leg[2].l2 == Fraction(1, 2)
    for name in ("legs", "l2"):
        with pytest.raises(AttributeError):
            getattr(g, name)
        with pytest.raises(AttributeError):
            setattr(g, name, 1)
    with pytest.raises(ValueError, match="takes 6 values"):
        g.tool = [1, 2, 3]
    with pytest.raises(KeyError):
        program.new_struct("nothing")
    with pytest.raises(KeyError):
        program.call("nothing")
    with pytest.raises(TypeError, match="1 arguments"):
        program.call("sample_wrapped")
    with pytest.raises(TypeError, match="Array is expected"):
        program.call("sample_trace", [0] * 9, [0] * 9)
    with pytest.raises(IndexError):
        Array([1, 2])[2]
    out = Array.unset(2)
    assert not out.is_set(0)
    with pytest.raises(UninitialisedRead):
        _ = out[0]
    out[-1] = 3
    assert out.is_set(1) and out[1] == 3
    assert list(out.at(1)) == [3] and len(out.at(2)) == 0
    assert list(Array(np.array([[1.0, 2.0], [3.0, 4.0]]))) == [1, 2, 3, 4]


def test_results_come_back_through_pointers() -> None:
    text = """
    typedef struct { double value; int count; const double *source; } report;
    static report made(double x) { report r = {x, 1, NULL}; return r; }
    void f(const double *x, size_t n, report *out, double *mean)
    {
        *out = made(0.0);
        out->source = x;
        for (size_t i = 0; i < n; i++, out->count++) out->value += out->source[i];
        if (mean) *mean = (*out).value/(double)n;
    }
    """
    for arithmetic in (EXACT, FLOAT):
        program = CProgram.from_text(text, arithmetic)
        report, mean = program.new_struct("report"), Array.unset(1)
        program.call("f", [1, 2, 4], 3, report, mean)
        assert report.value == 7 and report.count == 4
        assert mean[0] == (Fraction(7, 3) if arithmetic is EXACT else 7 / 3)
        program.call("f", [1, 2, 4], 3, report, None)


@pytest.mark.parametrize("arithmetic", [EXACT, FLOAT])
def test_an_array_belongs_to_one_type(arithmetic: Arithmetic) -> None:
    program = CProgram.from_text("void f(double *x) { x[0] = 1; } void g(int *i) { i[0] = 1; }", arithmetic)
    array = Array.unset(1)
    program.call("f", array)
    with pytest.raises(TypeError, match="is of double"):
        program.call("g", array)
