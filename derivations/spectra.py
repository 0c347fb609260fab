"""Largest eigenvalues of small symmetric matrices as formulas: in closed form, and as smooth bounds.

The closed form has a kink where the largest eigenvalue is a double one, as it is in poses with the symmetry
of the legs; its slope there is one of those nearby.  The bound has all derivatives everywhere, and is what an
optimiser should see.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations
from typing import Any

import sympy as sp

from krhpr.codegen.writer import KernelWriter
from krhpr.derivations.vectors import cross, determinant3, dot

EXPONENT = 8
"""The bound of an eigenvalue is the `EXPONENT`th root of the sum of the powers of all."""

NOTHING = sp.Rational(1, 10**48)
"""Relative to squares of eigenvalues: nothing beside roundings; below a root it keeps a slope finite where
eigenvalues are equal."""


def largest_eigenvalue(k: KernelWriter, name: str, a: sp.Matrix) -> Any:
    """The largest eigenvalue of a symmetric matrix with up to three rows; never NaN by rounding."""
    if all(a[i, j] == 0 for i, j in combinations(range(a.rows), 2)):
        return k.maximum(*(a[i, i] for i in range(a.rows)))
    if a.rows == 2:
        half = k.let(f"{name}_h", (a[0, 0] - a[1, 1]) / 2)
        return (a[0, 0] + a[1, 1]) / 2 + sp.sqrt(half**2 + a[0, 1] ** 2)
    mean = k.let(f"{name}_m", a.trace() / 3)
    floor = k.let(f"{name}_f", mean**2)
    rest = k.let(f"{name}_d", a - mean * sp.eye(3), "without its mean")
    size = k.let(f"{name}_p", sum(rest[i, j] ** 2 for i in range(3) for j in range(3)) / 6 + NOTHING * floor)
    turned = k.let(f"{name}_q", determinant3(rest) / 2)
    # cos(3 t) : sin(3 t) = det/2 : sqrt(discriminant/108); as a sum of squares it is never below zero, and as
    # exact as the differences of the eigenvalues
    ahead = k.let(f"{name}_s", _discriminant(k, name, rest) / 108 + NOTHING**3 * floor**3)
    angle = k.atan2(sp.sqrt(ahead), turned) / 3
    return mean + 2 * sp.sqrt(size) * sp.cos(k.let(f"{name}_t", angle))


def _discriminant(k: KernelWriter, name: str, a: sp.Matrix) -> Any:
    """The product of the squared differences of a symmetric 3 x 3 matrix' eigenvalues.

    It is the Gram determinant of 1, a and a^2 as vectors, and by Cauchy and Binet the sum of the squares of
    their minors.
    """
    square = k.let(f"{name}_a2", a * a)
    off = ((0, 1), (0, 2), (1, 2))
    total = (
        (a[1, 1] - a[0, 0]) * (square[2, 2] - square[0, 0])
        - (a[2, 2] - a[0, 0]) * (square[1, 1] - square[0, 0])
    ) ** 2
    for i, j in off:
        steps = (
            k.let(f"{name}_w{i}{j}", a[j, j] - a[i, i]),
            k.let(f"{name}_v{i}{j}", square[j, j] - square[i, i]),
        )
        for at in off:
            total += 2 * (steps[0] * square[at] - steps[1] * a[at]) ** 2
    for one, other in combinations(off, 2):
        total += 12 * (a[one] * square[other] - a[other] * square[one]) ** 2
    return total


def power_sum(k: KernelWriter, name: str, a: sp.Matrix) -> Any:
    """The sum of the `EXPONENT`th powers of the eigenvalues of a symmetric matrix."""
    square = a
    for step in ("2", "4"):
        square = k.let(f"{name}_r{step}", square * square)
    return sum(square[i, j] ** 2 for i in range(a.rows) for j in range(a.rows))


def root(k: KernelWriter, name: str, value: Any) -> Any:
    """The `EXPONENT`th root, as square roots."""
    for step in ("4", "2", "1"):
        value = k.let(f"{name}_{step}", sp.sqrt(value))
    return value


def _mean(values: Sequence[Any]) -> Any:
    """A mean of up to three positive values whose weights are powers of two: ones are not rounded."""
    return sum(value * sp.Rational(1, 2 ** min(i + 1, len(values) - 1)) for i, value in enumerate(values))


def eigenvalue_bound(k: KernelWriter, name: str, a: sp.Matrix) -> Any:
    """An upper bound of the largest eigenvalue of a positive matrix, at most rows^(1/8) times too large."""
    # relative to their mean, or the powers of what is large would not be numbers
    mean = k.let(f"{name}_0", _mean([a[i, i] for i in range(a.rows)]))
    relative = k.let(f"{name}_r", a / mean)
    return mean * root(k, name, k.let(f"{name}_8", power_sum(k, name, relative)))


def bound_of_bounds(k: KernelWriter, name: str, values: Sequence[Any]) -> Any:
    """The bound for a block-diagonal matrix from those of its blocks."""
    mean = k.let(f"{name}_0", _mean(values))
    powers = sum(k.let(f"{name}_r{i + 1}", value / mean) ** EXPONENT for i, value in enumerate(values))
    return mean * root(k, name, k.let(f"{name}_8", powers))


def cofactors(m: sp.Matrix) -> sp.Matrix:
    """The matrix of cofactors of a square matrix with two or three rows: m times its transpose is det(m)."""
    if m.rows == 2:
        return sp.Matrix([[m[1, 1], -m[1, 0]], [-m[0, 1], m[0, 0]]])
    rows = [m.row(i).T for i in range(3)]
    return sp.Matrix.vstack(*(cross(rows[(i + 1) % 3], rows[(i + 2) % 3]).T for i in range(3)))


def determinant(m: sp.Matrix, minors: sp.Matrix) -> Any:
    """The determinant from a row and its cofactors."""
    return dot(m.row(0).T, minors.row(0).T)
