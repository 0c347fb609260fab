"""How the time of a batch grows with the number of poses and of threads, from Python, by the wall clock.

W2 of `robot.inverse(..., out=..., threads=...)`: 120 bytes go in for each pose and 72 come out.
"""

from __future__ import annotations

import os
import time
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

import krhpr
from benchmarks.measure import Series
from benchmarks.ours import MODE, ROBOT
from benchmarks.samples import draw
from benchmarks.workloads import WORKLOADS

POSES = tuple(10**k for k in range(1, 8))
REPEAT_NS = 3e6  # one sample takes at least this
DIFFERENT = 10_000  # poses that differ; longer batches repeat them


@dataclass(frozen=True)
class Point:
    """One place of the line."""

    poses: int
    threads: int
    nanoseconds: float  # per pose, median
    undisturbed: float  # tenth percentile

    def as_json(self) -> dict[str, Any]:
        """For results.json."""
        return asdict(self)


def thread_counts() -> tuple[int, ...]:
    """1, 2, 4, ... up to the cores of the machine."""
    cores = os.cpu_count() or 1
    return tuple(2**k for k in range(cores.bit_length()) if 2**k <= cores)


def measure(rounds: int, counts: Sequence[int] = POSES) -> list[Point]:
    """Every number of poses with every number of threads."""
    workload = WORKLOADS["w2"]
    robot = krhpr.load(ROBOT["w2"], backend="compiled")
    different = draw(workload, DIFFERENT)
    points = []
    for poses in counts:
        shapes = [array.shape for array in workload.inputs]
        inputs = [
            np.resize(x.reshape(DIFFERENT, -1), (poses, x.size // DIFFERENT)).reshape(poses, *shape)
            for x, shape in zip(different, shapes, strict=True)
        ]
        out = np.empty((poses, *workload.outputs[0].shape))
        for threads in thread_counts():
            found = _samples(
                robot, inputs, out, threads, rounds if poses < POSES[-1] else max(3, rounds // 10)
            )
            series = Series([ns / poses for ns in found])
            points.append(Point(poses, threads, series.median, series.low))
    return points


def _samples(robot: krhpr.Robot, inputs: list[Any], out: Any, threads: int, rounds: int) -> list[float]:
    def once(calls: int) -> float:
        start = time.perf_counter_ns()
        for _ in range(calls):
            robot.inverse(*inputs, mode=MODE, out=out, threads=threads)
        return (time.perf_counter_ns() - start) / calls

    calls = max(1, round(REPEAT_NS / min(once(1), once(1))))
    return [once(calls) for _ in range(rounds)]
