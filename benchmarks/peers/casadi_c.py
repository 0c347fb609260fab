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

    @staticmethod
    def solve(rows: list[list[Any]], values: list[Any]) -> list[Any]:
        """CasADi's symbolic solution of linear equations, for the sparsity that the matrix has."""
        matrix = ca.sparsify(ca.vertcat(*(ca.horzcat(*row) for row in rows)))
        return ca.vertsplit(ca.densify(ca.solve(matrix, ca.vertcat(*values))))


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


class RuntimeOps(CasadiOps):
    """The same with linear equations solved by CasADi's QR when the code runs."""

    @staticmethod
    def solve(rows: list[list[Any]], values: list[Any]) -> list[Any]:
        """An expression that calls the factorisation."""
        matrix = ca.vertcat(*(ca.horzcat(*row) for row in rows))
        return ca.vertsplit(ca.solve(matrix, ca.vertcat(*values), "qr"))


def with_factorisation(workload: Workload, form: Form, name: str) -> ca.Function:
    """The function as a graph of matrices, which may call a linear solver."""
    inputs = [ca.MX.sym(array.name, array.size) for array in workload.inputs]
    scalars: list[list[Any]] = [ca.vertsplit(x) for x in inputs]
    outputs: Any = [ca.vertcat(*output) for output in form(RuntimeOps, *scalars)]
    return ca.Function(name, inputs, outputs)


def _solved_when_run(workload: Workload, folder: Path) -> list[Contender]:
    """Linear equations as users of CasADi write them for anything that is not small."""
    contenders = []
    for form_name, form in workload.forms.items():
        name = f"casadi_{workload.key}_{form_name}_qr"
        with stopwatch() as watch:
            f = with_factorisation(workload, form, name)
            generator = ca.CodeGenerator(f"{name}.c")
            generator.add(f)
            source = generator.generate(f"{folder}/")
        contenders.append(
            Contender(
                name="CasADi",
                workload=workload.key,
                variant=f"{form_name}, qr",
                glue=glue(workload, f),
                sources=(source,),
                generate_seconds=watch.seconds,
            )
        )
    return contenders


def generate(workload: Workload, folder: Path) -> list[Contender]:
    """One C file for every form, with and without ``casadi.cse``."""
    contenders = _solved_when_run(workload, folder) if workload.key == "w4" else []
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
