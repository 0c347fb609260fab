"""Statics of a sub-leg: its actuators' forces and the force that it gives at its end point (Chapter 5).

By virtual work these maps are the transposes of those of velocities: f = M^T g, and g = M^-T f.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import sympy as sp

from krhpr.codegen.kernel import Frame, Kernel, Layout, Port, Unit
from krhpr.codegen.writer import KernelWriter
from krhpr.derivations.vectors import cross, cross2, dot

if TYPE_CHECKING:
    from krhpr.derivations.sublegs.base import SubLeg
    from krhpr.derivations.sublegs.kernels import SubLegKernels


class StaticsPorts:
    """The ports of the statics of a sub-leg."""

    def __init__(self, subleg: SubLeg) -> None:
        d, n, rows = subleg.space.dimension, subleg.n, subleg.space.rows_per_leg
        names = tuple(joint.name for joint in subleg.actuators)
        stacked = Layout.STACKED
        self.actuator_forces = Port(
            "actuator_forces",
            (n,),
            Unit.ACTUATOR_FORCE,
            Frame.JOINT,
            "torques or forces of the actuators, positive where they do work at positive rates",
            stacked,
            names,
        )
        self.all_forces = replace(self.actuator_forces, shape=(3, n), layout=Layout.SHARED)
        """Those of all legs, which are found together."""
        self.swivel_forces = Port(
            "swivel_forces",
            (),
            Unit.ACTUATOR_FORCE,
            Frame.JOINT,
            "moment that the actuators give along the swivel, which moves nothing else",
            stacked,
        )
        self.end_force = Port(
            "end_force",
            (d,),
            Unit.NEWTON,
            Frame.BASE,
            "force of the sub-leg on what it holds, at S_i",
            stacked,
        )
        self.along = Port(
            "along", (d,), Unit.MIXED, Frame.BASE, "c_i, where the redundant force acts", stacked
        )
        self.count = rows + 1 + (1 if subleg.redundant else 0)
        """Rows of the leg's block of K_n: of the lines, of the redundant coordinate, of the swivel."""
        self.K_n = Port(
            "K_n", (self.count * n,), Unit.MIXED, Frame.BASE, "the leg's block of K_n, row by row", stacked
        )
        freedom = subleg.space.degrees_of_freedom + 3 + (3 if subleg.redundant else 0)
        self.J_n = Port(
            "J_n", (3 * self.count, freedom), Unit.MIXED, Frame.BASE, "Jacobian of all coordinates"
        )


class StaticsKernels:
    """Writes the kernels of the statics of one sub-leg."""

    def __init__(self, base: SubLegKernels) -> None:
        self.base, self.leg, self.ports = base, base.leg, base.ports
        self.statics = StaticsPorts(base.leg)

    def all(self) -> tuple[Kernel, ...]:
        """Every kernel, in the order in which it is printed."""
        return self._transmission(), self._non_redundant(), self._torques(), self._end_force()

    def _transmission(self) -> Kernel:
        swivel = ", and the swivel's" if self.leg.redundant else ""
        k = KernelWriter(
            "transmission",
            f"Rows of K_n for the {self.leg.notation} sub-leg: N M_i, c_i^T M_i{swivel}.",
            "(5.57), (5.59)",
            self.base.geometry,
        )
        d = self.leg.space.dimension
        equations = self.leg.velocity(k, self.base.at(k))
        rows = sp.Matrix.vstack(k.add_input(self.ports.N), k.add_input(self.statics.along).T)
        local = self.base.columns(k, equations)
        M = k.let("m", local[:d, :], "A^-1 B in the leg's frame")
        whole = k.let("n", rows * equations.F, "N and c_i in the leg's frame") * M
        if self.leg.redundant:
            whole = sp.Matrix.vstack(whole, local[d:, :])
        k.add_output(self.statics.K_n, whole)
        self.base.regularity(k, (*equations.parallel, *(equations.others if self.leg.redundant else ())))
        return self.base.end(k)

    def _non_redundant(self) -> Kernel:
        """[[J, 0], [C, 1]], leg by leg as the blocks of K_n: lines, redundant coordinate, swivel."""
        k = KernelWriter(
            "non_redundant",
            "J_n of J_n [t, rates of the redundant coordinates, of swivels] = K_n theta_dot.",
            "(5.58) to (5.60)",
        )
        space, swivels = self.leg.space, 3 if self.leg.redundant else 0
        d, f, rows = space.dimension, space.degrees_of_freedom, space.rows_per_leg
        lines = k.input("J", (3, rows * f))
        along, p, s = k.input("along", (3, d)), k.input("p", (d,)), k.input("s", (3, d))
        found: list[list[Any]] = []
        for i in range(3):
            alone = [sp.Integer(j == i) for j in range(3)]
            nothing = [sp.Integer(0)] * 3
            none = [sp.Integer(0)] * swivels
            found += [[*row, *nothing, *none] for row in sp.Matrix(rows, f, list(lines.row(i))).tolist()]
            c, arm = along.row(i).T, k.let(f"u_{i + 1}", s.row(i).T - p, "O' to S_i")
            moment = list(cross(arm, c)) if d == 3 else [cross2(arm, c)]
            found.append([*c, *moment, *alone, *none])
            if swivels:
                found.append([*([sp.Integer(0)] * f), *nothing, *alone])
        k.add_output(self.statics.J_n, sp.Matrix(found))
        return k.kernel()

    def _torques(self) -> Kernel:
        k = KernelWriter("torques", "Forces of all actuators, f = K_n^T [lambda, phi].", "(5.12), (5.44)")
        n, rows = self.leg.n, self.leg.space.rows_per_leg
        blocks = k.input("K_n", (3, self.statics.K_n.size))
        lines = k.input("line_forces", (3, rows))
        redundant = k.input("redundant_forces", (3,))
        swivels = k.input("swivel_forces", (3,)) if self.leg.redundant else None
        forces = []
        for i in range(3):
            of_leg = [*lines.row(i), redundant[i], *([] if swivels is None else [swivels[i]])]
            block = sp.Matrix(self.statics.count, n, list(blocks.row(i)))
            forces.append(block.T * sp.Matrix(of_leg))
        k.add_output(self.statics.all_forces, sp.Matrix.hstack(*forces).T)
        return k.kernel()

    def _end_force(self) -> Kernel:
        """The transpose of `rates`: what unit velocities ask of the joints."""
        k = KernelWriter(
            "end_force",
            f"Force at the end point of the {self.leg.notation} sub-leg from those of its actuators: "
            "g = M_i^-T f.",
            "(5.36)",
            self.base.geometry,
        )
        at = self.base.at(k)
        equations = self.leg.velocity(k, at)
        forces = k.add_input(self.statics.actuator_forces)
        d = self.leg.space.dimension
        size = d + 1 if self.leg.redundant else d
        local: list[Any] = [
            dot(self.leg.rates(k, at, equations, sp.eye(size).col(j)), forces) for j in range(size)
        ]
        k.add_output(
            self.statics.end_force,
            equations.F * k.let("g_l", sp.Matrix(local[:d]), "in the leg's frame"),
        )
        if self.leg.redundant:
            k.add_output(self.statics.swivel_forces, local[d])
        self.base.regularity(k, (*equations.serial, *(equations.others if self.leg.redundant else ())))
        return self.base.end(k)
