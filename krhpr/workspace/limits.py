"""What a pose has to keep to belong to the workspace, and the names of what stops it."""

from __future__ import annotations

from dataclasses import asdict, dataclass, replace
from enum import IntEnum
from math import pi, radians
from typing import Any

from krhpr.errors import WorkspaceError
from krhpr.limits import Limits
from krhpr.robot import Robot
from krhpr.robot_files.facts import FIRST_LINK


class Stop(IntEnum):
    """What keeps a pose out of the workspace; in the order in which it is looked for."""

    NONE = 0
    REACH = 1
    """A leg cannot reach its end point."""
    BASE = 2
    """The platform is below the lowest height."""
    TYPE_2 = 3
    """A type II margin is too small."""
    AXIS = 4
    """S_i is too near to the leg's first axis (type I)."""
    ELBOW = 5
    """An elbow is too straight or too folded (type I)."""
    SPHERICAL = 6
    """A spherical joint is turned too far."""
    ACTUATOR = 7
    """An actuated joint is beyond its limit."""
    PASSIVE = 8
    """A passive revolute joint or slide is beyond its limit."""
    BODIES = 9
    """Two bodies are nearer to one another than the clearance."""

    @property
    def words(self) -> str:
        """What it is, for messages and pictures."""
        return _WORDS[self]


_WORDS = {
    Stop.NONE: "nothing",
    Stop.REACH: "reach",
    Stop.BASE: "base",
    Stop.TYPE_2: "type II margin",
    Stop.AXIS: "distance from the first axis",
    Stop.ELBOW: "elbow",
    Stop.SPHERICAL: "spherical joint",
    Stop.ACTUATOR: "actuator",
    Stop.PASSIVE: "passive joint",
    Stop.BODIES: "interference",
}


@dataclass(frozen=True)
class WorkspaceLimits:
    """Limits beside those of the robot's file (`robot.limits`), which are held as well; None: not limited.

    Lengths in metres, angles in radians.  Clearance, axis distance and elbow are those of the file unless
    given here.
    """

    radius: float | None = None
    """Of the links for which the robot's file has none; without either a link is no body."""
    clearance: float | None = None
    """The least distance between surfaces of bodies; 0 where there is none in the file either."""
    edges: bool = True
    """Whether the platform's edges are bodies (in arrangement (a)), with the largest radius there is."""
    cone: float | None = None
    """The largest angle between a sub-leg's last link and the redundant link."""
    axis_distance: float | None = None
    """The least distance of S_i from the first axis of its leg."""
    elbow: tuple[float, float] | None = None
    """The least and the largest angle between the links that an elbow joins."""
    lowest: float | None = None
    """The least height of the platform."""
    margin: float | None = None
    """The least type II margin."""

    def __post_init__(self) -> None:
        for name, high in (("cone", pi), ("axis_distance", None), ("radius", None), ("clearance", None)):
            value = getattr(self, name)
            if value is not None and not (0 <= value <= (high or float("inf"))):
                expected = "0 or more" if high is None else "between 0 and pi"
                raise WorkspaceError(f"{name} is {value:g}; expected a number that is {expected}")
        if self.elbow is not None and not 0 <= self.elbow[0] < self.elbow[1] <= pi:
            raise WorkspaceError(
                f"elbow is {self.elbow}; expected the least and the largest angle, between 0 and pi"
            )

    def beside(self, file: Limits) -> WorkspaceLimits:
        """With what only the robot's file limits."""
        own = (file.elbow.low, file.elbow.high) if file.elbow is not None else None
        return replace(
            self,
            clearance=file.clearance if self.clearance is None else self.clearance,
            axis_distance=file.axis_distance if self.axis_distance is None else self.axis_distance,
            elbow=own if self.elbow is None else self.elbow,
        )

    def settings(self) -> dict[str, Any]:
        """As plain values, for stores."""
        return asdict(self)


def section_1_7(robot: Robot | None = None) -> WorkspaceLimits:
    """Those of Section 1.7: cylinders of 7.5 mm and 5 mm between them, S_i 20 mm from the first axis, elbows
    between 10 and 170 degrees, spherical joints within 150 degrees, the base below.

    The thesis does not print between which bodies spherical joints are measured, nor what body the platform
    is: here it is the angle between distal and redundant link, and the platform's edges are links.  For
    `robot`, limits that its sub-leg does not have are left out.
    """
    turns = robot is None or first_axis_turns(robot)
    bends = robot is None or bool(elbows(robot))
    return WorkspaceLimits(
        radius=0.0075,
        clearance=0.005,
        cone=radians(150),
        axis_distance=0.02 if turns else None,
        elbow=(radians(10), radians(170)) if bends else None,
        lowest=0.0,
    )


def first_axis_turns(robot: Robot) -> bool:
    """Whether the first actuator turns about link l_1, on which the first axis then lies."""
    return robot.angular[0] and FIRST_LINK in robot.links


def elbows(robot: Robot) -> tuple[tuple[int, int, int], ...]:
    """The elbows of a leg, each by three rows of `link_points`: where the proximal link begins, the elbow,
    and the end of what follows it."""
    labels = robot.signature("link_points").outputs[0].labels
    return tuple(
        (labels.index(start), labels.index(end), labels.index("S"))
        for _, kind, start, end in robot.links
        if kind == "proximal"
    )
