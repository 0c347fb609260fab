"""Signs of a factor at points, where it vanishes between two of them, and bounds of margins."""

from __future__ import annotations

from itertools import product

import numpy as np

from krhpr.certificate.boxes import Box, Triple, triple
from krhpr.certificate.factors import Factor


def vanishing_point(factor: Factor, first: Triple, second: Triple) -> Triple:
    """A zero on the segment between two points of opposite signs, to the last bit that matters.

    Bisection: where the factor's rounding decides the sign, it is zero to rounding.
    """
    start, way = np.array(first), np.array(second) - np.array(first)
    positive = bool(factor.near(start) > 0)
    near, far = 0.0, 1.0
    while True:
        middle = near + (far - near) / 2
        if middle in (near, far):
            break
        if bool(factor.near(start + middle * way) > 0) == positive:
            near = middle
        else:
            far = middle
    places = [start + t * way for t in (near, far)]
    if far == 1.0:
        places = places[:1]
    best = min(places, key=lambda place: abs(float(factor.near(place))))
    return triple(best.tolist())


def sign_at(factor: Factor, point: Triple) -> int | None:
    """The exact sign of a value; None where its error leaves it open."""
    return factor.at([factor.coordinate(x) for x in point]).sign()


def corners(box: Box, share: float = 1.0) -> list[Triple]:
    """The eight vertices of a box, or of one drawn in towards its centre."""
    if share == 1.0:
        return [triple(corner) for corner in product(*zip(box.low, box.high, strict=True))]
    return [
        triple([c + share * (x - c) for c, x in zip(box.centre, corner, strict=True)])
        for corner in corners(box)
    ]


def sign_change(factor: Factor, box: Box) -> Triple | None:
    """A zero inside a box whose centre does not tell the sign: between two points of opposite signs."""
    signs = {sign_at(factor, corner): corner for corner in corners(box, 0.5)}
    return vanishing_point(factor, signs[1], signs[-1]) if {1, -1} <= signs.keys() else None


def proven_bound(factor: Factor, least: float) -> float:
    """A lower bound of the margin's absolute value from one of the factor's."""
    return max(least * abs(factor.margin) * (1 - 1e-13), 0.0)
