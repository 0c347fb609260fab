"""`krhpr list` and `krhpr info`."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest

import krhpr
from tests.cli.support import Cli
from tests.support import with_cover

ROBOTS = krhpr.catalogue()


def test_list_has_a_row_for_each_robot(cli: Cli) -> None:
    result = cli("list")
    assert result.code == 0
    head, rule, *rows = result.out.splitlines()
    assert head.split("  ")[0] == "robot" and set(rule) == {"-", " "}
    assert [row.split()[0] for row in rows] == list(ROBOTS)
    for row in (
        r"spatial_rrr_a +3-RRRSR +6\+3 +3 x 3: R R R +4 +1 +shoulder, elbow; J_a, J_n +2\.3",
        r"spatial_rrrr_b +3-4RSP +6\+6 +3 x 4: R R R R +4 +1 .*",
        r"spatial_cpr3_c +3-\[\(3-CPR\)SP\] +6\+3 +3 x 3: P P P +1 +up to 8 by point +chain_1 to 3, .*",
        r"spatial_delta_a .* 8 +2 by point .*",
        r"planar_pr_a +3-PRRR +3\+3 +3 x 2: P R +2 +1 .*",
        r"planar_rrr_c +3-RRRRP +3\+6 .*",
    ):
        assert re.search(f"^{row}$", result.out, re.MULTILINE), row
    assert max(map(len, result.out.splitlines())) <= 160


def test_list_takes_filters(cli: Cli) -> None:
    def listed(*arguments: str) -> list[str]:
        return [row["robot"] for row in json.loads(cli("list", *arguments, "--json").out)]

    assert listed("--space", "planar") == [name for name in ROBOTS if name.startswith("planar")]
    assert listed("--sub-leg", "rrr", "--arrangement", "b") == ["spatial_rrr_b", "planar_rrr_b"]
    wrong = cli("list", "--sub-leg", "rrrrr")
    assert wrong.code == 2 and "did you mean" in wrong.err


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


@pytest.mark.parametrize("identifier", with_cover(ROBOTS))
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


def test_info_draws_a_picture_that_is_the_same_every_time(cli: Cli, tmp_path: Path) -> None:
    for ending in ("svg", "png"):
        files = [tmp_path / f"{name}.{ending}" for name in "ab"]
        for file in files:
            assert cli("info", "spatial_delta_a", "--picture", str(file)).code == 0
        assert files[0].read_bytes() == files[1].read_bytes()
    text = (tmp_path / "a.svg").read_text(encoding="utf-8")
    assert "<svg" in text and "<dc:date>" not in text
    wrong = cli("info", "spatial_delta_a", "--picture", str(tmp_path / "delta.bmp"))
    assert wrong.code == 2 and ".png" in wrong.err
