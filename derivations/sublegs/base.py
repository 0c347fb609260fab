"""What a sub-leg is: the interface that one file per sub-leg implements.

A sub-leg carries the end point S_i (r_i in the plane).  Its file states seven things, and everything else
(the Jacobian M_i, projections N M_i, rates, accelerations, all working modes at once) is derived from them in
`kernels.py`, on the graph:

* `geometry`: the lengths that a person sets and the vectors prepared from them;
* `forward`: actuated joints and assembly mode -> end point;
* `inverse`: end point and the signs of a working mode -> actuated joints;
* `posture`: the vectors of the leg that velocities depend on (x, e_2, u_1, ...), from a consistent pair
  (s, theta), so that sines and cosines are computed once however many kernels follow;
* `velocity`: the velocity equations A (F^T s_dot) = B theta_dot in an orthonormal frame F, as (1.9),
  with the dimensionless factors whose zeros are the leg's singularities;
* `passive`: passive joint angles and the direction of the link that carries the end point;
* `points`: where the leg's joints are, and which links join them, for pictures and for distances between
links.

A redundant sub-leg (one more actuator than its end point has coordinates) names its `swivel`, the coordinate
that chooses among the joints for one end point; its velocity equations have a row more.  Where `forward` or
`inverse` is left out, there is no closed form, and a bounded Newton iteration from a point nearby is
generated from `closure` in its place.

All formulas are those of one leg: `s` is relative to the base frame, `theta` are this leg's actuated joints.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from functools import cached_property
from types import SimpleNamespace
from typing import Any

import sympy as sp

from krhpr.codegen.kernel import GeometryType, Kernel, Port
from krhpr.codegen.writer import KernelWriter
from krhpr.derivations.requirements import Requirement
from krhpr.derivations.sublegs.circles import Meeting
from krhpr.derivations.sublegs.forward import ForwardRoots
from krhpr.derivations.sublegs.kernels import SubLegKernels
from krhpr.derivations.sublegs.ports import SubLegPorts
from krhpr.derivations.sublegs.statics import StaticsKernels
from krhpr.derivations.terms import ONLY, Factor, Joint, JointKind, Link, Mode, Sign, Space, branches
from krhpr.derivations.vectors import solve_structured


@dataclass(frozen=True)
class VelocityEquations:
    """A (F^T s_dot) = B theta_dot, (1.9), in the leg's frame F (orthonormal, columns in the base frame).

    `serial` are the factors of det B (type I singularities), `parallel` those of det A (type II of the sub-
    leg); `determinant` is det M_i in closed form.

    `others` are factors that det M_i does not show: constraint singularities of a sub-leg with a platform of
    its own, or where the swivel of a redundant one has no meaning (its rates are then guarded by them).

    A redundant sub-leg has the rate of its swivel below F^T s_dot: A and B are n x n.  The last row and
    column of A are zero elsewhere, so that M_i does not depend on how the swivel is measured.  Its
    `determinant` is None: sqrt(det(M_i M_i^T)) follows from the minors of M_i.
    """

    F: sp.Matrix
    A: sp.Matrix
    B: sp.Matrix
    determinant: Any
    serial: tuple[Factor, ...]
    parallel: tuple[Factor, ...] = ()
    others: tuple[Factor, ...] = ()


@dataclass(frozen=True)
class Passive:
    """Passive joints of a sub-leg: angles, and the frame of the link that carries the end point.

    `link` is a rotation matrix (columns: along the link towards S_i, completing, normal of the linkage plane)
    in space, and the unit vector along the link in the plane.
    """

    angles: tuple[tuple[Joint, Any], ...]
    link: sp.Matrix


@dataclass(frozen=True)
class PassiveLoops:
    """Where loops of passive joints close and determine these joints."""

    radicands: tuple[Any, ...]
    """None is negative where the loops close."""
    lengths: tuple[Any, ...]
    """Dimensionless; a loop leaves its joints undetermined where its length is zero."""


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
    inverse_signs: tuple[Sign, ...] = ()
    forward_signs: tuple[Sign, ...] = ()
    forward_near: bool = False
    """Whether the assembly mode is chosen by a point near the end point instead of signs."""
    assemblies_near: int = 2
    """The most assembly modes where they are chosen so, or by Newton steps (errata, 4)."""
    swivel: Joint | None = None
    """The coordinate of a redundant sub-leg that is free when its end point is given."""
    links: tuple[Link, ...] = ()
    actuated_at: tuple[str, ...] = ()
    """Where each actuator is, for pictures: a point, or the link whose length (or turn) it is, by name."""
    requirements: tuple[Requirement, ...] = ()
    """What it requires of the sizes of all three legs together."""
    default_mode: str = ONLY
    default_assembly: str = ONLY
    equations: str = ""

    # -- what a sub-leg's file states -----------------------------------------------------------------------

    @abstractmethod
    def geometry(self) -> GeometryType:
        """Fields and prepared vectors of one leg."""

    def forward(self, k: KernelWriter, theta: sp.Matrix, assembly: sp.Matrix) -> Forward:
        """End point and posture from the actuated joints.

        `assembly` has a sign for each of `forward_signs`; with `forward_near` it is a point near the end
        point.
        """
        raise NotImplementedError(f"{self.name} has no forward kinematics in closed form")

    def forward_all(self, k: KernelWriter, theta: sp.Matrix) -> list[Meeting]:
        """Every end point where a point nearby chooses among them."""
        raise NotImplementedError(f"{self.name} has no forward kinematics in closed form")

    def forward_roots(self) -> ForwardRoots | None:
        """How a polynomial's real roots are its assembly modes, where they are."""
        return None

    def inverse(
        self, k: KernelWriter, s: sp.Matrix, mode: sp.Matrix, swivel: Any
    ) -> tuple[list[Any], list[Any]]:
        """The actuated joints in the branch `mode` (at `swivel`, for a redundant sub-leg), and the radicands
        that must not be negative.
        """
        raise NotImplementedError(f"{self.name} has no inverse kinematics in closed form")

    def reach(self, k: KernelWriter, s: sp.Matrix, mode: sp.Matrix, swivel: Any) -> Any:
        """By how much s_i lies outside the leg's reach in the branch `mode` (at `swivel`): a length, zero or
        negative within.  Left out where every point is within reach.
        """
        return sp.Integer(0)

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
    def points(self, k: KernelWriter, at: SimpleNamespace, s: sp.Matrix) -> dict[str, sp.Matrix]:
        """Where the leg's joints are, in the base frame, from the base on, S_i last; `links` join them."""

    def loops(self, k: KernelWriter, at: SimpleNamespace) -> PassiveLoops | None:
        """Loops of passive joints that the actuated joints do not drive, where there are any: passive joints
        and points exist where these close.
        """
        return None

    def swivel_angle(self, k: KernelWriter, at: SimpleNamespace) -> Any:
        """The swivel of a redundant sub-leg at a posture."""
        raise NotImplementedError(f"{self.name} is not redundant")

    def rates(
        self, k: KernelWriter, at: SimpleNamespace, equations: VelocityEquations, task: sp.Matrix
    ) -> sp.Matrix:
        """theta_dot from `task`: F^T s_dot, and the swivel's rate below it for a redundant sub-leg."""
        return solve_structured(equations.B, k.let("w", equations.A * task, "A s_dot"))

    @abstractmethod
    def closure(self, k: KernelWriter, s: sp.Matrix, theta: sp.Matrix) -> sp.Matrix:
        """Loop closure equations f(s, theta) = 0 that define the leg, from which `velocity` is proven."""

    # -- what follows ---------------------------------------------------------------------------------------

    @property
    def slides(self) -> bool:
        """Whether some of its actuators are slides."""
        return any(joint.kind is JointKind.PRISMATIC for joint in self.actuators)

    @property
    def n(self) -> int:
        """Number of actuated joints of one leg."""
        return len(self.actuators)

    @property
    def redundant(self) -> bool:
        """Whether it has a swivel."""
        return self.swivel is not None

    @property
    def has_forward(self) -> bool:
        """Whether its forward kinematics is stated in closed form."""
        return type(self).forward is not SubLeg.forward

    @property
    def has_inverse(self) -> bool:
        """Whether its inverse kinematics is stated in closed form."""
        return type(self).inverse is not SubLeg.inverse

    @property
    def modes(self) -> tuple[Mode, ...]:
        """Working modes, in the order of `inverse_all`."""
        return branches(self.inverse_signs)

    @property
    def assemblies(self) -> tuple[Mode, ...]:
        """Assembly modes that signs tell apart (`only` where there is no choice)."""
        return branches(self.forward_signs)

    @property
    def assembly_count(self) -> int:
        """The most assembly modes that it has for the same actuated joints."""
        return self.assemblies_near if self.assembly_by_point else len(self.assemblies)

    @property
    def lists_assemblies(self) -> bool:
        """Whether it states all its assembly modes, where there are several."""
        if not self.has_forward:
            return self.assembly_roots is not None
        return bool(self.forward_signs) or type(self).forward_all is not SubLeg.forward_all

    @cached_property
    def assembly_roots(self) -> ForwardRoots | None:
        """What `forward_roots` states, derived once."""
        return self.forward_roots()

    @cached_property
    def _factors(self) -> tuple[tuple[Factor, ...], ...]:
        return SubLegKernels(self).factors()

    @property
    def assembly_by_point(self) -> bool:
        """Whether a point near the end point chooses its assembly mode."""
        return self.forward_near or not self.has_forward

    def ports(self) -> SubLegPorts:
        """The ports of its kernels."""
        return SubLegPorts(self)

    def kernels(self) -> tuple[Kernel, ...]:
        """Every kernel of the sub-leg, in the order in which it is printed."""
        base = SubLegKernels(self)
        return (*base.all(), *StaticsKernels(base).all())

    def closure_kernel(self) -> Kernel:
        """The loop closure as a kernel; it is used by proofs and never printed."""
        return SubLegKernels(self).closure()

    def has_parallel_factors(self) -> bool:
        """Whether the sub-leg has a closed loop, and with it configurations in which M_i does not exist."""
        return bool(self._factors[1])

    def has_serial_factors(self) -> bool:
        """Whether there are configurations in which M_i, or the rates of its joints, cannot be inverted."""
        return bool(self._factors[0])

    def has_swivel_factors(self) -> bool:
        """Whether a redundant sub-leg has configurations in which its swivel does not exist."""
        return self.redundant and bool(self._factors[2])

    def has_loops(self) -> bool:
        """Whether passive joints and points exist only where loops of passive joints close."""
        return type(self).loops is not SubLeg.loops

    def points_port(self) -> Port:
        """The port of its joints' positions, with their names."""
        return SubLegKernels(self).points().output_port("points")

    def factor_names(self) -> list[tuple[str, str]]:
        """Names and meanings of the leg's singular factors, serial ones first."""
        return [(factor.name, factor.doc) for kind in self._factors for factor in kind]
