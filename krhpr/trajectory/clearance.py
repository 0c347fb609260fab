"""Distances between links: straight segments between joints, of the legs, the redundant links and the
platform."""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import combinations
from typing import Any

import numpy as np
from numpy.typing import NDArray

from krhpr.robot import Robot
from krhpr.trajectory.terms import Bounds

Floats = NDArray[np.float64]

PLATFORM = "platform"
REDUNDANT = "redundant link"


@dataclass(frozen=True)
class Segment:
    """A link between two points: places are (leg, row in `points`), row -1 the joint on the platform."""

    name: str
    start: tuple[int, int]
    end: tuple[int, int]
    link: str = ""
    """As `robot.limits.link_radii` names it."""

    def radius(self, robot: Robot) -> float:
        """Of the link as a cylinder, m; zero where none is given."""
        radii = robot.limits.link_radii.get(self.link)
        return 0.0 if radii is None else radii[self.start[0]]

    def number(self, rows: int, which: int) -> int:
        """One end by its number: the `rows` points of each leg, then the joints on the platform."""
        leg, row = (self.start, self.end)[which]
        return 3 * rows + leg if row < 0 else rows * leg + row

    def end_of(self, points: Any, which: int) -> Any:
        """One end as a CasADi column, from the outputs of `link_points`."""
        leg, row = (self.start, self.end)[which]
        return (points[3][leg, :] if row < 0 else points[leg][row, :]).T

    def ends(self, points: Floats, attachment: Floats) -> tuple[Floats, Floats]:
        """Both ends (..., 3), from the arrays of `link_points`."""
        places = [
            attachment[..., leg, :] if row < 0 else points[..., leg, row, :]
            for leg, row in (self.start, self.end)
        ]
        return places[0], places[1]


@dataclass(frozen=True)
class Pair:
    """Two links that no joint joins."""

    first: Segment
    second: Segment
    least: float = 0.0
    """The least distance (m) between their axes that is to be kept."""

    @property
    def name(self) -> str:
        """Both names."""
        return f"{self.first.name} and {self.second.name}"


def segments(robot: Robot) -> tuple[Segment, ...]:
    """The links of the three legs, their redundant links where these have a length, and the platform's
    edges."""
    labels = robot.signature("link_points").outputs[0].labels
    found = [
        Segment(f"{name} of leg {leg + 1}", (leg, labels.index(start)), (leg, labels.index(end)), name)
        for leg in range(3)
        for name, _, start, end in robot.links
    ]
    if not robot.redundant_link:
        return tuple(found)
    last = len(labels) - 1  # S_i
    found += [
        Segment(f"{REDUNDANT} of leg {leg + 1}", (leg, last), (leg, -1), robot.redundant_link)
        for leg in range(3)
    ]
    if robot.identifier.endswith("_a"):
        found += [
            Segment(f"{PLATFORM} edge {i + 1}-{j + 1}", (i, -1), (j, -1), PLATFORM)
            for i, j in combinations(range(3), 2)
        ]
    return tuple(found)


def pairs(robot: Robot) -> tuple[Pair, ...]:
    """Every pair of links that no joint joins; of spatial robots in the order of `clearances`.

    A joint may be in the middle of a link, as on the distal link of a five-bar: links whose axes meet
    wherever the robot stands are joined.
    """
    if robot.link_pairs:
        rows = len(robot.signature("link_points").outputs[0].labels)
        known = {(one.number(rows, 0), one.number(rows, 1)): one for one in segments(robot)}
        return tuple(Pair(known[a, b], known[c, d]) for a, b, c, d in robot.link_pairs)
    found = []
    for a, b in combinations(segments(robot), 2):
        if not {a.start, a.end} & {b.start, b.end}:
            found.append(Pair(a, b))
    p, Q, redundant = _around_home(robot)
    theta = robot.inverse(p, Q, redundant)
    points = robot.link_points(p, Q, robot.end_points(p, Q, redundant), theta)
    gaps = np.linalg.norm(separations(robot, tuple(found), points.points, points.attachment), axis=-1)
    apart = np.nanmax(gaps, axis=1) > 1e-9 * np.nanmax(np.abs(points.points))
    return tuple(pair for pair, there in zip(found, apart, strict=True) if there)


def kept_apart(robot: Robot, bounds: Bounds) -> tuple[Pair, ...]:
    """The pairs with a least distance: that of the limits between axes, and that of the robot's file between
    the surfaces of links, which have its radii.  None in the plane, where links pass above one another.
    """
    limits = robot.limits
    of_file = bool(limits.link_radii) or limits.clearance is not None
    if robot.planar or not (bounds.clearance or of_file):
        return ()
    found = []
    for pair in pairs(robot):
        radii = pair.first.radius(robot) + pair.second.radius(robot)
        between = radii + (limits.clearance or 0.0) if of_file else 0.0
        found.append(replace(pair, least=max(between, bounds.clearance or 0.0)))
    return tuple(pair for pair in found if pair.least > 0)


def _around_home(robot: Robot, count: int = 8) -> tuple[Floats, Floats, Floats]:
    """Poses and redundant coordinates at the robot's home and a little away from it, always the same ones."""
    from scipy.spatial.transform import Rotation

    source = np.random.default_rng(0)
    home = robot.home
    p = np.asarray(home.p) * (1 + 0.03 * source.uniform(-1, 1, (count, 3)))
    turns = Rotation.from_rotvec(0.05 * source.uniform(-1, 1, (count, 3))).as_matrix()
    redundant = np.asarray(home.redundant) * (1 + 0.03 * source.uniform(-1, 1, (count, 3)))
    p[0], turns[0], redundant[0] = home.p, np.eye(3), home.redundant
    return p, np.asarray(home.orientation) @ turns, redundant


def separation(first: tuple[Floats, Floats], second: tuple[Floats, Floats]) -> Floats:
    """The shortest vectors (..., 3) from points of the second segments to points of the first ones."""
    a, u = first[0], first[1] - first[0]
    b, v = second[0], second[1] - second[0]
    w = a - b
    uu, uv, vv = (np.einsum("...i,...i", x, y) for x, y in ((u, u), (u, v), (v, v)))
    uw, vw = np.einsum("...i,...i", u, w), np.einsum("...i,...i", v, w)
    det = uu * vv - uv**2
    inner = np.clip(
        np.where(det > 1e-12 * uu * vv, (uv * vw - vv * uw) / np.where(det > 0, det, 1.0), 0.0), 0, 1
    )
    best, least = None, None
    # the closest points: inside both, or with one at an end
    for s in (inner, np.zeros_like(inner), np.ones_like(inner)):
        t = np.clip((uv * s + vw) / vv, 0, 1)
        s = np.clip((uv * t - uw) / uu, 0, 1)
        gap = w + s[..., None] * u - t[..., None] * v
        size = np.einsum("...i,...i", gap, gap)
        if best is None or least is None:
            best, least = gap, size
        else:
            best = np.where((size < least)[..., None], gap, best)
            least = np.minimum(size, least)
    return np.asarray(best)


def separations(robot: Robot, of: tuple[Pair, ...], points: Floats, attachment: Floats) -> Floats:
    """The shortest vectors between the links of each pair (pairs, ..., 3)."""
    return np.stack(
        [separation(pair.first.ends(points, attachment), pair.second.ends(points, attachment)) for pair in of]
    )
