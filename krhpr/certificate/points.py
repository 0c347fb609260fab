"""Where a factor vanishes between two points, and bounds of margins."""

from __future__ import annotations

import numpy as np

from krhpr.certificate.boxes import Triple, triple
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


def proven_bound(factor: Factor, least: float) -> float:
    """A lower bound of the margin's absolute value from one of the factor's."""
    return max(least * abs(factor.margin) * (1 - 1e-13), 0.0)
