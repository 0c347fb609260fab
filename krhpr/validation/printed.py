"""The printed texts, run on exact numbers: C by the interpreter, NumPy on objects, CasADi instruction by
instruction.

Each function here takes a robot's function, its arguments by port (flat, row by row) and a geometry by
field, and gives the results by port, flat and row by row, as the derivation's own evaluation does.
"""

from __future__ import annotations

import importlib
import importlib.util
import sys
from collections.abc import Callable, Iterable, Mapping
from contextlib import ExitStack
from fractions import Fraction
from functools import partial
from itertools import count
from math import prod
from pathlib import Path
from types import ModuleType
from typing import Any

import casadi
import numpy as np

from krhpr.codegen.composition import RobotFunction
from krhpr.codegen.kernel import Kernel, Port
from krhpr.codegen.phases import split
from krhpr.codegen.targets.c_batch import goes_side_by_side
from krhpr.validation import casadi_exact
from krhpr.validation.c_interpreter import Array, CProgram
from krhpr.validation.check import Target
from krhpr.validation.numbers import Arithmetic, arctan2, cos, sin
from krhpr.validation.numpy_exact import exact_numpy
from krhpr.validation.subject import Fields, Inputs, Outputs, Subject

Run = Callable[[Subject, RobotFunction, Inputs, Fields, Arithmetic], Outputs | None]
"""Runs a robot's function; None where it is not printed in this form."""


class WrongStatus(AssertionError):
    """A function said that it has no answer where there is one."""


# -- C ---------------------------------------------------------------------------------------------

ELEMENTARY = {"KRHPR_LIBM": ""}
"""The interpreter's sines and arctangents are exact; the project's own are approximations, tested by
themselves.
"""


_programs: dict[tuple[Path, str, str], CProgram] = {}


def c_program(subject: Subject, arithmetic: Arithmetic, kind: str = "") -> CProgram:
    """The robot's C source (`_batch`: that of its batches) with its headers, parsed once for each kind of
    number.
    """
    key = (subject.folder, subject.identifier + kind, arithmetic.name)
    if key not in _programs:
        # infinity is only ever compared with distances
        constants = {"INFINITY": 10**30}
        macros = {**ELEMENTARY, "KRHPR_LANES_ARE_POSES": ""} if kind else ELEMENTARY
        _programs[key] = CProgram(subject.c_sources(kind), arithmetic, constants, macros)
    return _programs[key]


def c_geometry(subject: Subject, geometry: Fields, program: CProgram) -> Any:
    """The C structure, set by the printed `set_geometry`."""
    structure = program.new_struct(f"krhpr_{subject.identifier}_geometry")
    fields = [geometry[name][leg] for leg in range(subject.code.legs) for name in subject.fields]
    status = program.call(f"krhpr_{subject.identifier}_set_geometry", structure, fields)
    if status != 0:
        raise WrongStatus(f"set_geometry returns {status}")
    return structure


def run_c(
    subject: Subject, function: RobotFunction, inputs: Inputs, geometry: Fields, arithmetic: Arithmetic
) -> Outputs:
    """A function of the C text."""
    program = c_program(subject, arithmetic)
    arguments = [inputs[port.name] if port.full_shape else inputs[port.name][0] for port in function.inputs]
    results = {port.name: Array.unset(prod(port.full_shape), port.name) for port in function.outputs}
    structure = c_geometry(subject, geometry, program)
    status = program.call(
        f"krhpr_{subject.identifier}_{function.name}", structure, *arguments, *results.values()
    )
    _expect_ok(status, function)
    return {name: list(values) for name, values in results.items()}


def run_c_poses(
    subject: Subject, function: RobotFunction, inputs: Inputs, geometry: Fields, arithmetic: Arithmetic
) -> Outputs | None:
    """A function of the C text for poses side by side, of which the interpreter has one; None where poses go
    one after the other.
    """
    if not goes_side_by_side(function):
        return None
    program = c_program(subject, arithmetic, "_batch")
    results = {port.name: Array.unset(prod(port.full_shape), port.name) for port in function.outputs}
    structure = program.new_struct(f"krhpr_{subject.identifier}_geometry")
    prepared = c_geometry(subject, geometry, c_program(subject, arithmetic))
    for member in ("subleg", "platform"):
        for field in dir(getattr(prepared, member)):
            setattr(getattr(structure, member), field, _numbers(getattr(getattr(prepared, member), field)))
    status = Array.unset(1, "answer")
    arguments = [inputs[port.name] for port in function.inputs]
    symbol = f"krhpr_{subject.identifier}_{function.name}_lanes"
    program.call(symbol, structure, *arguments, *results.values(), status)
    _expect_ok(status[0], function)
    return {name: list(values) for name, values in results.items()}


def _numbers(values: Any) -> list[Any]:
    """An array of numbers, or one of such arrays, as lists."""
    return [_numbers(value) if isinstance(value, Array) else value for value in values]


def _expect_ok(status: int, function: RobotFunction) -> None:
    if status != 0 and function.name != "inverse_status":
        raise WrongStatus(f"{function.name} returns the status {status}")


# -- NumPy -----------------------------------------------------------------------------------------

_copies = count()
_modules: dict[tuple[Path, str, str], tuple[ModuleType, ExitStack]] = {}


def numpy_module(subject: Subject, arithmetic: Arithmetic) -> ModuleType:
    """A copy of the generated module that computes with exact numbers for as long as the process lives."""
    key = (subject.folder, subject.identifier, arithmetic.name)
    if key not in _modules:
        name = f"krhpr_exact_{next(_copies)}"
        folder = subject.folder / "python"
        spec = importlib.util.spec_from_file_location(
            name, folder / "__init__.py", submodule_search_locations=[str(folder)]
        )
        assert spec is not None and spec.loader is not None
        sys.modules[name] = importlib.util.module_from_spec(spec)
        module = importlib.import_module(f"{name}.{subject.identifier}")
        stack = ExitStack()
        parts = [getattr(module, part) for part in subject.code.parts if hasattr(module, part)]
        involved = [module, module.rt, *parts]
        stack.enter_context(exact_numpy(*involved, arithmetic=arithmetic))
        _modules[key] = module, stack
    return _modules[key][0]


def run_numpy(
    subject: Subject, function: RobotFunction, inputs: Inputs, geometry: Fields, arithmetic: Arithmetic
) -> Outputs:
    """A function of the NumPy text."""
    module = numpy_module(subject, arithmetic)
    arguments = {
        port.name: _object_array(inputs[port.name], port.full_shape, arithmetic) for port in function.inputs
    }
    legs = subject.code.legs
    fields = {name: _object_array(geometry[name], (legs,), arithmetic) for name in subject.fields}
    default = module.DEFAULT_GEOMETRY
    place = module.Geometry(fields, default.order, default.positive, legs)
    answer, status = getattr(module, function.name)(**arguments, geometry=place, status=True)
    _expect_ok(int(status), function)
    found = answer if len(function.outputs) > 1 else (answer,)
    return {port.name: list(np.ravel(value)) for port, value in zip(function.outputs, found, strict=True)}


def _object_array(values: Any, shape: tuple[int, ...], arithmetic: Arithmetic) -> Any:
    array = np.empty(prod(shape), dtype=object)
    for index, value in enumerate(values):
        array[index] = arithmetic.lift(value)
    return array.reshape(shape)


# -- CasADi ----------------------------------------------------------------------------------------

_functions: dict[tuple[Path, str, str], casadi.Function] = {}


def casadi_function(subject: Subject, function: RobotFunction) -> casadi.Function:
    """The casadi.Function with a symbolic geometry as its last input."""
    key = (subject.folder, subject.identifier, function.name)
    if key not in _functions:
        module = subject.casadi
        geometry = casadi.SX.sym("geometry", subject.code.legs * len(module.FIELDS))
        _functions[key] = module.FUNCTIONS[function.name](geometry)
    return _functions[key]


def run_casadi(
    subject: Subject, function: RobotFunction, inputs: Inputs, geometry: Fields, arithmetic: Arithmetic
) -> Outputs:
    """A function of the CasADi text."""
    built = casadi_function(subject, function)
    arguments: list[Any] = [_rows(inputs[port.name], port) for port in function.inputs]
    arguments.append([geometry[name][leg] for leg in range(subject.code.legs) for name in subject.fields])
    parts = subject.code.parts
    constants = _constants(subject, (parts[call.part].kernel(call.kernel) for call in function.calls))
    matrices = casadi_exact.evaluate(built, arguments, arithmetic, lambda value: constants.get(value, value))
    found = dict(zip(built.name_out(), matrices, strict=True))
    return {
        port.name: unpack(port, lambda name: [x for row in found[name] for x in row])
        for port in function.outputs
    }


def _rows(values: Any, port: Port) -> list[list[Any]]:
    """Row-major values as the rows of CasADi's matrix."""
    columns = (*port.full_shape, 1, 1)[1]
    return [list(values[start : start + columns]) for start in range(0, len(values), columns)]


def unpack(port: Port, matrix: Callable[[str], Any]) -> list[Any]:
    """A port's values, row by row, from CasADi's results (several where they are more than a matrix: one for
    each leg, or each solution).
    """
    if len(port.full_shape) > 2:
        return [value for first in range(port.full_shape[0]) for value in matrix(f"{port.name}{first + 1}")]
    return list(matrix(port.name))


def _constants(subject: Subject, kernels: Iterable[Kernel]) -> dict[float, Fraction]:
    """The fractions of the derivation that CasADi knows as the nearest double."""
    prepared = [part.geometry.prepare for part in subject.code.parts.values() if part.geometry is not None]
    graphs = [kernel.graph for kernel in (*kernels, *prepared)]
    values = [node.value for graph in graphs for _, node in graph if isinstance(node.value, Fraction)]
    return {float(value): value for value in values}


# -- kernels by themselves -------------------------------------------------------------------------


def c_kernel(
    subject: Subject,
    key: str,
    kernel: Kernel,
    inputs: Inputs,
    geometry: Fields,
    arithmetic: Arithmetic,
    suffix: str = "",
) -> Outputs:
    """A kernel of the C text, with its sines and cosines before it and its arctangents after it.

    `suffix`: `_lanes` for its form over lanes, of which the interpreter has one.
    """
    program = c_program(subject, arithmetic)
    part = subject.code.parts[key]
    phases = split(part.kernel(kernel.name))
    symbol = f"krhpr_{part.name}_{kernel.name}"
    values: dict[str, Any] = {
        port.name: inputs[port.name] if port.shape else inputs[port.name][0] for port in kernel.inputs
    }
    if kernel.geometry is not None:
        values |= {"g": getattr(c_geometry(subject, geometry, program), key), "i": 0}
    if phases.angles is not None:
        angles = Array.unset(phases.angles.outputs[0].size, "angle")
        names = program.parameters(f"{symbol}_angles{suffix}")
        program.call(
            f"{symbol}_angles{suffix}", *(angles if name == "angle" else values[name] for name in names)
        )
        values |= {"sine": [sin(angle) for angle in angles], "cosine": [cos(angle) for angle in angles]}
    results = {port.name: Array.unset(port.size, port.name) for port in phases.body.outputs}
    names = program.parameters(f"{symbol}{suffix}")
    program.call(f"{symbol}{suffix}", *({**values, **results}[name] for name in names))
    found = {name: list(array) for name, array in results.items()}
    for tail in phases.tails:
        found[tail.port.name] = [arctan2(found["tail_y"][slot], found["tail_x"][slot]) for slot in tail.slots]
    return found


def numpy_kernel(
    subject: Subject, key: str, kernel: Kernel, inputs: Inputs, geometry: Fields, arithmetic: Arithmetic
) -> Outputs:
    """A kernel of the NumPy text."""
    module = getattr(numpy_module(subject, arithmetic), key)
    fields = {name: arithmetic.lift(values[0]) for name, values in geometry.items()}
    arguments = [module.prepare(fields)] if kernel.geometry is not None else []
    found = getattr(module, kernel.name)(*arguments, *(inputs[port.name] for port in kernel.inputs))
    parts = found if len(kernel.outputs) > 1 else (found,)
    return {port.name: list(values) for port, values in zip(kernel.outputs, parts, strict=True)}


def casadi_kernel(
    subject: Subject, key: str, kernel: Kernel, inputs: Inputs, geometry: Fields, arithmetic: Arithmetic
) -> Outputs:
    """A kernel of the CasADi text."""
    module = getattr(subject.casadi, key)
    fields = {name: casadi.SX.sym(name) for name in geometry}
    symbols = {port.name: casadi.SX.sym(port.name, port.size) for port in kernel.inputs}
    arguments = [module.prepare(fields)] if kernel.geometry is not None else []
    arguments += [casadi.vertsplit(symbols[port.name]) for port in kernel.inputs]
    found = getattr(module, kernel.name)(*arguments)
    parts = found if len(kernel.outputs) > 1 else (found,)
    outputs = [casadi.vertcat(*part) for part in parts]
    built = casadi.Function(kernel.name, [*fields.values(), *symbols.values()], outputs)
    values = [*([entry[0]] for entry in geometry.values()), *(inputs[port.name] for port in kernel.inputs)]
    constants = _constants(subject, [subject.code.parts[key].kernel(kernel.name)])
    matrices = casadi_exact.evaluate(built, values, arithmetic, lambda value: constants.get(value, value))
    return {port.name: [row[0] for row in rows] for port, rows in zip(kernel.outputs, matrices, strict=True)}


KERNELS = {
    Target.C: (c_kernel, partial(c_kernel, suffix="_lanes")),
    Target.NUMPY: (numpy_kernel,),
    Target.CASADI: (casadi_kernel,),
}
"""How a kernel of each printed target is run by itself, in each form in which it is printed."""

PRINTED: Mapping[Target, tuple[Run, ...]] = {
    Target.C: (run_c, run_c_poses),
    Target.NUMPY: (run_numpy,),
    Target.CASADI: (run_casadi,),
}
"""How each printed target is run, in each form in which it is printed."""


def forget(folder: Path) -> None:
    """Drop what is kept of the texts in a folder: a parsed program takes some fifty megabytes."""
    for kept in (_programs, _modules, _functions):
        for key in [key for key in kept if key[0] == folder]:
            value = kept.pop(key)
            if isinstance(value, tuple):
                module, stack = value
                stack.close()
                prefix = module.__name__.rpartition(".")[0]
                for name in [name for name in sys.modules if name == prefix or name.startswith(f"{prefix}.")]:
                    del sys.modules[name]
