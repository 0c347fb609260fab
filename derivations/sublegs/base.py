"""What a sub-leg is: the interface that one file per sub-leg implements.

A sub-leg carries the end point S_i (r_i in the plane).  Its file states six things, and everything else (the
Jacobian M_i, projections N M_i, rates, accelerations, all working modes at once) is derived from them here,
on the graph:

* `geometry`: the lengths that a person sets and the vectors prepared from them;
* `forward`: actuated joints and assembly mode -> end point;
* `inverse`: end point and the signs of a working mode -> actuated joints;
* `posture`: the vectors of the leg that velocities depend on (x, e_2, u_1, ...), from a consistent pair (s,
theta), so
  that sines and cosines are computed once however many kernels follow;
* `velocity`: the velocity equations A (F^T s_dot) = B theta_dot in an orthonormal frame F of the leg, as
(1.9), with
  the dimensionless factors whose zeros are the leg's singularities;
* `passive`: passive joint angles and the direction of the link that carries the end point.

All formulas are those of one leg: `s` is relative to the base frame, `theta` are this leg's actuated joints.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from enum import StrEnum
from itertools import product
from types import SimpleNamespace
from typing import Any

import sympy as sp

from krhpr.codegen.kernel import Frame, GeometryType, Kernel, Layout, Port, Unit
from krhpr.codegen.writer import KernelWriter
from krhpr.derivations.vectors import solve_structured


class Space(StrEnum):
    """Where a robot moves."""

    SPATIAL = "spatial"
    PLANAR = "planar"

    @property
    def dimension(self) -> int:
        """Dimension of the space in which the platform moves."""
        return 3 if self is Space.SPATIAL else 2

    @property
    def degrees_of_freedom(self) -> int:
        """The platform's degrees of freedom."""
        return 6 if self is Space.SPATIAL else 3

    @property
    def rows_per_leg(self) -> int:
        """Constraint equations that one leg gives the platform."""
        return 2 if self is Space.SPATIAL else 1


class JointKind(StrEnum):
    """How a joint's coordinate behaves: angles differ by full turns, slides do not."""

    REVOLUTE = "revolute"
    PRISMATIC = "prismatic"


@dataclass(frozen=True)
class Joint:
    """An actuated or passive joint of a leg."""

    name: str
    kind: JointKind
    doc: str


@dataclass(frozen=True)
class Sign:
    """A choice of sign in a closed form (a branch), with the words for +1 and -1."""

    name: str
    plus: str
    minus: str
    doc: str


@dataclass(frozen=True)
class Mode:
    """A branch: a readable label and the sign of every choice."""

    label: str
    signs: tuple[int, ...]


def branches(signs: tuple[Sign, ...]) -> tuple[Mode, ...]:
    """Every combination of signs, the first choice varying slowest and +1 before -1."""
    modes = []
    for values in product((1, -1), repeat=len(signs)):
        words = [sign.plus if value > 0 else sign.minus for sign, value in zip(signs, values, strict=True)]
        modes.append(Mode("/".join(words), values))
    return tuple(modes)


@dataclass(frozen=True)
class Factor:
    """A dimensionless factor of a leg's determinant: the leg is singular where it vanishes."""

    name: str
    value: Any
    doc: str


@dataclass(frozen=True)
class VelocityEquations:
    """A (F^T s_dot) = B theta_dot, (1.9), in the leg's frame F (orthonormal, columns in the base frame).

    `serial` are the factors of det B (type I singularities), `parallel` those of det A (type II of the sub-
    leg); `determinant` is det M_i in closed form.
    """

    F: sp.Matrix
    A: sp.Matrix
    B: sp.Matrix
    determinant: Any
    serial: tuple[Factor, ...]
    parallel: tuple[Factor, ...] = ()


@dataclass(frozen=True)
class Passive:
    """Passive joints of a sub-leg: angles, and the frame of the link that carries the end point.

    `link` is a rotation matrix (columns: along the link towards S_i, completing, normal of the linkage plane)
    in space, and the unit vector along the link in the plane.
    """

    angles: tuple[tuple[Joint, Any], ...]
    link: sp.Matrix


Posture = dict[str, Any]
"""Values of a posture by port name."""


@dataclass(frozen=True)
class Forward:
    """What the forward kinematics of a sub-leg finds; `radicand` must not be negative (None for open
    chains).
    """

    s: sp.Matrix
    posture: Posture
    radicand: Any = None


class SubLeg(ABC):
    """One type of sub-leg.  Subclasses state the formulas; kernels are derived from them."""

    name: str
    space: Space
    notation: str
    section: str
    doc: str
    actuators: tuple[Joint, ...]
    passive_joints: tuple[Joint, ...] = ()
    inverse_signs: tuple[Sign, ...]
    forward_signs: tuple[Sign, ...] = ()
    default_mode: str
    default_assembly: str = ""
    equations: str = ""

    # -- what a sub-leg's file states
    # ---------------------------------------------------------------------------

    @abstractmethod
    def geometry(self) -> GeometryType:
        """Fields and prepared vectors of one leg."""

    @abstractmethod
    def forward(self, k: KernelWriter, theta: sp.Matrix, assembly: sp.Matrix) -> Forward:
        """End point and posture from the actuated joints; `assembly` has a sign for each of
        `forward_signs`.
        """

    @abstractmethod
    def inverse(self, k: KernelWriter, s: sp.Matrix, mode: sp.Matrix) -> tuple[list[Any], list[Any]]:
        """The actuated joints in the branch `mode`, and the radicands that must not be negative."""

    @abstractmethod
    def reach(self, k: KernelWriter, s: sp.Matrix, mode: sp.Matrix) -> Any:
        """By how much s_i lies outside the leg's reach in the branch `mode` (a length; zero or negative
        within).
        """

    @abstractmethod
    def posture_ports(self) -> tuple[Port, ...]:
        """Names, shapes and meanings of the posture's vectors."""

    @abstractmethod
    def posture(self, k: KernelWriter, s: sp.Matrix, theta: sp.Matrix) -> Posture:
        """The posture at a consistent pair (s, theta): a value for each of `posture_ports`."""

    @abstractmethod
    def velocity(self, k: KernelWriter, at: SimpleNamespace) -> VelocityEquations:
        """The velocity equations at a posture (`at.x`, `at.e_2`, ...)."""

    @abstractmethod
    def passive(self, k: KernelWriter, at: SimpleNamespace) -> Passive:
        """Passive joint coordinates at a posture."""

    @abstractmethod
    def closure(self, k: KernelWriter, s: sp.Matrix, theta: sp.Matrix) -> sp.Matrix:
        """Loop closure equations f(s, theta) = 0 that define the leg, from which `velocity` is proven."""

    # -- what follows
    # -------------------------------------------------------------------------------------------

    @property
    def n(self) -> int:
        """Number of actuated joints of one leg."""
        return len(self.actuators)

    @property
    def modes(self) -> tuple[Mode, ...]:
        """Working modes, in the order of `inverse_all`."""
        return branches(self.inverse_signs)

    @property
    def assemblies(self) -> tuple[Mode, ...]:
        """Assembly modes (one without a label for open chains)."""
        return branches(self.forward_signs)

    def ports(self) -> SubLegPorts:
        """The ports of its kernels."""
        return SubLegPorts(self)

    def kernels(self) -> tuple[Kernel, ...]:
        """Every kernel of the sub-leg, in the order in which it is printed."""
        geometry, ports = self.geometry(), self.ports()
        inverse = self._inverse(geometry, ports)
        return (
            self._forward(geometry, ports),
            self._forward(geometry, ports, posture=True),
            inverse,
            self._inverse_all(geometry, ports, inverse),
            self._reach(geometry, ports),
            self._posture(geometry, ports),
            self._jacobian(geometry, ports),
            self._project(geometry, ports),
            self._velocity(geometry, ports),
            self._bias(geometry, ports),
            self._rates(geometry, ports),
            self._determinant(geometry, ports),
            self._passive(geometry, ports),
        )

    def closure_kernel(self) -> Kernel:
        """The loop closure as a kernel; it is used by proofs and never printed."""
        ports = self.ports()
        k = KernelWriter("closure", "Loop closure of the sub-leg.", geometry=self.geometry())
        residual = self.closure(k, k.add_input(ports.s), k.add_input(ports.theta))
        k.output("residual", residual)
        return k.kernel()

    def _forward(self, geometry: GeometryType, ports: SubLegPorts, *, posture: bool = False) -> Kernel:
        name, more = ("forward_posture", " and posture") if posture else ("forward", "")
        doc = f"End point{more} of the {self.notation} sub-leg from its actuated joints."
        k = KernelWriter(name, doc, "3.5", geometry)
        theta = k.add_input(ports.theta)
        assembly = k.add_input(ports.assembly) if self.forward_signs else sp.Matrix(0, 1, [])
        found = self.forward(k, theta, assembly)
        k.add_output(ports.s, found.s)
        if posture:
            for port in self.posture_ports():
                k.add_output(port, found.posture[port.name])
        if found.radicand is not None:
            k.output("radicand", found.radicand, doc="not negative where the loop closes")
        return k.kernel()

    def _posture(self, geometry: GeometryType, ports: SubLegPorts) -> Kernel:
        doc = f"Posture of the {self.notation} sub-leg: the vectors that its velocity equations are made of."
        k = KernelWriter("posture", doc, self.equations, geometry)
        found = self.posture(k, k.add_input(ports.s), k.add_input(ports.theta))
        for port in self.posture_ports():
            k.add_output(port, found[port.name])
        return k.kernel()

    def _at(self, k: KernelWriter) -> SimpleNamespace:
        """The posture as inputs of a kernel."""
        return SimpleNamespace(**{port.name: k.add_input(port) for port in self.posture_ports()})

    def _end(self, k: KernelWriter) -> Kernel:
        return k.kernel(prune=[port.name for port in self.posture_ports()])

    def _inverse(self, geometry: GeometryType, ports: SubLegPorts) -> Kernel:
        k = KernelWriter(
            "inverse",
            f"Actuated joints of the {self.notation} sub-leg in one working mode.  The mode is "
            "given by signs; NaN where "
            "the end point is out of reach.",
            self.equations,
            geometry,
        )
        theta, radicands = self.inverse(k, k.add_input(ports.s), k.add_input(ports.mode))
        k.add_output(ports.theta, theta)
        worst = radicands[0] if len(radicands) == 1 else k.minimum(*radicands)
        k.output("radicand", worst, Unit.MIXED, doc="not negative where the mode exists")
        return k.kernel()

    def _inverse_all(self, geometry: GeometryType, ports: SubLegPorts, inverse: Kernel) -> Kernel:
        k = KernelWriter(
            "inverse_all",
            f"Every working mode of the {self.notation} sub-leg, in the order "
            + ", ".join(mode.label for mode in self.modes)
            + "; NaN where a mode does not exist.",
            self.equations,
            geometry,
        )
        s = k.add_input(ports.s)
        found = [k.call(inverse, s=s, mode=sp.Matrix(mode.signs)) for mode in self.modes]
        k.add_output(ports.theta_all, [mode.theta for mode in found])
        best = k.maximum(*dict.fromkeys(mode.radicand for mode in found))
        k.output("radicand", best, Unit.MIXED, doc="not negative where at least one mode exists")
        return k.kernel()

    def _reach(self, geometry: GeometryType, ports: SubLegPorts) -> Kernel:
        k = KernelWriter(
            "reach",
            f"Distance by which the end point lies outside the reach of the {self.notation} sub-leg.",
            "",
            geometry,
        )
        k.output(
            "excess",
            self.reach(k, k.add_input(ports.s), k.add_input(ports.mode)),
            Unit.METRE,
            doc="positive out of reach",
        )
        return k.kernel()

    def _jacobian(self, geometry: GeometryType, ports: SubLegPorts) -> Kernel:
        k = KernelWriter(
            "jacobian",
            f"Jacobian M_i of the {self.notation} sub-leg, s_dot = M theta_dot.",
            "(1.16), (2.15)",
            geometry,
        )
        equations = self.velocity(k, self._at(k))
        local = k.let("m", _solve_columns(equations.A, equations.B), "A^-1 B in the leg's frame")
        k.add_output(ports.M, equations.F * local)
        self._regularity(k, equations.parallel)
        return self._end(k)

    def _project(self, geometry: GeometryType, ports: SubLegPorts) -> Kernel:
        k = KernelWriter(
            "project",
            f"Rows of K: N M_i for the {self.notation} sub-leg, where the rows of N are the "
            "directions of the platform's lines.",
            "(1.8), (1.28)",
            geometry,
        )
        equations = self.velocity(k, self._at(k))
        rows = k.add_input(ports.N)
        local = k.let("m", _solve_columns(equations.A, equations.B), "A^-1 B in the leg's frame")
        turned = k.let("n", rows * equations.F, "N in the leg's frame")
        k.add_output(ports.K, turned * local)
        self._regularity(k, equations.parallel)
        return self._end(k)

    def _velocity(self, geometry: GeometryType, ports: SubLegPorts) -> Kernel:
        k = KernelWriter(
            "velocity",
            f"Velocity of the end point of the {self.notation} sub-leg, M theta_dot.",
            "(1.9)",
            geometry,
        )
        equations = self.velocity(k, self._at(k))
        right = k.let("w", equations.B * k.add_input(ports.theta_dot), "B theta_dot")
        local = k.let("v_l", solve_structured(equations.A, right), "velocity in the leg's frame")
        k.add_output(ports.s_dot, equations.F * local)
        self._regularity(k, equations.parallel)
        return self._end(k)

    def _bias(self, geometry: GeometryType, ports: SubLegPorts) -> Kernel:
        k = KernelWriter(
            "bias",
            f"Velocity of the end point of the {self.notation} sub-leg and the part of its "
            "acceleration that does not depend "
            "on theta_ddot: s_ddot = M theta_ddot + bias, bias = M_dot theta_dot.",
            "",
            geometry,
        )
        velocity = self._velocity_from_joints(geometry, ports)
        s, theta, theta_dot = (k.add_input(port) for port in (ports.s, ports.theta, ports.theta_dot))
        arguments = {"s": s, "theta": theta, "theta_dot": theta_dot}
        s_dot = k.call(velocity, **arguments).s_dot
        value, rate = k.call_tangent(velocity, "s_dot", arguments, {"s": s_dot, "theta": theta_dot})
        k.add_output(ports.s_dot, value)
        k.add_output(ports.bias, rate)
        return k.kernel()

    def _velocity_from_joints(self, geometry: GeometryType, ports: SubLegPorts) -> Kernel:
        """s_dot as a function of s, theta and theta_dot, to be differentiated."""
        k = KernelWriter("velocity_from_joints", "M theta_dot.", geometry=geometry)
        found = self.posture(k, k.add_input(ports.s), k.add_input(ports.theta))
        equations = self.velocity(k, SimpleNamespace(**found))
        local = solve_structured(equations.A, equations.B * k.add_input(ports.theta_dot))
        k.add_output(ports.s_dot, equations.F * local)
        return k.kernel()

    def _rates(self, geometry: GeometryType, ports: SubLegPorts) -> Kernel:
        k = KernelWriter(
            "rates",
            f"Actuated joint rates of the {self.notation} sub-leg from the velocity of its end "
            "point: B^-1 A s_dot.  Linear, so "
            "it serves accelerations too.",
            "(1.9)",
            geometry,
        )
        equations = self.velocity(k, self._at(k))
        local = k.let("v_l", equations.F.T * k.add_input(ports.s_dot), "velocity in the leg's frame")
        right = k.let("w", equations.A * local, "A s_dot")
        k.add_output(ports.theta_dot, solve_structured(equations.B, right))
        self._regularity(k, equations.serial)
        return self._end(k)

    def _determinant(self, geometry: GeometryType, ports: SubLegPorts) -> Kernel:
        names = ", ".join(name for name, _ in self.factor_names())
        k = KernelWriter(
            "determinant",
            f"det M_i of the {self.notation} sub-leg and its dimensionless factors: {names}.",
            "1.4",
            geometry,
        )
        equations = self.velocity(k, self._at(k))
        k.output("det_M", equations.determinant, Unit.MIXED, doc="det M_i")
        factors = [factor.value for factor in (*equations.serial, *equations.parallel)]
        k.add_output(ports.factors(len(factors)), factors)
        return self._end(k)

    def _passive(self, geometry: GeometryType, ports: SubLegPorts) -> Kernel:
        k = KernelWriter(
            "passive",
            f"Passive joints of the {self.notation} sub-leg and the orientation of its last link.",
            "",
            geometry,
        )
        found = self.passive(k, self._at(k))
        if found.angles:
            k.add_output(ports.passive, [value for _, value in found.angles])
        k.add_output(ports.link, found.link)
        return self._end(k)

    def has_parallel_factors(self) -> bool:
        """Whether the sub-leg has a closed loop, and with it configurations in which M_i does not exist."""
        return any(
            port.name == "regularity" for port in self._jacobian(self.geometry(), self.ports()).outputs
        )

    def factor_names(self) -> list[tuple[str, str]]:
        """Names and meanings of the leg's singular factors, serial ones first."""
        k = KernelWriter("names", "", geometry=self.geometry())
        equations = self.velocity(k, self._at(k))
        return [(factor.name, factor.doc) for factor in (*equations.serial, *equations.parallel)]

    def _regularity(self, k: KernelWriter, factors: tuple[Factor, ...]) -> None:
        """The smallest absolute factor, which the caller compares with the tolerance for singular
        configurations.
        """
        if factors:
            absolute = [k.absolute(factor.value) for factor in factors]
            worst = absolute[0] if len(absolute) == 1 else k.minimum(*absolute)
            k.output("regularity", worst, doc="smallest absolute factor of the determinant")


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
