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

from krhpr.certificate.answer import Finding, Method, Verdict
from krhpr.certificate.boxes import Box, Triple, triple
from krhpr.certificate.exact import multiple
from krhpr.certificate.factors import Factor, Form
from krhpr.certificate.points import corners, proven_bound, sign_at, vanishing_point

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
    vertices = corners(box)
    values = [sign * factor.at([factor.coordinate(x) for x in vertex]) for vertex in vertices]
    signs = [value.sign() for value in values]
    if -1 in signs:
        return finding(Verdict.SINGULAR, point=vanishing_point(factor, box.centre, vertices[signs.index(-1)]))
    if None in signs:
        vertex = vertices[signs.index(None)]
        return finding(Verdict.UNDECIDED, cell=Box(vertex, vertex))
    if 0 in signs and box.closed:
        return finding(Verdict.SINGULAR, point=vertices[signs.index(0)])
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

    With just half a turn it may be at both of its ends: boxes within, and a closed box's corners, are tried.
    """
    for leg, width in enumerate(box.widths):
        for share in (0.5, 0.3, 0.9):
            ends = [list(box.centre), list(box.centre)]
            ends[0][leg] = box.low[leg] + share * (width - HALF_TURN)
            ends[1][leg] = ends[0][leg] + HALF_TURN
            if width > HALF_TURN * (1 + 1e-15) and sign_at(factor, triple(ends[0])):
                return vanishing_point(factor, triple(ends[0]), triple(ends[1]))
    for share in (0.5, 0.9, 0.99, 0.999, 1 - 1e-6, *([1.0] if box.closed else [])):
        for point in corners(box, share):
            if sign_at(factor, point) == -sign:
                return vanishing_point(factor, box.centre, point)
    zeros = (vertex for vertex in corners(box) if sign_at(factor, vertex) == 0)
    return next(zeros, None) if box.closed else None
