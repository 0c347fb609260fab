"""The planar two-link chain: the closed form that every sub-leg with an elbow uses, and the linkage it makes.

A point (x, y) at distance d from the first joint, links a (inner) and b (outer), elbow angle psi from the
inner to the outer link.  With C = d^2 - a^2 - b^2 = 2 a b cos(psi) and S = 2 a b sin(psi),

    S^2 = 4 a^2 b^2 - C^2 = ((a + b)^2 - d^2) (d^2 - (a - b)^2),

so psi = atan2(S, C) and the inner link is at atan2(y A - x S, x A + y S) with A = 2 a^2 + C = 2 a (a + b
cos(psi)); as a vector it is (x A + y S, y A - x S) / (2 d^2). No angle is subtracted, nothing is divided,
nothing is lost where the elbow is straight or folded (the thesis' half-angle forms (B.14) lose the root at
pi).
"""

from __future__ import annotations

from dataclasses import dataclass
from types import SimpleNamespace
from typing import Any

import sympy as sp

from krhpr.codegen.kernel import Frame, GeometryField, Layout, Port, Unit
from krhpr.codegen.writer import KernelWriter
from krhpr.derivations.sublegs.carriers import in_plane
from krhpr.derivations.sublegs.linkages import Linkage, PlaneForward, PlaneVelocity
from krhpr.derivations.terms import Factor, Link, LinkKind, Sign
from krhpr.derivations.vectors import E, cross2, dot


@dataclass(frozen=True)
class Solution:
    """Inner link angle and vector, elbow angle (relative), and the radicand that decides whether there is a
    solution.
    """

    inner: Any
    elbow: Any
    radicand: Any
    link: sp.Matrix


def two_link(
    k: KernelWriter, x: Any, y: Any, a: Any, b: Any, sign: Any, *, elbow: bool = True, suffix: str = ""
) -> Solution:
    """Solve the two-link chain in the branch `sign` = sign of sin(psi)."""
    d2 = k.let(f"d2{suffix}", x**2 + y**2)
    longest, shortest = (a + b) ** 2, (a - b) ** 2
    radicand = k.let(f"h2{suffix}", (longest - d2) * (d2 - shortest), "4 a^2 b^2 sin^2")
    s = k.let(f"S{suffix}", sign * sp.sqrt(radicand), "2 a b sin")
    c = k.let(f"C{suffix}", d2 - k.let(f"sum{suffix}", a**2 + b**2), "2 a b cos")
    reach = k.let(f"A{suffix}", d2 + k.let(f"difference{suffix}", a**2 - b**2), "2 a (a + b cos)")
    along, across = k.let(f"n{suffix}", x * reach + y * s), k.let(f"m{suffix}", y * reach - x * s)
    link = sp.Matrix([along, across]) / (2 * d2)
    return Solution(k.atan2(across, along), k.atan2(s, c) if elbow else None, radicand, link)


def outside(k: KernelWriter, distance: Any, a: Any, b: Any) -> Any:
    """By how much a point at `distance` lies outside the annulus of a two-link chain."""
    return k.maximum(distance - (a + b), k.absolute(a - b) - distance)


def distance(k: KernelWriter, d: sp.Matrix, name: str = "distance") -> Any:
    """The length of a vector."""
    return k.let(name, sp.sqrt(dot(d, d)))


ELBOW = Sign("elbow", "elbow+", "elbow-", "sign of the sine of the elbow's angle")


class TwoLink(Linkage):
    """Two links in series, the second joint relative to the first link:

    d = a u(t_1) + b u(t_1 + t_2), with the lengths a and b called `inner` and `outer` in the geometry.
    """

    signs = (ELBOW,)

    def __init__(self, inner: str, outer: str) -> None:
        self.inner, self.outer = inner, outer

    def _lengths(self, k: KernelWriter) -> tuple[Any, Any]:
        return getattr(k.g, self.inner), getattr(k.g, self.outer)

    def lengths(self) -> tuple[GeometryField, ...]:
        return (
            GeometryField(self.inner, Unit.METRE, "link to the elbow", positive=True),
            GeometryField(self.outer, Unit.METRE, "link from the elbow to the end point", positive=True),
        )

    def links(self, origin: str) -> tuple[Link, ...]:
        return (
            Link(self.inner, LinkKind.PROXIMAL, origin, "E"),
            Link(self.outer, LinkKind.DISTAL, "E", "S"),
        )

    def longest(self, k: KernelWriter) -> Any:
        return sum(self._lengths(k))

    def forward(self, k: KernelWriter, theta: sp.Matrix, assembly: sp.Matrix) -> PlaneForward:
        a, b = self._lengths(k)
        v = k.let("v_1", b * in_plane(theta[0] + theta[1]), "last link")
        return PlaneForward(k.let("d", a * in_plane(theta[0]) + v), {"v_1": v})

    def inverse(self, k: KernelWriter, d: sp.Matrix, signs: list[Any]) -> tuple[list[Any], list[Any]]:
        (sign,) = signs
        arm = two_link(k, d[0], d[1], *self._lengths(k), sign)
        return [arm.inner, arm.elbow], [arm.radicand]

    def reach(self, k: KernelWriter, d: sp.Matrix, signs: list[Any]) -> Any:
        return outside(k, distance(k, d), *self._lengths(k))

    def posture_ports(self, frame: Frame, plane: str) -> tuple[Port, ...]:
        return (Port("v_1", (2,), Unit.METRE, frame, f"last link {plane}", Layout.STACKED),)

    def posture(self, k: KernelWriter, d: sp.Matrix, theta: sp.Matrix) -> dict[str, sp.Matrix]:
        a, _ = self._lengths(k)
        return {"v_1": k.let("v_1", d - a * in_plane(theta[0]), "last link")}

    def velocity(self, k: KernelWriter, at: SimpleNamespace) -> PlaneVelocity:
        # (2.15): columns e_2 x d and e_2 x v_1
        a, b = self._lengths(k)
        elbow = k.let("elbow", cross2(at.d, at.v_1), "a b sin(t_2)")
        return PlaneVelocity(
            A=sp.eye(2),
            B=sp.Matrix.hstack(E * at.d, E * at.v_1),
            determinant=elbow,
            serial=(
                Factor("elbow", elbow / (a * b), "links aligned, the sine of the elbow's angle is zero"),
            ),
        )

    def tip(self, k: KernelWriter, at: SimpleNamespace) -> sp.Matrix:
        return at.v_1 / self._lengths(k)[1]

    def points(self, k: KernelWriter, at: SimpleNamespace) -> dict[str, sp.Matrix]:
        return {"E": at.d - at.v_1}

    def closure(self, k: KernelWriter, d: sp.Matrix, theta: sp.Matrix) -> list[Any]:
        return list(d - self.forward(k, theta, sp.Matrix(0, 1, [])).d)
