"""What a platform arrangement is: how three sub-leg end points hold the platform (Fig. 2.1).

An arrangement's file states, for one leg: its geometry, the end point from pose and redundant coordinate and
back, the constraint equations, the lines (wrenches) that they stand for, the velocity of the end point, and
the redundant link's frame.  Rows of J and K, accelerations, the solution of J t = K theta_dot and the factors
of det J follow here.

Each leg gives the platform one line in its plane (along the redundant link for arrangement (a), across the
slide for (b) and (c)) and, in space, one line along the normal q_z through S_i.  In the platform frame J is
block triangular, so that det J = det J_a det J_n with J_a = [direction, moment about O'] and J_n = [1, y_i,
-x_i] (errata, 4).
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import Any

import sympy as sp

from krhpr.codegen.kernel import GeometryType, Kernel
from krhpr.codegen.writer import KernelWriter
from krhpr.derivations.platforms.forward import Hold
from krhpr.derivations.platforms.kernels import PlatformKernels, PlatformPorts
from krhpr.derivations.platforms.statics import StaticsKernels
from krhpr.derivations.requirements import Requirement
from krhpr.derivations.terms import Joint, JointKind, Pose, Space


class Platform(ABC):
    """One platform arrangement in space or in the plane."""

    name: str
    arrangement: str
    space: Space
    notation: str
    section: str
    doc: str
    redundant_joint: Joint
    redundant_link: str = "l_r"
    """The field with the length of the link from S_i to its attachment; empty where they are one point."""
    equations: str
    type_2_doc: str
    margins_doc: str
    requirements: tuple[Requirement, ...] = ()
    """What it requires of the sizes of all three legs together."""

    closed_forward: bool = False
    """Whether the forward kinematics has a closed form, kernels `tie`, `assembly_modes` and `assembly_mode`;
    else it is a polynomial's roots, kernels `tie`, `sextic` and `assembly`.
    """
    carries_gripper: bool = False
    """Whether jaws on its redundant links make a gripper, kernels `opening`, `redundant_of_opening`
    and `grasp`."""

    # -- what an arrangement's file states ------------------------------------------------------------------

    @abstractmethod
    def geometry(self) -> GeometryType:
        """Fields and prepared vectors of one leg's attachment."""

    @abstractmethod
    def end_point(self, k: KernelWriter, pose: Pose, redundant: Any) -> sp.Matrix:
        """s_i from the pose and the redundant coordinate, (1.37)."""

    @abstractmethod
    def redundant(self, k: KernelWriter, pose: Pose, s: sp.Matrix) -> Any:
        """The redundant coordinate from pose and end point."""

    @abstractmethod
    def residual(self, k: KernelWriter, pose: Pose, s: sp.Matrix) -> sp.Matrix:
        """The leg's constraint equations, zero where the leg closes; their rates are J t - N s_dot."""

    @abstractmethod
    def direction(self, k: KernelWriter, pose: Pose, s: sp.Matrix) -> sp.Matrix:
        """Direction of the leg's line in the platform's plane, in the base frame (a_i, or Q n_i)."""

    @abstractmethod
    def anchor(self, k: KernelWriter, pose: Pose, s: sp.Matrix) -> sp.Matrix:
        """A vector from O' to a point of that line, in the base frame."""

    @abstractmethod
    def end_velocity(
        self, k: KernelWriter, pose: Pose, s: sp.Matrix, carried: sp.Matrix, rate: Any
    ) -> sp.Matrix:
        """s_dot from `carried`, the velocity of the platform's point at S_i, and the redundant coordinate's
        rate.
        """

    @abstractmethod
    def joint(self, k: KernelWriter, pose: Pose, s: sp.Matrix) -> sp.Matrix:
        """The redundant link: its frame (rotation matrix) in space, its direction in the plane."""

    @abstractmethod
    def attachment(self, k: KernelWriter, pose: Pose, s: sp.Matrix) -> sp.Matrix:
        """Where the redundant link meets the platform, in the base frame: its joint B_i, or its slider."""

    @abstractmethod
    def margins(self, k: KernelWriter, det_a: Any, det_n: Any, scale: sp.Matrix) -> list[Any]:
        """Type II margins, positive inside the working box, from the factors of det J and the legs'
        `scale`.
        """

    @abstractmethod
    def scale(self, k: KernelWriter) -> list[Any]:
        """Two lengths of the leg by which margins are made dimensionless (1 where there is none)."""

    @abstractmethod
    def closed_form(self, k: KernelWriter, redundant: list[Any], geometry: list[Any]) -> list[Any]:
        """det J_a (and det J_n in space) as the closed form in the redundant coordinates, for the proof."""

    @abstractmethod
    def forward_kernels(self) -> tuple[Kernel, ...]:
        """Kernels of the forward kinematics: poses from the sub-legs' end points."""

    @abstractmethod
    def hold(self, k: KernelWriter, count: int) -> Hold:
        """What encoders at the first `count` legs tell, from the legs' ties and from what is measured."""

    @abstractmethod
    def tie_residual(self, k: KernelWriter, state: Any, point: Any) -> tuple[list[Any], Any]:
        """By how much the third leg's end point misses its tie to the platform (m), and its derivatives.

        `state` is U column by column and p, `point` is S_3, all in the platform's plane as
        `platforms/encoders.py` has them.
        """

    # -- what follows ---------------------------------------------------------------------------------------

    def ports(self) -> PlatformPorts:
        """The ports of its kernels."""
        return PlatformPorts(self)

    def kernels(self) -> tuple[Kernel, ...]:
        """Every kernel of the arrangement."""
        base = PlatformKernels(self)
        return (*base.all(), *StaticsKernels(base).all())

    def lever(self, k: KernelWriter) -> Any:
        """How far S_i moves with the redundant coordinate: the redundant link where that is an angle."""
        revolute = self.redundant_joint.kind is JointKind.REVOLUTE
        return getattr(k.g, self.redundant_link) if revolute else sp.Integer(1)
