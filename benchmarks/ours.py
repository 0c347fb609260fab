"""This project's own contenders: the one place where generated kernels are plugged into the benchmark.

``c_contenders`` returns what takes part for one workload, as ``Contender`` objects with the name ``OURS``,
one for each variant (scalar, three legs in lanes, ...), or ``Missing`` with the reason. A contender's glue
defines the workload's prototype and calls the library in the way that its users do, with the geometry of
``robot.py``::

    #include "krhpr_spatial_rrr_a.h"
    static const krhpr_spatial_rrr_a_geometry geometry = {...};
    void contender_w1(const double *p, const double *Q, const double *theta, double *J, double *K) { ... }

Its sources are compiled with the flags of everybody else (``build.SPEED_FLAGS``); flags beyond them go to
``extra_flags`` and are shown. With ``batch_layout`` set, the glue also defines ``contender_w1_batch`` (see
``Workload.batch_prototype``). ``python_contenders`` does the same for calls from Python.
"""

from __future__ import annotations

from pathlib import Path

from benchmarks.contender import OURS, Contender, Missing
from benchmarks.python_contender import PythonContender
from benchmarks.workloads import Workload

NOT_YET = Missing(OURS, "not plugged in yet (benchmarks/ours.py)")


def c_contenders(workload: Workload, folder: Path) -> list[Contender] | Missing:
    """Generated C for a workload; files that have to be generated go to ``folder``."""
    return NOT_YET


def python_contenders(workload: Workload) -> list[PythonContender] | Missing:
    """The same kernels called from Python: gufunc with ``out=``, fresh outputs, and the pure NumPy module."""
    return NOT_YET
