"""Points at given distances from given centres: two circles in the plane, three spheres in space."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import sympy as sp

from krhpr.codegen.writer import KernelWriter
from krhpr.derivations.vectors import E, cross, dot


@dataclass(frozen=True)
class Meeting:
    """A point where circles or spheres meet, and the radicand that is negative where they do not."""

    point: sp.Matrix
    radicand: Any


def meet(k: KernelWriter, line: sp.Matrix, first2: Any, second2: Any, sign: Any) -> Meeting:
    """Where two circles meet: about 0 with the squared radius `first2`, about `line` with `second2`.

    The point lies left of `line` for sign = +1, right of it for -1.
    """
    d2 = k.let("d2", dot(line, line))
    along = k.let("along", (first2 - second2 + d2) / (2 * d2))
    radicand = k.let("h2", first2 / d2 - along**2)
    across = k.let("across", sign * sp.sqrt(radicand))
    return Meeting(k.let("meeting", along * line + across * (E * line)), radicand)


@dataclass(frozen=True)
class SpheresMeeting:
    """Both points where three spheres meet: mirrored in the plane of their centres."""

    origin: sp.Matrix
    foot: sp.Matrix
    normal: sp.Matrix
    radicand: Any

    def near(self, k: KernelWriter, point: sp.Matrix) -> Meeting:
        """The one on the side of a point; for a point between them, that on the side of the normal."""
        side = k.let("side", dot(point - self.origin, self.normal))
        height = k.let("height", sp.sqrt(self.radicand) * k.sign(side))
        return Meeting(self.origin + self.foot + height * self.normal, self.radicand)

    def both(self, k: KernelWriter) -> list[Meeting]:
        """Both, first the one on the side of the normal (c_2 - c_1) x (c_3 - c_1)."""
        height = k.let("height", sp.sqrt(self.radicand))
        middle = self.origin + self.foot
        return [Meeting(middle + sign * height * self.normal, self.radicand) for sign in (1, -1)]


def meet_spheres(k: KernelWriter, centres: list[sp.Matrix], squares: list[Any]) -> SpheresMeeting:
    """Where three spheres about these centres, with these squared radii, meet."""
    origin = centres[0]
    a = k.let("g_12", centres[1] - origin)
    b = k.let("g_13", centres[2] - origin)
    n = k.let("n", cross(a, b), "normal of the plane of the centres")
    n2 = k.let("n2", dot(n, n))
    # s - g_1 has the products q_2 with a and q_3 with b
    q_2 = k.let("q_2", (dot(a, a) + squares[0] - squares[1]) / 2)
    q_3 = k.let("q_3", (dot(b, b) + squares[0] - squares[2]) / 2)
    foot = k.let("foot", (q_2 * cross(b, n) + q_3 * cross(n, a)) / n2, "in the plane of the centres")
    radicand = k.let("h2", (squares[0] - dot(foot, foot)) / n2)
    return SpheresMeeting(origin, foot, n, radicand)
