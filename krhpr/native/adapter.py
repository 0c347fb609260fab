"""NumPy functions of compiled kernels.

Every generated kernel has a batch function of one type:

    int f(const void *geometry, size_t count, const double *const in[], const ptrdiff_t in_step[],
          double *const out[], const ptrdiff_t out_step[], int *status, ptrdiff_t status_step);

Steps are counted in elements, from one member of the batch to the next, and may be zero or negative; each
member's array is contiguous, in row-major order. `make_gufunc` turns such a function into a NumPy generalized
ufunc, `bind` makes a function without arguments of one call, by two small extension modules that are
compiled when first needed.
"""

from __future__ import annotations

import ctypes
import functools
import importlib.machinery
import importlib.util
import os
import sys
import sysconfig
import threading
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING, Any, Protocol, cast

import numpy as np

from krhpr.native.compiler import SHARED, NoCompiler, compile_library

if TYPE_CHECKING:
    from numpy.typing import NDArray
    from typing_extensions import Buffer

    # Before Python 3.12 the type checker does not know that the last two are buffers.
    Bytes = Buffer | ctypes.Structure | NDArray[Any]

EXTENSION_FLAGS = (
    "-std=gnu11",
    "-O2",
    *SHARED,
    *(("-Wl,-undefined,dynamic_lookup",) if sys.platform == "darwin" else ()),
)

_extension_lock = threading.Lock()


class Bound(Protocol):
    """A function on arrays that are bound once; calling it computes its outputs and returns the status."""

    @property
    def inputs(self) -> Any:
        """The arrays that a call reads, by name."""

    @property
    def outputs(self) -> Any:
        """The arrays that a call writes, by name."""

    def __call__(self) -> int:
        """Compute the outputs; the status."""


class _GufuncModule(Protocol):
    """What gufunc.c offers."""

    def make(
        self,
        name: str,
        doc: str,
        function: int,
        geometry: Bytes | None,
        signature: str,
        nin: int,
        nout: int,
        owner: object,
        /,
    ) -> np.ufunc: ...


class _BoundModule(Protocol):
    """What bound.c offers."""

    def Bound(
        self,
        function: int,
        geometry: Bytes | None,
        inputs: tuple[Any, ...],
        outputs: tuple[Any, ...],
        owner: object,
    ) -> Bound: ...


def make_gufunc(
    name: str,
    doc: str,
    function: int,
    geometry: Bytes | None,
    signature: str,
    nin: int,
    nout: int,
    owner: object,
) -> np.ufunc:
    """A NumPy generalized ufunc of the batch kernel at the address `function`.

    `signature` gives the core shapes in numbers, the status last: `(3),(3,3)->(3,2),()` has two inputs and,
    counted without the status, one output. Inputs and outputs are float64, the status is int32 (C's int);
    others are cast as for any ufunc. The function keeps a copy of the bytes of `geometry`, and `owner`, which
    is to keep the kernel's code loaded, for as long as it lives. It may be called from any number of threads.
    No floating-point warning comes of a call: the status says what went wrong.

    At most four core dimensions and 1024 core elements an argument, 4096 in all arguments together and 32
    arguments are supported; others, and a signature that does not fit, raise ValueError.
    """
    module = cast(_GufuncModule, _extension("gufunc"))
    return module.make(name, doc, function, geometry, signature, nin, nout, owner)


def bind(
    function: int,
    geometry: Bytes | None,
    inputs: tuple[Any, ...],
    outputs: tuple[Any, ...],
    owner: object,
) -> Bound:
    """The batch kernel at the address `function` on one element, in arrays bound once: a call computes
    `outputs` from `inputs` as they then are, allocates nothing and returns the status.

    `inputs` and `outputs` are (named) tuples of contiguous float64 arrays, of as many numbers as the kernel
    takes, which is not checked; they cannot be resized as long as this lives. At most 32 are supported.
    The function keeps a copy of the bytes of `geometry`, and `owner`, which is to keep its code loaded.
    Threads that share one must take turns.
    """
    return cast(_BoundModule, _extension("bound")).Bound(function, geometry, inputs, outputs, owner)


def load_library(path: os.PathLike[str] | str) -> ctypes.CDLL:
    """Load a shared library. It stays loaded until the process ends."""
    try:
        return ctypes.CDLL(os.fspath(Path(path).absolute()))
    except OSError as error:
        raise OSError(
            f"{path} cannot be loaded: {error}. Where the folder's file system allows no execution, "
            "set KRHPR_CACHE to a folder elsewhere"
        ) from error


def function_address(library: ctypes.CDLL, name: str) -> int:
    """The address of a function of a library; AttributeError if it has none of that name."""
    address = ctypes.cast(getattr(library, name), ctypes.c_void_p).value
    assert address is not None  # the loader gives no symbol at 0
    return address


def extension_paths() -> tuple[Path, ...]:
    """The compiled extension modules; compiles them if that was not done before for this Python and NumPy."""
    return tuple(_extension_path(name) for name in ("gufunc", "bound"))


def _extension_path(name: str) -> Path:
    headers = Path(sysconfig.get_path("include"))
    if not (headers / "Python.h").is_file():
        raise NoCompiler(
            f"Python's C headers are missing ({headers / 'Python.h'}): "
            "install them (Debian, Ubuntu: apt install python3-dev)"
        )
    return compile_library(
        name,
        [Path(__file__).with_name(f"{name}.c")],
        system_include_dirs=[headers, Path(np.get_include())],
        flags=EXTENSION_FLAGS,
        tag=f"{sys.version} {sysconfig.get_config_var('EXT_SUFFIX')} {np.__version__}",
    )


def _extension(name: str) -> ModuleType:
    with _extension_lock:
        return _load_extension(name)


@functools.cache
def _load_extension(name: str) -> ModuleType:
    loader = importlib.machinery.ExtensionFileLoader(f"krhpr.native._{name}", str(_extension_path(name)))
    spec = importlib.util.spec_from_loader(loader.name, loader)
    assert spec is not None
    module = importlib.util.module_from_spec(spec)
    loader.exec_module(module)
    return module
