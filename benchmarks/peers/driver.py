"""The command line of all peer modules: ``python -m benchmarks.peers.<module> FOLDER WORKLOAD...``."""

from __future__ import annotations

import importlib.metadata
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

from benchmarks.contender import Contender, Manifest
from benchmarks.workloads import WORKLOADS, Workload

Generate = Callable[[Workload, Path], list[Contender]]


class Stopwatch:
    """Seconds spent in the ``with`` block of ``stopwatch()``."""

    seconds = 0.0


@contextmanager
def stopwatch() -> Iterator[Stopwatch]:
    """Measures how long a generator takes."""
    watch, start = Stopwatch(), time.perf_counter()
    yield watch
    watch.seconds = time.perf_counter() - start


def flat_names(workload: Workload) -> list[list[str]]:
    """One scalar name for every component of every input: p0, p1, p2, Q0, ..."""
    return [[f"{array.name}{k}" for k in range(array.size)] for array in workload.inputs]


def main(generate: Generate, packages: Sequence[str]) -> None:
    """Writes all contenders of a peer and its ``manifest.json`` into the folder of the command line."""
    folder = Path(sys.argv[1]).resolve()
    contenders = [c for key in sys.argv[2:] for c in generate(WORKLOADS[key], folder)]
    versions = {package: importlib.metadata.version(package) for package in packages}
    Manifest(contenders, versions).write(folder / "manifest.json")
