"""Planar parallel sub-legs: five-bar linkages, and pairs of PRR or RPR chains that meet in r (Section 2.2.3;
errata for planar robots, 3.3).
"""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import sympy as sp

from krhpr.codegen.kernel import GeometryField, GeometryType, Unit
from krhpr.codegen.writer import KernelWriter
from krhpr.derivations.sublegs.base import Forward
from krhpr.derivations.sublegs.chains import Chain, ChainSubLeg, row
from krhpr.derivations.sublegs.circles import meet
from krhpr.derivations.sublegs.five_bar import FiveBar
from krhpr.derivations.sublegs.linkages import AXES_DISTANCE, RADIAL, PlanarLinkage, planar_geometry
from krhpr.derivations.sublegs.planar_serial import slide_field
from krhpr.derivations.terms import Joint, JointKind, Link, LinkKind, Sign, Space
from krhpr.derivations.vectors import cross2, dot

MEETING = Sign(
    "assembly", "left", "right", "r lies left or right of the line from the first chain's end to the second's"
)


class PlanarFiveBar(PlanarLinkage):
    """A five-bar linkage whose bars meet in r."""

    name = "fivebar"
    notation = "(RR-RRR)"
    section = "2.2.3"
    doc = (
        "Planar parallel sub-leg: a five-bar linkage with two actuated cranks whose bars meet in "
        "the end point."
    )
    equations = "2.2.3, 2.5"
    linkage = FiveBar(coupler=False, coaxial=False)
    actuators = (
        Joint("theta_1", JointKind.REVOLUTE, "crank u_1 (l_4), from the x axis of the base"),
        Joint("theta_2", JointKind.REVOLUTE, "crank u_2 (l_2), from the x axis of the base"),
    )
    passive_joints = linkage.passive_joints
    inverse_signs = linkage.signs
    forward_signs = linkage.forward_signs
    links = linkage.links("A")
    actuated_at = ("A", "A_2")
    default_mode = "elbow+/rod+"
    default_assembly = "right"


class PlanarFiveBarCoupler(PlanarFiveBar):
    """A five-bar linkage whose rod ends on the distal link beyond its crank, as that of the hybrid leg."""

    name = "fivebar_coupler"
    doc = (
        "Planar parallel sub-leg: a five-bar linkage with two actuated cranks; the end point is on "
        "the distal link, "
        "which reaches beyond its crank to the rod."
    )
    linkage = FiveBar(coupler=True, coaxial=False)
    passive_joints = linkage.passive_joints
    forward_signs = linkage.forward_signs
    links = linkage.links("A")


class PlanarPair(ChainSubLeg):
    """Two chains that meet in r."""

    space = Space.PLANAR
    section = "2.2.3"
    equations = "2.2.3, 2.5"
    forward_signs = (MEETING,)
    default_assembly = "left"

    def _bases(self, k: KernelWriter) -> tuple[sp.Matrix, sp.Matrix]:
        return k.g.o, k.g.o + k.g.o_12

    def link_frame(self, k: KernelWriter, at: SimpleNamespace) -> sp.Matrix:
        # the first chain's last link
        w = row(at.w, 0)
        return w / k.let("size", sp.sqrt(dot(w, w)))

    def _between(self, k: KernelWriter, at: SimpleNamespace) -> list[Any]:
        """The angle between the two last links."""
        first, second = row(at.w, 0), row(at.w, 1)
        return [k.atan2(cross2(first, second), dot(first, second))]


class PRR2(PlanarPair):
    """Two sliders and two links that meet in r: |r - a_k - rho_k e_k| = l_k."""

    name = "prr2"
    notation = "(2-PRR)"
    doc = "Planar parallel sub-leg: two actuated sliders and two links that meet in the end point."
    actuated = "link {} normal to its slide"
    actuators = (
        Joint("rho_1", JointKind.PRISMATIC, "slide along e_1, from the first base joint"),
        Joint("rho_2", JointKind.PRISMATIC, "slide along e_2, from the second base joint"),
    )
    passive_joints = (
        Joint("hinge_1", JointKind.REVOLUTE, "link 1 on its slider, from e_1"),
        Joint("hinge_2", JointKind.REVOLUTE, "link 2 on its slider, from e_2"),
        Joint("meeting", JointKind.REVOLUTE, "link 2 relative to link 1, in r"),
    )
    inverse_signs = tuple(
        Sign(f"link_{n}", f"{n}-ahead", f"{n}-behind", f"sign of the part of link {n} along e_{n}")
        for n in (1, 2)
    )
    links = (
        Link("rho_1", LinkKind.SLIDE, "A", "D_1"),
        Link("l_1", LinkKind.DISTAL, "D_1", "S"),
        Link("rho_2", LinkKind.SLIDE, "A_2", "D_2"),
        Link("l_2", LinkKind.DISTAL, "D_2", "S"),
    )
    actuated_at = ("rho_1", "rho_2")
    default_mode = "1-ahead/2-ahead"

    def geometry(self) -> GeometryType:
        fields = (
            AXES_DISTANCE,
            slide_field("slide_1", "the first slide"),
            slide_field("slide_2", "the second slide"),
            GeometryField("l_1", Unit.METRE, "first link", positive=True),
            GeometryField("l_2", Unit.METRE, "second link", positive=True),
        )
        return planar_geometry(f"subleg_planar_{self.name}", self.doc, fields, ("slide_1", "slide_2"))

    def _slides(self, k: KernelWriter) -> tuple[tuple[sp.Matrix, sp.Matrix, Any], ...]:
        """Base joint, direction and link of each chain."""
        first, second = self._bases(k)
        return ((first, k.g.e_1, k.g.l_1), (second, k.g.e_2, k.g.l_2))

    def chains(self, k: KernelWriter, s: sp.Matrix, theta: sp.Matrix) -> list[Chain]:
        found = []
        for n, (base, e, length) in enumerate(self._slides(k)):
            w = k.let(f"w_{n + 1}", s - base - theta[n] * e, f"link {n + 1}")
            found.append(Chain(w, length, dot(w, e)))
        return found

    def scales(self, k: KernelWriter) -> tuple[Any, Any]:
        return k.g.l_1, k.g.l_1

    def forward(self, k: KernelWriter, theta: sp.Matrix, assembly: sp.Matrix) -> Forward:
        (a_1, e_1, l_1), (a_2, e_2, l_2) = self._slides(k)
        first = k.let("d_1", a_1 + theta[0] * e_1, "first slider")
        line = k.let("line", a_2 + theta[1] * e_2 - first, "from the first slider to the second")
        found = meet(k, line, l_1**2, l_2**2, assembly[0])
        s = k.let("r", first + found.point)
        return Forward(s, self.posture(k, s, theta), found.radicand)

    def inverse(
        self, k: KernelWriter, s: sp.Matrix, mode: sp.Matrix, swivel: Any
    ) -> tuple[list[Any], list[Any]]:
        joints, radicands = [], []
        for n, (base, e, length) in enumerate(self._slides(k)):
            d = k.let(f"d_{n + 1}", s - base)
            radicand = k.let(f"h2_{n + 1}", length**2 - cross2(e, d) ** 2)
            joints.append(dot(d, e) - mode[n] * sp.sqrt(radicand))
            radicands.append(radicand)
        return joints, radicands

    def reach(self, k: KernelWriter, s: sp.Matrix, mode: sp.Matrix, swivel: Any) -> Any:
        return k.maximum(*(k.absolute(cross2(e, s - base)) - length for base, e, length in self._slides(k)))

    def passive_angles(self, k: KernelWriter, at: SimpleNamespace) -> list[Any]:
        hinges = [
            k.atan2(cross2(e, row(at.w, n)), dot(e, row(at.w, n)))
            for n, (_, e, _) in enumerate(self._slides(k))
        ]
        return [*hinges, *self._between(k, at)]

    def points(self, k: KernelWriter, at: SimpleNamespace, s: sp.Matrix) -> dict[str, sp.Matrix]:
        first, second = self._bases(k)
        return {"A": first, "D_1": s - row(at.w, 0), "A_2": second, "D_2": s - row(at.w, 1), "S": s}


class RPR2(PlanarPair):
    """Two struts that meet in r: |r - a_k| = rho_k."""

    name = "rpr2"
    notation = "(2-RPR)"
    doc = "Planar parallel sub-leg: two actuated struts from the base meet in the end point."
    actuated = "strut {} has no length"
    actuators = (
        Joint("rho_1", JointKind.PRISMATIC, "length of the first strut"),
        Joint("rho_2", JointKind.PRISMATIC, "length of the second strut"),
    )
    passive_joints = (
        Joint("base_1", JointKind.REVOLUTE, "strut 1 on the base, from the leg's radial direction"),
        Joint("base_2", JointKind.REVOLUTE, "strut 2 on the base, from the leg's radial direction"),
        Joint("meeting", JointKind.REVOLUTE, "strut 2 relative to strut 1, in r"),
    )
    links = (Link("rho_1", LinkKind.STRUT, "A", "S"), Link("rho_2", LinkKind.STRUT, "A_2", "S"))
    actuated_at = ("rho_1", "rho_2")

    def geometry(self) -> GeometryType:
        return planar_geometry(f"subleg_planar_{self.name}", self.doc, (AXES_DISTANCE,), (RADIAL,))

    def chains(self, k: KernelWriter, s: sp.Matrix, theta: sp.Matrix) -> list[Chain]:
        vectors = [k.let(f"w_{n}", s - base, f"strut {n}") for n, base in enumerate(self._bases(k), 1)]
        return [Chain(w, rho, rho) for w, rho in zip(vectors, theta, strict=True)]

    def scales(self, k: KernelWriter) -> tuple[Any, Any]:
        return k.g.R_b, k.g.R_b

    def forward(self, k: KernelWriter, theta: sp.Matrix, assembly: sp.Matrix) -> Forward:
        found = meet(k, k.g.o_12, theta[0] ** 2, theta[1] ** 2, assembly[0])
        s = k.let("r", k.g.o + found.point)
        return Forward(s, self.posture(k, s, theta), found.radicand)

    def inverse(
        self, k: KernelWriter, s: sp.Matrix, mode: sp.Matrix, swivel: Any
    ) -> tuple[list[Any], list[Any]]:
        return [sp.sqrt(dot(s - base, s - base)) for base in self._bases(k)], []

    def passive_angles(self, k: KernelWriter, at: SimpleNamespace) -> list[Any]:
        struts = (row(at.w, 0), row(at.w, 1))
        return [*(k.atan2(cross2(k.g.e_1, w), dot(k.g.e_1, w)) for w in struts), *self._between(k, at)]

    def points(self, k: KernelWriter, at: SimpleNamespace, s: sp.Matrix) -> dict[str, sp.Matrix]:
        first, second = self._bases(k)
        return {"A": first, "A_2": second, "S": s}
