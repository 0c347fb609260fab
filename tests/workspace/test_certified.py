"""Cubes of positions that are proven: whatever lies inside keeps every limit."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import krhpr
from krhpr.errors import WorkspaceError
from krhpr.robot import Robot
from krhpr.workspace import Certifier, Cube, Examiner, WorkspaceLimits, section_1_7
from krhpr.workspace.certified import _Leg

BETA = np.radians(97)
PROVEN = ("spatial_rrr_a", "spatial_r_fivebar_a", "spatial_r_fivebar_b", "spatial_rrr_c")


def certifier(robot: Robot, **changes: Any) -> tuple[Certifier, Examiner]:
    examiner = Examiner(robot, replace(section_1_7(robot), **changes))
    return Certifier(examiner, robot.home.redundant), examiner


def inside(source: np.random.Generator, count: int) -> np.ndarray:
    """Points of the unit ball, half of them on its surface."""
    found = source.normal(size=(count, 3))
    found /= np.linalg.norm(found, axis=-1, keepdims=True)
    found[::2] *= source.uniform(size=(len(found[::2]), 1)) ** (1 / 3)
    return found


@pytest.mark.parametrize("name", PROVEN)
def test_points_of_a_leg_go_no_farther_than_is_said(name: str) -> None:
    """Against the kinematics at poses all over the workspace, with balls of every size; and bounds are near
    to what happens somewhere, or they would be no use."""
    robot, source = krhpr.load(name), np.random.default_rng(4)
    redundant = np.asarray(robot.home.redundant)
    labels = tuple(robot.signature("link_points").outputs[0].labels)

    def points(p: np.ndarray) -> np.ndarray:
        Q = np.broadcast_to(np.eye(3), (len(p), 3, 3))
        s = robot.end_points(p, Q, redundant)
        return np.asarray(robot.link_points(p, Q, s, robot.inverse(p, Q, redundant)).points)

    tightest: dict[str, float] = {}
    for radius in (1e-4, 0.01, 0.03, 0.08):
        centres = source.uniform((-0.4, -0.4, 0.1), (0.4, 0.4, 0.6), (300, 3))
        before = points(centres)
        legs = _Leg.of(labels, before, radius)
        where = np.isfinite(before).all(axis=(-3, -2, -1)) & legs.known.all(axis=-1)
        steps = radius * inside(source, len(centres))
        after = points(centres + steps)
        assert np.isfinite(after[where]).all()  # it stays within reach
        ways = np.linalg.norm(after - before, axis=-1)[where]
        assert (ways <= legs.moved[where] + 1e-12).all()
        seen = np.linalg.norm(after - before - steps[:, None, None], axis=-1)[where]
        assert (seen <= legs.drift[where] + 1e-12).all()
        for at, label in enumerate(labels):
            moving = legs.moved[where][..., at] > 0
            share = (ways[..., at] / np.where(moving, legs.moved[where][..., at], 1)).max(initial=0.0)
            tightest[label] = max(tightest.get(label, 0.0), float(share))
    assert tightest["S"] > 0.999 and tightest["E"] > 0.9


@pytest.mark.parametrize("name", PROVEN)
def test_distances_of_bodies_change_no_more_than_is_said(name: str) -> None:
    robot, source = krhpr.load(name), np.random.default_rng(7)
    found, _ = certifier(robot)

    def state(p: np.ndarray) -> tuple[np.ndarray, ...]:
        Q, redundant = found._rest(len(p))
        return p, Q, robot.end_points(p, Q, redundant), robot.inverse(p, Q, redundant)

    tightest = 0.0
    for radius in (1e-4, 0.01, 0.05):
        centres = source.uniform((-0.4, -0.4, 0.1), (0.4, 0.4, 0.6), (300, 3))
        at = state(centres)
        legs = _Leg.of(found._labels, robot.link_points(*at).points, radius)
        where = np.isfinite(at[-1]).all(axis=(-2, -1)) & legs.known.all(axis=-1)
        said = np.minimum(found._changes(legs.moved, radius), found._changes(legs.drift, 0.0))[where]
        after = robot.clearances(*state(centres + radius * inside(source, len(centres))))
        change = np.abs(after - robot.clearances(*at))[where]
        assert (change <= said + 1e-12).all()
        tightest = max(tightest, float((change / np.maximum(said, 1e-12)).max()))
    assert tightest > 0.9


@pytest.mark.parametrize("name", PROVEN)
def test_in_a_ball_that_is_proven_every_limit_is_kept(name: str) -> None:
    robot, source = krhpr.load(name), np.random.default_rng(5)
    found, examiner = certifier(robot)
    holds = 0
    for radius in (0.003, 0.01, 0.03):
        centres = source.uniform((-0.3, -0.3, 0.1), (0.3, 0.3, 0.55), (400, 3))
        for _ in range(5):
            proven = found.balls(centres, radius)
            holds += int(proven.sum())
            p = (centres + radius * inside(source, len(centres)))[proven]
            Q, redundant = found._rest(len(p))
            assert examiner.examine(p, Q, redundant).free.all()
    assert holds > 100


ALONE: dict[str, dict[str, Any]] = {
    "first axis": {"axis_distance": 0.2, "elbow": None, "cone": None, "radius": None, "lowest": None},
    "base": {"lowest": 0.3, "axis_distance": None, "elbow": None, "cone": None, "radius": None},
    "elbow": {"elbow": (np.radians(60), np.radians(145)), "cone": None, "radius": None, "lowest": None},
    "spherical joint": {"cone": np.radians(125), "elbow": None, "radius": None, "lowest": None},
    "interference": {"radius": 0.012, "cone": None, "elbow": None, "lowest": None},
}
"""Limits of which one alone matters."""


@pytest.mark.parametrize("reason", ALONE)
def test_in_the_largest_ball_that_is_proven_each_limit_is_kept(reason: str) -> None:
    """The radius is halved between what is proven and what is not, for each centre; then the ball is searched
    for its worst point, from many on its surface and with steps along it towards the least margin."""
    found, examiner = certifier(krhpr.load("spatial_rrr_a"), **ALONE[reason])
    source = np.random.default_rng(6)
    centres = source.uniform((-0.25, -0.25, 0.15), (0.25, 0.25, 0.5), (120, 3))
    low, high = np.zeros(len(centres)), np.full(len(centres), 0.15)
    for _ in range(12):
        middle = (low + high) / 2
        proven = np.array([found.balls(c[None], r)[0] for c, r in zip(centres, middle, strict=True)])
        low, high = np.where(proven, middle, low), np.where(proven, high, middle)
    some = (low > 1e-3) & (low < 0.12)
    centres, radii = centres[some], low[some]
    assert len(centres) > 15

    def margin(p: np.ndarray) -> np.ndarray:
        margins = examiner.examine(p, *found._rest(len(p)))
        assert margins.free.all()
        values = np.array(list(margins.values.values()))
        return np.asarray(np.fmin.reduce(values, axis=0))

    count = 40
    centres, radii = np.repeat(centres, count, axis=0), np.repeat(radii, count)[:, None]
    directions = source.normal(size=centres.shape)
    directions /= np.linalg.norm(directions, axis=-1, keepdims=True)
    before = margin(centres)
    for _ in range(4):
        worst = margin(centres + radii * directions)
        slope = np.stack(
            [
                (margin(centres + radii * (0.99 * directions + 0.01 * axis) / 1.01) - worst) / 0.01
                for axis in np.eye(3)
            ],
            axis=-1,
        )
        slope /= np.linalg.norm(slope, axis=-1, keepdims=True) + 1e-30
        directions = directions - 0.5 * slope
        directions /= np.linalg.norm(directions, axis=-1, keepdims=True)
    spent = ((before - worst) / before).max()
    assert spent > 0.3  # not so careful that it is no use


def test_the_largest_cube() -> None:
    """Proven, every node of a fine grid in it is free, and not far beyond its faces one is not."""
    found, examiner = certifier(krhpr.load("spatial_rrr_a"))
    cube = found.largest((0.0, 0.0, 0.35), 0.5, share=0.05, balls=20_000)
    assert 0.15 < cube.side < 0.3 and found.proves(cube).holds
    at = np.linspace(-0.5, 0.5, 24)

    def free(side: float) -> bool:
        p = np.asarray(cube.centre) + side * np.stack(np.meshgrid(at, at, at), axis=-1).reshape(-1, 3)
        return bool(examiner.examine(p, *found._rest(len(p))).free.all())

    assert free(cube.side) and not free(1.5 * cube.side)


def test_what_stops_a_cube() -> None:
    found, _ = certifier(krhpr.load("spatial_r_fivebar_a"))
    proof = found.proves(Cube((0.0, 0.0, 0.35), 0.6))
    assert not proof.holds and proof.where is not None and " of leg " in proof.stopped
    few = found.proves(Cube((0.0, 0.0, 0.35), 0.1), most=10)
    assert (few.holds, few.stopped, few.where) == (False, "", None)
    assert found.largest((0.6, 0.0, 0.35), 0.1).side == 0.0


@pytest.mark.parametrize("reason", ALONE)
def test_each_limit_alone_stops_at_its_place(reason: str) -> None:
    """The edge up to which a cube is proven is that at which its worst corner breaks the limit, within what
    the finest balls leave; limits are found by halving along the diagonals."""
    found, examiner = certifier(krhpr.load("spatial_rrr_a"), **ALONE[reason])
    centre = np.array([0.0, 0.0, 0.35])
    cube = found.largest(centre, 0.8, share=0.01, balls=20_000)
    at = np.linspace(-0.5, 0.5, 25)
    grid = np.stack(np.meshgrid(at, at, at), axis=-1).reshape(-1, 3)
    low, high = 0.0, 0.8
    while high - low > 0.002:
        middle = (low + high) / 2
        margins = examiner.examine(centre + middle * grid, *found._rest(len(grid)))
        low, high = (middle, high) if margins.free.all() else (low, middle)
    stops = examiner.examine(centre + (high + 0.004) * grid, *found._rest(len(grid)))
    worst = int(np.argmin(stops.free))
    assert reason in examiner.name(int(stops.stops[worst]), int(stops.which[worst]))
    assert 0.5 * low < cube.side < high


def test_robots_and_limits_without_a_proof() -> None:
    with pytest.raises(WorkspaceError, match="a proof for RRR and R"):
        Certifier(Examiner(krhpr.load("spatial_prr_a"), WorkspaceLimits()), BETA)
    robot = krhpr.load("examples/my_robot.yaml")
    with pytest.raises(WorkspaceError, match="its file limits actuators; check grids instead"):
        Certifier(Examiner(robot, WorkspaceLimits()), BETA)
