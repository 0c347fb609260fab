"""Cubes of positions in which every pose is proven to keep every limit, not only those that were looked at.

The platform keeps its orientation and its redundant coordinates, so that S_i, the redundant links and the
platform's edges move as O' does. Where S_i moves by rho at most, the joints of its leg move by so many times
rho at most (`_Leg`), and a limit that is kept at the centre of a ball by more than that is kept in the whole
ball. A cube is cut into smaller ones until each lies in such a ball.

Legs whose plane turns about the first axis are known: RRR, and the five-bar R(RR-RRR). The proof is one with
real numbers; those of a machine are off by some 1e-15 m, and `ROUNDING` is kept for them.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from krhpr.errors import WorkspaceError
from krhpr.trajectory.clearance import Segment, pairs
from krhpr.workspace.limits import Stop, first_axis_turns
from krhpr.workspace.margins import Examiner

Floats = NDArray[np.float64]
Flags = NDArray[np.bool_]

ROUNDING = 1e-9
"""What is kept beyond every limit for rounding, in metres and radians."""
FINEST = 256
"""Parts of an edge below which a cube is not cut."""
MOST = 100_000
"""Balls that are looked at for one cube before the answer is that it is not proven."""
FIRST = 4
"""Parts of an edge to begin with."""

_CHAINS = {
    ("fixed", "proximal", "distal"): False,
    ("fixed", "proximal", "crank", "rod", "distal"): True,
}
"""Kinds of the links of a leg, and whether it has a crank and a rod."""


@dataclass(frozen=True)
class Cube:
    """Positions of O' around a centre."""

    centre: tuple[float, float, float]
    side: float
    """Of an edge, m; 0 where not even the centre is free."""


@dataclass(frozen=True)
class Proof:
    """What came of the attempt to prove a cube."""

    holds: bool
    balls: int
    """How many were looked at."""
    stopped: str = ""
    """The limit that is not kept at `where`; empty where there is none such, but balls got too small."""
    where: tuple[float, float, float] | None = None


class Certifier:
    """Proves cubes of positions for a robot with constant redundant coordinates and orientation."""

    def __init__(self, examiner: Examiner, redundant: ArrayLike, Q: ArrayLike | None = None) -> None:
        """With the limits of an examiner.

        Raises:
            WorkspaceError: a sub-leg or a limit for which there is no proof.
        """
        robot = examiner.robot
        why = _unknown(examiner)
        if why:
            raise WorkspaceError(
                f"{robot.name}: cubes of positions cannot be proven: {why}; check grids instead"
            )
        self._examiner = examiner
        self._redundant = np.broadcast_to(np.asarray(redundant, dtype=float), (3,))
        self._Q = np.eye(3) if Q is None else np.asarray(Q, dtype=float)

    def proves(self, cube: Cube, most: int = MOST) -> Proof:
        """Whether every pose of a cube keeps every limit; False may also mean that it could not be shown."""
        half = cube.side / 2 / FIRST
        offsets = half * (2 * np.arange(FIRST) - FIRST + 1)
        grid = np.stack(np.meshgrid(offsets, offsets, offsets, indexing="ij"), axis=-1).reshape(-1, 3)
        centres = np.asarray(cube.centre) + grid
        looked = 0
        while len(centres):
            looked += len(centres)
            if looked > most:
                return Proof(False, looked)
            found = self._examiner.examine(centres, *self._rest(len(centres)))
            if not found.free.all():
                first = int(np.argmin(found.free))
                what = self._examiner.name(int(found.stops[first]), int(found.which[first]))
                x, y, z = centres[first].tolist()
                return Proof(False, looked, what, (x, y, z))
            left = centres[~self.balls(centres, half * np.sqrt(3.0))]
            half /= 2
            if len(left) and half < cube.side / 2 / FINEST:
                return Proof(False, looked)
            corners = half * np.stack(np.meshgrid(*[(-1.0, 1.0)] * 3, indexing="ij"), axis=-1).reshape(-1, 3)
            centres = (left[:, None] + corners).reshape(-1, 3)
        return Proof(True, looked)

    def largest(self, centre: ArrayLike, most: float, *, share: float = 0.02, balls: int = MOST) -> Cube:
        """The largest cube around a centre that is proven with so many balls, up to the edge `most` and
        within a share of it."""
        x, y, z = np.asarray(centre, dtype=float).tolist()
        proven, beyond = 0.0, 1.0
        if self.proves(Cube((x, y, z), most), balls).holds:
            return Cube((x, y, z), most)
        while beyond - proven > share:
            middle = (proven + beyond) / 2
            if self.proves(Cube((x, y, z), middle * most), balls).holds:
                proven = middle
            else:
                beyond = middle
        return Cube((x, y, z), proven * most)

    def balls(self, centres: Floats, radius: float) -> Flags:
        """Whether all limits are kept wherever O' is within `radius` (m) of the centres (n, 3)."""
        robot, limits = self._examiner.robot, self._examiner.limits
        Q, redundant = self._rest(len(centres))
        s = robot.end_points(centres, Q, redundant, check_rotation=False)
        theta = robot.inverse(centres, Q, redundant, mode=self._examiner.mode, check_rotation=False)
        state = (centres, Q, s, theta)
        points = robot.link_points(*state, check_rotation=False).points
        legs = _Leg.of(self._labels, points, radius)
        holds = legs.known.all(axis=-1)
        if limits.lowest is not None:
            holds &= centres[:, 2] - radius >= limits.lowest + ROUNDING
        if limits.axis_distance is not None:
            holds &= (legs.axis - radius >= limits.axis_distance + ROUNDING).all(axis=-1)
        if limits.elbow is not None:
            low, high = limits.elbow
            holds &= ((legs.straight >= low + ROUNDING) & (legs.folded <= high - ROUNDING)).all(axis=-1)
        if limits.cone is not None or robot.limits.spherical is not None:
            found = self._examiner.examine(centres, Q, redundant, thorough=True)
            turned = (legs.turning * radius).max(axis=-1)
            holds &= found.values[Stop.SPHERICAL] >= turned + ROUNDING
        if len(self._examiner.bodies.chosen):
            # distances are the same to one who goes with the platform
            change = np.minimum(self._changes(legs.moved, radius), self._changes(legs.drift, 0.0))
            bodies = self._examiner.bodies
            distances = robot.clearances(*state, check_rotation=False)
            spare = distances[:, bodies.chosen] - bodies.least - change[:, bodies.chosen]
            holds &= (spare >= ROUNDING).all(axis=-1)
        return np.asarray(holds)

    def _changes(self, ways: Floats, platform: float) -> Floats:
        """By how much the distance of each pair of links changes at most (n, pairs), from the ways of the
        legs' points (n, 3, points) and of the joints on the platform."""
        every = ways.reshape(len(ways), -1)
        every = np.concatenate([every, np.full((len(ways), 3), platform)], axis=-1)
        first, second = (every[:, ends].max(axis=-1) for ends in self._ends)
        return np.asarray(first + second)

    def _rest(self, count: int) -> tuple[Floats, Floats]:
        """Orientations and redundant coordinates of so many poses."""
        return (
            np.broadcast_to(self._Q, (count, 3, 3)),
            np.broadcast_to(self._redundant, (count, 3)),
        )

    @cached_property
    def _labels(self) -> tuple[str, ...]:
        return tuple(self._examiner.robot.signature("link_points").outputs[0].labels)

    @cached_property
    def _pairs(self) -> Any:
        return pairs(self._examiner.robot)

    @cached_property
    def _ends(self) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
        """Both ends (pairs, 2) of the first and of the second link of each pair, by their numbers."""
        rows = len(self._labels)

        def numbers(link: Segment) -> list[int]:
            return [link.number(rows, 0), link.number(rows, 1)]

        first = np.array([numbers(pair.first) for pair in self._pairs], dtype=np.intp)
        second = np.array([numbers(pair.second) for pair in self._pairs], dtype=np.intp)
        return first, second


@dataclass(frozen=True)
class _Leg:
    """Of n poses and three legs: how far the joints go at most while S_i stays in a ball.

    A step of S_i of length 1 is v_t across the leg's plane and v_i in it. Across, a point at the distance
    r_X from the first axis goes v_t r_X / r, with r that of S_i. In the plane |w| = l_v is constant, so that
    E, at right angles to u, goes v_i / sin(elbow) at most; a point on the line of w goes as its ends do. For
    a crank with its rod the same holds with P in place of S_i. Each bound is taken with the least r and sine
    in the ball: r changes as S_i does at most, and angles follow from the distances |S - c| and |P - c|.
    """

    known: Flags
    """Whether the leg keeps its working mode in the ball (n, 3): it neither stretches nor folds, and S_i does
    not reach the first axis."""
    axis: Floats
    """Distance of S_i from the first axis at the centre (n, 3)."""
    straight: Floats
    folded: Floats
    """The least and the largest elbow angle in the ball (n, 3)."""
    turning: Floats
    """By what angle the last link turns at most for a unit of S_i's way (n, 3), rad/m."""
    moved: Floats
    """How far each point of `link_points` goes at most (n, 3, points), m."""
    drift: Floats
    """The same as seen from the platform, on which S_i stands still."""

    @classmethod
    def of(cls, labels: tuple[str, ...], points: Floats, radius: float) -> _Leg:
        def at(name: str) -> Floats:
            return points[:, :, labels.index(name)]

        base, c, e, s = at("A"), at("c"), at("E"), at("S")
        along = (c - base) / np.linalg.norm(c - base, axis=-1, keepdims=True)

        def from_axis(point: Floats) -> Floats:
            return _norm(np.cross(point - base, along))

        axis = from_axis(s)
        nearest = axis - radius
        l_u, l_v = _norm(e - c), _norm(s - e)
        straight, folded, sine = _angles(_norm(s - c), radius, l_u, l_v)
        known = (nearest > 0) & (sine > 0)
        with np.errstate(divide="ignore", invalid="ignore"):
            bend = np.where(known, 1 / sine, np.inf)  # of E in the plane, for a unit of v_i
            moved = {"S": np.full_like(axis, radius)}
            moved["E"] = radius * _points_way(from_axis(e), l_u, bend, nearest, radius)
            if "P" in labels:
                p, crank = at("P"), at("C")
                share = _norm(s - p) / l_v  # P = S + share (E - S)
                sway = np.abs(1 - share) + share * bend
                l_2, l_3 = _norm(crank - c), _norm(p - crank)
                out = np.abs(1 - share) * (axis + radius) + share * l_u
                moved["P"] = radius * _points_way(from_axis(p), out, sway, nearest, radius)
                *_, closed = _angles(_norm(p - c), moved["P"], l_2, l_3)
                known &= closed > 0
                swing = np.where(known, sway / closed, np.inf)
                moved["C"] = radius * _points_way(from_axis(crank), l_2, swing, nearest, radius)
            turning = np.where(known, np.maximum(1 / nearest, bend / l_v), np.inf)
            drift = {"S": np.zeros_like(axis), "E": radius * turning * l_v}
            if "P" in labels:
                drift |= {"P": share * drift["E"], "C": moved["C"] + radius}

        def every(ways: dict[str, Floats], fixed: float) -> Floats:
            whole = np.full(points.shape[:-1], fixed)
            for name, way in ways.items():
                whole[:, :, labels.index(name)] = np.where(known, way, np.inf)
            return whole

        return cls(known, axis, straight, folded, turning, every(moved, 0.0), every(drift, radius))


def _points_way(axis: Floats, most: Floats, sway: Floats, nearest: Floats, radius: float) -> Floats:
    """How far a point goes at most for a unit of S_i's way: `axis` is its distance from the first axis at the
    centre, `most` the largest there is, `sway` its way in the plane."""
    first = np.maximum(most / nearest, sway)
    return np.maximum(np.minimum(most, axis + first * radius) / nearest, sway)


def _angles(distance: Floats, change: Any, l_u: Floats, l_v: Floats) -> tuple[Floats, Floats, Floats]:
    """The least and the largest angle between two links, 0 where they are stretched, and the least sine of
    all between, while the distance of their ends changes by `change` at most; a sine of 0 where they can be
    stretched or folded."""
    ends = np.stack([distance + change, distance - change])
    cosine = (np.sign(ends) * ends**2 - l_u**2 - l_v**2) / (2 * l_u * l_v)
    inside = (np.abs(cosine) < 1).all(axis=0) & (ends[1] > 0)
    angle = np.arccos(np.clip(cosine, -1, 1))
    return angle[0], angle[1], np.where(inside, np.sin(angle).min(axis=0), 0.0)


def _norm(vector: Floats) -> Floats:
    return np.asarray(np.linalg.norm(vector, axis=-1))


def _unknown(examiner: Examiner) -> str:
    """Why there is no proof; empty where there is one."""
    robot = examiner.robot
    kinds = tuple(kind for _, kind, _, _ in robot.links)
    if kinds not in _CHAINS or not first_axis_turns(robot):
        return "there is a proof for RRR and R(RR-RRR) sub-legs alone"
    if robot.limits.actuators:
        return "its file limits actuators"
    if set(robot.limits.passive) - {"platform_joint"}:
        return "its file limits passive revolute joints"
    return ""
