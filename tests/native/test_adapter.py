"""Gufuncs of compiled kernels behave as NumPy's own functions do."""

from __future__ import annotations

import ctypes
import gc
import os
import threading
import tracemalloc
import warnings
import weakref
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from krhpr.native import (
    Compiler,
    NoCompiler,
    adapter,
    compile_library,
    function_address,
    load_library,
    make_gufunc,
)
from tests.native.support import GEOMETRY, KERNELS, OFFSET, SCALE, SOURCE, run_python

Make = Callable[[str], np.ufunc]
RNG = np.random.default_rng(7)


def expected(x: Any, a: Any) -> Any:
    return SCALE * (np.asarray(a, float) @ np.asarray(x, float)[..., None])[..., 0] + OFFSET


def check(y: Any, x: Any, a: Any) -> None:
    np.testing.assert_allclose(y, expected(x, a), rtol=1e-14, atol=1e-14)


# -- shapes and types ----------------------------------------------------------------------------------------


def test_describes_itself(matvec: np.ufunc) -> None:
    assert isinstance(matvec, np.ufunc)
    assert matvec.__name__ == "matvec"
    assert "kernel matvec" in str(matvec.__doc__)
    assert matvec.signature == "(3),(3,3)->(3),()"
    assert (matvec.nin, matvec.nout, matvec.types) == (2, 2, ["dd->di"])


def test_single_call(matvec: np.ufunc) -> None:
    x, a = RNG.normal(size=3), RNG.normal(size=(3, 3))
    y, status = matvec(x, a)
    check(y, x, a)
    assert y.dtype == np.float64
    assert status.dtype == np.int32
    assert status == 0


@pytest.mark.parametrize(
    ("x_batch", "a_batch"),
    [((), (5,)), ((5,), ()), ((4, 1), (5,)), ((2, 1, 3), (7, 1)), ((1,), (6,)), ((200,), (200,))],
)
def test_broadcasts_over_batch_dimensions(
    matvec: np.ufunc, x_batch: tuple[int, ...], a_batch: tuple[int, ...]
) -> None:
    x, a = RNG.normal(size=(*x_batch, 3)), RNG.normal(size=(*a_batch, 3, 3))
    y, status = matvec(x, a)
    assert y.shape == (*np.broadcast_shapes(x_batch, a_batch), 3)
    assert status.shape == y.shape[:-1]
    check(y, x, a)


def test_broadcast_with_steps_of_zero(matvec: np.ufunc) -> None:
    x = np.broadcast_to(RNG.normal(size=3), (50, 3))
    a = np.broadcast_to(RNG.normal(size=(3, 3)), (50, 3, 3))
    assert x.strides[0] == a.strides[0] == 0
    check(matvec(x, a)[0], x, a)
    # Zero within the core array, where a kernel cannot follow.
    x = np.broadcast_to(RNG.normal(size=(50, 1)), (50, 3))
    check(matvec(x, a)[0], x, a)


@pytest.mark.parametrize("batch", [(0,), (0, 4), (4, 0), (3, 0, 2)])
def test_empty_batch(matvec: np.ufunc, make: Make, batch: tuple[int, ...]) -> None:
    y, status = matvec(np.empty((*batch, 3)), np.eye(3))
    assert y.shape == (*batch, 3)
    assert status.shape == batch
    assert make("root")(np.empty(batch))[0].shape == batch


@pytest.mark.parametrize("dtype", ["f4", "i4", "u1", "?", ">f8", "f2"])
def test_inputs_are_cast(matvec: np.ufunc, dtype: str) -> None:
    x, a = RNG.integers(0, 2, (70, 3)).astype(dtype), RNG.integers(0, 2, (70, 3, 3)).astype(dtype)
    y, _ = matvec(x, a)
    assert y.dtype == np.float64
    check(y, x, a)


def test_lists_are_taken(matvec: np.ufunc) -> None:
    x, a = [1, 2.5, 3], [[1, 2, 3], [4, 5, 6], [7, 8, 9]]
    check(matvec(x, a)[0], x, a)


@pytest.mark.parametrize("wrong", [np.ones(3, complex), np.array(["a"] * 3), np.array([object()] * 3)])
def test_other_types_are_refused(matvec: np.ufunc, wrong: Any) -> None:
    with pytest.raises(TypeError):
        matvec(wrong, np.eye(3))


@pytest.mark.parametrize(
    ("x_shape", "a_shape"), [((4,), (3, 3)), ((3,), (3, 2)), ((2,), (2, 2)), ((), (3, 3)), ((3,), (3,))]
)
def test_wrong_core_shape(matvec: np.ufunc, x_shape: tuple[int, ...], a_shape: tuple[int, ...]) -> None:
    with pytest.raises(ValueError, match="matvec"):
        matvec(np.ones(x_shape), np.ones(a_shape))


def test_batches_that_do_not_broadcast(matvec: np.ufunc) -> None:
    with pytest.raises(ValueError, match="broadcast"):
        matvec(np.ones((4, 3)), np.ones((5, 3, 3)))


def test_several_outputs(make: Make) -> None:
    x = RNG.normal(size=(9, 2, 3))
    transposed, total, status = make("split")(x)
    np.testing.assert_array_equal(transposed, x.swapaxes(1, 2))
    np.testing.assert_allclose(total, x.sum(axis=(1, 2)), atol=1e-14)
    np.testing.assert_array_equal(status, range(9))


def test_status_says_what_no_warning_says(make: Make) -> None:
    root = make("root")
    with warnings.catch_warnings(), np.errstate(all="raise"):
        warnings.simplefilter("error")
        y, status = root(np.array([4.0, -1.0, 0.0, np.inf, np.nan]))
    np.testing.assert_array_equal(y, [2.0, np.nan, 0.0, np.inf, np.nan])
    np.testing.assert_array_equal(status, [0, 7, 0, 0, 0])
    y, status = root(9.0)
    assert (y, status) == (3.0, 0)


# -- out= and memory layouts ---------------------------------------------------------------------------------


def test_out_is_filled_and_returned(matvec: np.ufunc) -> None:
    x, a = RNG.normal(size=(20, 3)), RNG.normal(size=(20, 3, 3))
    y, status = np.full((20, 3), np.nan), np.full(20, -1, np.int32)
    result = matvec(x, a, out=(y, status))
    assert result[0] is y
    assert result[1] is status
    check(y, x, a)
    assert not status.any()
    y[:] = np.nan
    assert matvec(x, a, out=(y, None))[0] is y
    check(y, x, a)


def test_out_of_other_types(matvec: np.ufunc) -> None:
    x, a = RNG.normal(size=(20, 3)), RNG.normal(size=(20, 3, 3))
    y, status = np.empty((20, 3), "f4"), np.full(20, -1, np.int64)
    matvec(x, a, out=(y, status))
    np.testing.assert_allclose(y, expected(x, a), rtol=1e-5, atol=1e-5)
    assert not status.any()
    with pytest.raises(TypeError):
        matvec(x, a, out=(np.empty((20, 3), int), None))


def test_out_of_wrong_shape(matvec: np.ufunc) -> None:
    for shape in [(4,), (5, 3, 1), (3, 2)]:
        with pytest.raises(ValueError, match=r"matvec|broadcast"):
            matvec(np.ones(3), np.eye(3), out=(np.empty(shape), None))


def test_axes_and_subclasses(matvec: np.ufunc) -> None:
    x, a = RNG.normal(size=(3, 20)), RNG.normal(size=(3, 3, 20))
    y, _ = matvec(x, a, axes=[(0,), (0, 1), (0,), ()])
    check(y.T, x.T, a.transpose(2, 0, 1))


LAYOUTS: dict[str, Callable[[Any], Any]] = {
    "contiguous": np.ascontiguousarray,
    "Fortran": np.asfortranarray,
    "transposed core": lambda a: a.swapaxes(-1, -2).copy().swapaxes(-1, -2),
    "reversed batch": lambda a: a[::-1].copy()[::-1],
    "reversed core": lambda a: a[..., ::-1].copy()[..., ::-1],
    "every other": lambda a: np.repeat(a, 2, axis=0)[::2],
    "every other in the core": lambda a: np.repeat(a, 2, axis=-1)[..., ::2],
    "record field": lambda a: _in_record(a, "i8"),
    "odd record field": lambda a: _in_record(a, "i1"),
}


def _in_record(a: Any, other: str) -> Any:
    """A view of the same values between others; with steps that are no multiples of 8 if `other` is short."""
    records = np.zeros(a.shape[0], [("other", other), ("value", a.dtype, a.shape[1:]), ("last", other)])
    records["value"] = a
    return records["value"]


@pytest.mark.parametrize("layout", LAYOUTS)
@pytest.mark.parametrize("size", [1, 63, 64, 65, 1000])
def test_layouts_of_inputs_and_outputs(matvec: np.ufunc, layout: str, size: int) -> None:
    lay = LAYOUTS[layout]
    x, a = RNG.normal(size=(size, 3)), RNG.normal(size=(size, 3, 3))
    as_laid, xs_laid = lay(a), lay(x)
    np.testing.assert_array_equal(as_laid, a)
    check(matvec(x, as_laid)[0], x, a)
    check(matvec(xs_laid, as_laid)[0], x, a)
    y = lay(np.full((size, 3), np.nan))
    status = lay(np.full((size, 1), -1, np.int32))[:, 0]
    matvec(x, a, out=(y, status))
    check(y, x, a)
    assert not status.any()


def test_two_dimensional_output_layouts(make: Make) -> None:
    x = RNG.normal(size=(130, 2, 3))
    for name, lay in LAYOUTS.items():
        y, total = lay(np.zeros((130, 3, 2))), lay(np.zeros((130, 1)))[:, 0]
        make("split")(x, out=(y, total, None))
        np.testing.assert_array_equal(y, x.swapaxes(1, 2), err_msg=name)
        np.testing.assert_allclose(total, x.sum(axis=(1, 2)), atol=1e-14, err_msg=name)


@st.composite
def views(draw: st.DrawFn, batch: tuple[int, ...], core: tuple[int, ...]) -> Any:
    """Random numbers in an array with any order of axes, any steps, or not even aligned."""
    shape = (*(draw(st.sampled_from((1, n))) for n in batch), *core)
    order = draw(st.permutations(range(len(shape))))
    steps = [draw(st.sampled_from((1, 1, 1, -1, 2, -3))) for _ in shape]
    big = [n * abs(step) for n, step in zip(shape, steps, strict=True)]
    shift = draw(st.sampled_from((0, 0, 1, 4, 8)))
    memory = np.zeros(8 * int(np.prod(big)) + shift, np.uint8)
    flat = np.frombuffer(memory.data, np.float64, offset=shift)
    view = flat.reshape([big[i] for i in order]).transpose(np.argsort(order))
    view = view[tuple(slice(None, None, step) for step in steps)]
    view[...] = np.random.default_rng(draw(st.integers(0, 2**32))).normal(size=shape)
    assert view.shape == shape
    return view


@given(st.data())
@settings(deadline=None, max_examples=150)
def test_any_layout(matvec: np.ufunc, data: st.DataObject) -> None:
    batch = tuple(data.draw(st.lists(st.integers(1, 9), max_size=3)))
    x, a = data.draw(views(batch, (3,))), data.draw(views(batch, (3, 3)))
    out_batch = np.broadcast_shapes(x.shape[:-1], a.shape[:-2])
    y, _ = matvec(x, a)
    assert y.shape == (*out_batch, 3)
    check(y, x, a)
    out = data.draw(views(out_batch, (3,)).filter(lambda v: v.shape == (*out_batch, 3)))
    matvec(x, a, out=(out, None))
    np.testing.assert_array_equal(out, y)


def test_contiguous_batches_go_straight_through(make: Make) -> None:
    calls = make("calls")
    y, status = calls(np.zeros((1000, 2)))
    assert (y == (1000, 2, 3)).all()
    assert (status == 1).all()
    y, _ = calls(np.broadcast_to(np.zeros(2), (1000, 2)))
    assert (y == (1000, 0, 3)).all()
    y, _ = calls(np.zeros((1000, 2))[::-1])
    assert (abs(y) == (1000, 2, 3)).all()  # NumPy may turn all the steps round
    y, _ = calls(np.zeros((1000, 5))[:, 1:3])
    assert (y == (1000, 5, 3)).all()
    # What has to be packed comes in blocks.
    y, _ = calls(np.zeros((1000, 4))[:, ::2])
    assert (y[:, 1:] == (2, 3)).all()
    assert y[0, 0] == 64


# -- overlapping memory --------------------------------------------------------------------------------------


def test_output_over_the_very_input(matvec: np.ufunc) -> None:
    for size in (1, 5, 1000):
        x, a = RNG.normal(size=(size, 3)), RNG.normal(size=(size, 3, 3))
        y = x.copy()
        assert matvec(y, a, out=(y, None))[0] is y
        check(y, x, a)
    x, a = RNG.normal(size=3), RNG.normal(size=(3, 3))
    y = x.copy()
    matvec(y, a, out=(y, None))
    check(y, x, a)


@pytest.mark.parametrize("shift", [1, 2, 3, 7])
def test_output_over_shifted_input(matvec: np.ufunc, shift: int) -> None:
    memory = RNG.normal(size=400)
    x, y = memory[:300].reshape(100, 3), memory[shift : 300 + shift].reshape(100, 3)
    before, a = x.copy(), RNG.normal(size=(100, 3, 3))
    matvec(x, a, out=(y, None))
    check(y, before, a)
    x, y = memory[:300].reshape(100, 3)[::-1], memory[:300].reshape(100, 3)
    before = x.copy()
    matvec(x, a, out=(y, None))
    check(y, before, a)


def test_outputs_inside_an_input(matvec: np.ufunc) -> None:
    a = RNG.normal(size=(100, 3, 3))
    x, before = RNG.normal(size=(100, 3)), a.copy()
    matvec(x, a, out=(a[:, 1], None))
    check(a[:, 1], x, before)


@pytest.mark.parametrize("size", [1, 3, 64, 200, 20000])
def test_scalar_function_in_place(make: Make, size: int) -> None:
    root = make("root")
    x = RNG.uniform(size=size)
    for lay in (np.copy, lambda v: np.repeat(v, 2)[::2], lambda v: v[::-1].copy()[::-1]):
        y = lay(x)
        root(y, out=(y, None))
        np.testing.assert_array_equal(y, np.sqrt(x))
    y = np.concatenate([x, [0.0]])
    root(y[:-1], out=(y[1:], None))
    np.testing.assert_array_equal(y[1:], np.sqrt(x))
    single = x.astype("f4")
    expected = np.sqrt(single.astype(float)).astype("f4")
    root(single, out=(single, None))
    np.testing.assert_array_equal(single, expected)


# -- construction --------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("signature", "nin", "nout", "message"),
    [
        ("(n)->(3),()", 1, 1, "positive number"),
        ("(3?)->(3),()", 1, 1, None),
        ("(3)->(3),(1)", 1, 1, "status"),
        ("(3)->(3)", 1, 1, None),
        ("(3),(3)->(3),()", 1, 1, None),
        ("(3)->(3),(),()", 1, 1, None),
        ("3->3", 1, 1, None),
        ("(1025)->()", 1, 0, "1024"),
        ("(32,33)->()", 1, 0, "1024"),
        ("(4000000000,4000000000)->()", 1, 0, "1024"),
        ("(1024),(32,32),(1024),(1024)->()", 4, 0, "together"),
        ("(2,2,2,2,2)->()", 1, 0, "core dimensions"),
        ("(3)->()", -1, 0, "supported"),
        (",".join(["(1)"] * 32) + "->()", 32, 0, "supported"),
    ],
)
def test_signatures_that_are_refused(
    library: ctypes.CDLL, signature: str, nin: int, nout: int, message: str | None
) -> None:
    address = function_address(library, "matvec")
    with pytest.raises(ValueError, match=message):
        make_gufunc("f", "", address, None, signature, nin, nout, library)


def test_largest_signatures_work(library: ctypes.CDLL) -> None:
    f = make_gufunc("f", "", function_address(library, "calls"), None, "(1024)->(3),()", 1, 1, library)
    y, _ = f(np.zeros((10, 2048))[:, ::2])
    assert (y[:, 1:] == (1024, 3)).all()
    many = ",".join(["(1)"] * 30)
    f = make_gufunc("f", "", function_address(library, "calls"), None, f"{many}->(3),()", 30, 1, library)
    assert (f(*[np.zeros((5, 1))] * 30)[0] == (5, 1, 3)).all()


def test_arguments_that_are_refused(library: ctypes.CDLL) -> None:
    address = function_address(library, "matvec")
    with pytest.raises(ValueError, match="address is 0"):
        make_gufunc("f", "", 0, None, "(3)->()", 1, 0, library)
    wrong: Any
    for wrong in ("text", 1.0, [1.0]):
        with pytest.raises(TypeError):
            make_gufunc("f", "", address, wrong, "(3)->()", 1, 0, library)
    with pytest.raises(TypeError):
        wrong = None
        make_gufunc(wrong, "", address, None, "(3)->()", 1, 0, library)
    with pytest.raises(AttributeError):
        function_address(library, "no_such_function")


class GeometryType(ctypes.Structure):
    _fields_ = (("scale", ctypes.c_double), ("offset", ctypes.c_double * 3))


def test_geometry_is_copied_from_any_buffer(library: ctypes.CDLL, matvec: np.ufunc) -> None:
    address = function_address(library, "matvec")
    signature, nin, nout = KERNELS["matvec"]
    structure = GeometryType(SCALE, OFFSET)
    changing = bytearray(GEOMETRY)
    array = np.array([SCALE, *OFFSET])
    strided = np.repeat(array, 2)[::2]
    x, a = np.array([1.0, 2.0, 3.0]), RNG.normal(size=(3, 3))
    for geometry in (structure, changing, array, strided, memoryview(GEOMETRY), GEOMETRY):
        f = make_gufunc("f", "", address, geometry, signature, nin, nout, library)
        structure.scale = 100.0
        changing[:] = bytes(len(changing))
        array[:] = 0.0
        check(f(x, a)[0], x, a)
        structure.scale, changing[:], array[:] = SCALE, GEOMETRY, [SCALE, *OFFSET]
        changing.extend(b"")  # not held


@pytest.mark.usefixtures("collected")
def test_names_and_texts_of_any_language(library: ctypes.CDLL) -> None:
    address = function_address(library, "calls")
    name, doc = "".join(["θ"]), "".join(["β̇ = ", "M⁻¹"])
    f = make_gufunc(name, doc, address, None, "(2)->(3),()", 1, 1, None)
    del name, doc
    gc.collect()
    assert f.__name__ == "θ"
    assert "β̇ = M⁻¹" in str(f.__doc__)


# -- threads and lifetimes -----------------------------------------------------------------------------------


def test_calls_run_side_by_side(make: Make) -> None:
    meet = make("meet")
    with ThreadPoolExecutor(2) as pool:
        results = list(pool.map(lambda _: meet(np.zeros((1000, 1)))[1], range(2)))
    assert not np.any(results), "one call waited for the other to end"


def test_many_threads(matvec: np.ufunc, make: Make) -> None:
    x, a = RNG.normal(size=(500, 3)), RNG.normal(size=(500, 3, 3))
    fortran = np.asfortranarray(a)
    gate = threading.Barrier(16)

    def work(_: int) -> None:
        gate.wait()
        for _ in range(50):
            check(matvec(x, a)[0], x, a)
            check(make("matvec")(x, fortran)[0], x, a)

    with ThreadPoolExecutor(16) as pool:
        list(pool.map(work, range(16)))


class Owner:
    """Something that can be watched."""


@pytest.mark.usefixtures("collected")
def test_owner_lives_as_long_as_the_function(compiler: Compiler) -> None:
    library = load_library(compile_library("kernels", [SOURCE], compiler=compiler))
    owner: Any = Owner()
    owner.library = library
    watch = weakref.ref(owner)
    signature, nin, nout = KERNELS["matvec"]
    address = function_address(library, "matvec")
    f = make_gufunc("matvec", "", address, bytearray(GEOMETRY), signature, nin, nout, owner)
    del library, owner
    gc.collect()
    assert watch() is not None
    x, a = RNG.normal(size=(10, 3)), RNG.normal(size=(10, 3, 3))
    check(f(x, a)[0], x, a)
    del f
    gc.collect()
    assert watch() is None


@pytest.mark.usefixtures("collected")
def test_owner_that_holds_the_function_is_collected(library: ctypes.CDLL) -> None:
    owner: Any = Owner()
    signature, nin, nout = KERNELS["matvec"]
    address = function_address(library, "matvec")
    owner.f = make_gufunc("matvec", "", address, GEOMETRY, signature, nin, nout, owner)
    owner.f(np.ones(3), np.eye(3))
    watch = weakref.ref(owner)
    del owner
    gc.collect()
    assert watch() is None


def _resident() -> int:
    with open("/proc/self/statm") as file:
        return int(file.read().split()[1]) * os.sysconf("SC_PAGE_SIZE")


@pytest.mark.skipif(not os.path.exists("/proc/self/statm"), reason="needs /proc/self/statm to see leaks")
@pytest.mark.usefixtures("collected")
def test_nothing_leaks(library: ctypes.CDLL) -> None:
    address = function_address(library, "matvec")
    signature, nin, nout = KERNELS["matvec"]
    geometry = GEOMETRY + bytes(1000)
    x, a = np.ones((2, 3)), np.asfortranarray(np.ones((2, 3, 3)))

    def create(times: int) -> None:
        for _ in range(times):
            f = make_gufunc("matvec", "doc" * 100, address, geometry, signature, nin, nout, Owner())
            f(x, a)
            with pytest.raises(ValueError, match="status"):
                make_gufunc("f", "", address, geometry, "(3)->(3)", 1, 0, Owner())

    create(1000)
    gc.collect()
    before = _resident()
    create(10_000)
    gc.collect()
    assert _resident() - before < 1_000_000  # a hundred bytes for each

    tracemalloc.start()
    try:
        create(10)
        gc.collect()
        start = tracemalloc.get_traced_memory()[0]
        create(1000)
        gc.collect()
        assert tracemalloc.get_traced_memory()[0] - start < 20_000
    finally:
        tracemalloc.stop()


# -- the extension -------------------------------------------------------------------------------------------


def test_missing_python_headers_are_named(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setattr("sysconfig.get_path", lambda name: str(tmp_path / "nowhere"))
    with pytest.raises(NoCompiler, match=r"Python\.h.*python3-dev"):
        adapter.extension_paths()


def test_library_that_cannot_be_loaded(tmp_path: Path) -> None:
    (tmp_path / "bad.so").write_bytes(b"not a library")
    with pytest.raises(OSError, match=r"bad\.so cannot be loaded: .*KRHPR_CACHE"):
        load_library(tmp_path / "bad.so")


@pytest.mark.parametrize("program", ["gcc", "clang"])
def test_each_compiler_takes_it_without_a_warning(
    program: str,
    tmp_path: Path,
) -> None:
    """The extension and the kernels, with warnings as errors; then both at work in a process of their own."""
    code = f"""
import numpy as np
from krhpr.native import *
from krhpr.native import adapter
try:
    find_compiler()
except NoCompiler as error:
    print("NONE", error)
    raise SystemExit
warnings = ("-Wall", "-Wextra", "-Werror", "-Wshadow", "-Wconversion", "-Wvla")
speed = (*SPEED_FLAGS, *warnings)
adapter.EXTENSION_FLAGS += warnings
library = load_library(compile_library("kernels", [{str(SOURCE)!r}], flags=speed))
f = make_gufunc("split", "", function_address(library, "split"), None, "(2,3)->(3,2),(),()", 1, 2, library)
x = np.arange(60.0).reshape(10, 2, 3)
for x in (x, x[:, ::-1, ::-1]):
    assert (f(x)[0] == x.swapaxes(1, 2)).all()
print("WORKS", find_compiler().version)
"""
    done = run_python(code, KRHPR_CC=program, KRHPR_CACHE=str(tmp_path))
    assert done.returncode == 0, done.stderr
    if done.stdout.startswith("NONE"):
        pytest.skip(f"needs {program}: {done.stdout[5:].strip()}")
    assert done.stdout.startswith("WORKS")
