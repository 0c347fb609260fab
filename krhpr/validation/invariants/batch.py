"""How an invariant runs: on the functions of one target, at a batch of random configurations."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from krhpr.validation.check import Check
from krhpr.validation.numeric import Numeric, target
from krhpr.validation.outcome import Measured, Runner
from krhpr.validation.sampling import Batch, draw
from krhpr.validation.subject import Subject

Body = Callable[[Numeric, Batch, Measured], None]


def runner(body: Body) -> Runner:
    """A check of one target on a batch."""

    def run(subject: Subject, check: Check, count: int) -> Measured:
        found = Measured(check, samples=count)
        body(target(subject, check.target), draw(subject, check.seed, count), found)
        return found

    return run


def close(found: Measured, got: Any, wanted: Any, where: str, axes: int) -> None:
    """The error relative to the largest element of the last `axes` axes of what is wanted."""
    over = tuple(range(-axes, 0))
    scale = np.abs(wanted).max(axis=over, keepdims=True) if axes else np.abs(wanted)
    found.worse(np.abs(got - wanted) / scale, where)
