"""Least squares on the graph: Gauss-Newton steps by the normal equations."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import sympy as sp

from krhpr.codegen.writer import KernelWriter
from krhpr.derivations.vectors import dot


def normal_step(k: KernelWriter, rows: Sequence[Sequence[Any]], values: Sequence[Any]) -> sp.Matrix:
    """-(J^T J)^-1 J^T f, (3.32) and (3.33), for the rows of J and their values f."""
    J = sp.Matrix(
        [[k.let(f"J_{i}{j}", x) if x != 0 else x for j, x in enumerate(row)] for i, row in enumerate(rows)]
    )
    f = sp.Matrix([k.let(f"r_{i}", value) for i, value in enumerate(values)])
    n = J.cols
    normal = [[k.let(f"N_{i}{j}", dot(J.col(i), J.col(j))) for j in range(i + 1)] for i in range(n)]
    right = [k.let(f"h_{i}", -dot(J.col(i), f)) for i in range(n)]
    return solve_symmetric(k, normal, right)


def solve_symmetric(k: KernelWriter, lower: Sequence[Sequence[Any]], right: Sequence[Any]) -> sp.Matrix:
    """Solve N x = h for a positive definite N, given by its lower triangle, as L D L^T."""
    n = len(right)
    L: list[list[Any]] = [[sp.Integer(0)] * n for _ in range(n)]
    D: list[Any] = []
    for j in range(n):
        pivot = lower[j][j] - sum(L[j][m] ** 2 * D[m] for m in range(j))
        D.append(k.let(f"D_{j}", pivot))
        inverse = k.let(f"E_{j}", 1 / D[j])
        for i in range(j + 1, n):
            rest = lower[i][j] - sum(L[i][m] * L[j][m] * D[m] for m in range(j))
            L[i][j] = k.let(f"L_{i}{j}", rest * inverse) if rest != 0 else rest
    y: list[Any] = []
    for i in range(n):
        y.append(k.let(f"y_{i}", right[i] - sum(L[i][m] * y[m] for m in range(i))))
    x: list[Any] = [sp.Integer(0)] * n
    for i in reversed(range(n)):
        x[i] = k.let(f"x_{i}", y[i] / D[i] - sum(L[m][i] * x[m] for m in range(i + 1, n)))
    return sp.Matrix(x)
