"""The largest box around a point that can be certified."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass

from numpy.typing import ArrayLike

from krhpr.certificate.answer import Certificate
from krhpr.certificate.boxes import FARTHEST, TURN, Box, Triple, per_leg, triple
from krhpr.certificate.certify import judge
from krhpr.certificate.exact import multiple
from krhpr.certificate.factors import is_angular
from krhpr.certificate.intervals import CELLS
from krhpr.errors import InvalidInput
from krhpr.robot import Robot

CLOSE = 1e-9
"""Relative distance of the largest half-width that is certified to one that is not."""

_STEPS = 48
"""Halvings or doublings on the way to a first bracket."""


@dataclass(frozen=True)
class Largest:
    """The largest open box centre +- half_width * proportions that was certified.

    `beyond` is the certificate of a box larger by CLOSE at most: it holds a singular point, or the smallest
    cell left; None where the limit was reached.
    """

    half_width: float
    certificate: Certificate
    beyond: Certificate | None


def largest_box(
    robot: Robot,
    centre: ArrayLike,
    proportions: ArrayLike = 1.0,
    *,
    limit: float | None = None,
    cells: int = CELLS // 10,
) -> Largest:
    """The largest open box around a point that is certified: a cube, or in given proportions.

    Args:
        robot: the robot with its geometry.
        centre: redundant coordinates (rad or m): one for all legs or three.
        proportions: half-widths of the three coordinates relative to one another, positive.
        limit: the largest half-width (times the largest proportion) of interest; half a turn unless given,
            and none for slides.
        cells: how many cells the interval test may look at in each box.

    Raises:
        InvalidInput: numbers that are not finite, of another shape or not positive; a singular centre.
    """
    middle, shares = per_leg("centre", centre), per_leg("proportions", proportions)
    angular = is_angular(robot)
    if min(shares) <= 0:
        raise InvalidInput(f"proportions are {shares}; they must be positive")
    if limit is not None and not 0 < limit < math.inf:
        raise InvalidInput(f"limit is {limit}; it must be positive and finite")
    if angular and max(map(abs, middle)) + TURN / 2 > FARTHEST:
        raise InvalidInput(f"centre is {middle} rad; subtract full turns")
    widest = max(shares)
    most = (min(limit or math.inf, TURN / 2 if angular else math.inf)) / widest

    def certificate(half: float, bounds: bool = False) -> Certificate:
        return judge(robot, _box(middle, shares, half), cells, bounds=bounds)

    start = math.inf if angular else max(map(abs, middle)) / widest or 1.0
    inside, outside = _bracket(certificate, most, start)
    if inside is None:
        raise InvalidInput(f"{robot.identifier}: no box around {middle} is certified: it is singular there")
    while outside is not None and outside[0] - inside[0] > CLOSE * outside[0]:
        half = (inside[0] + outside[0]) / 2
        found = certificate(half)
        if found.free:
            inside = half, found
        else:
            outside = half, found
    if outside is not None:
        for half in sorted(_nominal(middle, shares, angular)):
            if inside[0] < half <= outside[0] and (found := certificate(half)).free:
                inside = half, found
    best = certificate(inside[0], bounds=True)
    return Largest(inside[0], best, None if outside is None else outside[1])


Tried = tuple[float, Certificate]
"""A half-width and what is known of its box."""


def _box(centre: Triple, shares: Triple, half: float) -> Box:
    low = [x - half * share for x, share in zip(centre, shares, strict=True)]
    high = [x + half * share for x, share in zip(centre, shares, strict=True)]
    return Box(triple(low), triple(high), closed=False)


def _bracket(
    certificate: Callable[[float], Certificate], most: float, start: float
) -> tuple[Tried | None, Tried | None]:
    """A half-width that is certified, and a larger one that is not (None if `most` is)."""
    half, outside = min(most, start), None
    for _ in range(_STEPS):
        found = certificate(half)
        if found.free:
            if outside is not None or half == most:
                return (half, found), outside
            inside: Tried = (half, found)
            break
        outside, half = (half, found), half / 2
    else:
        return None, outside
    for _ in range(_STEPS):
        half = min(2 * half, most)
        found = certificate(half)
        if not found.free:
            return inside, (half, found)
        inside = half, found
        if half == most:
            break
    return inside, None


def _nominal(centre: Triple, shares: Triple, angular: bool) -> Iterator[float]:
    """Half-widths at which a bound is a multiple of 30 degrees, or a slide's zero: exact zeros lie there."""
    for x, share in zip(centre, shares, strict=True):
        if not angular:
            yield abs(x) / share
            continue
        here = multiple(x)
        for count in range(-24, 25):
            gap = count * math.pi / 6 - x if here is None else (count - here) * math.pi / 6
            yield abs(gap) / share
