from __future__ import annotations

import ctypes
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pytest

from krhpr.native import (
    Compiler,
    NoCompiler,
    compile_library,
    find_compiler,
    function_address,
    load_library,
    make_gufunc,
)
from tests.native.support import GEOMETRY, KERNELS, SOURCE


@pytest.fixture(scope="session", autouse=True)
def cache(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Path]:
    """A cache of the tests' own."""
    folder = tmp_path_factory.mktemp("cache")
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("KRHPR_CACHE", str(folder))
        yield folder


@pytest.fixture(scope="session")
def compiler(cache: Path) -> Compiler:
    try:
        return find_compiler()
    except NoCompiler as error:
        pytest.skip(f"needs a C compiler: {error}")


@pytest.fixture(scope="session")
def library(compiler: Compiler) -> ctypes.CDLL:
    return load_library(compile_library("kernels", [SOURCE], compiler=compiler))


@pytest.fixture(scope="session")
def make(library: ctypes.CDLL) -> Callable[[str], np.ufunc]:
    """Makes the gufunc of a kernel of kernels.c."""

    def make(name: str) -> np.ufunc:
        signature, nin, nout = KERNELS[name]
        geometry = GEOMETRY if name == "matvec" else None
        address = function_address(library, name)
        return make_gufunc(name, f"kernel {name}", address, geometry, signature, nin, nout, library)

    return make


@pytest.fixture(scope="session")
def matvec(make: Callable[[str], np.ufunc]) -> np.ufunc:
    return make("matvec")
