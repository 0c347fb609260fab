"""Numbers first: every contender must agree. Then times: all take turns in random order, in many rounds."""

from __future__ import annotations

import ctypes
import random
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from benchmarks.build import Built
from benchmarks.layouts import LAYOUTS, pack, room, unpack
from benchmarks.samples import draw, evaluate
from benchmarks.workloads import Workload

Floats = NDArray[np.float64]
TOLERANCE = 1e-12
POOL = 32
STREAMED = 321 * POOL
"""Poses of a batch that no near cache holds; the pool's, over and over. No multiple of 512: all numbers of a
pose in a structure of arrays would meet in one set of the cache."""
CHUNK_NS = 100_000.0  # processor time of one sample
LOOPS = ("throughput", "latency", "batch")
"""The harness' loops: the modes, but for streaming, which is its batch with more poses."""


@dataclass
class Series:
    """Nanoseconds per pose, one sample for each round."""

    samples: list[float]

    @property
    def median(self) -> float:
        return float(np.median(self.samples))

    @property
    def low(self) -> float:
        """The tenth percentile: what the code takes when nobody disturbs."""
        return float(np.percentile(self.samples, 10))

    @property
    def spread(self) -> float:
        """Interquartile range over the median."""
        low, high = np.percentile(self.samples, (25, 75))
        return float((high - low) / self.median)

    def ratio_to(self, other: Series) -> float:
        """Median over the rounds of this time over the other's in the same round."""
        return float(np.median(np.array(self.samples) / np.array(other.samples)))


@dataclass
class Row:
    """What was found out about one contender."""

    built: Built
    error: float  # largest difference from the reference, relative to the output's scale
    tolerance: float = TOLERANCE
    series: dict[str, Series] = field(default_factory=dict)

    @property
    def correct(self) -> bool:
        return self.error <= self.tolerance


def scaled_error(workload: Workload, found: Sequence[Floats], expected: Sequence[Floats]) -> float:
    """Largest difference in any pose, relative to the output's largest entry in it; infinite for NaN."""
    worst = 0.0
    for got, want in zip(found, expected, strict=True):
        difference = got - want
        if workload.angles:
            difference = np.arctan2(np.sin(difference), np.cos(difference))
        n = len(want)
        scale = np.abs(want).reshape(n, -1).max(axis=1)
        error = float(np.max(np.abs(difference).reshape(n, -1).max(axis=1) / scale))
        worst = max(worst, error if np.isfinite(error) else float("inf"))
    return worst


class Bench:
    """One workload's library, its pool of inputs, and the loops."""

    def __init__(self, workload: Workload, library: Path, pool: int = POOL) -> None:
        self.workload = workload
        self.pool = pool
        self.path = library
        self.library = ctypes.CDLL(str(library))
        for name in LOOPS:
            getattr(self.library, name).restype = ctypes.c_double
        self.inputs = draw(workload, pool)
        self.expected = evaluate(workload, self.inputs)
        self.packed = {layout: [pack(x, layout) for x in self.inputs] for layout in LAYOUTS}
        self.outputs = [room(pool * array.size) for array in workload.outputs]
        many = [np.concatenate([x] * (STREAMED // pool)) for x in self.inputs]
        self.streamed = {layout: [pack(x, layout) for x in many] for layout in LAYOUTS}
        self.streamed_outputs = [room(STREAMED * array.size) for array in workload.outputs]

    def poses(self, mode: str) -> int:
        """How many a call of that mode computes."""
        return {"batch": self.pool, "streaming": STREAMED}.get(mode, 1)

    def _pointers(self, layout: str, mode: str = "") -> list[ctypes.c_void_p]:
        if mode == "streaming":
            arrays = [*self.streamed[layout], *self.streamed_outputs]
        else:
            arrays = [*self.packed[layout], *self.outputs]
        return [ctypes.c_void_p(x.ctypes.data) for x in arrays]

    def _function(self, symbol: str) -> ctypes.c_void_p:
        return ctypes.cast(getattr(self.library, symbol), ctypes.c_void_p)

    def error(self, built: Built) -> float:
        """How far a contender is from the reference, in both of its functions."""
        errors = []
        if built.single_symbol:
            errors.append(self._error_of(built.single_symbol, "aos", batch=False))
        if built.batch_symbol and built.contender.batch_layout:
            errors.append(self._error_of(built.batch_symbol, built.contender.batch_layout, batch=True))
        return max(errors)

    def _error_of(self, symbol: str, layout: str, batch: bool) -> float:
        for output in self.outputs:
            output.fill(np.nan)
        if batch:
            self.sample(symbol, "batch", 1, layout)
        else:
            self.library.evaluate(self._function(symbol), ctypes.c_long(self.pool), *self._pointers(layout))
        found = [
            unpack(flat, self.pool, array.shape, layout)
            for flat, array in zip(self.outputs, self.workload.outputs, strict=True)
        ]
        return scaled_error(self.workload, found, self.expected)

    def sample(self, symbol: str, mode: str, calls: int, layout: str = "aos") -> float:
        """Nanoseconds per pose."""
        loop = getattr(self.library, "batch" if mode == "streaming" else mode)
        pool = STREAMED if mode == "streaming" else self.pool
        counts = ctypes.c_long(calls), ctypes.c_long(pool)
        return float(loop(self._function(symbol), *counts, *self._pointers(layout, mode)))

    def jobs(self, rows: Sequence[Row]) -> list[tuple[Row | None, str, str, str]]:
        """(row, mode, symbol, layout) of all that is timed; no row stands for the empty function."""
        jobs: list[tuple[Row | None, str, str, str]] = [
            (None, "throughput", "nothing", "aos"),
            (None, "latency", "nothing", "aos"),
        ]
        for row in rows:
            if row.built.single_symbol:
                jobs += [(row, mode, row.built.single_symbol, "aos") for mode in ("throughput", "latency")]
            if row.built.batch_symbol and row.built.contender.batch_layout:
                symbol, layout = row.built.batch_symbol, row.built.contender.batch_layout
                jobs += [(row, mode, symbol, layout) for mode in ("batch", "streaming")]
        return jobs

    def run(self, rows: Sequence[Row], rounds: int, seed: int = 1) -> dict[str, Series]:
        """Fills in ``row.series``; returns the series of the empty function, the cost of the loops."""
        jobs = self.jobs(rows)
        calls = []
        for _, mode, symbol, layout in jobs:
            tries = (1, 2) if mode == "streaming" else (8, 64)
            per_call = self.poses(mode) * min(self.sample(symbol, mode, few, layout) for few in tries)
            calls.append(max(1, round(CHUNK_NS / max(per_call, 1.0))))
        samples: list[list[float]] = [[] for _ in jobs]
        order = list(range(len(jobs)))
        shuffle = random.Random(seed).shuffle
        for _ in range(rounds):
            shuffle(order)
            for k in order:
                _, mode, symbol, layout = jobs[k]
                samples[k].append(self.sample(symbol, mode, calls[k], layout))
        overhead: dict[str, Series] = {}
        for (row, mode, _, _), times in zip(jobs, samples, strict=True):
            (overhead if row is None else row.series)[mode] = Series(times)
        return overhead
