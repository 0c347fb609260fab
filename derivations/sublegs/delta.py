"""The Delta robot as a sub-leg (Section 2.4.4; errata, 6): |s - g_k - L (x_k cos t_k + z sin t_k)| = R.

The arms L turn in vertical planes through the centre, t_k from the outward horizontal x_k upwards;
parallelograms R keep the small platform's orientation.  g_k are the arms' joints less the platform's.
"""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import sympy as sp

from krhpr.codegen.kernel import Frame, GeometryField, GeometryType, Layout, Port, Unit
from krhpr.codegen.writer import KernelWriter
from krhpr.derivations.sublegs.base import Forward, Posture
from krhpr.derivations.sublegs.carriers import E_Z, leg_axes
from krhpr.derivations.sublegs.chains import Chain, ChainSubLeg, row, triad_geometry
from krhpr.derivations.sublegs.circles import Meeting, SpheresMeeting, meet_spheres
from krhpr.derivations.sublegs.tripods import RADIUS
from krhpr.derivations.terms import Joint, JointKind, Link, LinkKind, Sign, Space
from krhpr.derivations.vectors import cross2, dot

ARMS = (1, 2, 3)


class Delta(ChainSubLeg):
    """Three actuated arms and three parallelograms."""

    name = "delta"
    space = Space.SPATIAL
    notation = "(Delta)"
    section = "2.4.4"
    doc = (
        "Parallel sub-leg: a Delta robot, three actuated arms and parallelograms that keep its "
        "platform's orientation."
    )
    equations = "2.4.4"
    actuated = "arm {0} and its parallelogram aligned in the arm's plane"
    forward_near = True
    actuators = tuple(
        Joint(f"theta_{n}", JointKind.REVOLUTE, f"arm {n}, from the outward horizontal upwards") for n in ARMS
    )
    passive_joints = tuple(
        Joint(f"{name}_{n}", JointKind.REVOLUTE, f"parallelogram {n} on its arm: {doc}")
        for n in ARMS
        for name, doc in (
            ("knee", "in the arm's plane, zero where the arm is stretched, positive upwards"),
            ("lean", "out of the arm's plane, towards the tangent"),
        )
    )
    inverse_signs = tuple(
        Sign(f"arm_{n}", f"{n}+", f"{n}-", f"sign of w_{n}^T (dg_{n}/dtheta_{n}), of the lever of arm {n}")
        for n in ARMS
    )
    actuated_at = tuple(f"G_{n}" for n in ARMS)
    links = (
        *(Link("L", LinkKind.PROXIMAL, f"G_{n}", f"K_{n}") for n in ARMS),
        *(Link("R", LinkKind.PARALLELOGRAM, f"K_{n}", "S") for n in ARMS),
    )
    default_mode = "1+/2+/3+"

    def geometry(self) -> GeometryType:
        lengths = (
            RADIUS,
            GeometryField("L", Unit.METRE, "arms", positive=True),
            GeometryField("R", Unit.METRE, "parallelograms", positive=True),
        )
        return triad_geometry(f"subleg_{self.name}", self.doc, lengths, "r_g", directions=True)

    def _knees(self, k: KernelWriter, theta: sp.Matrix) -> tuple[list[sp.Matrix], list[sp.Matrix]]:
        """The arms' ends, and their derivatives with respect to theta_k over L."""
        knees, turned = [], []
        for n in ARMS:
            x = row(k.g.x, n - 1)
            cosine, sine = k.let(f"cos_{n}", sp.cos(theta[n - 1])), k.let(f"sin_{n}", sp.sin(theta[n - 1]))
            knees.append(row(k.g.g, n - 1) + k.g.L * (cosine * x + sine * E_Z))
            turned.append(cosine * E_Z - sine * x)
        return knees, turned

    def chains(self, k: KernelWriter, s: sp.Matrix, theta: sp.Matrix) -> list[Chain]:
        knees, turned = self._knees(k, theta)
        found = []
        for n, knee, direction in zip(ARMS, knees, turned, strict=True):
            w = k.let(f"w_{n}", s - knee, f"parallelogram {n}")
            found.append(Chain(w, k.g.R, k.g.L * dot(w, direction)))
        return found

    def scales(self, k: KernelWriter) -> tuple[Any, Any]:
        return k.g.R, k.g.L * k.g.R

    def _spheres(self, k: KernelWriter, theta: sp.Matrix) -> SpheresMeeting:
        knees = [
            k.let(f"k_{n}", knee, f"end of arm {n}")
            for n, knee in zip(ARMS, self._knees(k, theta)[0], strict=True)
        ]
        return meet_spheres(k, knees, [k.g.R**2] * 3)

    def forward_all(self, k: KernelWriter, theta: sp.Matrix) -> list[Meeting]:
        return self._spheres(k, theta).both(k)

    def forward(self, k: KernelWriter, theta: sp.Matrix, assembly: sp.Matrix) -> Forward:
        found = self._spheres(k, theta).near(k, assembly)
        s = k.let("s", found.point)
        return Forward(s, self.posture(k, s, theta), found.radicand)

    def _arms(self, k: KernelWriter, s: sp.Matrix) -> list[tuple[Any, Any, Any, Any]]:
        """For each arm: S_i seen from its joint, along x_k and upwards; A = a_x^2 + a_z^2; and E with
        a_x cos t + a_z sin t = E.
        """
        found = []
        for n in ARMS:
            a = k.let(f"a_{n}", s - row(k.g.g, n - 1), "s - g_k")
            a_x = k.let(f"a_{n}x", dot(a, row(k.g.x, n - 1)))
            planar = k.let(f"p_{n}", a_x**2 + a[2] ** 2)
            wanted = k.let(f"e_{n}", (dot(a, a) + k.g.L**2 - k.g.R**2) / (2 * k.g.L))
            found.append((a_x, a[2], planar, wanted))
        return found

    def inverse(
        self, k: KernelWriter, s: sp.Matrix, mode: sp.Matrix, swivel: Any
    ) -> tuple[list[Any], list[Any]]:
        # cos t = (a_x E - a_z h) / A, sin t = (a_z E + a_x h) / A with h^2 = A - E^2; h = -w^T (dg/dt) / L
        angles, radicands = [], []
        for sign, (a_x, a_z, planar, wanted) in zip(mode, self._arms(k, s), strict=True):
            radicand = planar - wanted**2
            h = -sign * sp.sqrt(radicand)
            angles.append(k.atan2(a_z * wanted + a_x * h, a_x * wanted - a_z * h))
            radicands.append(radicand)
        return angles, radicands

    def reach(self, k: KernelWriter, s: sp.Matrix, mode: sp.Matrix, swivel: Any) -> Any:
        excess = [k.absolute(wanted) - sp.sqrt(planar) for _, _, planar, wanted in self._arms(k, s)]
        return k.maximum(*excess)

    def posture_ports(self) -> tuple[Port, ...]:
        arms = Port(
            "u", (3, 2), Unit.NONE, Frame.JOINT, "directions of the arms, along x_k and up", Layout.STACKED
        )
        return (*super().posture_ports(), arms)

    def posture(self, k: KernelWriter, s: sp.Matrix, theta: sp.Matrix) -> Posture:
        arms = sp.Matrix([[sp.cos(angle), sp.sin(angle)] for angle in theta])
        return {**super().posture(k, s, theta), "u": k.let("u", arms)}

    def passive_angles(self, k: KernelWriter, at: SimpleNamespace) -> list[Any]:
        angles = []
        for n in ARMS:
            w, x = row(at.w, n - 1), row(k.g.x, n - 1)
            in_plane = k.let(f"q_{n}", sp.Matrix([dot(w, x), w[2]]), "parallelogram in the arm's plane")
            arm = row(at.u, n - 1)
            angles.append(k.atan2(cross2(arm, in_plane), dot(arm, in_plane)))
            size = k.let(f"size_{n}", sp.sqrt(dot(in_plane, in_plane)))
            angles.append(k.atan2(dot(w, sp.Matrix([-x[1], x[0], 0])), size))
        return angles

    def link_frame(self, k: KernelWriter, at: SimpleNamespace) -> sp.Matrix:
        return leg_axes(k)

    def points(self, k: KernelWriter, at: SimpleNamespace, s: sp.Matrix) -> dict[str, sp.Matrix]:
        centres = {f"G_{n}": row(k.g.g, n - 1) for n in ARMS}
        return {**centres, **{f"K_{n}": s - row(at.w, n - 1) for n in ARMS}, "S": s}
