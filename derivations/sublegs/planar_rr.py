"""The planar serial RR sub-leg of Section 2.2: r = o + l_1 u(t_1) + l_2 u(t_1 + t_2)."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import sympy as sp

from krhpr.codegen.kernel import Frame, GeometryField, GeometryType, Layout, Port, Unit
from krhpr.codegen.writer import KernelWriter
from krhpr.derivations.sublegs.base import Forward, Passive, Posture, SubLeg, VelocityEquations
from krhpr.derivations.sublegs.first_axis import in_plane
from krhpr.derivations.sublegs.two_link import outside, two_link
from krhpr.derivations.terms import Factor, Joint, JointKind, Link, LinkKind, Sign, Space
from krhpr.derivations.vectors import E, cross2, dot


class RR(SubLeg):
    """Two actuated revolute joints in series, (2.4)."""

    name = "rr"
    space = Space.PLANAR
    notation = "RR"
    section = "2.2"
    doc = "Planar serial sub-leg with two actuated revolute joints."
    equations = "2.2.1, 2.5"
    actuators = (
        Joint("theta_1", JointKind.REVOLUTE, "first link, from the x axis of the base"),
        Joint("theta_2", JointKind.REVOLUTE, "second link relative to the first"),
    )
    inverse_signs = (Sign("elbow", "elbow+", "elbow-", "sign of sin(theta_2)"),)
    links = (Link("l_1", LinkKind.PROXIMAL, "A", "E"), Link("l_2", LinkKind.DISTAL, "E", "S"))
    default_mode = "elbow+"

    def geometry(self) -> GeometryType:
        fields = (
            GeometryField("azimuth", Unit.RADIAN, "azimuth of the leg on the base"),
            GeometryField("R_b", Unit.METRE, "circumradius of the base", positive=True),
            GeometryField("l_1", Unit.METRE, "first link", positive=True),
            GeometryField("l_2", Unit.METRE, "second link", positive=True),
        )
        k = KernelWriter("prepare", "Vectors and sub-expressions that depend on the geometry alone.")
        azimuth, radius, _, _ = (k.input(field.name, (), field.unit, doc=field.doc) for field in fields)
        k.output(
            "o", radius * sp.Matrix([sp.cos(azimuth), sp.sin(azimuth)]), Unit.METRE, Frame.BASE, "base joint"
        )
        return GeometryType("subleg_planar_rr", self.doc, fields, k.kernel())

    def forward(self, k: KernelWriter, theta: sp.Matrix, assembly: sp.Matrix) -> Forward:
        u_2 = k.let("u_2", k.g.l_2 * in_plane(theta[0] + theta[1]), "second link")
        d = k.let("d", k.g.l_1 * in_plane(theta[0]) + u_2, "r - o")
        return Forward(k.g.o + d, {"d": d, "u_2": u_2})

    def inverse(
        self, k: KernelWriter, s: sp.Matrix, mode: sp.Matrix, swivel: Any
    ) -> tuple[list[Any], list[Any]]:
        d = k.let("d", s - k.g.o, "r - o")
        arm = two_link(k, d[0], d[1], k.g.l_1, k.g.l_2, mode[0])
        return [arm.inner, arm.elbow], [arm.radicand]

    def reach(self, k: KernelWriter, s: sp.Matrix, mode: sp.Matrix) -> Any:
        d = k.let("d", s - k.g.o)
        return outside(k, k.let("distance", sp.sqrt(dot(d, d))), k.g.l_1, k.g.l_2)

    def posture_ports(self) -> tuple[Port, ...]:
        return (
            Port("d", (2,), Unit.METRE, Frame.BASE, "r - o", Layout.STACKED),
            Port("u_2", (2,), Unit.METRE, Frame.BASE, "second link", Layout.STACKED),
        )

    def posture(self, k: KernelWriter, s: sp.Matrix, theta: sp.Matrix) -> Posture:
        d = k.let("d", s - k.g.o, "r - o")
        return {"d": d, "u_2": k.let("u_2", d - k.g.l_1 * in_plane(theta[0]), "second link")}

    def velocity(self, k: KernelWriter, at: SimpleNamespace) -> VelocityEquations:
        # M = [E (r - o), E (r - elbow)]
        determinant = k.let("det", cross2(at.d, at.u_2), "l_1 l_2 sin(theta_2)")
        return VelocityEquations(
            F=sp.eye(2),
            A=sp.eye(2),
            B=sp.Matrix.hstack(E * at.d, E * at.u_2),
            determinant=determinant,
            serial=(Factor("elbow", determinant / (k.g.l_1 * k.g.l_2), "links aligned, sin(theta_2) = 0"),),
        )

    def passive(self, k: KernelWriter, at: SimpleNamespace) -> Passive:
        return Passive((), at.u_2 / k.g.l_2)

    def points(self, k: KernelWriter, at: SimpleNamespace, s: sp.Matrix) -> dict[str, sp.Matrix]:
        return {"A": k.g.o, "E": s - at.u_2, "S": s}

    def closure(self, k: KernelWriter, s: sp.Matrix, theta: sp.Matrix) -> sp.Matrix:
        return s - self.forward(k, theta, sp.Matrix(0, 1, [])).s
