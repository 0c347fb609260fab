"""The hybrid sub-leg R(RR-RRR) of Chapter 1: a first axis that carries a planar five-bar linkage.

Names of Chapter 1: crank u_1 (l_4) and crank u_2 (l_2) turn about the same axis through c, at angles theta_2
and theta_3 from x; the distal link v_1 (its part next to S is l_6, the whole link l_5) hangs on u_1; the rod
v_2 (l_3) joins the end of u_2 to the distal link:  u_1 + w = u_2 + v_2,  w = (1 - l_5/l_6) v_1,  s = c + u_1
+ v_1.

With the printed sizes the linkage is a parallelogram: at full extension A_i and B_i lose rank together and
the quotient A_i^-1 B_i is 0/0 there.  The kernels here are those of general lengths; `regularity` says when
they must not be used.
"""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import sympy as sp

from krhpr.codegen.kernel import Frame, GeometryField, GeometryType, Layout, Port, Unit
from krhpr.codegen.writer import KernelWriter
from krhpr.derivations.sublegs.base import Forward, Passive, Posture, SubLeg, VelocityEquations
from krhpr.derivations.sublegs.first_axis import (
    FRAME_PORTS,
    SHOULDER,
    axis_geometry,
    in_base,
    in_plane,
    link_frame,
    linkage_frame,
    place,
    plane_coordinates,
    shoulder,
    shoulder_factor,
    shoulder_points,
)
from krhpr.derivations.sublegs.two_link import outside, two_link
from krhpr.derivations.terms import Factor, Joint, JointKind, Link, LinkKind, Sign, Space
from krhpr.derivations.vectors import E, cross2, dot


class RFiveBar(SubLeg):
    """An actuated revolute joint and a five-bar linkage with two coaxial actuated cranks, (1.9) to (1.16)."""

    name = "r_fivebar"
    space = Space.SPATIAL
    notation = "R(RR-RRR)"
    section = "1.3, App. A, App. B"
    doc = (
        "Hybrid sub-leg: the first axis carries a five-bar linkage whose two cranks turn "
        "about one axis normal to the first."
    )
    equations = "App. B"
    actuators = (
        Joint("theta_1", JointKind.REVOLUTE, "about e_1; zero where e_2 is tangential"),
        Joint("theta_2", JointKind.REVOLUTE, "crank u_1 (l_4), from x towards e_1"),
        Joint("theta_3", JointKind.REVOLUTE, "crank u_2 (l_2), from x towards e_1"),
    )
    passive_joints = (
        Joint("crank_1", JointKind.REVOLUTE, "E, tip of u_1: distal link v_1 relative to u_1"),
        Joint("crank_2", JointKind.REVOLUTE, "C, tip of u_2: rod v_2 relative to u_2"),
        Joint("rod", JointKind.REVOLUTE, "P: distal link v_1 relative to the rod v_2"),
    )
    inverse_signs = (
        SHOULDER,
        Sign("elbow", "elbow+", "elbow-", "sign of u_1 x v_1 about e_2"),
        Sign("rod", "rod+", "rod-", "sign of u_2 x v_2 about e_2"),
    )
    forward_signs = (
        Sign(
            "assembly",
            "left",
            "right",
            "P lies left or right of the directed line C -> E in the plane (x, e_1)",
        ),
    )
    links = (
        Link("l_1", LinkKind.FIXED, "A", "c"),
        Link("l_4", LinkKind.PROXIMAL, "c", "E"),
        Link("l_2", LinkKind.CRANK, "c", "C"),
        Link("l_3", LinkKind.ROD, "C", "P"),
        Link("l_5", LinkKind.DISTAL, "P", "S"),
    )
    default_mode = "front/elbow-/rod-"
    default_assembly = "left"

    def geometry(self) -> GeometryType:
        lengths = (
            GeometryField("l_2", Unit.METRE, "crank u_2", positive=True),
            GeometryField("l_3", Unit.METRE, "rod v_2", positive=True),
            GeometryField("l_4", Unit.METRE, "crank u_1", positive=True),
            GeometryField("l_5", Unit.METRE, "whole distal link", positive=True),
            GeometryField("l_6", Unit.METRE, "part of the distal link from crank u_1 to S_i", positive=True),
        )
        return axis_geometry("subleg_r_fivebar", self.doc, lengths)

    def forward(self, k: KernelWriter, theta: sp.Matrix, assembly: sp.Matrix) -> Forward:
        x, e_2 = linkage_frame(k, theta[0])
        u_1 = k.let("u_1", k.g.l_4 * in_plane(theta[1]), "E - c in (x, e_1)")
        u_2 = k.let("u_2", k.g.l_2 * in_plane(theta[2]), "C - c in (x, e_1)")
        line = k.let("f", u_1 - u_2, "from C to E")
        d2 = k.let("d2", dot(line, line))
        tail = k.let("ratio", self._ratio(k), "1 - l_5/l_6")
        # P is at distance l_3 from C and |w| = |l_6 - l_5| from E
        along = k.let("along", (k.g.l_3**2 - (k.g.l_6 - k.g.l_5) ** 2 + d2) / (2 * d2))
        radicand = k.let("h2", k.g.l_3**2 / d2 - along**2)
        across = k.let("across", assembly[0] * sp.sqrt(radicand))
        w = k.let("w", (along - 1) * line + across * (E * line), "P - E")
        d = k.let("d", u_1 + w / tail, "s - c in (x, e_1)")
        return Forward(
            place(k, x, d[0], d[1]), {"x": x, "e_2": e_2, "d": d, "u_1": u_1, "u_2": u_2}, radicand
        )

    def inverse(
        self, k: KernelWriter, s: sp.Matrix, mode: sp.Matrix, swivel: Any
    ) -> tuple[list[Any], list[Any]]:
        theta_1, r, y = shoulder(k, s, mode[0])
        outer = two_link(k, r, y, k.g.l_4, k.g.l_6, mode[1], elbow=False)
        pivot = self._pivot(k, r, y, outer.link)
        crank = two_link(k, pivot[0], pivot[1], k.g.l_2, k.g.l_3, mode[2], elbow=False, suffix="_2")
        return [theta_1, outer.inner, crank.inner], [outer.radicand, crank.radicand]

    def reach(self, k: KernelWriter, s: sp.Matrix, mode: sp.Matrix) -> Any:
        # the serial part c, u_1, v_1, then, where that closes, the second crank and the rod
        _, r, y = shoulder(k, s, mode[0])
        outer = two_link(k, r, y, k.g.l_4, k.g.l_6, mode[1], elbow=False)
        pivot = self._pivot(k, r, y, outer.link)
        rod = outside(k, k.let("reach_2", sp.sqrt(dot(pivot, pivot))), k.g.l_2, k.g.l_3)
        return k.maximum(rod, outside(k, k.let("reach_1", sp.sqrt(r**2 + y**2)), k.g.l_4, k.g.l_6))

    def posture_ports(self) -> tuple[Port, ...]:
        cranks = (
            ("u_1", "crank u_1 in the linkage plane (x, e_1)"),
            ("u_2", "crank u_2 in the linkage plane (x, e_1)"),
        )
        return (
            *FRAME_PORTS,
            *(Port(name, (2,), Unit.METRE, Frame.JOINT, doc, Layout.STACKED) for name, doc in cranks),
        )

    def posture(self, k: KernelWriter, s: sp.Matrix, theta: sp.Matrix) -> Posture:
        x, e_2 = linkage_frame(k, theta[0])
        return {
            "x": x,
            "e_2": e_2,
            "d": plane_coordinates(k, s, x),
            "u_1": k.let("u_1", k.g.l_4 * in_plane(theta[1])),
            "u_2": k.let("u_2", k.g.l_2 * in_plane(theta[2])),
        }

    def velocity(self, k: KernelWriter, at: SimpleNamespace) -> VelocityEquations:
        r, u_1, u_2 = at.d[0], at.u_1, at.u_2
        v_1, v_2 = self._distal(k, at)
        ratio = k.let("ratio", self._ratio(k), "1 - l_5/l_6")
        b_22 = k.let("b_22", cross2(u_1, v_1), "v_1^T (e_2 x u_1)")
        b_32 = k.let("b_32", (1 - ratio) * cross2(v_2, u_1), "(1.13)")
        b_33 = k.let("b_33", cross2(u_2, v_2), "v_2^T (e_3 x u_2)")
        alignment = k.let("delta", cross2(v_1, v_2), "e_2^T (v_1 x v_2)")
        # (1.10), (1.11) in the frame (x, e_1, e_2); row 1 is e_2^T, with b_11 = (s - c)^T (e_2 x e_1) = -r
        A = sp.Matrix([[0, 0, 1], [v_1[0], v_1[1], 0], [ratio * v_2[0], ratio * v_2[1], 0]])
        B = sp.Matrix([[-r, 0, 0], [0, b_22, 0], [0, b_32, b_33]])
        return VelocityEquations(
            F=sp.Matrix.hstack(at.x, k.g.e_1, at.e_2),
            A=A,
            B=B,
            determinant=-r * b_22 * b_33 / (ratio * alignment),
            serial=(
                shoulder_factor(r, k.g.l_4 + k.g.l_6),
                Factor("elbow", b_22 / (k.g.l_4 * k.g.l_6), "crank u_1 and distal link v_1 aligned"),
                Factor("crank", b_33 / (k.g.l_2 * k.g.l_3), "crank u_2 and rod v_2 aligned"),
            ),
            parallel=(Factor("rod", alignment / (k.g.l_6 * k.g.l_3), "rod v_2 and distal link v_1 aligned"),),
        )

    def passive(self, k: KernelWriter, at: SimpleNamespace) -> Passive:
        v_1, v_2 = self._distal(k, at)
        pairs = ((at.u_1, v_1), (at.u_2, v_2), (v_2, v_1))
        angles = [k.atan2(cross2(a, b), dot(a, b)) for a, b in pairs]
        named = tuple(zip(self.passive_joints, angles, strict=True))
        return Passive(named, link_frame(k, at, v_1 / k.g.l_6))

    def points(self, k: KernelWriter, at: SimpleNamespace, s: sp.Matrix) -> dict[str, sp.Matrix]:
        pivot = at.u_1 + self._ratio(k) * (at.d - at.u_1)
        return {
            **shoulder_points(k),
            "E": in_base(k, at, at.u_1),
            "C": in_base(k, at, at.u_2),
            "P": in_base(k, at, k.let("p", pivot, "P - c")),
            "S": s,
        }

    def closure(self, k: KernelWriter, s: sp.Matrix, theta: sp.Matrix) -> sp.Matrix:
        # (A.1), (A.5), (A.15)
        at = SimpleNamespace(**self.posture(k, s, theta))
        v_1, v_2 = self._distal(k, at)
        return sp.Matrix([dot(at.e_2, s - k.g.c), dot(v_1, v_1) - k.g.l_6**2, dot(v_2, v_2) - k.g.l_3**2])

    def _distal(self, k: KernelWriter, at: SimpleNamespace) -> tuple[sp.Matrix, sp.Matrix]:
        """Distal link v_1 and rod v_2 in the linkage plane (x, e_1), (1.14), (1.15)."""
        v_1 = k.let("v_1", at.d - at.u_1, "(1.14)")
        return v_1, k.let("v_2", at.u_1 + self._ratio(k) * v_1 - at.u_2, "(1.15)")

    def _pivot(self, k: KernelWriter, r: Any, y: Any, crank: sp.Matrix) -> sp.Matrix:
        """P - c = u_1 + w in the linkage plane, (B.2)."""
        u_1 = k.let("u_1", crank)
        return k.let("p", u_1 + self._ratio(k) * (sp.Matrix([r, y]) - u_1), "r_i = u_1 + w")

    @staticmethod
    def _ratio(k: KernelWriter) -> Any:
        return 1 - k.g.l_5 / k.g.l_6
