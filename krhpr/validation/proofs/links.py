"""Proof about distances between links: the least of all stationary values of the distance."""

from __future__ import annotations

from typing import Any

from krhpr.codegen.evaluate import evaluate_kernel
from krhpr.validation.arithmetic import BALLS
from krhpr.validation.configurations import Configuration
from krhpr.validation.linear import dot
from krhpr.validation.numbers import Ball, Exact, Undecidable
from krhpr.validation.outcome import Measured, Runner
from krhpr.validation.proofs.robots import proof
from krhpr.validation.subject import Subject

SAMPLES = 12
"""Pairs of one configuration that are looked at, evenly spread."""


def _balls(values: list[Any]) -> list[Ball]:
    return [value if isinstance(value, Ball) else Ball(Exact(value).fraction) for value in values]


def _minus(a: list[Ball], b: list[Ball]) -> list[Ball]:
    return [x - y for x, y in zip(a, b, strict=True)]


def _point_square(point: list[Ball], start: list[Ball], end: list[Ball]) -> list[Ball]:
    """Squared distances of a point from both ends and, if it is there, from its foot on the segment."""
    along, here = _minus(end, start), _minus(point, start)
    found = [dot(here, here), dot(_minus(point, end), _minus(point, end))]
    share = dot(along, here) / dot(along, along)
    if _inside(share):
        found.append(dot(here, here) - share * share * dot(along, along))
    return found


def _inside(share: Ball) -> bool:
    """Whether it is between 0 and 1; where balls cannot tell, the end there has the same distance."""
    try:
        return Ball(0) < share and share < Ball(1)
    except Undecidable:
        return False


def _line_squares(a: list[list[Ball]], b: list[list[Ball]]) -> list[Ball]:
    """The squared distance of both lines by their common normal, if it meets both segments inside."""
    u, v, w = _minus(a[1], a[0]), _minus(b[1], b[0]), _minus(b[0], a[0])
    normal = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]]
    square = dot(normal, normal)

    def triple(x: list[Ball], y: list[Ball]) -> Any:
        return dot(normal, [x[1] * y[2] - x[2] * y[1], x[2] * y[0] - x[0] * y[2], x[0] * y[1] - x[1] * y[0]])

    first, second = triple(w, v) / square, triple(w, u) / square
    return [dot(normal, w) ** 2 / square] if _inside(first) and _inside(second) else []


def distances(subject: Subject, here: Configuration, found: Measured) -> None:
    """Every pair of links against the ends, the feet and the common normal of both."""
    (each,) = (call.pairs for call in subject.code.function("clearances").calls if call.pairs is not None)
    result = here.call("link_points")
    flat = _balls(result["points"] + result["attachment"])
    kernel = subject.derived("algebra", "segment_distance")
    for ends in each.ends[:: max(1, len(each.ends) // SAMPLES)]:
        points = [flat[3 * end : 3 * end + 3] for end in ends]
        inputs = {port.name: point for port, point in zip(kernel.inputs, points, strict=True)}
        (distance,) = evaluate_kernel(kernel, inputs, None, BALLS)["distance"]
        a, b = points[:2], points[2:]
        squares = [x for point in a for x in _point_square(point, *b)]
        squares += [x for point in b for x in _point_square(point, *a)]
        squares += _line_squares(a, b)
        least = squares[0]
        for square in squares[1:]:
            least = least.minimum(square)
        found.equal([distance * distance], [least], f"links between the points {ends}")


RUNNERS: dict[str, Runner] = {
    "distances of links": proof(distances),
}
