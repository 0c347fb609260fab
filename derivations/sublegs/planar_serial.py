"""Planar serial sub-legs with slides: PR, RP and PP (Section 2.2.3; errata for planar robots, 3.3)."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import sympy as sp

from krhpr.codegen.kernel import Frame, GeometryField, GeometryType, Layout, Port, Unit
from krhpr.codegen.writer import KernelWriter
from krhpr.derivations.sublegs.base import Forward, Passive, Posture, SubLeg, VelocityEquations
from krhpr.derivations.sublegs.carriers import in_plane
from krhpr.derivations.sublegs.linkages import planar_geometry
from krhpr.derivations.terms import Factor, Joint, JointKind, Link, LinkKind, Sign, Space
from krhpr.derivations.vectors import E, cross2, dot


def slide_field(name: str, doc: str) -> GeometryField:
    """The direction of a slide, measured so that it turns with the leg."""
    return GeometryField(name, Unit.RADIAN, f"direction of {doc}, from the leg's radial direction")


def vector_port(name: str, doc: str) -> Port:
    """A vector of a planar leg's posture."""
    return Port(name, (2,), Unit.METRE, Frame.BASE, doc, Layout.STACKED)


class PR(SubLeg):
    """A slide along e and a link: r = o + rho e + l u(t)."""

    name = "pr"
    space = Space.PLANAR
    notation = "PR"
    section = "2.2.3"
    doc = "Planar serial sub-leg with an actuated slide and an actuated revolute joint on it."
    equations = "2.2.3, 2.5"
    actuators = (
        Joint("rho", JointKind.PRISMATIC, "slide along e, from the base joint"),
        Joint("theta", JointKind.REVOLUTE, "link, from the x axis of the base"),
    )
    inverse_signs = (Sign("link", "ahead", "behind", "sign of the link's part along e"),)
    links = (Link("rho", LinkKind.SLIDE, "A", "D"), Link("l_1", LinkKind.DISTAL, "D", "S"))
    actuated_at = ("rho", "D")
    default_mode = "ahead"

    def geometry(self) -> GeometryType:
        fields = (slide_field("slide", "the slide"), GeometryField("l_1", Unit.METRE, "link", positive=True))
        return planar_geometry(f"subleg_planar_{self.name}", self.doc, fields, ("slide",))

    def forward(self, k: KernelWriter, theta: sp.Matrix, assembly: sp.Matrix) -> Forward:
        u = k.let("u", k.g.l_1 * in_plane(theta[1]), "link")
        return Forward(k.g.o + theta[0] * k.g.e_1 + u, {"u": u})

    def inverse(
        self, k: KernelWriter, s: sp.Matrix, mode: sp.Matrix, swivel: Any
    ) -> tuple[list[Any], list[Any]]:
        d = k.let("d", s - k.g.o, "r - o")
        across = k.let("across", cross2(k.g.e_1, d), "the link's part normal to e")
        radicand = k.let("h2", k.g.l_1**2 - across**2)
        along = k.let("along", mode[0] * sp.sqrt(radicand), "the link's part along e")
        u = along * k.g.e_1 + across * (E * k.g.e_1)
        return [dot(d, k.g.e_1) - along, k.atan2(u[1], u[0])], [radicand]

    def reach(self, k: KernelWriter, s: sp.Matrix, mode: sp.Matrix, swivel: Any) -> Any:
        return k.absolute(cross2(k.g.e_1, s - k.g.o)) - k.g.l_1

    def posture_ports(self) -> tuple[Port, ...]:
        return (vector_port("u", "link"),)

    def posture(self, k: KernelWriter, s: sp.Matrix, theta: sp.Matrix) -> Posture:
        return {"u": k.let("u", k.g.l_1 * in_plane(theta[1]), "link")}

    def velocity(self, k: KernelWriter, at: SimpleNamespace) -> VelocityEquations:
        along = k.let("along", dot(k.g.e_1, at.u), "e^T u")
        return VelocityEquations(
            F=sp.eye(2),
            A=sp.eye(2),
            B=sp.Matrix.hstack(k.g.e_1, E * at.u),
            determinant=along,
            serial=(Factor("link", along / k.g.l_1, "link normal to the slide"),),
        )

    def passive(self, k: KernelWriter, at: SimpleNamespace) -> Passive:
        return Passive((), at.u / k.g.l_1)

    def points(self, k: KernelWriter, at: SimpleNamespace, s: sp.Matrix) -> dict[str, sp.Matrix]:
        return {"A": k.g.o, "D": s - at.u, "S": s}

    def closure(self, k: KernelWriter, s: sp.Matrix, theta: sp.Matrix) -> sp.Matrix:
        return s - self.forward(k, theta, sp.Matrix(0, 1, [])).s


class RP(SubLeg):
    """A turning slide: r = o + rho u(t) + h E u(t)."""

    name = "rp"
    space = Space.PLANAR
    notation = "RP"
    section = "2.2.3"
    doc = "Planar serial sub-leg with an actuated revolute joint that turns an actuated slide."
    equations = "2.2.3, 2.5"
    actuators = (
        Joint("theta", JointKind.REVOLUTE, "direction u of the slide, from the x axis of the base"),
        Joint("rho", JointKind.PRISMATIC, "slide along u"),
    )
    inverse_signs = (Sign("slide", "rho+", "rho-", "sign of rho"),)
    links = (Link("h", LinkKind.FIXED, "A", "D"), Link("rho", LinkKind.SLIDE, "D", "S"))
    actuated_at = ("A", "rho")
    default_mode = "rho+"

    def geometry(self) -> GeometryType:
        fields = (GeometryField("h", Unit.METRE, "offset of the slide from the revolute joint, along E u"),)
        return planar_geometry(f"subleg_planar_{self.name}", self.doc, fields)

    def forward(self, k: KernelWriter, theta: sp.Matrix, assembly: sp.Matrix) -> Forward:
        u = k.let("u", in_plane(theta[0]), "direction of the slide")
        d = k.let("d", theta[1] * u + k.g.h * (E * u), "r - o")
        return Forward(k.g.o + d, {"d": d, "u": u})

    def inverse(
        self, k: KernelWriter, s: sp.Matrix, mode: sp.Matrix, swivel: Any
    ) -> tuple[list[Any], list[Any]]:
        d = k.let("d", s - k.g.o, "r - o")
        radicand = k.let("h2", dot(d, d) - k.g.h**2)
        rho = k.let("rho", mode[0] * sp.sqrt(radicand))
        # d is (rho, h) turned by theta
        return [k.atan2(rho * d[1] - k.g.h * d[0], rho * d[0] + k.g.h * d[1]), rho], [radicand]

    def reach(self, k: KernelWriter, s: sp.Matrix, mode: sp.Matrix, swivel: Any) -> Any:
        d = k.let("d", s - k.g.o, "r - o")
        return k.absolute(k.g.h) - sp.sqrt(dot(d, d))

    def posture_ports(self) -> tuple[Port, ...]:
        direction = Port("u", (2,), Unit.NONE, Frame.BASE, "direction of the slide", Layout.STACKED)
        return (vector_port("d", "r - o"), direction)

    def posture(self, k: KernelWriter, s: sp.Matrix, theta: sp.Matrix) -> Posture:
        return {"d": k.let("d", s - k.g.o, "r - o"), "u": k.let("u", in_plane(theta[0]))}

    def velocity(self, k: KernelWriter, at: SimpleNamespace) -> VelocityEquations:
        # M = [E (r - o), u], det M = -rho
        rho = k.let("rho", dot(at.d, at.u))
        return VelocityEquations(
            F=sp.eye(2),
            A=sp.eye(2),
            B=sp.Matrix.hstack(E * at.d, at.u),
            determinant=-rho,
            serial=(Factor("slide", rho / k.g.R_b, "rho = 0"),),
        )

    def passive(self, k: KernelWriter, at: SimpleNamespace) -> Passive:
        return Passive((), at.u)

    def points(self, k: KernelWriter, at: SimpleNamespace, s: sp.Matrix) -> dict[str, sp.Matrix]:
        return {"A": k.g.o, "D": k.g.o + k.g.h * (E * at.u), "S": s}

    def closure(self, k: KernelWriter, s: sp.Matrix, theta: sp.Matrix) -> sp.Matrix:
        return s - self.forward(k, theta, sp.Matrix(0, 1, [])).s


class PP(SubLeg):
    """Two slides: r = o + rho_1 e_1 + rho_2 e_2."""

    name = "pp"
    space = Space.PLANAR
    notation = "PP"
    section = "2.2.3"
    doc = "Planar serial sub-leg with two actuated slides."
    equations = "2.2.3, 2.5"
    actuators = (
        Joint("rho_1", JointKind.PRISMATIC, "slide along e_1, from the base joint"),
        Joint("rho_2", JointKind.PRISMATIC, "slide along e_2 on the first one"),
    )
    links = (Link("rho_1", LinkKind.SLIDE, "A", "D"), Link("rho_2", LinkKind.SLIDE, "D", "S"))
    actuated_at = ("rho_1", "rho_2")

    def geometry(self) -> GeometryType:
        fields = (slide_field("slide_1", "the first slide"), slide_field("slide_2", "the second slide"))
        return planar_geometry(f"subleg_planar_{self.name}", self.doc, fields, ("slide_1", "slide_2"))

    def forward(self, k: KernelWriter, theta: sp.Matrix, assembly: sp.Matrix) -> Forward:
        last = k.let("v", theta[1] * k.g.e_2)
        return Forward(k.g.o + theta[0] * k.g.e_1 + last, {"v": last})

    def inverse(
        self, k: KernelWriter, s: sp.Matrix, mode: sp.Matrix, swivel: Any
    ) -> tuple[list[Any], list[Any]]:
        d = k.let("d", s - k.g.o, "r - o")
        sine = k.let("sine", cross2(k.g.e_1, k.g.e_2))
        return [cross2(d, k.g.e_2) / sine, cross2(k.g.e_1, d) / sine], []

    def posture_ports(self) -> tuple[Port, ...]:
        return (vector_port("v", "the second slide"),)

    def posture(self, k: KernelWriter, s: sp.Matrix, theta: sp.Matrix) -> Posture:
        return {"v": k.let("v", theta[1] * k.g.e_2)}

    def velocity(self, k: KernelWriter, at: SimpleNamespace) -> VelocityEquations:
        sine = k.let("sine", cross2(k.g.e_1, k.g.e_2))
        return VelocityEquations(
            F=sp.eye(2),
            A=sp.eye(2),
            B=sp.Matrix.hstack(k.g.e_1, k.g.e_2),
            determinant=sine,
            serial=(Factor("slides", sine, "the slides are parallel"),),
        )

    def passive(self, k: KernelWriter, at: SimpleNamespace) -> Passive:
        return Passive((), k.g.e_2)

    def points(self, k: KernelWriter, at: SimpleNamespace, s: sp.Matrix) -> dict[str, sp.Matrix]:
        return {"A": k.g.o, "D": s - at.v, "S": s}

    def closure(self, k: KernelWriter, s: sp.Matrix, theta: sp.Matrix) -> sp.Matrix:
        return s - self.forward(k, theta, sp.Matrix(0, 1, [])).s
