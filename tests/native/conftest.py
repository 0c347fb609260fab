from __future__ import annotations

import ctypes
import os
import struct
import subprocess
import sys
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

HERE = Path(__file__).parent

SCALE, OFFSET = 1.5, (1.0, -2.0, 0.25)
GEOMETRY = struct.pack("4d", SCALE, *OFFSET)

# name: signature, inputs, outputs without the status
KERNELS = {
    "matvec": ("(3),(3,3)->(3),()", 2, 1),
    "root": ("()->(),()", 1, 1),
    "split": ("(2,3)->(3,2),(),()", 1, 2),
    "calls": ("(2)->(3),()", 1, 1),
    "meet": ("(1)->(1),()", 1, 1),
}


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
    return load_library(compile_library("kernels", [HERE / "kernels.c"], compiler=compiler))


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


def run_python(code: str, **environment: str) -> subprocess.CompletedProcess[str]:
    """Run code in a Python of its own that finds the same packages."""
    return subprocess.run(
        [sys.executable, "-c", code],
        env={**os.environ, "PYTHONPATH": os.pathsep.join(filter(None, sys.path)), **environment},
        capture_output=True,
        text=True,
        check=False,
    )


@pytest.fixture(name="run_python", scope="session")
def run_python_fixture() -> Callable[..., subprocess.CompletedProcess[str]]:
    return run_python
