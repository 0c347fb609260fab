"""Doubles and integers are those of a compiler, but for the last bit of hypot."""

from __future__ import annotations

import ctypes
import math
import subprocess
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from krhpr.validation.c_interpreter import Array, CProgram, Struct
from krhpr.validation.numbers import EXACT, FLOAT
from tests.support import lacking, need
from tests.validation.c_interpreter.sample import geometry


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
