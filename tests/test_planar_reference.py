"""Planar platforms held at given end points: all poses of the reference, through the public calls."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
import pytest

import krhpr
from tests.support import ROOT

CASES = json.loads((ROOT / "tests" / "reference" / "planar_fk.json").read_text(encoding="utf-8"))["cases"]
ROBOTS = [name for name in krhpr.catalogue() if name.startswith("planar") and name.endswith("_a")]


@pytest.mark.parametrize("identifier", ROBOTS)
@pytest.mark.parametrize("case", CASES, ids=lambda case: case["name"])
def test_every_pose_holds_the_end_points(identifier: str, case: dict[str, Any]) -> None:
    """The references have fifteen digits, and twelve of them in lengths of a hundred."""
    b, s = np.array(case["b"]), np.array(case["r"])
    robot = krhpr.load(identifier, backend="numpy").with_geometry(
        platform_azimuth=np.arctan2(b[:, 1], b[:, 0]), R_p=np.hypot(*b.T), l_r=case["l"]
    )
    poses, beta = np.array(case["poses"]), np.array(case["beta"])
    assert len(poses) == len(beta) >= 2
    p, phi = poses[:, :2], poses[:, 2]
    scale = np.abs(s).max()
    np.testing.assert_allclose(
        robot.end_points(p, phi, beta), np.stack([s] * len(p)), rtol=0, atol=1e-13 * scale
    )
    found = robot.redundant_coordinates(p, phi, s)
    np.testing.assert_allclose(np.exp(1j * found), np.exp(1j * beta), rtol=0, atol=1e-12)
    residual = robot.constraints(p, phi, s)
    np.testing.assert_allclose(residual, 0.0, rtol=0, atol=1e-12 * scale**2)
