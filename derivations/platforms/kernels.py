"""Kernels of a platform arrangement, derived from what its file states: the same for every arrangement."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import sympy as sp

from krhpr.codegen.kernel import Frame, Kernel, Layout, Port, Unit
from krhpr.codegen.writer import KernelWriter
from krhpr.derivations.spectra import cofactors, determinant
from krhpr.derivations.terms import Pose, Space
from krhpr.derivations.vectors import NO_LENGTH, E, cross, determinant3, dot, solve3

if TYPE_CHECKING:
    from krhpr.derivations.platforms.base import Platform

STACKED = Layout.STACKED


class PlatformKernels:
    """Writes the kernels of one arrangement: leg-wise ones first, then those that join the legs."""

    def __init__(self, plate: Platform) -> None:
        self.plate, self.ports = plate, PlatformPorts(plate)

    def all(self) -> tuple[Kernel, ...]:
        """Every kernel, in the order in which it is printed."""
        velocity = self._end_velocity()
        rows = self._rows()
        return (
            self._end_point(),
            self._redundant(),
            self._residual(),
            rows,
            self._line(),
            self._line_of_redundant(),
            velocity,
            self._end_acceleration(velocity),
            self._row_bias(rows),
            self._joint(),
            self._attachment(),
            self._solve(),
            self._type_2(),
            self._sensitivity(),
            *self.plate.forward_kernels(),
        )

    def begin(
        self, name: str, doc: str, equations: str = "", *, s: bool = True
    ) -> tuple[KernelWriter, Pose, Any]:
        """A kernel of one leg, with the pose and the end point (None without `s`) as its inputs."""
        k = KernelWriter(name, doc, equations, self.plate.geometry())
        ports = self.ports
        pose = Pose(k.add_input(ports.p), k.add_input(ports.Q))
        return k, pose, k.add_input(ports.s) if s else None

    def _end_point(self) -> Kernel:
        k, pose, _ = self.begin(
            "end_point",
            f"End point of the sub-leg, arrangement ({self.plate.arrangement}).",
            "(1.37), 2.5",
            s=False,
        )
        ports = self.ports
        k.add_output(ports.s, self.plate.end_point(k, pose, k.add_input(ports.redundant)))
        return k.kernel()

    def _redundant(self) -> Kernel:
        k, pose, s = self.begin("redundant", f"Redundant coordinate: {self.plate.redundant_joint.doc}.")
        k.add_output(self.ports.redundant, self.plate.redundant(k, pose, s))
        return k.kernel()

    def _residual(self) -> Kernel:
        k, pose, s = self.begin("residual", "Residuals of the constraint equations.", self.plate.equations)
        k.add_output(self.ports.residual, self.plate.residual(k, pose, s))
        return k.kernel()

    def _rows(self) -> Kernel:
        k, pose, s = self.begin(
            "rows", "Rows of J, and the directions N with J t = N s_dot.", "(1.31), (2.28)"
        )
        ports = self.ports
        jacobian, directions = self._write_rows(k, pose, s)
        k.add_output(ports.J, jacobian)
        k.add_output(ports.N, directions)
        return k.kernel()

    def _write_rows(self, k: KernelWriter, pose: Pose, s: sp.Matrix) -> tuple[sp.Matrix, sp.Matrix]:
        along = k.let("a", self.plate.direction(k, pose, s))
        anchor = k.let("b", self.plate.anchor(k, pose, s), "from O' to the line")
        if self.plate.space is Space.PLANAR:
            return sp.Matrix([[along[0], along[1], dot(along, E * anchor)]]), along.T
        q_z = pose.Q.col(2)
        u = k.let("u", s - pose.p, "(1.25), O' to S_i")
        first = [*along, *cross(anchor, along)]
        return sp.Matrix([first, [*q_z, *cross(u, q_z)]]), sp.Matrix([list(along), list(q_z)])

    def _line(self) -> Kernel:
        k, pose, s = self.begin(
            "line",
            "The leg's line in the platform frame (direction, moment about O'), its end point there, and N.",
            "(1.33), (1.34)",
        )
        ports = self.ports
        line, point, along = self._write_line(k, pose, s)
        directions = along.T
        if self.plate.space is Space.SPATIAL:
            directions = sp.Matrix([list(along), list(pose.Q.col(2))])
        k.add_output(ports.line, line)
        k.add_output(ports.point, point)
        k.add_output(ports.N, directions)
        k.add_output(ports.scale, self.plate.scale(k))
        return k.kernel()

    def _line_of_redundant(self) -> Kernel:
        """The same line and end point at the pose p = 0, Q = 1, where both frames are one."""
        k = KernelWriter(
            "line_of_redundant",
            "The leg's line and end point in the platform frame from the redundant coordinate alone.",
            "(1.33), (1.34)",
            self.plate.geometry(),
        )
        ports, d = self.ports, self.plate.space.dimension
        pose = Pose(sp.zeros(d, 1), sp.eye(d))
        s = self.plate.end_point(k, pose, k.add_input(ports.redundant))
        line, point, _ = self._write_line(k, pose, s)
        k.add_output(ports.line, line)
        k.add_output(ports.point, point)
        k.add_output(ports.scale, self.plate.scale(k))
        return k.kernel()

    def _write_line(
        self, k: KernelWriter, pose: Pose, s: sp.Matrix
    ) -> tuple[list[Any], sp.Matrix, sp.Matrix]:
        """Line and S_i in the platform frame, and the line's direction in the base frame."""
        along = k.let("a", self.plate.direction(k, pose, s))
        anchor = k.let("b", self.plate.anchor(k, pose, s), "from O' to the line")
        u = k.let("u", s - pose.p, "O' to S_i")
        local = k.let("a_l", pose.Q.T * along, "in the platform frame")
        arm = k.let("b_l", pose.Q.T * anchor)
        point = (pose.Q.T * u)[:2, 0]
        if self.plate.space is Space.PLANAR:
            return [*local, local[1] * arm[0] - local[0] * arm[1]], point, along
        return [*local, *cross(arm, local)], point, along

    def _end_velocity(self) -> Kernel:
        k, pose, s = self.begin(
            "end_velocity",
            "Velocity of the end point from the platform's twist and the redundant coordinate's rate.",
            "(1.37) differentiated",
        )
        ports = self.ports
        twist, rate = k.add_input(ports.twist), k.add_input(ports.redundant_rates)
        k.add_output(ports.s_dot, self.plate.end_velocity(k, pose, s, self._carried(k, pose, s, twist), rate))
        return k.kernel()

    def _carried(self, k: KernelWriter, pose: Pose, s: sp.Matrix, twist: sp.Matrix) -> sp.Matrix:
        """Velocity of the platform's point that coincides with S_i."""
        u = k.let("u", s - pose.p, "O' to S_i")
        if self.plate.space is Space.PLANAR:
            return k.let("carried", twist[:2, 0] + twist[2] * (E * u))
        return k.let("carried", twist[:3, 0] + cross(twist[3:, 0], u))

    def _pose_rates(self, k: KernelWriter, pose: Pose, twist: sp.Matrix) -> dict[str, sp.Matrix]:
        """p_dot and Q_dot = Omega Q, (1.6), (2.5)."""
        if self.plate.space is Space.PLANAR:
            return {"p": twist[:2, 0], "Q": twist[2] * (E * pose.Q)}
        omega = twist[3:, 0]
        return {"p": twist[:3, 0], "Q": sp.Matrix.hstack(*(cross(omega, pose.Q.col(j)) for j in range(3)))}

    def _end_acceleration(self, velocity: Kernel) -> Kernel:
        k, pose, s = self.begin(
            "end_acceleration", "Velocity and acceleration of the end point from those of the platform."
        )
        ports = self.ports
        twist, rate = k.add_input(ports.twist), k.add_input(ports.redundant_rates)
        twist_rate, acceleration = k.add_input(ports.twist_rate), k.add_input(ports.redundant_accelerations)
        arguments = {"p": pose.p, "Q": pose.Q, "s": s, "twist": twist, "redundant_rates": rate}
        s_dot = k.call(velocity, **arguments).s_dot
        directions = {
            **self._pose_rates(k, pose, twist),
            "s": s_dot,
            "twist": twist_rate,
            "redundant_rates": acceleration,
        }
        value, derivative = k.call_tangent(velocity, "s_dot", arguments, directions)
        k.add_output(ports.s_dot, value)
        k.add_output(ports.s_ddot, derivative)
        return k.kernel()

    def _row_bias(self, rows: Kernel) -> Kernel:
        k, pose, s = self.begin(
            "row_bias",
            "J t_dot = N s_ddot + bias with bias = N_dot s_dot - J_dot t: what (1.30) gains when "
            "it is differentiated.",
        )
        ports = self.ports
        twist, s_dot = k.add_input(ports.twist), k.add_input(ports.s_dot)
        arguments = {"p": pose.p, "Q": pose.Q, "s": s}
        directions = {**self._pose_rates(k, pose, twist), "s": s_dot}
        _, j_dot = k.call_tangent(rows, "J", arguments, directions)
        _, n_dot = k.call_tangent(rows, "N", arguments, directions)
        k.add_output(ports.bias, n_dot * s_dot - j_dot * twist)
        return k.kernel()

    def _joint(self) -> Kernel:
        k, pose, s = self.begin(
            "joint", "Orientation of the redundant link and the joint that ties it to the platform."
        )
        ports = self.ports
        k.add_output(ports.link, self.plate.joint(k, pose, s))
        k.add_output(ports.platform_joint, self.plate.redundant(k, pose, s))
        return k.kernel()

    def _attachment(self) -> Kernel:
        k, pose, s = self.begin("attachment", "Where the redundant link meets the platform.")
        k.add_output(self.ports.attachment, self.plate.attachment(k, pose, s))
        return k.kernel(prune=("p", "Q", "s"))

    def _solve(self) -> Kernel:
        """J t = r for the twist, in the platform frame where J is block triangular; exact for any s."""
        k = KernelWriter(
            "solve",
            "The twist from the legs' rates r = N s_dot: J t = r solved in the platform frame.",
            "(1.30)",
        )
        ports = self.ports
        Q = k.add_input(ports.Q)
        lines, points = all_legs(k, ports.line), all_legs(k, ports.point)
        rates = all_legs(k, ports.rate)
        if self.plate.space is Space.PLANAR:
            in_plane = sp.Matrix.vstack(*(line.T for line in lines))
            scaled, det_a = solve3(in_plane, sp.Matrix([rate[0] for rate in rates]))
            inverse_a = k.let("inv_a", 1 / k.let("det_a", det_a))
            local = k.let("t_l", scaled * inverse_a, "twist in the platform frame")
            k.add_output(ports.twist, [*(Q * local[:2, 0]), local[2]])
            self.regularity(k, det_a, None, lines, points)
            return k.kernel()
        # rows along q_z: v_z + y_i omega_x - x_i omega_y = r_i2, (1.33)
        normal = sp.Matrix([[1, point[1], -point[0]] for point in points])
        scaled, det_n = solve3(normal, sp.Matrix([rate[1] for rate in rates]))
        inverse_n = k.let("inv_n", 1 / k.let("det_n", det_n))
        v_z, w_x, w_y = k.let("n_l", scaled * inverse_n, "v_z, omega_x, omega_y in the platform frame")
        # rows in the plane, (1.34); what the lines have out of the plane (s off the platform's plane) moves
        # to the right
        in_plane = sp.Matrix([[line[0], line[1], line[5]] for line in lines])
        right = [
            rate[0] - line[2] * v_z - line[3] * w_x - line[4] * w_y
            for line, rate in zip(lines, rates, strict=True)
        ]
        scaled, det_a = solve3(in_plane, k.let("r_a", sp.Matrix(right)))
        inverse_a = k.let("inv_a", 1 / k.let("det_a", det_a))
        v_x, v_y, w_z = k.let("a_l", scaled * inverse_a, "v_x, v_y, omega_z in the platform frame")
        k.add_output(ports.twist, [*(Q * sp.Matrix([v_x, v_y, v_z])), *(Q * sp.Matrix([w_x, w_y, w_z]))])
        self.regularity(k, det_a, det_n, lines, points)
        return k.kernel()

    def regularity(
        self, k: KernelWriter, det_a: Any, det_n: Any, lines: list[Any], points: list[Any]
    ) -> None:
        """Squares of the factors of det J over bounds that they cannot exceed: dimensionless, zero when
        singular.
        """
        directions = [k.let(f"d2_{i}", line[0] ** 2 + line[1] ** 2) for i, line in enumerate(lines)]
        size = k.let("size", sum(dot(point, point) for point in points) + NO_LENGTH, "sum of |S_i - O'|^2")
        value_a = det_a**2 / (directions[0] * directions[1] * directions[2] * size)
        values = [value_a] if det_n is None else [value_a, det_n**2 / size**2]
        k.add_output(self.ports.regularity, values)

    def _type_2(self) -> Kernel:
        k = KernelWriter("type_2", f"Factors of det J and margins.  {self.plate.type_2_doc}", "1.4, 2.3.2")
        ports = self.ports
        lines, points, scale = all_legs(k, ports.line), all_legs(k, ports.point), all_legs(k, ports.scale)
        if self.plate.space is Space.PLANAR:
            det_a = k.let("det_a", determinant3(sp.Matrix.vstack(*(line.T for line in lines))), "det J")
            k.add_output(ports.type_2, [det_a])
            k.add_output(ports.margins, self.plate.margins(k, det_a, None, sp.Matrix.hstack(*scale).T))
            return k.kernel()
        det_a = k.let(
            "det_a", determinant3(sp.Matrix([[line[0], line[1], line[5]] for line in lines])), "det J_a"
        )
        det_n = k.let(
            "det_n", determinant3(sp.Matrix([[1, point[1], -point[0]] for point in points])), "det J_n"
        )
        k.add_output(ports.type_2, [det_a, det_n])
        k.add_output(ports.margins, self.plate.margins(k, det_a, det_n, sp.Matrix.hstack(*scale).T))
        return k.kernel()

    def _sensitivity(self) -> Kernel:
        """Where J is block triangular, in the platform frame: turning it changes no norm."""
        k = KernelWriter(
            "sensitivity",
            "Squares of the position and the rotation part of U = J^-1 K, in the platform frame.",
            "1.8, 4.2.2",
        )
        ports = self.ports
        lines, points = all_legs(k, ports.line), all_legs(k, ports.point)
        reach = all_legs(k, ports.reach)
        if self.plate.space is Space.PLANAR:
            in_plane = sp.Matrix.vstack(*(line.T for line in lines))
            inverse, det_a = self._inverse(k, "a", in_plane)
            squares = [sp.Matrix([[r[0]]]) for r in reach]
            rows = [[sp.Matrix([[inverse[row, leg]]]) for leg in range(3)] for row in range(3)]
            k.add_output(ports.position_gram, _gram(rows[:2], squares))
            k.add_output(ports.rotation_gram, _gram(rows[2:], squares))
            self.regularity(k, det_a, None, lines, points)
            return k.kernel()
        normal, det_n = self._inverse(k, "n", sp.Matrix([[1, point[1], -point[0]] for point in points]))
        in_plane = sp.Matrix([[line[0], line[1], line[5]] for line in lines])
        plane, det_a = self._inverse(k, "a", in_plane)
        # what the lines have out of the plane couples the two, as in `solve`
        out = k.let("c", sp.Matrix([[line[2], line[3], line[4]] for line in lines]) * normal)
        mixed = k.let("x", -plane * out)
        v_x, v_y, w_z = (
            [sp.Matrix([[plane[row, leg], mixed[row, leg]]]) for leg in range(3)] for row in range(3)
        )
        v_z, w_x, w_y = ([sp.Matrix([[0, normal[row, leg]]]) for leg in range(3)] for row in range(3))
        squares = [sp.Matrix([[r[0], r[1]], [r[1], r[2]]]) for r in reach]
        k.add_output(ports.position_gram, _gram([v_x, v_y, v_z], squares))
        k.add_output(ports.rotation_gram, _gram([w_x, w_y, w_z], squares))
        self.regularity(k, det_a, det_n, lines, points)
        return k.kernel()

    @staticmethod
    def _inverse(k: KernelWriter, name: str, m: sp.Matrix) -> tuple[sp.Matrix, Any]:
        """The inverse of a 3 x 3 matrix, and its determinant."""
        minors = k.let(f"adj_{name}", cofactors(m))
        value = k.let(f"det_{name}", determinant(m, minors))
        return k.let(f"inv_{name}", minors.T * k.let(f"one_{name}", 1 / value)), value


def _gram(rows: list[list[sp.Matrix]], squares: list[sp.Matrix]) -> sp.Matrix:
    """U U^T from rows of J^-1, leg by leg, and each leg's K K^T."""
    d = len(rows)
    products = [[row[leg] * squares[leg] for leg in range(3)] for row in rows]
    return sp.Matrix(
        d,
        d,
        lambda i, j: sum(
            ((products[min(i, j)][leg] * rows[max(i, j)][leg].T)[0] for leg in range(3)), sp.Integer(0)
        ),
    )


def all_legs(k: KernelWriter, port: Port) -> list[Any]:
    """An input that holds all three legs' values, as a list of vectors or scalars."""
    whole = k.add_input(Port(port.name, (3, *port.shape), port.unit, port.frame, port.doc))
    return [whole.row(i).T if port.shape else whole[i] for i in range(3)]


class PlatformPorts:
    """The ports that every arrangement's kernels share."""

    def __init__(self, platform: Platform) -> None:
        space = platform.space
        d, f, rows = space.dimension, space.degrees_of_freedom, space.rows_per_leg
        spatial = space is Space.SPATIAL
        joint = platform.redundant_joint
        angle = joint.kind == "revolute"
        self.p = Port("p", (d,), Unit.METRE, Frame.BASE, "position of O'")
        self.Q = Port("Q", (d, d), Unit.NONE, Frame.BASE, "orientation, base from platform")
        self.s = Port("s", (d,), Unit.METRE, Frame.BASE, "end points of the sub-legs", STACKED)
        self.redundant = Port(
            "redundant", (), Unit.RADIAN if angle else Unit.METRE, Frame.JOINT, joint.doc, STACKED
        )
        self.redundant_rates = Port(
            "redundant_rates", (), Unit.ACTUATOR_RATE, Frame.JOINT, f"rate of {joint.name}", STACKED
        )
        self.redundant_accelerations = Port(
            "redundant_accelerations",
            (),
            Unit.ACTUATOR_ACCELERATION,
            Frame.JOINT,
            f"second rate of {joint.name}",
            STACKED,
        )
        self.platform_joint = Port("platform_joint", (), self.redundant.unit, Frame.JOINT, joint.doc, STACKED)
        self.residual = Port(
            "residual", (rows,), Unit.MIXED, Frame.NONE, "residuals of the constraint equations", Layout.ROWS
        )
        self.J = Port(
            "J",
            (rows, f),
            Unit.MIXED,
            Frame.BASE,
            "Jacobian of the platform, rows in the order of (1.31)",
            Layout.ROWS,
        )
        self.N = Port("N", (rows, d), Unit.MIXED, Frame.BASE, "directions of the leg's lines, rows", STACKED)
        twist = "twist [p_dot, omega]" if spatial else "twist [p_dot, phi_dot]"
        self.twist = Port("twist", (f,), Unit.TWIST, Frame.BASE, twist)
        self.twist_rate = Port("twist_rate", (f,), Unit.TWIST_RATE, Frame.BASE, "rate of the twist")
        self.s_dot = Port(
            "s_dot", (d,), Unit.METRE_PER_SECOND, Frame.BASE, "velocities of the end points", STACKED
        )
        self.s_ddot = Port(
            "s_ddot",
            (d,),
            Unit.METRE_PER_SECOND_SQUARED,
            Frame.BASE,
            "accelerations of the end points",
            STACKED,
        )
        self.bias = Port("bias", (rows,), Unit.MIXED, Frame.NONE, "N_dot s_dot - J_dot t", STACKED)
        self.rate = Port("rate", (rows,), Unit.MIXED, Frame.NONE, "N s_dot", STACKED)
        self.line = Port(
            "line",
            (6 if spatial else 3,),
            Unit.MIXED,
            Frame.PLATFORM,
            "direction and moment about O'",
            STACKED,
        )
        self.point = Port("point", (2,), Unit.METRE, Frame.PLATFORM, "S_i in the platform's plane", STACKED)
        self.scale = Port(
            "scale", (2,), Unit.METRE, Frame.NONE, "lengths that make margins dimensionless", STACKED
        )
        half = rows * (rows + 1) // 2
        self.reach = Port(
            "reach", (half,), Unit.MIXED, Frame.NONE, "K K^T of the leg, its upper half", STACKED
        )
        self.position_gram = Port("position_gram", (d, d), Unit.MIXED, Frame.PLATFORM, "U_p U_p^T")
        turns = 3 if spatial else 1
        self.rotation_gram = Port("rotation_gram", (turns, turns), Unit.MIXED, Frame.PLATFORM, "U_r U_r^T")
        link = (3, 3) if spatial else (2,)
        self.link = Port(
            "redundant_link", link, Unit.NONE, Frame.BASE, "orientation of the redundant link", STACKED
        )
        self.attachment = Port(
            "attachment", (d,), Unit.METRE, Frame.BASE, "joint or slider on the platform", STACKED
        )
        count = 2 if spatial else 1
        names = ("det J_a", "det J_n")[:count]
        self.type_2 = Port("type_2", (count,), Unit.MIXED, Frame.PLATFORM, "factors of det J", labels=names)
        self.margins = Port("margins", (count,), Unit.MIXED, Frame.NONE, platform.margins_doc, labels=names)
        self.regularity = Port(
            "regularity", (count,), Unit.NONE, Frame.NONE, "squared, scaled factors of det J"
        )
