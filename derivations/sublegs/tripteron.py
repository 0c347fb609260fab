"""The Tripteron as a sub-leg (Section 2.4.4; errata, 6): s = c + R rho, three slides along the leg frame's
axes.

Slide k moves along axis k of R = [e_x, e_1, e_t] through c; two links of lengths l_2 and l_3, hinged about
axes parallel to the slide, lead from there to S_i and leave it free in the plane normal to the slide.  M_i =
R is constant: there is no singularity but the limit of the links' reach.
"""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import sympy as sp

from krhpr.codegen.kernel import Frame, GeometryField, GeometryType, Layout, Port, Unit
from krhpr.codegen.writer import KernelWriter
from krhpr.derivations.sublegs.base import (
    Forward,
    Passive,
    PassiveLoops,
    Posture,
    SubLeg,
    VelocityEquations,
)
from krhpr.derivations.sublegs.carriers import leg_axes, leg_frame_geometry
from krhpr.derivations.sublegs.two_link import outside, two_link
from krhpr.derivations.terms import Factor, Joint, JointKind, Link, LinkKind, Space
from krhpr.derivations.vectors import dot

SLIDES = (1, 2, 3)


class Tripteron(SubLeg):
    """Three slides at right angles."""

    name = "tripteron"
    space = Space.SPATIAL
    notation = "(Tripteron)"
    section = "2.4.4"
    doc = "Parallel sub-leg: three actuated slides at right angles, each moving S_i along its own axis alone."
    equations = "2.4.4"
    actuators = tuple(
        Joint(f"rho_{n}", JointKind.PRISMATIC, f"slide along {axis}, from c")
        for n, axis in zip(SLIDES, ("e_x", "e_1", "e_t"), strict=True)
    )
    passive_joints = tuple(
        Joint(f"{name}_{n}", JointKind.REVOLUTE, f"links of slide {n}: {doc}")
        for n in SLIDES
        for name, doc in (
            ("hinge", "first link about the slide's axis, from the next axis of R towards the one after"),
            ("elbow", "second link relative to the first, positive"),
        )
    )
    actuated_at = tuple(f"rho_{n}" for n in SLIDES)
    links = tuple(
        link
        for n in SLIDES
        for link in (
            Link(f"rho_{n}", LinkKind.SLIDE, "c", f"D_{n}"),
            Link("l_2", LinkKind.PROXIMAL, f"D_{n}", f"E_{n}"),
            Link("l_3", LinkKind.DISTAL, f"E_{n}", "S"),
        )
    )

    def geometry(self) -> GeometryType:
        lengths = (
            GeometryField("l_2", Unit.METRE, "first link of each slide", positive=True),
            GeometryField("l_3", Unit.METRE, "second link of each slide", positive=True),
        )
        return leg_frame_geometry(f"subleg_{self.name}", self.doc, lengths)

    def _axes(self, k: KernelWriter) -> sp.Matrix:
        return leg_axes(k)

    def forward(self, k: KernelWriter, theta: sp.Matrix, assembly: sp.Matrix) -> Forward:
        radicand = k.minimum(*self._radicands(k, theta))
        return Forward(k.g.c + self._axes(k) * theta, {"rho": theta}, radicand)

    def inverse(
        self, k: KernelWriter, s: sp.Matrix, mode: sp.Matrix, swivel: Any
    ) -> tuple[list[Any], list[Any]]:
        rho = self._rho(k, s)
        return list(rho), self._radicands(k, rho)

    def _rho(self, k: KernelWriter, s: sp.Matrix) -> sp.Matrix:
        arm = k.let("arm", s - k.g.c, "s - c")
        return k.let("rho", sp.Matrix([dot(arm, axis) for axis in (k.g.e_x, k.g.e_1, k.g.e_t)]))

    def _squares(self, rho: sp.Matrix) -> list[Any]:
        """Squared distances from the slides to S_i."""
        return [rho[n % 3] ** 2 + rho[(n + 1) % 3] ** 2 for n in SLIDES]

    def _radicands(self, k: KernelWriter, rho: sp.Matrix) -> list[Any]:
        """4 l_2^2 l_3^2 sin^2 of the elbow's angle of each slide."""
        a, b = k.g.l_2, k.g.l_3
        return [((a + b) ** 2 - d2) * (d2 - (a - b) ** 2) for d2 in self._squares(rho)]

    def reach(self, k: KernelWriter, s: sp.Matrix, mode: sp.Matrix, swivel: Any) -> Any:
        rho = self._rho(k, s)
        excess = [
            outside(k, k.let(f"distance_{n}", sp.sqrt(d2)), k.g.l_2, k.g.l_3)
            for n, d2 in zip(SLIDES, self._squares(rho), strict=True)
        ]
        return k.maximum(*excess)

    def posture_ports(self) -> tuple[Port, ...]:
        return (Port("rho", (3,), Unit.METRE, Frame.JOINT, "the slides", Layout.STACKED),)

    def posture(self, k: KernelWriter, s: sp.Matrix, theta: sp.Matrix) -> Posture:
        return {"rho": theta}

    def velocity(self, k: KernelWriter, at: SimpleNamespace) -> VelocityEquations:
        scale = (2 * k.g.l_2 * k.g.l_3) ** 2
        stretched = tuple(
            Factor(
                f"links_{n}",
                value / scale,
                f"links of slide {n} aligned, the end of their reach (sine squared)",
            )
            for n, value in zip(SLIDES, self._radicands(k, at.rho), strict=True)
        )
        return VelocityEquations(self._axes(k), sp.eye(3), sp.eye(3), sp.Integer(1), (), others=stretched)

    def _links(self, k: KernelWriter, rho: sp.Matrix, number: int, *, elbow: bool) -> Any:
        x, y = rho[number % 3], rho[(number + 1) % 3]
        return two_link(k, x, y, k.g.l_2, k.g.l_3, sp.Integer(1), elbow=elbow, suffix=f"_{number}")

    def passive(self, k: KernelWriter, at: SimpleNamespace) -> Passive:
        angles = []
        for n in SLIDES:
            arm = self._links(k, at.rho, n, elbow=True)
            angles += [arm.inner, arm.elbow]
        return Passive(tuple(zip(self.passive_joints, angles, strict=True)), self._axes(k))

    def loops(self, k: KernelWriter, at: SimpleNamespace) -> PassiveLoops:
        # links of equal lengths that are folded leave the direction of the pair free
        lengths = tuple(d2 / (k.g.l_2 + k.g.l_3) ** 2 for d2 in self._squares(at.rho))
        return PassiveLoops(tuple(self._radicands(k, at.rho)), lengths)

    def points(self, k: KernelWriter, at: SimpleNamespace, s: sp.Matrix) -> dict[str, sp.Matrix]:
        axes = (k.g.e_x, k.g.e_1, k.g.e_t)
        found = {"c": k.g.c}
        for n in SLIDES:
            slider = k.let(f"slider_{n}", k.g.c + at.rho[n - 1] * axes[n - 1])
            link = self._links(k, at.rho, n, elbow=False).link
            found[f"D_{n}"] = slider
            found[f"E_{n}"] = slider + link[0] * axes[n % 3] + link[1] * axes[(n + 1) % 3]
        return {**found, "S": s}

    def closure(self, k: KernelWriter, s: sp.Matrix, theta: sp.Matrix) -> sp.Matrix:
        return s - self.forward(k, theta, sp.Matrix(0, 1, [])).s
