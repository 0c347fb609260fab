"""Kernels that are called at the real roots of a polynomial in T = tan(angle / 2)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from krhpr.codegen.kernel import Frame, Port, Unit
from krhpr.codegen.writer import KernelWriter

MISS_TOLERANCE = 1e-18
"""A solution holds lengths to a billionth; a root that is none misses them by far."""
COEFFICIENT_ERROR = 1e-14
"""What rounding makes of the coefficients, relative to the sum of their sizes."""


def root_port(polynomial: str) -> Port:
    """A root as a point of the projective line."""
    return Port("root", (2,), Unit.NONE, Frame.NONE, f"a root of the {polynomial}: T = root_0 / root_1")


def miss_port(what: str) -> Port:
    """By how much a root is no solution."""
    return Port("miss", (1,), Unit.NONE, Frame.NONE, f"by how much {what} are missed, squared and scaled")


def cosine_and_sine(k: KernelWriter, root: Any, at: str) -> tuple[Any, Any]:
    """Of the angle at a root; `at` ends their names."""
    x, y = root
    scale = k.let("xy_2", 1 / (x**2 + y**2))
    return k.let(f"cos{at}", (y**2 - x**2) * scale), k.let(f"sin{at}", 2 * x * y * scale)


def write_miss(k: KernelWriter, port: Port, misses: Sequence[Any], size: Any) -> None:
    """The output that says whether a root is a solution: squared lengths are off by `misses`."""
    k.add_output(port, [sum(miss**2 for miss in misses) / size**2])
