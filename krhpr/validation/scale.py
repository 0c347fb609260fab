"""Errors of doubles, relative to the scale of what is compared.

Agreement in units in the last place means nothing where outputs cancel, so that a difference is divided
by the largest value of the array in the same configuration; the factors of det J, which are of different
kinds, by their own.  Angles differ by the smaller arc, on the scale of a radian at least.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from krhpr.codegen.kernel import Layout, Port, Unit

Floats = NDArray[np.float64]

_ANGLES = frozenset({Unit.RADIAN, Unit.ACTUATOR})


def difference(port: Port, found: Any, wanted: Any, *, arcs: bool = True) -> Floats:
    """Absolute differences; of angles the smaller arc."""
    gap = np.abs(np.asarray(found) - np.asarray(wanted))
    if arcs and port.unit in _ANGLES:
        turn = 2 * np.pi
        gap = np.minimum(gap % turn, turn - gap % turn)
    return np.asarray(gap, dtype=float)


def scale(port: Port, values: Any) -> Floats:
    """The scale of a batch of values (count, *port), broadcast against it."""
    size = np.nan_to_num(np.abs(np.asarray(values, dtype=float)), nan=0.0)  # solutions that are not there
    core = tuple(range(size.ndim - len(port.full_shape), size.ndim))
    kinds = port.unit is Unit.MIXED and bool(port.labels)
    mixed = kinds and port.layout is Layout.SHARED and len(core) == 1
    largest: Floats = size if mixed or not core else size.max(axis=core, keepdims=True)
    if port.unit in _ANGLES:
        largest = np.maximum(largest, 1.0)
    return largest


def relative(port: Port, found: Any, wanted: Any, reference: Any = None, *, arcs: bool = True) -> Floats:
    """Differences over the scale of `wanted` (or of `reference`); not-a-number on both sides is no
    difference.
    """
    gap = difference(port, found, wanted, arcs=arcs)
    size = scale(port, wanted if reference is None else reference)
    with np.errstate(divide="ignore", invalid="ignore"):
        error = np.where(gap == 0, 0.0, gap / size)
    both = np.isnan(np.asarray(found, dtype=float)) & np.isnan(np.asarray(wanted, dtype=float))
    return np.where(both, 0.0, error)


def worst_of(error: Any) -> tuple[float, int]:
    """The largest error of a batch and the configuration in which it is; not-a-number is infinite."""
    array = np.nan_to_num(np.asarray(error, dtype=float), nan=np.inf)
    each = array.reshape(len(array), -1).max(axis=1)
    index = int(each.argmax())
    return float(each[index]), index
