"""Consistent random inputs: poses near the reference pose, joint angles from the inverse kinematics."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from benchmarks.forward import every_solution
from benchmarks.robot import HYBRID, L_REDUNDANT, LEGS, R_PLATFORM
from benchmarks.workloads import WORKLOADS, Workload

Floats = NDArray[np.float64]


class NumpyOps:
    """NumPy under the names that ``formulas`` uses."""

    sin, cos, sqrt, atan2, acos = np.sin, np.cos, np.sqrt, np.arctan2, np.arccos

    @staticmethod
    def solve(rows: list[list[Any]], values: list[Any]) -> list[Any]:
        """Linear equations, one system for each element of the batch."""
        entries = np.broadcast_arrays(*(x for row in rows for x in row), *values)
        n = len(values)
        matrix = np.stack(entries[: n * n], axis=-1).reshape(-1, n, n)
        right = np.stack(entries[n * n :], axis=-1)[..., None]
        return list(np.linalg.solve(matrix, right)[..., 0].T)


def evaluate(workload: Workload, inputs: list[Floats], form: str | None = None) -> list[Floats]:
    """The formulas over a batch, with NumPy component arrays: (n, ...) in, (n, ...) out."""
    if workload.reference is not None:
        return workload.reference(inputs)
    components = [list(x.reshape(len(x), -1).T) for x in inputs]
    function = workload.forms[form or next(iter(workload.forms))]
    outputs = function(NumpyOps, *components)
    return [
        np.stack(flat, axis=-1).reshape(-1, *array.shape)
        for flat, array in zip(outputs, workload.outputs, strict=True)
    ]


def poses(rng: np.random.Generator, n: int) -> tuple[Floats, Floats, Floats]:
    """p near (0, 0, 0.35), rotations up to 30 degrees about any axis, beta from 60 to 120 degrees."""
    p = np.array([0.0, 0.0, 0.35]) + rng.uniform(-0.05, 0.05, (n, 3))
    axis = rng.normal(size=(n, 3))
    x, y, z = (axis / np.linalg.norm(axis, axis=1, keepdims=True)).T
    angle = rng.uniform(0.0, np.radians(30.0), n)
    zero = np.zeros(n)
    skew = np.stack([zero, -z, y, z, zero, -x, -y, x, zero], axis=-1).reshape(n, 3, 3)
    rotation = np.eye(3) + np.sin(angle)[:, None, None] * skew
    rotation += (1.0 - np.cos(angle))[:, None, None] * (skew @ skew)
    return p, rotation, rng.uniform(np.radians(60.0), np.radians(120.0), (n, 3))


def end_points(p: Floats, q: Floats, beta: Floats) -> Floats:
    """S_i in the base frame, (n, 3, 3), rows are legs."""
    e_r, e_t = np.array([leg.e_r for leg in LEGS], float), np.array([leg.e_t for leg in LEGS], float)
    in_platform = (R_PLATFORM - L_REDUNDANT * np.cos(beta))[..., None] * e_r
    in_platform = in_platform + (L_REDUNDANT * np.sin(beta))[..., None] * e_t
    s: Floats = p[:, None, :] + in_platform @ q.transpose(0, 2, 1)
    return s


def hybrid_angles(s: Floats) -> Floats:
    """Joint angles of R(RR-RRR) at S: upper crank outside, the recommended working mode; NaN out of reach."""
    theta = np.empty_like(s)
    for i, leg in enumerate(LEGS):
        d = s[:, i] - np.array(leg.c, float)
        d_x, d_t, y = (d @ np.array(v, float) for v in (leg.e_x, leg.e_t, leg.e_1))
        theta[:, i, 0] = np.arctan2(-d_t, d_x)
        reach = np.hypot(d_x, d_t) + 1j * y
        theta[:, i, 1] = np.angle(reach) + _triangle(HYBRID.l4, abs(reach), HYBRID.l6)
        u_1 = HYBRID.l4 * np.exp(1j * theta[:, i, 1])
        r = u_1 + (1.0 - HYBRID.l5 / HYBRID.l6) * (reach - u_1)
        theta[:, i, 2] = np.angle(r) + _triangle(HYBRID.l2, abs(r), HYBRID.l3)
    return theta


def _far_apart(s: Floats) -> Floats:
    """Zero where solutions are apart, NaN where two all but coincide: counts may differ there."""
    count, p, q, beta = every_solution([s])
    n = len(p)
    there = np.abs(p).max(axis=-1) > 0
    pairs = there[:, :, None] & there[:, None] & ~np.eye(6, dtype=bool)
    gaps, turns = (
        np.abs(x[:, :, None] - x[:, None]).max(axis=-1)
        for x in (np.concatenate([beta, p], axis=-1), q.reshape(n, 6, 9))
    )
    # where the end points' triangle is all but the platform's, it shifts and hardly turns: roots are close
    close = (pairs & ((gaps < 0.05) | (turns < 0.01))).any(axis=(1, 2))
    # solutions come in pairs: where one is missing it is beside another
    return np.where(close | (count[:, 0] % 2 == 1), np.nan, 0.0)


def _beside(rng: np.random.Generator, p: Floats, q: Floats) -> tuple[Floats, Floats]:
    """The pose before: a tenth of a millimetre and a tenth of a degree away."""
    a, b, c = rng.uniform(-1e-3, 1e-3, (3, len(p)))
    zero = np.zeros(len(p))
    small = np.stack([zero, -c, b, c, zero, -a, -b, a, zero], axis=-1).reshape(-1, 3, 3)
    return p + rng.uniform(-1e-4, 1e-4, p.shape), q @ (np.eye(3) + small + small @ small / 2)


def _triangle(a: float, b: Floats, opposite: float) -> Floats:
    """Angle between sides a and b of a triangle, from its third side."""
    return np.arccos((a * a + b * b - opposite * opposite) / (2.0 * a * b))


def draw(workload: Workload, n: int, seed: int = 20240) -> list[Floats]:
    """``n`` inputs of a workload, (n, ...) each; draws again where a leg cannot reach."""
    rng = np.random.default_rng(seed)
    p, q, beta = poses(rng, 2 * n)
    s = end_points(p, q, beta)
    with np.errstate(invalid="ignore"):
        (theta,) = evaluate(WORKLOADS["w2"], [p, q, beta])
        candidates = {
            "w1": [p, q, theta],
            "w2": [p, q, beta, theta],
            "w3": [s, _far_apart(s) if workload.key == "w3" else s],
            "w4": [s, *_beside(rng, p, q)],
            "w5": [s, hybrid_angles(s)],
        }[workload.key]
    good = np.all([np.isfinite(x).reshape(2 * n, -1).all(axis=1) for x in candidates], axis=0)
    if good.sum() < n:
        raise RuntimeError(f"{workload.key}: only {good.sum()} of {2 * n} random poses are in reach")
    return [np.ascontiguousarray(x[good][:n]) for x in candidates[: len(workload.inputs)]]
