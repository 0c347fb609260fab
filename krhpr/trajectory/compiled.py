"""Point functions as compiled C: printed by CasADi from their SX graphs, loaded by `casadi.external`.

The same operations, first and second derivatives included, several times faster; the compiler takes some
seconds, once: libraries are kept in the cache of compiled kernels.
"""

from __future__ import annotations

import os
from collections.abc import Mapping
from enum import StrEnum
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from krhpr.native import compile_library

FLAGS = ("-O1", "-march=native", "-fno-math-errno", "-fPIC", "-shared")
"""More optimisation takes the compiler much longer than the functions gain."""


class Evaluation(StrEnum):
    """How functions of the programme are evaluated."""

    SX = "sx"
    """By CasADi's own machine; nothing is compiled."""
    COMPILED = "compiled"
    """As compiled C: for programmes that are solved often."""


def compiled(functions: Mapping[str, Any]) -> dict[str, Any]:
    """CasADi functions by name as compiled C with the same inputs and outputs.

    Raises:
        NoCompiler: there is none on this machine.
    """
    import casadi as ca

    with TemporaryDirectory() as folder:
        source = Path(folder) / "trajectory.c"
        generator = ca.CodeGenerator(source.name, {"verbose": False})
        for function in functions.values():
            generator.add(function)
        generator.generate(str(source.parent) + os.sep)
        library = compile_library("trajectory", [source], flags=FLAGS, tag=ca.CasadiMeta.version())
    return {name: ca.external(function.name(), str(library)) for name, function in functions.items()}
