"""The forward kinematics of a robot as methods (Chapter 3)."""

from __future__ import annotations

from typing import Any, Unpack

import numpy as np
from numpy.typing import ArrayLike

from krhpr.branches import Branch
from krhpr.calls import Calls, Options
from krhpr.defaults import NUMBERS
from krhpr.errors import UnknownBranch


class ForwardKinematics(Calls):
    """From end points, joints and encoders to poses."""

    def forward_all(self, s: ArrayLike, *, turned: bool = False, **options: Unpack[Options]) -> Any:
        """(p, Q, redundant, det_J, count): every pose that holds the end points s (..., 3, 3), along a first
        core axis; `turned` gives those of the platform turned over in place of the others.  Arrangement (a)
        adds `doubtful`, 1 where two solutions all but coincide and are left out.
        """
        return self._answer("forward_all", (s, *self._family("forward_all", turned)), options)

    def _family(self, function: str, turned: bool) -> tuple[float, ...]:
        """The argument `turned`, where there is one."""
        if self._takes(function, "turned"):
            return (-1.0 if turned else 1.0,)
        if turned:
            raise UnknownBranch(f"{self.identifier}.{function}: a planar platform cannot be turned over")
        return ()

    @property
    def box(self) -> np.ndarray[Any, Any]:
        """Where `forward` looks for redundant angles unless told (3, 2), rad; empty for slides."""
        return np.array(getattr(self._module, "DEFAULT_BOX", ()))

    def forward(
        self,
        theta: ArrayLike,
        assembly: Branch | None = None,
        *,
        near: ArrayLike | None = None,
        side: ArrayLike | None = None,
        box: ArrayLike | None = None,
        turned: bool = False,
        **options: Unpack[Options],
    ) -> Any:
        """(p, Q, redundant, count, certified) from the actuated joints theta (..., 3, n) alone.

        Arrangement (a): the only pose with its redundant angles in `box` (..., 3, 2), low and high for each
        leg, in radians; from 30 to 150 degrees, or within the limits of the robot's file, unless given.
        `certified` is 1 where a theorem says that there is no other, and 0 where it is the only one among
        the `count` found; the status is AMBIGUOUS where several lie in the box, NO_ASSEMBLY where none does.
        `turned` looks for the platform turned over.

        Arrangements (b) and (c): the one pose on a `side` of type II, +1 (where the first margin of
        `singularity` is positive, and unless given) or -1: always certain.

        `assembly` and `near` choose the sub-legs' assembly modes as in `subleg_forward`.
        """
        choice = self._assembly_choice("forward", assembly, near)
        pose = self._pose_choice("forward", side, box, turned)
        return self._answer("forward", (theta, *choice, *pose), options)

    def passive_joints_of_theta(
        self,
        theta: ArrayLike,
        assembly: Branch | None = None,
        *,
        near: ArrayLike | None = None,
        side: ArrayLike | None = None,
        box: ArrayLike | None = None,
        turned: bool = False,
        **options: Unpack[Options],
    ) -> Any:
        """Every passive joint from the actuated ones alone, as `passive_joints` gives them, then the pose
        (p, Q, redundant); the arguments are those of `forward`, and so is the status.
        """
        choice = self._assembly_choice("passive_joints_of_theta", assembly, near)
        pose = self._pose_choice("passive_joints_of_theta", side, box, turned)
        return self._answer("passive_joints_of_theta", (theta, *choice, *pose), options)

    def _pose_choice(
        self, function: str, side: ArrayLike | None, box: ArrayLike | None, turned: bool
    ) -> tuple[Any, ...]:
        """The arguments that choose among poses: a side of type II, or a box and a family."""
        if self._takes(function, "side"):
            if box is not None or turned:
                raise UnknownBranch(f"{self.identifier}.{function}: side=+1 or -1 chooses the pose, no box")
            return (1.0 if side is None else side,)
        if side is not None:
            raise UnknownBranch(f"{self.identifier}.{function}: box=... chooses the pose, no side")
        return (self.box if box is None else box, *self._family(function, turned))

    def forward_newton(
        self, s: ArrayLike, p_near: ArrayLike, Q_near: ArrayLike, **options: Unpack[Options]
    ) -> Any:
        """(p, Q, redundant, kantorovich) by Newton steps from a pose nearby, the previous one on a path:
        approach two, for arrangement (a).  `kantorovich` is at most 1 where the steps are certain to
        converge, to the only solution around.  `Q_near` is phi_near for a planar robot.
        """
        return self._answer("forward_newton", (s, p_near, Q_near), options)

    def forward_encoders(
        self,
        s: ArrayLike,
        measured: ArrayLike,
        *,
        tolerance: ArrayLike | None = None,
        **options: Unpack[Options],
    ) -> Any:
        """The pose with encoders at the redundant joints of the first one, two or three legs: approaches
        three to five, as many as `measured` (..., 1 to 3) has; arrangements (b) and (c) need two.

        One encoder gives (p, Q, mismatch) of two solutions, along a first core axis: first the one that fits
        better.  Two or three give (p, Q, raw, mismatch), with `raw` the orientation before it is made a
        rotation.  `mismatch` says by how much lengths disagree; the status is INCONSISTENT where that is more
        than `tolerance`, in metres.
        """
        function = f"forward_encoders_{self._count(measured)}"
        given = NUMBERS["tolerance"][0] if tolerance is None else tolerance
        return self._answer(function, (s, measured, given), options)

    def forward_gauss_newton(
        self,
        s: ArrayLike,
        measured: ArrayLike,
        *,
        weights: ArrayLike | None = None,
        tolerance: ArrayLike | None = None,
        **options: Unpack[Options],
    ) -> Any:
        """(p, Q, raw, mismatch) by Gauss-Newton with two or three encoders: approaches six and seven.

        `weights` (..., 3) multiply the residuals of s_i = p + Q d_i (1/m), of the third leg's tie (1/m),
        and of Q^T Q = 1: the result depends on them, and they are 1000 each unless given.
        """
        function = f"forward_gauss_newton_{self._count(measured)}"
        given = NUMBERS["tolerance"][0] if tolerance is None else tolerance
        chosen = NUMBERS["weights"] if weights is None else weights
        return self._answer(function, (s, measured, given, chosen), options)

    @staticmethod
    def _count(measured: ArrayLike) -> int:
        """How many encoders there are."""
        shape = np.shape(measured)
        return shape[-1] if shape else 1
