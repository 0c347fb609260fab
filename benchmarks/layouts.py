"""How a batch lies in memory: pose after pose, component after component, or in blocks of eight poses."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
LANES = 8
LAYOUTS = ("aos", "soa", "blocked8")
"""Arrays of structures, structures of arrays, blocks of eight poses."""
LINE = 64
"""Bytes in a line of the cache."""


def room(size: int) -> Floats:
    """`size` zeros from a line of the cache on, so that no time hangs on where an array happens to lie."""
    whole = np.zeros(size + LINE // 8)
    first = -whole.ctypes.data % LINE // 8
    return whole[first : first + size]


def pack(array: Floats, layout: str) -> Floats:
    """(n, ...) to a flat array in ``layout``, from a line of the cache on."""
    flat: Floats = array.reshape(len(array), -1)
    if layout == "soa":
        flat = flat.T
    elif layout == "blocked8":
        flat = flat.reshape(-1, LANES, flat.shape[1]).transpose(0, 2, 1)
    elif layout != "aos":
        raise ValueError(f"unknown layout {layout!r}")
    packed = room(flat.size)
    packed[:] = flat.reshape(-1)
    return packed


def unpack(flat: Floats, n: int, shape: tuple[int, ...], layout: str) -> Floats:
    """The inverse of ``pack``."""
    if layout == "soa":
        flat = flat.reshape(-1, n).T
    elif layout == "blocked8":
        flat = flat.reshape(n // LANES, -1, LANES).transpose(0, 2, 1)
    return np.ascontiguousarray(flat).reshape(n, *shape)
