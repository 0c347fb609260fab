"""`krhpr list`: the robots of the catalogue."""

from __future__ import annotations

import argparse
import json
import re
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import krhpr
from krhpr.cli.common import Column, Command, Exit, WrongUse, print_table
from krhpr.cli.plugin_option import add_plugin_option, known_robots, own_robots, plugin_entries
from krhpr.errors import nearest
from krhpr.robot_files.facts import choice

if TYPE_CHECKING:
    from krhpr.robot import Robot

COLUMNS = (
    Column("robot", whole=True),
    Column("notation", whole=True),
    Column("dof", whole=True),
    Column("actuators", whole=True),
    Column("working", numeric=True),
    Column("assembly", whole=True),
    Column("singular factors of det M; det J"),
    Column("thesis"),
)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The command's arguments."""
    parser.add_argument("--space", metavar="SPACE", help="spatial or planar robots alone")
    parser.add_argument("--sub-leg", metavar="NAME", help="robots with this sub-leg alone, such as rrr")
    parser.add_argument("--arrangement", metavar="LETTER", help="robots of arrangement a, b or c alone")
    add_plugin_option(parser)
    parser.add_argument("--json", action="store_true", help="print a list of objects, with more about each")


def run(options: argparse.Namespace) -> int:
    """Print a row for each robot."""
    wanted = (options.space, options.sub_leg, options.arrangement)
    own = plugin_entries(options.plugin)
    identifiers = chosen(known_robots(own), wanted)
    robots = [krhpr.load(name, backend="numpy") for name in identifiers if name in krhpr.catalogue()]
    robots += own_robots(own, identifiers)
    if options.json:
        print(json.dumps([facts(robot) for robot in robots], indent=1))
    else:
        print_table(COLUMNS, [_row(facts(robot)) for robot in robots])
    return Exit.OK


def chosen(identifiers: Sequence[str], wanted: Sequence[str | None]) -> list[str]:
    """The robots of a space, a sub-leg and an arrangement, None being any."""
    for place, value in enumerate(wanted):
        known = list(dict.fromkeys(choice(identifier)[place] for identifier in identifiers))
        if value is not None and value not in known:
            what = ("space", "sub-leg", "arrangement")[place]
            raise WrongUse(f"no robot has the {what} {value!r}; {nearest(value, known)}")
    return [
        identifier
        for identifier in identifiers
        if all(value in (None, own) for value, own in zip(wanted, choice(identifier), strict=True))
    ]


def facts(robot: Robot) -> dict[str, Any]:
    """A robot as JSON values."""
    about = {topic: dict(rows) for topic, rows in robot.documentation.items()}
    platform, redundancy = robot.degrees_of_freedom
    space, subleg, arrangement = choice(robot.identifier)
    return {
        "robot": robot.identifier,
        "space": space,
        "sub_leg": subleg,
        "arrangement": arrangement,
        "notation": robot.notation,
        "title": robot.title,
        "degrees_of_freedom": platform,
        "redundancy": redundancy,
        "actuators": {name: about["joint kinds"][name] for name in about["actuators"]},
        "working_modes": robot.modes,
        "default_mode": robot.default_mode,
        "assembly_modes": robot.assemblies,
        "assembly_mode_count": int(about["assemblies"]["count"]),
        "assembly_mode_by_point": about["assemblies"]["chosen by"] == "point",
        "singular_factors": about["singular factors"],
        "type_2_factors": robot.signature("type_2_of_redundant").outputs[0].labels,
        "type_2": about["type II"]["singular set"],
        "thesis": about["sections"],
    }


def _row(about: dict[str, Any]) -> tuple[object, ...]:
    letters = " ".join(kind[0].upper() for kind in about["actuators"].values())
    count = about["assembly_mode_count"]
    type_2 = [factor.removeprefix("det ") for factor in about["type_2_factors"]]
    at_most = "up to " if count > 2 else ""
    by_point = " by point" if about["assembly_mode_by_point"] else ""
    return (
        about["robot"],
        about["notation"],
        f"{about['degrees_of_freedom']}+{about['redundancy']}",
        f"3 x {len(about['actuators'])}: {letters}",
        len(about["working_modes"]),
        f"{at_most}{count}{by_point}",
        f"{_short(list(about['singular_factors']))}; {', '.join(type_2)}",
        about["thesis"]["sub-leg"],
    )


def _short(names: Sequence[str]) -> str:
    """Names in a row; those that differ in a number alone once: `chain_1 to 3, volume`."""
    found: dict[str, list[str]] = {}
    for name in names:
        match = re.fullmatch(r"(.+_)(\d)", name)
        found.setdefault(match[1] if match else name, []).append(match[2] if match else "")
    return ", ".join(
        stem + (f"{numbers[0]} to {numbers[-1]}" if len(numbers) > 1 else numbers[0])
        for stem, numbers in found.items()
    )


COMMAND = Command(
    "list",
    "List the robots.  Modes, working and assembly ones, are those of one leg; dof are those of the platform "
    "and the redundant ones; R and P are actuated joints.  `krhpr info ROBOT` says more.",
    "examples:\n  krhpr list\n  krhpr list --space planar --arrangement a\n  krhpr list --sub-leg rrr\n"
    "  krhpr list --json",
    add_arguments,
    run,
)
