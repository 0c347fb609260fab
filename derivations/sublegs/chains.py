"""Parallel sub-legs whose end point is held by as many chains as it has coordinates, each with one equation

    w_k^T w_k = rho_k^2,    w_k = P_k (s - g_k(theta_k)),

where w_k is the last link or strut of chain k (P_k = 1), or the part of it that is normal to an axis.  Their
velocity equations are those of (2.54): w_k^T s_dot = b_k theta_k_dot.
"""

from __future__ import annotations

from abc import abstractmethod
from dataclasses import dataclass
from types import SimpleNamespace
from typing import Any

import sympy as sp

from krhpr.codegen.kernel import Frame, GeometryField, GeometryType, Layout, Port, Unit
from krhpr.codegen.writer import KernelWriter
from krhpr.derivations.sublegs.base import Passive, Posture, SubLeg, VelocityEquations
from krhpr.derivations.sublegs.carriers import BASE_FIELDS, begin_geometry, radial, write_leg_frame
from krhpr.derivations.terms import Factor
from krhpr.derivations.vectors import cross2, determinant3, dot


@dataclass(frozen=True)
class Chain:
    """One chain: w_k, its length rho_k, and b_k of w_k^T s_dot = b_k theta_k_dot."""

    w: sp.Matrix
    length: Any
    b: Any


class ChainSubLeg(SubLeg):
    """A sub-leg of chains; a file says what the chains are, and how position is solved."""

    actuated: str
    """What it means that b_k vanishes, for the documentation of the factors."""

    @abstractmethod
    def chains(self, k: KernelWriter, s: sp.Matrix, theta: sp.Matrix) -> list[Chain]:
        """The chains at a consistent pair (s, theta)."""

    @abstractmethod
    def scales(self, k: KernelWriter) -> tuple[Any, Any]:
        """A length that makes det [w_1 ...] dimensionless (its power is taken), and a divisor of b_k."""

    @abstractmethod
    def link_frame(self, k: KernelWriter, at: SimpleNamespace) -> sp.Matrix:
        """Orientation of the link that carries the end point."""

    def passive_angles(self, k: KernelWriter, at: SimpleNamespace) -> list[Any]:
        """Coordinates of the passive joints, in the order of `passive_joints`."""
        return []

    def posture_ports(self) -> tuple[Port, ...]:
        d = self.space.dimension
        return (
            Port("w", (d, d), Unit.METRE, Frame.BASE, "w_k of the chains, a row for each", Layout.STACKED),
            Port("b", (d,), Unit.MIXED, Frame.NONE, "w_k^T s_dot = b_k theta_k_dot", Layout.STACKED),
        )

    def posture(self, k: KernelWriter, s: sp.Matrix, theta: sp.Matrix) -> Posture:
        found = self.chains(k, s, theta)
        w = k.let("w", sp.Matrix([list(chain.w) for chain in found]))
        return {"w": w, "b": k.let("b", sp.Matrix([chain.b for chain in found]))}

    def velocity(self, k: KernelWriter, at: SimpleNamespace) -> VelocityEquations:
        d = self.space.dimension
        w, b = at.w, at.b
        volume = determinant3(w) if d == 3 else cross2(w.row(0).T, w.row(1).T)
        volume = k.let("volume", volume, "det [w_1 ...]")
        scale, divisor = self.scales(k)
        product = sp.Integer(1)
        for entry in b:
            product = product * entry
        shape = "coplanar" if d == 3 else "aligned"
        return VelocityEquations(
            F=sp.eye(d),
            A=w,
            B=sp.diag(*b),
            determinant=product / volume,
            serial=tuple(
                Factor(f"chain_{i + 1}", b[i] / divisor, self.actuated.format(i + 1)) for i in range(d)
            ),
            parallel=(Factor("volume", volume / scale**d, f"the vectors w_k are {shape}"),),
            others=self.other_factors(k, at),
        )

    def other_factors(self, k: KernelWriter, at: SimpleNamespace) -> tuple[Factor, ...]:
        """Factors of singularities that det M_i does not show."""
        return ()

    def passive(self, k: KernelWriter, at: SimpleNamespace) -> Passive:
        named = tuple(zip(self.passive_joints, self.passive_angles(k, at), strict=True))
        return Passive(named, self.link_frame(k, at))

    def closure(self, k: KernelWriter, s: sp.Matrix, theta: sp.Matrix) -> sp.Matrix:
        return sp.Matrix([dot(chain.w, chain.w) - chain.length**2 for chain in self.chains(k, s, theta)])


def strut_angles(k: KernelWriter, w: sp.Matrix, frame: list[sp.Matrix], name: str) -> list[Any]:
    """The two angles of a universal joint that points a strut along w: the first about frame[0], the second
    about the turned frame[1]; both are zero where w is along frame[2].
    """
    along = [k.let(f"{name}_{i}", dot(w, axis)) for i, axis in enumerate(frame)]
    normal = k.let(f"{name}_n", sp.sqrt(along[1] ** 2 + along[2] ** 2))
    return [k.atan2(-along[1], along[2]), k.atan2(along[0], normal)]


def triad_geometry(
    name: str, doc: str, lengths: tuple[GeometryField, ...], radius: str, directions: bool
) -> GeometryType:
    """A leg frame, and three centres g_k about c on a horizontal circle.

    The field named `radius` is the circle's; g_k stands at the angle a_k from the leg's radial direction.
    With `directions`, the radial direction x_k of each centre is prepared as well.
    """
    angles = tuple(
        GeometryField(f"a_{k}", Unit.RADIAN, f"azimuth of g_{k} about c, from the leg's radial direction")
        for k in (1, 2, 3)
    )
    fields = (*BASE_FIELDS, *lengths, *angles)
    k, symbols = begin_geometry(fields)
    azimuth = symbols["azimuth"]
    e_t = k.let("e_t", sp.Matrix([-sp.sin(azimuth), sp.cos(azimuth), 0]))
    e_r = k.let("e_r", radial(azimuth))
    write_leg_frame(k, symbols, e_r, e_t)
    c = symbols["R_b"] * e_r + symbols["l_1"] * (
        -sp.cos(symbols["alpha"]) * e_r + sp.sin(symbols["alpha"]) * sp.Matrix([0, 0, 1])
    )
    c = k.let("c", c)
    around = [sp.cos(symbols[field.name]) * e_r + sp.sin(symbols[field.name]) * e_t for field in angles]
    rows = [k.let(f"x_{i + 1}", direction) for i, direction in enumerate(around)]
    centres = sp.Matrix([list(c + symbols[radius] * row) for row in rows])
    k.output("g", centres, Unit.METRE, Frame.BASE, "centres g_k, a row for each chain")
    if directions:
        k.output("x", sp.Matrix([list(row) for row in rows]), Unit.NONE, Frame.BASE, "radial directions x_k")
    return GeometryType(name, doc, fields, k.kernel())


def row(matrix: sp.Matrix, index: int) -> sp.Matrix:
    """A row of a prepared matrix, as a column."""
    return matrix.row(index).T
