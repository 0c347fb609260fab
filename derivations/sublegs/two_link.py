"""The planar two-link chain: the closed form that every sub-leg with an elbow uses.

A point (x, y) at distance d from the first joint, links a (inner) and b (outer), elbow angle psi from the
inner to the outer link.  With C = d^2 - a^2 - b^2 = 2 a b cos(psi) and S = 2 a b sin(psi),

    S^2 = 4 a^2 b^2 - C^2 = ((a + b)^2 - d^2) (d^2 - (a - b)^2),

so psi = atan2(S, C) and the inner link is at atan2(y A - x S, x A + y S) with A = 2 a^2 + C = 2 a (a + b
cos(psi)); as a vector it is (x A + y S, y A - x S) / (2 d^2). No angle is subtracted, nothing is divided,
nothing is lost where the elbow is straight or folded (the thesis' half-angle forms (B.14) lose the root at
pi).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import sympy as sp

from krhpr.codegen.writer import KernelWriter


@dataclass(frozen=True)
class TwoLink:
    """Inner link angle and vector, elbow angle (relative), and the radicand that decides whether there is a
    solution.
    """

    inner: Any
    elbow: Any
    radicand: Any
    link: sp.Matrix


def two_link(
    k: KernelWriter, x: Any, y: Any, a: Any, b: Any, sign: Any, *, elbow: bool = True, suffix: str = ""
) -> TwoLink:
    """Solve the two-link chain in the branch `sign` = sign of sin(psi)."""
    d2 = k.let(f"d2{suffix}", x**2 + y**2)
    longest, shortest = (a + b) ** 2, (a - b) ** 2
    radicand = k.let(f"h2{suffix}", (longest - d2) * (d2 - shortest), "4 a^2 b^2 sin^2")
    s = k.let(f"S{suffix}", sign * sp.sqrt(radicand), "2 a b sin")
    c = k.let(f"C{suffix}", d2 - (a**2 + b**2), "2 a b cos")
    reach = k.let(f"A{suffix}", d2 + (a**2 - b**2), "2 a (a + b cos)")
    along, across = k.let(f"n{suffix}", x * reach + y * s), k.let(f"m{suffix}", y * reach - x * s)
    link = sp.Matrix([along, across]) / (2 * d2)
    return TwoLink(k.atan2(across, along), k.atan2(s, c) if elbow else None, radicand, link)


def outside(k: KernelWriter, distance: Any, a: Any, b: Any) -> Any:
    """By how much a point at `distance` lies outside the annulus of a two-link chain."""
    return k.maximum(distance - (a + b), k.absolute(a - b) - distance)
