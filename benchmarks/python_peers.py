"""The peers of the benchmark from Python: CasADi, SymPy's ``lambdify``, and NumPy written by hand."""

from __future__ import annotations

import math
import subprocess
from collections.abc import Callable, Sequence
from functools import partial
from itertools import chain, pairwise
from pathlib import Path
from typing import Any

import casadi as ca
import numpy as np
import sympy as sp

from benchmarks.build import SPEED_FLAGS, Tools
from benchmarks.forward import every_solution, sextic
from benchmarks.numpy_by_hand import HAND_WRITTEN
from benchmarks.peers.casadi_c import function as casadi_function
from benchmarks.peers.driver import flat_names
from benchmarks.peers.sympy_c import SympyOps
from benchmarks.python_contender import Floats, Prepared, PythonContender
from benchmarks.samples import NumpyOps
from benchmarks.workloads import Form, Workload


class MathOps:
    """The standard library under the names that ``formulas`` uses."""

    sin, cos, sqrt, atan2, acos = math.sin, math.cos, math.sqrt, math.atan2, math.acos


def shaped(workload: Workload, flat: Sequence[Any]) -> list[Floats]:
    """Flat outputs, pose after pose, as (n, ...)."""
    arrays = zip(flat, workload.outputs, strict=True)
    return [np.asarray(values, dtype=float).reshape(-1, *array.shape) for values, array in arrays]


def from_components(workload: Workload, outputs: Sequence[Sequence[Any]]) -> list[Floats]:
    """Lists of component arrays (or floats) as (n, ...)."""
    stacked = [np.stack(np.broadcast_arrays(*values), axis=-1) for values in outputs]
    return shaped(workload, stacked)


def split(workload: Workload, flat: Sequence[Any]) -> list[Sequence[Any]]:
    """One flat list of all outputs, cut into outputs."""
    cuts = np.cumsum([0, *(array.size for array in workload.outputs)])
    return [flat[a:b] for a, b in pairwise(cuts)]


def contenders(workload: Workload, folder: Path, tools: Tools) -> list[PythonContender]:
    """Everybody who takes part."""
    if workload.key == "w3":
        return [PythonContender("numpy.roots", "of the sextic alone", batch=partial(numpy_roots, workload))]
    return [
        *casadi_contenders(workload, folder, tools),
        *sympy_contenders(workload),
        *hand_contenders(workload),
    ]


# numpy.roots takes one polynomial at a time; the sextic and the poses at its roots are not counted.


def numpy_roots(workload: Workload, inputs: list[Floats]) -> Prepared:
    """Coefficients in, lists of complex roots out."""
    (s,) = inputs
    sextics = [sextic(points) for points in s]

    def collect(found: list[Any]) -> list[Floats]:
        return every_solution([s], found)

    return Prepared(lambda: [np.roots(c) for c in sextics], collect)


# CasADi: the virtual machine called with arrays, and (virtual machine or compiled) with bound buffers.


def casadi_plain(workload: Workload, f: ca.Function, inputs: list[Floats]) -> Prepared:
    """``f(p, Q, theta)`` on NumPy arrays; a batch goes through ``f.map``, one column for each pose."""
    n = inputs[0].size // workload.inputs[0].size
    mapped = f.map(n) if n > 1 else f
    arguments = [
        np.asfortranarray(x.reshape(n, a.size).T) for x, a in zip(inputs, workload.inputs, strict=True)
    ]

    def collect(result: Any) -> list[Floats]:
        results = result if isinstance(result, tuple) else (result,)
        return shaped(workload, [np.array(x).T for x in results])

    return Prepared(lambda: mapped(*arguments), collect)


def casadi_buffers(workload: Workload, f: ca.Function, inputs: list[Floats]) -> Prepared:
    """``FunctionBuffer``: the arrays are bound once; a call is one trigger."""
    n = inputs[0].size // workload.inputs[0].size
    mapped = f.map(n) if n > 1 else f
    buffer, trigger = mapped.buffer()
    arguments = [np.ascontiguousarray(x).reshape(-1) for x in inputs]
    results = [np.full(n * array.size, np.nan) for array in workload.outputs]
    for k, array in enumerate(arguments):
        buffer.set_arg(k, memoryview(array))  # type: ignore[call-arg, arg-type]
    for k, array in enumerate(results):
        buffer.set_res(k, memoryview(array))  # type: ignore[call-arg, arg-type]
    alive = (buffer, arguments)  # the trigger does not own what it works on
    return Prepared(trigger, lambda _: shaped(workload, results) if alive else [])


def casadi_compiled(f: ca.Function, folder: Path, tools: Tools) -> ca.Function:
    """The same function as C, compiled with the flags of everybody and loaded by ``casadi.external``."""
    folder.mkdir(parents=True, exist_ok=True)
    generator = ca.CodeGenerator(f"{f.name()}.c")
    generator.add(f)
    source = Path(generator.generate(f"{folder}/"))
    library = source.with_suffix(".so")
    command = [tools.cc, *SPEED_FLAGS, "-fPIC", "-shared", str(source), "-o", str(library), "-lm"]
    subprocess.run(command, check=True, capture_output=True)
    return ca.external(f.name(), str(library))


def casadi_contenders(workload: Workload, folder: Path, tools: Tools) -> list[PythonContender]:
    """Three ways of calling, for every form of the workload."""
    contenders = []
    for form_name, form in workload.forms.items():
        f = casadi_function(workload, form, f"python_{workload.key}_{form_name}", cse=True)
        compiled = casadi_compiled(f, folder, tools)
        ways: dict[str, Callable[[list[Floats]], Prepared]] = {
            "virtual machine, arrays": partial(casadi_plain, workload, f),
            "virtual machine, bound buffers": partial(casadi_buffers, workload, f),
            "compiled, bound buffers": partial(casadi_buffers, workload, compiled),
        }
        contenders += [
            PythonContender("CasADi", f"{form_name}, {way}", prepare, prepare)
            for way, prepare in ways.items()
        ]
    return contenders


# SymPy's lambdify: NumPy component arrays for batches, the standard library's floats for single calls.


def lambdified(workload: Workload, form: Form, modules: str) -> Callable[..., list[Any]]:
    """A function of all scalars, returning one flat list."""
    symbols = [[sp.Symbol(name, real=True) for name in names] for names in flat_names(workload)]
    flat = [value for output in form(SympyOps, *symbols) for value in output]
    compiled: Callable[..., list[Any]] = sp.lambdify(list(chain(*symbols)), flat, modules=modules, cse=True)
    return compiled


def lambdify_batch(workload: Workload, f: Callable[..., list[Any]], inputs: list[Floats]) -> Prepared:
    """Contiguous component arrays in, a list of component arrays out, not stacked: the best case."""
    components = [np.ascontiguousarray(c) for x in inputs for c in x.reshape(len(x), -1).T]
    return Prepared(lambda: f(*components), lambda flat: from_components(workload, split(workload, flat)))


def lambdify_single(workload: Workload, f: Callable[..., list[Any]], inputs: list[Floats]) -> Prepared:
    """Floats in, a list of floats out."""
    scalars = [value for x in inputs for value in x.reshape(-1).tolist()]
    return Prepared(lambda: f(*scalars), lambda flat: shaped(workload, split(workload, flat)))


def sympy_contenders(workload: Workload) -> list[PythonContender]:
    """Both forms of the workload."""
    return [
        PythonContender(
            "SymPy lambdify",
            f"{form_name}, cse=True",
            partial(lambdify_single, workload, lambdified(workload, form, "math")),
            partial(lambdify_batch, workload, lambdified(workload, form, "numpy")),
        )
        for form_name, form in workload.forms.items()
    ]


# Written by hand (numpy_by_hand.py): component arrays, as NumPy users write kernels that must be quick.


def numpy_components(workload: Workload, inputs: list[Floats]) -> Prepared:
    """Contiguous component arrays in, component arrays out, not stacked."""
    components = [[np.ascontiguousarray(c) for c in x.reshape(len(x), -1).T] for x in inputs]
    kernel = HAND_WRITTEN[workload.key]
    return Prepared(lambda: kernel(NumpyOps, *components), partial(from_components, workload))


def numpy_stacked(workload: Workload, inputs: list[Floats]) -> Prepared:
    """(n, ...) arrays in and out, as ``numpy.linalg`` needs them next."""
    n = len(inputs[0])
    kernel = HAND_WRITTEN[workload.key]

    def call() -> list[Floats]:
        components = [list(x.reshape(n, -1).T) for x in inputs]
        results = [np.empty((n, array.size)) for array in workload.outputs]
        for result, values in zip(results, kernel(NumpyOps, *components), strict=True):
            for k, value in enumerate(values):
                result[:, k] = value
        return results

    return Prepared(call, partial(shaped, workload))


def floats_single(workload: Workload, inputs: list[Floats]) -> Prepared:
    """One pose: array to floats, the standard library's functions, and back to arrays."""
    kernel = HAND_WRITTEN[workload.key]

    def call() -> list[Floats]:
        outputs = kernel(MathOps, *(x.reshape(-1).tolist() for x in inputs))
        return [np.array(values) for values in outputs]

    return Prepared(call, partial(shaped, workload))


def hand_contenders(workload: Workload) -> list[PythonContender]:
    """Batches with NumPy; single calls with ``math``, which beats NumPy on scalars."""
    return [
        PythonContender("NumPy by hand", "component arrays", batch=partial(numpy_components, workload)),
        PythonContender("NumPy by hand", "(n, ...) arrays", batch=partial(numpy_stacked, workload)),
        PythonContender("Python by hand", "math, arrays in and out", single=partial(floats_single, workload)),
    ]
