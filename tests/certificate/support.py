"""What the tests of certificates share."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
from hypothesis import strategies as st

import krhpr
from krhpr import Robot
from krhpr.certificate import Box, Form
from krhpr.certificate.factors import factors, is_angular

Array = np.ndarray[Any, Any]

ROBOTS = tuple(
    {identifier[:4] + identifier[-1]: identifier for identifier in reversed(krhpr.catalogue())}.values()
)
"""One robot of each arrangement, in space and in the plane."""


@cache
def load(identifier: str) -> Robot:
    return krhpr.load(identifier, backend="numpy")


def degrees(*values: float) -> Array:
    return np.radians(values)


def margins(robot: Robot, points: Any) -> Array:
    return np.asarray(robot.type_2_of_redundant(points).margins)


def sizes(robot: Robot, points: Any) -> Array:
    """What rounding of margins at points (..., 3) is relative to: the size of their terms."""
    found = []
    for factor in factors(robot):
        value = np.broadcast_to(np.abs(factor.rounded), (*np.shape(points)[:-1], *factor.rounded.shape))
        for leg in range(3):
            basis = np.abs(factor.bases(np.asarray(points, dtype=float)[..., leg]))
            if factor.form is not Form.AFFINE:
                basis = np.ones_like(basis)  # sines and cosines may be small, and are terms all the same
            rest = "bc"[: 2 - leg]
            value = np.einsum(f"...a,...a{rest}->...{rest}", basis, value)
        found.append(value * abs(factor.margin))
    return np.stack(found, axis=-1)


def inside(box: Box, count: int = 200) -> Array:
    """Random points of a box, its centre and its vertices drawn in by a hair."""
    low, high = np.array(box.low), np.array(box.high)
    shares = np.random.default_rng(7).uniform(size=(count, 3))
    corners = np.array(np.meshgrid([0, 1], [0, 1], [0, 1])).reshape(3, -1).T
    shares = np.vstack([shares, [[0.5, 0.5, 0.5]], 1e-9 + corners * (1 - 2e-9)])
    return low + shares * (high - low)


@st.composite
def unequal(draw: st.DrawFn, identifier: str) -> Robot:
    """A robot whose platform has other lengths and azimuths on each leg."""
    robot = load(identifier)
    changes = {}
    for name in ("l_r", "R_p", "platform_azimuth"):
        if name in robot.geometry.order:
            spread = st.floats(-0.3, 0.3) if name == "platform_azimuth" else st.floats(0.7, 1.4)
            change = np.array(draw(st.tuples(spread, spread, spread)))
            given_ = getattr(robot.geometry, name)
            changes[name] = given_ + change if name == "platform_azimuth" else given_ * change
    return robot.with_geometry(**changes)


@st.composite
def boxes(draw: st.DrawFn, identifier: str) -> tuple[list[float], list[float]]:
    """Bounds of a box of redundant coordinates."""
    angular = is_angular(load(identifier))
    centre = st.floats(0.0, 2 * np.pi) if angular else st.floats(-0.2, 0.3)
    half = st.floats(0.01, 3.1) if angular else st.floats(1e-3, 0.2)
    middle, reach = draw(st.tuples(centre, centre, centre)), draw(st.tuples(half, half, half))
    low = [m - h for m, h in zip(middle, reach, strict=True)]
    high = [m + h for m, h in zip(middle, reach, strict=True)]
    return low, high
