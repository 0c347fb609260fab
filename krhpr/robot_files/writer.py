"""A robot as the text of a robot file, which gives the same robot when it is read."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from krhpr.limits import Cone, Interval
from krhpr.robot import Robot
from krhpr.robot_files.facts import choice


def write_robot_file(path: Path, robot: Robot, *, remarks: Sequence[str] = ()) -> Path:
    """Write a robot file with the name, all sizes, the home pose and the limits of a robot.

    Every number has as many digits as it takes to be read as the same one; `remarks` are lines of comment.
    """
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(robot_file_text(robot, remarks=remarks), encoding="utf-8")
    return path


def robot_file_text(robot: Robot, *, remarks: Sequence[str] = ()) -> str:
    """The text of `write_robot_file`."""
    space, subleg, arrangement = choice(robot.identifier)
    lines = [f"# {remark}".rstrip() for remark in remarks]
    lines += [
        f"name: {robot.name}",
        f"space: {space}",
        f"subleg: {subleg}",
        f"arrangement: {arrangement}",
        "geometry:",
        *(f"  {name}: {_alike(values.tolist())}" for name, values in robot.geometry.fields.items()),
        "home:",
        f"  p: {_list(robot.home.p)}",
        f"  redundant: {_alike(robot.home.redundant)}",
    ]
    limits = list(_limits(robot))
    if limits:
        lines += ["limits:", *(f"  {line}" for line in limits)]
    return "\n".join(lines) + "\n"


def _limits(robot: Robot) -> Iterator[str]:
    limits = robot.limits
    passive: dict[str, Any] = dict(limits.passive)
    if limits.spherical is not None:
        passive["spherical"] = limits.spherical
    yield from _table("actuators", limits.actuators)
    yield from _table("passive", passive)
    yield from _table("link_radii", limits.link_radii)
    for name in ("clearance", "axis_distance", "elbow"):
        value = getattr(limits, name)
        if value is not None:
            yield f"{name}: {_value(value)}"


def _table(name: str, entries: Mapping[str, Sequence[Any]]) -> Iterator[str]:
    if entries:
        yield f"{name}:"
        yield from (f"  {entry}: {_alike(values)}" for entry, values in entries.items())


def _alike(values: Sequence[Any]) -> str:
    """One value where all legs have the same."""
    return _value(values[0]) if all(value == values[0] for value in values) else _list(values)


def _list(values: Sequence[Any]) -> str:
    return f"[{', '.join(map(_value, values))}]"


def _value(value: Any) -> str:
    if isinstance(value, Interval):
        return _list((value.low, value.high))
    if isinstance(value, Cone):
        return f"{{tilt: {value.tilt!r}, socket: {_list(value.socket)}, stud: {_list(value.stud)}}}"
    return repr(float(value))
