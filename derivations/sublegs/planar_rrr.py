"""The redundant planar RRR sub-leg: r = o + l_1 u(t_1) + l_2 u(t_1 + t_2) + l_3 u(t_1 + t_2 + t_3).

Its swivel is the direction of the last link, t_1 + t_2 + t_3, from the x axis of the base.
"""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import sympy as sp

from krhpr.codegen.kernel import Frame, GeometryField, GeometryType, Layout, Port, Unit
from krhpr.codegen.writer import KernelWriter
from krhpr.derivations.sublegs.base import Forward, Passive, Posture, SubLeg, VelocityEquations
from krhpr.derivations.sublegs.carriers import in_plane
from krhpr.derivations.sublegs.linkages import planar_geometry
from krhpr.derivations.sublegs.two_link import ELBOW, distance, outside, two_link
from krhpr.derivations.terms import Factor, Joint, JointKind, Link, LinkKind, Space
from krhpr.derivations.vectors import E, cross2, dot


class PlanarRRR(SubLeg):
    """Three actuated revolute joints in series, one more than the end point has coordinates."""

    name = "rrr"
    space = Space.PLANAR
    notation = "RRR"
    section = "2.2.3"
    doc = "Redundant planar serial sub-leg with three actuated revolute joints."
    equations = "2.2.3, 2.5"
    actuators = (
        Joint("theta_1", JointKind.REVOLUTE, "first link, from the x axis of the base"),
        Joint("theta_2", JointKind.REVOLUTE, "second link relative to the first"),
        Joint("theta_3", JointKind.REVOLUTE, "last link relative to the second"),
    )
    swivel = Joint("swivel", JointKind.REVOLUTE, "direction of the last link, from the x axis of the base")
    inverse_signs = (ELBOW,)
    links = (
        Link("l_1", LinkKind.PROXIMAL, "A", "E"),
        Link("l_2", LinkKind.PROXIMAL, "E", "W"),
        Link("l_3", LinkKind.DISTAL, "W", "S"),
    )
    actuated_at = ("A", "E", "W")
    default_mode = "elbow+"

    def geometry(self) -> GeometryType:
        names = ("first", "second", "last")
        lengths = tuple(
            GeometryField(f"l_{n}", Unit.METRE, f"{name} link", positive=True)
            for n, name in enumerate(names, 1)
        )
        return planar_geometry(f"subleg_planar_{self.name}", self.doc, lengths)

    def forward(self, k: KernelWriter, theta: sp.Matrix, assembly: sp.Matrix) -> Forward:
        u_2 = k.let("u_2", k.g.l_2 * in_plane(theta[0] + theta[1]), "second link")
        u_3 = k.let("u_3", k.g.l_3 * in_plane(theta[0] + theta[1] + theta[2]), "last link")
        d = k.let("d", k.g.l_1 * in_plane(theta[0]) + u_2 + u_3, "r - o")
        return Forward(k.g.o + d, {"d": d, "u_2": u_2, "u_3": u_3})

    def inverse(
        self, k: KernelWriter, s: sp.Matrix, mode: sp.Matrix, swivel: Any
    ) -> tuple[list[Any], list[Any]]:
        last = k.let("dir", in_plane(swivel), "direction of the last link")
        w = self._wrist(k, s, last)
        arm = two_link(k, w[0], w[1], k.g.l_1, k.g.l_2, mode[0])
        # the last joint by the directions of the second link, which leads from the elbow to the wrist, and
        # the last
        second = k.let("u_2", w - arm.link)
        theta_3 = k.atan2(cross2(second, last), second[0] * last[0] + second[1] * last[1])
        return [arm.inner, arm.elbow, theta_3], [arm.radicand]

    def reach(self, k: KernelWriter, s: sp.Matrix, mode: sp.Matrix, swivel: Any) -> Any:
        return outside(k, distance(k, self._wrist(k, s, in_plane(swivel))), k.g.l_1, k.g.l_2)

    def _wrist(self, k: KernelWriter, s: sp.Matrix, last: sp.Matrix) -> sp.Matrix:
        """Where the last link begins, from o."""
        return k.let("w", s - k.g.o - k.g.l_3 * last, "wrist - o")

    def posture_ports(self) -> tuple[Port, ...]:
        vectors = (("d", "r - o"), ("u_2", "second link"), ("u_3", "last link"))
        return tuple(Port(name, (2,), Unit.METRE, Frame.BASE, doc, Layout.STACKED) for name, doc in vectors)

    def posture(self, k: KernelWriter, s: sp.Matrix, theta: sp.Matrix) -> Posture:
        d = k.let("d", s - k.g.o, "r - o")
        u_2 = k.let("u_2", k.g.l_2 * in_plane(theta[0] + theta[1]), "second link")
        return {"d": d, "u_2": u_2, "u_3": k.let("u_3", d - u_2 - k.g.l_1 * in_plane(theta[0]), "last link")}

    def velocity(self, k: KernelWriter, at: SimpleNamespace) -> VelocityEquations:
        # M = [E (r - o), E (r - p_1), E (r - p_2)]; the swivel's rate is the sum of all
        columns = (at.d, at.u_2 + at.u_3, at.u_3)
        elbow = k.let("elbow", cross2(at.d - at.u_2 - at.u_3, at.u_2) / (k.g.l_1 * k.g.l_2), "sin(theta_2)")
        return VelocityEquations(
            F=sp.eye(2),
            A=sp.eye(3),
            B=sp.Matrix.vstack(sp.Matrix.hstack(*(E * column for column in columns)), sp.ones(1, 3)),
            determinant=None,
            serial=(
                Factor(
                    "elbow", elbow, "first and second link aligned: the last link's direction is not free"
                ),
            ),
        )

    def rates(
        self, k: KernelWriter, at: SimpleNamespace, equations: VelocityEquations, task: sp.Matrix
    ) -> sp.Matrix:
        # w_dot = r_dot - swivel_dot E u_3 = t_1 E u_1 + t_2 E u_2 with the rates t_1 and t_2 of the links
        # u_1 and u_2; products with u_2 and u_1 leave one unknown each, over the elbow's factor.
        u_1 = k.let("u_1", at.d - at.u_2 - at.u_3, "first link")
        w_dot = k.let("w_dot", sp.Matrix(task[:2]) - task[2] * (E * at.u_3), "velocity of the wrist")
        sine = k.let("l12_sin_2", k.g.l_1 * k.g.l_2 * equations.serial[0].value, "l_1 l_2 sin(theta_2)")
        first = k.let("t_1", dot(w_dot, at.u_2) / sine, "rate of the first link")
        second = k.let("t_2", -dot(w_dot, u_1) / sine, "rate of the second link")
        return sp.Matrix([first, second - first, task[2] - second])

    def swivel_angle(self, k: KernelWriter, at: SimpleNamespace) -> Any:
        return k.atan2(at.u_3[1], at.u_3[0])

    def passive(self, k: KernelWriter, at: SimpleNamespace) -> Passive:
        return Passive((), at.u_3 / k.g.l_3)

    def points(self, k: KernelWriter, at: SimpleNamespace, s: sp.Matrix) -> dict[str, sp.Matrix]:
        wrist = k.let("wrist", s - at.u_3)
        return {"A": k.g.o, "E": wrist - at.u_2, "W": wrist, "S": s}

    def closure(self, k: KernelWriter, s: sp.Matrix, theta: sp.Matrix) -> sp.Matrix:
        return s - self.forward(k, theta, sp.Matrix(0, 1, [])).s
