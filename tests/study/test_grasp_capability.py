"""The grasp capability of the prototype: symmetric, alike all along the slides, nothing at singularities."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from krhpr.study.grasp import PROTOTYPE
from krhpr.study.grasp_capability import capability_study

TURNS = np.radians([-90.0, -20.0, 0.0, 20.0, 90.0])


def test_the_prototype() -> None:
    found = capability_study(turns=TURNS, rows=5)
    assert all(claim.holds for claim in found.claims())
    assert found.heights.shape == found.made.most.shape == found.moment.shape == (5, 5)
    # P lies 30 mm below the pivot, between the slides and the links' length, in steps of 1 mm
    low, high = found.heights[[0, -1], 2]
    assert low == pytest.approx(0.03, abs=1.001e-3) and high == pytest.approx(0.15, abs=1.001e-3)
    # the mirror image is the same robot, and a weight keeps its direction
    for values in (found.made.least, found.made.most, found.moment):
        np.testing.assert_allclose(values, values[:, ::-1], rtol=1e-6, atol=1e-7)
    # on its side the object rests on one jaw: no friction is needed, and any grasping force will do
    assert found.made.least[3, 0] == pytest.approx(0.0, abs=1e-9)
    # upright friction of both contacts bears it
    np.testing.assert_allclose(found.made.least[1:, 2], 0.3 / 2 / 0.5, rtol=1e-6)
    assert found.made.most[0, 3] < 0.1 * found.made.most[2, 3] or np.isnan(found.made.most[0, 3])


def test_nothing_depends_on_where_along_the_slides() -> None:
    beside = replace(PROTOTYPE, pivot=(0.05, 0.09))
    here, there = (capability_study(setup, turns=TURNS[:2], rows=3) for setup in (PROTOTYPE, beside))
    np.testing.assert_allclose(there.made.most, here.made.most, rtol=1e-7)
    np.testing.assert_allclose(there.moment, here.moment, rtol=1e-7)
    assert there.at_pose.grasp_force == pytest.approx(here.at_pose.grasp_force, rel=1e-7)


def test_weak_motors_do_not_hold_it() -> None:
    found = capability_study(torque=1e-6, turns=TURNS[2:3], rows=2)
    assert not found.at_pose.held and not found.claims()[0].holds and found.at_pose.conflict
    assert np.isnan(found.made.most).all()
