"""The published schema: fresh, valid, and of one mind with the reader wherever JSON Schema can tell."""

from __future__ import annotations

import json
from functools import cache
from pathlib import Path
from typing import Any

import jsonschema
import pytest
import yaml

import krhpr
from krhpr.robot_files.facts import facts_of_code
from krhpr.robot_files.schema import schema, schema_text
from tests.cli.support import Cli
from tests.files.support import EXAMPLE, FIVEBAR, PLANAR, Write, facts_of, head, problems
from tests.support import ROOT, catalogued, run_python

PUBLISHED = ROOT / "generated" / "robot-file.schema.json"


@cache
def validator() -> Any:
    found = json.loads(PUBLISHED.read_text(encoding="utf-8"))
    jsonschema.Draft202012Validator.check_schema(found)
    return jsonschema.Draft202012Validator(found)


def resolved(part: dict[str, Any]) -> Any:
    """What a reference refers to."""
    return validator().schema["$defs"][part["$ref"].removeprefix("#/$defs/")]


def accepts(text: str) -> bool:
    return bool(validator().is_valid(yaml.safe_load(text)))


def test_the_published_schema_is_that_of_the_code() -> None:
    robots = [facts_of_code(robot) for robot in catalogued()]
    assert PUBLISHED.read_text(encoding="utf-8") == schema_text(robots), "run `make generate`"


def test_it_does_not_depend_on_what_is_generated() -> None:
    facts = [facts_of(identifier) for identifier in krhpr.catalogue()]
    assert schema(facts) == validator().schema


def test_the_command_prints_it(cli: Cli) -> None:
    result = cli("schema")
    assert (result.code, result.out) == (0, PUBLISHED.read_text(encoding="utf-8"))


def test_it_takes_the_example_and_every_robot() -> None:
    assert accepts(EXAMPLE.read_text(encoding="utf-8"))
    for identifier in krhpr.catalogue():
        assert accepts(head(facts_of(identifier)))


@pytest.mark.parametrize(
    "text",
    [
        FIVEBAR + "name: arm\ngeometry: {l_2: 140 mm, l_1: -0.1, azimuth: [0, 120 deg, 4.2 rad]}\n",
        FIVEBAR + "home: {p: [0, 0, 350 mm], redundant: [1, 1, 97 deg]}\n",
        FIVEBAR + "limits: {actuators: {theta_1: [-1, 90 deg]}, clearance: 0}\n",
        FIVEBAR + "limits: {actuators: {theta_1: [[-1, 1], [-1, 2], [0 deg, 1]]}}\n",
        FIVEBAR + "limits: {passive: {spherical: 60 deg, rod: [0, 1]}}\n",
        FIVEBAR + "limits: {link_radii: {l_2: 7.5 mm, l_r: [1 mm, 0, 0.0]}}\n",
        FIVEBAR + "limits: {passive: {spherical: [1, 2, {tilt: 60 deg, stud: [0, 0, 1]}]}}\n",
        PLANAR
        + "geometry: {l_r: 0.2}\nhome: {p: [0, 0], redundant: 1.5}\nlimits: {passive: {wrist: [0, 1]}}\n",
        # and what neither takes
        "space: spatial\nsubleg: rrr\n",
        "space: planar\nsubleg: r_fivebar\narrangement: a\n",
        FIVEBAR + "name: My-arm\n",
        FIVEBAR + "name: planar_rr_a\n",
        FIVEBAR + "colour: red\n",
        FIVEBAR + "geometry: 3\n",
        FIVEBAR + "geometry: {l_9: 1}\n",
        FIVEBAR + "geometry: {l_2: -0.1}\n",
        FIVEBAR + "geometry: {l_2: -10 mm}\n",
        FIVEBAR + "geometry: {l_2: 0}\n",
        FIVEBAR + "geometry: {l_2: 10 deg}\n",
        FIVEBAR + "geometry: {alpha: 10 mm}\n",
        FIVEBAR + "geometry: {l_2: '0.1'}\n",
        FIVEBAR + "geometry: {l_2: true}\n",
        FIVEBAR + "geometry: {l_2: [0.1, 0.1]}\n",
        FIVEBAR + "home: {p: [0, 0], redundant: 1}\n",
        FIVEBAR + "home: {p: [0, 0, 0.3]}\n",
        FIVEBAR + "limits: {actuators: {theta_4: [0, 1]}}\n",
        FIVEBAR + "limits: {actuators: {theta_1: 1}}\n",
        FIVEBAR + "limits: {passive: {spherical: {}}}\n",
        FIVEBAR + "limits: {link_radii: {l_2: -1 mm}}\n",
        FIVEBAR + "limits: {clearance: -1}\n",
        PLANAR + "home: {p: [0, 0, 0], redundant: 1.5}\n",
        PLANAR + "limits: {passive: {spherical: 1}}\n",
    ],
)
def test_reader_and_schema_are_of_one_mind(text: str, write: Write) -> None:
    assert accepts(text) == (not problems(write(text)))


def test_fields_say_what_they_are_in_which_unit_and_by_default() -> None:
    for robot, rules in zip(krhpr.catalogue(), validator().schema["allOf"], strict=True):
        fields = resolved(rules["then"]["properties"]["geometry"])["properties"]
        for field in facts_of(robot).fields:
            entry = resolved(fields[field.name])
            assert field.doc in entry["description"]
            assert ("deg" if field.kind == "rad" else "mm") in entry["description"]
            assert entry["default"] in (field.default[0], list(field.default))


def test_a_newer_schema_needs_no_network(tmp_path: Path) -> None:
    text = json.dumps(validator().schema)
    assert "http" not in text.replace("https://json-schema.org/draft/2020-12/schema", "")


def test_the_schema_is_printed_without_yaml_or_sympy(tmp_path: Path) -> None:
    code = (
        "import sys\nfor name in ('yaml', 'sympy', 'jinja2', 'rich'): sys.modules[name] = None\n"
        "from krhpr.cli import main\nsys.exit(main(['schema']))"
    )
    run = run_python("-c", code, cwd=tmp_path)
    assert run.returncode == 0 and json.loads(run.stdout)["title"] == "Robot file of krhpr"
