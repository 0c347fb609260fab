"""What tests of the grasping robots share: robots, configurations, the prototype's object."""

from __future__ import annotations

import json
from typing import Any

import numpy as np

import krhpr
from krhpr import GraspingRobot
from tests.support import ROOT

Array = np.ndarray[Any, Any]

REFERENCE = json.loads((ROOT / "tests" / "reference" / "grasp_planar.json").read_text(encoding="utf-8"))
ROBOTS = ("planar_grasp_prr", "planar_grasp_rpr")
E = np.array([[0.0, -1.0], [1.0, 0.0]])


def rotation(angle: float) -> Array:
    return np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])


def cross(a: Array, b: Array) -> Any:
    return a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]


def of_reference(case: dict[str, Any], backend: str) -> GraspingRobot:
    """The robot of a reference case, in millimetres."""
    robot = krhpr.load_grasping(f"planar_grasp_{case['kind'].lower()}", backend=backend)
    sizes = case["params"]
    if case["kind"] == "PRR":
        return robot.with_geometry(l_1=sizes["link"], l_2=sizes["link"], l_j=(sizes["b"], sizes["l"]))
    a = np.array(sizes["anchors"], dtype=float)
    return robot.with_geometry(
        x_1=a[::2, 0], y_1=a[::2, 1], x_2=a[1::2, 0], y_2=a[1::2, 1], l_j=(sizes["b"], sizes["l"])
    )


def different(name: str, backend: str = "numpy") -> GraspingRobot:
    """A robot whose sub-legs and jaws all differ."""
    robot = krhpr.load_grasping(name, backend=backend)
    if name.endswith("prr"):
        return robot.with_geometry(
            x_1=(0.01, -0.02),
            y_1=(-0.01, 0.015),
            x_2=(0.02, 0.03),
            y_2=(0.005, -0.02),
            slide_1=(0.2, -0.3),
            slide_2=(-0.15, 0.1),
            l_1=(0.12, 0.13),
            l_2=(0.11, 0.14),
            l_j=(0.04, 0.05),
        )
    return robot.with_geometry(x_1=(-0.14, -0.07), y_1=(0.01, -0.02), l_j=(0.04, 0.05))


def configurations(robot: GraspingRobot, count: int, seed: int = 1) -> tuple[Array, Array, Array, Array]:
    """Pivots, angles, end points and joints, away from singularities."""
    rng = np.random.default_rng(seed)
    pivot = np.array([0.0, 0.09]) + rng.uniform(-0.02, 0.02, (count, 2))
    angles = np.array([0.8, 2.3]) + rng.uniform(-0.35, 0.35, (count, 2))
    s = robot.end_points(pivot, angles)
    theta = robot.inverse(pivot, angles)
    assert np.isfinite(theta).all()
    return pivot, angles, s, theta
