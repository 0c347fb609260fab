"""The home pose that a robot file may give: the platform stands there parallel to the base."""

from __future__ import annotations

from dataclasses import dataclass

from krhpr.robot_files.facts import Facts, Legs
from krhpr.robot_files.problems import Problems
from krhpr.robot_files.quantities import Kind
from krhpr.robot_files.tree import Items, Node, Table, described
from krhpr.robot_files.values import for_legs, known_fields, quantity, table_of

FIELDS = ("p", "redundant")
"""Fields of `home`."""


@dataclass(frozen=True)
class Home:
    """Position of O' (m) and redundant coordinates (rad or m); the orientation is that of the base."""

    p: tuple[float, ...]
    redundant: Legs


def read_home(root: Table, facts: Facts, problems: Problems) -> Home | None:
    """The home pose of a file; None where it gives none."""
    table = table_of(root, "home", "home", problems)
    if table is None:
        return None
    found = {name: (node, line) for name, node, line in known_fields(table, "home", FIELDS, "home", problems)}
    for name in FIELDS:
        if name not in found:
            problems.wrong(table.line, "home", f"{name} is missing; home takes {' and '.join(FIELDS)}")
    if len(found) < len(FIELDS):
        return None
    kind = redundant_kind(facts)
    p = _position(*found["p"], dimension(facts), problems)
    node, line = found["redundant"]
    redundant = for_legs(
        node,
        line,
        "home.redundant",
        lambda n, at, where: quantity(n, at, where, kind, problems),
        problems,
        pairs=False,
    )
    return None if p is None or redundant is None else Home(p, redundant)


def dimension(facts: Facts) -> int:
    """Coordinates of a point."""
    return 3 if facts.space == "spatial" else 2


def redundant_kind(facts: Facts) -> Kind:
    """What the redundant coordinate is: that of the platform's joint."""
    return next(joint.kind for joint in facts.passive if joint.name == "platform_joint")


def _position(node: Node, line: int, size: int, problems: Problems) -> tuple[float, ...] | None:
    if not isinstance(node, Items) or len(node.items) != size:
        example = ", ".join(["0", "0", "350 mm"][-size:])
        problems.wrong(
            line,
            "home.p",
            f"found {described(node)}, expected the {size} coordinates of O', such as [{example}]",
        )
        return None
    values = [quantity(item, item.line, "home.p", Kind.LENGTH, problems) for item in node.items]
    return None if None in values else tuple(value for value in values if value is not None)
