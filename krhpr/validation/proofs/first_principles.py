"""Sub-legs a second time: loop closures from rotations of vectors, differentiated by SymPy.

Nothing here is shared with `derivations/`: axes are turned by Rodrigues' formula, links are vectors in
the base frame, and the Jacobian is what the implicit function theorem makes of the closure.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any

import sympy as sp

from krhpr.validation.linear import Matrix, solve


@dataclass(frozen=True)
class Closure:
    """A closure f(s, theta) = 0 in symbols: fields by name, then s and theta."""

    fields: Mapping[str, sp.Symbol]
    s: sp.Matrix
    theta: sp.Matrix
    f: sp.Matrix


def rotated(axis: sp.Matrix, angle: Any, v: sp.Matrix) -> sp.Matrix:
    """v turned about a unit axis (Rodrigues)."""
    return v * sp.cos(angle) + axis.cross(v) * sp.sin(angle) + axis * (axis.dot(v) * (1 - sp.cos(angle)))


def _symbols(names: str, count: int, dimension: int) -> tuple[dict[str, sp.Symbol], sp.Matrix, sp.Matrix]:
    fields = {name: sp.Symbol(name, real=True) for name in names.split()}
    s = sp.Matrix(sp.symbols(f"s:{dimension}", real=True))
    return fields, s, sp.Matrix(sp.symbols(f"theta:{count}", real=True))


def _linkage(g: Mapping[str, sp.Symbol], theta_1: Any) -> tuple[sp.Matrix, sp.Matrix, sp.Matrix]:
    """End of the first link, direction x and axis e_2 of the linkage plane after the first joint has
    turned.
    """
    e_r = sp.Matrix([sp.cos(g["azimuth"]), sp.sin(g["azimuth"]), 0])
    e_z = sp.Matrix([0, 0, 1])
    e_t = e_z.cross(e_r)
    e_1 = -sp.cos(g["alpha"]) * e_r + sp.sin(g["alpha"]) * e_z
    c = g["R_b"] * e_r + g["l_1"] * e_1
    return c, rotated(e_1, theta_1, e_1.cross(e_t)), rotated(e_1, theta_1, e_t)


def _rrr() -> Closure:
    g, s, t = _symbols("azimuth R_b alpha l_1 l_2 l_3", 3, 3)
    c, x, e_2 = _linkage(g, t[0])
    upper = g["l_2"] * rotated(e_2, t[1], x)
    lower = g["l_3"] * rotated(e_2, t[1] + t[2], x)
    return Closure(g, s, t, s - c - upper - lower)


def _r_fivebar() -> Closure:
    g, s, t = _symbols("azimuth R_b alpha l_1 l_2 l_3 l_4 l_5 l_6", 3, 3)
    c, x, e_2 = _linkage(g, t[0])
    tip_1 = c + g["l_4"] * rotated(e_2, t[1], x)
    tip_2 = c + g["l_2"] * rotated(e_2, t[2], x)
    # the rod's pivot lies on the line from S through the tip of the first crank, l_5 from S
    pivot = s + (tip_1 - s) * (g["l_5"] / g["l_6"])
    distal, rod = s - tip_1, pivot - tip_2
    return Closure(
        g, s, t, sp.Matrix([e_2.dot(s - c), distal.dot(distal) - g["l_6"] ** 2, rod.dot(rod) - g["l_3"] ** 2])
    )


def _planar_rr() -> Closure:
    g, s, t = _symbols("azimuth R_b l_1 l_2", 2, 2)
    base = g["R_b"] * sp.Matrix([sp.cos(g["azimuth"]), sp.sin(g["azimuth"])])
    first, second = t[0], t[0] + t[1]
    links = [
        length * sp.Matrix([sp.cos(a), sp.sin(a)]) for length, a in ((g["l_1"], first), (g["l_2"], second))
    ]
    return Closure(g, s, t, s - base - links[0] - links[1])


CLOSURES: dict[str, Callable[[], Closure]] = {
    "subleg_rrr": _rrr,
    "subleg_r_fivebar": _r_fivebar,
    "subleg_planar_rr": _planar_rr,
}


@cache
def _compiled(name: str) -> tuple[tuple[str, ...], Callable[..., Any]]:
    closure = CLOSURES[name]()
    arguments = [*closure.fields.values(), *closure.s, *closure.theta]
    results = [list(m) for m in (closure.f, closure.f.jacobian(closure.s), closure.f.jacobian(closure.theta))]
    functions = {"sin": lambda angle: angle.sin(), "cos": lambda angle: angle.cos()}
    return tuple(closure.fields), sp.lambdify(arguments, results, modules=[functions], cse=True)


def closure_and_jacobian(
    name: str, fields: Mapping[str, Any], s: Sequence[Any], theta: Sequence[Any]
) -> tuple[list[Any], Matrix]:
    """The residual of the closure and M = -(df/ds)^-1 df/dtheta, on any numbers."""
    names, compiled = _compiled(name)
    residual, by_s, by_theta = compiled(*(fields[key] for key in names), *s, *theta)
    d, n = len(s), len(theta)
    left = [by_s[d * i : d * (i + 1)] for i in range(len(residual))]
    right = [[-entry for entry in by_theta[n * i : n * (i + 1)]] for i in range(len(residual))]
    return residual, solve(left, right)
