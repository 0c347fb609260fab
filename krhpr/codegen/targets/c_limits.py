"""Limits as a constant structure in C."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

from krhpr.codegen.kernel import LEGS
from krhpr.limits import Cone, Interval, Limits

_DOCS = {
    "actuators": "actuated joints (rad or m): lowest, highest",
    "passive": "passive revolute joints and slides (rad or m): lowest, highest",
    "link_radii": "radii of links as cylinders (m)",
}


@dataclass(frozen=True)
class Member:
    """A member of the structure: what it is, its declaration, and its value."""

    doc: str
    declarations: tuple[str, ...]
    value: str
    name: str


def limits_view(limits: Limits) -> tuple[Member, ...]:
    """The members that the template prints: only what is limited is there."""
    members = [_table(name, getattr(limits, name)) for name in _DOCS if getattr(limits, name)]
    if limits.spherical is not None:
        members.append(_spherical(limits.spherical))
    if limits.clearance is not None:
        doc = "least distance between the surfaces of links that no joint joins (m)"
        members.append(Member(doc, ("double clearance;",), repr(limits.clearance), "clearance"))
    if limits.axis_distance is not None:
        doc = "least distance of S_i from the first axis of its leg (m)"
        members.append(Member(doc, ("double axis_distance;",), repr(limits.axis_distance), "axis_distance"))
    if limits.elbow is not None:
        doc = "angle between the links that an elbow joins (rad): lowest, highest"
        members.append(Member(doc, ("double elbow[2];",), _number(limits.elbow), "elbow"))
    return tuple(members)


def _table(name: str, table: Mapping[str, Any]) -> Member:
    pairs = name != "link_radii"
    declarations = [f"double {entry}[{LEGS}]{'[2]' if pairs else ''};" for entry in table]
    values = [f".{entry} = {_braces(map(_number, legs))}" for entry, legs in table.items()]
    return Member(
        _DOCS[name],
        ("struct {", *(f"    {line}" for line in declarations), f"}} {name};"),
        _braces(values),
        name,
    )


def _spherical(cones: tuple[Cone, Cone, Cone]) -> Member:
    doc = (
        "spherical joints: largest angle (rad) between the socket's axis, in the frame of the sub-leg's last "
        "link, and the stud's, in that of the redundant link"
    )
    values = [
        _braces([repr(cone.tilt), _braces(map(repr, cone.socket)), _braces(map(repr, cone.stud))])
        for cone in cones
    ]
    declarations = ("struct {", "    double tilt, socket[3], stud[3];", f"}} spherical[{LEGS}];")
    return Member(doc, declarations, _braces(values), "spherical")


def _number(value: Interval | float) -> str:
    return _braces([repr(value.low), repr(value.high)]) if isinstance(value, Interval) else repr(value)


def _braces(texts: Iterable[str]) -> str:
    return "{" + ", ".join(texts) + "}"
