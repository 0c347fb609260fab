"""What a function answers where it has no result."""

from __future__ import annotations

from enum import IntEnum


class Status(IntEnum):
    """What a function says about its answer; one enumeration for all targets."""

    OK = 0
    UNREACHABLE_LEG_1 = 1
    UNREACHABLE_LEG_2 = 2
    UNREACHABLE_LEG_3 = 3
    SINGULAR_LEG_1 = 4
    SINGULAR_LEG_2 = 5
    SINGULAR_LEG_3 = 6
    SINGULAR_IN_PLANE = 7
    SINGULAR_NORMAL = 8
    NO_CONVERGENCE = 9
    AMBIGUOUS = 10
    INVALID_INPUT = 11
    NO_ASSEMBLY = 12
    INCONSISTENT = 13
    NO_GRASP = 14
    SLIPS = 15
    UNDETERMINED = 16


LEG_STATUSES = frozenset({Status.UNREACHABLE_LEG_1, Status.SINGULAR_LEG_1})
"""Statuses of the first leg: those of the other legs follow."""

STATUS_DOC = {
    Status.OK: "the answer is valid",
    Status.UNREACHABLE_LEG_1: "the end point of leg 1 is out of its reach",
    Status.UNREACHABLE_LEG_2: "the end point of leg 2 is out of its reach",
    Status.UNREACHABLE_LEG_3: "the end point of leg 3 is out of its reach",
    Status.SINGULAR_LEG_1: "a factor of det M_1 vanishes",
    Status.SINGULAR_LEG_2: "a factor of det M_2 vanishes",
    Status.SINGULAR_LEG_3: "a factor of det M_3 vanishes",
    Status.SINGULAR_IN_PLANE: (
        "det J_a vanishes: the lines in the platform's plane meet in a point or are parallel"
    ),
    Status.SINGULAR_NORMAL: "det J_n vanishes: S_1, S_2, S_3 are collinear",
    Status.NO_CONVERGENCE: "an iteration ended before it converged",
    Status.AMBIGUOUS: "several answers cannot be told apart",
    Status.INVALID_INPUT: "an input is NaN or infinite",
    Status.NO_ASSEMBLY: "no platform fits the three end points",
    Status.INCONSISTENT: "encoders contradict the end points by more than the tolerance",
    Status.NO_GRASP: "the jaws hold nothing: the slides' directions lie on one side, or a contact would pull",
    Status.SLIPS: "friction does not hold the object at a contact",
    Status.UNDETERMINED: (
        "the measured forces do not determine the others: the lines through the contacts along the jaws' "
        "faces meet in a point, or the contacts are in line"
    ),
}
