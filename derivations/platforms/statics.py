"""Statics of a platform arrangement: what its three legs' lines carry (Chapter 5).

Forces are those that the robot applies to its environment.  A leg gives the platform the force g_i at S_i:
lambda along the lines of J, (1.31), and the force or moment of the redundant coordinate, which acts along
c_i = e_i / |e_i|^2 with e_i = ds_i/d(redundant).  As c_i is normal to the lines, the rows

    J_n = [[J, 0], [C, 1]],  K_n = [N M; c^T M]

are those of the non-redundant view, (5.59), for any arrangement: c_i^T s_dot_i is the redundant
coordinate's rate and what the platform carries along.  (5.60) has S_i - O' = d_i c_i in place of c_i, and is
singular at d_i = 0, where there is nothing singular.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import sympy as sp

from krhpr.codegen.kernel import Frame, Kernel, Layout, Port, Unit
from krhpr.codegen.writer import KernelWriter
from krhpr.derivations.platforms.kernels import PlatformKernels, all_legs
from krhpr.derivations.terms import Pose, Space
from krhpr.derivations.vectors import cross, cross2, dot, solve3

if TYPE_CHECKING:
    from krhpr.derivations.platforms.base import Platform


class StaticsPorts:
    """The ports of the statics of an arrangement."""

    def __init__(self, platform: Platform) -> None:
        space, joint = platform.space, platform.redundant_joint
        d, f, rows = space.dimension, space.degrees_of_freedom, space.rows_per_leg
        spatial = space is Space.SPATIAL
        stacked = Layout.STACKED
        self.wrench = Port(
            "wrench",
            (f,),
            Unit.WRENCH,
            Frame.BASE,
            "force and moment about O' that the robot applies to its environment",
        )
        what = "moment" if joint.kind == "revolute" else "force"
        self.redundant_forces = Port(
            "redundant_forces",
            (),
            Unit.ACTUATOR_FORCE,
            Frame.JOINT,
            f"{what} that the robot applies to its environment along {joint.name}, between redundant link "
            "and platform",
            stacked,
        )
        self.along = Port("along", (d,), Unit.MIXED, Frame.BASE, "c_i = e_i / |e_i|^2", stacked)
        self.redundant_line = Port(
            "redundant_line",
            (6 if spatial else 3,),
            Unit.MIXED,
            Frame.PLATFORM,
            "c_i and its moment about O'",
            stacked,
        )
        self.line_forces = Port(
            "line_forces", (rows,), Unit.MIXED, Frame.NONE, "lambda, along the leg's lines", stacked
        )
        self.end_force = Port(
            "end_force",
            (d,),
            Unit.NEWTON,
            Frame.BASE,
            "force of the sub-leg on what it holds, at S_i",
            stacked,
        )
        self.moment = Port(
            "moment", (3,) if spatial else (), Unit.NEWTON_METRE, Frame.BASE, "its moment about O'", stacked
        )


class StaticsKernels:
    """Writes the kernels of the statics of one arrangement."""

    def __init__(self, base: PlatformKernels) -> None:
        self.base, self.plate, self.ports = base, base.plate, base.ports
        self.statics = StaticsPorts(base.plate)

    def all(self) -> tuple[Kernel, ...]:
        """Every kernel, in the order in which it is printed."""
        return self._redundant_line(), self._balance(), self._reaction()

    def _redundant_direction(self, k: KernelWriter, pose: Pose, s: sp.Matrix) -> sp.Matrix:
        """e_i = ds_i/d(redundant), the platform at rest."""
        still = sp.zeros(self.plate.space.dimension, 1)
        return k.let("e", self.plate.end_velocity(k, pose, s, still, sp.Integer(1)), "ds_i/d(redundant)")

    def _redundant_line(self) -> Kernel:
        k, pose, s = self.base.begin(
            "redundant_line",
            "The line along which the redundant coordinate's force acts: c_i in the base frame, and with its "
            "moment about O' in the platform frame.",
            "(5.53), (5.58)",
        )
        along = k.let("c", self._redundant_direction(k, pose, s) / self.plate.lever(k) ** 2)
        local = k.let("c_l", pose.Q.T * along, "in the platform frame")
        arm = k.let("u_l", pose.Q.T * (s - pose.p), "O' to S_i")
        spatial = self.plate.space is Space.SPATIAL
        moment = list(cross(arm, local)) if spatial else [cross2(arm, local)]
        k.add_output(self.statics.along, along)
        k.add_output(self.statics.redundant_line, [*local, *moment])
        return k.kernel()

    def _balance(self) -> Kernel:
        """J^T lambda = F - C^T phi, in the platform frame where J is block triangular; exact for any s."""
        k = KernelWriter(
            "balance",
            "Forces along the legs' lines that give a wrench and forces along the redundant coordinates: "
            "J^T lambda = F - C^T phi solved in the platform frame.",
            "(5.12), (5.44)",
        )
        ports, space = self.ports, self.plate.space
        Q = k.add_input(ports.Q)
        lines, points = all_legs(k, ports.line), all_legs(k, ports.point)
        redundant = all_legs(k, self.statics.redundant_line)
        forces = all_legs(k, self.statics.redundant_forces)
        wrench = k.add_input(self.statics.wrench)
        d, f = space.dimension, space.degrees_of_freedom
        local = [*(Q.T * wrench[:d, 0]), *(Q.T * wrench[d:, 0] if d == 3 else wrench[d:, 0])]
        rest = k.let(
            "rest",
            sp.Matrix(
                [
                    local[j] - sum(phi * line[j] for phi, line in zip(forces, redundant, strict=True))
                    for j in range(f)
                ]
            ),
            "F - C^T phi in the platform frame",
        )
        in_plane = sp.Matrix.hstack(*(sp.Matrix([line[0], line[1], line[-1]]) for line in lines))
        scaled, det_a = solve3(in_plane, sp.Matrix([rest[0], rest[1], rest[f - 1]]))
        inverse_a = k.let("inv_a", 1 / k.let("det_a", det_a))
        a = k.let("lambda_a", scaled * inverse_a, "along the lines in the plane")
        if d == 2:
            k.add_output(self._whole(self.statics.line_forces), a)
            self.base.regularity(k, det_a, None, lines, points)
            return k.kernel()
        # the lines along q_z carry the rest, and what the others have out of the plane (s off it)
        right = [
            rest[j] - sum(force * line[j] for force, line in zip(a, lines, strict=True)) for j in (2, 3, 4)
        ]
        normal = sp.Matrix.hstack(*(sp.Matrix([1, point[1], -point[0]]) for point in points))
        scaled, det_n = solve3(normal, k.let("r_n", sp.Matrix(right)))
        inverse_n = k.let("inv_n", 1 / k.let("det_n", det_n))
        n = k.let("lambda_n", scaled * inverse_n, "along q_z")
        k.add_output(self._whole(self.statics.line_forces), [[a[i], n[i]] for i in range(3)])
        self.base.regularity(k, det_a, det_n, lines, points)
        return k.kernel()

    @staticmethod
    def _whole(port: Port) -> Port:
        """A leg-wise port as that of all legs."""
        return Port(port.name, (3, *port.shape), port.unit, port.frame, port.doc)

    def _reaction(self) -> Kernel:
        k, pose, s = self.base.begin(
            "reaction",
            "What the force of a sub-leg does: its moment about O', and its part along the redundant "
            "coordinate.",
            "(5.36)",
        )
        force = k.add_input(self.statics.end_force)
        arm = k.let("u", s - pose.p, "O' to S_i")
        spatial = self.plate.space is Space.SPATIAL
        k.add_output(self.statics.moment, cross(arm, force) if spatial else cross2(arm, force))
        k.add_output(self.statics.redundant_forces, dot(self._redundant_direction(k, pose, s), force))
        return k.kernel()


def whole_wrench(space: Space) -> Kernel:
    """The sum of the legs' forces and of their moments."""
    d = space.dimension
    k = KernelWriter("total", "The wrench of three forces: their sum, and that of their moments.", "(5.36)")
    forces = k.input("end_force", (3, d))
    moments: Any = k.input("moment", (3, 3) if d == 3 else (3,))
    total = [sum(forces[i, j] for i in range(3)) for j in range(d)]
    if d == 3:
        total += [sum(moments[i, j] for i in range(3)) for j in range(3)]
    else:
        total.append(sum(moments))
    k.output("wrench", sp.Matrix(total), Unit.WRENCH, Frame.BASE)
    return k.kernel()
