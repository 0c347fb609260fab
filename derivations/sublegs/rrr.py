"""The serial RRR sub-leg of Section 2.3: a first axis, then two links in the linkage plane.

theta_3 is relative to the second link:

    s = c + l_2 (x cos t_2 + e_1 sin t_2) + l_3 (x cos(t_2 + t_3) + e_1 sin(t_2 + t_3))
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
from krhpr.derivations.vectors import cross2, dot


class RRR(SubLeg):
    """Three actuated revolute joints in series, (2.15)."""

    name = "rrr"
    space = Space.SPATIAL
    notation = "RRR"
    section = "2.3"
    doc = (
        "Serial sub-leg: the first axis leans outwards by alpha, the next two are parallel to"
        " each other and normal to it."
    )
    equations = "1.5, 2.5"
    actuators = (
        Joint("theta_1", JointKind.REVOLUTE, "about e_1; zero where e_2 is tangential"),
        Joint("theta_2", JointKind.REVOLUTE, "about e_2; link i2 from x towards e_1"),
        Joint("theta_3", JointKind.REVOLUTE, "about e_2; link i3 relative to link i2"),
    )
    inverse_signs = (SHOULDER, Sign("elbow", "elbow+", "elbow-", "sign of sin(theta_3)"))
    links = (
        Link("l_1", LinkKind.FIXED, "A", "c"),
        Link("l_2", LinkKind.PROXIMAL, "c", "E"),
        Link("l_3", LinkKind.DISTAL, "E", "S"),
    )
    default_mode = "front/elbow-"

    def geometry(self) -> GeometryType:
        return axis_geometry(
            "subleg_rrr",
            self.doc,
            (
                GeometryField("l_2", Unit.METRE, "link i2", positive=True),
                GeometryField("l_3", Unit.METRE, "link i3", positive=True),
            ),
        )

    def forward(self, k: KernelWriter, theta: sp.Matrix, assembly: sp.Matrix) -> Forward:
        x, e_2 = linkage_frame(k, theta[0])
        v_1 = k.let("v_1", k.g.l_3 * in_plane(theta[1] + theta[2]), "link i3 in (x, e_1)")
        d = k.let("d", k.g.l_2 * in_plane(theta[1]) + v_1, "s - c in (x, e_1)")
        return Forward(place(k, x, d[0], d[1]), {"x": x, "e_2": e_2, "d": d, "v_1": v_1})

    def inverse(
        self, k: KernelWriter, s: sp.Matrix, mode: sp.Matrix, swivel: Any
    ) -> tuple[list[Any], list[Any]]:
        theta_1, r, y = shoulder(k, s, mode[0])
        arm = two_link(k, r, y, k.g.l_2, k.g.l_3, mode[1])
        return [theta_1, arm.inner, arm.elbow], [arm.radicand]

    def reach(self, k: KernelWriter, s: sp.Matrix, mode: sp.Matrix) -> Any:
        d = k.let("d", s - k.g.c)
        return outside(k, k.let("distance", sp.sqrt(dot(d, d))), k.g.l_2, k.g.l_3)

    def posture_ports(self) -> tuple[Port, ...]:
        v_1 = Port(
            "v_1", (2,), Unit.METRE, Frame.JOINT, "link i3 in the linkage plane (x, e_1)", Layout.STACKED
        )
        return (*FRAME_PORTS, v_1)

    def posture(self, k: KernelWriter, s: sp.Matrix, theta: sp.Matrix) -> Posture:
        x, e_2 = linkage_frame(k, theta[0])
        d = plane_coordinates(k, s, x)
        return {
            "x": x,
            "e_2": e_2,
            "d": d,
            "v_1": k.let("v_1", d - k.g.l_2 * in_plane(theta[1]), "s - c - u_1"),
        }

    def velocity(self, k: KernelWriter, at: SimpleNamespace) -> VelocityEquations:
        # (2.15): columns e_1 x (s - c), e_2 x (s - c), e_2 x (s - c - u_1), written in the frame (x, e_1,
        # e_2)
        (r, y), v = at.d, at.v_1
        elbow = k.let("elbow", cross2(at.d, v), "u_1 x v_1 = l_2 l_3 sin(theta_3)")
        return VelocityEquations(
            F=sp.Matrix.hstack(at.x, k.g.e_1, at.e_2),
            A=sp.eye(3),
            B=sp.Matrix([[0, -y, -v[1]], [0, r, v[0]], [-r, 0, 0]]),
            determinant=-elbow * r,
            serial=(
                shoulder_factor(r, k.g.l_2 + k.g.l_3),
                Factor("elbow", elbow / (k.g.l_2 * k.g.l_3), "links i2 and i3 aligned, sin(theta_3) = 0"),
            ),
        )

    def passive(self, k: KernelWriter, at: SimpleNamespace) -> Passive:
        return Passive((), link_frame(k, at, at.v_1 / k.g.l_3))

    def points(self, k: KernelWriter, at: SimpleNamespace, s: sp.Matrix) -> dict[str, sp.Matrix]:
        return {**shoulder_points(k), "E": in_base(k, at, at.d - at.v_1), "S": s}

    def closure(self, k: KernelWriter, s: sp.Matrix, theta: sp.Matrix) -> sp.Matrix:
        return s - self.forward(k, theta, sp.Matrix(0, 1, [])).s
