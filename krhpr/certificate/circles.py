"""(1.35) for any lengths: when the end points of an arrangement with turning links can never be collinear.

S_i moves on a circle about B_i.  A line meets a circle if and only if it meets its disc, and three convex
sets have a common transversal line if and only if one of them meets the convex hull of the other two.  So
det J_n, twice the signed area of S_1 S_2 S_3, vanishes for some redundant angles if and only if one disc
meets the convex hull of the other two, which is a union of discs:

    for some t in [0, 1]:  |B_k - (1 - t) B_i - t B_j| <= l_k + (1 - t) l_i + t l_j

For an equilateral platform and equal lengths this is l >= 3 R_p / 4.  The circles are taken from three points
on them, so that this needs no formula of the arrangement.
"""

from __future__ import annotations

from functools import lru_cache
from importlib import import_module
from typing import Any

import numpy as np

from krhpr.certificate.boxes import LEGS
from krhpr.certificate.exact import Number
from krhpr.certificate.factors import CORNERS, exact_geometry
from krhpr.generated.python.runtime import Geometry
from krhpr.robot import Robot

Circle = tuple[Number, Number, Number]
"""Centre (x, y) in the platform frame and radius."""


def never_collinear(robot: Robot) -> bool:
    """Whether det J_n has no zero at all, for a spatial robot with redundant angles: proven where true."""
    return _never_collinear(robot.identifier, robot.geometry)


@lru_cache(maxsize=64)
def _never_collinear(identifier: str, geometry: Geometry) -> bool:
    circles = _circles(identifier, geometry)
    pairs = ((0, 1, 2), (1, 2, 0), (2, 0, 1))
    return all(_clear(circles[k], circles[i], circles[j]) for k, i, j in pairs)


def _circles(identifier: str, given: Geometry) -> list[Circle]:
    """Where each S_i moves, from its places at 0 and 180 degrees."""
    module = import_module(f"krhpr.generated.python.{identifier}")
    redundant = np.empty((2, LEGS), dtype=object)
    redundant[0], redundant[1] = [CORNERS[0]] * LEGS, [CORNERS[2]] * LEGS
    geometry = exact_geometry(module, given)
    s = module.end_points(np.zeros(3), np.eye(3), redundant, geometry=geometry)
    found = []
    for leg in range(LEGS):
        first, second = s[0, leg], s[1, leg]
        x, y = ((a + b) / 2 for a, b in zip(first[:2], second[:2], strict=True))
        found.append((x, y, _square(first[0] - x, first[1] - y).sqrt()))
    return found


def _clear(one: Circle, first: Circle, second: Circle) -> bool:
    """Whether a disc keeps away from the convex hull of two others: proven where true.

    The difference of squares is C - 2 B t + A t^2, which must be positive for t in [0, 1].
    """
    across = (second[0] - first[0], second[1] - first[1])
    along = (one[0] - first[0], one[1] - first[1])
    reach, change = one[2] + first[2], second[2] - first[2]
    a = _square(*across) - change * change
    b = along[0] * across[0] + along[1] * across[1] + reach * change
    c = _square(*along) - reach * reach
    if not (_positive(a) and _positive(c) and _positive(a - 2 * b + c)):
        return False
    return _positive(-b) or _positive(b - a) or _positive(a * c - b * b)


def _square(x: Any, y: Any) -> Number:
    value: Number = x * x + y * y
    return value


def _positive(value: Number) -> bool:
    return value.sign() == 1
