"""The grasping robots with their default sizes: those of the prototype (Section 5.5) with sliders, and struts
from pivots on about the same line.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from math import pi

from krhpr.derivations.grasping.jaws import Jaws
from krhpr.derivations.grasping.robot import GraspingRobot
from krhpr.derivations.grasping.sublegs import GraspPRR, GraspRPR

Pair = tuple[float, float]
"""A value of the right and of the left sub-leg, or jaw."""


@dataclass(frozen=True)
class JawsHome:
    """A pose far from singularities: pivot, and the angles phi and beta."""

    p: Pair
    redundant: Pair


@dataclass(frozen=True)
class GraspingEntry:
    """A grasping robot with its default sizes (metres and radians, a value for each sub-leg)."""

    robot: GraspingRobot
    sizes: Mapping[str, Pair]
    home: JawsHome
    title: str
    thesis: str

    @property
    def identifier(self) -> str:
        """The name of the robot, `planar_grasp_prr`."""
        return self.robot.identifier


INITIAL = JawsHome((0.0, 0.09), (pi / 4, 3 * pi / 4))
"""The initial configuration of the prototype, (5.71)."""

_NOTHING = (0.0, 0.0)


def grasping() -> tuple[GraspingEntry, ...]:
    """Every grasping robot."""
    return (
        GraspingEntry(
            GraspingRobot(GraspPRR(), Jaws(), "4-PRR"),
            {
                **dict.fromkeys(("x_1", "y_1", "x_2", "y_2", "slide_1", "slide_2"), _NOTHING),
                "l_1": (0.12, 0.12),
                "l_2": (0.12, 0.12),
                "l_j": (0.0424, 0.0424),
            },
            INITIAL,
            "planar robot with a gripper, four PRR legs",
            "5.2, 5.5",
        ),
        GraspingEntry(
            GraspingRobot(GraspRPR(), Jaws(), "4-RPR"),
            {
                "x_1": (-0.15, -0.06),
                "y_1": (0.0, 0.005),
                "x_2": (0.06, 0.15),
                "y_2": (-0.005, 0.0),
                "l_j": (0.0424, 0.045),
            },
            INITIAL,
            "planar robot with a gripper, four RPR legs",
            "5.1, 5.2",
        ),
    )
