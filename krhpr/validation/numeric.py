"""The generated functions in doubles: compiled C, NumPy and CasADi behind one interface.

`call(name, values)` takes a function's arguments as arrays with the batch first and gives its results by
port the same way, with the status under "status" where the target has one.
"""

from __future__ import annotations

import ctypes
from collections.abc import Mapping, Sequence
from math import prod
from typing import Any, Protocol

import casadi
import numpy as np
from numpy.typing import NDArray

from krhpr.codegen.composition import RobotFunction
from krhpr.native import load_library
from krhpr.validation.check import Target
from krhpr.validation.printed import casadi_function, unpack
from krhpr.validation.subject import Subject

Floats = NDArray[np.float64]
Values = Mapping[str, Any]
Geometry = Mapping[str, Sequence[float]]


class Numeric(Protocol):
    """A target that computes with doubles."""

    subject: Subject

    def call(self, name: str, values: Values, geometry: Geometry | None = None) -> dict[str, Floats]:
        """A function on a batch, with the default sizes unless a geometry is given."""


def target(subject: Subject, which: Target) -> Numeric:
    """The target of a subject; raises `NoCompiler` for C where there is none."""
    makers: dict[Target, type[Any]] = {Target.C: CompiledC, Target.NUMPY: Numpy, Target.CASADI: Casadi}
    made: Numeric = makers[which](subject)
    return made


class Numpy:
    """The generated NumPy module."""

    def __init__(self, subject: Subject) -> None:
        self.subject = subject
        self.module = subject.module

    def call(self, name: str, values: Values, geometry: Geometry | None = None) -> dict[str, Floats]:
        """A function of the module."""
        function = self.subject.code.function(name)
        arguments = {port.name: values[port.name] for port in function.inputs if port.name in values}
        place = self.module.DEFAULT_GEOMETRY
        if geometry is not None:
            place = place.replace(**{key: tuple(entry) for key, entry in geometry.items()})
        answer, status = getattr(self.module, name)(**arguments, geometry=place, status=True)
        found = answer if len(function.outputs) > 1 else (answer,)
        results = {port.name: value for port, value in zip(function.outputs, found, strict=True)}
        return {**results, "status": status}


_DOUBLES = ctypes.POINTER(ctypes.c_double)


class CompiledC:
    """The generated C, compiled for speed, called through its batch functions."""

    def __init__(self, subject: Subject) -> None:
        self.subject = subject
        self.library = load_library(subject.library)
        self.prefix = f"krhpr_{subject.identifier}_"
        size = getattr(self.library, self.prefix + "geometry_size")
        size.restype = ctypes.c_size_t
        self._size = int(size())

    def _geometry(self, geometry: Geometry | None) -> Any:
        structure = ctypes.create_string_buffer(self._size)
        if geometry is None:
            status = getattr(self.library, self.prefix + "default_geometry")(structure)
        else:
            fields = [
                float(geometry[name][leg])
                for leg in range(self.subject.code.legs)
                for name in self.subject.fields
            ]
            values = (ctypes.c_double * len(fields))(*fields)
            status = getattr(self.library, self.prefix + "set_geometry")(structure, values)
        if status != 0:
            raise ValueError(f"set_geometry returns {status}")
        return structure

    def call(self, name: str, values: Values, geometry: Geometry | None = None) -> dict[str, Floats]:
        """A function's batch form; a mode or assembly mode that is missing is the default."""
        function = self.subject.code.function(name)
        arrays = [
            np.asarray(values[port.name], dtype=float) if port.name in values else None
            for port in function.inputs
        ]
        shapes = [
            array.shape[: array.ndim - len(port.full_shape)]
            for port, array in zip(function.inputs, arrays, strict=True)
            if array is not None
        ]
        batch = np.broadcast_shapes(*shapes)
        count = prod(batch)
        inputs = [
            None
            if array is None
            else np.ascontiguousarray(np.broadcast_to(array, (*batch, *port.full_shape)))
            for port, array in zip(function.inputs, arrays, strict=True)
        ]
        results = {port.name: np.empty((*batch, *port.full_shape)) for port in function.outputs}
        status = np.empty(batch, dtype=np.intc)
        outputs = list(results.values())
        getattr(self.library, self.prefix + name + "_batch")(
            self._geometry(geometry),
            ctypes.c_size_t(count),
            _pointers(inputs),
            _steps([port.full_shape for port in function.inputs]),
            _pointers(outputs),
            _steps([port.full_shape for port in function.outputs]),
            status.ctypes.data_as(ctypes.POINTER(ctypes.c_int)),
            ctypes.c_ssize_t(1),
        )
        return {**results, "status": status}


def _pointers(arrays: Sequence[Floats | None]) -> Any:
    pointers = [_DOUBLES() if array is None else array.ctypes.data_as(_DOUBLES) for array in arrays]
    return (_DOUBLES * len(pointers))(*pointers)


def _steps(shapes: Sequence[tuple[int, ...]]) -> Any:
    return (ctypes.c_ssize_t * len(shapes))(*(prod(shape) for shape in shapes))


class Casadi:
    """The generated CasADi functions, evaluated one configuration at a time."""

    def __init__(self, subject: Subject) -> None:
        self.subject = subject

    def call(self, name: str, values: Values, geometry: Geometry | None = None) -> dict[str, Floats]:
        """A function on a batch, without a status."""
        function = self.subject.code.function(name)
        built = casadi_function(self.subject, function)
        sizes = self.subject.entry.sizes if geometry is None else geometry
        fields = [
            float(sizes[field][leg]) for leg in range(self.subject.code.legs) for field in self.subject.fields
        ]
        arrays = [np.asarray(values[port.name], dtype=float) for port in function.inputs]
        rows = [
            self._one(function, built, [array[k] for array in arrays], fields) for k in range(len(arrays[0]))
        ]
        return {
            port.name: np.array([row[port.name] for row in rows]).reshape((len(rows), *port.full_shape))
            for port in function.outputs
        }

    @staticmethod
    def _one(
        function: RobotFunction, built: casadi.Function, arguments: Sequence[Floats], fields: list[float]
    ) -> dict[str, list[float]]:
        given = [casadi.DM(np.atleast_1d(argument)) for argument in arguments]
        found = dict(zip(built.name_out(), built.call([*given, casadi.DM(fields)]), strict=True))
        return {
            port.name: unpack(port, lambda key: np.array(found[key].full()).ravel().tolist())
            for port in function.outputs
        }
