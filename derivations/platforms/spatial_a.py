"""Arrangement (a) in space (Fig. 2.1a): a redundant link from S_i to a revolute joint B_i normal to the
platform.

B_i = R_p e_r and S_i = B_i + l (-cos(beta_i) e_r + sin(beta_i) e_t) in the platform frame: beta_i is measured
at B_i from the inward ray, clockwise seen from +z' (the edge angle of Chapter 3 is beta_i - 30 deg for an
equilateral platform). The redundant link is l_i7 of Chapter 1 and l_i4 of Chapters 2 to 4; here it is `l_r`.
"""

from __future__ import annotations

from typing import Any

import sympy as sp

from krhpr.codegen.kernel import Frame, GeometryField, GeometryType, Kernel, Unit
from krhpr.codegen.writer import KernelWriter
from krhpr.derivations.platforms import encoders, forward_newton, forward_revolute
from krhpr.derivations.platforms.base import Platform
from krhpr.derivations.platforms.forward import Hold
from krhpr.derivations.requirements import Requirement
from krhpr.derivations.terms import Joint, JointKind, Pose, Space
from krhpr.derivations.vectors import cross, dot

FIELDS = (
    GeometryField("platform_azimuth", Unit.RADIAN, "azimuth of the leg on the platform"),
    GeometryField("R_p", Unit.METRE, "circumradius of the platform", positive=True),
    GeometryField("l_r", Unit.METRE, "redundant link (l_i7 in Chapter 1, l_i4 later)", positive=True),
)

BETA = Joint(
    "beta",
    JointKind.REVOLUTE,
    "angle beta_i at B_i from the inward ray to the redundant link, clockwise from +z'",
)


def revolute_factors(redundant: list[Any], geometry: list[Any]) -> Any:
    """det J_a of arrangement (a) in closed form: -l_1 l_2 l_3 sum_k R_k sin(beta_k) sin(gamma_j - gamma_i),
    (i, j, k) cyclic.

    gamma_i = azimuth_i - beta_i + pi is the direction of the redundant link from B_i.  For an equilateral
    platform and equal lengths this is -l^3 r f with f = sum sin(beta_i) sin(120 deg + beta_{i+1} -
    beta_{i+2}) (errata, 4).
    """
    lengths = [g.l_r for g in geometry]
    gamma = [g.platform_azimuth - beta for g, beta in zip(geometry, redundant, strict=True)]
    total = sp.Integer(0)
    for k in range(3):
        i, j = (k + 1) % 3, (k + 2) % 3
        total += geometry[k].R_p * sp.sin(redundant[k]) * sp.sin(gamma[j] - gamma[i])
    return -lengths[0] * lengths[1] * lengths[2] * total


class SpatialA(Platform):
    """Spherical-revolute redundant links, (1.1), (1.2)."""

    name = "spatial_a"
    arrangement = "a"
    space = Space.SPATIAL
    notation = "SR"
    section = "1.3, 2.3"
    doc = (
        "Redundant links from the spherical joints to revolute joints whose axes are normal to the platform."
    )
    redundant_joint = BETA
    requirements = (Requirement.END_POINTS_NEVER_COLLINEAR,)
    equations = "(1.1), (1.2)"
    type_2_doc = (
        "Singular where the three redundant links' lines meet in a point or are parallel (det"
        " J_a = 0), or where S_1, S_2, S_3 "
        "are collinear (det J_n = 0; excluded for l < 3 R_p / 4, (1.35))."
    )
    margins_doc = (
        "-det J_a / (l_1 l_2 l_3 R), det J_n / R^2 with R the mean of R_p: positive for beta in (30, 150) deg"
    )

    def geometry(self) -> GeometryType:
        k = KernelWriter("prepare", "Vectors and sub-expressions that depend on the geometry alone.")
        azimuth, radius, _ = (k.input(field.name, (), field.unit, doc=field.doc) for field in FIELDS)
        radial = k.let("e_r", sp.Matrix([sp.cos(azimuth), sp.sin(azimuth)]))
        k.output("e_r", radial, Unit.NONE, Frame.PLATFORM, "radial direction")
        k.output("b", radius * radial, Unit.METRE, Frame.PLATFORM, "B_i")
        return GeometryType("platform_spatial_a", self.doc, FIELDS, k.kernel())

    def end_point(self, k: KernelWriter, pose: Pose, redundant: Any) -> sp.Matrix:
        link = k.let("l_e", k.g.l_r * k.g.e_r)
        cosine, sine = sp.cos(redundant), sp.sin(redundant)
        local = k.let(
            "s_l",
            sp.Matrix(
                [
                    k.g.b[0] - cosine * link[0] - sine * link[1],
                    k.g.b[1] - cosine * link[1] + sine * link[0],
                ]
            ),
            "S_i in the platform frame",
        )
        return pose.p + pose.Q[:, :2] * local

    def redundant(self, k: KernelWriter, pose: Pose, s: sp.Matrix) -> Any:
        a = k.let("a", self.direction(k, pose, s), "(1.4)")
        x, y = (k.let(name, dot(pose.Q.col(j), a)) for j, name in enumerate(("a_x", "a_y")))
        # -a is the link seen from B_i: -a = l (-cos(beta) e_r + sin(beta) e_t)
        e_r = k.g.e_r
        return k.atan2(x * e_r[1] - y * e_r[0], x * e_r[0] + y * e_r[1])

    def residual(self, k: KernelWriter, pose: Pose, s: sp.Matrix) -> sp.Matrix:
        a = k.let("a", self.direction(k, pose, s), "(1.4)")
        return sp.Matrix([k.let("a2", dot(a, a)) / 2 - k.g.l_r**2 / 2, dot(pose.Q.col(2), a)])

    def direction(self, k: KernelWriter, pose: Pose, s: sp.Matrix) -> sp.Matrix:
        return pose.p + self.anchor(k, pose, s) - s

    def anchor(self, k: KernelWriter, pose: Pose, s: sp.Matrix) -> sp.Matrix:
        return k.let("Qb", pose.Q[:, :2] * k.g.b, "Q b_i")

    def end_velocity(
        self, k: KernelWriter, pose: Pose, s: sp.Matrix, carried: sp.Matrix, rate: Any
    ) -> sp.Matrix:
        # beta grows clockwise seen from +z': S_i turns about B_i with -beta_dot q_z
        a = k.let("a", self.direction(k, pose, s), "(1.4)")
        return carried + rate * cross(pose.Q.col(2), a)

    def joint(self, k: KernelWriter, pose: Pose, s: sp.Matrix) -> sp.Matrix:
        along = k.let("x_r", self.direction(k, pose, s) / k.g.l_r, "from S_i to B_i")
        q_z = pose.Q.col(2)
        return sp.Matrix.hstack(along, k.let("y_r", cross(q_z, along)), q_z)

    def attachment(self, k: KernelWriter, pose: Pose, s: sp.Matrix) -> sp.Matrix:
        return pose.p + self.anchor(k, pose, s)

    def scale(self, k: KernelWriter) -> list[Any]:
        return [k.g.l_r, k.g.R_p]

    def margins(self, k: KernelWriter, det_a: Any, det_n: Any, scale: sp.Matrix) -> list[Any]:
        radius = k.let("R", (scale[0, 1] + scale[1, 1] + scale[2, 1]) / 3, "mean platform radius")
        return [-det_a / (scale[0, 0] * scale[1, 0] * scale[2, 0] * radius), det_n / radius**2]

    def closed_form(self, k: KernelWriter, redundant: list[Any], geometry: list[Any]) -> list[Any]:
        # det J_n = twice the signed area of S_1 S_2 S_3
        x = [
            g.R_p * sp.cos(g.platform_azimuth) - g.l_r * sp.cos(g.platform_azimuth - b)
            for g, b in zip(geometry, redundant, strict=True)
        ]
        y = [
            g.R_p * sp.sin(g.platform_azimuth) - g.l_r * sp.sin(g.platform_azimuth - b)
            for g, b in zip(geometry, redundant, strict=True)
        ]
        area = sum((x[i] * y[(i + 1) % 3] - x[(i + 1) % 3] * y[i] for i in range(3)), sp.Integer(0))
        return [revolute_factors(redundant, geometry), area]

    def forward_kernels(self) -> tuple[Kernel, ...]:
        return (
            *forward_revolute.forward_kernels(self),
            *forward_newton.newton_kernels(self),
            *encoders.encoder_kernels(self),
        )

    def hold(self, k: KernelWriter, count: int) -> Hold:
        return encoders.hold_by_angles(k, count)

    def tie_residual(self, k: KernelWriter, state: Any, point: Any) -> tuple[list[Any], Any]:
        return encoders.length_residual(k, state, point)
