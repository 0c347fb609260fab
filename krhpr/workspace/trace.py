"""Boundaries along rays: by marching as the thesis does, or by bisection, to the same nodes."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from enum import StrEnum
from typing import Any

import numpy as np
from numpy.typing import NDArray

from krhpr.workspace.choices import Answer
from krhpr.workspace.limits import Stop

Floats = NDArray[np.float64]
Numbers = NDArray[np.intp]

Look = Callable[[Numbers, Numbers], Answer]
"""What is true of nodes: rays (k,) and steps along them (k,) -> answers of k nodes."""

BATCH = 8192
"""Nodes that are looked at together: what they take lies in a processor's cache."""


class Tracing(StrEnum):
    """How the boundary on a ray is found."""

    MARCH = "march"
    """Step by step from the beginning until a node is not free."""
    BISECT = "bisect"
    """In coarse steps and then by halves, wherever margins leave room for a gap: the same boundary at a
    fraction of the work."""


@dataclass(frozen=True)
class Boundary:
    """Of n rays."""

    steps: Numbers
    """The number of the last free node, -1 where the first node is not free."""
    stops: NDArray[np.int8]
    """What stops the next node; `Stop.NONE` where the ray ends before anything does."""
    which: NDArray[np.int16]
    redundant: Floats
    """Those that were chosen at the last free node (n, 3)."""
    nodes: int
    """How many nodes were looked at."""


def trace(look: Look, rays: int, at: Floats, tracing: Tracing, coarse: int = 16) -> Boundary:
    """The boundary on each ray, whose nodes are at the values `at` of its coordinate."""
    found = _Tracer(look, rays, at)
    if tracing is Tracing.MARCH:
        found.march()
    else:
        found.bisect(max(coarse, 1))
    return found.boundary()


class _Tracer:
    """The state of all rays: how far they are free, and the first node that is known not to be."""

    def __init__(self, look: Look, rays: int, at: Floats) -> None:
        self._look, self._at, self.count = look, at, len(at)
        self.beyond = np.full(rays, self.count, dtype=np.intp)
        self.stops = np.zeros(rays, dtype=np.int8)
        self.which = np.zeros(rays, dtype=np.int16)
        self.nodes = 0

    def look(self, rays: Numbers, steps: Numbers) -> Floats:
        """Look at one node of each of some rays; how much room there is around it, -inf if it is not free."""
        room = np.empty(len(rays))
        for first in range(0, len(rays), BATCH):
            some = slice(first, first + BATCH)
            answer = self._look(rays[some], steps[some])
            room[some] = np.where(answer.stops == Stop.NONE, answer.slack, -np.inf)
            nearer = np.flatnonzero((answer.stops != Stop.NONE) & (steps[some] < self.beyond[rays[some]]))
            # where there are several of one ray, the nearest comes last and stays
            nearer = nearer[np.argsort(-steps[some][nearer], kind="stable")]
            place = rays[some][nearer]
            self.beyond[place] = steps[some][nearer]
            self.stops[place], self.which[place] = answer.stops[nearer], answer.which[nearer]
        self.nodes += len(rays)
        return room

    def march(self) -> None:
        """All rays side by side, node after node."""
        going = np.arange(len(self.beyond))
        for step in range(self.count):
            self.look(going, np.full(len(going), step, dtype=np.intp))
            going = going[self.beyond[going] > step]
            if not len(going):
                break

    def bisect(self, coarse: int) -> None:
        """Coarse steps to the first that is not free; then halves of whatever may hide one that comes
        earlier."""
        spans = self._coarse(coarse)
        while len(spans.rays):
            spans = spans.only(spans.start < self.beyond[spans.rays] - 1)
            spans = spans.only((spans.end - spans.start > 1) & self._open(spans))
            middle = (spans.start + spans.end) // 2
            room = self.look(spans.rays, middle)
            before = _Spans(spans.rays, spans.start, middle, spans.room, room)
            after = _Spans(spans.rays, middle, spans.end, room, spans.room_end).only(room > -np.inf)
            spans = before.joined(after)

    def _coarse(self, coarse: int) -> _Spans:
        """The spans between coarse nodes."""
        going = np.arange(len(self.beyond))
        before = np.full(len(going), -np.inf)
        no_nodes, no_room = np.empty(0, dtype=np.intp), np.empty(0)
        found = _Spans(no_nodes, no_nodes, no_nodes, no_room, no_room)
        last = 0
        for step in [*range(0, self.count - 1, coarse), self.count - 1]:
            room = self.look(going, np.full(len(going), step, dtype=np.intp))
            if step:
                start, end = (np.full(len(going), k, dtype=np.intp) for k in (last, step))
                found = found.joined(_Spans(going, start, end, before, room))
            last, on = step, room > -np.inf
            going, before = going[on], room[on]
            if not len(going):
                break
        return found

    def _open(self, spans: _Spans) -> Any:
        """Whether a node that is not free may lie inside: always where one lies at the end."""
        length = self._at[spans.end] - self._at[spans.start]
        with np.errstate(invalid="ignore"):  # without any limit there is no end to the room before the end
            return ~(spans.room + spans.room_end > length)

    def boundary(self) -> Boundary:
        """What came of it."""
        steps = self.beyond - 1
        some = np.flatnonzero(steps >= 0)
        redundant = np.full((len(steps), 3), np.nan)
        for first in range(0, len(some), BATCH):
            rays = some[first : first + BATCH]
            redundant[rays] = self._look(rays, steps[rays]).redundant
        return Boundary(steps, self.stops, self.which, redundant, self.nodes)


@dataclass(frozen=True)
class _Spans:
    """Parts of rays between two nodes, of which the first is free."""

    rays: Numbers
    start: Numbers
    end: Numbers
    room: Floats
    """Around the first node."""
    room_end: Floats
    """Around the other, -inf where it is not free."""

    def only(self, chosen: Any) -> _Spans:
        """Some of them."""
        return _Spans(*(part[chosen] for part in self._parts))

    def joined(self, other: _Spans) -> _Spans:
        """With others."""
        pairs = zip(self._parts, other._parts, strict=True)
        return _Spans(*(np.concatenate(parts) for parts in pairs))

    @property
    def _parts(self) -> tuple[Any, ...]:
        return self.rays, self.start, self.end, self.room, self.room_end
