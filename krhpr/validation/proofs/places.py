"""Of the catalogue's sub-legs: where joints on the base are, and factors that det M_i does not have.

Both written from the sub-legs' descriptions alone.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from krhpr.validation.linear import cross, determinant, dot, minus, plus, scaled
from krhpr.validation.numbers import Exact
from krhpr.validation.proofs import thesis
from krhpr.validation.proofs.thesis import Vector

Fields = dict[str, Any]


def around(g: Fields) -> list[Vector]:
    """Radial directions of the centres g_k about c."""
    angles = [g["azimuth"] + g[f"a_{k}"] for k in (1, 2, 3)]
    return [[angle.cos(), angle.sin(), Exact(0)] for angle in angles]


def _centres(g: Fields) -> list[Vector]:
    """g_k on a horizontal circle about c."""
    c = thesis.axes(g, None).c
    return [plus(c, scaled(g["r_g"], out)) for out in around(g)]


def _feet(g: Fields, s: Vector) -> list[Vector]:
    """C_k, the point of cylinder k's axis that is next to S_i."""
    at, found = thesis.axes(g, None), []
    for k in (1, 2, 3):
        tilt, turn = g[f"tilt_{k}"], g[f"turn_{k}"]
        leaning = plus(scaled(turn.cos(), at.e_1), scaled(turn.sin(), at.e_2))
        e = plus(scaled(tilt.cos(), at.x), scaled(tilt.sin(), leaning))
        offset = [g[f"{axis}_{k}"] for axis in "xyz"]
        g_k = at.c
        for length, axis in zip(offset, (at.x, at.e_1, at.e_2), strict=True):
            g_k = plus(g_k, scaled(length, axis))
        found.append(plus(g_k, scaled(dot(minus(s, g_k), e), e)))
    return found


def places(g: Fields, s: Vector, theta: Vector) -> dict[str, Vector]:
    """Points by their names: base joints A and A_2, the end c of link i1, centres G_k, feet C_k, and the end
    E of a planar five-bar's first crank.
    """
    found: dict[str, Vector] = {}
    radial = [g["azimuth"].cos(), g["azimuth"].sin(), Exact(0)][: len(s)]
    base = scaled(g["R_b"], radial)
    if "l_0" in g:  # the distance of two base joints
        along = scaled(g["l_0"] / 2, [-radial[1], radial[0]])
        found |= {"A": minus(base, along), "A_2": plus(base, along)}
    else:
        found["A"] = base
    if "l_4" in g and len(s) == 2:
        found["E"] = plus(found["A"], scaled(g["l_4"], [theta[0].cos(), theta[0].sin()]))
    if "alpha" in g and "slide_azimuth" not in g:
        found["c"] = thesis.axes(g, None).c
    if "a_1" in g:
        found |= {f"G_{k}": centre for k, centre in enumerate(_centres(g), 1)}
    if "tilt_1" in g:
        found |= {f"C_{k}": foot for k, foot in enumerate(_feet(g, s), 1)}
    return found


def _tripteron(g: Fields, s: Vector, theta: Vector) -> list[Any]:
    """Squared sines of the angles between the two links of each slide, by the law of cosines."""
    a, b, found = g["l_2"], g["l_3"], []
    for k in range(3):
        d2 = sum((theta[j] * theta[j] for j in range(3) if j != k), Exact(0))
        cosine = (d2 - a * a - b * b) / (2 * a * b)
        found.append(1 - cosine * cosine)
    return found


def _upu3(g: Fields, s: Vector, theta: Vector) -> list[Any]:
    """det [t_k x (w_k x t_k)]: normals of the axes t_k and w_k x t_k of the universal joints."""
    normals = []
    for out, centre in zip(around(g), _centres(g), strict=True):
        tangent = [-out[1], out[0], Exact(0)]
        normals.append(cross(tangent, cross(minus(s, centre), tangent)))
    scale = g["r_g"]
    return [determinant(normals) / (scale * scale * scale)]


def _rrrr(g: Fields, s: Vector, theta: Vector) -> list[Any]:
    """Distance of S_i from the first axis over the sum of the links."""
    at = thesis.axes(g, None)
    across = cross(minus(s, at.c), at.e_1)
    return [dot(across, across).sqrt() / (g["l_2"] + g["l_3"])]


OTHERS: dict[str, Callable[[Fields, Vector, Vector], list[Any]]] = {
    "subleg_tripteron": _tripteron,
    "subleg_upu3": _upu3,
    "subleg_rrrr": _rrrr,
}
"""Factors beside those of det M_i, of each sub-leg that has any."""
