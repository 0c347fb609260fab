"""The sizes that a robot file gives: read, held to what the robot requires, and looked at for wrong units."""

from __future__ import annotations

import math

from krhpr.derivations.requirements import CHECKS, Requirement
from krhpr.robot_files.facts import Facts, Field, Legs
from krhpr.robot_files.problems import Problems
from krhpr.robot_files.quantities import Kind, has_unit
from krhpr.robot_files.tree import Node, Table
from krhpr.robot_files.values import for_legs, known_fields, quantity, table_of

LARGE = 10.0
"""Metres; who writes more than this hardly means metres."""

SMALL = 5e-4
"""Metres; a positive length below this hardly is one."""


def read_geometry(root: Table, facts: Facts, problems: Problems) -> dict[str, Legs]:
    """Every field for every leg: the file's values, else the catalogue's."""
    sizes = {field.name: field.default for field in facts.fields}
    table = table_of(root, "geometry", "geometry", problems)
    if table is None:
        return sizes
    by_name, mistakes = {field.name: field for field in facts.fields}, len(problems.mistakes)
    for name, node, line in known_fields(table, "geometry", list(by_name), facts.identifier, problems):
        found = _read(node, line, by_name[name], problems)
        if found is not None:
            sizes[name] = found
    if len(problems.mistakes) == mistakes:
        _requirements(facts, sizes, table, root, problems)
    return sizes


def _read(node: Node, line: int, field: Field, problems: Problems) -> Legs | None:
    path = f"geometry.{field.name}"

    def one(value: Node, at: int, where: str) -> float | None:
        least = 0.0 if field.positive else None
        found = quantity(value, at, where, field.kind, problems, least=least, strict=True)
        if found is not None:
            _suspicions(value, found, at, where, field, problems)
        return found

    return for_legs(node, line, path, one, problems, pairs=False)


def _suspicions(node: Node, value: float, line: int, path: str, field: Field, problems: Problems) -> None:
    told = suspicion(node, value, field.kind)
    if told:
        problems.suspicious(line, path, told)


def suspicion(node: Node, value: float, kind: Kind, small: float = SMALL) -> str:
    """What a size is suspected of: a unit wrong by a thousand, or degrees for radians; or nothing.

    Lengths below `small` are suspected too.
    """
    size = abs(value)
    if kind is Kind.ANGLE:
        if size > 2 * math.pi and not has_unit(node):
            return f"{value:g} rad is more than a turn; with degrees in mind write `{value:g} deg`"
    elif size >= LARGE:
        hint = "" if has_unit(node) else f"; with millimetres in mind write `{value:g} mm`"
        return f"{value:g} m is very long{hint}"
    elif 0.0 < size < small:
        hint = f"; with {value:g} km in mind write `{1000 * value:g} m`" if not has_unit(node) else ""
        return f"{value:g} m is very short{hint}"
    return ""


def _requirements(
    facts: Facts, sizes: dict[str, Legs], table: Table, root: Table, problems: Problems
) -> None:
    for name in facts.requirements:
        why = CHECKS[Requirement(name)](sizes)
        if why:
            line = table.lines.get("l_r") or next(iter(table.lines.values()), root.lines["geometry"])
            problems.wrong(line, "geometry", why)
