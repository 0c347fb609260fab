"""An opening that the gripper keeps along a path, and what no gripper can keep."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.optimize import linprog
from scipy.spatial.transform import Rotation

import krhpr
from krhpr import trajectory
from krhpr.trajectory import Bounds, ContradictoryLimits, Grip, PathError
from krhpr.trajectory.clearance import pairs
from krhpr.trajectory.files import Request, read_request

ROOT = Path(__file__).resolve().parents[2]
JAWS = 0.08


@cache
def gripper() -> krhpr.Robot:
    return krhpr.load(str(ROOT / "examples" / "gripper.yaml"), backend="numpy")


@cache
def request_() -> Request:
    return read_request(ROOT / "examples" / "carry.yaml", planar=False, slides=True)


@cache
def carried(play: float | None) -> trajectory.Trajectory:
    asked = request_()
    assert asked.bounds.grip == Grip(0.06, JAWS, 0.02)
    bounds = replace(asked.bounds, grip=Grip(0.06, JAWS, play))
    return trajectory.optimise(gripper(), asked.path, asked.objective, bounds)


def test_the_example_keeps_its_opening() -> None:
    """By the geometry of three jaws with faces normal to the slides, between the samples as well."""
    found = carried(0.02)
    assert found.feasible
    times = np.linspace(0, 4, 1601)
    motion, d = found.path.at(times), found.coordinates.at(times)
    azimuth = np.radians([0.0, 120.0, 240.0])
    outward = np.stack([np.cos(azimuth), np.sin(azimuth)], axis=1)
    faces = d - JAWS  # the lines outward_i x = faces_i; three of them are a triangle round the object
    unknowns = np.column_stack([outward, np.ones(3)])  # centre and radius
    x, y, radius = np.linalg.solve(unknowns, faces.T)
    np.testing.assert_allclose(2 * radius, 0.06, atol=1e-9)
    off = np.hypot(x, y)
    assert off.max() < 0.02 + 1e-6 and off.max() > 0.0195  # it does reach the end of its play
    s = gripper().end_points(motion.p, motion.Q, d)
    local = np.einsum("nji,nkj->nki", motion.Q, s - motion.p[:, None])
    np.testing.assert_allclose(np.linalg.norm(local, axis=-1), d, atol=1e-12)
    assert np.abs(np.diff(d, axis=0) / (times[1] - times[0])).max() < 0.1001


def test_what_is_left_of_the_redundancy_pays() -> None:
    asked = request_()
    centred = trajectory.optimise(gripper(), asked.path, "eta_1", asked.bounds, method="constant")
    np.testing.assert_allclose(centred.redundant, 0.11, atol=1e-12)
    values = [centred.examined.objective, carried(0.02).examined.objective, carried(None).examined.objective]
    assert centred.feasible and values[1] < 0.97 * values[0] and values[2] < 0.98 * values[1]
    free = trajectory.optimise(gripper(), asked.path, "eta_1", replace(asked.bounds, grip=None))
    assert free.examined.objective < values[2]


def test_the_object_does_not_move_where_it_may_not() -> None:
    still = carried(1e-5)
    assert still.feasible
    np.testing.assert_allclose(still.redundant, 0.11, atol=1.1e-5)


def test_results_have_the_opening(tmp_path: Path) -> None:
    found = carried(0.02)
    paths = trajectory.save(found, tmp_path / "carry")
    again = trajectory.load_result(paths[0])
    np.testing.assert_allclose(again.arrays["opening"], 0.06, atol=1e-12)
    assert again.arrays["centre"].shape == (len(found.times), 2)
    assert again.about["limits"]["grip"] == {"opening": 0.06, "jaws": [JAWS] * 3, "play": 0.02}
    assert again.about["units"]["opening"] == "m"
    header = next(line for line in paths[1].read_text().splitlines() if line.startswith("time"))
    assert header.endswith(",opening [m],centre_x [m],centre_y [m]")


@pytest.mark.parametrize("name", ["spatial_rrr_b", "planar_rr_c", "planar_fivebar_b"])
def test_other_grippers_and_jaws(name: str) -> None:
    """Slides that miss the centre, unequal jaws, and the plane."""
    robot = krhpr.load(name, backend="numpy")
    jaws = np.array([0.5, 0.55, 0.45]) * min(robot.home.redundant)
    opening = float(robot.opening(robot.home.redundant, jaws).opening)
    p = np.asarray(robot.home.p)
    ends = np.stack([p, p + 0.02])
    turns: Any = [0.0, 0.15]
    if not robot.planar:
        turns = Rotation.from_rotvec([[0, 0, 0], [0.1, 0.1, 0.1]]).as_matrix()
    path = trajectory.way_points([0.0, 1.0], ends, turns)
    box = (0.5 * min(robot.home.redundant), 1.6 * max(robot.home.redundant))
    bounds = Bounds(box, redundant_rate=0.2, grip=Grip(opening, jaws))
    found = trajectory.optimise(robot, path, "eta_2", bounds, intervals=8)
    assert found.feasible and np.ptp(found.redundant, axis=0).max() > 1e-4
    np.testing.assert_allclose(robot.opening(found.redundant, jaws).opening, opening, atol=1e-9)


def test_an_opening_that_is_not_kept_is_a_violation() -> None:
    """The thesis' constant method with a value of one's own looks at no limits."""
    asked = request_()
    found = trajectory.optimise(
        gripper(), asked.path, "eta_1", asked.bounds, method="constant", constant=0.12
    )
    (one,) = [one for one in found.violations if one.name == "opening of the gripper"]
    assert one.value == pytest.approx(0.08) and one.limit == 0.06 and one.unit == "m"


def test_joints_in_the_middle_of_links() -> None:
    """The distal link of a five-bar turns about the end of the proximal one, which it passes."""
    names = {pair.name for pair in pairs(gripper())}
    assert "l_4 of leg 1 and l_5 of leg 1" not in names
    assert "l_4 of leg 1 and l_3 of leg 1" in names and "l_4 of leg 1 and l_5 of leg 2" in names
    assert len(pairs(krhpr.load("spatial_rrr_a", backend="numpy"))) == 15 * 14 // 2 - 9 - 9


# -- what cannot be held ------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("grip", "message"),
    [
        (Grip(0.2, JAWS), r"an opening of 0\.2 m cannot be held: .* open from -0\.04 to 0\.16 m"),
        (Grip(-0.01, JAWS), r"opening of the grip is -0\.01; it must not be negative"),
        (Grip(0.06, JAWS, float("nan")), "play of the grip is nan"),
        (Grip(0.06, (0.01, 0.13, 0.13), 0.01), r"centre of an object of 0\.06 m is .* more from O'; play is"),
    ],
)
def test_contradictions(grip: Grip, message: str) -> None:
    asked = request_()
    with pytest.raises(ContradictoryLimits, match=message):
        trajectory.optimise(gripper(), asked.path, "eta_1", replace(asked.bounds, grip=grip))


def test_robots_without_a_gripper() -> None:
    bounds = replace(trajectory.chapter_4(), grip=Grip(0.06))
    with pytest.raises(
        ContradictoryLimits, match=r"spatial_rrr_a has no gripper .* \(b\) and \(c\) have one"
    ):
        trajectory.optimise(
            krhpr.load("spatial_rrr_a", backend="numpy"), trajectory.translation(), "eta_1", bounds
        )


def test_the_least_play() -> None:
    """Against a linear programme over many directions, whose answer is the distance to a polygon."""
    robot, source = gripper(), np.random.default_rng(4)
    turns = np.linspace(0, 2 * np.pi, 720, endpoint=False)
    for _ in range(5):
        low = source.uniform(0.05, 0.12, 3)
        high, grip = low + source.uniform(0.03, 0.06, 3), Grip(0.06, source.uniform(0.05, 0.09, 3))
        at = [grip.centred(robot)] + [robot.redundant_of_opening(0.06, unit, grip.jaws) for unit in np.eye(2)]
        slopes = np.column_stack([at[1] - at[0], at[2] - at[0]])
        polygon = np.vstack([np.column_stack([np.zeros(3), slopes]), np.column_stack([np.zeros(3), -slopes])])
        circle = np.column_stack([-np.ones(720), np.cos(turns), np.sin(turns)])
        found = linprog(
            [1, 0, 0],
            A_ub=np.vstack([polygon, circle]),
            b_ub=np.concatenate([high - at[0], at[0] - low, np.zeros(720)]),
            bounds=[(None, None)] * 3,
        )
        if found.status == 0:
            assert grip._least_play(robot, low, high) == pytest.approx(found.x[0], rel=1e-4, abs=1e-6)
        else:
            assert grip._least_play(robot, low, high) == np.inf


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (
            ("opening: 60 mm, ", ""),
            "limits.grip: found a table of fields, expected a table with opening, jaws, play",
        ),
        (("play:", "plau:"), "limits.grip.plau: unknown field; did you mean play"),
        (
            ("jaws: 80 mm", "jaws: [80 mm, 80 mm]"),
            "limits.grip.jaws: found a list of 2, expected a list of 3",
        ),
    ],
)
def test_mistakes_in_a_file(change: tuple[str, str], message: str, tmp_path: Path) -> None:
    text = (ROOT / "examples" / "carry.yaml").read_text().replace(*change, 1)
    (tmp_path / "wrong.yaml").write_text(text)
    with pytest.raises(PathError, match=message):
        read_request(tmp_path / "wrong.yaml", planar=False, slides=True)
