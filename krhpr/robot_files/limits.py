"""The limits that a robot file gives, as `krhpr.limits.Limits`."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

from krhpr.limits import Cone, Interval, Limits
from krhpr.robot_files.facts import Facts, JointFact
from krhpr.robot_files.problems import Problems
from krhpr.robot_files.quantities import Kind
from krhpr.robot_files.tree import Items, Node, Table, described
from krhpr.robot_files.values import for_legs, known_fields, quantity, table_of

FIELDS = ("actuators", "passive", "link_radii", "clearance")
"""Fields of `limits` of every robot; those of type I singularities depend on the robot."""

CONE = ("tilt", "socket", "stud")
"""Fields of a spherical joint's limit."""


def read_limits(root: Table, facts: Facts, problems: Problems) -> Limits:
    """The limits of a file; empty where it gives none."""
    table = table_of(root, "limits", "limits", problems)
    if table is None:
        return Limits()
    for _ in known_fields(table, "limits", (*FIELDS, *facts.type_1), "limits", problems):
        pass
    passive = _joints(
        table, "passive", [*facts.passive, *([facts.spherical] if facts.spherical else [])], facts, problems
    )
    spherical = passive.pop(facts.spherical.name, None) if facts.spherical else None

    def length(name: str) -> float | None:
        if name not in table.entries:
            return None
        return quantity(
            table.entries[name], table.lines[name], f"limits.{name}", Kind.LENGTH, problems, least=0.0
        )

    return Limits(
        _joints(table, "actuators", facts.actuators, facts, problems),
        passive,
        spherical,
        _radii(table, facts, problems),
        length("clearance"),
        length("axis_distance") if "axis_distance" in facts.type_1 else None,
        _elbow(table, problems) if "elbow" in facts.type_1 else None,
    )


def _elbow(limits: Table, problems: Problems) -> Interval | None:
    """The least and the largest angle between the links that an elbow joins."""
    if "elbow" not in limits.entries:
        return None
    node, line = limits.entries["elbow"], limits.lines["elbow"]
    found = _interval(node, line, "limits.elbow", Kind.ANGLE, problems)
    if found is not None and not (found.low >= 0 and found.high <= math.pi):
        problems.wrong(
            line,
            "limits.elbow",
            f"found [{found.low:g}, {found.high:g}] rad, expected angles between 0 and 180 deg",
        )
        return None
    return found


def _joints(
    limits: Table, group: str, joints: Sequence[JointFact], facts: Facts, problems: Problems
) -> dict[str, Any]:
    path = f"limits.{group}"
    table = table_of(limits, group, path, problems)
    found: dict[str, Any] = {}
    if table is None:
        return found
    by_name = {joint.name: joint for joint in joints}
    for name, node, line in known_fields(table, path, list(by_name), facts.identifier, problems):
        values = _limit(node, line, f"{path}.{name}", by_name[name], problems)
        if values is not None:
            found[name] = values
    return found


def _limit(node: Node, line: int, path: str, joint: JointFact, problems: Problems) -> Any:
    if joint.kind is Kind.NUMBER:
        return for_legs(
            node, line, path, lambda n, at, where: _cone(n, at, where, problems), problems, pairs=False
        )
    return for_legs(
        node,
        line,
        path,
        lambda n, at, where: _interval(n, at, where, joint.kind, problems),
        problems,
        pairs=True,
    )


def _interval(node: Node, line: int, path: str, kind: Kind, problems: Problems) -> Interval | None:
    if not isinstance(node, Items) or len(node.items) != 2:
        problems.wrong(
            line,
            path,
            f"found {described(node)}, expected [lowest, highest], or three of these: one for "
            f"each leg; each is {kind.expected}",
        )
        return None
    low, high = (quantity(item, item.line, path, kind, problems) for item in node.items)
    if low is None or high is None:
        return None
    if low >= high:
        problems.wrong(
            line, path, f"found [{low:g}, {high:g}] {kind}, expected the lower limit first, and a greater one"
        )
        return None
    if kind is Kind.ANGLE and max(abs(low), abs(high)) > 20 * math.pi:
        problems.suspicious(
            line,
            path,
            f"[{low:g}, {high:g}] rad is more than ten turns; with degrees in mind "
            f"write [{low:g} deg, {high:g} deg]",
        )
    return Interval(low, high)


def _cone(node: Node, line: int, path: str, problems: Problems) -> Cone | None:
    """A spherical joint's limit: an angle, or a table with the axes that it is measured between."""
    if not isinstance(node, Table):
        tilt = _tilt(node, line, path, problems)
        return None if tilt is None else Cone(tilt)
    entries = {
        name: (value, at) for name, value, at in known_fields(node, path, CONE, "a spherical joint", problems)
    }
    if "tilt" not in entries:
        problems.wrong(
            line, path, "tilt is missing: the largest angle between stud and socket, such as 60 deg"
        )
        return None
    value, at = entries["tilt"]
    tilt = _tilt(value, at, f"{path}.tilt", problems)
    axes = {
        name: _axis(value, at, f"{path}.{name}", problems)
        for name, (value, at) in entries.items()
        if name != "tilt"
    }
    if tilt is None or None in axes.values():
        return None
    return Cone(tilt, **{name: axis for name, axis in axes.items() if axis is not None})


def _tilt(node: Node, line: int, path: str, problems: Problems) -> float | None:
    tilt = quantity(node, line, path, Kind.ANGLE, problems, least=0.0, strict=True)
    if tilt is not None and tilt > math.pi:
        problems.wrong(
            line,
            path,
            f"found {described(node)}, expected an angle of at most 180 deg (the angle between two axes)",
        )
        return None
    return tilt


def _axis(node: Node, line: int, path: str, problems: Problems) -> tuple[float, float, float] | None:
    if not isinstance(node, Items) or len(node.items) != 3:
        problems.wrong(
            line, path, f"found {described(node)}, expected a direction: three numbers, such as [1, 0, 0]"
        )
        return None
    x, y, z = (quantity(item, item.line, path, Kind.NUMBER, problems) for item in node.items)
    if x is None or y is None or z is None:
        return None
    length = math.hypot(x, y, z)
    if not 1e-9 < length < 1e9:
        problems.wrong(
            line, path, f"found [{x:g}, {y:g}, {z:g}], expected a direction: not all of its numbers are zero"
        )
        return None
    return (x / length, y / length, z / length)


def _radii(limits: Table, facts: Facts, problems: Problems) -> Mapping[str, tuple[float, float, float]]:
    path = "limits.link_radii"
    table = table_of(limits, "link_radii", path, problems)
    found: dict[str, tuple[float, float, float]] = {}
    if table is None:
        return found
    for name, node, line in known_fields(table, path, facts.links, facts.identifier, problems):
        values = for_legs(
            node,
            line,
            f"{path}.{name}",
            lambda n, at, where: quantity(n, at, where, Kind.LENGTH, problems, least=0.0),
            problems,
            pairs=False,
        )
        if values is not None:
            found[name] = values
            if max(values) >= 1.0:
                problems.suspicious(
                    line,
                    f"{path}.{name}",
                    f"{max(values):g} m is very thick; with millimetres in mind write `{max(values):g} mm`",
                )
    return found
