"""The parallel 3-CPR sub-leg of Section 2.4.3: |p_k| = rho_k with p_k = (1 - e_k e_k^T)(s - g_k), (2.51).

Each chain has a passive cylindrical joint whose axis e_k is fixed in the base, an actuated prismatic joint
normal to it, and a revolute joint parallel to it on the platform, which keeps its orientation as long as the
axes are not all parallel.  g_k is c_k - v_k of (2.52), any point of the axis seen from the platform's joint.

Three quadrics meet in up to eight points: there is no closed form of the forward kinematics.  Newton steps
lead from a point nearby to the assembly mode that it belongs to; all modes are the roots of an octic
(`cpr_forward.py`).
"""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import sympy as sp

from krhpr.codegen.kernel import Frame, GeometryField, GeometryType, Layout, Port, Unit
from krhpr.codegen.writer import KernelWriter
from krhpr.derivations.sublegs.base import Posture
from krhpr.derivations.sublegs.carriers import BASE_FIELDS, begin_geometry, leg_axes, radial, write_leg_frame
from krhpr.derivations.sublegs.chains import Chain, ChainSubLeg, row
from krhpr.derivations.sublegs.cpr_forward import forward_roots
from krhpr.derivations.sublegs.forward import ForwardRoots
from krhpr.derivations.terms import Joint, JointKind, Link, LinkKind, Space
from krhpr.derivations.vectors import cross, dot

CHAINS = (1, 2, 3)


class CPR3(ChainSubLeg):
    """Three CPR chains with actuated prismatic joints, (2.55)."""

    name = "cpr3"
    space = Space.SPATIAL
    notation = "(3-CPR)"
    section = "2.4.3"
    doc = "Parallel sub-leg: three chains of a cylindrical, an actuated prismatic and a revolute joint."
    equations = "2.4.3"
    assemblies_near = 8
    actuated = "rho_{0} = 0: S_i on axis {0} as the platform sees it"
    actuators = tuple(
        Joint(f"rho_{n}", JointKind.PRISMATIC, f"distance from axis {n}, positive") for n in CHAINS
    )
    passive_joints = tuple(
        joint
        for n in CHAINS
        for joint in (
            Joint(f"turn_{n}", JointKind.REVOLUTE, f"cylindrical joint {n} about e_{n}, from e_1 x e_{n}"),
            Joint(f"travel_{n}", JointKind.PRISMATIC, f"cylindrical joint {n} along e_{n}, from g_{n}"),
        )
    )
    actuated_at = tuple(f"rho_{n}" for n in CHAINS)
    links = tuple(Link(f"rho_{n}", LinkKind.STRUT, f"C_{n}", "S") for n in CHAINS)

    def geometry(self) -> GeometryType:
        axes = [
            field
            for n in CHAINS
            for field in (
                GeometryField(f"tilt_{n}", Unit.RADIAN, f"axis {n}, from e_x"),
                GeometryField(f"turn_{n}", Unit.RADIAN, f"axis {n} about e_x, from e_1 towards e_t"),
                GeometryField(f"x_{n}", Unit.METRE, f"g_{n} - c along e_x"),
                GeometryField(f"y_{n}", Unit.METRE, f"g_{n} - c along e_1"),
                GeometryField(f"z_{n}", Unit.METRE, f"g_{n} - c along e_t"),
            )
        ]
        fields = (*BASE_FIELDS, *axes)
        k, symbols = begin_geometry(fields)
        azimuth = symbols["azimuth"]
        e_t = k.let("e_t", sp.Matrix([-sp.sin(azimuth), sp.cos(azimuth), 0]))
        e_r = k.let("e_r", radial(azimuth))
        write_leg_frame(k, symbols, e_r, e_t)
        e_1 = -sp.cos(symbols["alpha"]) * e_r + sp.sin(symbols["alpha"]) * sp.Matrix([0, 0, 1])
        e_1 = k.let("e_1", e_1)
        e_x = k.let("e_x", cross(e_1, e_t))
        c = k.let("c", symbols["R_b"] * e_r + symbols["l_1"] * e_1)
        directions, centres = [], []
        for n in CHAINS:
            across = sp.sin(symbols[f"tilt_{n}"])
            turn = symbols[f"turn_{n}"]
            directions.append(
                sp.cos(symbols[f"tilt_{n}"]) * e_x + across * (sp.cos(turn) * e_1 + sp.sin(turn) * e_t)
            )
            centres.append(c + symbols[f"x_{n}"] * e_x + symbols[f"y_{n}"] * e_1 + symbols[f"z_{n}"] * e_t)
        k.output("e", _rows(directions), Unit.NONE, Frame.BASE, "axes e_k, a row for each chain")
        tilt, turn = symbols["tilt_1"], symbols["turn_1"]
        away = sp.cos(turn) * e_1 + sp.sin(turn) * e_t
        normals = [sp.cos(tilt) * away - sp.sin(tilt) * e_x, sp.cos(turn) * e_t - sp.sin(turn) * e_1]
        k.output(
            "n", _rows(normals), Unit.NONE, Frame.BASE, "two normals of axis 1, to measure angles about it"
        )
        k.output("g", _rows(centres), Unit.METRE, Frame.BASE, "points g_k, a row for each chain")
        return GeometryType(f"subleg_{self.name}", self.doc, fields, k.kernel())

    def _normals(self, k: KernelWriter, s: sp.Matrix) -> list[sp.Matrix]:
        """p_k, (2.52)."""
        found = []
        for n in CHAINS:
            arm, e = k.let(f"arm_{n}", s - row(k.g.g, n - 1), "s - g_k"), row(k.g.e, n - 1)
            found.append(k.let(f"p_{n}", arm - dot(arm, e) * e, "(2.52)"))
        return found

    def chains(self, k: KernelWriter, s: sp.Matrix, theta: sp.Matrix) -> list[Chain]:
        return [Chain(p, rho, rho) for p, rho in zip(self._normals(k, s), theta, strict=True)]

    def scales(self, k: KernelWriter) -> tuple[Any, Any]:
        return k.g.R_b, k.g.R_b

    def forward_roots(self) -> ForwardRoots:
        return forward_roots(self)

    def inverse(
        self, k: KernelWriter, s: sp.Matrix, mode: sp.Matrix, swivel: Any
    ) -> tuple[list[Any], list[Any]]:
        return [sp.sqrt(dot(p, p)) for p in self._normals(k, s)], []

    def posture_ports(self) -> tuple[Port, ...]:
        travel = Port("travel", (3,), Unit.METRE, Frame.JOINT, "e_k^T (s - g_k)", Layout.STACKED)
        return (*super().posture_ports(), travel)

    def posture(self, k: KernelWriter, s: sp.Matrix, theta: sp.Matrix) -> Posture:
        travel = [dot(s - row(k.g.g, n - 1), row(k.g.e, n - 1)) for n in CHAINS]
        return {**super().posture(k, s, theta), "travel": k.let("travel", sp.Matrix(travel))}

    def passive_angles(self, k: KernelWriter, at: SimpleNamespace) -> list[Any]:
        # the turn is zero along e_1 x e_k, which is normal to the axis whatever its direction but e_1
        found = []
        for n in CHAINS:
            e, p = row(k.g.e, n - 1), row(at.w, n - 1)
            zero = k.let(f"zero_{n}", cross(k.g.e_1, e))
            found += [k.atan2(dot(cross(e, zero), p), dot(zero, p)), at.travel[n - 1]]
        return found

    def link_frame(self, k: KernelWriter, at: SimpleNamespace) -> sp.Matrix:
        return leg_axes(k)

    def points(self, k: KernelWriter, at: SimpleNamespace, s: sp.Matrix) -> dict[str, sp.Matrix]:
        return {**{f"C_{n}": s - row(at.w, n - 1) for n in CHAINS}, "S": s}


def _rows(vectors: list[sp.Matrix]) -> sp.Matrix:
    return sp.Matrix([list(vector) for vector in vectors])
