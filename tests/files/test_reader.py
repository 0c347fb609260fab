"""What a robot file chooses, and what is said where it does not: file, line, field, found, allowed."""

from __future__ import annotations

import math
import pickle
from pathlib import Path

import pytest

import krhpr
from krhpr.robot_files import RobotFileError, is_robot_file
from krhpr.robot_files.facts import choice, facts_of_code, facts_of_module
from tests.files.support import EXAMPLE, FIVEBAR, Write, facts_of, head, problems, read, the_problem
from tests.support import catalogued

ROBOTS = krhpr.catalogue()


@pytest.mark.parametrize("identifier", ROBOTS)
def test_three_lines_choose_any_robot_with_the_catalogues_sizes(identifier: str, write: Write) -> None:
    file = read(write(head(facts_of(identifier))))
    geometry = krhpr.load(identifier, backend="numpy").geometry
    assert (file.identifier, file.name) == (identifier, "arm")
    assert file.sizes == {name: tuple(values.tolist()) for name, values in geometry.fields.items()}
    assert not file.limits and file.home is None


@pytest.mark.parametrize("identifier", ROBOTS)
def test_every_field_of_every_robot_can_be_set(identifier: str, write: Write) -> None:
    facts = facts_of(identifier)
    lines = [f"  {field.name}: {list(field.default)}" for field in facts.fields]
    lines += ["limits:", "  actuators:"]
    lines += [f"    {joint.name}: [-0.1, 0.1]" for joint in facts.actuators]
    lines += ["  passive:", *(f"    {joint.name}: [-0.1, 0.1]" for joint in facts.passive)]
    lines += [f"    {facts.spherical.name}: 1"] if facts.spherical else []
    lines += ["  link_radii:", *(f"    {link}: 0.01" for link in facts.links)]
    file = read(write(head(facts) + "geometry:\n" + "\n".join(lines) + "\n"))
    assert file.sizes == {field.name: field.default for field in facts.fields}
    assert set(file.limits.actuators) == {joint.name for joint in facts.actuators}
    assert set(file.limits.passive) == {joint.name for joint in facts.passive}
    assert (file.limits.spherical is None) == (facts.space == "planar")
    assert set(file.limits.link_radii) == set(facts.links)


def test_facts_are_the_same_from_generated_and_from_derived_code() -> None:
    for robot in catalogued():
        module = __import__(f"krhpr.generated.python.{robot.identifier}", fromlist=["x"])
        assert facts_of_code(robot) == facts_of_module(module)


def test_identifiers_come_apart_as_they_were_composed() -> None:
    from krhpr.derivations.catalogue import catalogue

    for entry in catalogue():
        robot = entry.robot
        assert choice(entry.identifier) == (robot.space, robot.subleg.name, robot.platform.arrangement)


def test_one_value_serves_all_legs_and_three_serve_each(write: Write) -> None:
    sizes = read(write(FIVEBAR + "geometry:\n  l_2: 140 mm\n  l_3: [0.3, 310 mm, 32 cm]\n")).sizes
    assert sizes["l_2"] == (0.14, 0.14, 0.14)
    assert sizes["l_3"] == (0.3, 0.31, 0.32)
    assert sizes["l_4"] == facts_of("spatial_r_fivebar_a").fields[6].default


def test_degrees_are_those_of_the_catalogue(write: Write) -> None:
    sizes = read(write(FIVEBAR + "geometry: {azimuth: [0 deg, 120 deg, 240 deg]}\n")).sizes
    assert sizes["azimuth"] == facts_of("spatial_r_fivebar_a").fields[0].default
    assert sizes["azimuth"][1] == math.radians(120.0)


def test_the_name_is_the_files_unless_given(write: Write, tmp_path: Path) -> None:
    path = write(FIVEBAR)
    assert read(path).name == "arm"
    assert read(write(FIVEBAR + "name: other\n")).name == "other"
    odd = tmp_path / "My arm.yaml"
    odd.write_text(FIVEBAR)
    problem = the_problem(odd)
    assert (problem.line, problem.field) == (0, "name")
    assert problem.message.startswith("is that of the file unless the field gives another: found 'My arm', ")
    odd.write_text(FIVEBAR + "name: arm\n")
    assert read(odd).name == "arm"


@pytest.mark.parametrize(
    ("text", "line", "field", "words"),
    [
        ("name: arm\n", 0, "space", "is missing; give one of planar, spatial"),
        ("space: spatial\narrangement: a\n", 0, "subleg", "is missing; give one of "),
        (
            "space: Spatial\n",
            1,
            "space",
            "found Spatial, expected one of planar, spatial; did you mean spatial",
        ),
        ("space: [spatial]\n", 1, "space", "found a list of 1, expected one of planar, spatial"),
        ("space: on\n", 1, "space", "found on (true or false), expected one of"),
        ("space:\n", 1, "space", "found nothing, expected one of"),
        ("space: spatial\nsubleg: five_bar\narrangement: a\n", 2, "subleg", "did you mean r_fivebar"),
        ("space: planar\nsubleg: r_fivebar\narrangement: a\n", 2, "subleg", "for planar"),
        ("space: spatial\nsubleg: rrr\narrangement: z\n", 3, "arrangement", "for spatial_rrr"),
        (FIVEBAR + "geometri: {}\n", 4, "geometri", "unknown field 'geometri'; did you mean geometry"),
        (FIVEBAR + "'a b': {}\n", 4, "", "unknown field 'a b'"),
        (FIVEBAR + "<<: {}\n", 4, "", "unknown field '<<'"),
        (FIVEBAR + "name: while\n", 4, "name", "found 'while', which is a word of Python"),
        (FIVEBAR + "name: [a]\n", 4, "name", "found a list of 1, expected a name"),
        (FIVEBAR + "name: no\n", 4, "name", "found no (true or false), expected a name"),
        (FIVEBAR + "geometry: 3\n", 4, "geometry", "found 3, expected a table of fields"),
        (FIVEBAR + "geometry:\n", 4, "geometry", "found nothing, expected a table of fields"),
        (
            FIVEBAR + "geometry: {l_7: 1}\n",
            4,
            "geometry",
            "unknown field 'l_7' of spatial_r_fivebar_a; did you mean l_",
        ),
        (
            FIVEBAR + "geometry:\n  l_2: -0.15\n",
            5,
            "geometry.l_2",
            "found -0.15, expected a length greater than 0",
        ),
        (
            FIVEBAR + "geometry:\n  l_2: -15 mm\n",
            5,
            "geometry.l_2",
            "found '-15 mm', expected a length greater",
        ),
        (FIVEBAR + "geometry:\n  l_2: 0\n", 5, "geometry.l_2", "found 0, expected a length greater than 0"),
        (
            FIVEBAR + "geometry:\n  l_2: 15 deg\n",
            5,
            "geometry.l_2",
            "found '15 deg', expected a length in metres",
        ),
        (FIVEBAR + "geometry:\n  alpha: 15 mm\n", 5, "geometry.alpha", "expected an angle in radians"),
        (
            FIVEBAR + "geometry:\n  l_2: {a: 1}\n",
            5,
            "geometry.l_2",
            "found a table of fields, expected a length",
        ),
        (
            FIVEBAR + "geometry:\n  l_2: [1, 2]\n",
            5,
            "geometry.l_2",
            "found a list of 2, expected one value, or three",
        ),
        (FIVEBAR + "geometry:\n  l_2: [.1,\n   x, .1]\n", 6, "geometry.l_2[1]", "found x, expected a length"),
        (
            FIVEBAR + "geometry:\n  l_2: [[.1, .1, .1], .1, .1]\n",
            5,
            "geometry.l_2[0]",
            "found a list of 3, expected a",
        ),
    ],
)
def test_mistakes(text: str, line: int, field: str, words: str, write: Write) -> None:
    problem = the_problem(write(text))
    assert (problem.line, problem.field) == (line, field)
    assert words in problem.message


def test_all_mistakes_are_told_at_once_in_the_order_of_the_file(write: Write) -> None:
    found = problems(
        write(
            FIVEBAR
            + "limits: {clearance: -1}\ngeometry:\n  l_2: x\n  l_9: 1\nhome: {p: [1, 2], redundant: 1}\n"
        )
    )
    assert [(problem.line, problem.field) for problem in found] == [
        (4, "limits.clearance"),
        (6, "geometry.l_2"),
        (7, "geometry"),
        (8, "home.p"),
    ]


def test_values_are_shown_escaped_and_cut(write: Write) -> None:
    message = the_problem(write(FIVEBAR + 'geometry: {l_2: "\\e[31m\\n' + "x" * 500 + '"}\n')).message
    assert message.isprintable() and len(message) < 250 and "'\\x1b[31m" in message


def test_the_error_says_which_file_and_survives_a_pickle(write: Write) -> None:
    path = write("space: up\n")
    with pytest.raises(RobotFileError) as caught:
        read(path)
    assert str(caught.value) == f"{path}, line 1: space: found up, expected one of planar, spatial"
    again = pickle.loads(pickle.dumps(caught.value))
    assert (str(again), again.path, again.problems) == (str(caught.value), str(path), caught.value.problems)
    assert isinstance(again, krhpr.KrhprError) and isinstance(again, ValueError)


def test_files_are_told_from_robots() -> None:
    assert all(map(is_robot_file, ("arm.yaml", "arm.YML", "./arm", "a/b", "..\\arm")))
    assert not any(map(is_robot_file, (*ROBOTS, "arm", "yaml", "")))


def test_the_example_is_without_fault(recwarn: pytest.WarningsRecorder) -> None:
    file = read(EXAMPLE)
    assert file.name == "my_robot" and not list(recwarn)
    assert file.home is not None and file.home.p == (0.0, 0.0, 0.28)
