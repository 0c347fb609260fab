"""Limits: read, checked against the robot's joints and links, typed, frozen."""

from __future__ import annotations

import copy
import dataclasses
import math
import pickle

import pytest

import krhpr
from krhpr import Cone, Interval, Limits
from krhpr.robot_files import RobotFileWarning
from tests.files.support import EXAMPLE, FIVEBAR, PLANAR, Write, problems, read, the_problem


def limits(write: Write, text: str, robot: str = FIVEBAR) -> Limits:
    return read(write(robot + "limits:\n" + text)).limits


def test_intervals_for_all_legs_or_for_each(write: Write) -> None:
    found = limits(
        write, "  actuators:\n    theta_1: [-90 deg, 1]\n    theta_2: [[0, 1], [0, 2], [-1, 3 rad]]\n"
    )
    same = Interval(math.radians(-90.0), 1.0)
    assert found.actuators["theta_1"] == (same, same, same)
    assert found.actuators["theta_2"] == (Interval(0.0, 1.0), Interval(0.0, 2.0), Interval(-1.0, 3.0))
    assert set(found.actuators) == {"theta_1", "theta_2"} and not found.passive


def test_spherical_joints_take_an_angle_or_axes(write: Write) -> None:
    tilt = math.radians(60.0)
    assert limits(write, "  passive: {spherical: 60 deg}\n").spherical == (Cone(tilt),) * 3
    found = limits(write, "  passive: {spherical: {tilt: 60 deg, socket: [0, 0, 2], stud: [3, 0, 4]}}\n")
    assert found.spherical == (Cone(tilt, (0.0, 0.0, 1.0), (0.6, 0.0, 0.8)),) * 3
    found = limits(write, "  passive: {spherical: [1, 60 deg, {tilt: 2}]}\n")
    assert found.spherical == (Cone(1.0), Cone(tilt), Cone(2.0))


def test_planar_robots_have_a_wrist_instead(write: Write) -> None:
    found = limits(write, "  passive: {wrist: [-1, 1], platform_joint: [0, 2]}\n", PLANAR)
    assert set(found.passive) == {"wrist", "platform_joint"} and found.spherical is None
    assert (
        "unknown field 'spherical'"
        in the_problem(write(PLANAR + "limits: {passive: {spherical: 1}}\n")).message
    )


def test_radii_and_clearance(write: Write) -> None:
    found = limits(write, "  link_radii: {l_2: 7.5 mm, l_r: [5 mm, 6 mm, 0]}\n  clearance: 5 mm\n")
    assert dict(found.link_radii) == {"l_2": (0.0075,) * 3, "l_r": (0.005, 0.006, 0.0)}
    assert found.clearance == 0.005
    found = limits(write, "  link_radii: {platform: 6 mm}\n")
    assert dict(found.link_radii) == {"platform": (0.006,) * 3}


def test_limits_of_type_1_singularities(write: Write) -> None:
    found = limits(write, "  axis_distance: 20 mm\n  elbow: [10 deg, 170 deg]\n")
    assert found.axis_distance == 0.02
    assert found.elbow == Interval(math.radians(10), math.radians(170))
    robots = {"subleg: prr": ["elbow"], "subleg: ups3": []}
    for subleg, has in robots.items():
        for field in ("axis_distance: 1 mm", "elbow: [0, 1]"):
            file = write(f"space: spatial\n{subleg}\narrangement: b\nlimits: {{{field}}}\n")
            if field.partition(":")[0] in has:
                assert read(file).limits
            else:
                assert "unknown field" in the_problem(file).message


def test_slides_are_limited_by_lengths(write: Write) -> None:
    robot = "space: spatial\nsubleg: rrr\narrangement: c\n"
    found = limits(write, "  passive: {platform_joint: [0, 120 mm]}\n", robot)
    assert found.passive["platform_joint"][2] == Interval(0.0, 0.12)


@pytest.mark.parametrize(
    ("text", "field", "words"),
    [
        (
            "actuators: {theta_4: [0, 1]}",
            "limits.actuators",
            "unknown field 'theta_4' of spatial_r_fivebar_a; did you",
        ),
        (
            "actuators: {theta_1: [1, 0]}",
            "limits.actuators.theta_1",
            "found [1, 0] rad, expected the lower limit first",
        ),
        ("actuators: {theta_1: [1, 1]}", "limits.actuators.theta_1", "expected the lower limit first"),
        ("actuators: {theta_1: 1}", "limits.actuators.theta_1", "found 1, expected [lowest, highest]"),
        (
            "actuators: {theta_1: [1]}",
            "limits.actuators.theta_1",
            "found a list of 1, expected [lowest, highest]",
        ),
        (
            "actuators: {theta_1: [[0, 1], [0, 1]]}",
            "limits.actuators.theta_1",
            "found a list of 2, expected one value",
        ),
        (
            "actuators: {theta_1: [[0, 1], [0, 1], 3]}",
            "limits.actuators.theta_1",
            "found a list of 3, expected [lowest",
        ),
        ("actuators: {theta_1: [0, 1 mm]}", "limits.actuators.theta_1", "found '1 mm', expected an angle"),
        ("actuators: []", "limits.actuators", "found a list of 0, expected a table"),
        (
            "passive: {beta: [0, 1]}",
            "limits.passive",
            "there are crank_1, crank_2, rod, platform_joint, spherical",
        ),
        ("passive: {spherical: 181 deg}", "limits.passive.spherical", "expected an angle of at most 180 deg"),
        ("passive: {spherical: 0}", "limits.passive.spherical", "expected an angle greater than 0"),
        (
            "passive: {spherical: [0, 1]}",
            "limits.passive.spherical",
            "found a list of 2, expected one value, or three",
        ),
        ("passive: {spherical: {}}", "limits.passive.spherical", "tilt is missing"),
        (
            "passive: {spherical: {tilt: 1, stud: [0, 0, 0]}}",
            "limits.passive.spherical.stud",
            "not all of its numbers",
        ),
        (
            "passive: {spherical: {tilt: 1, stud: z}}",
            "limits.passive.spherical.stud",
            "found z, expected a direction",
        ),
        ("passive: {spherical: {tilt: 1, axis: z}}", "limits.passive.spherical", "unknown field 'axis'"),
        ("link_radii: {l_6: 1 mm}", "limits.link_radii", "unknown field 'l_6'"),
        ("link_radii: {l_2: -1 mm}", "limits.link_radii.l_2", "expected a length of at least 0"),
        ("clearance: -1 mm", "limits.clearance", "found '-1 mm', expected a length of at least 0"),
        ("axis_distance: -1 mm", "limits.axis_distance", "expected a length of at least 0"),
        ("elbow: [170 deg, 10 deg]", "limits.elbow", "expected the lower limit first"),
        ("elbow: [10 deg, 190 deg]", "limits.elbow", "expected angles between 0 and 180 deg"),
        ("link_radii: {platforms: 1}", "limits.link_radii", "did you mean platform"),
        ("clearance: [1, 1, 1]", "limits.clearance", "found a list of 3, expected a length"),
        (
            "speed: 1",
            "limits",
            "unknown field 'speed' of limits; there are actuators, passive, link_radii, clearance",
        ),
    ],
)
def test_mistakes(text: str, field: str, words: str, write: Write) -> None:
    problem = the_problem(write(FIVEBAR + f"limits:\n  {text}\n"))
    assert (problem.line, problem.field) == (5, field)
    assert words in problem.message


def test_thick_links_and_many_turns_are_told(write: Write) -> None:
    with pytest.warns(RobotFileWarning, match=r"limits.link_radii.l_2: 7.5 m is very thick; .* `7.5 mm`"):
        limits(write, "  link_radii: {l_2: 7.5}\n")
    with pytest.warns(RobotFileWarning, match=r"theta_1: .*with degrees in mind write \[-90 deg, 90 deg\]"):
        limits(write, "  actuators: {theta_1: [-90, 90]}\n")


def test_limits_are_frozen_and_copied_whole() -> None:
    found = krhpr.load(EXAMPLE, backend="numpy").limits
    with pytest.raises(dataclasses.FrozenInstanceError):
        found.clearance = 1.0  # type: ignore[misc]
    with pytest.raises(TypeError):
        found.actuators["theta_1"] = found.actuators["theta_2"]  # type: ignore[index]
    for again in (pickle.loads(pickle.dumps(found)), copy.deepcopy(found)):
        assert again == found and hash(again) == hash(found)
    assert found and not Limits() and Limits(clearance=0.0) != Limits()


def test_a_caller_cannot_change_them_behind_their_back() -> None:
    table = {"l_2": (1.0, 1.0, 1.0)}
    found = Limits(link_radii=table)
    table["l_2"] = (2.0, 2.0, 2.0)
    assert found.link_radii["l_2"] == (1.0, 1.0, 1.0)


def test_nothing_is_said_of_a_file_without_limits(write: Write) -> None:
    assert not problems(write(FIVEBAR + "limits: {}\n"))
