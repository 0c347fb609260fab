"""Kernels of a sub-leg, derived from what its file states: the same for every sub-leg."""

from __future__ import annotations

from types import SimpleNamespace
from typing import TYPE_CHECKING

import sympy as sp

from krhpr.codegen.kernel import Frame, Kernel, Layout, Port, Unit
from krhpr.codegen.writer import KernelWriter
from krhpr.derivations.terms import Factor, Space
from krhpr.derivations.vectors import solve_structured

if TYPE_CHECKING:
    from krhpr.derivations.sublegs.base import SubLeg


REGULARITY_DOC = "smallest absolute factor of the determinant"


class SubLegKernels:
    """Writes the kernels of one sub-leg."""

    def __init__(self, leg: SubLeg) -> None:
        self.leg, self.geometry, self.ports = leg, leg.geometry(), SubLegPorts(leg)

    def all(self) -> tuple[Kernel, ...]:
        """Every kernel, in the order in which it is printed."""
        inverse = self._inverse()
        return (
            self._forward(),
            self._forward(posture=True),
            inverse,
            self._inverse_all(inverse),
            self._reach(),
            self._posture(),
            self._jacobian(),
            self._project(),
            self._velocity(),
            self._bias(),
            self._rates(),
            self._determinant(),
            self._passive(),
        )

    def closure(self) -> Kernel:
        """The loop closure as a kernel; it is used by proofs and never printed."""
        k = KernelWriter("closure", "Loop closure of the sub-leg.", geometry=self.geometry)
        residual = self.leg.closure(k, k.add_input(self.ports.s), k.add_input(self.ports.theta))
        k.output("residual", residual)
        return k.kernel()

    def factors(self) -> tuple[tuple[Factor, ...], tuple[Factor, ...]]:
        """The serial and the parallel factors of det M_i."""
        k = KernelWriter("factors", "", geometry=self.geometry)
        equations = self.leg.velocity(k, self._at(k))
        return equations.serial, equations.parallel

    def _forward(self, *, posture: bool = False) -> Kernel:
        name, more = ("forward_posture", " and posture") if posture else ("forward", "")
        doc = f"End point{more} of the {self.leg.notation} sub-leg from its actuated joints."
        k = KernelWriter(name, doc, "3.5", self.geometry)
        theta = k.add_input(self.ports.theta)
        assembly = k.add_input(self.ports.assembly) if self.leg.forward_signs else sp.Matrix(0, 1, [])
        found = self.leg.forward(k, theta, assembly)
        k.add_output(self.ports.s, found.s)
        if posture:
            for port in self.leg.posture_ports():
                k.add_output(port, found.posture[port.name])
        if found.radicand is not None:
            k.output("radicand", found.radicand, doc="not negative where the loop closes")
        return k.kernel()

    def _posture(self) -> Kernel:
        doc = f"Posture of the {self.leg.notation} sub-leg: what its velocity equations are made of."
        k = KernelWriter("posture", doc, "App. A, 2.3.1", self.geometry)
        found = self.leg.posture(k, k.add_input(self.ports.s), k.add_input(self.ports.theta))
        for port in self.leg.posture_ports():
            k.add_output(port, found[port.name])
        return k.kernel()

    def _at(self, k: KernelWriter) -> SimpleNamespace:
        """The posture as inputs of a kernel."""
        return SimpleNamespace(**{port.name: k.add_input(port) for port in self.leg.posture_ports()})

    def _end(self, k: KernelWriter) -> Kernel:
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
        theta, radicands = self.leg.inverse(k, k.add_input(self.ports.s), k.add_input(self.ports.mode))
        k.add_output(self.ports.theta, theta)
        worst = radicands[0] if len(radicands) == 1 else k.minimum(*radicands)
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
        s = k.add_input(self.ports.s)
        found = [k.call(inverse, s=s, mode=sp.Matrix(mode.signs)) for mode in self.leg.modes]
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
        k.output(
            "excess",
            self.leg.reach(k, k.add_input(self.ports.s), k.add_input(self.ports.mode)),
            Unit.METRE,
            doc="positive out of reach",
        )
        return k.kernel()

    def _jacobian(self) -> Kernel:
        k = KernelWriter(
            "jacobian",
            f"Jacobian M_i of the {self.leg.notation} sub-leg, s_dot = M theta_dot.",
            "(1.16), (2.15)",
            self.geometry,
        )
        equations = self.leg.velocity(k, self._at(k))
        local = k.let("m", _solve_columns(equations.A, equations.B), "A^-1 B in the leg's frame")
        k.add_output(self.ports.M, equations.F * local)
        self._regularity(k, equations.parallel)
        return self._end(k)

    def _project(self) -> Kernel:
        k = KernelWriter(
            "project",
            f"Rows of K: N M_i for the {self.leg.notation} sub-leg, where the rows of N are the "
            "directions of the platform's lines.",
            "(1.8), (1.28)",
            self.geometry,
        )
        equations = self.leg.velocity(k, self._at(k))
        rows = k.add_input(self.ports.N)
        local = k.let("m", _solve_columns(equations.A, equations.B), "A^-1 B in the leg's frame")
        turned = k.let("n", rows * equations.F, "N in the leg's frame")
        k.add_output(self.ports.K, turned * local)
        self._regularity(k, equations.parallel)
        return self._end(k)

    def _velocity(self) -> Kernel:
        k = KernelWriter(
            "velocity",
            f"Velocity of the end point of the {self.leg.notation} sub-leg, M theta_dot.",
            "(1.9)",
            self.geometry,
        )
        equations = self.leg.velocity(k, self._at(k))
        right = k.let("w", equations.B * k.add_input(self.ports.theta_dot), "B theta_dot")
        local = k.let("v_l", solve_structured(equations.A, right), "velocity in the leg's frame")
        k.add_output(self.ports.s_dot, equations.F * local)
        self._regularity(k, equations.parallel)
        return self._end(k)

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
        if hasattr(found, "regularity"):
            k.output("regularity", found.regularity, doc=REGULARITY_DOC)
        return k.kernel()

    def _velocity_from_joints(self) -> Kernel:
        """s_dot as a function of s, theta and theta_dot, to be differentiated."""
        k = KernelWriter("velocity_from_joints", "M theta_dot.", geometry=self.geometry)
        found = self.leg.posture(k, k.add_input(self.ports.s), k.add_input(self.ports.theta))
        equations = self.leg.velocity(k, SimpleNamespace(**found))
        local = solve_structured(equations.A, equations.B * k.add_input(self.ports.theta_dot))
        k.add_output(self.ports.s_dot, equations.F * local)
        self._regularity(k, equations.parallel)
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
        equations = self.leg.velocity(k, self._at(k))
        local = k.let("v_l", equations.F.T * k.add_input(self.ports.s_dot), "velocity in the leg's frame")
        right = k.let("w", equations.A * local, "A s_dot")
        k.add_output(self.ports.theta_dot, solve_structured(equations.B, right))
        self._regularity(k, equations.serial)
        return self._end(k)

    def _determinant(self) -> Kernel:
        names = ", ".join(name for name, _ in self.leg.factor_names())
        k = KernelWriter(
            "determinant",
            f"det M_i of the {self.leg.notation} sub-leg and its dimensionless factors: {names}.",
            "1.4",
            self.geometry,
        )
        equations = self.leg.velocity(k, self._at(k))
        k.output("det_M", equations.determinant, Unit.MIXED, doc="det M_i")
        factors = [factor.value for factor in (*equations.serial, *equations.parallel)]
        k.add_output(self.ports.factors(len(factors)), factors)
        return self._end(k)

    def _passive(self) -> Kernel:
        k = KernelWriter(
            "passive",
            f"Passive joints of the {self.leg.notation} sub-leg and the orientation of its last link.",
            "",
            self.geometry,
        )
        found = self.leg.passive(k, self._at(k))
        if found.angles:
            k.add_output(self.ports.passive, [value for _, value in found.angles])
        k.add_output(self.ports.link, found.link)
        return self._end(k)

    def _regularity(self, k: KernelWriter, factors: tuple[Factor, ...]) -> None:
        """The smallest absolute factor, which the caller compares with the tolerance for singular
        configurations.
        """
        if factors:
            absolute = [k.absolute(factor.value) for factor in factors]
            worst = absolute[0] if len(absolute) == 1 else k.minimum(*absolute)
            k.output("regularity", worst, doc=REGULARITY_DOC)


def _solve_columns(a: sp.Matrix, b: sp.Matrix) -> sp.Matrix:
    if a == sp.eye(a.rows):
        return b
    columns = [solve_structured(a, b.col(j)) for j in range(b.cols)]
    return sp.Matrix.hstack(*columns)


class SubLegPorts:
    """The ports that every sub-leg's kernels share, with its sizes."""

    def __init__(self, subleg: SubLeg) -> None:
        d, n = subleg.space.dimension, subleg.n
        rows = subleg.space.rows_per_leg
        names = tuple(joint.name for joint in subleg.actuators)
        signs = tuple(sign.name for sign in subleg.inverse_signs)
        assembly = tuple(sign.name for sign in subleg.forward_signs)
        stacked = Layout.STACKED
        self.s = Port("s", (d,), Unit.METRE, Frame.BASE, "end point of the sub-leg, S_i", stacked)
        self.theta = Port("theta", (n,), Unit.ACTUATOR, Frame.JOINT, "actuated joints", stacked, names)
        self.theta_all = Port(
            "theta",
            (len(subleg.modes), n),
            Unit.ACTUATOR,
            Frame.JOINT,
            "actuated joints in every working mode",
            stacked,
            tuple(mode.label for mode in subleg.modes),
        )
        self.mode = Port(
            "mode",
            (len(signs),),
            Unit.NONE,
            Frame.NONE,
            "signs of the working mode, +1 or -1",
            stacked,
            signs,
        )
        self.assembly = Port(
            "assembly",
            (len(assembly),),
            Unit.NONE,
            Frame.NONE,
            "signs of the assembly mode, +1 or -1",
            stacked,
            assembly,
        )
        self.theta_dot = Port(
            "theta_dot", (n,), Unit.ACTUATOR_RATE, Frame.JOINT, "rates of the actuated joints", stacked, names
        )
        self.s_dot = Port(
            "s_dot", (d,), Unit.METRE_PER_SECOND, Frame.BASE, "velocity of the end point", stacked
        )
        self.bias = Port(
            "bias",
            (d,),
            Unit.METRE_PER_SECOND_SQUARED,
            Frame.BASE,
            "acceleration of the end point at theta_ddot = 0",
            stacked,
        )
        self.M = Port("M", (d, n), Unit.MIXED, Frame.BASE, "Jacobian of the sub-leg", stacked)
        self.N = Port("N", (rows, d), Unit.MIXED, Frame.BASE, "directions of the leg's lines, rows", stacked)
        self.K = Port("K", (rows, n), Unit.MIXED, Frame.BASE, "the leg's block of K", stacked)
        link = (3, 3) if subleg.space is Space.SPATIAL else (2,)
        self.link = Port(
            "link", link, Unit.NONE, Frame.BASE, "orientation of the link that carries the end point", stacked
        )
        passive = tuple(joint.name for joint in subleg.passive_joints)
        self.passive = Port(
            "passive",
            (len(passive),),
            Unit.RADIAN,
            Frame.JOINT,
            "passive joints within the sub-leg",
            stacked,
            passive,
        )

    def factors(self, count: int) -> Port:
        """The port of the factors of det M_i."""
        return Port(
            "factors", (count,), Unit.NONE, Frame.NONE, "dimensionless factors of det M_i", Layout.STACKED
        )
