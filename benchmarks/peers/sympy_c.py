"""SymPy: ``cse`` over all outputs, then ``ccode``; also as the body of an ``omp simd`` loop over libmvec.

Written as a careful user would: integer powers are expanded into products, inputs are read once, constants
carry 17 digits, and both settings of ``cse`` are measured.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import sympy as sp
from sympy.codegen.rewriting import create_expand_pow_optimization, optimize
from sympy.printing.c import C99CodePrinter

from benchmarks.contender import Contender
from benchmarks.layouts import LAYOUTS
from benchmarks.peers.driver import flat_names, main, stopwatch
from benchmarks.peers.simd_loop import LIBMVEC_FLAGS, LIBMVEC_PROTOTYPES, simd_loop
from benchmarks.workloads import Form, Workload

CSE_OPTIONS: dict[str, dict[str, Any]] = {"cse": {}, "cse basic": {"optimizations": "basic"}}


class SympyOps:
    """SymPy under the names that ``formulas`` uses."""

    sin, cos, sqrt, atan2, acos = sp.sin, sp.cos, sp.sqrt, sp.atan2, sp.acos


def body(workload: Workload, form: Form, cse_options: dict[str, Any]) -> list[str]:
    """C statements from scalars ``p0, p1, ...`` to assignments ``J[0] = ...``."""
    symbols = [[sp.Symbol(name, real=True) for name in names] for names in flat_names(workload)]
    outputs = form(SympyOps, *symbols)
    flat = [sp.sympify(value) for output in outputs for value in output]
    replacements, reduced = sp.cse(flat, symbols=sp.numbered_symbols("t_"), **cse_options)
    printer = C99CodePrinter({"contract": False})
    expand_powers = [create_expand_pow_optimization(4)]

    def code(expression: sp.Expr) -> str:
        return str(printer.doprint(optimize(expression, expand_powers)))

    lines = [f"const double {symbol} = {code(expression)};" for symbol, expression in replacements]
    targets = [f"{array.name}[{k}]" for array in workload.outputs for k in range(array.size)]
    return lines + [f"{target} = {code(value)};" for target, value in zip(targets, reduced, strict=True)]


def loads(workload: Workload) -> list[str]:
    """``const double p0 = p[0];`` for every input."""
    return [f"const double {a.name}{k} = {a.name}[{k}];" for a in workload.inputs for k in range(a.size)]


def generate(workload: Workload, folder: Path) -> list[Contender]:
    """A scalar function for every form and setting of ``cse``; a batch loop for every form and layout."""
    contenders = []
    for form_name, form in workload.forms.items():
        for option_name, options in CSE_OPTIONS.items():
            with stopwatch() as watch:
                lines = body(workload, form, options)
            function = "\n    ".join([workload.prototype(restrict=True) + " {", *loads(workload), *lines])
            contenders.append(
                Contender(
                    name="SymPy",
                    workload=workload.key,
                    variant=f"{form_name}, {option_name}",
                    glue=f"#include <math.h>\n{function}\n}}\n",
                    generate_seconds=watch.seconds,
                )
            )
            if option_name != "cse":
                continue
            for layout in LAYOUTS:
                contenders.append(
                    Contender(
                        name="SymPy + libmvec",
                        workload=workload.key,
                        variant=f"{form_name}, omp simd",
                        glue=LIBMVEC_PROTOTYPES + simd_loop(workload, lines, layout),
                        extra_flags=LIBMVEC_FLAGS,
                        libraries=("-lmvec",),
                        single=False,
                        batch_layout=layout,
                        generate_seconds=watch.seconds,
                    )
                )
    return contenders


if __name__ == "__main__":
    main(generate, ("sympy",))
