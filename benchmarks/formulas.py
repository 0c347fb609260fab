"""The three workloads, written once with plain vectors and evaluated by every back end.

A back end is a namespace with ``sin``, ``cos``, ``sqrt``, ``atan2`` and ``acos`` whose values have
``+ - * /``: SymPy, CasADi, SymForce, wrenfold and NumPy arrays all qualify. Literal zeros and ones are
dropped here, so that no back end has to simplify them away. Every workload comes in two forms, and each
peer is measured in both: no peer loses because the form that suits it was left out.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from benchmarks.robot import HYBRID, L2, L3, L_REDUNDANT, LEGS, R_PLATFORM, SHOULDER_1, SHOULDER_X, LegFrame

Value = Any  # a scalar of the back end
Vec = list[Value]


def scale(factor: Value, vector: Sequence[Value]) -> Vec:
    """``factor * vector`` without products by literal 0, 1 and -1."""
    return [product(factor, component) for component in vector]


def product(a: Value, b: Value) -> Value:
    """``a * b`` without products by literal 0, 1 and -1."""
    for literal, other in ((a, b), (b, a)):
        if isinstance(literal, int | float) and literal in (0, 1, -1):
            return 0 if literal == 0 else other if literal == 1 else -other
    return a * b


def total(*terms: Value) -> Value:
    """Sum without literal zeros."""
    kept = [term for term in terms if not (isinstance(term, int | float) and term == 0)]
    result: Value = kept[0] if kept else 0
    for term in kept[1:]:
        result = result + term
    return result


def add(*vectors: Sequence[Value]) -> Vec:
    """Sum of vectors."""
    return [total(*components) for components in zip(*vectors, strict=True)]


def sub(a: Sequence[Value], b: Sequence[Value]) -> Vec:
    """``a - b``."""
    return [x if isinstance(y, int | float) and y == 0 else x - y for x, y in zip(a, b, strict=True)]


def dot(a: Sequence[Value], b: Sequence[Value]) -> Value:
    """Scalar product."""
    return total(*(product(x, y) for x, y in zip(a, b, strict=True)))


def cross(a: Sequence[Value], b: Sequence[Value]) -> Vec:
    """Vector product."""
    return [
        product(a[1], b[2]) - product(a[2], b[1]),
        product(a[2], b[0]) - product(a[0], b[2]),
        product(a[0], b[1]) - product(a[1], b[0]),
    ]


def columns(matrix: Sequence[Value]) -> tuple[Vec, Vec, Vec]:
    """Columns of a row-major 3x3 matrix."""
    return list(matrix[0:9:3]), list(matrix[1:9:3]), list(matrix[2:9:3])


def platform_points(q_x: Vec, q_y: Vec) -> list[Vec]:
    """Q b_i of the equilateral platform."""
    half, side = scale(-R_PLATFORM / 2, q_x), scale(R_PLATFORM * LEGS[1].e_r[1], q_y)
    return [scale(R_PLATFORM, q_x), add(half, side), sub(half, side)]


def linkage_plane(ops: Any, leg: LegFrame, theta_1: Value) -> tuple[Vec, Vec]:
    """x and e_2 after a rotation by theta_1 about e_1."""
    cos_1, sin_1 = ops.cos(theta_1), ops.sin(theta_1)
    x = sub(scale(cos_1, leg.e_x), scale(sin_1, leg.e_t))
    e_2 = add(scale(cos_1, leg.e_t), scale(sin_1, leg.e_x))
    return x, e_2


def jacobians(ops: Any, p: Vec, q: Vec, theta: Vec, *, in_plane: bool) -> tuple[Vec, Vec]:
    """W1: J (36) and the blocks of K (18) from pose and joint angles, (1.31) and (1.32), for RRR legs.

    ``in_plane`` uses M = [-X e_2, X e_1 - Y x, X_3 e_1 - Y_3 x], with s - c = X x + Y e_1; otherwise the
    columns of M are vector products.
    """
    q_x, q_y, q_z = columns(q)
    jacobian: Vec = []
    blocks: Vec = []
    for i, (leg, qb) in enumerate(zip(LEGS, platform_points(q_x, q_y), strict=True)):
        t_1, t_2, t_3 = theta[3 * i : 3 * i + 3]
        x, e_2 = linkage_plane(ops, leg, t_1)
        t_23 = t_2 + t_3
        x_3, y_3 = L3 * ops.cos(t_23), L3 * ops.sin(t_23)
        if in_plane:
            big_x, big_y = L2 * ops.cos(t_2) + x_3, L2 * ops.sin(t_2) + y_3
            reach = add(scale(big_x, x), scale(big_y, leg.e_1))
        else:
            v_1 = add(scale(x_3, x), scale(y_3, leg.e_1))
            u_1 = add(scale(L2 * ops.cos(t_2), x), scale(L2 * ops.sin(t_2), leg.e_1))
            reach = add(u_1, v_1)
            m = (cross(leg.e_1, reach), cross(e_2, reach), cross(e_2, v_1))
        a = sub(sub(add(p, qb), leg.c), reach)
        jacobian += [*a, *cross(qb, a), *q_z, *cross(sub(qb, a), q_z)]
        for row in (a, q_z):
            if in_plane:
                r_x, r_1, r_2 = dot(row, x), dot(row, leg.e_1), dot(row, e_2)
                blocks += [-(big_x * r_2), big_x * r_1 - big_y * r_x, x_3 * r_1 - y_3 * r_x]
            else:
                blocks += [dot(row, column) for column in m]
    return jacobian, blocks


def inverse(ops: Any, p: Vec, q: Vec, beta: Vec, *, use_acos: bool) -> tuple[Vec]:
    """W2: nine joint angles from pose and redundant angles, for r > 0 and sin(theta_3) > 0.

    The shoulder's projections are constants, equal in all legs and zero along e_t. theta_2 needs one
    arctangent only; theta_3 comes from ``acos`` or from ``atan2``.
    """
    q_x, q_y, _ = columns(q)
    theta: Vec = []
    for leg, beta_i in zip(LEGS, beta, strict=True):
        radial, tangential = R_PLATFORM - L_REDUNDANT * ops.cos(beta_i), L_REDUNDANT * ops.sin(beta_i)
        in_x = total(product(leg.e_r[0], radial), product(leg.e_t[0], tangential))
        in_y = total(product(leg.e_r[1], radial), product(leg.e_t[1], tangential))
        s = add(p, scale(in_x, q_x), scale(in_y, q_y))
        d_x, d_t, y = dot(s, leg.e_x) - SHOULDER_X, dot(s, leg.e_t), dot(s, leg.e_1) - SHOULDER_1
        square = d_x * d_x + d_t * d_t
        r = ops.sqrt(square)
        cos_3 = (square + y * y - (L2 * L2 + L3 * L3)) * (1.0 / (2.0 * L2 * L3))
        sin_3 = ops.sqrt(1 - cos_3 * cos_3)
        k_1, k_2 = L2 + L3 * cos_3, L3 * sin_3
        theta += [
            ops.atan2(-d_t, d_x),
            ops.atan2(y * k_1 - r * k_2, r * k_1 + y * k_2),
            ops.acos(cos_3) if use_acos else ops.atan2(sin_3, cos_3),
        ]
    return (theta,)


def hybrid_leg_jacobians(ops: Any, s: Vec, theta: Vec, *, in_plane: bool) -> tuple[Vec]:
    """W5: M_i = A_i^-1 B_i of three R(RR-RRR) legs, (1.10) corrected to (1.16); row-major, leg by leg.

    ``in_plane`` separates the first column and solves 2x2 in (x, e_1); otherwise A is inverted by vector
    products.
    """
    ratio = HYBRID.l5 / HYBRID.l6
    k = 1.0 - ratio
    result: Vec = []
    for i, leg in enumerate(LEGS):
        t_1, t_2, t_3 = theta[3 * i : 3 * i + 3]
        x, e_2 = linkage_plane(ops, leg, t_1)
        d = sub(s[3 * i : 3 * i + 3], leg.c)
        u_1 = [HYBRID.l4 * ops.cos(t_2), HYBRID.l4 * ops.sin(t_2)]
        u_2 = [HYBRID.l2 * ops.cos(t_3), HYBRID.l2 * ops.sin(t_3)]
        if in_plane:
            big_x = dot(d, x)
            v_1 = [big_x - u_1[0], dot(d, leg.e_1) - u_1[1]]
            v_2 = [u_1[0] + k * v_1[0] - u_2[0], u_1[1] + k * v_1[1] - u_2[1]]
            b_22 = v_1[1] * u_1[0] - v_1[0] * u_1[1]
            b_32 = ratio * (v_2[0] * u_1[1] - v_2[1] * u_1[0])
            b_33 = v_2[1] * u_2[0] - v_2[0] * u_2[1]
            inv = 1 / (k * (v_1[0] * v_2[1] - v_1[1] * v_2[0]))
            g_22, g_32, g_33 = inv * k * b_22, inv * b_32, inv * b_33
            cols = [
                scale(-big_x, e_2),
                add(scale(g_22 * v_2[1] - g_32 * v_1[1], x), scale(g_32 * v_1[0] - g_22 * v_2[0], leg.e_1)),
                add(scale(-(g_33 * v_1[1]), x), scale(g_33 * v_1[0], leg.e_1)),
            ]
        else:
            u1 = add(scale(u_1[0], x), scale(u_1[1], leg.e_1))
            u2 = add(scale(u_2[0], x), scale(u_2[1], leg.e_1))
            v1 = sub(d, u1)
            v2 = sub(add(u1, scale(k, v1)), u2)
            rows = (e_2, v1, scale(k, v2))
            adjugate = (cross(rows[1], rows[2]), cross(rows[2], rows[0]), cross(rows[0], rows[1]))
            inv = 1 / dot(rows[0], adjugate[0])
            b_11 = -dot(d, x)
            e2_u1 = cross(e_2, u1)
            b_22, b_32, b_33 = dot(v1, e2_u1), -(ratio * dot(v2, e2_u1)), dot(v2, cross(e_2, u2))
            cols = [
                scale(inv * b_11, adjugate[0]),
                add(scale(inv * b_22, adjugate[1]), scale(inv * b_32, adjugate[2])),
                scale(inv * b_33, adjugate[2]),
            ]
        result += [cols[column][row] for row in range(3) for column in range(3)]
    return (result,)
