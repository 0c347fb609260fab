"""A robot file as checked values: name, robot of the catalogue, sizes, limits, home pose.

Mistakes are collected and raised together as RobotFileError; suspicions are warnings.
"""

from __future__ import annotations

import re
import warnings
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

from krhpr.errors import nearest
from krhpr.limits import Limits
from krhpr.robot_files.facts import Facts, Legs, choice
from krhpr.robot_files.geometry import read_geometry
from krhpr.robot_files.home import Home, read_home
from krhpr.robot_files.limits import read_limits
from krhpr.robot_files.names import LONGEST, wrong_name
from krhpr.robot_files.problems import Problems, RobotFileError, RobotFileWarning, described, shown
from krhpr.robot_files.tree import Table, Text, is_text, read_tree
from krhpr.robot_files.tree import described as what

FIELDS = ("name", "space", "subleg", "arrangement", "geometry", "home", "limits")
"""Fields of a robot file, in the order of the documentation."""

ENDINGS = (".yaml", ".yml")
"""How the name of a robot file ends."""


@dataclass(frozen=True)
class RobotFile:
    """What a robot file says.  `lines` are those of its fields, by dotted name, for messages."""

    path: str
    name: str
    identifier: str
    sizes: dict[str, Legs]
    limits: Limits
    home: Home | None
    lines: dict[str, int]

    def wrong(self, field: str, message: str) -> RobotFileError:
        """An error about one field."""
        problems = Problems(self.path)
        line = self.lines.get(field) or self.lines.get(field.partition(".")[0], 0)
        problems.wrong(line, field, message)
        return RobotFileError(self.path, tuple(problems.mistakes))


def is_robot_file(name: str) -> bool:
    """Whether a name is that of a file and not of a robot in the catalogue."""
    return name.lower().endswith(ENDINGS) or "/" in name or "\\" in name


def read_robot_file(path: Path, catalogue: Sequence[str], facts_of: Callable[[str], Facts]) -> RobotFile:
    """Read and check a robot file; `facts_of` gives the facts of a robot of the catalogue.

    Raises RobotFileError for what is wrong, OSError where there is no file.  Suspicious values are told as
    RobotFileWarning.
    """
    problems = Problems(str(path))
    root = read_tree(path)
    for field, line in root.lines.items():
        if field not in FIELDS:
            problems.wrong(
                line,
                field if field.isidentifier() else "",
                f"unknown field {shown(field)}; {nearest(field, FIELDS)}",
            )
    name = _name(path, root, catalogue, problems)
    identifier = _identifier(root, catalogue, problems)
    problems.stop_if_any()  # which sizes and joints there are depends on the robot
    facts = facts_of(identifier)
    sizes = read_geometry(root, facts, problems)
    limits = read_limits(root, facts, problems)
    home = read_home(root, facts, problems)
    problems.stop_if_any()
    for suspicion in problems.suspicions:
        warnings.warn(described(str(path), suspicion), RobotFileWarning, stacklevel=5)
    return RobotFile(str(path), name, identifier, sizes, limits, home, _lines(root))


def _name(path: Path, root: Table, catalogue: Iterable[str], problems: Problems) -> str:
    """The robot's name: that of the file unless it gives another."""
    node = root.entries.get("name")
    if node is None:
        name = path.name[: -len(path.suffix)] if path.suffix else path.name
        wrong = wrong_name(name, catalogue)
        if wrong:
            problems.wrong(0, "name", f"is that of the file unless the field gives another: {wrong}")
        return name
    if not isinstance(node, Text) or not is_text(node):
        problems.wrong(
            root.lines["name"], "name", f"found {what(node)}, expected a name of {LONGEST} characters at most"
        )
        return ""
    wrong = wrong_name(node.text, catalogue)
    if wrong:
        problems.wrong(root.lines["name"], "name", wrong)
    return node.text


def _identifier(root: Table, catalogue: Sequence[str], problems: Problems) -> str:
    """The robot of the catalogue that space, sub-leg and arrangement choose."""
    known = [choice(identifier) for identifier in catalogue]
    chosen: list[str] = []
    for place, field in enumerate(("space", "subleg", "arrangement")):
        here = [parts for parts in known if list(parts[:place]) == chosen]
        allowed = sorted({parts[place] for parts in here})
        found = _one_of(field, root, allowed, chosen, problems)
        if found is None:
            return ""
        chosen.append(found)
    return "_".join(chosen)


def _one_of(
    field: str, root: Table, allowed: Sequence[str], chosen: Sequence[str], problems: Problems
) -> str | None:
    of = f" for {'_'.join(chosen)}" if chosen else ""
    node = root.entries.get(field)
    if node is None:
        problems.wrong(
            0, field, f"is missing; {'give one of' if len(allowed) > 1 else 'give'} {', '.join(allowed)}"
        )
        return None
    if isinstance(node, Text) and is_text(node) and node.text in allowed:
        return node.text
    hint = f"; {nearest(node.text, allowed)}" if isinstance(node, Text) and _near(node.text, allowed) else ""
    problems.wrong(
        root.lines[field], field, f"found {what(node)}, expected one of {', '.join(allowed)}{of}{hint}"
    )
    return None


def _near(text: str, allowed: Sequence[str]) -> bool:
    return bool(re.fullmatch(r"\w{1,60}", text, re.ASCII)) and nearest(text, allowed).startswith("did")


def _lines(root: Table) -> dict[str, int]:
    found: dict[str, int] = {}

    def walk(table: Table, prefix: str) -> None:
        for field, node in table.entries.items():
            found[prefix + field] = table.lines[field]
            if isinstance(node, Table):
                walk(node, f"{prefix}{field}.")

    walk(root, "")
    return found
