"""Indices of a robot: values of the thesis' robots, lengths of slides, directions."""

from __future__ import annotations

import json
from pathlib import Path

import casadi as ca
import numpy as np
import pytest

import krhpr
from krhpr.indices import directions

CHAPTER_4 = json.loads((Path(__file__).parent / "reference" / "chapter4.json").read_text(encoding="utf-8"))
ROBOTS = ("spatial_rrr_a", "spatial_prr_b", "spatial_tripteron_c", "spatial_rrrr_a", "planar_rp_a")


def home(name: str) -> tuple[krhpr.Robot, tuple[np.ndarray, ...]]:
    robot = krhpr.load(name)
    p, Q, redundant = (np.array(x) for x in robot.home)
    moved = redundant * np.array([1.0, 1.1, 0.9])
    return robot, (p, Q, robot.end_points(p, Q, moved), robot.inverse(p, Q, moved))


@pytest.mark.parametrize("row", CHAPTER_4["cases"], ids=lambda row: str(row["beta_deg"]))
def test_chapter_4(row: dict) -> None:
    robot = krhpr.load("spatial_rrr_a")
    p, Q, beta = np.array(row["p"]) / 1000, np.array(row["Q"]), np.radians(row["beta_deg"])
    found = robot.indices(p, Q, robot.end_points(p, Q, beta), robot.inverse(p, Q, beta))
    wanted = [row["eta1_mm"] / 1000, row["eta2"], row["eta3"]]
    np.testing.assert_allclose(found[:3], wanted, rtol=1e-9)
    assert found.condition.shape == (3,) and found.condition.max() <= found.eta_3 * (1 + 1e-12)


@pytest.mark.parametrize("name", ROBOTS)
def test_directions_belong_to_the_indices(name: str) -> None:
    robot, at = home(name)
    found = directions(robot, *at, characteristic_length=0.3)
    indices = robot.indices(*at, characteristic_length=0.3)
    factors = np.where(robot.angular, 1.0, 0.3)
    d = len(at[0])
    for direction, rates, eta, part in (
        (found.position, found.position_rates, indices.eta_1, slice(None, d)),
        (found.rotation, found.rotation_rates, indices.eta_2, slice(d, None)),
    ):
        assert np.isclose(np.linalg.norm(rates), 1) and np.isclose(np.linalg.norm(direction), 1)
        twist = robot.twist(*at, rates * factors)
        np.testing.assert_allclose(np.abs(twist[part] @ direction), eta, rtol=1e-9)
    M = robot.subleg_jacobian(at[2], at[3]) * factors
    pulled = np.linalg.norm(np.einsum("lij,li->lj", M, found.weak), axis=-1)
    np.testing.assert_allclose(pulled, found.weak_values, rtol=1e-9)
    np.testing.assert_allclose(
        np.linalg.svd(M, compute_uv=False)[:, 0] / found.weak_values, indices.condition, rtol=1e-9
    )


def test_the_length_matters_where_something_slides() -> None:
    robot, at = home("spatial_prr_b")
    assert robot.indices(*at, characteristic_length=1.0).eta_3 == robot.indices(*at).eta_3
    longer = robot.indices(*at, characteristic_length=10.0)
    assert np.isclose(longer.eta_3, 10 * robot.indices(*at).eta_3)
    turning, there = home("spatial_rrr_a")
    assert turning.indices(*there, characteristic_length=0.1).eta_2 == turning.indices(*there).eta_2


def test_singularities_have_a_status_and_no_indices() -> None:
    robot, (p, Q, s, theta) = home("spatial_rrr_a")
    assert np.isnan(directions(robot, p, Q, s, theta * np.nan).position).all()
    beta = np.full(3, np.pi)
    ends = robot.end_points(p, Q, beta)
    found, status = robot.indices(p, Q, ends, robot.inverse(p, Q, beta), status=True)
    assert np.isnan(np.concatenate([found[:3], found.condition])).all()
    assert status == krhpr.Status.SINGULAR_IN_PLANE
    straight = theta.copy()
    straight[0, 2] = 0.0
    for function in (robot.indices, robot.index_bounds):
        found, status = function(p, Q, robot.subleg_forward(straight), straight, status=True)
        assert status == krhpr.Status.SINGULAR_LEG_1 and np.isnan(found.eta_3)
        straight[0, 2] = 1e-6  # beside it there is an answer
        found, status = function(p, Q, robot.subleg_forward(straight), straight, status=True)
        assert status == 0 and 1e5 < found.eta_3 < 1e9
        straight[0, 2] = 0.0


def test_bounds_have_slopes_at_poses_with_the_symmetry_of_the_legs() -> None:
    """There the largest singular value is a double one."""
    robot = krhpr.load("spatial_rrr_a")
    p, Q, beta = (np.array(x) for x in robot.home)
    free, functions = ca.SX.sym("beta", 3), robot.casadi
    s = functions.end_points(p, Q, free)
    theta = functions.inverse(p, Q, free, robot.mode_signs())
    etas = ca.vertcat(*functions.index_bounds(p, Q, s, theta), *functions.indices(p, Q, s, theta)[:3])
    slopes = ca.Function("slopes", [free], [etas, ca.jacobian(etas, free)])
    _, slope = slopes(beta)
    assert np.isfinite(slope.full()).all()
    h = 1e-6
    for leg in range(3):
        step = h * np.eye(3)[leg]
        difference = (slopes(beta + step)[0] - slopes(beta - step)[0]).full()[:3, 0] / (2 * h)
        np.testing.assert_allclose(slope.full()[:3, leg], difference, atol=1e-7)
