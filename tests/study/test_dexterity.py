"""The example of Section 1.8 against the reference, and by differences of the kinematics."""

from __future__ import annotations

import json
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest

import krhpr
from krhpr.study.dexterity import BETA, ROBOT, Dexterity, dexterity
from krhpr.study.figures import dexterity_figures
from krhpr.study.files import save_figures
from krhpr.study.trajectory import trajectory

REFERENCE = json.loads(
    (Path(__file__).parents[1] / "reference" / "chapter1.json").read_text(encoding="utf-8")
)


@cache
def found() -> Dexterity:
    return dexterity()


def test_numbers_of_the_reference() -> None:
    one = found()
    assert np.degrees(one.theta[0]) == pytest.approx(np.array(REFERENCE["q_start_deg"]), abs=1e-9)
    assert np.degrees(one.ranges) == pytest.approx(np.array(REFERENCE["range_deg"]), abs=1e-9)
    assert round(np.degrees(one.ranges.max()), 2) == 59.96
    for values, name in ((one.condition, "cond_M"), (one.position, "norm_Up_m"), (one.rotation, "norm_Ur")):
        assert [values.min(), values.max()] == pytest.approx(REFERENCE[name], rel=1e-9)
    assert one.condition.shape == (REFERENCE["poses"], 3)


def test_indices_by_differences_of_the_end_points() -> None:
    """Condition numbers of ds/dtheta by central differences of the forward kinematics of the legs."""
    robot, one, h = krhpr.load(ROBOT), found(), 1e-6
    for k in range(0, 721, 90):
        columns = []
        for actuator in range(3):
            step = np.zeros((3, 3))
            step[:, actuator] = h
            ahead, behind = (robot.subleg_forward(one.theta[k] + sign * step) for sign in (1, -1))
            columns.append((ahead - behind) / (2 * h))
        M = np.stack(columns, axis=-1)
        np.testing.assert_allclose(one.condition[k], np.linalg.cond(M), rtol=1e-6)
        values = np.linalg.svd(M, compute_uv=False)
        np.testing.assert_allclose(one.condition_of_all[k], values.max() / values.min(), rtol=1e-6)


def test_sensitivities_are_largest_displacements() -> None:
    """No joint rates of norm one move the platform faster, and some all but as fast."""
    robot, one, source = krhpr.load(ROBOT), found(), np.random.default_rng(0)
    p, Q = trajectory()
    k, beta = 250, np.full(3, BETA)
    at = (p[k] / 1000, Q[k], robot.end_points(p[k] / 1000, Q[k], beta), one.theta[k])
    rates = source.normal(size=(20_000, 3, 3))
    rates /= np.linalg.norm(rates, axis=(1, 2), keepdims=True)
    twist = robot.twist(*at, rates)
    for size, part in ((one.position[k], twist[:, :3]), (one.rotation[k], twist[:, 3:])):
        fastest = np.linalg.norm(part, axis=1).max()
        assert 0.9 * size < fastest <= size * (1 + 1e-9)


def test_claims() -> None:
    assert all(claim.holds for claim in found().claims()) and len(found().claims()) == 4
    edge = dexterity(BETA + np.radians(30))  # beta measured from the platform's edge, as Chapter 3 does
    assert np.degrees(edge.ranges.max()) == pytest.approx(67.1, abs=0.05)
    assert not edge.claims()[0].holds
    far = replace(found(), condition=found().condition * 2)
    assert [claim.holds for claim in far.claims()] == [True, False, True, True]


def test_pictures(tmp_path: Path) -> None:
    paths = [save_figures(dexterity_figures(found()), tmp_path / name) for name in ("a", "b")]
    assert [path.name for path in paths[0]] == ["dexterity_ranges.png", "dexterity_indices.png"]
    for one, other in zip(*paths, strict=True):
        assert one.read_bytes() == other.read_bytes() and one.stat().st_size > 10_000
