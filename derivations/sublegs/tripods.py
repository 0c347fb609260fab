"""Three actuated struts that meet in S_i: |s - g_k| = rho_k (Section 2.4.4; errata, 6).

As the translational 3-UPU the struts carry a small platform that keeps its orientation; g_k are then the
base joints less the platform's joints.  As 3-UPS they meet in a common spherical joint.  Rows of M_i^-1 are
the unit vectors of the struts.
"""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import sympy as sp

from krhpr.codegen.kernel import GeometryField, GeometryType, Unit
from krhpr.codegen.writer import KernelWriter
from krhpr.derivations.sublegs.base import Forward
from krhpr.derivations.sublegs.carriers import leg_axes
from krhpr.derivations.sublegs.chains import Chain, ChainSubLeg, row, strut_angles, triad_geometry
from krhpr.derivations.sublegs.circles import Meeting, SpheresMeeting, meet_spheres
from krhpr.derivations.terms import Factor, Joint, JointKind, Link, LinkKind, Space
from krhpr.derivations.vectors import cross, determinant3, dot

RADIUS = GeometryField("r_g", Unit.METRE, "radius of the circle of the centres g_k about c", positive=True)
STRUTS = (1, 2, 3)


class UPS3(ChainSubLeg):
    """Three UPS struts with a common spherical joint."""

    name = "ups3"
    space = Space.SPATIAL
    notation = "(3-UPS)"
    section = "2.4.4"
    doc = "Parallel sub-leg: three actuated struts from universal joints on the base meet in S_i."
    equations = "2.4.4"
    actuated = "strut {} has no length"
    forward_near = True
    actuators = tuple(Joint(f"rho_{n}", JointKind.PRISMATIC, f"length of strut {n}") for n in STRUTS)
    passive_joints = tuple(
        Joint(f"{name}_{n}", JointKind.REVOLUTE, f"universal joint of strut {n}: {doc}")
        for n in STRUTS
        for name, doc in (
            ("tilt", "about e_x, zero where the strut is normal to e_1"),
            ("lean", "about its second axis, zero where the strut is normal to e_x"),
        )
    )
    actuated_at = tuple(f"rho_{n}" for n in STRUTS)
    links = tuple(Link(f"rho_{n}", LinkKind.STRUT, f"G_{n}", "S") for n in STRUTS)

    def geometry(self) -> GeometryType:
        return triad_geometry(f"subleg_{self.name}", self.doc, (RADIUS,), "r_g", directions=False)

    def _struts(self, k: KernelWriter, s: sp.Matrix) -> list[sp.Matrix]:
        return [k.let(f"w_{n}", s - row(k.g.g, n - 1), f"strut {n}") for n in STRUTS]

    def chains(self, k: KernelWriter, s: sp.Matrix, theta: sp.Matrix) -> list[Chain]:
        return [Chain(w, rho, rho) for w, rho in zip(self._struts(k, s), theta, strict=True)]

    def scales(self, k: KernelWriter) -> tuple[Any, Any]:
        return k.g.r_g, k.g.r_g

    def _spheres(self, k: KernelWriter, theta: sp.Matrix) -> SpheresMeeting:
        return meet_spheres(k, [row(k.g.g, n - 1) for n in STRUTS], [rho**2 for rho in theta])

    def forward_all(self, k: KernelWriter, theta: sp.Matrix) -> list[Meeting]:
        return self._spheres(k, theta).both(k)

    def forward(self, k: KernelWriter, theta: sp.Matrix, assembly: sp.Matrix) -> Forward:
        found = self._spheres(k, theta).near(k, assembly)
        s = k.let("s", found.point)
        return Forward(s, self.posture(k, s, theta), found.radicand)

    def inverse(
        self, k: KernelWriter, s: sp.Matrix, mode: sp.Matrix, swivel: Any
    ) -> tuple[list[Any], list[Any]]:
        return [sp.sqrt(dot(w, w)) for w in self._struts(k, s)], []

    def passive_angles(self, k: KernelWriter, at: SimpleNamespace) -> list[Any]:
        # zero along e_t: the universal joints' first axes are along e_x, their second ones along e_1
        frame = [k.g.e_x, k.g.e_1, k.g.e_t]
        return [angle for n in STRUTS for angle in strut_angles(k, row(at.w, n - 1), frame, f"strut_{n}")]

    def link_frame(self, k: KernelWriter, at: SimpleNamespace) -> sp.Matrix:
        # that of strut 1: along it, and normal to e_x
        w = row(at.w, 0)
        along = k.let("along", w / k.let("rho", sp.sqrt(dot(w, w))))
        normal = k.let("normal", cross(k.g.e_x, along))
        normal = k.let("across", normal / k.let("size", sp.sqrt(dot(normal, normal))))
        return sp.Matrix.hstack(along, cross(normal, along), normal)

    def points(self, k: KernelWriter, at: SimpleNamespace, s: sp.Matrix) -> dict[str, sp.Matrix]:
        return {**{f"G_{n}": row(k.g.g, n - 1) for n in STRUTS}, "S": s}


class UPU3(UPS3):
    """The translational 3-UPU mechanism, whose platform keeps its orientation.

    The first and the last revolute axis of each strut are parallel to the tangent t_k of the circle of
    centres, the two in between to one another; each strut then takes from the platform the rotation about
    n_k, normal to both axes of its universal joints.  Where the three n_k are dependent the platform may
    turn (constraint singularity), though M_i does not show it.
    """

    name = "upu3"
    notation = "(3-UPU)"
    doc = (
        "Parallel sub-leg: three actuated struts between universal joints carry a platform that keeps its "
        "orientation, S_i is on it."
    )
    passive_joints = tuple(
        Joint(f"{name}_{n}", JointKind.REVOLUTE, f"universal joints of strut {n}: {doc}")
        for n in STRUTS
        for name, doc in (
            (
                "tilt",
                "about the tangent t_k, zero where the strut is in the plane of t_k and e_z; opposite above",
            ),
            ("lean", "about the second axis, zero where the strut is normal to t_k; opposite above"),
        )
    )

    def geometry(self) -> GeometryType:
        return triad_geometry(f"subleg_{self.name}", self.doc, (RADIUS,), "r_g", directions=True)

    def _tangent(self, k: KernelWriter, number: int) -> sp.Matrix:
        x, y = k.g.x[number - 1, 0], k.g.x[number - 1, 1]
        return sp.Matrix([-y, x, 0])

    def other_factors(self, k: KernelWriter, at: SimpleNamespace) -> tuple[Factor, ...]:
        normals = []
        for n in STRUTS:
            t, w = self._tangent(k, n), row(at.w, n - 1)
            normals.append(list(k.let(f"n_{n}", w - dot(w, t) * t, "w_k without its part along t_k")))
        value = determinant3(sp.Matrix(normals)) / k.g.r_g**3
        return (Factor("constraint", value, "the struts leave the platform a rotation"),)

    def passive_angles(self, k: KernelWriter, at: SimpleNamespace) -> list[Any]:
        angles = []
        for n in STRUTS:
            frame = [self._tangent(k, n), -row(k.g.x, n - 1), sp.Matrix([0, 0, 1])]
            angles += strut_angles(k, row(at.w, n - 1), frame, f"strut_{n}")
        return angles

    def link_frame(self, k: KernelWriter, at: SimpleNamespace) -> sp.Matrix:
        return leg_axes(k)
