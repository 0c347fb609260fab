"""The study of Section 4.3: minima by a search of their own, methods, and claims that can fail."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from scipy.optimize import minimize_scalar

import krhpr
from krhpr.study.figures import redundancy_figures
from krhpr.study.files import save_figures
from krhpr.study.redundancy import FACTORS, METHODS, Redundancy, redundancy
from krhpr.trajectory import Method


@cache
def found() -> Redundancy:
    return redundancy()


def eta_1(x: float, beta: float) -> float:
    """By the singular values of J^-1 K, from the Jacobians alone."""
    robot = krhpr.load("spatial_rrr_a")
    p, Q, redundant = np.array([x, 0.0, 0.35]), np.eye(3), np.full(3, beta)
    s, theta = robot.end_points(p, Q, redundant), robot.inverse(p, Q, redundant)
    J, K = robot.jacobians(p, Q, s, theta)
    return float(np.linalg.norm(np.linalg.solve(J, K)[:3], 2))


@pytest.mark.parametrize(("x", "right"), [(0.24, 146), (0.26, 159), (0.294, 158)])
def test_the_two_minima(x: float, right: int) -> None:
    left, second = found().translation.minima("eta_1", x)
    assert second == right
    for angle in (left, second):
        bounds = np.radians([angle - 4, angle + 4])
        best = minimize_scalar(lambda beta: eta_1(x, beta), bounds=bounds, method="bounded").x
        assert abs(np.degrees(best) - angle) <= 0.75


def test_the_fall() -> None:
    place, above, below = found().fall()
    assert (place, above, below) == pytest.approx((0.294, 158, 93))
    assert eta_1(0.293, np.radians(158)) < eta_1(0.293, np.radians(93))
    assert eta_1(0.294, np.radians(158)) > eta_1(0.294, np.radians(93))


def test_filtered_angles() -> None:
    filtered = found().filtered
    assert filtered["method one"].min() == 140 and filtered["method one"].max() == 160
    best = filtered["least eta_1"]
    for factor in FACTORS:
        values = filtered[f"method two, alpha {factor:g}"]
        assert values[0] == best[0]
        np.testing.assert_allclose(values[1:], factor * best[1:] + (1 - factor) * values[:-1], atol=1e-9)


def test_claims_can_fail() -> None:
    one = found()
    assert [claim.text for claim in one.claims() if not claim.holds] == []
    flat = {**one.translation.indices, "eta_1": np.ones_like(one.translation.indices["eta_1"])}
    without = replace(one, translation=replace(one.translation, indices=flat))
    assert [claim.holds for claim in without.claims()][:2] == [False, False]
    compared = {key: dict(methods) for key, methods in one.compared.items()}
    compared["T2", "eta_2"][Method.NLP] = compared["T2", "eta_2"][Method.CONSTANT]
    last = replace(one, compared=compared).claims()[-1]
    assert not last.holds and "T2 eta_2 scan" in last.text


def test_every_method_is_compared(tmp_path: Path) -> None:
    assert len(found().compared) == 4
    assert all(tuple(methods) == METHODS for methods in found().compared.values())
    paths = save_figures(redundancy_figures(found()), tmp_path)
    assert [path.name for path in paths] == [
        "redundancy_best.png",
        "redundancy_minima.png",
        "redundancy_programme.png",
    ]
