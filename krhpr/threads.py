"""Large batches in several threads: slices of one call, side by side.

Compiled kernels run without the interpreter's lock, so that threads share the work.  Each writes to its own
part of the results; nothing is copied.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from itertools import pairwise
from math import prod
from typing import Any

import numpy as np

from krhpr.generated.python.runtime import Port, Signature

SMALLEST = 8192
"""Poses that a thread is worth starting for: it takes a third of a millisecond, a pose some 50 ns."""

Call = Callable[[Sequence[Any], tuple[Any, ...] | None], tuple[Any, ...]]
"""Computes outputs and status from inputs, into arrays if given."""


def in_threads(
    call: Call, signature: Signature, inputs: Sequence[Any], out: tuple[Any, ...] | None, threads: int
) -> tuple[Any, ...]:
    """What `call(inputs, out)` gives, computed by up to so many threads along the longest batch dimension."""
    if threads < 1:
        raise ValueError(f"threads is {threads}; expected 1 or more")
    if threads == 1:
        return call(inputs, out)
    places = out if out is not None else (None,) * len(signature.outputs)
    known = [*zip(signature.inputs, inputs, strict=True), *zip(signature.outputs, places, strict=True)]
    batch = np.broadcast_shapes(*(_batch(port, array) for port, array in known if array is not None))
    threads = min(threads, prod(batch) // SMALLEST)
    if threads < 2:
        return call(inputs, out)
    axis = int(np.argmax(batch))
    spread = [
        np.broadcast_to(array, (*batch, *port.shape))
        for port, array in zip(signature.inputs, inputs, strict=True)
    ]
    results = tuple(
        np.empty((*batch, *port.shape)) if place is None else place
        for port, place in zip(signature.outputs, places, strict=True)
    )
    status = np.empty(batch, dtype=np.intc)

    def part(bounds: tuple[int, int]) -> None:
        piece = (slice(None),) * axis + (slice(*bounds),)
        *_, codes = call([array[piece] for array in spread], tuple(array[piece] for array in results))
        status[piece] = codes

    # this thread has a share of its own, and one less is started
    ends = np.linspace(0, batch[axis], threads + 1).astype(int).tolist()
    own, *others = pairwise(ends)
    with ThreadPoolExecutor(threads - 1) as pool:
        started = [pool.submit(part, bounds) for bounds in others]
        part(own)
    for job in started:
        job.result()
    return (*results, status)


def _batch(port: Port, array: Any) -> tuple[int, ...]:
    shape: tuple[int, ...] = np.shape(array)
    return shape[: len(shape) - len(port.shape)]
