"""W3 and W4: the forward kinematics of arrangement (a), written apart from the project's derivation.

W3 is solved by ``numpy.roots`` from the sextic of an equilateral platform with equal links,
|z_2|^2 |z_3|^2 |z_3 - z_2|^2 = 4 l^2 (z_2 x z_3)^2.  W4 is one Newton step, for the thesis' nine unknowns,
(3.7) to (3.9), and for the three that are left in the platform's plane; a back end needs
``solve(matrix, vector)`` for it.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from benchmarks.formulas import Value, Vec, add, columns, cross, dot, scale, sub
from benchmarks.robot import L_REDUNDANT, LEGS, R_PLATFORM

CORNERS = [[R_PLATFORM * leg.e_r[0], R_PLATFORM * leg.e_r[1]] for leg in LEGS]
"""b_i in the platform's plane."""


# -- W3 ------------------------------------------------------------------------------------------------------


def every_solution(inputs: list[Any], roots: list[Any] | None = None) -> list[Any]:
    """Counts, positions, orientations and redundant angles, in the order of det J, 0 behind the last."""
    (s,) = inputs
    if roots is None:
        roots = [np.roots(sextic(points)) for points in s]
    n = len(s)
    found = [np.zeros((n, 1)), np.zeros((n, 6, 3)), np.zeros((n, 6, 3, 3)), np.zeros((n, 6, 3))]
    for k in range(n):
        solutions = _solutions(s[k], roots[k])
        found[0][k] = len(solutions)
        for place, (_, *values) in enumerate(solutions):
            for array, value in zip(found[1:], values, strict=True):
                array[k, place] = value
    return found


def _plane(s: Any) -> tuple[Any, Any]:
    """[x_1, y_1, z_1], (3.1) to (3.3), and the end points seen from S_1."""
    x, z = s[1] - s[0], np.cross(s[1] - s[0], s[2] - s[0])
    x, z = x / np.linalg.norm(x), z / np.linalg.norm(z)
    axes = np.stack([x, np.cross(z, x), z], axis=1)
    return axes, ((s - s[0]) @ axes)[:, :2]


def without_wrap(beta: Any) -> Any:
    """Angles at the ends of (-pi, pi], which rounding may put at either, at the upper one."""
    return np.where(beta < 1e-6 - np.pi, beta + 2 * np.pi, beta)


def sextic(s: Any) -> Any:
    """Coefficients in tan(phi/2), the highest power first."""
    _, r = _plane(s)
    b = np.array(CORNERS, float)
    d = b - b[0]

    def linear(constant: float, cosine: float, sine: float) -> Any:  # highest power of T first
        return np.array([constant - cosine, 2 * sine, constant + cosine])

    def square(u: Any, v: Any) -> Any:  # |R u - v|^2
        return linear(u @ u + v @ v, -2 * (u @ v), -2 * (u[0] * v[1] - u[1] * v[0]))

    z_2, z_3, z_23 = square(d[1], r[1]), square(d[2], r[2]), square(d[2] - d[1], r[2] - r[1])
    cross_d, cross_r = np.linalg.det(d[1:]), np.linalg.det(r[1:])
    mixed = d[1] @ r[2] - d[2] @ r[1]
    turned = np.linalg.det([d[1], r[2]]) + np.linalg.det([r[1], d[2]])
    D = linear(cross_d + cross_r, -turned, mixed)
    one = np.array([1.0, 0.0, 1.0])
    sixth = np.convolve(np.convolve(z_2, z_3), z_23)
    return sixth - 4 * L_REDUNDANT**2 * np.convolve(np.convolve(D, D), one)


def _solutions(s: Any, roots: Any) -> list[tuple[Any, ...]]:
    axes, r = _plane(s)
    b = np.array(CORNERS, float)
    d = b - b[0]
    polynomial = sextic(s)
    found = []
    slope = np.polyder(polynomial)
    for root in roots:
        if abs(root.imag) > 1e-7 * (1 + abs(root.real)):
            continue
        T = root.real
        for _ in range(3):
            T -= np.polyval(polynomial, T) / np.polyval(slope, T)
        phi = 2 * np.arctan(T)
        R = np.array([[np.cos(phi), -np.sin(phi)], [np.sin(phi), np.cos(phi)]])
        z = d @ R.T - r
        if abs(np.linalg.det(z[1:])) < 1e-9:
            continue
        a_1 = np.linalg.solve(2 * z[1:], -np.sum(z[1:] ** 2, axis=1))
        a = a_1 + z
        if np.abs(np.linalg.norm(a, axis=1) - L_REDUNDANT).max() > 1e-6:
            continue
        Q = axes @ np.block([[R, np.zeros((2, 1))], [np.zeros((1, 2)), np.eye(1)]])
        p = s[0] + axes[:, :2] @ (a_1 - R @ b[0])
        u = -a @ R  # from B_i to S_i in the platform frame
        e_r = b / R_PLATFORM
        beta = without_wrap(np.arctan2(e_r[:, 0] * u[:, 1] - e_r[:, 1] * u[:, 0], -np.sum(e_r * u, axis=1)))
        local = b + u
        lines = np.column_stack([a @ R, b[:, 0] * (a @ R)[:, 1] - b[:, 1] * (a @ R)[:, 0]])
        normal = np.column_stack([np.ones(3), local[:, 1], -local[:, 0]])
        found.append((np.linalg.det(lines) * np.linalg.det(normal), p, Q, beta))
    return sorted(found, key=lambda solution: solution[0])


# -- W4 ------------------------------------------------------------------------------------------------------


def _end_points(s: Vec) -> list[Vec]:
    return [list(s[3 * i : 3 * i + 3]) for i in range(3)]


def _unit(ops: Any, v: Vec) -> Vec:
    inverse = 1 / ops.sqrt(dot(v, v))
    return [inverse * x for x in v]


def nine_step(ops: Any, s: Vec, p: Vec, q: Vec) -> tuple[Vec, Vec]:
    """F'(X) dX = -F(X) for X = (q_x, q_y, p), (3.4) to (3.8)."""
    ends = _end_points(s)
    q_x, q_y, _ = columns(q)
    q_z = _unit(ops, cross(sub(ends[1], ends[0]), sub(ends[2], ends[0])))
    zero: Vec = [0, 0, 0]
    rows: list[Vec] = []
    values: Vec = []
    for (b_x, b_y), end in zip(CORNERS, ends, strict=True):
        a = sub(add(p, scale(b_x, q_x), scale(b_y, q_y)), end)
        rows.append([*scale(2 * b_x, a), *scale(2 * b_y, a), *scale(2, a)])
        values.append(dot(a, a) - L_REDUNDANT**2)
    rows.append([*zero, *zero, *scale(-1, q_z)])
    values.append(dot(sub(ends[0], p), q_z))
    rows += [
        [*scale(2, q_x), *zero, *zero],
        [*zero, *scale(2, q_y), *zero],
        [*q_y, *q_x, *zero],
        [*q_z, *zero, *zero],
        [*zero, *q_z, *zero],
    ]
    values += [dot(q_x, q_x) - 1, dot(q_y, q_y) - 1, dot(q_x, q_y), dot(q_x, q_z), dot(q_y, q_z)]
    step = ops.solve(rows, values)
    x, y, position = (
        [value - change for value, change in zip(old, step[place : place + 3], strict=True)]
        for old, place in ((q_x, 0), (q_y, 3), (p, 6))
    )
    return position, [entry for row in zip(x, y, q_z, strict=True) for entry in row]


def planar_step(ops: Any, s: Vec, p: Vec, q: Vec) -> tuple[Vec, Vec]:
    """The same for phi and B_1 - S_1 in the platform's plane."""
    ends = _end_points(s)
    q_x, q_y, _ = columns(q)
    s_12, s_13 = sub(ends[1], ends[0]), sub(ends[2], ends[0])
    x, z = _unit(ops, s_12), _unit(ops, cross(s_12, s_13))
    y = cross(z, x)
    cosine, sine = dot(x, q_x), dot(y, q_x)
    norm = 1 / ops.sqrt(cosine * cosine + sine * sine)
    cosine, sine = cosine * norm, sine * norm
    arm = sub(add(p, scale(CORNERS[0][0], q_x), scale(CORNERS[0][1], q_y)), ends[0])
    a_1 = [dot(x, arm), dot(y, arm)]
    rows: list[Vec] = []
    values: Vec = []
    for k, point in enumerate(([0, 0], [dot(x, s_12), 0], [dot(x, s_13), dot(y, s_13)])):
        d = [CORNERS[k][j] - CORNERS[0][j] for j in range(2)]
        turned: list[Value] = [cosine * d[0] - sine * d[1], sine * d[0] + cosine * d[1]]
        a = sub(add(a_1, turned), point)
        rows.append([turned[0] * a[1] - turned[1] * a[0], *a])
        values.append((dot(a, a) - L_REDUNDANT**2) * 0.5)
    step = ops.solve(rows, values)
    turn, a_1 = -step[0], [a_1[0] - step[1], a_1[1] - step[2]]
    c, t = ops.cos(turn), ops.sin(turn)
    cosine, sine = cosine * c - sine * t, sine * c + cosine * t
    next_x, next_y = add(scale(cosine, x), scale(sine, y)), sub(scale(cosine, y), scale(sine, x))
    b = CORNERS[0]
    local = [a_1[0] - (cosine * b[0] - sine * b[1]), a_1[1] - (sine * b[0] + cosine * b[1])]
    position = add(ends[0], scale(local[0], x), scale(local[1], y))
    return position, [entry for row in zip(next_x, next_y, z, strict=True) for entry in row]
