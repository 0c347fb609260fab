from __future__ import annotations

import ctypes
import gc
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


@pytest.fixture(scope="session")
def cache_folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("cache")


@pytest.fixture(scope="module", autouse=True)
def cache(cache_folder: Path) -> Iterator[Path]:
    """A cache of the tests' own, for as long as they run: others find robots compiled where they were."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("KRHPR_CACHE", str(cache_folder))
        yield cache_folder


@pytest.fixture
def collected() -> Iterator[None]:
    """What other tests of this process have made is not looked at where a test collects what is left."""
    gc.freeze()
    yield
    gc.unfreeze()


@pytest.fixture(scope="module")
def compiler(cache: Path) -> Compiler:
    try:
        return find_compiler()
    except NoCompiler as error:
        pytest.skip(f"needs a C compiler: {error}")


@pytest.fixture(scope="module")
def library(compiler: Compiler) -> ctypes.CDLL:
    return load_library(compile_library("kernels", [SOURCE], compiler=compiler))


@pytest.fixture(scope="module")
def make(library: ctypes.CDLL) -> Callable[[str], np.ufunc]:
    """Makes the gufunc of a kernel of kernels.c."""

    def make(name: str) -> np.ufunc:
        signature, nin, nout = KERNELS[name]
        geometry = GEOMETRY if name == "matvec" else None
        address = function_address(library, name)
        return make_gufunc(name, f"kernel {name}", address, geometry, signature, nin, nout, library)

    return make


@pytest.fixture(scope="module")
def matvec(make: Callable[[str], np.ufunc]) -> np.ufunc:
    return make("matvec")
