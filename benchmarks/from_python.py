"""Calls from Python, in batches of 10^4 poses and singly: in turns, in one process, by the thread's clock."""

from __future__ import annotations

import random
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from benchmarks.build import Tools
from benchmarks.contender import Missing
from benchmarks.measure import TOLERANCE, Series, scaled_error
from benchmarks.ours import python_contenders
from benchmarks.python_contender import Prepared, PythonContender
from benchmarks.samples import draw, evaluate
from benchmarks.workloads import Workload

BATCH = 10_000
KEYS = ("w1", "w2", "w3")
CHUNK_NS = 400_000


@dataclass
class PythonRow:
    """What was found out about one way to call; modes are ``batch`` (per pose) and ``single``."""

    contender: PythonContender
    error: float = 0.0
    tolerance: float = TOLERANCE
    series: dict[str, Series] = field(default_factory=dict)

    @property
    def correct(self) -> bool:
        return self.error <= self.tolerance


@dataclass
class PythonResult:
    """All rows of one workload, who is missing, and the cost of an empty call in the loop."""

    workload: Workload
    rows: list[PythonRow]
    missing: list[Missing]
    empty_call_ns: float


def sample(call: Callable[[], Any], calls: int) -> float:
    """Nanoseconds per call, after one that brings back what others took from the caches."""
    call()
    start = time.thread_time_ns()
    for _ in range(calls):
        call()
    return (time.thread_time_ns() - start) / calls


def collect_contenders(
    workload: Workload, folder: Path, tools: Tools
) -> tuple[list[PythonContender], list[Missing]]:
    """Ours, and the peers whose packages are installed."""
    contenders: list[PythonContender] = []
    missing: list[Missing] = []
    ours = python_contenders(workload)
    if isinstance(ours, Missing):
        missing.append(ours)
    else:
        contenders += ours
    try:
        from benchmarks import python_peers
    except ImportError as failure:
        return contenders, [*missing, Missing("CasADi, SymPy and NumPy from Python", str(failure))]
    contenders += python_peers.contenders(workload, folder, tools)
    return contenders, missing


def prepare(
    workload: Workload, contenders: Sequence[PythonContender], n: int
) -> tuple[list[PythonRow], list[tuple[PythonRow, str, Prepared, int]]]:
    """Rows with their errors, and what is to be timed: (row, mode, prepared call, poses per call)."""
    inputs = draw(workload, n)
    expected = evaluate(workload, inputs)
    first = [x[0] for x in inputs]
    rows, jobs = [], []
    for contender in contenders:
        row = PythonRow(contender, tolerance=workload.tolerance)
        rows.append(row)
        for mode, make, arguments, poses in (
            ("batch", contender.batch, inputs, n),
            ("single", contender.single, first, 1),
        ):
            if make is None:
                continue
            prepared = make([x.copy() for x in arguments])
            found = prepared.collect(prepared.call())
            row.error = max(row.error, scaled_error(workload, found, [x[:poses] for x in expected]))
            jobs.append((row, mode, prepared, poses))
    return rows, [job for job in jobs if job[0].correct]


def measure(workload: Workload, folder: Path, tools: Tools, rounds: int, n: int = BATCH) -> PythonResult:
    """Checks and times everything for one workload."""
    contenders, missing = collect_contenders(workload, folder, tools)
    rows, jobs = prepare(workload, contenders, n)
    calls = [
        max(1, round(CHUNK_NS / max(min(sample(job[2].call, 2) for _ in range(3)), 1.0))) for job in jobs
    ]
    samples: list[list[float]] = [[] for _ in jobs]
    empty: list[float] = []
    order = list(range(len(jobs)))
    shuffle = random.Random(1).shuffle
    for _ in range(rounds):
        shuffle(order)
        empty.append(sample(lambda: None, 2_000))
        for k in order:
            samples[k].append(sample(jobs[k][2].call, calls[k]) / jobs[k][3])
    for (row, mode, _, _), times in zip(jobs, samples, strict=True):
        row.series[mode] = Series(times)
    return PythonResult(workload, rows, missing, Series(empty).median)
