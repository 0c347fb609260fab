"""Two ways to run a robot's functions: compiled kernels as generalized ufuncs, or the generated NumPy
module.
"""

from __future__ import annotations

import ctypes
import functools
import os
import sys
import warnings
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from enum import StrEnum
from functools import cache, partial
from importlib.resources import files
from pathlib import Path
from types import ModuleType
from typing import Any, Protocol

import numpy as np

from krhpr.native import (
    SPEED_FLAGS,
    Bound,
    CompilationError,
    NoCompiler,
    bind,
    compile_library,
    extension_paths,
    function_address,
    load_library,
    make_gufunc,
)

SLOWER = "the same results, but a single call takes about ten times longer, and large batches several times"
"""What there is to say where there are no compiled kernels."""


class BackendName(StrEnum):
    """How functions are computed."""

    AUTO = "auto"
    COMPILED = "compiled"
    NUMPY = "numpy"


class Backend(Protocol):
    """Computes a function by name."""

    name: BackendName

    def call(self, function: str, inputs: Sequence[Any], out: tuple[Any, ...] | None) -> tuple[Any, ...]:
        """Outputs in order, then the status."""

    def bind(self, function: str, inputs: tuple[Any, ...], outputs: tuple[Any, ...]) -> Bound:
        """A function of one pose on (named) tuples of arrays of float64."""


@dataclass
class _BoundNumpy:
    """A function of the NumPy module on arrays that are bound once."""

    inputs: Any
    outputs: Any
    compute: Callable[[Any, tuple[Any, ...]], tuple[Any, ...]]

    def __call__(self) -> int:
        return int(self.compute(self.inputs, self.outputs)[-1])


class NumpyBackend:
    """The generated NumPy module; needs no compiler."""

    name = BackendName.NUMPY

    def __init__(self, module: ModuleType, geometry: Any) -> None:
        self._module, self._geometry = module, geometry

    def call(self, function: str, inputs: Sequence[Any], out: tuple[Any, ...] | None) -> tuple[Any, ...]:
        """Outputs in order, then the status."""
        answer, status = getattr(self._module, function)(*inputs, geometry=self._geometry, status=True)
        single = len(self._module.SIGNATURES[function].outputs) == 1
        results = (answer,) if single else tuple(answer)
        if out is not None:
            for target, result in zip(out, results, strict=True):
                if target is not None:
                    np.copyto(target, result)
            results = tuple(
                result if target is None else target for target, result in zip(out, results, strict=True)
            )
        return (*results, status)

    def bind(self, function: str, inputs: tuple[Any, ...], outputs: tuple[Any, ...]) -> Bound:
        """A function of one pose on (named) tuples of arrays."""
        return _BoundNumpy(inputs, outputs, partial(self.call, function))


class CompiledBackend:
    """Generated C behind generalized ufuncs, one for each function, made on first use."""

    name = BackendName.COMPILED

    def __init__(self, module: ModuleType, geometry: Any) -> None:
        self._module = module
        _extension()  # where it cannot be had, better now than in the first call
        self._library = _library(module.IDENTIFIER)
        self._prefix = f"krhpr_{module.IDENTIFIER}"
        self._geometry = self._prepare(geometry)
        self._gufuncs: dict[str, np.ufunc] = {}

    def gufunc(self, function: str) -> np.ufunc:
        """The generalized ufunc of a function: its inputs, its outputs and, last, the status."""
        found = self._gufuncs.get(function)
        if found is None:
            signature = self._module.SIGNATURES[function]
            found = make_gufunc(
                function,
                signature.doc,
                function_address(self._library, f"{self._prefix}_{function}_batch"),
                self._geometry,
                signature.gufunc,
                len(signature.inputs),
                len(signature.outputs),
                self._library,
            )
            self._gufuncs[function] = found
        return found

    def call(self, function: str, inputs: Sequence[Any], out: tuple[Any, ...] | None) -> tuple[Any, ...]:
        """Outputs in order, then the status."""
        gufunc = self.gufunc(function)
        outputs: Any = gufunc(*inputs) if out is None else gufunc(*inputs, out=(*out, None))
        return tuple(outputs)

    def bind(self, function: str, inputs: tuple[Any, ...], outputs: tuple[Any, ...]) -> Bound:
        """A function of one pose on (named) tuples of arrays."""
        address = function_address(self._library, f"{self._prefix}_{function}_batch")
        return bind(address, self._geometry, inputs, outputs, self._library)

    def _prepare(self, geometry: Any) -> bytes:
        size = getattr(self._library, f"{self._prefix}_geometry_size")
        size.restype = ctypes.c_size_t
        buffer = ctypes.create_string_buffer(size())
        fields = np.ascontiguousarray(geometry.flat(), dtype=float)
        status = getattr(self._library, f"{self._prefix}_set_geometry")(
            buffer, fields.ctypes.data_as(ctypes.POINTER(ctypes.c_double))
        )
        if status:
            raise ValueError(f"geometry is not valid: {geometry!r}")
        return bytes(buffer)


def backend_name(wanted: str | None = None) -> BackendName:
    """The backend wanted, else the one that KRHPR_BACKEND names, else auto."""
    name = wanted or os.environ.get("KRHPR_BACKEND") or BackendName.AUTO
    if name not in set(BackendName):
        source = "" if wanted else " (KRHPR_BACKEND)"
        raise ValueError(f"no backend is called {name!r}{source}; there are {', '.join(BackendName)}")
    return BackendName(name)


def make_backend(module: ModuleType, geometry: Any, wanted: str | None = None) -> Backend:
    """The backend asked for; `auto` compiles where it can and falls back to NumPy with one warning."""
    name = backend_name(wanted)
    if name is BackendName.NUMPY:
        return NumpyBackend(module, geometry)
    try:
        return CompiledBackend(module, geometry)
    except NoCompiler as error:
        if name is BackendName.COMPILED:
            raise
        _warn_slow(str(error))
        return NumpyBackend(module, geometry)


def c_sources() -> Path:
    """The folder with the generated C."""
    return Path(str(files("krhpr.generated"))) / "c"


def compile_robot(identifier: str, folder: Path | None = None) -> Path:
    """The compiled library of a robot, of its sources in a folder (the generated ones unless given); compiles
    it unless that was done before.
    """
    folder = folder or c_sources()
    sources = [folder / f"krhpr_{identifier}{kind}.c" for kind in ("", "_batch")]
    flags = (*SPEED_FLAGS, "-DKRHPR_WITHOUT_SOA")  # nothing here calls them
    return compile_library(f"krhpr_{identifier}", sources, include_dirs=[folder], flags=flags)


def compile_extension() -> tuple[Path, ...]:
    """The compiled extensions that make Python functions of libraries; compiles them unless that was done
    before.
    """
    return extension_paths()


@cache
def _library(identifier: str) -> ctypes.CDLL:
    return load_library(compile_robot(identifier))


@cache
def _extension() -> tuple[Path, ...]:
    return compile_extension()


@cache
def _warn_slow(reason: str) -> None:
    warnings.warn(
        f"{reason}. The pure NumPy modules are used: {SLOWER}. KRHPR_BACKEND=numpy chooses them without a "
        "warning",
        RuntimeWarning,
        stacklevel=_level_outside(),
    )


def _level_outside() -> int:
    """The stack level, for a warning, of the first caller that is not in this package."""
    inside = (os.path.dirname(__file__) + os.sep, functools.__file__)
    level, frame = 0, sys._getframe(1)
    while frame.f_back is not None and frame.f_code.co_filename.startswith(inside):
        level, frame = level + 1, frame.f_back
    return level + 1


__all__ = [
    "Backend",
    "BackendName",
    "CompilationError",
    "CompiledBackend",
    "NoCompiler",
    "NumpyBackend",
    "backend_name",
    "compile_extension",
    "compile_robot",
    "make_backend",
]
