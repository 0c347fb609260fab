"""Columns of CSV files: `phi` for a number, `p_0,p_1,p_2` for a vector, `Q_00,Q_01,...` for a matrix."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import product
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from krhpr.generated.python.runtime import Port

_MOST_DIGITS = 10


def column_names(port: Port) -> list[str]:
    """The columns of an argument or result, in row-major order.

    Indices are digits, one after the other; with a dimension of more than ten they are kept apart: `K_0_11`.
    """
    apart = "_" if any(length > _MOST_DIGITS for length in port.shape) else ""
    indices = product(*(range(length) for length in port.shape))
    return [port.name if not index else f"{port.name}_{apart.join(map(str, index))}" for index in indices]


def all_columns(ports: Sequence[Port]) -> list[str]:
    """The columns of several arguments or results."""
    return [name for port in ports for name in column_names(port)]
