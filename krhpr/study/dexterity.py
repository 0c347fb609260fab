"""The example of Section 1.8: how far the nine actuators move, and how far from singularities they stay.

The 3-[R(RR-RRR)SR] robot follows the example trajectory with constant angles beta.  Found are the motion
ranges of the actuators (Fig. 1.10), the condition numbers of M_i and of J_1 = diag(M_1, M_2, M_3), (1.52)
(Fig. 1.11), and the kinematic sensitivities, 2-norms of the position and of the rotation part of
U = J^-1 K (Fig. 1.12).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

import krhpr
from krhpr.study.claims import Claim
from krhpr.study.trajectory import trajectory

Floats = NDArray[np.float64]

ROBOT = "spatial_r_fivebar_a"
BETA = float(np.radians(97))
"""The redundant angle of all legs, from the inward ray."""
LARGEST_RANGE = float(np.radians(60))
"""No actuator moves further, the thesis says."""
CLOSE_TO_ONE = 4.0
"""What counts as a condition number close to one: the printed text has no number, and 3.81 comes out."""
STABLE = 2.0
"""What counts as a stable sensitivity: the largest over the smallest."""


@dataclass(frozen=True)
class Dexterity:
    """The robot along the 721 poses of the trajectory."""

    theta: Floats
    """Actuated joints (721, 3, 3) without jumps of full turns, rad."""
    condition: Floats
    """Condition numbers of M_i (721, 3)."""
    condition_of_all: Floats
    """Condition number of J_1 (721), which is eta_3."""
    position: Floats
    """Sensitivity of the position, eta_1 (721), m."""
    rotation: Floats
    """Sensitivity of the rotation, eta_2 (721)."""

    @property
    def ranges(self) -> Floats:
        """Absolute motion ranges of the actuators (3, 3), legs first, rad."""
        return np.asarray(np.ptp(self.theta, axis=0))

    def claims(self) -> tuple[Claim, ...]:
        """What Section 1.8 says."""
        largest = np.degrees(self.ranges.max())
        worst = max(self.condition.max(), self.condition_of_all.max())
        growth = [float(one.max() / one.min()) for one in (self.position, self.rotation)]
        closed = float(np.abs(self.theta[-1] - self.theta[0]).max())
        return (
            Claim(
                f"the largest motion range of an actuator is no more than 60 degrees ({largest:.2f})",
                bool(self.ranges.max() <= LARGEST_RANGE),
            ),
            Claim(
                f"the condition numbers stay close to one (below {CLOSE_TO_ONE:g}: {worst:.2f})",
                bool(worst < CLOSE_TO_ONE),
            ),
            Claim(
                "the sensitivities are stable (the largest over the smallest is "
                f"{growth[0]:.2f} for the position, {growth[1]:.2f} for the rotation)",
                max(growth) < STABLE,
            ),
            Claim("the joints end where they began, without full turns", closed < 1e-9),
        )


def dexterity(beta: float = BETA) -> Dexterity:
    """The example of Section 1.8, with the same redundant angle (rad) in all legs."""
    robot = krhpr.load(ROBOT)
    p, Q = trajectory()
    p, redundant = p / 1000, np.full(3, beta)
    theta = np.unwrap(robot.inverse(p, Q, redundant), axis=0)
    found = robot.indices(p, Q, robot.end_points(p, Q, redundant), theta)
    return Dexterity(theta, found.condition, found.eta_3, found.eta_1, found.eta_2)
