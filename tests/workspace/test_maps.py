"""Maps: the thesis' numbers, marching against bisection and plain loops, choices, volumes."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given, strategies

import krhpr
from krhpr import workspace as W
from krhpr.errors import WorkspaceError
from krhpr.workspace.choices import Answer
from krhpr.workspace.trace import trace
from tests.support import ROOT

BETA = np.radians(97.0)
FLAGSHIP = "spatial_r_fivebar_a"
REFERENCE = json.loads((ROOT / "tests/reference/workspace.json").read_text("utf-8"))
UPRIGHT = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))


def degrees(*of: float) -> Any:
    return np.radians(np.arange(*of))


# -- the thesis ------------------------------------------------------------------------------------------


def test_tilt_of_section_1_7() -> None:
    robot = krhpr.load(REFERENCE["robot"])
    rays = 360 // REFERENCE["directions_every"]
    step = np.radians(REFERENCE["tilt_step"])
    for tracing in W.Tracing:
        found = W.orientational(robot, redundancy=BETA, torsions=[0.0], rays=rays, step=step, tracing=tracing)
        tilt = np.degrees(found["boundary"])
        assert tilt.max() == pytest.approx(REFERENCE["tilt_best"])
        assert tilt.min() == pytest.approx(REFERENCE["tilt_worst"])
        assert found["boundary"].reshape(3, -1) == pytest.approx(np.tile(found["boundary"][0, :8], (3, 1)))


def test_torsion_under_each_reading_of_the_bodies() -> None:
    robot = krhpr.load(REFERENCE["robot"])
    limits = W.section_1_7(robot)
    readings = {
        "span": limits,
        "span_without_cone": replace(limits, cone=None),
        "span_without_cone_and_edges": replace(limits, cone=None, edges=False),
    }
    for name, reading in readings.items():
        found = W.torsion(robot, redundancy=BETA, limits=reading)
        assert np.degrees(found.span) == pytest.approx(REFERENCE[name]), name
    # by the symmetry of the legs all three are stopped at once, and the first is named
    assert W.torsion(robot, redundancy=BETA).stopped_high == "spherical joint of leg 1"


def test_angles_of_tilt_and_torsion() -> None:
    """(1.41), (1.43) as they are printed, and the rotation about an axis."""
    rng = np.random.default_rng(1)
    psi, theta_c, phi = rng.uniform(-3, 3, (3, 30))
    Q = W.tilt_torsion(psi, theta_c, phi)
    for k in range(30):
        c, s = np.cos(phi[k]), np.sin(phi[k])
        x, y = np.cos(theta_c[k]), np.sin(theta_c[k])
        tilt = np.array(
            [
                [c + x**2 * (1 - c), x * y * (1 - c), y * s],
                [x * y * (1 - c), c + y**2 * (1 - c), -x * s],
                [-y * s, x * s, c],
            ]
        )
        turned = np.array(
            [[np.cos(psi[k]), -np.sin(psi[k]), 0], [np.sin(psi[k]), np.cos(psi[k]), 0], [0, 0, 1]]
        )
        assert Q[k] == pytest.approx(turned @ tilt)
        assert tilt @ [x, y, 0] == pytest.approx([x, y, 0])
    assert np.swapaxes(Q, 1, 2) @ Q == pytest.approx(np.tile(np.eye(3), (30, 1, 1)))


# -- boundaries ------------------------------------------------------------------------------------------


def test_bisection_finds_what_marching_finds() -> None:
    """Layers with hollows where S_i comes near to a first axis, and tilts at several torsions."""
    robot = krhpr.load(FLAGSHIP)
    cases: list[Callable[[W.Tracing], W.Workspace]] = [
        lambda how: W.translational(
            robot, [0.03, 0.1, 0.35, 0.6], redundancy=BETA, rays=72, farthest=0.7, tracing=how
        ),
        lambda how: W.orientational(
            robot, redundancy=BETA, torsions=degrees(-140, 50, 60), rays=60, tracing=how
        ),
    ]
    for case in cases:
        march, bisect = case(W.Tracing.MARCH), case(W.Tracing.BISECT)
        for name in ("boundary", "stops", "which", "redundant"):
            assert np.array_equal(march[name], bisect[name], equal_nan=True), name


@pytest.mark.parametrize("name", [FLAGSHIP, "spatial_rrr_a"])
@pytest.mark.parametrize("family", [W.Layers(), W.TiltTorsion()])
def test_slopes_are_those_of_margins(name: str, family: W.Family) -> None:
    """Between free poses, one step of the thesis apart: no margin changes by more, and some by half of it."""
    robot, source = krhpr.load(name), np.random.default_rng(0)
    examiner = W.Examiner(robot, W.section_1_7(robot))
    layers = isinstance(family, W.Layers)
    low, high = ((0.05, 0.0, 0.0), (0.6, 6.28, 0.8)) if layers else ((-2.5, 0.0, 0.0), (0.8, 6.28, 2.6))
    step = 0.001 if layers else np.radians(1)
    at = source.uniform(low, high, (20_000, 3))
    redundant = np.full((len(at), 3), BETA)
    here = examiner.examine(*family.poses(*at.T), redundant)
    there = examiner.examine(*family.poses(*(at + np.array([0.0, 0.0, step])).T), redundant)
    both = here.free & there.free
    largest = {
        stop: np.abs(value - there.values[stop])[both].max() / step / family.slopes[stop]
        for stop, value in here.values.items()
        if stop in family.slopes
    }
    assert len(largest) == 4 and both.sum() > 4000
    assert max(largest.values()) < 1 and max(largest.values()) > 0.5


def test_boundaries_by_plain_loops() -> None:
    robot = krhpr.load("spatial_rrr_a")
    found = W.translational(robot, [0.2, 0.45], redundancy=BETA, step=0.004, rays=9, farthest=0.8)
    examiner = W.Examiner(robot, W.section_1_7(robot))
    for i, h in enumerate((0.2, 0.45)):
        for j, direction in enumerate(W.directions(9)):
            steps = 0
            while True:
                d_p = 0.004 * steps
                p = np.array([[d_p * np.cos(direction), d_p * np.sin(direction), h]])
                at = examiner.examine(p, np.eye(3)[None], np.full((1, 3), BETA))
                if not at.free[0]:
                    break
                steps += 1
            assert found["boundary"][i, j] == pytest.approx(0.004 * (steps - 1))
            assert found["stops"][i, j] == at.stops[0]
            assert found["which"][i, j] == at.which[0]


gaps = strategies.lists(strategies.integers(0, 60), max_size=4)


@given(strategies.lists(gaps, min_size=1, max_size=4), strategies.integers(1, 20))
def test_no_gap_is_skipped(stopped: list[list[int]], coarse: int) -> None:
    """Rays with single nodes that are not free: margins are distances from the nearest."""
    at = np.arange(61.0)

    def look(rays: Any, steps: Any) -> Answer:
        room = np.array(
            [
                min((abs(step - gap) for gap in stopped[ray]), default=99)
                for ray, step in zip(rays, steps, strict=True)
            ],
            dtype=float,
        )
        stops = np.where(room == 0, W.Stop.BODIES, W.Stop.NONE).astype(np.int8)
        which = np.asarray(steps, dtype=np.int16)
        return Answer(stops, which, np.zeros((len(rays), 3)), np.where(room == 0, -np.inf, room))

    for how in W.Tracing:
        found = trace(look, len(stopped), at, how, coarse)
        wanted = [min(gaps, default=61) for gaps in stopped]
        assert found.steps.tolist() == [first - 1 for first in wanted]
        assert found.stops.tolist() == [int(W.Stop.BODIES) if gaps else 0 for gaps in stopped]
        assert [w for w, gaps in zip(found.which, stopped, strict=True) if gaps] == [
            min(g) for g in stopped if g
        ]


# -- choices ---------------------------------------------------------------------------------------------


def grid(redundancy: W.Redundancy, **changes: Any) -> W.Workspace:
    robot = krhpr.load(FLAGSHIP)
    family = W.TiltTorsion()
    axes = family.axes([0.0, 0.5], W.directions(6), degrees(0, 171, 10))
    return W.run(replace(W.GridMap(robot, W.section_1_7(robot), redundancy, family, axes), **changes))


def test_free_redundant_coordinates_add_to_constant_ones() -> None:
    values = np.radians([70.0, 97.0, 130.0])
    single = [grid(W.constant(value)).free for value in values]
    alike = grid(W.free(values, alike=True))
    assert np.array_equal(alike.free, np.any(single, axis=0))
    every = grid(W.free(values, best="first"))
    assert (every.free >= alike.free).all()
    assert alike.free.sum() > max(one.sum() for one in single)


@pytest.mark.parametrize("best", ["margin", "eta_1", "eta_2", "eta_3"])
def test_the_best_is_the_best(best: str) -> None:
    values = np.radians([75.0, 97.0, 120.0])
    made = grid(W.free(values, alike=True, best=best))
    robot, examiner = made.job.robot, made.job.examiner
    for place in [tuple(k) for k in np.argwhere(made.free)[::9]]:
        pose = made.job.family.poses(
            *(axis.values[[k]] for axis, k in zip(made.job.axes, place, strict=True))
        )
        scores = {}
        for value in values:
            redundant = np.full((1, 3), value)
            here = examiner.examine(*pose, redundant)
            if not here.free[0]:
                continue
            s = robot.end_points(*pose, redundant)
            at = (*pose, s, robot.inverse(*pose, redundant))
            scores[value] = here.least[0] if best == "margin" else -getattr(robot.indices(*at), best)[0]
        assert made["redundant"][place] == pytest.approx(max(scores, key=lambda value: scores[value]))


def test_reachable_and_dexterous() -> None:
    robot = krhpr.load(FLAGSHIP)
    family = W.Box()
    axes = family.axes(W.steps(-0.4, 0.4, 0.1), W.steps(-0.4, 0.4, 0.1), [0.25, 0.4])
    turned = W.tilt_torsion(
        np.zeros(5), np.radians([0.0, 0, 90, 180, 270]), np.radians([0.0, 40, 40, 40, 40])
    )
    nested = tuple(tuple(map(tuple, Q)) for Q in turned.tolist())
    job = W.GridMap(robot, W.section_1_7(robot), W.constant(BETA), family, axes)
    each = [W.run(replace(job, family=W.Box(tuple(map(tuple, Q.tolist()))))).free for Q in turned]
    reachable, dexterous = (
        W.run(replace(job, orientations=nested, variant=variant)) for variant in W.Variant
    )
    assert np.array_equal(reachable.free, np.any(each, axis=0))
    assert np.array_equal(dexterous.free, np.all(each, axis=0))
    assert 0 < dexterous.free.sum() < each[0].sum() < reachable.free.sum()
    with pytest.raises(WorkspaceError, match="indices are those of one orientation"):
        W.run(replace(job, orientations=nested, with_indices=True))


def test_indices_of_nodes() -> None:
    made = grid(W.constant(BETA), with_indices=True)
    eta = made["eta"]
    assert np.isnan(eta[~made.free]).all()
    place = tuple(np.argwhere(made.free)[-1])
    pose = made.job.family.poses(*(axis.values[[k]] for axis, k in zip(made.job.axes, place, strict=True)))
    robot, redundant = made.job.robot, np.full((1, 3), BETA)
    found = robot.indices(*pose, robot.end_points(*pose, redundant), robot.inverse(*pose, redundant))
    assert eta[place] == pytest.approx([found.eta_1[0], found.eta_2[0], found.eta_3[0]])
    ray = W.translational(robot, [0.35], redundancy=BETA, rays=4, farthest=0.7, step=0.01, with_indices=True)
    assert np.isfinite(ray["eta"]).all()
    assert ray["eta"].shape == (1, 4, 3)


# -- volumes ---------------------------------------------------------------------------------------------


def made_up(family: Any, axes: Any, boundary: Any) -> W.Workspace:
    job = W.BoundaryMap(krhpr.load("spatial_rrr_a"), W.WorkspaceLimits(), W.constant(BETA), family, axes)
    return W.Workspace(job, {"boundary": boundary, "stops": np.zeros(boundary.shape, dtype=np.int8)})


@pytest.mark.parametrize("step", [0.01, 0.001])
def test_volume_of_a_ball(step: float) -> None:
    family, radius = W.Layers(), 0.3
    axes = family.axes(W.steps(-radius, radius, step), W.directions(36), W.steps(0, 0.5, step))
    h = axes[0].values
    r = np.sqrt(np.maximum(radius**2 - h**2, 0))[:, None] + np.zeros(36)
    last_free = np.floor(r / step + 1e-9) * step
    made = made_up(family, axes, last_free)
    found = W.volume(made)
    assert found.unit == "m^3"
    assert abs(found.value - 4 / 3 * np.pi * radius**3) < 3 * found.error
    assert found.error < 10 * step * radius**2
    assert W.areas(made)[len(h) // 2] == pytest.approx(np.pi * radius**2, rel=4 * step)


def test_volume_of_all_orientations() -> None:
    family = W.TiltTorsion()
    axes = family.axes(np.linspace(-np.pi, np.pi, 19), W.directions(12), W.steps(0, np.pi, np.pi / 90))
    whole = made_up(family, axes, np.full((19, 12), axes[2].values[-1]))
    assert W.volume(whole).value == pytest.approx(1.0)
    half = made_up(family, axes, np.full((19, 12), axes[2].values[45]))
    assert abs(W.volume(half).value - 0.5) < 0.02


def test_volumes_converge_and_agree() -> None:
    """Under refinement, and of boundaries with grids of another kind."""
    robot = krhpr.load(FLAGSHIP)
    found = {}
    for step in (0.04, 0.02, 0.01):
        heights = np.linspace(0.2, 0.52, round(0.32 / step) + 1)
        made = W.translational(robot, heights, redundancy=BETA, rays=24, step=step, farthest=0.7)
        found[step] = W.volume(made)
    finest = found[0.01].value
    for step in (0.04, 0.02):
        assert abs(found[step].value - finest) < found[step].error
    assert found[0.01].error < found[0.02].error < found[0.04].error
    family = W.Box()
    axes = family.axes(W.steps(-0.6, 0.6, 0.04), W.steps(-0.6, 0.6, 0.04), np.linspace(0.2, 0.52, 9))
    cubes = W.volume(W.run(W.GridMap(robot, W.section_1_7(robot), W.constant(BETA), family, axes)))
    assert abs(cubes.value - finest) < 0.05 * finest


def test_a_volume_takes_more_than_one_layer() -> None:
    made = W.translational(krhpr.load("spatial_rrr_a"), [0.35], redundancy=BETA, rays=4, step=0.02)
    with pytest.raises(WorkspaceError, match="two values or more"):
        W.volume(made)
    assert W.areas(made).shape == (1,)


# -- what cannot be made ---------------------------------------------------------------------------------


def test_bodies_that_collide_at_home() -> None:
    robot = krhpr.load(FLAGSHIP)
    thick = replace(W.section_1_7(robot), radius=0.09)
    with pytest.raises(WorkspaceError) as caught:
        W.translational(robot, [0.35], limits=thick, rays=4)
    for word in ("interference of", "already at home", "m too near", "make radii or the clearance smaller"):
        assert word in str(caught.value)


def test_an_empty_workspace_says_which_limit_and_where() -> None:
    robot = krhpr.load(FLAGSHIP)
    made = W.translational(robot, [0.75, 0.8], redundancy=BETA, rays=4, step=0.05)
    assert not made.free.any()
    with pytest.raises(WorkspaceError) as caught:
        made.demand()
    assert "reach 100%" in str(caught.value)
    assert "at h = 0.75 m, theta_c = 0 rad, d_p = 0 m: reach of leg 1" in str(caught.value)
    with pytest.raises(WorkspaceError, match="without torsion and tilt: reach of leg 1"):
        W.torsion(robot, p=(0.0, 0.0, 0.9))


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: W.Layers().axes([0.2, 0.1]), "h: its values must increase"),
        (lambda: W.Layers().axes([]), "expected one number or more"),
        (lambda: W.Layers().axes([np.nan]), "all finite"),
        (lambda: W.steps(0, 1, 0), "expected a positive step"),
        (lambda: W.steps(1, 0, 0.1), "expected a positive step upwards"),
        (lambda: W.directions(0), "0 directions; expected 1 or more"),
        (lambda: W.free([]), "no redundant coordinates"),
    ],
)
def test_axes_that_are_none(make: Callable[[], Any], words: str) -> None:
    with pytest.raises(WorkspaceError, match=words):
        make()


def test_axes_of_another_family() -> None:
    robot = krhpr.load("spatial_rrr_a")
    axes = W.Box().axes([0.0], [0.0], [0.35])
    with pytest.raises(WorkspaceError, match="the axes are x, y, z; expected h, theta_c, d_p"):
        W.run(W.GridMap(robot, W.WorkspaceLimits(), W.constant(BETA), W.Layers(), axes))
