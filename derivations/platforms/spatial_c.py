"""Arrangement (c) in space (Fig. 2.1c): S_i slides along a radial line through O'.

S_i = d_i t_i with t_i = e_r along the slide and n_i = e_t across it, both in the platform frame; d_i is
signed.
"""

from __future__ import annotations

from typing import Any

import sympy as sp

from krhpr.codegen.kernel import Frame, GeometryField, GeometryType, Unit
from krhpr.codegen.writer import KernelWriter
from krhpr.derivations.platforms.base import Platform
from krhpr.derivations.terms import Joint, JointKind, Pose, Space
from krhpr.derivations.vectors import dot

FIELDS = (GeometryField("platform_azimuth", Unit.RADIAN, "azimuth of the leg's slide on the platform"),)


class SpatialC(Platform):
    """Spherical-prismatic redundant links whose axes pass through O', (2.30), (2.31)."""

    name = "spatial_c"
    arrangement = "c"
    space = Space.SPATIAL
    notation = "SP"
    section = "2.3"
    doc = "Spherical joints that slide along radial lines through the platform's centre."
    redundant_joint = Joint("d", JointKind.PRISMATIC, "slide d_i of S_i along t_i = e_r, from O', signed")
    redundant_link = ""
    equations = "(2.30), (2.31)"
    type_2_doc = (
        "Free of type II singularities if all d_i >= 0 and at most one is zero (the thesis "
        "says completely free, which holds only "
        "with this slide limit); det J_a = (sqrt3/2)(d_1 + d_2 + d_3), det J_n = "
        "(sqrt3/2)(d_1 d_2 + d_2 d_3 + d_3 d_1)."
    )
    margins_doc = "det J_a (m) and det J_n (m^2): positive while all d_i > 0"

    def geometry(self) -> GeometryType:
        k = KernelWriter("prepare", "Vectors and sub-expressions that depend on the geometry alone.")
        azimuth = k.input(FIELDS[0].name, (), FIELDS[0].unit, doc=FIELDS[0].doc)
        k.output(
            "t",
            sp.Matrix([sp.cos(azimuth), sp.sin(azimuth)]),
            Unit.NONE,
            Frame.PLATFORM,
            "t_i, along the slide",
        )
        return GeometryType("platform_spatial_c", self.doc, FIELDS, k.kernel())

    def end_point(self, k: KernelWriter, pose: Pose, redundant: Any) -> sp.Matrix:
        return pose.p + redundant * self._slide(k, pose)

    def redundant(self, k: KernelWriter, pose: Pose, s: sp.Matrix) -> Any:
        return dot(s - pose.p, self._slide(k, pose))

    def residual(self, k: KernelWriter, pose: Pose, s: sp.Matrix) -> sp.Matrix:
        u = k.let("u", s - pose.p, "O' to S_i")
        return sp.Matrix([-dot(u, self.direction(k, pose, s)), -dot(u, pose.Q.col(2))])

    def direction(self, k: KernelWriter, pose: Pose, s: sp.Matrix) -> sp.Matrix:
        return k.let("Qn", pose.Q[:, :2] * sp.Matrix([-k.g.t[1], k.g.t[0]]), "Q n_i")

    def anchor(self, k: KernelWriter, pose: Pose, s: sp.Matrix) -> sp.Matrix:
        return s - pose.p

    def end_velocity(
        self, k: KernelWriter, pose: Pose, s: sp.Matrix, carried: sp.Matrix, rate: Any
    ) -> sp.Matrix:
        return carried + rate * self._slide(k, pose)

    def joint(self, k: KernelWriter, pose: Pose, s: sp.Matrix) -> sp.Matrix:
        return sp.Matrix.hstack(self._slide(k, pose), self.direction(k, pose, s), pose.Q.col(2))

    def attachment(self, k: KernelWriter, pose: Pose, s: sp.Matrix) -> sp.Matrix:
        return s

    def scale(self, k: KernelWriter) -> list[Any]:
        return [sp.Integer(1), sp.Integer(1)]

    def margins(self, k: KernelWriter, det_a: Any, det_n: Any, scale: sp.Matrix) -> list[Any]:
        return [det_a, det_n]

    def closed_form(self, k: KernelWriter, redundant: list[Any], geometry: list[Any]) -> list[Any]:
        azimuth = [g.platform_azimuth for g in geometry]
        turned = [sp.sin(azimuth[(i + 2) % 3] - azimuth[(i + 1) % 3]) for i in range(3)]
        det_a = sum((redundant[i] * turned[i] for i in range(3)), sp.Integer(0))
        det_n = sum(
            (redundant[(i + 1) % 3] * redundant[(i + 2) % 3] * turned[i] for i in range(3)), sp.Integer(0)
        )
        return [det_a, det_n]

    def _slide(self, k: KernelWriter, pose: Pose) -> sp.Matrix:
        return k.let("Qt", pose.Q[:, :2] * k.g.t, "Q t_i")
