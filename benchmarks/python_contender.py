"""What takes part in the benchmark from Python: a call bound to its inputs, and a check of its outputs."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Prepared:
    """``call()`` is timed; ``collect(result of call)`` gives the outputs as (n, ...) arrays and is not."""

    call: Callable[[], Any]
    collect: Callable[[Any], Sequence[Floats]]


Prepare = Callable[[list[Floats]], Prepared]


@dataclass(frozen=True)
class PythonContender:
    """One way to compute a workload from Python.

    ``batch`` gets inputs of shape (n, ...), ``single`` the same without the first axis (and ``collect`` then
    returns n = 1). What users do once, such as binding buffers, belongs into them; what they do for every
    call into ``call``.
    """

    name: str
    variant: str
    single: Prepare | None = None
    batch: Prepare | None = None
