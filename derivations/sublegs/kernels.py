"""Kernels of a sub-leg, derived from what its file states: the same for every sub-leg."""

from __future__ import annotations

from itertools import combinations
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any

import sympy as sp

from krhpr.codegen.kernel import Frame, Kernel, Port, Unit
from krhpr.codegen.writer import KernelWriter
from krhpr.derivations.spectra import cofactors, determinant
from krhpr.derivations.sublegs.ports import SubLegPorts
from krhpr.derivations.terms import Factor, JointKind
from krhpr.derivations.vectors import cross2, determinant3, dot, solve_columns, solve_structured

if TYPE_CHECKING:
    from krhpr.derivations.sublegs.base import SubLeg, VelocityEquations


REGULARITY_DOC = "smallest absolute factor of the determinant"

SMALLEST = sp.Rational(1, 10**12)
"""Metres or radians below which unknowns of Newton steps count as zero."""


class SubLegKernels:
    """Writes the kernels of one sub-leg."""

    def __init__(self, leg: SubLeg) -> None:
        self.leg, self.geometry, self.ports = leg, leg.geometry(), SubLegPorts(leg)

    def all(self) -> tuple[Kernel, ...]:
        """Every kernel, in the order in which it is printed."""
        leg = self.leg
        if leg.has_forward:
            forward = self._forward()
            kernels = [forward, self._forward(posture=True)]
            if leg.lists_assemblies:
                kernels.append(self._forward_all(forward))
        else:
            roots = leg.assembly_roots
            kernels = [self.forward_step(), *([roots.polynomial, roots.at_root] if roots else [])]
        if leg.has_inverse:
            inverse = self._inverse()
            kernels += [inverse, self._inverse_all(inverse), self._reach()]
        else:
            kernels.append(self.inverse_step())
        kernels += [
            self._posture(),
            self._jacobian(),
            self._project(),
            self._velocity(),
            self._bias(),
            self._rates(),
            self._determinant(),
            self._gram(),
            self._passive(),
            self.points(),
        ]
        return (*kernels, self._swivel(), self._swivel_difference()) if leg.redundant else tuple(kernels)

    def closure(self) -> Kernel:
        """The loop closure as a kernel; it is used by proofs and never printed."""
        k = KernelWriter("closure", "Loop closure of the sub-leg.", geometry=self.geometry)
        residual = self.leg.closure(k, k.add_input(self.ports.s), k.add_input(self.ports.theta))
        k.output("residual", residual)
        return k.kernel()

    def factors(self) -> tuple[tuple[Factor, ...], tuple[Factor, ...], tuple[Factor, ...]]:
        """The serial and the parallel factors of det M_i, and the others."""
        k = KernelWriter("factors", "", geometry=self.geometry)
        equations = self.leg.velocity(k, self.at(k))
        return equations.serial, equations.parallel, equations.others

    def _forward(self, *, posture: bool = False) -> Kernel:
        name, more = ("forward_posture", " and posture") if posture else ("forward", "")
        doc = f"End point{more} of the {self.leg.notation} sub-leg from its actuated joints."
        k = KernelWriter(name, doc, "3.5", self.geometry)
        theta = k.add_input(self.ports.theta)
        assembly = self._choice(k, self.ports.forward_choice)
        found = self.leg.forward(k, theta, assembly)
        k.add_output(self.ports.s, found.s)
        if posture:
            for port in self.leg.posture_ports():
                k.add_output(port, found.posture[port.name])
        if found.radicand is not None:
            k.output("radicand", found.radicand, doc="not negative where the loop closes")
        return k.kernel()

    def _forward_all(self, forward: Kernel) -> Kernel:
        labels = [mode.label for mode in self.leg.assemblies]
        order = ", ".join(labels) if self.leg.forward_signs else "first the one on the side of the normal"
        k = KernelWriter(
            "forward_all",
            f"End points of the {self.leg.notation} sub-leg in every assembly mode: {order}; NaN where the "
            "loop cannot close.",
            "3.5",
            self.geometry,
        )
        theta = k.add_input(self.ports.theta)
        if self.leg.forward_signs:
            found = [
                k.call(forward, theta=theta, assembly=sp.Matrix(mode.signs)) for mode in self.leg.assemblies
            ]
            points, radicand = (
                [mode.s for mode in found],
                k.maximum(*dict.fromkeys(m.radicand for m in found)),
            )
        else:
            both = self.leg.forward_all(k, theta)
            points, radicand = [mode.point for mode in both], both[0].radicand
        k.add_output(self.ports.s_all, points)
        k.output("radicand", radicand, doc="not negative where the loop closes")
        return k.kernel()

    @staticmethod
    def _choice(k: KernelWriter, ports: tuple[Port, ...]) -> sp.Matrix:
        """The signs of a branch, or the point that chooses it, as a vector; empty where there is no
        choice.
        """
        return k.add_input(ports[0]) if ports else sp.Matrix(0, 1, [])

    def _posture(self) -> Kernel:
        doc = f"Posture of the {self.leg.notation} sub-leg: what its velocity equations are made of."
        k = KernelWriter("posture", doc, "App. A, 2.3.1", self.geometry)
        found = self.leg.posture(k, k.add_input(self.ports.s), k.add_input(self.ports.theta))
        for port in self.leg.posture_ports():
            k.add_output(port, found[port.name])
        return k.kernel()

    def at(self, k: KernelWriter) -> SimpleNamespace:
        """The posture as inputs of a kernel."""
        return SimpleNamespace(**{port.name: k.add_input(port) for port in self.leg.posture_ports()})

    def end(self, k: KernelWriter) -> Kernel:
        """The kernel, without what it does not need of the posture."""
        return k.kernel(prune=[port.name for port in self.leg.posture_ports()])

    def _inverse(self) -> Kernel:
        k = KernelWriter(
            "inverse",
            f"Actuated joints of the {self.leg.notation} sub-leg in one working mode.  The mode is "
            "given by signs; NaN where "
            "the end point is out of reach.",
            self.leg.equations,
            self.geometry,
        )
        s, mode = k.add_input(self.ports.s), self._choice(k, self.ports.mode_choice)
        swivel = k.add_input(self.ports.swivel) if self.leg.redundant else None
        theta, radicands = self.leg.inverse(k, s, mode, swivel)
        k.add_output(self.ports.theta, theta)
        worst = k.minimum(*radicands) if radicands else sp.Integer(1)
        k.output("radicand", worst, Unit.MIXED, doc="not negative where the mode exists")
        return k.kernel()

    def _inverse_all(self, inverse: Kernel) -> Kernel:
        k = KernelWriter(
            "inverse_all",
            f"Every working mode of the {self.leg.notation} sub-leg, in the order "
            + ", ".join(mode.label for mode in self.leg.modes)
            + "; NaN where a mode does not exist.",
            self.leg.equations,
            self.geometry,
        )
        arguments = {"s": k.add_input(self.ports.s)}
        if self.leg.redundant:
            arguments["swivel"] = k.add_input(self.ports.swivel)
        found = [
            k.call(inverse, **arguments, **({"mode": sp.Matrix(mode.signs)} if mode.signs else {}))
            for mode in self.leg.modes
        ]
        k.add_output(self.ports.theta_all, [mode.theta for mode in found])
        best = k.maximum(*dict.fromkeys(mode.radicand for mode in found))
        k.output("radicand", best, Unit.MIXED, doc="not negative where at least one mode exists")
        return k.kernel()

    def _reach(self) -> Kernel:
        k = KernelWriter(
            "reach",
            f"Distance by which the end point lies outside the reach of the {self.leg.notation} sub-leg.",
            "",
            self.geometry,
        )
        s, mode = k.add_input(self.ports.s), self._choice(k, self.ports.mode_choice)
        swivel = k.add_input(self.ports.swivel) if self.leg.redundant else None
        k.output("excess", self.leg.reach(k, s, mode, swivel), Unit.METRE, doc="positive out of reach")
        return k.kernel(prune=("s", "mode", "swivel"))

    def _jacobian(self) -> Kernel:
        k = KernelWriter(
            "jacobian",
            f"Jacobian M_i of the {self.leg.notation} sub-leg, s_dot = M theta_dot.",
            "(1.16), (2.15)",
            self.geometry,
        )
        equations = self.leg.velocity(k, self.at(k))
        k.add_output(self.ports.M, equations.F * self._local_jacobian(k, equations))
        self.regularity(k, equations.parallel)
        return self.end(k)

    def _local_jacobian(self, k: KernelWriter, equations: VelocityEquations) -> sp.Matrix:
        """M_i in the leg's frame: the rows of A^-1 B that belong to the end point."""
        rows = self.columns(k, equations)[: self.leg.space.dimension, :]
        return k.let("m", rows, "A^-1 B in the leg's frame")

    @staticmethod
    def columns(k: KernelWriter, equations: VelocityEquations) -> sp.Matrix:
        """A^-1 B."""
        return solve_columns(equations.A, equations.B, lambda quotient: k.let("q", quotient))

    def _project(self) -> Kernel:
        k = KernelWriter(
            "project",
            f"Rows of K: N M_i for the {self.leg.notation} sub-leg, where the rows of N are the "
            "directions of the platform's lines.",
            "(1.8), (1.28)",
            self.geometry,
        )
        equations = self.leg.velocity(k, self.at(k))
        rows = k.add_input(self.ports.N)
        local = self._local_jacobian(k, equations)
        turned = k.let("n", rows * equations.F, "N in the leg's frame")
        k.add_output(self.ports.K, turned * local)
        self.regularity(k, equations.parallel)
        return self.end(k)

    def _velocity(self) -> Kernel:
        k = KernelWriter(
            "velocity",
            f"Velocity of the end point of the {self.leg.notation} sub-leg, M theta_dot.",
            "(1.9)",
            self.geometry,
        )
        equations = self.leg.velocity(k, self.at(k))
        right = k.let("w", equations.B * k.add_input(self.ports.theta_dot), "B theta_dot")
        local = solve_structured(equations.A, right)[: self.leg.space.dimension, :]
        k.add_output(self.ports.s_dot, equations.F * k.let("v_l", local, "velocity in the leg's frame"))
        self.regularity(k, equations.parallel)
        return self.end(k)

    def _bias(self) -> Kernel:
        k = KernelWriter(
            "bias",
            f"Velocity of the end point of the {self.leg.notation} sub-leg and the part of its "
            "acceleration that does not depend "
            "on theta_ddot: s_ddot = M theta_ddot + bias, bias = M_dot theta_dot.",
            "",
            self.geometry,
        )
        velocity = self._velocity_from_joints()
        s, theta, theta_dot = (
            k.add_input(port) for port in (self.ports.s, self.ports.theta, self.ports.theta_dot)
        )
        arguments = {"s": s, "theta": theta, "theta_dot": theta_dot}
        found = k.call(velocity, **arguments)
        value, rate = k.call_tangent(velocity, "s_dot", arguments, {"s": found.s_dot, "theta": theta_dot})
        k.add_output(self.ports.s_dot, value)
        k.add_output(self.ports.bias, rate)
        if self.leg.redundant:
            directions = {"s": found.s_dot, "theta": theta_dot}
            _, swivel_bias = k.call_tangent(velocity, "swivel_rates", arguments, directions)
            k.add_output(self.ports.swivel_bias, swivel_bias)
        if hasattr(found, "regularity"):
            k.output("regularity", found.regularity, doc=REGULARITY_DOC)
        return k.kernel()

    def _velocity_from_joints(self) -> Kernel:
        """s_dot (and the swivel's rate) as a function of s, theta and theta_dot, to be differentiated."""
        k = KernelWriter("velocity_from_joints", "M theta_dot.", geometry=self.geometry)
        found = self.leg.posture(k, k.add_input(self.ports.s), k.add_input(self.ports.theta))
        equations = self.leg.velocity(k, SimpleNamespace(**found))
        local = solve_structured(equations.A, equations.B * k.add_input(self.ports.theta_dot))
        d = self.leg.space.dimension
        k.add_output(self.ports.s_dot, equations.F * local[:d, :])
        if self.leg.redundant:
            k.add_output(self.ports.swivel_rates, local[d])
        self.regularity(k, equations.parallel)
        return k.kernel()

    def _rates(self) -> Kernel:
        k = KernelWriter(
            "rates",
            f"Actuated joint rates of the {self.leg.notation} sub-leg from the velocity of its end "
            "point: B^-1 A s_dot.  Linear, so "
            "it serves accelerations too.",
            "(1.9)",
            self.geometry,
        )
        at = self.at(k)
        equations = self.leg.velocity(k, at)
        local = k.let("v_l", equations.F.T * k.add_input(self.ports.s_dot), "velocity in the leg's frame")
        if self.leg.redundant:
            local = sp.Matrix([*local, k.add_input(self.ports.swivel_rates)])
        k.add_output(self.ports.theta_dot, self.leg.rates(k, at, equations, local))
        coordinate = equations.others if self.leg.redundant else ()
        self.regularity(k, (*equations.serial, *coordinate))
        return self.end(k)

    def _determinant(self) -> Kernel:
        names = ", ".join(name for name, _ in self.leg.factor_names())
        k = KernelWriter(
            "determinant",
            f"det M_i of the {self.leg.notation} sub-leg and its dimensionless factors: {names}.",
            "1.4",
            self.geometry,
        )
        equations = self.leg.velocity(k, self.at(k))
        if self.leg.redundant:
            minors = _minors(self._local_jacobian(k, equations))
            gram = sum((k.let(f"minor_{i}", minor) ** 2 for i, minor in enumerate(minors)), sp.Integer(0))
            k.output("det_M", sp.sqrt(gram), Unit.MIXED, doc="sqrt(det(M_i M_i^T))")
        else:
            k.output("det_M", equations.determinant, Unit.MIXED, doc="det M_i")
        factors = [factor.value for factor in (*equations.serial, *equations.parallel, *equations.others)]
        k.add_output(self.ports.factors(len(factors)), factors)
        return self.end(k)

    def _gram(self) -> Kernel:
        k = KernelWriter(
            "gram",
            f"Squares of M_i of the {self.leg.notation} sub-leg, in its own frame, for the indices: "
            "actuators that slide count by their displacement over `characteristic_length`.",
            "1.8, 4.2.2",
            self.geometry,
        )
        equations, ports = self.leg.velocity(k, self.at(k)), self.ports
        local = self._local_jacobian(k, equations)
        if self.leg.slides:
            length = k.add_input(ports.characteristic_length)
            factors = [length if joint.kind is JointKind.PRISMATIC else 1 for joint in self.leg.actuators]
            local = k.let("m_l", local * sp.diag(*factors), "slides over the length")
        gram = k.let("g", local * local.T, "M M^T")
        turned = k.let("n", k.add_input(ports.N) * equations.F, "N in the leg's frame")
        along = k.let("k", turned * local, "the leg's block of K")
        if self.leg.redundant:
            minors, square = cofactors(gram), sum(minor**2 for minor in _minors(local))
        else:
            inverse = k.let("c", cofactors(local), "cofactors of M")
            minors, square = inverse * inverse.T, k.let("det_M", determinant(local, inverse)) ** 2
        k.add_output(ports.gram, gram)
        k.add_output(ports.cofactors, minors)
        k.add_output(ports.square, square)
        reach = along * along.T
        k.add_output(ports.reach, [reach[i, j] for i in range(reach.rows) for j in range(i, reach.rows)])
        self.regularity(k, equations.parallel)
        return self.end(k)

    def _passive(self) -> Kernel:
        k = KernelWriter(
            "passive",
            f"Passive joints of the {self.leg.notation} sub-leg and the orientation of its last link.",
            "",
            self.geometry,
        )
        at = self.at(k)
        found = self.leg.passive(k, at)
        if found.angles:
            k.add_output(self.ports.passive, [value for _, value in found.angles])
        k.add_output(self.ports.link, found.link)
        self._loops(k, at)
        return self.end(k)

    def points(self) -> Kernel:
        """Where the joints are."""
        k = KernelWriter(
            "points", f"Joints of the {self.leg.notation} sub-leg, from the base to S_i.", "", self.geometry
        )
        at, s = self.at(k), k.add_input(self.ports.s)
        found = self.leg.points(k, at, s)
        names = tuple(found)
        k.add_output(self.ports.points(names), sp.Matrix.hstack(*found.values()).T)
        self._loops(k, at)
        return self.end(k)

    def _swivel(self) -> Kernel:
        k = KernelWriter("swivel", f"Swivel of the {self.leg.notation} sub-leg.", "", self.geometry)
        k.add_output(self.ports.swivel, self.leg.swivel_angle(k, self.at(k)))
        return self.end(k)

    def _swivel_difference(self) -> Kernel:
        doc = "What the joints' accelerations have to give of the swivel's second rate."
        k = KernelWriter("swivel_difference", doc)
        wanted, bias = k.add_input(self.ports.swivel_accelerations), k.add_input(self.ports.swivel_bias)
        k.output("swivel_along", wanted - bias, Unit.ACTUATOR_ACCELERATION, Frame.JOINT)
        return k.kernel()

    # -- Newton steps, where there is no closed form --------------------------------------------------------

    def forward_step(self) -> Kernel:
        """One Newton step of the forward kinematics: s + ds with f + (df/ds) ds = 0."""
        return self._newton_step("forward_step", self.ports.s, self.ports.theta)

    def inverse_step(self) -> Kernel:
        """One Newton step of the inverse kinematics: theta + dtheta with f + (df/dtheta) dtheta = 0."""
        return self._newton_step("inverse_step", self.ports.theta, self.ports.s)

    def _newton_step(self, name: str, unknown: Port, given: Port) -> Kernel:
        what = "forward" if unknown is self.ports.s else "inverse"
        k = KernelWriter(
            name,
            f"One Newton step of the {what} kinematics of the {self.leg.notation} sub-leg, from its "
            "loop closure.",
            "",
            self.geometry,
        )
        arguments = {given.name: k.add_input(given), unknown.name: k.add_input(unknown)}
        closure = self.closure()
        residual, columns = None, []
        for j in range(unknown.size):
            unit = sp.Matrix([1 if i == j else 0 for i in range(unknown.size)])
            residual, column = k.call_tangent(closure, "residual", arguments, {unknown.name: unit})
            columns.append(column)
        assert residual is not None
        if residual.rows != unknown.size:
            raise ValueError(
                f"{self.leg.name}: {residual.rows} closure equations do not determine {unknown.size} "
                "unknowns; "
                f"state `{what}` in closed form"
            )
        slope = k.let("df", sp.Matrix.hstack(*columns), f"df/d{unknown.name}")
        step = k.let("step", -solve_structured(slope, k.let("f", residual, "loop closure")))
        start = arguments[unknown.name]
        k.add_output(unknown.one_step_on(), start + step)
        # not below a picometre, or all unknowns being zero would never count as found
        size = k.let("size", k.maximum(dot(start, start), SMALLEST**2), "squared length of the unknowns")
        k.output("change", dot(step, step) / size, doc="squared length of the step over that of the unknowns")
        return k.kernel()

    def regularity(self, k: KernelWriter, factors: tuple[Factor, ...]) -> None:
        """The smallest absolute factor, which the caller compares with the tolerance for singular
        configurations.
        """
        if factors:
            absolute = [k.absolute(factor.value) for factor in factors]
            worst = absolute[0] if len(absolute) == 1 else k.minimum(*absolute)
            k.output("regularity", worst, doc=REGULARITY_DOC)

    def _loops(self, k: KernelWriter, at: SimpleNamespace) -> None:
        """Whether the loops of passive joints close and determine these joints."""
        loops = self.leg.loops(k, at)
        if loops is None:
            return
        doc = "not negative where the passive joints exist"
        k.output("radicand", k.minimum(*loops.radicands), Unit.MIXED, doc=doc)
        doc = "squared distances over lengths; zero where a passive joint is undetermined"
        k.output("regularity", k.minimum(*loops.lengths), doc=doc)


def _minors(m: sp.Matrix) -> list[Any]:
    """Determinants of m (d x n) with n - d columns left out; their squares add up to det(m m^T)."""
    chosen = (
        m.extract(list(range(m.rows)), list(columns)) for columns in combinations(range(m.cols), m.rows)
    )
    return [
        determinant3(square) if m.rows == 3 else cross2(square.col(0), square.col(1)) for square in chosen
    ]
