"""The vertex test, for factors that are sinusoids of each angle or affine in each slide.

Between low and high, less than half a turn apart, a sinusoid is

    f(x) = (f(low) sin(high - x) + f(high) sin(x - low)) / sin(high - low),

and an affine function likewise, with weights that are positive in between and add up to at least one.  Taken
coordinate by coordinate, f is such a combination of its values at the eight vertices.  Hence

* open box: f > 0 inside if no vertex value is negative and one is positive;
* closed box: f > 0 if and only if all vertex values are positive, as the vertices belong to it;
* f is nowhere below the smallest vertex value, and takes it.
"""

from __future__ import annotations

from itertools import product

from krhpr.certificate.answer import Finding, Method, Verdict
from krhpr.certificate.boxes import Box, Triple, triple
from krhpr.certificate.exact import multiple
from krhpr.certificate.factors import Factor, Form
from krhpr.certificate.points import proven_bound, vanishing_point

HALF_TURN = 3.141592653589793


def vertex_test(factor: Factor, box: Box, sign: int) -> Finding:
    """What the eight vertices prove of a factor that has the given sign at the centre (+1 or -1)."""

    def finding(verdict: Verdict, **more: object) -> Finding:
        margin_sign = sign if factor.margin > 0 else -sign
        return Finding(factor.name, verdict, Method.VERTICES, margin_sign, **more)  # type: ignore[arg-type]

    if factor.form is Form.SINUSOIDAL and any(map(_wide, box.low, box.high)):
        point = _over_half_a_turn(factor, box, sign)
        return (
            finding(Verdict.UNDECIDED, cell=box) if point is None else finding(Verdict.SINGULAR, point=point)
        )
    corners = _corners(box)
    values = [sign * factor.at([factor.coordinate(x) for x in corner]) for corner in corners]
    signs = [value.sign() for value in values]
    if -1 in signs:
        return finding(Verdict.SINGULAR, point=vanishing_point(factor, box.centre, corners[signs.index(-1)]))
    if None in signs:
        corner = corners[signs.index(None)]
        return finding(Verdict.UNDECIDED, cell=Box(corner, corner))
    if 0 in signs and box.closed:
        return finding(Verdict.SINGULAR, point=corners[signs.index(0)])
    lowest = min(values, key=lambda value: value.low())
    return finding(Verdict.FREE, bound=proven_bound(factor, max(lowest.below(), 0.0)))


def _wide(low: float, high: float) -> bool:
    """Whether two angles are half a turn or more apart, or cannot be told to be less."""
    ends = multiple(low), multiple(high)
    if None not in ends:
        return bool(ends[1] - ends[0] >= 6)  # type: ignore[operator]
    return high - low >= HALF_TURN * (1 - 1e-15)


def _over_half_a_turn(factor: Factor, box: Box, sign: int) -> Triple | None:
    """A zero in a box that spans half a turn: there is one on any line along that coordinate.

    With half a turn to rounding the zero may be at both of its ends: boxes within are tried, too.
    """
    for leg, width in enumerate(box.widths):
        for share in (0.5, 0.3, 0.9):
            ends = [list(box.centre), list(box.centre)]
            ends[0][leg] = box.low[leg] + share * (width - HALF_TURN)
            ends[1][leg] = ends[0][leg] + HALF_TURN
            if width > HALF_TURN * (1 + 1e-15) and _sign(factor, triple(ends[0])):
                return vanishing_point(factor, triple(ends[0]), triple(ends[1]))
    for share in (0.5, 0.9, 0.99, 0.999, 1 - 1e-6):
        for corner in _corners(box):
            point = triple([c + share * (x - c) for c, x in zip(box.centre, corner, strict=True)])
            if _sign(factor, point) == -sign:
                return vanishing_point(factor, box.centre, point)
    return None


def _sign(factor: Factor, point: Triple) -> int:
    """The sign of a value, 0 where it is open."""
    return factor.at([factor.coordinate(x) for x in point]).sign() or 0


def _corners(box: Box) -> list[Triple]:
    return [triple(corner) for corner in product(*zip(box.low, box.high, strict=True))]
