"""Paths: poses, twists and their rates between way-points, and what is no path."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from krhpr import trajectory
from krhpr.trajectory import Interpolation, PathError, way_points

TIMES = [0.0, 1.0, 2.5, 3.0, 4.0]
P = np.random.default_rng(1).normal(size=(5, 3))
Q = Rotation.from_rotvec(np.random.default_rng(2).normal(size=(5, 3))).as_matrix()


@pytest.mark.parametrize("interpolation", list(Interpolation))
def test_rates_are_derivatives_of_the_poses(interpolation: Interpolation) -> None:
    path = way_points(TIMES, P, Q, interpolation)
    at, h = np.array([0.3, 1.7, 2.8, 3.9]), 1e-5
    here, before, after = path.at(at), path.at(at - h), path.at(at + h)
    np.testing.assert_allclose(here.twist[:, :3], (after.p - before.p) / (2 * h), atol=1e-6)
    Q_dot = (after.Q - before.Q) / (2 * h)
    Omega = Q_dot @ np.swapaxes(here.Q, 1, 2)
    omega = np.stack([Omega[:, 2, 1], Omega[:, 0, 2], Omega[:, 1, 0]], axis=1)
    np.testing.assert_allclose(here.twist[:, 3:], omega, atol=1e-6)
    np.testing.assert_allclose(here.twist_rate, (after.twist - before.twist) / (2 * h), atol=1e-4)
    ends = path.at(TIMES)
    np.testing.assert_allclose(ends.p, P, atol=1e-12)
    np.testing.assert_allclose(ends.Q, Q, atol=1e-12)


def test_a_planar_path() -> None:
    path = way_points([0, 1, 2], [[0, 0], [1, 0], [1, 1]], [0.0, 4.0, 7.0])
    found = path.at([0.5, 1.0])
    assert path.planar and found.Q[1] == 4.0 and found.twist.shape == (2, 3)
    h = 1e-5
    slope = (path.at([0.5 + h]).Q - path.at([0.5 - h]).Q) / (2 * h)
    np.testing.assert_allclose(found.twist[0, 2], slope[0], atol=1e-6)


def test_paths_of_the_thesis() -> None:
    t1, t2 = trajectory.translation(), trajectory.tilt()
    assert np.allclose(t1.at([3.0]).p, [[0.15, 0, 0.35]]) and np.allclose(t1.at([1.0]).twist[0, 0], 0.05)
    halfway = t2.at([2.0])
    assert np.allclose(Rotation.from_matrix(halfway.Q).as_rotvec(), [[0, np.radians(40), 0]])
    assert np.allclose(halfway.twist[0], [0, 0, 0, 0, np.radians(20), 0])
    example = trajectory.example()
    assert example.p.shape == (721, 3) and np.allclose(example.at([0.0, 36.0]).p, [[0, 0, 0.35]] * 2)
    assert np.linalg.norm(example.p[:, :2], axis=1).max() == pytest.approx(0.1)


def test_a_function_of_time() -> None:
    def pose(time: float) -> tuple[Any, Any]:
        return [np.sin(time), 0, time], Rotation.from_rotvec([0, 0, time**2]).as_matrix()

    found = trajectory.function_of_time(pose, 2.0).at([1.3])
    np.testing.assert_allclose(found.twist[0], [np.cos(1.3), 0, 1, 0, 0, 2.6], atol=1e-5)


@pytest.mark.parametrize(
    ("times", "p", "Q", "message"),
    [
        ([0.0], [[0, 0, 0]], [np.eye(3)], "1 way-points; a path takes two or more"),
        ([0.0, 0.0], [[0, 0, 0]] * 2, [np.eye(3)] * 2, "times must increase; way-point 2 is at 0 s"),
        ([0, 1, 0.5], [[0, 0, 0]] * 3, [np.eye(3)] * 3, "way-point 3 is at 0.5 s and the one before at 1 s"),
        ([0, 1], [[0, 0, 0]] * 3, [np.eye(3)] * 2, r"p has shape \(3, 3\), expected \(2, 3\)"),
        ([0, 1], [[0, 0, np.nan]] * 2, [np.eye(3)] * 2, "p has values that are not finite"),
        ([0, 1], [[0, 0, 0]] * 2, [np.eye(3), 2 * np.eye(3)], "Q of way-point 2 is not a rotation matrix"),
        ([0, 1], [[0, 0, 0]] * 2, [np.eye(3), np.diag([1, 1, -1])], "Q of way-point 2 is not a rotation"),
    ],
)
def test_what_is_no_path(times: Any, p: Any, Q: Any, message: str) -> None:
    with pytest.raises(PathError, match=message):
        way_points(times, p, Q)
