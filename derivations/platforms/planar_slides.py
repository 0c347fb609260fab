"""Arrangements (b) and (c) in the plane: revolute-prismatic redundant links (Figs. 2.3, 2.4).

(b) r_i = p + Q (b_i + delta_i t_i - l_r n_i), n_i = E t_i: the slides stand anywhere on the platform.
(c) r_i = p + delta_i Q t_i: their lines meet in O'.
"""

from __future__ import annotations

from typing import Any

import sympy as sp

from krhpr.codegen.kernel import GeometryField, Unit
from krhpr.derivations.platforms.slides import SlidePlatform
from krhpr.derivations.terms import Joint, JointKind, Space

AZIMUTH = GeometryField("platform_azimuth", Unit.RADIAN, "direction t_i of the slide in the platform frame")


class PlanarSlide(SlidePlatform):
    """What the two arrangements have in common."""

    space = Space.PLANAR
    notation = "RP"
    section = "2.2"

    def slide(self, g: dict[str, Any]) -> sp.Matrix:
        azimuth = g["platform_azimuth"]
        return sp.Matrix([sp.cos(azimuth), sp.sin(azimuth)])


class PlanarB(PlanarSlide):
    """Revolute-prismatic redundant links whose axes miss O', (2.8) to (2.12)."""

    name = "planar_b"
    arrangement = "b"
    doc = "Revolute joints on links that slide along lines of the platform."
    redundant_joint = Joint("delta", JointKind.PRISMATIC, "slide delta_i along t_i, from b_i, signed")
    equations = "(2.8)"
    type_2_doc = (
        "Singular on one plane of the redundant coordinates: det J = sum w_i (delta_i + n_i^T E b_i) "
        "= 0 with "
        "w_i = n_j x n_k (lines through one point)."
    )
    margins_doc = "det J (m): positive on the side of type II where delta_i is large"
    fields = (
        AZIMUTH,
        GeometryField("b_x", Unit.METRE, "point b_i of the slide in the platform frame, x"),
        GeometryField("b_y", Unit.METRE, "point b_i of the slide in the platform frame, y"),
        GeometryField("l_r", Unit.METRE, "redundant link, from r_i along n_i to its slider", positive=True),
    )
    offset = True

    def middle(self, g: dict[str, Any], normal: sp.Matrix) -> sp.Matrix:
        return sp.Matrix([g["b_x"], g["b_y"]]) - g["l_r"] * normal


class PlanarC(PlanarSlide):
    """Revolute-prismatic redundant links whose axes pass through O', (2.13), (2.14)."""

    name = "planar_c"
    arrangement = "c"
    doc = "Revolute joints that slide along lines through the platform's centre."
    redundant_joint = Joint("delta", JointKind.PRISMATIC, "slide delta_i along t_i, from O', signed")
    redundant_link = ""
    equations = "(2.13)"
    type_2_doc = (
        "Singular where sum w_i delta_i = 0 with w_i = n_j x n_k; free while all delta_i > 0 and the "
        "three directions "
        "positively span the plane (the thesis says free, which holds only so)."
    )
    margins_doc = "det J (m): positive while all delta_i > 0"
    fields = (AZIMUTH,)
    offset = False
