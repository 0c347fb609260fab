"""What is chosen at a node: redundant coordinates, constant or free, and orientations, any or all of them."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum
from itertools import product
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from krhpr.errors import WorkspaceError
from krhpr.workspace.axes import Slopes
from krhpr.workspace.limits import Stop
from krhpr.workspace.margins import Codes, Examiner, Places

Floats = NDArray[np.float64]


class Best(StrEnum):
    """Which of the redundant coordinates that work is the best."""

    FIRST = "first"
    """The first that works: whether there is any is all that is asked."""
    MARGIN = "margin"
    """The one with the largest least margin."""
    ETA_1 = "eta_1"
    ETA_2 = "eta_2"
    ETA_3 = "eta_3"
    """The one with the smallest index."""


@dataclass(frozen=True)
class Redundancy:
    """Redundant coordinates to choose from at every node; one alone is constant."""

    candidates: tuple[tuple[float, float, float], ...]
    best: Best = Best.FIRST

    def __post_init__(self) -> None:
        if not self.candidates:
            raise WorkspaceError("no redundant coordinates to choose from")

    def settings(self) -> dict[str, Any]:
        """As plain values, for stores."""
        return {"redundant": [list(one) for one in self.candidates], "best": str(self.best)}


def constant(redundant: ArrayLike) -> Redundancy:
    """The same redundant coordinates everywhere: a number, or three."""
    a, b, c = np.broadcast_to(np.asarray(redundant, dtype=float), (3,)).tolist()
    return Redundancy(((a, b, c),))


def free(values: ArrayLike, *, alike: bool = False, best: Best | str = Best.MARGIN) -> Redundancy:
    """Redundant coordinates out of `values` for each leg: all combinations, or `alike` in the three legs."""
    each = [float(x) for x in np.atleast_1d(np.asarray(values, dtype=float))]
    found = [(x, x, x) for x in each] if alike else [(a, b, c) for a, b, c in product(each, repeat=3)]
    return Redundancy(tuple(found), Best(best))


class Variant(StrEnum):
    """Which of the orientations a position has to allow."""

    REACHABLE = "reachable"
    """One of them."""
    DEXTEROUS = "dexterous"
    """All of them."""


@dataclass(frozen=True)
class Answer:
    """Of n nodes."""

    stops: Codes
    """`Stop.NONE` where the node belongs to the workspace; else what stops its first alternative."""
    which: Places
    redundant: Floats
    """The redundant coordinates (n, 3) that were chosen; those of the first alternative where none works."""
    slack: Floats
    """How far the last coordinate may go before they stop to work (n,), by the slopes that were given."""


def choose(
    examiner: Examiner, redundancy: Redundancy, p: Floats, Q: Floats, slopes: Slopes | None = None
) -> Answer:
    """Whether redundant coordinates work at n poses, which are the best of them, and what else stops."""
    n = len(p)
    slack = np.full(n, -np.inf)
    chosen = np.tile(np.array(redundancy.candidates[0]), (n, 1))
    stops, which = np.full(n, Stop.REACH, dtype=np.int8), np.zeros(n, dtype=np.int16)
    score = np.full(n, -np.inf)
    first_only = redundancy.best is Best.FIRST
    for number, candidate in enumerate(redundancy.candidates):
        left = np.flatnonzero(stops != Stop.NONE) if first_only and number else np.arange(n)
        if not len(left):
            break
        whole = len(left) == n
        at_p, at_Q = (p, Q) if whole else (p[left], Q[left])
        redundant = np.broadcast_to(np.array(candidate), (len(left), 3))
        found = examiner.examine(at_p, at_Q, redundant)
        room = found.slack(slopes) if slopes is not None else slack[left]
        if number == 0:
            stops[left], which[left] = found.stops, found.which
        if len(redundancy.candidates) == 1:
            slack = room
            break
        value = _score(examiner, redundancy.best, found.free, found.least, at_p, at_Q, redundant)
        better = found.free & (value > score[left])
        place = left[better]
        stops[place], which[place], score[place] = Stop.NONE, 0, value[better]
        chosen[place], slack[place] = candidate, room[better]
    return Answer(stops, which, chosen, slack)


def _score(
    examiner: Examiner,
    best: Best,
    works: NDArray[np.bool_],
    least: Floats,
    p: Floats,
    Q: Floats,
    redundant: Floats,
) -> Floats:
    if best is Best.FIRST:
        return np.where(works, 0.0, -np.inf)
    if best is Best.MARGIN:
        return least
    found = np.full(len(works), -np.inf)
    values = indices(examiner, p[works], Q[works], redundant[works])
    found[works] = -values[:, int(best[-1]) - 1]
    return np.where(np.isnan(found), -np.inf, found)


def indices(examiner: Examiner, p: Floats, Q: Floats, redundant: Floats) -> Floats:
    """eta_1, eta_2 and eta_3 (n, 3) of poses within reach."""
    robot = examiner.robot
    s = robot.end_points(p, Q, redundant, check_rotation=False)
    theta = robot.inverse(p, Q, redundant, mode=examiner.mode, check_rotation=False)
    length = (
        [1.0]
        if any(port.name == "characteristic_length" for port in robot.signature("indices").inputs)
        else []
    )
    found = robot.call("indices", p, Q, s, theta, *length, check_rotation=False)
    return np.stack([found.eta_1, found.eta_2, found.eta_3], axis=-1)


def over_orientations(
    examiner: Examiner, redundancy: Redundancy, p: Floats, orientations: Floats, variant: Variant
) -> Answer:
    """Whether n positions allow one, or all, of the orientations (m, 3, 3)."""
    n = len(p)
    answer: Answer | None = None
    any_will_do = variant is Variant.REACHABLE
    for Q in orientations:
        if answer is None:
            left = np.arange(n)
        else:
            works = answer.stops == Stop.NONE
            left = np.flatnonzero(~works if any_will_do else works)
        if not len(left):
            break
        found = choose(examiner, redundancy, p[left], np.broadcast_to(Q, (len(left), 3, 3)))
        if answer is None:
            answer = found
            continue
        changed = (found.stops == Stop.NONE) == any_will_do
        place = left[changed]
        for target, source in (
            (answer.stops, found.stops),
            (answer.which, found.which),
            (answer.redundant, found.redundant),
        ):
            target[place] = source[changed]
    if answer is None:
        raise WorkspaceError("no orientations to look at")
    return answer
