"""`krhpr list` and `krhpr info`."""

from __future__ import annotations

import json
import re

import pytest

import krhpr
from tests.cli.support import Cli

ROBOTS = krhpr.catalogue()


def test_list_has_a_row_for_each_robot(cli: Cli) -> None:
    result = cli("list")
    assert result.code == 0
    head, rule, *rows = result.out.splitlines()
    assert head.split("  ")[0] == "robot" and set(rule) == {"-", " "}
    assert [row.split()[0] for row in rows] == list(ROBOTS)
    assert re.search(
        r"^spatial_rrr_a +3-RRRSR +.* 4 +1 +theta_1, theta_2, theta_3$", result.out, re.MULTILINE
    )


def test_list_as_json(cli: Cli) -> None:
    rows = {row["robot"]: row for row in json.loads(cli("list", "--json").out)}
    assert list(rows) == list(ROBOTS)
    assert rows["spatial_r_fivebar_a"]["assembly_modes"] == ["left", "right"]
    assert rows["planar_rr_a"]["working_modes"] == ["elbow+", "elbow-"]


@pytest.mark.parametrize("identifier", ROBOTS)
def test_info_shows_all_of_a_robot(identifier: str, cli: Cli) -> None:
    robot = krhpr.load(identifier)
    result = cli("info", identifier)
    assert result.code == 0
    assert robot.notation in result.out and robot.title in result.out
    for name in robot.functions:
        assert f"\n  {name} " in result.out
    for field in robot.geometry.order:
        assert f"\n  {field} = " in result.out
    for topic in ("actuators", "passive", "singular factors", "working mode", "assembly mode"):
        for name, _ in robot.documentation[topic]:
            assert f"\n  {name} " in result.out
    assert all(label in result.out for label in (*robot.modes, *robot.assemblies))
    assert f"{robot.default_mode}*" in result.out
    assert max(map(len, result.out.splitlines())) <= 110


@pytest.mark.parametrize("identifier", ROBOTS)
def test_info_as_json_is_complete(identifier: str, cli: Cli) -> None:
    robot = krhpr.load(identifier)
    facts = json.loads(cli("info", identifier, "--json").out)
    assert {f["function"] for f in facts["functions"]} == set(robot.functions)
    fields = {field["field"]: field for field in facts["geometry"]}
    assert list(fields) == list(robot.geometry.order)
    assert all(field["unit"] in ("m", "rad") and field["meaning"] for field in fields.values())
    assert all(fields[name]["default"] == getattr(robot.geometry, name).tolist() for name in fields)


@pytest.mark.parametrize("identifier", ROBOTS)
def test_info_of_every_function(identifier: str, cli: Cli) -> None:
    robot = krhpr.load(identifier)
    for name in robot.functions:
        result = cli("info", identifier, "--function", name)
        assert result.code == 0
        signature = robot.signature(name)
        for port in (*signature.inputs, *signature.outputs):
            assert f"\n  {port.name} (..." in result.out
        assert f"krhpr_{identifier}_{name}" in result.out
        facts = json.loads(cli("info", identifier, "--function", name, "--json").out)
        assert [port["name"] for port in facts["arguments"]] == [port.name for port in signature.inputs]


def test_a_function_with_modes_names_their_labels(cli: Cli) -> None:
    out = cli("info", "spatial_rrr_a", "--function", "inverse").out
    assert "mode  front/elbow+, front/elbow-, back/elbow+, back/elbow-" in out


def test_an_unknown_function_gives_the_nearest_names(cli: Cli) -> None:
    result = cli("info", "spatial_rrr_a", "--function", "invers")
    assert result.code == 2
    assert "has no function 'invers'; did you mean inverse" in result.err
