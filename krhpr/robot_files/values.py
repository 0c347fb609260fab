"""Values of a robot file that a table holds by name: for all legs at once, or for each of the three."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import TypeVar

from krhpr.errors import nearest
from krhpr.robot_files.problems import Problems, shown
from krhpr.robot_files.quantities import BadQuantity, Kind, parse
from krhpr.robot_files.tree import Items, Node, Table, described

LEGS = 3
T = TypeVar("T")


def table_of(parent: Table, field: str, path: str, problems: Problems) -> Table | None:
    """The table that a field holds; None where there is none, or something else (which is a mistake)."""
    node = parent.entries.get(field)
    if node is None or isinstance(node, Table):
        return node
    problems.wrong(parent.lines[field], path, f"found {described(node)}, expected a table of fields")
    return None


def known_fields(
    table: Table, path: str, known: Sequence[str], of: str, problems: Problems
) -> Iterator[tuple[str, Node, int]]:
    """Fields of a table with their values and lines; unknown ones are mistakes."""
    for name, node in table.entries.items():
        line = table.lines[name]
        if name in known:
            yield name, node, line
        elif known:
            problems.wrong(line, path, f"unknown field {shown(name)} of {of}; {nearest(name, known)}")
        else:
            problems.wrong(line, path, f"unknown field {shown(name)}; {of} has none here")


def for_legs(
    node: Node,
    line: int,
    path: str,
    read: Callable[[Node, int, str], T | None],
    problems: Problems,
    *,
    pairs: bool,
) -> tuple[T, T, T] | None:
    """A value for all legs, or a list of three; `pairs`: where a value is itself a list of two."""
    if isinstance(node, Items):
        lists = bool(node.items) and all(isinstance(item, (Items, Table)) for item in node.items)
        if lists or not pairs:
            return _three(node, line, path, read, problems)
    value = read(node, line, path)
    return None if value is None else (value, value, value)


def _three(
    node: Items, line: int, path: str, read: Callable[[Node, int, str], T | None], problems: Problems
) -> tuple[T, T, T] | None:
    if len(node.items) != LEGS:
        problems.wrong(line, path, f"found {described(node)}, expected one value, or three: one for each leg")
        return None
    a, b, c = (read(item, item.line, f"{path}[{leg}]") for leg, item in enumerate(node.items))
    return None if a is None or b is None or c is None else (a, b, c)


def quantity(
    node: Node,
    line: int,
    path: str,
    kind: Kind,
    problems: Problems,
    *,
    least: float | None = None,
    strict: bool = False,
) -> float | None:
    """A length or angle; a mistake where it is none, or below `least` (`strict`: or equal to it)."""
    try:
        value = parse(node, kind)
    except BadQuantity as error:
        problems.wrong(line, path, str(error))
        return None
    if least is not None and (value <= least if strict else value < least):
        relation = "greater than" if strict else "of at least"
        problems.wrong(line, path, f"found {described(node)}, expected {kind.noun} {relation} {least:g}")
        return None
    return value
