"""Memory: what is checked, and how Python sees it."""

from __future__ import annotations

from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest

from krhpr.validation.c_interpreter import Array, CProgram, OutOfBounds, UninitialisedRead
from krhpr.validation.numbers import EXACT, FLOAT, Arithmetic, Exact


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
