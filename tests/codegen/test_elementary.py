"""Sine, cosine and arctangent of the generated C against correctly rounded values, compiled in many ways."""

from __future__ import annotations

import ctypes
import math
import platform
import re
import subprocess
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import flint
import numpy as np
import pytest

from krhpr.backend import c_sources
from tests.support import need

SOURCE = Path(__file__).with_name("elementary.c")
HEADER = (c_sources() / "krhpr_elementary.h").read_text()
NEAR = 1e5
"""The largest angle for which a bound is stated."""
BLOCK = 64

POSES = ("-DKRHPR_LANES_ARE_POSES",)
FUSED = ("-march=native", "-ffp-contract=fast")
WAYS = {
    "O0": ("-O0", "-std=c99"),
    "O2 strict": ("-O2", "-std=c99", "-ffp-contract=off"),
    "O2 native, no contraction": ("-O2", "-march=native", "-ffp-contract=off"),
    "O3 fused": ("-O3", *FUSED),
    "speed": ("-O3", *FUSED, "-fno-math-errno", "-fno-tree-slp-vectorize"),
    "one lane": ("-O2", "-ffp-contract=off", "-DKRHPR_LANES=1"),
    "two lanes": ("-O2", "-ffp-contract=off", "-DKRHPR_LANES=2"),
    "four lanes": ("-O3", *FUSED, "-DKRHPR_LANES=4", "-Wno-psabi"),
    "eight lanes": ("-O3", *FUSED, "-fno-math-errno", *POSES, "-DKRHPR_LANES=8", "-Wno-psabi"),
}


def stated(what: str) -> float:
    """The bound that the header's comment states, in ulps."""
    found = re.search(rf"{what} +below ([0-9.]+) ulp", HEADER)
    assert found is not None
    return float(found[1])


class Library:
    """The compiled functions, over arrays."""

    def __init__(self, path: Path) -> None:
        self._library = ctypes.CDLL(str(path))
        self.lanes = self._library.lanes()
        self.libm = bool(self._library.leaves_angles_to_libm())

    def sine_cosine(
        self, x: np.ndarray, *, blocks: bool = False, alone: bool = False
    ) -> tuple[np.ndarray, np.ndarray]:
        """Both; `alone`, each by the function that gives one of them."""
        name = "one_of_both" if alone else "sine_cosine"
        function = self._library[f"{name}_blocks" if blocks else name]
        (x,), size = _padded(blocks, x)
        sine, cosine = np.full_like(x, 7.0), np.full_like(x, 7.0)
        function(x.size, _pointer(x), _pointer(sine), _pointer(cosine))
        return sine[:size], cosine[:size]

    def arctangent(self, y: np.ndarray, x: np.ndarray, *, blocks: bool = False) -> np.ndarray:
        function = self._library.arctangent_blocks if blocks else self._library.arctangent
        (y, x), size = _padded(blocks, y, x)
        angle = np.full_like(x, 7.0)
        function(x.size, _pointer(y), _pointer(x), _pointer(angle))
        return angle[:size]


def _padded(blocks: bool, *arrays: np.ndarray) -> tuple[list[np.ndarray], int]:
    size = arrays[0].size
    room = -(-size // BLOCK) * BLOCK if blocks else size
    return [np.concatenate([a, np.zeros(room - size)]) for a in arrays], size


def _pointer(array: np.ndarray) -> ctypes.Array:
    return array.ctypes.data_as(ctypes.POINTER(ctypes.c_double))


def compile_shared(compiler: str, target: Path, *flags: str) -> None:
    command = [compiler, *flags, "-fPIC", "-shared", str(SOURCE), "-o", str(target), "-lm"]
    subprocess.run(command, check=True)


Make = Callable[..., Library]


@pytest.fixture(scope="session")
def make(tmp_path_factory: pytest.TempPathFactory) -> Make:
    """Compiles tests/codegen/elementary.c; each way once."""
    folder = tmp_path_factory.mktemp("elementary")

    @cache
    def make(compiler: str, *flags: str) -> Library:
        need(compiler)
        known = [f for f in flags if not (compiler == "clang" and f == "-fno-tree-slp-vectorize")]
        target = folder / f"{len(list(folder.iterdir()))}.so"
        compile_shared(compiler, target, "-Wall", "-Werror", *known, f"-I{c_sources()}")
        return Library(target)

    return make


@pytest.fixture(params=["gcc", "clang"])
def compiler(request: pytest.FixtureRequest) -> str:
    return str(request.param)


# -- reference -----------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Reference:
    """Correctly rounded values, with what is left."""

    high: np.ndarray
    low: np.ndarray

    def errors(self, values: np.ndarray) -> np.ndarray:
        """Distances in units in the last place of the true value."""
        return np.abs((values - self.high) - self.low) / np.spacing(np.abs(self.high))


def rounded(values: Iterable[flint.arb]) -> Reference:
    high, low = [], []
    for value in values:
        nearest = float(value)
        high.append(nearest)
        low.append(float(value - nearest))
    return Reference(np.array(high), np.array(low))


@pytest.fixture(scope="session", autouse=True)
def digits() -> None:
    flint.ctx.prec = 200


@pytest.fixture(scope="session")
def angles(full: bool) -> np.ndarray:
    """Angles up to the bound: multiples of pi/4 and their neighbours, tiny ones, the edge itself."""
    rng = np.random.default_rng(1)
    count = 500_000 if full else 4_000
    half_pi = flint.arb.pi() / 2
    last = int(NEAR / (math.pi / 2))
    every = np.arange(1, last + 1) if full else rng.choice(np.arange(1, last + 1), count, replace=False)
    multiples = np.array([float(half_pi * int(n)) for n in [*every, *range(1, 33)]])
    borders = np.array([float(half_pi * (int(n) - 0.5)) for n in (*every[:count], *range(1, 33))])
    close = np.concatenate([multiples, borders])
    close = np.concatenate([close, np.nextafter(close, 0), np.nextafter(close, np.inf), close * (1 + 1e-9)])
    sets = [
        close[close <= NEAR],
        rng.uniform(0, NEAR, count),
        rng.uniform(0, 2 * math.pi, count),
        rng.uniform(0, math.pi / 4, count),
        10.0 ** rng.uniform(-300, 0, count),
        np.array([NEAR, np.nextafter(NEAR, 0), 1.0, math.pi / 4, 2.0**-27, 1e-8]),
    ]
    x = np.concatenate(sets)
    return x * rng.choice([-1.0, 1.0], x.size)


@pytest.fixture(scope="session")
def circle(angles: np.ndarray) -> tuple[Reference, Reference]:
    pairs = [flint.arb(float(x)).sin_cos() for x in angles]
    return rounded(pair[0] for pair in pairs), rounded(pair[1] for pair in pairs)


@pytest.fixture(scope="session")
def points(full: bool) -> tuple[np.ndarray, np.ndarray]:
    """Points (y, x) in all octants: any angle, any ratio, near the octants' borders, tiny and huge."""
    rng = np.random.default_rng(2)
    count = 500_000 if full else 4_000

    def polar(angle: np.ndarray, spread: float) -> np.ndarray:
        size = 10.0 ** rng.uniform(-spread, spread, angle.size)
        return np.array([size * np.sin(angle), size * np.cos(angle)])

    def signs() -> np.ndarray:
        return rng.choice([-1.0, 1.0], (2, count))

    borders = [math.pi / 4, math.pi / 2, math.pi, math.atan(0.5), math.pi / 2 - math.atan(0.5), 0.125, 0.25]
    away = 10.0 ** rng.uniform(-16, -1, count) * rng.choice([-1, 1], count)
    sets = [
        polar(rng.uniform(-math.pi, math.pi, count), 3),
        polar(rng.uniform(-math.pi, math.pi, count), 280),
        polar(rng.choice(borders, count) + away, 1) * signs(),
        rng.uniform(-1, 1, (2, count)),
        10.0 ** rng.uniform(-20, 3, (2, count)) * signs(),
        rng.integers(-40, 41, (2, count)) * 1.0 + 0.0,
    ]
    y, x = np.concatenate(sets, axis=1)
    keep = (x != 0) | (y != 0)
    return np.ascontiguousarray(y[keep]), np.ascontiguousarray(x[keep])


@pytest.fixture(scope="session")
def directions(points: tuple[np.ndarray, np.ndarray]) -> Reference:
    y, x = points
    return rounded(
        flint.arb.atan2(flint.arb(float(b)), flint.arb(float(a))) for b, a in zip(y, x, strict=True)
    )


# -- bounds --------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("way", WAYS)
@pytest.mark.parametrize("blocks", [False, True], ids=["one by one", "blocks"])
def test_sine_and_cosine_keep_the_stated_bound(
    compiler: str, way: str, blocks: bool, make: Make, angles: np.ndarray, circle: tuple[Reference, Reference]
) -> None:
    library = make(compiler, *WAYS[way])
    for values, reference in zip(library.sine_cosine(angles, blocks=blocks), circle, strict=True):
        errors = reference.errors(values)
        worst = int(errors.argmax())
        assert errors[worst] < stated("sine, cosine"), f"{errors[worst]:.3f} ulp at {angles[worst]!r}"


@pytest.mark.parametrize("way", WAYS)
@pytest.mark.parametrize("blocks", [False, True], ids=["one by one", "blocks"])
def test_arctangent_keeps_the_stated_bound(
    compiler: str,
    way: str,
    blocks: bool,
    make: Make,
    points: tuple[np.ndarray, np.ndarray],
    directions: Reference,
) -> None:
    y, x = points
    errors = directions.errors(make(compiler, *WAYS[way]).arctangent(y, x, blocks=blocks))
    worst = int(errors.argmax())
    assert errors[worst] < stated("arctangent"), (
        f"{errors[worst]:.3f} ulp at atan2({y[worst]!r}, {x[worst]!r})"
    )


# -- identities and special values ---------------------------------------------------------------------------


@pytest.fixture(params=["O2 strict", "speed"])
def library(request: pytest.FixtureRequest, compiler: str, make: Make) -> Library:
    return make(compiler, *WAYS[request.param])


def test_symmetries(library: Library, angles: np.ndarray, points: tuple[np.ndarray, np.ndarray]) -> None:
    """Sine odd and cosine even, atan2 odd in y, bit by bit; no value beyond 1 or pi."""
    sine, cosine = library.sine_cosine(angles)
    negative_sine, same_cosine = library.sine_cosine(-angles)
    np.testing.assert_array_equal(negative_sine, -sine)
    np.testing.assert_array_equal(same_cosine, cosine)
    assert max(np.abs(sine).max(), np.abs(cosine).max()) <= 1.0
    y, x = points
    angle = library.arctangent(y, x)
    np.testing.assert_array_equal(library.arctangent(-y, x), -angle)
    assert np.abs(angle).max() <= math.pi


@pytest.mark.parametrize("blocks", [False, True], ids=["one by one", "blocks"])
def test_one_of_both_is_the_same(library: Library, blocks: bool, angles: np.ndarray) -> None:
    """Sine and cosine each alone are bit by bit those of the pair, beyond the bound and for NaN too."""
    x = np.concatenate([angles, [3e5, -1e22, math.nan, math.inf, -0.0]])
    together = library.sine_cosine(x, blocks=blocks)
    for alone, of_pair in zip(library.sine_cosine(x, blocks=blocks, alone=True), together, strict=True):
        np.testing.assert_array_equal(alone.view(np.int64), of_pair.view(np.int64))


def test_axes_and_diagonals_are_exact(library: Library) -> None:
    """Multiples of pi/4 come out as the nearest doubles."""
    y = np.array([0.0, 1.0, 1.0, 1.0, 0.0, -1.0, -1.0, -1.0])
    x = np.array([1.0, 1.0, 0.0, -1.0, -1.0, -1.0, 0.0, 1.0])
    steps = [0, 1, 2, 3, 4, -3, -2, -1]
    for size in (1.0, 0.3, 1e-12, 1e200, 1e-295, 5e-324):
        angle = library.arctangent(y * size, x * size)
        np.testing.assert_array_equal(angle, [float(flint.arb.pi() * n / 4) for n in steps])


def test_beyond_the_bounds_the_c_library_answers(library: Library) -> None:
    """Large angles, infinities and NaN as in C; a neighbour in the same block does not suffer."""
    odd = np.array([1e5 + 1, 1e6, 1e22, 1e300, -1e300, np.inf, -np.inf, np.nan])
    x = np.linspace(-3, 3, BLOCK)
    for k, value in enumerate(odd):
        x[8 * k + 3] = value
    with np.errstate(invalid="ignore"):
        expected = np.sin(x), np.cos(x)
    for blocks in (False, True):
        for got, want in zip(library.sine_cosine(x, blocks=blocks), expected, strict=True):
            np.testing.assert_allclose(got, want, rtol=3e-16, atol=0)
    big = np.array([1e300, 1.7e308, np.inf, -np.inf, np.nan, 1e-300, 5e-324, 0.0, 1.0])
    y, x = (grid.ravel() for grid in np.meshgrid(big, np.concatenate([big, -big[:-2]])))
    for blocks in (False, True):
        np.testing.assert_allclose(
            library.arctangent(y, x, blocks=blocks), np.arctan2(y, x), rtol=3e-16, atol=0
        )


def test_zeros_and_denormals(library: Library) -> None:
    zeros = np.array([0.0, -0.0])
    tiny = np.array([*zeros, 5e-324, -5e-324, 1e-310, -1e-310, 2.3e-308, 1e-200])
    for blocks in (False, True):
        sine, cosine = library.sine_cosine(tiny, blocks=blocks)
        np.testing.assert_array_equal(sine, tiny)
        np.testing.assert_array_equal(np.signbit(sine), np.signbit(tiny))
        np.testing.assert_array_equal(cosine, 1.0)
        # the signs of zeros are kept, and tell 0 from pi
        y, x = (grid.ravel() for grid in np.meshgrid(zeros, [2.0, -2.0, 0.0, -0.0]))
        angle = library.arctangent(y, x, blocks=blocks)
        np.testing.assert_array_equal(angle, np.arctan2(y, x))
        np.testing.assert_array_equal(np.signbit(angle), np.signbit(y))
        y, x = (grid.ravel() for grid in np.meshgrid([2.0, -2.0], zeros))
        np.testing.assert_array_equal(library.arctangent(y, x, blocks=blocks), y * (math.pi / 4))
        # denormal sides, in every octant and next to the diagonals
        small = np.arange(-9, 10) * 5e-324
        y, x = (grid.ravel() for grid in np.meshgrid(small, small))
        angle = library.arctangent(y, x, blocks=blocks)
        np.testing.assert_allclose(angle, np.arctan2(y, x), rtol=4e-16, atol=0)


def test_the_c_library_instead(
    compiler: str, make: Make, angles: np.ndarray, points: tuple[np.ndarray, np.ndarray]
) -> None:
    """KRHPR_LIBM gives the C library's values (through arrays and one by one)."""
    library = make(compiler, "-O2", "-DKRHPR_LIBM")
    assert library.libm
    some = angles[:: max(1, angles.size // 2000)]
    for blocks in (False, True):
        sine, cosine = library.sine_cosine(some, blocks=blocks)
        np.testing.assert_array_equal(sine, [math.sin(x) for x in some])
        np.testing.assert_array_equal(cosine, [math.cos(x) for x in some])
        y, x = (array[:2000] for array in points)
        angle = [math.atan2(b, a) for b, a in zip(y, x, strict=True)]
        np.testing.assert_array_equal(library.arctangent(y, x, blocks=blocks), angle)


@pytest.mark.skipif(platform.machine() != "x86_64", reason="needs an x86-64 processor")
def test_wider_registers_leave_angles_to_the_c_library(
    make: Make, angles: np.ndarray, circle: tuple[Reference, Reference]
) -> None:
    """Excess precision (x87) would spoil exact differences; the header sees it."""
    library = make("gcc", "-O2", "-mfpmath=387")
    assert library.libm
    for values, reference in zip(library.sine_cosine(angles), circle, strict=True):
        assert reference.errors(values).max() < stated("sine, cosine")


@pytest.mark.parametrize("flag", ["-ffast-math", "-ffinite-math-only", "-Ofast"])
def test_fast_math_is_refused(compiler: str, flag: str) -> None:
    """Without NaN there are no answers to tell apart; the compiler stops and says which flags are safe."""
    need(compiler)
    command = [compiler, flag, "-fsyntax-only", f"-I{c_sources()}", str(SOURCE)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode != 0 and "compile without -ffast-math" in done.stderr


def test_a_worse_polynomial_is_seen(
    tmp_path: Path, angles: np.ndarray, circle: tuple[Reference, Reference]
) -> None:
    """The bound bites: a coefficient wrong in its 10th digit, or pi/2 without its third part, exceeds it."""
    need("gcc")
    spoilt = {
        "2.48015872894767294178e-05": "2.48015872994767294178e-05",
        "n * 2.02226624879595063154e-21": "0.0",
    }
    for number, (good, bad) in enumerate(spoilt.items()):
        folder = tmp_path / str(number)
        folder.mkdir()
        assert good in HEADER
        (folder / "krhpr_elementary.h").write_text(HEADER.replace(good, bad))
        compile_shared("gcc", folder / "spoilt.so", "-O1", f"-I{folder}", f"-I{c_sources()}")
        values = Library(folder / "spoilt.so").sine_cosine(angles)
        assert max(r.errors(v).max() for v, r in zip(values, circle, strict=True)) > stated("sine, cosine")
