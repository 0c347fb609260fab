"""Bodies: links and platform edges as capsules, and how far apart the axes of two of them have to be."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from krhpr.robot import Robot
from krhpr.trajectory.clearance import PLATFORM, REDUNDANT, Segment, pairs
from krhpr.workspace.limits import WorkspaceLimits

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Bodies:
    """The pairs of `clearances`: which are of two bodies, and the least distances of their axes."""

    names: tuple[str, ...]
    """Of both links of each pair."""
    chosen: NDArray[np.intp]
    """The pairs of two bodies, by their places among the distances."""
    least: Floats
    """For each of them: both radii and the clearance (m)."""

    @classmethod
    def of(cls, robot: Robot, limits: WorkspaceLimits) -> Bodies:
        """Those of a robot: radii of its file first, then of the limits."""
        clearance = limits.beside(robot.limits).clearance or 0.0
        names, chosen, least = [], [], []
        for place, pair in enumerate(pairs(robot)):
            names.append(pair.name)
            sizes = [_radius(robot, limits, one) for one in (pair.first, pair.second)]
            if None in sizes:
                continue
            chosen.append(place)
            least.append(sum(size for size in sizes if size is not None) + clearance)
        return cls(tuple(names), np.array(chosen, dtype=np.intp), np.array(least))

    def margins(self, distances: Floats) -> tuple[Floats, NDArray[np.int16]]:
        """(the least distance beyond what is needed (n,), of which pair), from the distances (n, pairs)."""
        every = len(self.chosen) == distances.shape[-1]
        beyond = (distances if every else distances[:, self.chosen]) - self.least
        least, place = least_of(beyond)
        return least, self.chosen[place].astype(np.int16)


TIE = 1e-9
"""Margins (m, rad) that differ by less are the same: of several, the first is named, on every machine."""


def least_of(margins: Floats) -> tuple[Floats, NDArray[np.intp]]:
    """The least of each row (n, k), and the first place that has it; NaN counts as less than any number."""
    least = margins.min(axis=-1)  # NaN where there is one
    place = np.asarray(~(margins > (least + TIE)[:, None])).argmax(axis=-1)
    return least, place


def _radius(robot: Robot, limits: WorkspaceLimits, link: Segment) -> float | None:
    """The radius of a link; None where it is no body."""
    radii = robot.limits.link_radii
    name, leg = link.name.partition(" of leg ")[0], link.start[0]
    if link.name.startswith(PLATFORM):
        if not limits.edges:
            return None
        if PLATFORM in radii:
            return max(radii[PLATFORM])
        known = [radius for values in radii.values() for radius in values]
        return limits.radius if limits.radius is not None else max(known, default=None)
    name = robot.redundant_link if name == REDUNDANT else name
    return radii[name][leg] if name in radii else limits.radius
