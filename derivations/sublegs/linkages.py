"""Linkages with two actuated joints in a plane, and the sub-legs that they make.

A `Linkage` states formulas in the coordinates of its plane, from its origin; d is the place of S_i there.
On a carrier (`carriers.py`) it is a spatial sub-leg: `CarriedLinkage`.  On the base it is a planar one:
`PlanarLinkage`.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from types import SimpleNamespace
from typing import Any

import sympy as sp

from krhpr.codegen.kernel import Frame, GeometryField, GeometryType, Layout, Port, Unit
from krhpr.codegen.writer import KernelWriter
from krhpr.derivations.sublegs.base import Forward, Passive, Posture, SubLeg, VelocityEquations
from krhpr.derivations.sublegs.carriers import Carrier, begin_geometry, in_plane
from krhpr.derivations.terms import Factor, Joint, Link, Sign, Space
from krhpr.derivations.vectors import E, dot


@dataclass(frozen=True)
class PlaneVelocity:
    """A d_dot = B theta_dot in the linkage's plane, with the factors of det B and det A; det(A^-1 B)."""

    A: sp.Matrix
    B: sp.Matrix
    determinant: Any
    serial: tuple[Factor, ...]
    parallel: tuple[Factor, ...] = ()


@dataclass(frozen=True)
class PlaneForward:
    """Where the joints lead: d, the posture's vectors, and the radicand that must not be negative."""

    d: sp.Matrix
    vectors: dict[str, sp.Matrix]
    radicand: Any = None


class Linkage(ABC):
    """Two actuated joints in a plane; `k.g` has its lengths."""

    signs: tuple[Sign, ...]
    forward_signs: tuple[Sign, ...] = ()
    passive_joints: tuple[Joint, ...] = ()

    @abstractmethod
    def lengths(self) -> tuple[GeometryField, ...]:
        """Its fields of the geometry."""

    @abstractmethod
    def links(self, origin: str) -> tuple[Link, ...]:
        """Links between its `points` and the origin, which is called so."""

    @abstractmethod
    def longest(self, k: KernelWriter) -> Any:
        """The largest distance of S_i from the origin."""

    @abstractmethod
    def forward(self, k: KernelWriter, theta: sp.Matrix, assembly: sp.Matrix) -> PlaneForward:
        """S_i in the plane from the two joints."""

    @abstractmethod
    def inverse(self, k: KernelWriter, d: sp.Matrix, signs: list[Any]) -> tuple[list[Any], list[Any]]:
        """The two joints, and the radicands that must not be negative."""

    @abstractmethod
    def reach(self, k: KernelWriter, d: sp.Matrix, signs: list[Any]) -> Any:
        """By how much S_i is out of reach."""

    @abstractmethod
    def posture_ports(self, frame: Frame, plane: str) -> tuple[Port, ...]:
        """Its vectors in the plane that velocities depend on."""

    @abstractmethod
    def posture(self, k: KernelWriter, d: sp.Matrix, theta: sp.Matrix) -> dict[str, sp.Matrix]:
        """Their values."""

    @abstractmethod
    def velocity(self, k: KernelWriter, at: SimpleNamespace) -> PlaneVelocity:
        """Velocity equations at a posture."""

    @abstractmethod
    def tip(self, k: KernelWriter, at: SimpleNamespace) -> sp.Matrix:
        """The unit vector along the last link, towards S_i."""

    def passive(self, k: KernelWriter, at: SimpleNamespace) -> list[Any]:
        """Angles of its passive joints."""
        return []

    @abstractmethod
    def points(self, k: KernelWriter, at: SimpleNamespace) -> dict[str, sp.Matrix]:
        """Its joints in the plane, from the origin, without S_i."""

    @abstractmethod
    def closure(self, k: KernelWriter, d: sp.Matrix, theta: sp.Matrix) -> list[Any]:
        """Equations that are zero where the two joints lead to d."""


class CarriedLinkage(SubLeg):
    """A spatial sub-leg: a linkage whose plane turns about a first axis or moves along a slide."""

    space = Space.SPATIAL
    carrier: Carrier
    linkage: Linkage

    def geometry(self) -> GeometryType:
        return self.carrier.geometry(f"subleg_{self.name}", self.doc, self.linkage.lengths())

    def forward(self, k: KernelWriter, theta: sp.Matrix, assembly: sp.Matrix) -> Forward:
        found = self.linkage.forward(k, theta[1:, 0], assembly)
        s, posture = self.carrier.place(k, theta[0], found.d)
        return Forward(s, {**posture, **found.vectors}, found.radicand)

    def inverse(
        self, k: KernelWriter, s: sp.Matrix, mode: sp.Matrix, swivel: Any
    ) -> tuple[list[Any], list[Any]]:
        first, d, signs = self._in_plane(k, s, mode)
        rest, radicands = self.linkage.inverse(k, d, signs)
        return [first, *rest], radicands

    def reach(self, k: KernelWriter, s: sp.Matrix, mode: sp.Matrix, swivel: Any) -> Any:
        _, d, signs = self._in_plane(k, s, mode)
        return self.linkage.reach(k, d, signs)

    def _in_plane(self, k: KernelWriter, s: sp.Matrix, mode: sp.Matrix) -> tuple[Any, sp.Matrix, list[Any]]:
        """theta_1, S_i in the linkage plane, and the signs that are left for the linkage."""
        signs, own = list(mode), len(self.carrier.signs)
        first, d = self.carrier.solve(k, s, signs[:own])
        return first, d, signs[own:]

    def posture_ports(self) -> tuple[Port, ...]:
        return (
            *self.carrier.posture_ports(),
            *self.linkage.posture_ports(Frame.JOINT, "in the linkage plane (x, e_1)"),
        )

    def posture(self, k: KernelWriter, s: sp.Matrix, theta: sp.Matrix) -> Posture:
        found = self.carrier.posture(k, s, theta[0])
        return {**found, **self.linkage.posture(k, found["d"], theta[1:, 0])}

    def velocity(self, k: KernelWriter, at: SimpleNamespace) -> VelocityEquations:
        # in the frame (x, e_1, e_2): row 1 is e_2^T s_dot = b_11 theta_1_dot, the others are the linkage's
        plane, b_11 = self.linkage.velocity(k, at), self.carrier.lever(at)
        A = sp.zeros(3, 3)
        A[0, 2], A[1:, :2] = 1, plane.A
        B = sp.zeros(3, 3)
        B[0, 0], B[1:, 1:] = b_11, plane.B
        x, e_2 = self.carrier.axes(k, at)
        return VelocityEquations(
            F=sp.Matrix.hstack(x, k.g.e_1, e_2),
            A=A,
            B=B,
            determinant=b_11 * plane.determinant,
            serial=(*self.carrier.factors(at, self.linkage.longest(k)), *plane.serial),
            parallel=plane.parallel,
        )

    def passive(self, k: KernelWriter, at: SimpleNamespace) -> Passive:
        named = tuple(zip(self.passive_joints, self.linkage.passive(k, at), strict=True))
        u = k.let("dir", self.linkage.tip(k, at), "direction of the last link in (x, e_1)")
        x, e_2 = self.carrier.axes(k, at)
        along = k.let("along", u[0] * x + u[1] * k.g.e_1)
        across = k.let("across", u[0] * k.g.e_1 - u[1] * x, "e_2 x along")
        return Passive(named, sp.Matrix.hstack(along, across, e_2))

    def points(self, k: KernelWriter, at: SimpleNamespace, s: sp.Matrix) -> dict[str, sp.Matrix]:
        found = self.carrier.points(k, at, s)
        (x, _), origin = self.carrier.axes(k, at), found[self.carrier.origin]
        for name, point in self.linkage.points(k, at).items():
            found[name] = origin + point[0] * x + point[1] * k.g.e_1
        return {**found, "S": s}

    def closure(self, k: KernelWriter, s: sp.Matrix, theta: sp.Matrix) -> sp.Matrix:
        # e_2^T (s - c) = theta_1 on a slide and 0 on a first axis, (A.1), (2.33)
        at = SimpleNamespace(**self.carrier.posture(k, s, theta[0]))
        _, e_2 = self.carrier.axes(k, at)
        moved = sp.Integer(0) if self.carrier.signs else theta[0]
        return sp.Matrix([dot(e_2, s - k.g.c) - moved, *self.linkage.closure(k, at.d, theta[1:, 0])])


class PlanarLinkage(SubLeg):
    """A planar sub-leg: a linkage in the plane of the robot, angles from the x axis of the base."""

    space = Space.PLANAR
    linkage: Linkage

    def geometry(self) -> GeometryType:
        return planar_geometry(f"subleg_planar_{self.name}", self.doc, self.linkage.lengths())

    def forward(self, k: KernelWriter, theta: sp.Matrix, assembly: sp.Matrix) -> Forward:
        found = self.linkage.forward(k, theta, assembly)
        return Forward(k.g.o + found.d, {"d": found.d, **found.vectors}, found.radicand)

    def inverse(
        self, k: KernelWriter, s: sp.Matrix, mode: sp.Matrix, swivel: Any
    ) -> tuple[list[Any], list[Any]]:
        return self.linkage.inverse(k, k.let("d", s - k.g.o, "r - o"), list(mode))

    def reach(self, k: KernelWriter, s: sp.Matrix, mode: sp.Matrix, swivel: Any) -> Any:
        return self.linkage.reach(k, k.let("d", s - k.g.o, "r - o"), list(mode))

    def posture_ports(self) -> tuple[Port, ...]:
        d = Port("d", (2,), Unit.METRE, Frame.BASE, "r - o", Layout.STACKED)
        return (d, *self.linkage.posture_ports(Frame.BASE, "in the base frame"))

    def posture(self, k: KernelWriter, s: sp.Matrix, theta: sp.Matrix) -> Posture:
        d = k.let("d", s - k.g.o, "r - o")
        return {"d": d, **self.linkage.posture(k, d, theta)}

    def velocity(self, k: KernelWriter, at: SimpleNamespace) -> VelocityEquations:
        plane = self.linkage.velocity(k, at)
        return VelocityEquations(sp.eye(2), plane.A, plane.B, plane.determinant, plane.serial, plane.parallel)

    def passive(self, k: KernelWriter, at: SimpleNamespace) -> Passive:
        named = tuple(zip(self.passive_joints, self.linkage.passive(k, at), strict=True))
        return Passive(named, self.linkage.tip(k, at))

    def points(self, k: KernelWriter, at: SimpleNamespace, s: sp.Matrix) -> dict[str, sp.Matrix]:
        found = {name: k.g.o + point for name, point in self.linkage.points(k, at).items()}
        return {"A": k.g.o, **found, "S": s}

    def closure(self, k: KernelWriter, s: sp.Matrix, theta: sp.Matrix) -> sp.Matrix:
        return sp.Matrix(self.linkage.closure(k, k.let("d", s - k.g.o, "r - o"), theta))


PLANAR_BASE = (
    GeometryField("azimuth", Unit.RADIAN, "azimuth of the leg on the base"),
    GeometryField("R_b", Unit.METRE, "circumradius of the base", positive=True),
)

AXES_DISTANCE = GeometryField("l_0", Unit.METRE, "distance of the two base joints, along e_t")


RADIAL = ""
"""The leg's radial direction, among the directions of a planar geometry."""


def planar_geometry(
    name: str, doc: str, lengths: tuple[GeometryField, ...], slides: tuple[str, ...] = ()
) -> GeometryType:
    """Geometry of a planar leg: its fields, and its base joint o prepared.

    With a field `l_0` there are two base joints, o and o + o_12, half of it on either side of R_b e_r along
    e_t.  For each field named in `slides`, an angle from e_r, the direction is prepared as e_1, e_2, ...;
    `RADIAL` stands for e_r itself.
    """
    fields = (*PLANAR_BASE, *lengths)
    k, symbols = begin_geometry(fields)
    e_r = k.let("e_r", in_plane(symbols["azimuth"]))
    o = symbols["R_b"] * e_r
    if "l_0" in symbols:
        apart = k.let("apart", symbols["l_0"] * (E * e_r))
        k.output("o", o - apart / 2, Unit.METRE, Frame.BASE, "first base joint")
        k.output("o_12", apart, Unit.METRE, Frame.BASE, "from the first base joint to the second")
    else:
        k.output("o", o, Unit.METRE, Frame.BASE, "base joint")
    for index, field in enumerate(slides, start=1):
        turned = symbols["azimuth"] + symbols[field] if field else symbols["azimuth"]
        what = f"direction of slide {index}" if field else "radial direction"
        k.output(f"e_{index}", in_plane(turned), Unit.NONE, Frame.BASE, what)
    return GeometryType(name, doc, fields, k.kernel())
