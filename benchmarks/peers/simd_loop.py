"""A scalar kernel's body as a vectorised loop over a batch: gcc's ``omp simd``, glibc's vector functions."""

from __future__ import annotations

import re
from collections.abc import Sequence

from benchmarks.workloads import Array, Workload

# gcc reaches libmvec only where it does not replace sin and cos by its own built-in functions.
LIBMVEC_FLAGS = ("-fopenmp-simd", "-fno-builtin-sin", "-fno-builtin-cos")
LIBMVEC_PROTOTYPES = """#include <math.h>
#pragma omp declare simd notinbranch
double sin(double);
#pragma omp declare simd notinbranch
double cos(double);
#pragma omp declare simd notinbranch
double atan2(double, double);
#pragma omp declare simd notinbranch
double acos(double);
"""


def simd_loop(workload: Workload, lines: Sequence[str], layout: str) -> str:
    """``workload.batch_prototype()`` around ``lines``, which read ``p0, p1, ...`` and assign ``J[0], ...``.

    Poses are taken in blocks of eight; the number of poses must be a multiple of eight. Layouts with
    neighbouring lanes are worked on in place; ``aos`` is transposed into local blocks and back, which beats
    gathers.
    """
    arrays = (*workload.inputs, *workload.outputs)
    stride = "n" if layout == "soa" else "8"

    def retarget(line: str) -> str:
        return re.sub(r"^(\w+)\[(\d+)\]", rf"\1_b[\2 * {stride} + lane]", line)

    inner = [
        f"const double {a.name}{k} = {a.name}_b[{k} * {stride} + lane];"
        for a in workload.inputs
        for k in range(a.size)
    ]
    inner += map(retarget, lines)
    after: list[str] = []
    if layout == "aos":
        before = [f"double {a.name}_b[{8 * a.size}] __attribute__((aligned(64)));" for a in arrays]
        before += [_transpose(a, f"{a.name}_b[8 * k + lane] = {a.name}[{_AT}]") for a in workload.inputs]
        after = [_transpose(a, f"{a.name}[{_AT}] = {a.name}_b[8 * k + lane]") for a in workload.outputs]
    else:
        step = {a.name: 8 if layout == "soa" else 8 * a.size for a in arrays}
        before = [
            f"const double *restrict {a.name}_b = {a.name} + {step[a.name]} * block;" for a in workload.inputs
        ]
        before += [
            f"double *restrict {a.name}_b = {a.name} + {step[a.name]} * block;" for a in workload.outputs
        ]
    newline, newline_inside = "\n        ", "\n            "
    return f"""{workload.batch_prototype()} {{
    for (long block = 0; block < n / 8; ++block) {{
        {newline.join(before)}
        #pragma omp simd
        for (int lane = 0; lane < 8; ++lane) {{
            {newline_inside.join(inner)}
        }}
        {newline.join(after)}
    }}
}}
"""


_AT = "(8 * block + lane) * SIZE + k"


def _transpose(array: Array, assignment: str) -> str:
    """A double loop over the lanes and components of a block."""
    loops = f"for (int lane = 0; lane < 8; ++lane) for (int k = 0; k < {array.size}; ++k)"
    return f"{loops} {assignment.replace('SIZE', str(array.size))};"
