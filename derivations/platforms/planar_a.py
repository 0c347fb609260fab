"""Arrangement (a) in the plane (Fig. 2.2): a redundant link from the sub-leg's end point to a revolute joint
B_i.

r_i = p + Q (b_i + l R(-beta_i) nu_i) with nu_i = -b_i / |b_i|: the same link and the same beta_i as in space.
"""

from __future__ import annotations

from typing import Any

import sympy as sp

from krhpr.codegen.kernel import Frame, GeometryType, Kernel, Unit
from krhpr.codegen.writer import KernelWriter
from krhpr.derivations.platforms import encoders, forward_newton, forward_revolute
from krhpr.derivations.platforms.base import Platform
from krhpr.derivations.platforms.forward import Hold
from krhpr.derivations.platforms.spatial_a import BETA, FIELDS, revolute_factors
from krhpr.derivations.terms import Pose, Space
from krhpr.derivations.vectors import E, dot


class PlanarA(Platform):
    """Revolute-revolute redundant links, (2.1) to (2.7)."""

    name = "planar_a"
    arrangement = "a"
    space = Space.PLANAR
    notation = "RR"
    section = "2.2"
    doc = "Redundant links with revolute joints at both ends."
    redundant_joint = BETA
    equations = "(2.1)"
    type_2_doc = "Singular where the three redundant links' lines meet in a point or are parallel."
    margins_doc = "-det J / (l_1 l_2 l_3 R) with R the mean of R_p: positive for beta in (30, 150) deg"

    def geometry(self) -> GeometryType:
        k = KernelWriter("prepare", "Vectors and sub-expressions that depend on the geometry alone.")
        azimuth, radius, _ = (k.input(field.name, (), field.unit, doc=field.doc) for field in FIELDS)
        radial = k.let("e_r", sp.Matrix([sp.cos(azimuth), sp.sin(azimuth)]))
        k.output("e_r", radial, Unit.NONE, Frame.PLATFORM, "radial direction, -nu_i")
        k.output("b", radius * radial, Unit.METRE, Frame.PLATFORM, "b_i")
        return GeometryType("platform_planar_a", self.doc, FIELDS, k.kernel())

    def end_point(self, k: KernelWriter, pose: Pose, redundant: Any) -> sp.Matrix:
        link = k.let("l_e", k.g.l_r * k.g.e_r)
        local = k.let(
            "r_l",
            k.g.b - sp.cos(redundant) * link + sp.sin(redundant) * (E * link),
            "r_i in the platform frame",
        )
        return pose.p + pose.Q * local

    def redundant(self, k: KernelWriter, pose: Pose, s: sp.Matrix) -> Any:
        a = k.let("a", self.direction(k, pose, s), "(2.3)")
        x, y = (k.let(name, dot(pose.Q.col(j), a)) for j, name in enumerate(("a_x", "a_y")))
        e_r = k.g.e_r
        return k.atan2(x * e_r[1] - y * e_r[0], x * e_r[0] + y * e_r[1])

    def residual(self, k: KernelWriter, pose: Pose, s: sp.Matrix) -> sp.Matrix:
        a = k.let("a", self.direction(k, pose, s), "(2.3)")
        return sp.Matrix([k.let("a2", dot(a, a)) / 2 - k.g.l_r**2 / 2])

    def direction(self, k: KernelWriter, pose: Pose, s: sp.Matrix) -> sp.Matrix:
        return pose.p + self.anchor(k, pose, s) - s

    def anchor(self, k: KernelWriter, pose: Pose, s: sp.Matrix) -> sp.Matrix:
        return k.let("Qb", pose.Q * k.g.b, "Q b_i")

    def end_velocity(
        self, k: KernelWriter, pose: Pose, s: sp.Matrix, carried: sp.Matrix, rate: Any
    ) -> sp.Matrix:
        a = k.let("a", self.direction(k, pose, s), "(2.3)")
        return carried + rate * (E * a)

    def joint(self, k: KernelWriter, pose: Pose, s: sp.Matrix) -> sp.Matrix:
        return self.direction(k, pose, s) / k.g.l_r

    def attachment(self, k: KernelWriter, pose: Pose, s: sp.Matrix) -> sp.Matrix:
        return pose.p + self.anchor(k, pose, s)

    def scale(self, k: KernelWriter) -> list[Any]:
        return [k.g.l_r, k.g.R_p]

    def margins(self, k: KernelWriter, det_a: Any, det_n: Any, scale: sp.Matrix) -> list[Any]:
        radius = k.let("R", (scale[0, 1] + scale[1, 1] + scale[2, 1]) / 3, "mean platform radius")
        return [-det_a / (scale[0, 0] * scale[1, 0] * scale[2, 0] * radius)]

    def closed_form(self, k: KernelWriter, redundant: list[Any], geometry: list[Any]) -> list[Any]:
        return [revolute_factors(redundant, geometry)]

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
