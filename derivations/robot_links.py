"""Distances between the links of one robot: which pairs there are, and the function that measures them."""

from __future__ import annotations

from itertools import combinations
from typing import TYPE_CHECKING

from krhpr.codegen.composition import Call, EachPair, RobotFunction, Stage
from krhpr.codegen.kernel import LEGS, Frame, Port, Unit
from krhpr.derivations.robot_functions import FunctionsOf

if TYPE_CHECKING:
    from krhpr.derivations.robots import Robot

Ends = tuple[int, int]
"""Two points by number: leg by leg those of `link_points`, then where redundant links meet the platform."""


def link_ends(robot: Robot) -> list[tuple[Ends, frozenset[int]]]:
    """The ends of every straight link, and all joints that lie on it.

    The links of leg 1, of leg 2 and of leg 3; then, where redundant links have a length, these; then, in
    arrangement (a), the edges of the platform 1-2, 1-3 and 2-3.
    """
    names = robot.subleg.points_port().labels
    found: list[tuple[Ends, frozenset[int]]] = []
    for leg in range(LEGS):
        for link in robot.subleg.links:
            start, end, *inside = (leg * len(names) + names.index(name) for name in link.joints)
            found.append(((start, end), frozenset((start, end, *inside))))
    if not robot.platform.redundant_link:
        return found
    first = LEGS * len(names)
    edges = [(leg * len(names) + names.index("S"), first + leg) for leg in range(LEGS)]
    if robot.platform.arrangement == "a":
        edges += [(first + i, first + j) for i, j in combinations(range(LEGS), 2)]
    return found + [(edge, frozenset(edge)) for edge in edges]


def link_pairs(robot: Robot) -> tuple[tuple[int, int, int, int], ...]:
    """The ends of both links of every pair that no joint joins."""
    return tuple(
        (*first, *second)
        for (first, joints), (second, others) in combinations(link_ends(robot), 2)
        if not joints & others
    )


class LinkFunctions(FunctionsOf):
    """Distances between the links of one robot."""

    def _clearances(self) -> RobotFunction:
        pairs = link_pairs(self.robot)
        distances = Port(
            "distances",
            (len(pairs),),
            Unit.METRE,
            Frame.NONE,
            "shortest distances between the axes of links that no joint joins",
        )
        return self._function(
            "clearances",
            "Distances between the axes of every two links that no joint joins: of the legs, the redundant "
            "links, and in arrangement (a) the platform's edges.  They have kinks where the nearest points "
            "pass from an end of a link to another.",
            "1.7.1",
            (*self.pose, self.leg.s, self.leg.theta),
            (distances,),
            (
                self._posture(),
                self._on_leg("subleg", "points"),
                self._on_leg("platform", "attachment"),
                Call(
                    Stage.PLATFORM,
                    "algebra",
                    "segment_distance",
                    {},
                    {"distance": "distances"},
                    pairs=EachPair(("points", "attachment"), pairs),
                ),
            ),
            self._loop_guard(),
        )
