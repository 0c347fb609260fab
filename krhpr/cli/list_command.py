"""`krhpr list`: the robots of the catalogue."""

from __future__ import annotations

import argparse
import json

import krhpr
from krhpr.cli.common import Column, Command, Exit, print_table


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The command's arguments."""
    parser.add_argument("--json", action="store_true", help="print a list of objects")


def run(options: argparse.Namespace) -> int:
    """Print a row for each robot."""
    robots = [krhpr.load(identifier, backend="numpy") for identifier in krhpr.catalogue()]
    rows = [
        {
            "robot": robot.identifier,
            "notation": robot.notation,
            "title": robot.title,
            "working_modes": robot.modes,
            "default_mode": robot.default_mode,
            "assembly_modes": robot.assemblies,
            "actuators": [name for name, _ in robot.documentation["actuators"]],
        }
        for robot in robots
    ]
    if options.json:
        print(json.dumps(rows, indent=1))
        return Exit.OK
    columns = (
        Column("robot", whole=True),
        Column("notation", whole=True),
        Column("title"),
        Column("working modes", numeric=True),
        Column("assembly modes", numeric=True),
        Column("actuators of a leg"),
    )
    print_table(
        columns,
        [
            (
                robot.identifier,
                robot.notation,
                robot.title,
                len(robot.modes),
                len(robot.assemblies) or 1,
                ", ".join(name for name, _ in robot.documentation["actuators"]),
            )
            for robot in robots
        ],
    )
    return Exit.OK


COMMAND = Command(
    "list",
    "List the robots.  Modes are those of one leg; `krhpr info ROBOT` names them.",
    "examples:\n  krhpr list\n  krhpr list --json",
    add_arguments,
    run,
)
