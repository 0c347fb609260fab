"""Margins of poses: by how much each limit is kept, and which one is not."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from krhpr.branches import Branch
from krhpr.errors import WorkspaceError
from krhpr.limits import Intervals
from krhpr.robot import Robot
from krhpr.workspace.bodies import Bodies, least_of
from krhpr.workspace.limits import Stop, WorkspaceLimits, elbows, first_axis_turns

Floats = NDArray[np.float64]
Codes = NDArray[np.int8]
Places = NDArray[np.int16]

LENGTH = 0.1
"""A margin of so many metres counts as much as one of a radian, where limits of both kinds are compared."""
LENGTHS = (Stop.BASE, Stop.AXIS, Stop.BODIES)
"""Limits whose margins are in metres."""


@dataclass(frozen=True)
class Margins:
    """Of n poses; positive where a limit is kept, in metres or radians."""

    stops: Codes
    """The first limit that is not kept, a `Stop`."""
    which: Places
    """Which of its kind: a leg, leg by leg a joint, or a pair of bodies."""
    values: dict[Stop, Floats]
    """Every margin that was looked at, NaN where another limit had stopped the pose before."""

    @property
    def free(self) -> NDArray[np.bool_]:
        """Whether all limits are kept."""
        return np.asarray(self.stops == Stop.NONE)

    @property
    def least(self) -> Floats:
        """The least margin, metres over `LENGTH`; -inf where a pose is not free."""
        found = np.full(len(self.stops), np.inf)
        for stop, value in self.values.items():
            found = np.fmin(found, value / LENGTH if stop in LENGTHS else value)
        return np.where(self.free, found, -np.inf)

    def slack(self, slopes: Mapping[Stop, float]) -> Floats:
        """How far a coordinate may go before any limit can be reached, by how steep margins are at most; -inf
        where a pose is not free."""
        found = np.full(len(self.stops), np.inf)
        for stop, value in self.values.items():
            if slopes.get(stop, 0.0) > 0:
                found = np.fmin(found, value / slopes[stop])
        return np.where(self.free, found, -np.inf)


@dataclass(frozen=True)
class State:
    """Poses with their joints: what limits are measured on."""

    p: Floats
    Q: Floats
    redundant: Floats
    s: Floats
    theta: Floats

    def of(self, chosen: Any) -> State:
        """Some of them."""
        return State(
            self.p[chosen], self.Q[chosen], self.redundant[chosen], self.s[chosen], self.theta[chosen]
        )

    @property
    def arguments(self) -> tuple[Floats, Floats, Floats, Floats]:
        """As functions of the robot take them."""
        return self.p, self.Q, self.s, self.theta


Measure = Callable[[State], tuple[Floats, Places]]
"""The least margin of each pose (n,), and which of its kind it is (n,)."""


class Examiner:
    """A robot with limits, which says of poses whether they keep them."""

    def __init__(self, robot: Robot, limits: WorkspaceLimits, *, mode: Branch | None = None) -> None:
        """With limits beside those of the robot's file, in a working mode (the default one unless given).

        Raises:
            WorkspaceError: a limit that the robot does not have, or a robot that is not in space.
        """
        if robot.planar:
            raise WorkspaceError(
                f"{robot.name}: workspaces are those of spatial robots; links of planar ones lie in layers"
            )
        if any(port.name == "theta_near" for port in robot.signature("inverse").inputs):
            raise WorkspaceError(f"{robot.name}: its sub-legs have no inverse kinematics in closed form")
        limits = limits.beside(robot.limits)
        if limits.axis_distance is not None and not first_axis_turns(robot):
            raise WorkspaceError(
                f"{robot.name}: axis_distance is limited, but its first actuators do not turn"
            )
        if limits.axis_distance is not None and (robot.geometry.fields["l_1"] == 0).any():
            raise WorkspaceError(
                f"{robot.name}: axis_distance is limited, but l_1 = 0 gives the axis no direction"
            )
        if limits.elbow is not None and not elbows(robot):
            raise WorkspaceError(f"{robot.name}: elbow is limited, but its sub-legs have none")
        self.robot, self.limits, self.mode = robot, limits, mode
        self.bodies = Bodies.of(robot, limits)

    def examine(self, p: Floats, Q: Floats, redundant: Floats, *, thorough: bool = False) -> Margins:
        """The margins of n poses p (n, 3), Q (n, 3, 3), redundant (n, 3).

        Limits are looked at in the order of `Stop`, and no more of a pose once one is not kept, unless
        `thorough`.
        """
        robot = self.robot
        s = robot.end_points(p, Q, redundant, check_rotation=False)
        theta, status = robot.inverse(p, Q, redundant, mode=self.mode, check_rotation=False, status=True)
        stops = np.where(status == 0, Stop.NONE, Stop.REACH).astype(np.int8)
        which = np.maximum(status - 1, 0).astype(np.int16)
        values = {}
        state = State(p, Q, redundant, s, theta)
        for stop, measure in self._measures.items():
            left = np.flatnonzero(status == 0 if thorough else stops == Stop.NONE)
            whole = len(left) == len(p)
            value, place = measure(state if whole else state.of(left))
            beyond = ~(value >= 0) & (stops[left] == Stop.NONE)
            stops[left[beyond]] = stop
            which[left[beyond]] = place[beyond]
            values[stop] = np.full(len(p), np.nan)
            values[stop][left] = value
        return Margins(stops, which, values)

    def name(self, stop: int, which: int) -> str:
        """What stops a pose, in words: `interference of l_3 of leg 1 and platform edge 1-2`."""
        kind = Stop(stop)
        if kind is Stop.BODIES:
            return f"{kind.words} of {self.bodies.names[which]}"
        if kind in (Stop.NONE, Stop.BASE, Stop.TYPE_2):
            return kind.words
        if kind is Stop.ACTUATOR:
            names = list(self.robot.limits.actuators)
            return f"{kind.words} {names[which // 3]} of leg {which % 3 + 1}"
        if kind is Stop.PASSIVE:
            names = list(self.robot.limits.passive)
            return f"{kind.words} {names[which // 3]} of leg {which % 3 + 1}"
        return f"{kind.words} of leg {which % 3 + 1}"

    # -- how each limit is measured -------------------------------------------------------------------------

    @cached_property
    def _measures(self) -> dict[Stop, Measure]:
        limits, robot = self.limits, self.robot
        found: dict[Stop, Measure] = {}
        if limits.lowest is not None:
            found[Stop.BASE] = self._base
        if limits.margin is not None:
            found[Stop.TYPE_2] = self._type_2
        if limits.axis_distance is not None:
            found[Stop.AXIS] = self._axis
        if limits.elbow is not None:
            found[Stop.ELBOW] = self._elbow
        if limits.cone is not None or robot.limits.spherical is not None:
            found[Stop.SPHERICAL] = self._spherical
        if robot.limits.actuators:
            found[Stop.ACTUATOR] = self._actuators
        if robot.limits.passive:
            found[Stop.PASSIVE] = self._passive
        if len(self.bodies.chosen):
            found[Stop.BODIES] = self._bodies
        return found

    def _base(self, state: State) -> tuple[Floats, Places]:
        height = state.p[:, 2] - (self.limits.lowest or 0.0)
        return height, np.zeros(len(height), dtype=np.int16)

    def _type_2(self, state: State) -> tuple[Floats, Places]:
        margins = self.robot.type_2_of_redundant(state.redundant).margins - (self.limits.margin or 0.0)
        return _least(margins)

    @cached_property
    def _axes(self) -> tuple[Floats, Floats]:
        """A point (3, 3) and the direction (3, 3) of the legs' first axes."""
        home = self.robot.home
        s = self.robot.end_points(*home)
        theta = np.zeros((3, len(self.robot.angular)))
        points = self.robot.link_points(home.p, home.orientation, s, theta).points
        rows = self.robot.signature("link_points").outputs[0].labels
        base, end = points[:, rows.index("A")], points[:, rows.index("c")]
        return base, (end - base) / np.linalg.norm(end - base, axis=-1, keepdims=True)

    def _axis(self, state: State) -> tuple[Floats, Places]:
        base, along = self._axes
        arm = state.s - base
        height = np.einsum("nij,ij->ni", arm, along)
        square = np.einsum("nij,nij->ni", arm, arm) - height**2
        return _least(np.sqrt(np.maximum(square, 0.0)) - (self.limits.axis_distance or 0.0))

    def _elbow(self, state: State) -> tuple[Floats, Places]:
        low, high = self.limits.elbow or (0.0, np.pi)
        points = self.robot.link_points(*state.arguments, check_rotation=False).points
        every = []
        for start, middle, end in elbows(self.robot):
            u = points[:, :, middle] - points[:, :, start]
            w = points[:, :, end] - points[:, :, middle]
            square = np.einsum("nij,nij->ni", u, u) * np.einsum("nij,nij->ni", w, w)
            angle = np.arccos(np.clip(np.einsum("nij,nij->ni", u, w) / np.sqrt(square), -1, 1))
            every.append(np.minimum(angle - low, high - angle))
        return _least(np.concatenate(every, axis=-1))

    def _spherical(self, state: State) -> tuple[Floats, Places]:
        turned = self._joints(state).spherical
        every = []
        if self.limits.cone is not None:  # both links point away from the base
            every.append(self.limits.cone - np.arccos(np.clip(turned[..., 0, 0], -1, 1)))
        if self.robot.limits.spherical is not None:
            for leg, cone in enumerate(self.robot.limits.spherical):
                cosine = np.asarray(cone.socket) @ turned[:, leg] @ np.asarray(cone.stud)
                every.append((cone.tilt - np.arccos(np.clip(cosine, -1, 1)))[:, None])
        return _least(np.concatenate(every, axis=-1))

    def _actuators(self, state: State) -> tuple[Floats, Places]:
        names = self.robot.signature("inverse").outputs[0].labels
        return _least(
            np.concatenate(
                [
                    _within(
                        state.theta[:, :, names.index(name)], limits, self.robot.angular[names.index(name)]
                    )
                    for name, limits in self.robot.limits.actuators.items()
                ],
                axis=-1,
            )
        )

    def _passive(self, state: State) -> tuple[Floats, Places]:
        found = self._joints(state)
        kinds = dict(self.robot.documentation["joint kinds"])
        ports = {port.name: port for port in self.robot.signature("passive_joints").outputs}
        every = []
        for name, limits in self.robot.limits.passive.items():
            if name in ports:
                value, turns = getattr(found, name), str(ports[name].unit) == "rad"
            else:
                value = found.passive[..., ports["passive"].labels.index(name)]
                turns = kinds[name] == "revolute"
            every.append(_within(value, limits, turns))
        return _least(np.concatenate(every, axis=-1))

    def _joints(self, state: State) -> Any:
        return self.robot.passive_joints(*state.arguments, check_rotation=False)

    def _bodies(self, state: State) -> tuple[Floats, Places]:
        return self.bodies.margins(self.robot.clearances(*state.arguments, check_rotation=False))

    def with_limits(self, **changes: Any) -> Examiner:
        """The same with other limits."""
        return Examiner(self.robot, replace(self.limits, **changes), mode=self.mode)


def _least(margins: Floats) -> tuple[Floats, Places]:
    """The least of each row, and its place."""
    least, place = least_of(margins)
    return least, place.astype(np.int16)


def _within(value: Floats, limits: Intervals, turns: bool) -> Floats:
    """How far (n, 3) each leg's coordinate is inside its interval; angles with any full turns."""
    low, high = (np.array([getattr(limit, end) for limit in limits]) for end in ("low", "high"))
    off = value - (low + high) / 2
    if turns:
        off = np.remainder(off + np.pi, 2 * np.pi) - np.pi
    return np.asarray((high - low) / 2 - np.abs(off))
