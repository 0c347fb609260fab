"""Statics from Newton's laws alone: every body's equilibrium, with an unknown wrench in every joint.

Nothing here knows velocities, Jacobians or virtual work.  A joint's wrench is what its inner body applies to
its outer one, [force, moment about the joint]; where the joint is free to move it transmits nothing.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

Array = np.ndarray[Any, Any]
GROUND = "ground"


def moment(arm: Array, force: Array) -> Array:
    """arm x force: a vector in space, one number in the plane."""
    return (
        np.atleast_1d(np.cross(arm, force))
        if len(arm) == 3
        else np.array([arm[0] * force[1] - arm[1] * force[0]])
    )


@dataclass
class Joint:
    """A joint between two bodies; `free` are wrenches that do work on its motions, which it does not bear,
    and `actuated` the one that its motor gives.
    """

    inner: str
    outer: str
    at: Array
    free: Sequence[Array] = ()
    actuated: Array | None = None


@dataclass
class Assembly:
    """Bodies, the joints between them, and loads [force, moment about the point] on bodies."""

    dimension: int
    joints: list[Joint] = field(default_factory=list)
    loads: list[tuple[str, Array, Array]] = field(default_factory=list)

    def turning(self, axis: Array | None = None) -> Array:
        """The wrench of a moment about an axis (the plane's normal in the plane)."""
        return np.concatenate([np.zeros(self.dimension), [1.0] if axis is None else axis])

    def sliding(self, along: Array) -> Array:
        """The wrench of a force along a direction."""
        return np.concatenate([along, np.zeros(3 if self.dimension == 3 else 1)])

    def solve(self) -> tuple[Array, list[Array]]:
        """What the motors give, in the order of the joints, and every joint's wrench.

        Loops that bear more than they need leave some wrenches open, but no motor's.
        """
        bodies = sorted({body for j in self.joints for body in (j.inner, j.outer)} - {GROUND})
        size = 6 if self.dimension == 3 else 3
        row_of = {body: size * index for index, body in enumerate(bodies)}
        free = sum(len(j.free) for j in self.joints)
        A = np.zeros((size * len(bodies) + free, size * len(self.joints)))
        b = np.zeros(len(A))
        below = size * len(bodies)
        for index, joint in enumerate(self.joints):
            columns = slice(size * index, size * (index + 1))
            moved = self._about_origin(joint.at)
            for body, sign in ((joint.outer, 1.0), (joint.inner, -1.0)):
                if body != GROUND:
                    A[row_of[body] : row_of[body] + size, columns] += sign * moved
            for direction in joint.free:
                A[below, columns] = direction
                below += 1
        for body, at, wrench in self.loads:
            b[row_of[body] : row_of[body] + size] -= self._about_origin(at) @ wrench
        # moments beside forces: lengths are tenths of a metre
        x, *_ = np.linalg.lstsq(A, b, rcond=1e-12)
        assert np.abs(A @ x - b).max() < 1e-11 * max(1.0, np.abs(x).max())
        wrenches = list(x.reshape(-1, size))
        motors = [
            joint.actuated @ wrench
            for joint, wrench in zip(self.joints, wrenches, strict=True)
            if joint.actuated is not None
        ]
        return np.array(motors), wrenches

    def _about_origin(self, at: Array) -> Array:
        """From [force, moment about a point] to [force, moment about the origin]."""
        d = self.dimension
        matrix = np.eye(6 if d == 3 else 3)
        for k in range(d):
            matrix[d:, k] += moment(at, np.eye(d)[k])
        return matrix
