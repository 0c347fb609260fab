"""CasADi: an SX function as C, called through CasADi's own C interface with work vectors made ahead."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import casadi as ca

from benchmarks.contender import Contender
from benchmarks.peers.driver import main, stopwatch
from benchmarks.workloads import Form, Workload


class CasadiOps:
    """CasADi under the names that ``formulas`` uses."""

    sin, cos, sqrt, atan2, acos = ca.sin, ca.cos, ca.sqrt, ca.atan2, ca.acos


def function(workload: Workload, form: Form, name: str, cse: bool = False) -> ca.Function:
    """Flat inputs and outputs, so that matrices are row-major for the caller as for everybody else."""
    inputs = [ca.SX.sym(array.name, array.size) for array in workload.inputs]
    scalars: list[list[Any]] = [ca.vertsplit(x) for x in inputs]
    stacked: Any = [ca.vertcat(*output) for output in form(CasadiOps, *scalars)]
    if cse:
        stacked = ca.cse(stacked)
    names = [array.name for array in workload.inputs], [array.name for array in workload.outputs]
    return ca.Function(name, inputs, stacked, *names)


def glue(workload: Workload, f: ca.Function) -> str:
    """The workload's prototype around CasADi's calling convention."""
    arguments = ", ".join(array.name for array in workload.inputs)
    results = ", ".join(array.name for array in workload.outputs)
    name = f.name()
    return f"""int {name}(const double **arg, double **res, long long *iw, double *w, int mem);
static long long iw[{f.sz_iw() + 1}];
static double w[{f.sz_w() + 1}];
{workload.prototype()} {{
    const double *arg[{f.sz_arg()}] = {{{arguments}}};
    double *res[{f.sz_res()}] = {{{results}}};
    {name}(arg, res, iw, w, 0);
}}
"""


def generate(workload: Workload, folder: Path) -> list[Contender]:
    """One C file for every form, with and without ``casadi.cse``."""
    contenders = []
    for form_name, form in workload.forms.items():
        for cse in (False, True):
            name = f"casadi_{workload.key}_{form_name}{'_cse' if cse else ''}"
            with stopwatch() as watch:
                f = function(workload, form, name, cse)
                generator = ca.CodeGenerator(f"{name}.c")
                generator.add(f)
                source = generator.generate(f"{folder}/")
            contenders.append(
                Contender(
                    name="CasADi",
                    workload=workload.key,
                    variant=f"{form_name}{', cse' if cse else ''}",
                    glue=glue(workload, f),
                    sources=(source,),
                    generate_seconds=watch.seconds,
                )
            )
    return contenders


if __name__ == "__main__":
    main(generate, ("casadi",))
