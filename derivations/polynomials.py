"""Polynomials in T = tan(angle / 2), as lists of coefficients, the constant one first."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import sympy as sp


def linear(constant: Any, cosine: Any, sine: Any) -> list[Any]:
    """constant + cosine cos(angle) + sine sin(angle), times 1 + T^2."""
    return [constant + cosine, 2 * sine, constant - cosine]


def product(a: Sequence[Any], b: Sequence[Any]) -> list[Any]:
    """The product of two polynomials."""
    found = [sp.Integer(0)] * (len(a) + len(b) - 1)
    for i, left in enumerate(a):
        for j, right in enumerate(b):
            found[i + j] += left * right
    return found
