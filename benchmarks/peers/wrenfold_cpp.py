"""wrenfold: C++ functions on spans, instantiated for the caller's arrays in an ``extern "C"`` wrapper."""

from __future__ import annotations

import sysconfig
from pathlib import Path
from typing import Any

import wrenfold as wf
from wrenfold import sym, type_info

from benchmarks.contender import Contender
from benchmarks.peers.driver import main, stopwatch
from benchmarks.workloads import Form, Workload

FACTORIZATION_PASSES = {"default": None, "unfactorized": 0}


class WrenfoldOps:
    """wrenfold under the names that ``formulas`` uses."""

    sin, cos, sqrt, atan2, acos = sym.sin, sym.cos, sym.sqrt, sym.atan2, sym.acos


def code(workload: Workload, form: Form, name: str, factorization_passes: int | None) -> str:
    """The text of the generated function template."""
    description = wf.FunctionDescription(name)
    arguments = []
    for array in workload.inputs:
        vector: Any = description.add_input_argument(array.name, type_info.MatrixType(array.size, 1))
        arguments.append([vector[k, 0] for k in range(array.size)])
    for array, values in zip(workload.outputs, form(WrenfoldOps, *arguments), strict=True):
        description.add_output_argument(array.name, False, sym.matrix([[value] for value in values]))
    parameters = wf.OptimizationParams()
    if factorization_passes is not None:
        parameters.factorization_passes = factorization_passes
    tree = wf.transpile(description, optimization_params=parameters)
    return str(wf.CppGenerator(wf.CppMatrixTypeBehavior.GenericSpan).generate(tree))


def glue(workload: Workload, name: str) -> str:
    """Spans of constant size around the caller's pointers."""
    arrays = [*workload.inputs, *workload.outputs]
    spans = [
        f"auto {a.name}_span = wf::make_span({a.name}, wf::make_constant_value_pack<{a.size}, 1>(), "
        f"wf::make_constant_value_pack<1, {a.size}>());"
        for a in arrays
    ]
    call = f"{name}<double>({', '.join(a.name + '_span' for a in arrays)});"
    body = "\n    ".join([*spans, call])
    return f'#include "{name}.h"\nextern "C" {workload.prototype()} {{\n    {body}\n}}\n'


def span_header() -> Path:
    """The folder with ``wrenfold/span.h``, which the package installs beside Python's own headers."""
    base = Path(sysconfig.get_path("data")) / "include"
    found = sorted(base.glob("**/wrenfold/span.h"))
    if not found:
        raise FileNotFoundError("wrenfold/span.h is not installed")
    return found[0].parent.parent


def generate(workload: Workload, folder: Path) -> list[Contender]:
    """One header for every form, with default settings and without factorisation."""
    include = str(span_header())
    contenders = []
    for form_name, form in workload.forms.items():
        for option_name, passes in FACTORIZATION_PASSES.items():
            name = f"wrenfold_{workload.key}_{form_name}_{option_name}"
            with stopwatch() as watch:
                text = code(workload, form, name, passes)
            header = "#pragma once\n#include <cmath>\n#include <wrenfold/span.h>\n" + text
            (folder / f"{name}.h").write_text(header)
            contenders.append(
                Contender(
                    name="wrenfold",
                    workload=workload.key,
                    variant=f"{form_name}, {option_name}",
                    glue=glue(workload, name),
                    glue_language="c++",
                    include_dirs=(str(folder), include),
                    generate_seconds=watch.seconds,
                )
            )
    return contenders


if __name__ == "__main__":
    main(generate, ("wrenfold",))
