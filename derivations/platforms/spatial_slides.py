"""Arrangements (b) and (c) in space: spherical-prismatic redundant links (Fig. 2.1b, c).

(b) n_i = e_r, t_i = e_t, S_i = (b - l_r) e_r + d_i e_t with b = R_p: the slides are tangential.
(c) n_i = e_t, t_i = e_r, S_i = d_i e_r: the slides are radial and their lines meet in O'.
"""

from __future__ import annotations

from typing import Any

import sympy as sp

from krhpr.codegen.kernel import GeometryField, Unit
from krhpr.derivations.platforms.slides import SlidePlatform
from krhpr.derivations.terms import Joint, JointKind, Space

AZIMUTH = GeometryField("platform_azimuth", Unit.RADIAN, "azimuth of the leg on the platform")


class SpatialB(SlidePlatform):
    """Spherical-prismatic redundant links whose axes miss O', (2.19), (2.21)."""

    name = "spatial_b"
    arrangement = "b"
    space = Space.SPATIAL
    notation = "SP"
    section = "2.3"
    doc = "Spherical joints on links that slide along tangential lines of the platform."
    redundant_joint = Joint("d", JointKind.PRISMATIC, "slide d_i of S_i along t_i = e_t, signed")
    equations = "(2.19), (2.21)"
    type_2_doc = (
        "Singular where d_1 + d_2 + d_3 = 0 (lines through one point; det J_a = -(sqrt3/2)(d_1 + d_2 "
        "+ d_3)), or "
        "where S_1, S_2, S_3 are collinear: 3 h^2 + d_1 d_2 + d_2 d_3 + d_3 d_1 = 0 with h = R_p - "
        "l_r, which the "
        "thesis leaves out and |d_i| < sqrt(3) |h| excludes (equal legs at 120 deg)."
    )
    margins_doc = "-det J_a (m) and det J_n (m^2): positive while all d_i > 0"
    fields = (
        AZIMUTH,
        GeometryField("R_p", Unit.METRE, "distance b of the slides from O'", positive=True),
        GeometryField("l_r", Unit.METRE, "redundant link, from S_i outwards to its slider", positive=True),
    )
    handedness = -1
    offset = True

    def slide(self, g: dict[str, Any]) -> sp.Matrix:
        azimuth = g["platform_azimuth"]
        return sp.Matrix([-sp.sin(azimuth), sp.cos(azimuth)])

    def middle(self, g: dict[str, Any], normal: sp.Matrix) -> sp.Matrix:
        return (g["R_p"] - g["l_r"]) * normal


class SpatialC(SlidePlatform):
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
    fields = (GeometryField("platform_azimuth", Unit.RADIAN, "azimuth of the leg's slide on the platform"),)
    offset = False

    def slide(self, g: dict[str, Any]) -> sp.Matrix:
        azimuth = g["platform_azimuth"]
        return sp.Matrix([sp.cos(azimuth), sp.sin(azimuth)])
