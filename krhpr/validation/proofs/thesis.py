"""Matrices of the thesis as they are printed, with vectors in the base frame, on any numbers.

They are copied, and that is the point: the derivation never sees them.  Errata are corrected where they
stand.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from krhpr.validation.linear import Matrix, apply, cross, dot, minus, plus, scaled, solve, transpose
from krhpr.validation.numbers import Exact

Fields = Mapping[str, Any]
Vector = list[Any]


def turned(axis: Vector, angle: Any, v: Vector) -> Vector:
    """v turned about a unit axis."""
    along = scaled(dot(axis, v) * (1 - angle.cos()), axis)
    return plus(plus(scaled(angle.cos(), v), scaled(angle.sin(), cross(axis, v))), along)


@dataclass(frozen=True)
class VelocityMatrices:
    """A s_dot = B theta_dot and M = A^-1 B in the base frame; A and B where the thesis has them."""

    M: Matrix
    A: Matrix | None = None
    B: Matrix | None = None
    A_inverse: Matrix | None = None


@dataclass(frozen=True)
class Axes:
    """c_i, e_i1, e_i2 and the direction x = e_i1 x e_i2 of a leg with a first axis."""

    c: Vector
    e_1: Vector
    e_2: Vector
    x: Vector


def axes(g: Fields, theta_1: Any) -> Axes:
    """Fig. 1.3 with the conventions of the errata: e_2 is tangential at theta_1 = 0 (None: it stays so)."""
    e_r: Vector = [g["azimuth"].cos(), g["azimuth"].sin(), Exact(0)]
    e_t: Vector = [-g["azimuth"].sin(), g["azimuth"].cos(), Exact(0)]
    e_1 = plus(scaled(-g["alpha"].cos(), e_r), [Exact(0), Exact(0), g["alpha"].sin()])
    e_2 = e_t if theta_1 is None else turned(e_1, theta_1, e_t)
    return Axes(plus(scaled(g["R_b"], e_r), scaled(g["l_1"], e_1)), e_1, e_2, cross(e_1, e_2))


def _r_fivebar(g: Fields, s: Vector, theta: Vector) -> VelocityMatrices:
    at = axes(g, theta[0])
    e_1, e_2, e_3 = at.e_1, at.e_2, at.e_2
    ratio = 1 - g["l_5"] / g["l_6"]
    u_1 = scaled(g["l_4"], turned(e_2, theta[1], at.x))
    u_2 = scaled(g["l_2"], turned(e_3, theta[2], at.x))
    v_1 = minus(minus(s, at.c), u_1)  # (1.14)
    w = scaled(ratio, v_1)  # (A.16)
    v_2 = minus(plus(u_1, w), u_2)  # (1.15)
    zero = Exact(0)
    A = [e_2, v_1, scaled(ratio, v_2)]  # (1.10), with the parentheses of (A.22)
    b_11 = dot(minus(s, at.c), cross(e_2, e_1))  # (1.12)
    b_32 = g["l_5"] / g["l_6"] * dot(v_2, cross(u_1, e_2))  # (1.13)
    B = [  # (1.11)
        [b_11, zero, zero],
        [zero, dot(v_1, cross(e_2, u_1)), zero],
        [zero, b_32, dot(v_2, cross(e_3, u_2))],
    ]
    alpha = 1 / dot(e_2, cross(v_1, v_2))  # (A.3)
    columns = [  # (A.2)
        cross(v_1, v_2),
        scaled(-1, cross(e_2, v_2)),
        scaled(g["l_6"] / (g["l_6"] - g["l_5"]), cross(e_2, v_1)),
    ]
    inverse = transpose([scaled(alpha, column) for column in columns])
    M = [[dot(row, column) for column in transpose(B)] for row in inverse]
    return VelocityMatrices(M, A, B, inverse)


def _rrr(g: Fields, s: Vector, theta: Vector) -> VelocityMatrices:
    # (2.15): r_ik points from a point of the k-th joint's axis to S_i
    at = axes(g, theta[0])
    elbow = plus(at.c, scaled(g["l_2"], turned(at.e_2, theta[1], at.x)))
    arm = minus(s, at.c)
    return VelocityMatrices(
        transpose([cross(at.e_1, arm), cross(at.e_2, arm), cross(at.e_2, minus(s, elbow))])
    )


def _planar_rr(g: Fields, s: Vector, theta: Vector) -> VelocityMatrices:
    # [E (r - o), E (r - elbow)]
    o = [g["R_b"] * g["azimuth"].cos(), g["R_b"] * g["azimuth"].sin()]
    elbow = plus(o, [g["l_1"] * theta[0].cos(), g["l_1"] * theta[0].sin()])
    return VelocityMatrices(transpose([quarter(minus(s, o)), quarter(minus(s, elbow))]))


def quarter(v: Sequence[Any]) -> Vector:
    """E v, (2.6)."""
    return [-v[1], v[0]]


def _prr(g: Fields, s: Vector, theta: Vector) -> VelocityMatrices:
    # 2.4.1: (2.15) with its first column replaced by the slide's direction
    at = axes(g, None)
    base = plus(at.c, scaled(theta[0], at.e_2))
    elbow = plus(base, scaled(g["l_2"], turned(at.e_2, theta[1], at.x)))
    columns = [at.e_2, cross(at.e_2, minus(s, base)), cross(at.e_2, minus(s, elbow))]
    return VelocityMatrices(transpose(columns))


def _p_fivebar(g: Fields, s: Vector, theta: Vector) -> VelocityMatrices:
    at = axes(g, None)
    e_1 = e_2 = e_3 = at.e_2  # the slide and both cranks are along e_t
    b = plus(at.c, scaled(theta[0], e_1))  # (2.36)
    ratio = 1 - g["l_5"] / g["l_6"]  # l_4 / l_5 of Section 2.4.2 is l_5 / l_6 here
    u_1 = scaled(g["l_4"], turned(e_2, theta[1], at.x))
    u_2 = scaled(g["l_2"], turned(e_3, theta[2], at.x))
    v_1 = minus(minus(s, b), u_1)
    v_2 = minus(plus(u_1, scaled(ratio, v_1)), u_2)
    zero, one = Exact(0), Exact(1)
    A = [e_1, v_1, scaled(ratio, v_2)]  # (2.48)
    B = [  # (2.49)
        [one, zero, zero],
        [zero, dot(minus(s, b), cross(e_2, u_1)), zero],
        [zero, g["l_5"] / g["l_6"] * dot(v_2, cross(u_1, e_2)), dot(v_2, cross(e_3, u_2))],
    ]
    return VelocityMatrices(solve(A, B), A, B)  # (2.50)


def _rrrr(g: Fields, s: Vector, theta: Vector) -> VelocityMatrices:
    # (2.32): r_j points from the centre of joint j to S_i
    at = axes(g, theta[0])
    u = scaled(g["l_2"], turned(at.e_2, theta[1], at.x))
    e_3 = scaled(1 / g["l_2"], u)
    e_4 = turned(e_3, theta[2], at.e_2)
    shoulder, elbow = minus(s, at.c), minus(minus(s, at.c), u)
    pairs = ((at.e_1, shoulder), (at.e_2, shoulder), (e_3, elbow), (e_4, elbow))
    return VelocityMatrices(transpose([cross(e, r) for e, r in pairs]))


def _cpr3(g: Fields, s: Vector, theta: Vector) -> VelocityMatrices:
    at, rows = axes(g, None), []
    for k in (1, 2, 3):
        tilt, turn = g[f"tilt_{k}"], g[f"turn_{k}"]
        around = plus(scaled(turn.cos(), at.e_1), scaled(turn.sin(), at.e_2))
        e = plus(scaled(tilt.cos(), at.x), scaled(tilt.sin(), around))
        across = plus(scaled(g[f"y_{k}"], at.e_1), scaled(g[f"z_{k}"], at.e_2))
        c_k = plus(at.c, plus(scaled(g[f"x_{k}"], at.x), across))
        arm = minus(s, c_k)  # s + v_i - c_i of (2.52)
        rows.append(minus(arm, scaled(dot(arm, e), e)))
    B = [[theta[row] if row == column else Exact(0) for column in range(3)] for row in range(3)]
    return VelocityMatrices(solve(rows, B), rows, B)  # (2.55)


VELOCITY: dict[str, Callable[[Fields, Vector, Vector], VelocityMatrices]] = {
    "subleg_rrr": _rrr,
    "subleg_r_fivebar": _r_fivebar,
    "subleg_planar_rr": _planar_rr,
    "subleg_prr": _prr,
    "subleg_p_fivebar": _p_fivebar,
    "subleg_rrrr": _rrrr,
    "subleg_cpr3": _cpr3,
}


# -- platforms -------------------------------------------------------------------------------------


def _spatial_a(g: Fields, p: Vector, Q: Matrix, s: Vector) -> Matrix:
    # (1.4), (1.25), (1.31)
    q_z = [row[2] for row in Q]
    Qb = apply(Q, joint_in_platform(g))
    a = minus(plus(p, Qb), s)
    u = minus(Qb, a)
    return [[*a, *cross(Qb, a)], [*q_z, *cross(u, q_z)]]


def _along_slide(Q: Matrix, n: Vector, p: Vector, s: Vector) -> Matrix:
    """(2.28): the line across the slide and the one along q_z, both through S_i."""
    q_z = [row[2] for row in Q]
    Qn, arm = apply(Q, n), minus(s, p)
    return [[*Qn, *cross(arm, Qn)], [*q_z, *cross(arm, q_z)]]


def _spatial_b(g: Fields, p: Vector, Q: Matrix, s: Vector) -> Matrix:
    return _along_slide(Q, _radial(g), p, s)  # n_i = e_r


def _spatial_c(g: Fields, p: Vector, Q: Matrix, s: Vector) -> Matrix:
    return _along_slide(Q, cross([Exact(0), Exact(0), Exact(1)], _radial(g)), p, s)  # n_i = e_t


def _planar_slide(g: Fields, p: Vector, Q: Matrix, s: Vector) -> Matrix:
    # (2.10) with c_i = (Q n_i)^T E (r_i - p), to which (2.12) and (2.14) reduce
    Qn = apply(Q, [-g["platform_azimuth"].sin(), g["platform_azimuth"].cos()])
    return [[*Qn, dot(Qn, quarter(minus(s, p)))]]


def _planar_a(g: Fields, p: Vector, Q: Matrix, s: Vector) -> Matrix:
    # (2.3), (2.7)
    Qb = apply(Q, joint_in_platform(g)[:2])
    a = minus(plus(p, Qb), s)
    return [[*a, dot(a, quarter(Qb))]]


def joint_in_platform(g: Fields) -> Vector:
    """b_i of arrangement (a)."""
    azimuth = g["platform_azimuth"]
    return [g["R_p"] * azimuth.cos(), g["R_p"] * azimuth.sin(), Exact(0)]


def _radial(g: Fields) -> Vector:
    return [g["platform_azimuth"].cos(), g["platform_azimuth"].sin(), Exact(0)]


def _slider_spatial_b(g: Fields, d: Any) -> Vector:
    """b e_r + d_i e_t."""
    x, y, _ = _radial(g)
    return [g["R_p"] * x - d * y, g["R_p"] * y + d * x, Exact(0)]


def _slider_planar_b(g: Fields, d: Any) -> Vector:
    """b_i + delta_i t_i."""
    x, y, _ = _radial(g)
    return [g["b_x"] + d * x, g["b_y"] + d * y, Exact(0)]


def _slider_c(g: Fields, d: Any) -> Vector:
    """d_i t_i."""
    return scaled(d, _radial(g))


ATTACHMENTS: dict[str, Callable[[Fields, Any], Vector]] = {
    "platform_spatial_a": lambda g, beta: joint_in_platform(g),
    "platform_spatial_b": _slider_spatial_b,
    "platform_spatial_c": _slider_c,
    "platform_planar_a": lambda g, beta: joint_in_platform(g),
    "platform_planar_b": _slider_planar_b,
    "platform_planar_c": _slider_c,
}
"""Where the redundant link meets the platform, in the platform frame, by its redundant coordinate."""


ROWS: dict[str, Callable[[Fields, Vector, Matrix, Vector], Matrix]] = {
    "platform_spatial_a": _spatial_a,
    "platform_spatial_b": _spatial_b,
    "platform_spatial_c": _spatial_c,
    "platform_planar_a": _planar_a,
    "platform_planar_b": _planar_slide,
    "platform_planar_c": _planar_slide,
}
