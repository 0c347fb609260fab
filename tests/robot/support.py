"""Robots of every kind, poses inside their workspaces, and arguments of any function."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np

import krhpr
from krhpr import Robot
from krhpr.defaults import SIGNS

ROBOTS = ("spatial_rrr_a", "spatial_r_fivebar_a", "spatial_rrr_c", "planar_rr_a")
"""One of each kind: open and closed legs, redundant links and slides, space and plane."""
BACKENDS = ("numpy", "compiled")
CASES = [(identifier, name) for identifier in ROBOTS for name in krhpr.load(identifier).functions]
"""Every function of every robot."""

Array = np.ndarray[Any, Any]


@dataclass(frozen=True)
class Pose:
    """A pose inside the working box, with the redundant coordinates."""

    p: Array
    orientation: Array
    redundant: Array

    def __iter__(self) -> Iterator[Array]:
        return iter((self.p, self.orientation, self.redundant))


def rotation(angles: Array) -> Array:
    """Rotations (..., 3, 3) by the angles (..., 3) about z, y and x."""
    cosines, sines = np.moveaxis(np.cos(angles), -1, 0), np.moveaxis(np.sin(angles), -1, 0)
    zero, one = np.zeros_like(sines[0]), np.ones_like(sines[0])
    (cz, cy, cx), (sz, sy, sx) = cosines, sines
    z = np.stack([cz, -sz, zero, sz, cz, zero, zero, zero, one], -1)
    y = np.stack([cy, zero, sy, zero, one, zero, -sy, zero, cy], -1)
    x = np.stack([one, zero, zero, zero, cx, -sx, zero, sx, cx], -1)
    Z, Y, X = (part.reshape((*part.shape[:-1], 3, 3)) for part in (z, y, x))
    return Z @ Y @ X


def poses(robot: Robot, *batch: int, seed: int = 0) -> Pose:
    """Random poses near the middle of the workspace."""
    random = np.random.default_rng(seed)
    slides = robot.documentation["redundant"][0][0] == "d"
    middle, spread = (0.12, 0.03) if slides else (1.5, 0.3)
    redundant = middle + spread * random.uniform(-1, 1, (*batch, 3))
    if robot.planar:
        return Pose(0.03 * random.normal(size=(*batch, 2)), 0.1 * random.normal(size=batch), redundant)
    p = np.array([0, 0, 0.45]) + 0.02 * random.normal(size=(*batch, 3))
    return Pose(p, rotation(0.1 * random.normal(size=(*batch, 3))), redundant)


def configuration(robot: Robot, *batch: int, seed: int = 0) -> tuple[Array, Array, Array, Array]:
    """(p, Q, s, theta) of random poses."""
    pose = poses(robot, *batch, seed=seed)
    return pose.p, pose.orientation, robot.end_points(*pose), robot.inverse(*pose)


def results(answer: Any) -> tuple[Array, ...]:
    return answer if isinstance(answer, tuple) else (answer,)


def assert_same(first: Any, second: Any, tolerance: float = 0.0) -> None:
    for one, other in zip(results(first), results(second), strict=True):
        scale = max(1.0, np.abs(one[np.isfinite(one)]).max(initial=0))
        np.testing.assert_allclose(one, other, rtol=0, atol=tolerance * scale)


@cache
def load(identifier: str, backend: str) -> Robot:
    return krhpr.load(identifier, backend=backend)


def arguments(robot: Robot, function: str, *batch: int, seed: int = 0) -> tuple[Array, ...]:
    """Sensible arguments of any function, each with the same batch dimensions."""
    random = np.random.default_rng(seed)
    p, Q, s, theta = configuration(robot, *batch, seed=seed)
    redundant = poses(robot, *batch, seed=seed).redundant
    signs = np.broadcast_to(robot.mode_signs(), (*batch, *robot.mode_signs().shape))
    known = {"p": p, "Q": Q, "phi": Q, "s": s, "theta": theta, "redundant": redundant, "mode": signs}
    known["theta_near"] = theta + 0.1
    known |= dict.fromkeys(SIGNS, np.ones(batch))
    known |= {"p_near": p, "Q_near": Q, "phi_near": Q, "tolerance": np.full(batch, 0.01)}
    known["characteristic_length"] = np.full(batch, 0.3)
    known["box"] = np.broadcast_to(np.radians([30.0, 150.0]), (*batch, 3, 2))
    known |= {"normal_forces": np.ones((*batch, 3)), "friction": np.full(batch, 1e6)}
    known["weights"] = np.broadcast_to([1000.0, 1000.0, 1000.0], (*batch, 3))
    if robot.assemblies:
        shape = robot.assembly_signs().shape
        known["assembly"] = np.broadcast_to(robot.assembly_signs(), (*batch, *shape))
    known |= {f"measured of {count}": redundant[..., :count] for count in (1, 2, 3)}
    return tuple(
        known[f"measured of {port.shape[0]}"]
        if port.name == "measured"
        else known[port.name]
        if port.name in known
        else random.normal(size=(*batch, *port.shape))
        for port in robot.signature(function).inputs
    )
