"""The serial RRR sub-leg of Section 2.3: a first axis, then two links in the linkage plane.

theta_3 is relative to the second link:  s = c + l_2 (x cos t_2 + e_1 sin t_2) + l_3 (x cos(t_2 + t_3) + e_1 sin(t_2 + t_3)).
"""

from __future__ import annotations

from typing import Any

import sympy as sp

from krhpr.codegen.kernel import GeometryField, GeometryType, Unit
from krhpr.codegen.writer import KernelWriter
from krhpr.derivations.sublegs.base import Factor, Joint, JointKind, Passive, Sign, Space, SubLeg, VelocityEquations
from krhpr.derivations.sublegs.first_axis import (
    SHOULDER,
    axis_geometry,
    linkage_frame,
    place,
    plane_coordinates,
    shoulder,
    shoulder_factor,
)
from krhpr.derivations.sublegs.two_link import outside, two_link
from krhpr.derivations.vectors import dot


class RRR(SubLeg):
    """Three actuated revolute joints in series, (2.15)."""

    name = "rrr"
    space = Space.SPATIAL
    notation = "RRR"
    section = "2.3"
    doc = "Serial sub-leg: the first axis leans outwards by alpha, the next two are parallel to each other and normal to it."
    equations = "1.5, 2.5"
    actuators = (
        Joint("theta_1", JointKind.REVOLUTE, "about e_1; zero where e_2 is tangential"),
        Joint("theta_2", JointKind.REVOLUTE, "about e_2; link i2 from x towards e_1"),
        Joint("theta_3", JointKind.REVOLUTE, "about e_2; link i3 relative to link i2"),
    )
    inverse_signs = (SHOULDER, Sign("elbow", "elbow+", "elbow-", "sign of sin(theta_3)"))
    default_mode = "front/elbow+"

    def geometry(self) -> GeometryType:
        return axis_geometry(
            "subleg_rrr",
            self.doc,
            (
                GeometryField("l_2", Unit.METRE, "link i2", positive=True),
                GeometryField("l_3", Unit.METRE, "link i3", positive=True),
            ),
        )

    def forward(self, k: KernelWriter, theta: sp.Matrix, assembly: sp.Matrix) -> tuple[sp.Matrix, list[Any]]:
        t_2, t_23 = theta[1], theta[1] + theta[2]
        r = k.let("r", k.g.l_2 * sp.cos(t_2) + k.g.l_3 * sp.cos(t_23))
        y = k.let("y", k.g.l_2 * sp.sin(t_2) + k.g.l_3 * sp.sin(t_23))
        return place(k, theta[0], r, y), []

    def inverse(self, k: KernelWriter, s: sp.Matrix, mode: sp.Matrix) -> tuple[list[Any], list[Any]]:
        theta_1, r, y = shoulder(k, s, mode[0])
        arm = two_link(k, r, y, k.g.l_2, k.g.l_3, mode[1])
        return [theta_1, arm.inner, arm.elbow], [arm.radicand]

    def reach(self, k: KernelWriter, s: sp.Matrix, mode: sp.Matrix) -> Any:
        d = k.let("d", s - k.g.c)
        return outside(k, k.let("distance", sp.sqrt(dot(d, d))), k.g.l_2, k.g.l_3)

    def velocity(self, k: KernelWriter, s: sp.Matrix, theta: sp.Matrix) -> VelocityEquations:
        # (2.15): columns e_1 x (s - c), e_2 x (s - c), e_2 x (s - c - u_1), written in the frame (x, e_1, e_2)
        x, e_2 = linkage_frame(k, theta[0])
        r, y = plane_coordinates(k, s, x)
        cosine, sine = k.let("cos_2", sp.cos(theta[1])), k.let("sin_2", sp.sin(theta[1]))
        outer = k.let("v_1", sp.Matrix([r - k.g.l_2 * cosine, y - k.g.l_2 * sine]), "s - c - u_1 in the linkage plane")
        columns = sp.Matrix([[0, -y, -outer[1]], [0, r, outer[0]], [-r, 0, 0]])
        # l_2 l_3 sin(theta_3) = u_1 x v_1
        elbow = k.let("elbow", k.g.l_2 * (cosine * outer[1] - sine * outer[0]), "l_2 l_3 sin(theta_3)")
        return VelocityEquations(
            F=sp.Matrix.hstack(x, k.g.e_1, e_2),
            A=sp.eye(3),
            B=columns,
            determinant=-elbow * r,
            serial=(
                shoulder_factor(r, k.g.l_2 + k.g.l_3),
                Factor("elbow", elbow / (k.g.l_2 * k.g.l_3), "links i2 and i3 aligned, sin(theta_3) = 0"),
            ),
        )

    def passive(self, k: KernelWriter, s: sp.Matrix, theta: sp.Matrix) -> Passive:
        x, e_2 = linkage_frame(k, theta[0])
        t_23 = theta[1] + theta[2]
        along = k.let("along", sp.cos(t_23) * x + sp.sin(t_23) * k.g.e_1, "direction of link i3")
        across = k.let("across", sp.cos(t_23) * k.g.e_1 - sp.sin(t_23) * x, "e_2 x along")
        return Passive((), sp.Matrix.hstack(along, across, e_2))

    def closure(self, k: KernelWriter, s: sp.Matrix, theta: sp.Matrix) -> sp.Matrix:
        return s - self.forward(k, theta, sp.Matrix(0, 1, []))[0]
