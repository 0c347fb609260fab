"""Margins against what links and joints themselves say."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import krhpr
from krhpr.errors import WorkspaceError
from krhpr.limits import Cone, Interval, Limits
from krhpr.robot import Robot
from krhpr.trajectory.clearance import pairs
from krhpr.workspace import Bodies, Examiner, Stop, WorkspaceLimits, section_1_7
from krhpr.workspace.bodies import least_of

BETA = np.radians(97.0)
FLAGSHIP = "spatial_r_fivebar_a"


def poses(count: int, seed: int = 0) -> tuple[Any, Any, Any]:
    rng = np.random.default_rng(seed)
    p = np.array([0.0, 0.0, 0.35]) + rng.uniform(-0.25, 0.25, (count, 3))
    Q = Rotation.from_rotvec(rng.uniform(-1.2, 1.2, (count, 3))).as_matrix()
    return p, Q, BETA + rng.uniform(-0.3, 0.3, (count, 3))


def with_limits(name: str, **limits: Any) -> Robot:
    """A robot as a file with limits makes it."""
    robot = krhpr.load(name)
    return Robot(robot._module, robot.geometry, robot._backend_name, limits=Limits(**limits))


def measured(robot: Robot, limits: WorkspaceLimits, at: Any) -> Any:
    return Examiner(robot, limits).examine(*at, thorough=True)


def test_margins_of_section_1_7() -> None:
    """Each from the links' ends, pose by pose."""
    robot, at = krhpr.load(FLAGSHIP), poses(400)
    limits = section_1_7(robot)
    found = measured(robot, limits, at)
    rows = robot.signature("link_points").outputs[0].labels
    of_pairs = pairs(robot)
    reached = 0
    for k, (p, Q, beta) in enumerate(zip(*at, strict=True)):
        s = robot.end_points(p, Q, beta)
        theta, status = robot.inverse(p, Q, beta, status=True)
        assert (status == 0) == (found.stops[k] != Stop.REACH)
        if status:
            assert found.which[k] == status - 1
            continue
        reached += 1
        points, attachment = robot.link_points(p, Q, s, theta)
        A, c, E, S = (points[:, rows.index(name)] for name in ("A", "c", "E", "S"))
        e_1 = (c - A) / np.linalg.norm(c - A, axis=1)[:, None]
        axis = np.linalg.norm(np.cross(S - A, e_1), axis=1)
        assert found.values[Stop.AXIS][k] == pytest.approx(axis.min() - 0.02, abs=1e-12)

        def angle(u: Any, v: Any) -> Any:
            return np.degrees(np.arctan2(np.linalg.norm(np.cross(u, v), axis=1), (u * v).sum(axis=1)))

        elbow = angle(E - c, S - E)
        wanted = np.radians(np.minimum(elbow - 10, 170 - elbow).min())
        assert found.values[Stop.ELBOW][k] == pytest.approx(wanted, abs=1e-7)
        wanted = np.radians((150 - angle(S - E, attachment - S)).min())
        assert found.values[Stop.SPHERICAL][k] == pytest.approx(wanted, abs=1e-7)
        distances = robot.clearances(p, Q, s, theta) - (2 * 0.0075 + 0.005)
        assert found.values[Stop.BODIES][k] == pytest.approx(distances.min(), abs=1e-12)
        order = [stop for stop in Stop if stop in found.values and not found.values[stop][k] >= 0]
        assert found.stops[k] == (order[0] if order else Stop.NONE)
        if found.stops[k] == Stop.BODIES:
            nearest = int(np.flatnonzero(distances <= distances.min() + 1e-9)[0])
            assert of_pairs[nearest] == of_pairs[int(found.which[k])]
    assert reached > 100
    kinds = set(found.stops.tolist())
    assert {Stop.NONE, Stop.REACH, Stop.ELBOW, Stop.SPHERICAL, Stop.BODIES} <= kinds


def test_stopping_early_changes_nothing() -> None:
    robot, at = krhpr.load(FLAGSHIP), poses(300, seed=1)
    examiner = Examiner(robot, section_1_7(robot))
    early, thorough = examiner.examine(*at), examiner.examine(*at, thorough=True)
    assert np.array_equal(early.stops, thorough.stops)
    assert np.array_equal(early.which, thorough.which)
    one_by_one = [examiner.examine(*(x[k : k + 1] for x in at)) for k in range(0, 300, 7)]
    assert [int(one.stops[0]) for one in one_by_one] == early.stops[::7].tolist()
    assert (early.least[early.free] >= 0).all()
    assert (early.least[~early.free] == -np.inf).all()


def test_actuators_and_passive_joints_keep_their_intervals() -> None:
    low, high = -0.6, 0.4
    intervals = (Interval(low, high),) * 3
    wide = (Interval(-10.0, 10.0),) * 3
    robot = with_limits(
        "spatial_rrr_a",
        actuators={"theta_2": wide, "theta_1": intervals},
        passive={"platform_joint": (Interval(1.5, 1.9),) * 3},
    )
    at = poses(200, seed=2)
    found = measured(robot, WorkspaceLimits(), at)
    names = robot.signature("inverse").outputs[0].labels
    theta = robot.inverse(*at)[..., names.index("theta_1")]
    kept = ~np.isnan(theta).any(axis=1)
    wanted = np.minimum(theta - low, high - theta).min(axis=1)
    narrow = np.abs(theta).max(axis=1) < np.pi / 2  # beyond, the other end may be nearer
    assert found.values[Stop.ACTUATOR][kept & narrow] == pytest.approx(wanted[kept & narrow], abs=1e-9)
    redundant = at[2]
    wanted = np.minimum(redundant - 1.5, 1.9 - redundant).min(axis=1)
    assert found.values[Stop.PASSIVE][kept] == pytest.approx(wanted[kept], abs=1e-9)
    examiner = Examiner(robot, WorkspaceLimits())
    stopped = np.flatnonzero(found.stops == Stop.ACTUATOR)
    k = int(stopped[0])
    assert examiner.name(int(found.stops[k]), int(found.which[k])).startswith("actuator theta_1 of leg")


def test_angles_have_full_turns_to_spare() -> None:
    intervals = (Interval(2 * np.pi - 0.6, 2 * np.pi + 0.4),) * 3
    near = (Interval(-0.6, 0.4),) * 3
    at = poses(100, seed=3)
    one, other = (
        measured(with_limits("spatial_rrr_a", actuators={"theta_1": each}), WorkspaceLimits(), at)
        for each in (intervals, near)
    )
    assert one.values[Stop.ACTUATOR] == pytest.approx(other.values[Stop.ACTUATOR], abs=1e-9, nan_ok=True)


def test_cones_of_robot_files() -> None:
    """The default of files: the socket along the last link, the stud along the platform's normal."""
    robot = with_limits(FLAGSHIP, spherical=(Cone(1.2), Cone(1.3), Cone(1.4)))
    at = poses(60, seed=4)
    found = measured(robot, WorkspaceLimits(), at)
    s, theta = robot.end_points(*at), robot.inverse(*at)
    points = robot.link_points(at[0], at[1], s, theta).points
    labels = robot.signature("link_points").outputs[0].labels
    link = points[:, :, labels.index("S")] - points[:, :, labels.index("E")]
    link /= np.linalg.norm(link, axis=-1)[..., None]
    angle = np.arccos((link * at[1][:, None, :, 2]).sum(axis=-1))
    wanted = (np.array([1.2, 1.3, 1.4]) - angle).min(axis=1)
    assert found.values[Stop.SPHERICAL] == pytest.approx(wanted, abs=1e-7, nan_ok=True)


def test_bodies_have_the_radii_of_the_file() -> None:
    robot = with_limits(
        FLAGSHIP, link_radii={"l_5": (0.01, 0.02, 0.03), "l_r": (0.004,) * 3}, clearance=0.001
    )
    bodies = Bodies.of(robot, WorkspaceLimits(edges=False))
    names = [bodies.names[place] for place in bodies.chosen]
    assert all("l_5" in name or "redundant" in name for name in names)
    least = dict(zip(names, bodies.least, strict=True))
    assert least["l_5 of leg 1 and l_5 of leg 3"] == pytest.approx(0.041)
    assert least["l_5 of leg 2 and redundant link of leg 3"] == pytest.approx(0.025)
    with_edges = Bodies.of(robot, WorkspaceLimits())
    assert "l_5 of leg 1 and platform edge 1-2" in [with_edges.names[place] for place in with_edges.chosen]
    assert len(Bodies.of(krhpr.load(FLAGSHIP), WorkspaceLimits()).chosen) == 0
    every = Bodies.of(krhpr.load(FLAGSHIP), section_1_7())
    assert len(every.chosen) == len(every.names) == len(robot.link_pairs)
    assert np.unique(every.least).tolist() == [0.02]


def test_the_base_is_below_and_type_2_beside() -> None:
    robot, at = krhpr.load("spatial_rrr_b"), poses(40, seed=5)
    at = (at[0], at[1], np.tile(robot.home.redundant, (40, 1)))
    found = measured(robot, WorkspaceLimits(lowest=0.3, margin=0.1), at)
    kept = found.stops != Stop.REACH
    assert kept.sum() > 5
    assert found.values[Stop.BASE][kept] == pytest.approx(at[0][kept, 2] - 0.3)
    margins = robot.type_2_of_redundant(at[2]).margins.min(axis=1) - 0.1
    assert found.values[Stop.TYPE_2][kept] == pytest.approx(margins[kept])


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"cone": 4.0}, "cone is 4; expected a number that is between 0 and pi"),
        ({"radius": -0.1}, "radius is -0.1; expected a number that is 0 or more"),
        ({"elbow": (2.0, 1.0)}, "elbow is (2.0, 1.0); expected the least and the largest angle"),
        ({"axis_distance": float("nan")}, "axis_distance is nan"),
    ],
)
def test_limits_that_are_none(changes: dict[str, Any], words: str) -> None:
    with pytest.raises(WorkspaceError) as caught:
        WorkspaceLimits(**changes)
    assert words in str(caught.value)


@pytest.mark.parametrize(
    ("name", "limits", "words"),
    [
        ("planar_rr_a", WorkspaceLimits(), "spatial robots"),
        ("spatial_prr_a", WorkspaceLimits(axis_distance=0.02), "first actuators do not turn"),
        ("spatial_ups3_a", WorkspaceLimits(elbow=(0.1, 3.0)), "sub-legs have none"),
    ],
)
def test_limits_that_a_robot_does_not_have(name: str, limits: WorkspaceLimits, words: str) -> None:
    with pytest.raises(WorkspaceError, match=words):
        Examiner(krhpr.load(name), limits)


def test_a_first_axis_needs_a_direction() -> None:
    robot = krhpr.load(FLAGSHIP).with_geometry(l_1=0.0)
    with pytest.raises(WorkspaceError, match="l_1 = 0"):
        Examiner(robot, section_1_7(robot))
    Examiner(robot, replace(section_1_7(robot), axis_distance=None))


def test_section_1_7_leaves_out_what_a_robot_lacks() -> None:
    slides = section_1_7(krhpr.load("spatial_ups3_a"))
    assert (slides.axis_distance, slides.elbow) == (None, None)
    assert section_1_7(krhpr.load("spatial_rrr_a")) == section_1_7()


def test_limits_of_the_file_are_held_and_others_go_before() -> None:
    """Type I limits, clearance and the platform's radius."""
    file = {"axis_distance": 0.05, "elbow": Interval(0.3, 2.8), "clearance": 0.002}
    radii = {"l_5": (0.01,) * 3, "platform": (0.004, 0.005, 0.006)}
    robot = with_limits(FLAGSHIP, link_radii=radii, **file)
    at = poses(80, seed=6)
    by_file = measured(robot, WorkspaceLimits(), at)
    bare = with_limits(FLAGSHIP, link_radii=radii)
    same = WorkspaceLimits(axis_distance=0.05, elbow=(0.3, 2.8), clearance=0.002)
    by_hand = measured(bare, same, at)
    assert np.array_equal(by_file.stops, by_hand.stops)
    for stop in (Stop.AXIS, Stop.ELBOW, Stop.BODIES):
        assert by_file.values[stop] == pytest.approx(by_hand.values[stop], nan_ok=True)
    wider = measured(robot, WorkspaceLimits(axis_distance=0.01), at)
    kept = ~np.isnan(wider.values[Stop.AXIS])
    assert wider.values[Stop.AXIS][kept] == pytest.approx(by_file.values[Stop.AXIS][kept] + 0.04)
    bodies = Bodies.of(robot, WorkspaceLimits())
    names = [bodies.names[place] for place in bodies.chosen]
    least = dict(zip(names, bodies.least, strict=True))
    assert least["l_5 of leg 1 and platform edge 1-2"] == pytest.approx(0.018)


def test_a_robot_file_makes_such_a_robot(tmp_path: Any) -> None:
    file = tmp_path / "arm.yaml"
    file.write_text(
        "space: spatial\nsubleg: r_fivebar\narrangement: a\n"
        "limits: {axis_distance: 20 mm, elbow: [10 deg, 170 deg], clearance: 5 mm,"
        " link_radii: {l_1: 7.5 mm, l_2: 7.5 mm, l_3: 7.5 mm, l_4: 7.5 mm, l_5: 7.5 mm, l_r: 7.5 mm}}\n",
        "utf-8",
    )
    at = poses(120, seed=7)
    of_file = Examiner(krhpr.load(file), WorkspaceLimits(cone=np.radians(150), lowest=0.0)).examine(*at)
    robot = krhpr.load(FLAGSHIP)
    of_section = Examiner(robot, section_1_7(robot)).examine(*at)
    assert np.array_equal(of_file.stops, of_section.stops)
    assert np.array_equal(of_file.which, of_section.which)


def test_of_equal_margins_the_first_is_named() -> None:
    least, place = least_of(np.array([[3.0, 1.0 + 1e-12, 1.0], [np.nan, 0.0, np.nan], [0.5, 0.5, 2.0]]))
    assert place.tolist() == [1, 0, 0]
    assert least == pytest.approx([1.0, np.nan, 0.5], nan_ok=True)
