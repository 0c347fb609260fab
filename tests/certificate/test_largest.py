"""The largest boxes that are certified."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from krhpr import InvalidInput
from krhpr.certificate import Verdict, largest_box
from krhpr.certificate.largest import CLOSE
from tests.certificate.support import ROBOTS, degrees, inside, load, margins, unequal

spatial, planar, slides = load("spatial_rrr_a"), load("planar_rr_a"), load("spatial_rrr_c")


@pytest.mark.parametrize("robot", [spatial, planar], ids=repr)
def test_sixty_degrees_around_ninety(robot: Any) -> None:
    found = largest_box(robot, np.radians(90))
    assert found.half_width == pytest.approx(np.pi / 3, rel=1e-15)
    assert found.certificate.free and not found.certificate.box.closed
    assert found.beyond.verdict is Verdict.SINGULAR
    assert max(found.beyond.box.widths) < 2 * np.pi / 3 * (1 + 2 * CLOSE)


def test_radial_slides_reach_the_centre() -> None:
    found = largest_box(slides, 0.1)
    assert found.half_width == 0.1
    assert found.beyond.verdict is Verdict.SINGULAR


def test_proportions() -> None:
    found = largest_box(planar, degrees(80, 90, 95), (1, 0.5, 2))
    widths = np.array(found.certificate.box.widths)
    assert np.allclose(widths / widths[0], [1, 0.5, 2])
    assert found.certificate.box.centre == pytest.approx(tuple(degrees(80, 90, 95)))
    assert found.certificate.free and found.beyond.verdict is Verdict.SINGULAR


def test_a_limit() -> None:
    found = largest_box(spatial, np.radians(90), limit=0.5)
    assert found.half_width == 0.5 and found.beyond is None
    assert found.certificate.findings[0].bound > 0
    found = largest_box(slides, 0.1, (1, 2, 1), limit=0.01)
    assert found.half_width == 0.005 and found.beyond is None


def test_with_long_links() -> None:
    """Where det J_n decides by enclosures."""
    robot = spatial.with_geometry(l_r=0.3)
    found = largest_box(robot, np.radians(90))
    assert found.certificate.free and not found.beyond.free
    assert (np.abs(margins(robot, inside(found.certificate.box))) > 0).all()


@pytest.mark.parametrize("identifier", ROBOTS)
@settings(max_examples=settings.default.max_examples // 25)
@given(st.data())
def test_around_any_point_of_unequal_legs(identifier: str, data: st.DataObject) -> None:
    robot = data.draw(unequal(identifier))
    angle = st.floats(1.0, 2.2) if identifier[-1] == "a" else st.floats(0.02, 0.3)
    found = largest_box(robot, data.draw(st.tuples(angle, angle, angle)))
    assert found.certificate.free
    values = margins(robot, inside(found.certificate.box))
    assert (values * values[0] > -1e-15).all()
    assert found.beyond is not None and not found.beyond.free
    assert max(found.beyond.box.widths) <= max(found.certificate.box.widths) * (1 + 3 * CLOSE)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"centre": np.nan}, "centre is nan"),
        ({"centre": [1.0, 2.0]}, r"centre has shape \(2,\)"),
        ({"centre": 100.0}, "subtract full turns"),
        ({"centre": 1.5, "proportions": (1, 0, 1)}, "must be positive"),
        ({"centre": 1.5, "proportions": np.inf}, "must be finite"),
        ({"centre": 1.5, "limit": -1.0}, "limit is -1.0"),
        ({"centre": 1.5, "limit": np.nan}, "limit is nan"),
        ({"centre": np.pi}, "singular there"),
    ],
)
def test_hostile_input(arguments: dict[str, Any], message: str) -> None:
    with pytest.raises(InvalidInput, match=message):
        largest_box(spatial, **arguments)
