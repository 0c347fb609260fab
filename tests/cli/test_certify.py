"""`krhpr certify`: boxes in, verdicts and exit codes out."""

from __future__ import annotations

import json
import math
from typing import Any

import pytest

from tests.cli.support import Cli

BOX = ("--low", 30, "--high", 150, "--degrees")


def facts(cli: Cli, *arguments: object, code: int = 0) -> Any:
    result = cli("certify", *arguments, "--json")
    assert (result.code, result.err) == (code, "")
    return json.loads(result.out)


@pytest.mark.parametrize("robot", ["spatial_rrr_a", "spatial_r_fivebar_a", "planar_rr_a"])
def test_the_open_box_is_free(robot: str, cli: Cli) -> None:
    result = cli("certify", robot, *BOX, "--open")
    assert (result.code, result.err) == (0, "")
    assert result.out.startswith(f"{robot}: the box is free of type II singularities\n")
    assert "open box beta: (30, 30, 30) deg to (150, 150, 150) deg" in result.out
    assert "vertex test" in result.out


def test_the_closed_one_is_not(cli: Cli) -> None:
    result = cli("certify", "spatial_rrr_a", *BOX)
    assert result.code == 3
    assert "the box is singular at (30, 30, 150) deg" in result.out


def test_objects(cli: Cli) -> None:
    found = facts(cli, "spatial_rrr_a", "--low", 55, "--high", 175, "--degrees", code=3)
    assert found["verdict"] == "singular" and not found["free"] and found["unit"] == "deg"
    assert found["box"] == {"low": [55.0] * 3, "high": [175.0] * 3, "closed": True}
    assert all(55 < x < 175 for x in found["point"])
    first, second = found["factors"]
    assert first["factor"] == "det J_a" and first["point"] == found["point"]
    assert second["test"] == "closed form" and second["bound"] > 1 and second["point"] is None


def test_radians_are_the_default(cli: Cli) -> None:
    found = facts(cli, "planar_rr_a", "--low", 1, 1.1, 1.2, "--high", 2, 2.1, 2.2)
    assert found["unit"] == "rad" and found["box"]["low"] == [1.0, 1.1, 1.2]


def test_slides(cli: Cli) -> None:
    found = facts(cli, "spatial_rrr_c", "--low", -0.01, 0.05, 0.05, "--high", 0.15)
    assert found["free"] and found["unit"] == "m"
    assert facts(cli, "spatial_rrr_c", "--low", -0.1, "--high", 0.15, code=3)["point"]


def test_the_largest_box(cli: Cli) -> None:
    found = facts(cli, "spatial_rrr_a", "--largest", "--centre", 90, "--degrees")
    assert found["half_width"] == pytest.approx(60.0, abs=1e-12) and found["free"]
    assert found["beyond"]["verdict"] == "singular"
    result = cli("certify", "spatial_rrr_a", "--largest", "--centre", 90, "--degrees")
    assert result.code == 0 and result.out.startswith("largest half-width 60 deg\n")
    assert "a box larger by 1e-9 is singular at" in result.out
    found = facts(cli, "planar_rr_a", "--largest", "--centre", math.pi / 2, "--proportions", 1, 2, 1)
    low, high = found["box"]["low"], found["box"]["high"]
    assert high[1] - low[1] == pytest.approx(2 * (high[0] - low[0]))


def test_other_sizes(cli: Cli) -> None:
    found = facts(cli, "spatial_rrr_a", *BOX, "--open", "--geometry", "l_r=0.16")
    assert found["free"] and found["factors"][1]["test"] == "interval test"
    undecided = ("--low", -60, 240, 0, "--high", 50, 350, 110, "--degrees", "--geometry", "l_r=0.09375")
    text = cli("certify", "spatial_rrr_a", *undecided)
    assert text.code == 3 and "left: (" in text.out


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("spatial_rrr_a",), "give a box by --low and --high"),
        (("spatial_rrr_a", "--low", 1), "give a box by --low and --high"),
        (("spatial_rrr_a", "--low", 1, "--high", 2, "--centre", 1), "give a box by --low and --high"),
        (("spatial_rrr_a", "--largest"), "--largest takes --centre"),
        (("spatial_rrr_a", "--largest", "--centre", 1, "--open"), "--largest takes --centre"),
        (
            ("spatial_rrr_a", "--low", 1, 2, "--high", 2),
            "found 2 numbers, expected one for all legs or three",
        ),
        (("spatial_rrr_a", "--low", 2, "--high", 1), "low must be below high"),
        (("spatial_rrr_a", "--low", 0, "--high", 7), "more than a full turn"),
        (("spatial_rrr_a", "--low", "nan", "--high", 1), "it must be finite"),
        (("spatial_rrr_c", "--low", 0, "--high", 1, "--degrees"), "are slides, in metres"),
        (("spatial_rrr_a", "--low", 0, "--high", 1, "--geometry", "l=1"), "has no field 'l'"),
        (("spatial_rr_a", "--low", 0, "--high", 1), "did you mean spatial_rrr_a"),
    ],
)
def test_wrong_use(arguments: tuple[object, ...], message: str, cli: Cli) -> None:
    result = cli("certify", *arguments)
    assert (result.code, result.out) == (2, "")
    assert message in result.err
