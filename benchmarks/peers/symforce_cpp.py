"""SymForce: C++ functions on ``Eigen::Matrix``, from its SymEngine back end, in an ``extern "C"`` wrapper.

Its generated files are compiled as they are, against a stand-in for ``Eigen::Matrix`` (``eigen_stub``).
Arguments are plain column vectors, so that the caller's row-major arrays are used in place, without a copy.
"""

from __future__ import annotations

import inspect
from pathlib import Path
from typing import Any

import symforce

symforce.set_symbolic_api("symengine")

import symforce.symbolic as sf  # noqa: E402
from symforce import codegen  # noqa: E402
from symforce.codegen.codegen_config import ZeroEpsilonBehavior  # noqa: E402

from benchmarks.contender import Contender  # noqa: E402
from benchmarks.peers.driver import main, stopwatch  # noqa: E402
from benchmarks.workloads import Form, Workload  # noqa: E402


class SymforceOps:
    """SymForce under the names that ``formulas`` uses; poses are regular, so no epsilon is added."""

    sin, cos, sqrt, acos = sf.sin, sf.cos, sf.sqrt, sf.acos

    @staticmethod
    def atan2(y: Any, x: Any) -> Any:
        return sf.atan2(y, x, epsilon=0)


def write(workload: Workload, form: Form, name: str, folder: Path) -> Path:
    """Generates the header ``name.h``."""

    def kernel(*arguments: Any) -> Any:
        outputs = form(SymforceOps, *(list(argument) for argument in arguments))
        return tuple(sf.Matrix(len(values), 1, list(values)) for values in outputs)

    parameters = [inspect.Parameter(a.name, inspect.Parameter.POSITIONAL_OR_KEYWORD) for a in workload.inputs]
    kernel.__signature__ = inspect.Signature(parameters)  # type: ignore[attr-defined]
    config = codegen.CppConfig(zero_epsilon_behavior=ZeroEpsilonBehavior.ALLOW)
    generated = codegen.Codegen.function(
        kernel,
        config=config,
        name=name,
        input_types=[sf.matrix_type_from_shape((a.size, 1)) for a in workload.inputs],
        output_names=[a.name for a in workload.outputs],
    ).generate_function(output_dir=folder, skip_directory_nesting=True, generated_file_name=name)
    return Path(generated.generated_files[0])


def glue(workload: Workload, name: str) -> str:
    """Vectors in place of pointers."""
    camel_case = "".join(part.capitalize() for part in name.split("_"))
    arguments = [
        f"*reinterpret_cast<const Eigen::Matrix<double, {a.size}, 1>*>({a.name})" for a in workload.inputs
    ]
    arguments += [
        f"reinterpret_cast<Eigen::Matrix<double, {a.size}, 1>*>({a.name})" for a in workload.outputs
    ]
    joined = ",\n        ".join(arguments)
    return f"""#include "{name}.h"
extern "C" {workload.prototype()} {{
    sym::{camel_case}<double>(
        {joined});
}}
"""


def generate(workload: Workload, folder: Path) -> list[Contender]:
    """One header for every form."""
    stub = Path(__file__).resolve().parent / "eigen_stub"
    contenders = []
    for form_name, form in workload.forms.items():
        name = f"symforce_{workload.key}_{form_name}"
        with stopwatch() as watch:
            header = write(workload, form, name, folder)
        contenders.append(
            Contender(
                name="SymForce",
                workload=workload.key,
                variant=form_name,
                glue=glue(workload, name),
                glue_language="c++",
                include_dirs=(str(header.parent), str(stub)),
                generate_seconds=watch.seconds,
            )
        )
    return contenders


if __name__ == "__main__":
    main(generate, ("symforce",))
