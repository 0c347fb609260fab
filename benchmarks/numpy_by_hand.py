"""W1 and W2 as somebody would write them by hand for NumPy: one array for each component.

The same text runs on floats with the standard library's functions.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

from benchmarks.robot import L2, L3, L_REDUNDANT, LEGS, R_PLATFORM, SHOULDER_1, SHOULDER_X, SIN_60

Components = Sequence[Any]


def jacobians(m: Any, p: Components, q: Components, theta: Components) -> tuple[list[Any], list[Any]]:
    """J (36 components) and the blocks of K (18)."""
    q_x, q_y, q_z = q[2], q[5], q[8]
    jacobian: list[Any] = []
    blocks: list[Any] = []
    for i, leg in enumerate(LEGS):
        c_r, s_r = leg.e_r[0], leg.e_r[1]
        cos_1, sin_1 = m.cos(theta[3 * i]), m.sin(theta[3 * i])
        t_2 = theta[3 * i + 1]
        t_23 = t_2 + theta[3 * i + 2]
        x_3, y_3 = L3 * m.cos(t_23), L3 * m.sin(t_23)
        x, y = L2 * m.cos(t_2) + x_3, L2 * m.sin(t_2) + y_3
        # the end point along e_r, e_t, z: e_x = (-sin 60, 0, 1/2), e_1 = (1/2, 0, sin 60)
        cos_x = cos_1 * x
        s_rad, s_tan = 0.275 - SIN_60 * cos_x + 0.5 * y, -sin_1 * x
        s_z = 0.05 * SIN_60 + 0.5 * cos_x + SIN_60 * y
        if i == 0:
            b_x, b_y, b_z = R_PLATFORM * q[0], R_PLATFORM * q[3], R_PLATFORM * q[6]
            u_x, u_y = s_rad - p[0], s_tan - p[1]
        else:
            b_c, b_s = R_PLATFORM * c_r, R_PLATFORM * s_r
            b_x, b_y, b_z = b_c * q[0] + b_s * q[1], b_c * q[3] + b_s * q[4], b_c * q[6] + b_s * q[7]
            u_x, u_y = c_r * s_rad - s_r * s_tan - p[0], s_r * s_rad + c_r * s_tan - p[1]
        u_z = s_z - p[2]
        a_x, a_y, a_z = b_x - u_x, b_y - u_y, b_z - u_z
        jacobian += [a_x, a_y, a_z, b_y * a_z - b_z * a_y, b_z * a_x - b_x * a_z, b_x * a_y - b_y * a_x]
        jacobian += [q_x, q_y, q_z, u_y * q_z - u_z * q_y, u_z * q_x - u_x * q_z, u_x * q_y - u_y * q_x]
        for r_x, r_y, r_z in ((a_x, a_y, a_z), (q_x, q_y, q_z)):
            rad, tan = (r_x, r_y) if i == 0 else (c_r * r_x + s_r * r_y, c_r * r_y - s_r * r_x)
            on_x = 0.5 * r_z - SIN_60 * rad
            on_1 = 0.5 * rad + SIN_60 * r_z
            along_x = cos_1 * on_x - sin_1 * tan
            blocks += [-x * (cos_1 * tan + sin_1 * on_x), x * on_1 - y * along_x, x_3 * on_1 - y_3 * along_x]
    return jacobian, blocks


def inverse(m: Any, p: Components, q: Components, beta: Components) -> tuple[list[Any]]:
    """Nine joint angles."""
    theta: list[Any] = []
    for i, leg in enumerate(LEGS):
        c_r, s_r = leg.e_r[0], leg.e_r[1]
        radial, tangential = R_PLATFORM - L_REDUNDANT * m.cos(beta[i]), L_REDUNDANT * m.sin(beta[i])
        in_x, in_y = c_r * radial - s_r * tangential, s_r * radial + c_r * tangential
        s_x = p[0] + q[0] * in_x + q[1] * in_y
        s_y = p[1] + q[3] * in_x + q[4] * in_y
        s_z = p[2] + q[6] * in_x + q[7] * in_y
        rad, tan = c_r * s_x + s_r * s_y, c_r * s_y - s_r * s_x
        d_x, y = 0.5 * s_z - SIN_60 * rad - SHOULDER_X, 0.5 * rad + SIN_60 * s_z - SHOULDER_1
        square = d_x * d_x + tan * tan
        r = m.sqrt(square)
        cos_3 = (square + y * y - (L2 * L2 + L3 * L3)) * (0.5 / (L2 * L3))
        sin_3 = m.sqrt(1.0 - cos_3 * cos_3)
        k_1, k_2 = L2 + L3 * cos_3, L3 * sin_3
        theta += [
            m.atan2(-tan, d_x),
            m.atan2(y * k_1 - r * k_2, r * k_1 + y * k_2),
            m.acos(cos_3),
        ]
    return (theta,)


HAND_WRITTEN: dict[str, Callable[..., tuple[list[Any], ...]]] = {"w1": jacobians, "w2": inverse}
