"""What the tests of robot files share: writing one, reading it, and what went wrong."""

from __future__ import annotations

import textwrap
from collections.abc import Callable
from functools import cache
from importlib import import_module
from pathlib import Path

import krhpr
from krhpr.robot_files import RobotFile, read_robot_file
from krhpr.robot_files.facts import Facts, facts_of_module
from krhpr.robot_files.problems import Problem, RobotFileError
from tests.support import ROOT

EXAMPLE = ROOT / "examples" / "my_robot.yaml"

FIVEBAR = "space: spatial\nsubleg: r_fivebar\narrangement: a\n"
"""Three lines that choose the flagship; what follows begins in line 4."""

PLANAR = "space: planar\nsubleg: rr\narrangement: a\n"

Write = Callable[[str], Path]
"""Writes a robot file (of text that may be indented) and returns where."""


def head(facts: Facts) -> str:
    """The lines that choose a robot."""
    return f"space: {facts.space}\nsubleg: {facts.subleg}\narrangement: {facts.arrangement}\n"


@cache
def facts_of(identifier: str) -> Facts:
    """The facts of a robot of the catalogue."""
    return facts_of_module(import_module(f"krhpr.generated.python.{identifier}"))


def read(path: Path) -> RobotFile:
    """What the reader makes of a file."""
    return read_robot_file(path, krhpr.catalogue(), facts_of)


def problems(path: Path) -> list[Problem]:
    """What is wrong with a file; empty where nothing is."""
    try:
        read(path)
    except RobotFileError as error:
        assert str(error).count("\n") == len(error.problems) - 1
        assert all(line.startswith(str(path)) for line in str(error).splitlines())
        return list(error.problems)
    return []


def the_problem(path: Path) -> Problem:
    """The only thing that is wrong."""
    (problem,) = problems(path)
    return problem


def dedent(text: str) -> str:
    """A text without the margin that it has in a test."""
    return textwrap.dedent(text).lstrip("\n")
