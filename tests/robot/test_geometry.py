"""Geometry: changed in a copy, different legs, what is refused."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from krhpr import Robot
from tests.robot.support import assert_same, configuration, poses


def test_geometry_is_changed_in_a_copy(robot: Robot) -> None:
    longer = robot.with_geometry(l_2=1.1 * robot.geometry.l_2)
    assert longer.geometry != robot.geometry
    assert longer.backend == robot.backend
    pose = poses(robot)
    assert not np.allclose(longer.inverse(*pose), robot.inverse(*pose))
    same = longer.with_geometry(l_2=robot.geometry.l_2)
    assert same.geometry == robot.geometry and hash(same.geometry) == hash(robot.geometry)
    assert_same(same.inverse(*pose), robot.inverse(*pose))


def test_legs_may_differ(robot: Robot) -> None:
    lengths = robot.geometry.l_2 * [1.0, 1.02, 0.99]
    unequal = robot.with_geometry(l_2=lengths)
    p, Q, s, theta = configuration(unequal, 4)
    for leg in range(3):
        alike = robot.with_geometry(l_2=lengths[leg])
        assert_same(theta[:, leg], alike.inverse(*poses(robot, 4))[:, leg], 1e-13)
    assert_same(unequal.constraints(p, Q, s), np.zeros(unequal.constraints(p, Q, s).shape), 1e-14)
    assembly = [None, *robot.assemblies]
    found = [unequal.subleg_forward(theta, label) for label in (robot.assemblies or (None,))]
    assert len(assembly) > 0 and any(np.allclose(answer, s, rtol=0, atol=1e-12) for answer in found)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"l_99": 1}, "geometry: unknown field l_99; the fields are"),
        ({"l_1": "long"}, "'l_1' is 'long'; expected a number, or one for each leg"),
        ({"l_2": 0.0}, "must be positive"),
        ({"l_2": -1.0}, "must be positive"),
        ({"l_2": np.nan}, "must be finite"),
        ({"l_2": [1.0, 2.0]}, r"has shape \(2,\)"),
        ({"l_2": "long"}, "long"),
    ],
)
def test_a_geometry_that_makes_no_sense_is_refused(
    planar: Robot, change: dict[str, Any], message: str
) -> None:
    with pytest.raises(ValueError, match=message):
        planar.with_geometry(**change)


def test_geometry_cannot_be_changed_by_accident(planar: Robot) -> None:
    with pytest.raises(ValueError, match="read-only"):
        planar.geometry.l_2[0] = 1.0
