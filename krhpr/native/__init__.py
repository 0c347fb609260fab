"""Compiled kernels as NumPy functions: compile C sources once, load them, wrap them as generalized ufuncs.

library = load_library(compile_library("kernels", [Path("kernels.c")]))
address = function_address(library, "f_batch")
    f = make_gufunc("f", "what f is", address, geometry, "(3),(3,3)->(3),()", 2, 1, library)
y, status = f(x, A)
"""

from krhpr.native.adapter import (
    Bound,
    bind,
    extension_paths,
    function_address,
    load_library,
    make_gufunc,
)
from krhpr.native.cache import cache_folder
from krhpr.native.compiler import (
    SPEED_FLAGS,
    CompilationError,
    Compiler,
    NoCompiler,
    compile_library,
    find_compiler,
)

__all__ = [
    "SPEED_FLAGS",
    "Bound",
    "CompilationError",
    "Compiler",
    "NoCompiler",
    "bind",
    "cache_folder",
    "compile_library",
    "extension_paths",
    "find_compiler",
    "function_address",
    "load_library",
    "make_gufunc",
]
