"""What a design is worth, against counting by hand and against the maps of the workspace."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import krhpr
from krhpr import workspace
from krhpr.design import DesignSpace, Grid, Objective, Problem, Variable, connected, largest_cube
from krhpr.design.connected import cut
from krhpr.design.evaluation import Evaluation, length
from krhpr.workspace import Box, Stop, TiltTorsion, Workspace

ROBOT = krhpr.load("spatial_rrr_a")
COARSE = Grid(step=0.06, angle=np.pi / 6, balls=2000)


def problem(**changes: Any) -> Problem:
    space = DesignSpace(ROBOT, [Variable("redundant", 1.0, 2.5)])
    given = {
        "objectives": (Objective.VOLUME,),
        "limits": workspace.section_1_7(ROBOT),
        "grid": COARSE,
        **changes,
    }
    return Problem(space, **given)


def made(free: np.ndarray, family: Any = None, *axes: np.ndarray) -> Workspace:
    """A grid with given free nodes."""
    family = Box() if family is None else family
    given = axes or tuple(0.1 * np.arange(n) for n in free.shape)
    job: Any = SimpleNamespace(family=family, axes=family.axes(*given))
    stops = np.where(free, Stop.NONE, Stop.BODIES).astype(np.int8)

    class Grids(Workspace):
        @property
        def free(self) -> Any:
            return self.arrays["stops"] == Stop.NONE

    return Grids(job, {"stops": stops, "eta": np.zeros((*free.shape, 3))})


def test_only_what_is_connected_counts() -> None:
    free = np.zeros((7, 3, 3), dtype=bool)
    free[:3], free[4:] = True, True
    here = connected(made(free), (0.1, 0.1, 0.1))["stops"] == Stop.NONE
    assert here[:3].all() and not here[3:].any()
    there = connected(made(free), (0.47, 0.1, 0.1))["stops"] == Stop.NONE
    assert there[4:].all() and not there[:4].any()
    between = connected(made(free), (0.25, 0.1, 0.1))["stops"] == Stop.NONE  # a corner of its cell is free
    assert between[:3].all() and not between[4:].any()
    assert not (connected(made(free), (0.3, 0.1, 0.1))["stops"] == Stop.NONE).any()


def test_angles_go_round() -> None:
    """Two parts that meet at a torsion of 180 degrees are one; in positions they are two."""
    axes = (np.linspace(-np.pi, np.pi, 9), np.linspace(0, 2 * np.pi, 9), np.linspace(0, np.pi, 5))
    free = np.zeros((9, 9, 5), dtype=bool)
    free[:3], free[6:] = True, True
    found = connected(made(free, TiltTorsion(), *axes), (-np.pi / 2, 0.0, 0.0))
    assert (found["stops"] == Stop.NONE).sum() == free.sum()
    flat = connected(made(free), (0.0, 0.0, 0.0))
    assert (flat["stops"] == Stop.NONE).sum() == free[:3].sum()


@pytest.mark.parametrize("seed", range(6))
def test_the_largest_cube_of_nodes_against_counting(seed: int) -> None:
    free = np.random.default_rng(seed).uniform(size=(9, 8, 10)) > 0.04 * (1 + seed)
    grid = made(free)
    found = largest_cube(grid)
    best = -1
    for i, j, k in np.ndindex(*free.shape):
        for half in range(5):
            low, high = np.array([i, j, k]) - half, np.array([i, j, k]) + half + 1
            if (low < 0).any() or (high > free.shape).any() or not free[i, j, k]:
                break
            if not free[low[0] : high[0], low[1] : high[1], low[2] : high[2]].all():
                break
            best = max(best, half)
    assert np.isclose(found.side, 0.2 * best)
    at = [round(x / 0.1) for x in found.centre]
    half = round(found.side / 0.2)
    part = tuple(slice(x - half, x + half + 1) for x in at)
    assert free[part].all() and free[part].shape == (2 * half + 1,) * 3


def test_no_free_node_makes_no_cube() -> None:
    assert largest_cube(made(np.zeros((3, 3, 3), dtype=bool))).side == 0.0


def test_whether_the_grid_cuts_the_workspace() -> None:
    free = np.zeros((5, 5, 5), dtype=bool)
    free[1:4, 1:4, 1:4] = True
    assert not cut(made(free))
    free[2, 2, 0] = True
    assert cut(made(free)) and cut(made(free), -0.5) and not cut(made(free), -0.05)


def test_volumes_are_those_of_boundaries() -> None:
    """Where rays from the middle see everything: both are estimates of the same volume."""
    fine = problem(grid=Grid(step=0.03, angle=np.pi / 18, balls=100))
    positions = fine.positions(ROBOT)
    layers = workspace.translational(
        ROBOT, np.linspace(0.0, 0.9, 31), limits=fine.limits, step=0.004, rays=72, farthest=0.8
    )
    by_rays, by_nodes = workspace.volume(layers), workspace.volume(positions)
    assert by_nodes.value > by_rays.value - by_rays.error - by_nodes.error  # rays do not see behind a gap
    everything = fine.orientations(ROBOT.with_home(ROBOT.home.p, np.radians(97)))
    free = replace(fine, limits=workspace.WorkspaceLimits()).orientations(ROBOT)
    assert np.isclose(workspace.volume(free).value, 1.0, atol=2e-3)  # all there are
    assert 0.3 < workspace.volume(everything).value < 0.6


def test_results_are_those_of_the_grid() -> None:
    at = problem()
    found = at.evaluate([1.7])
    robot = at.space.robot_of([1.7])
    positions, orientations = at.positions(robot), at.orientations(robot)
    assert found.works and set(found.results) == set(Objective)
    assert found.results[Objective.VOLUME] == workspace.volume(positions).value
    assert found.results[Objective.ORIENTATIONS] == workspace.volume(orientations).value
    # indices by hand at the node that is worst
    worst = np.nanmax(np.where(positions.free, positions["eta"][..., 1], np.nan))
    turned = np.nanmax(np.where(orientations.free, orientations["eta"][..., 1], np.nan))
    assert found.results[Objective.ETA_2] == max(worst, turned)
    place = np.unravel_index(
        np.nanargmax(np.where(positions.free, positions["eta"][..., 1], np.nan)), positions.free.shape
    )
    p = np.array([axis.values[k] for axis, k in zip(positions.job.axes, place, strict=True)])
    redundant = np.array(robot.home.redundant)
    theta, s = robot.inverse(p, np.eye(3), redundant), robot.end_points(p, np.eye(3), redundant)
    J, K = robot.jacobians(p, np.eye(3), s, theta)
    assert np.isclose(np.linalg.norm(np.linalg.solve(J, K)[3:], 2), worst)
    assert np.isclose(length(robot), 3 * (0.05 + 0.3 + 0.45 + 0.05))
    assert at.evaluate([1.7]) == found


def test_the_cube_is_proven_and_not_larger_than_what_is_free() -> None:
    at = problem(grid=Grid(step=0.04, balls=4000))
    found = at.evaluate([1.7])
    assert found.proven and found.cube is not None and found.results[Objective.BOX] == found.cube.side
    checked = largest_cube(at.positions(at.space.robot_of([1.7])))
    assert checked.centre == found.cube.centre
    assert 0.4 * checked.side < found.cube.side < checked.side + 0.08
    robot = krhpr.load("spatial_prr_a")
    other = Problem(
        DesignSpace(robot, [Variable("R_p", 0.1, 0.2)]),
        (Objective.BOX,),
        workspace.section_1_7(robot),
        COARSE,
    )
    assert not other.evaluate(other.space.own).proven


def test_plain_values_and_back() -> None:
    import json
    import pickle

    at = problem()
    for values in ([1.7], [1.01]):
        found = at.evaluate(values)
        assert Evaluation.from_json(json.loads(json.dumps(found.as_json()))) == found
        assert pickle.loads(pickle.dumps(found)) == found
