"""Directions of the performance indices: which motion is amplified most, and which leg moves worst.

`robot.indices` gives the indices themselves, in every language; singular vectors come from NumPy's
decomposition of the generated Jacobians.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from krhpr.defaults import NUMBERS
from krhpr.robot import Robot

Floats = NDArray[np.float64]


class Directions(NamedTuple):
    """Unit singular vectors that belong to the indices; each may be turned round."""

    position: Floats
    """Of O' (..., 3) in the base frame: it moves eta_1 for joint rates of norm one; (..., 2) in the plane."""
    position_rates: Floats
    """The joint rates that move it so, (..., 3, actuators)."""
    rotation: Floats
    """Axis (..., 3) in the base frame about which the platform turns by eta_2; (..., 1) in the plane."""
    rotation_rates: Floats
    """The joint rates that turn it so, (..., 3, actuators)."""
    weak: Floats
    """For each leg (..., 3, 3) the direction in which S_i moves least; (..., 3, 2) in the plane."""
    weak_values: Floats
    """How far it then moves for joint rates of norm one, the least singular values of the M_i (..., 3); m."""


def directions(
    robot: Robot,
    p: ArrayLike,
    Q: ArrayLike,
    s: ArrayLike,
    theta: ArrayLike,
    characteristic_length: float | None = None,
) -> Directions:
    """Singular vectors of both parts of U = J^-1 K, and those of the M_i that are nearest to a singularity.

    Args:
        robot: any.
        p: position of O' (..., 3), or (..., 2) in the plane; m.
        Q: orientation (..., 3, 3), or phi (...) in the plane.
        s: end points of the sub-legs (..., 3, 3).
        theta: actuated joints (..., 3, actuators).
        characteristic_length: displacement of a slide that counts as much as a radian, m; 1 unless given.
            Rates of slides are given over it.

    Returns:
        The directions, NaN where there is no answer.
    """
    length = NUMBERS["characteristic_length"][0] if characteristic_length is None else characteristic_length
    factors = np.where(robot.angular, 1.0, length)
    J, K = (np.asarray(matrix) for matrix in robot.jacobians(p, Q, s, theta))
    M = np.asarray(robot.subleg_jacobian(s, theta)) * factors
    there = np.isfinite(J).all(axis=(-2, -1)) & np.isfinite(K).all(axis=(-2, -1))
    there &= np.abs(np.linalg.det(np.where(np.isfinite(J), J, 0.0))) > 0
    filled = np.where(there[..., None, None], J, np.eye(J.shape[-1]))
    U = np.linalg.solve(filled, np.where(there[..., None, None], K, 0.0)) * np.tile(factors, 3)
    d = M.shape[-2]
    (position, rates), (rotation, turning) = _first(U[..., :d, :]), _first(U[..., d:, :])
    left, values, _ = np.linalg.svd(np.where(np.isfinite(M), M, 0.0))
    shape = (*rates.shape[:-1], 3, len(factors))
    whole = (
        position,
        rates.reshape(shape),
        rotation,
        turning.reshape(shape),
        left[..., :, -1],
        values[..., -1],
    )
    return Directions(*(_masked(array, there) for array in whole))


def _first(part: Floats) -> tuple[Floats, Floats]:
    """The left and the right singular vector of the largest singular value."""
    left, _, right = np.linalg.svd(part, full_matrices=False)
    return left[..., :, 0], right[..., 0, :]


def _masked(array: Floats, there: NDArray[np.bool_]) -> Floats:
    mask = there.reshape(there.shape + (1,) * (array.ndim - there.ndim))
    return np.where(mask, array, np.nan)
