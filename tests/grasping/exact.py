"""Grasping robots on exact numbers: rational places, and the loop closures, written from the figures."""

from __future__ import annotations

from functools import cache
from typing import Any

from krhpr.derivations.grasping.catalogue import grasping
from krhpr.validation.arithmetic import RATIONAL
from krhpr.validation.draw import Draw
from krhpr.validation.subject import Subject

Values = dict[str, list[Any]]


@cache
def subject(name: str) -> Subject:
    """Of a subject's entry, running texts takes the robot and its sizes alone."""
    found: Any = next(entry for entry in grasping() if entry.identifier == name)
    return Subject(found)


class Place:
    """A random geometry and configuration: pivot, angles, end points, and joints that need not close.

    Formulas of velocities hold wherever the links' lengths are what the joints make them.
    """

    def __init__(self, name: str, seed: int) -> None:
        self.subject, self.draw = subject(name), Draw(seed)
        draw = self.draw
        self.geometry = draw.geometry(*self.subject.geometry_types.values(), legs=2)
        self.values: Values = {
            "pivot": draw.vector(2),
            "angles": [draw.angle(), draw.angle()],
            "theta": [draw.nonzero() for _ in range(4)],
        }
        self.values["s"] = self.call("end_points")["s"]

    def call(self, function: str, **more: list[Any]) -> Values:
        return self.subject.call(function, {**self.values, **more}, self.geometry, RATIONAL)

    def of(self, field: str, leg: int) -> Any:
        return self.geometry[field][leg]


def end_point(place: Place, leg: int, pivot: list[Any], angle: Any) -> list[Any]:
    """s = b - l [cos, sin], on numbers or on series in time."""
    length = place.of("l_j", leg)
    return [pivot[0] - length * angle.cos(), pivot[1] - length * angle.sin()]


def closure(place: Place, chain: int, s: list[Any], rho: Any) -> Any:
    """(5.13) halved: of a PRR chain |s - a|^2 / 2, constant; of an RPR chain (|s - a|^2 - rho^2) / 2."""
    leg, n = divmod(chain, 2)
    a = [place.of(f"{axis}_{n + 1}", leg) for axis in ("x", "y")]
    if "slide_1" in place.geometry:
        direction = place.of(f"slide_{n + 1}", leg)
        a = [a[0] + rho * direction.cos(), a[1] + rho * direction.sin()]
    d = [s[0] - a[0], s[1] - a[1]]
    square = d[0] * d[0] + d[1] * d[1]
    return (square if "slide_1" in place.geometry else square - rho * rho) / 2
