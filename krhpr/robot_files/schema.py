"""The JSON schema of robot files, by which editors complete and check them while one types.

It says the same as the reader wherever JSON Schema can; what concerns several values at once (limits the
wrong way round, circles that meet) only the reader finds.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from typing import Any

from krhpr.robot_files.facts import PLATFORM, Facts, Field, JointFact
from krhpr.robot_files.home import dimension, redundant_kind
from krhpr.robot_files.names import LONGEST, PATTERN
from krhpr.robot_files.quantities import Kind, pattern

Schema = dict[str, Any]

_UNIT_TEXT = {Kind.LENGTH: "m, or a text with mm, cm or m", Kind.ANGLE: "rad, or a text with deg or rad"}


def schema_text(robots: Sequence[Facts]) -> str:
    """The schema as the file that is published."""
    return json.dumps(schema(robots), indent=1, ensure_ascii=False) + "\n"


def schema(robots: Sequence[Facts]) -> Schema:
    """The schema for a catalogue of robots.

    What robots have in common (a joint of their sub-leg, say) stands once, below `$defs`.
    """
    shared = Shared()

    def names(of: str) -> list[str]:
        return sorted({getattr(facts, of) for facts in robots})

    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "$comment": "Written by `krhpr generate`; do not edit.",
        "title": "Robot file of krhpr",
        "description": "A robot of the catalogue with a name, sizes and limits of one's own. SI units.",
        "type": "object",
        "additionalProperties": False,
        "required": ["space", "subleg", "arrangement"],
        "properties": {
            "name": {
                "description": "Of files, C symbols and the Python module; that of the file unless given.",
                "type": "string",
                "pattern": PATTERN,
                "maxLength": LONGEST,
                "not": {"enum": sorted(facts.identifier for facts in robots)},
            },
            "space": {"description": "Where the platform moves.", "enum": names("space")},
            "subleg": {"description": "What carries each end point S_i.", "enum": names("subleg")},
            "arrangement": {
                "description": "How the end points hold the platform (Fig. 2.1).",
                "enum": names("arrangement"),
            },
            "geometry": {
                "description": "Lengths and angles; those of the catalogue where nothing is given.",
                "type": "object",
            },
            "home": {
                "description": "A pose at which the robot must close, its platform parallel to the base.",
                "type": "object",
            },
            "limits": {
                "description": "Limits of joints and links, carried into the code that is generated.",
                "type": "object",
            },
        },
        "anyOf": [_chosen(facts) for facts in robots],
        "allOf": [
            {"if": _chosen(facts), "then": {"properties": _of_robot(facts, shared)}} for facts in robots
        ],
        "$defs": {**_definitions(), **shared.definitions},
    }


class Shared:
    """Parts of the schema by their content, each with a name of its own."""

    def __init__(self) -> None:
        self.definitions: Schema = {}
        self._names: dict[str, str] = {}

    def __call__(self, stem: str, part: Schema) -> Schema:
        """A reference to a part, which is kept unless one like it is there."""
        text = json.dumps(part)
        if text not in self._names:
            taken = sum(name.rpartition(".")[0] == stem for name in self.definitions)
            self._names[text] = f"{stem}.{taken + 1}"
            self.definitions[self._names[text]] = part
        return {"$ref": f"#/$defs/{self._names[text]}"}

    def table(self, stem: str, fields: Schema) -> Schema:
        """An object with these fields and no others, by reference; so are its fields."""
        return self(stem, _object({name: self(name, field) for name, field in fields.items()}))


def _chosen(facts: Facts) -> Schema:
    parts = {"space": facts.space, "subleg": facts.subleg, "arrangement": facts.arrangement}
    return {
        "properties": {field: {"const": value} for field, value in parts.items()},
        "required": list(parts),
    }


def _of_robot(facts: Facts, shared: Shared) -> Schema:
    passive = {joint.name: _joint(joint) for joint in facts.passive}
    if facts.spherical is not None:
        passive[facts.spherical.name] = _spherical(facts.spherical)
    return {
        "geometry": shared.table("geometry", {field.name: _field(field) for field in facts.fields}),
        "home": shared("home", {**_object(_home(facts)), "required": ["p", "redundant"]}),
        "limits": _object(
            {
                "actuators": shared.table(
                    "actuators", {joint.name: _joint(joint) for joint in facts.actuators}
                ),
                "passive": shared.table("passive", passive),
                "link_radii": shared.table("link_radii", {link: _radius(link) for link in facts.links}),
                "clearance": {"$ref": "#/$defs/clearance"},
                **{name: {"$ref": f"#/$defs/{name}"} for name in facts.type_1},
            }
        ),
    }


def _home(facts: Facts) -> Schema:
    kind = redundant_kind(facts)
    return {
        "p": {
            "description": "Position of O' in the base frame (m).",
            "type": "array",
            "items": {"$ref": "#/$defs/length"},
            "minItems": dimension(facts),
            "maxItems": dimension(facts),
        },
        "redundant": {
            "description": f"Redundant coordinates ({_UNIT_TEXT[kind]}).",
            "$ref": f"#/$defs/{_name(kind)}_of_legs",
        },
    }


def _radius(link: str) -> Schema:
    name = "the platform's edges" if link == PLATFORM else link
    return {
        "description": f"Radius of {name} as a cylinder ({_UNIT_TEXT[Kind.LENGTH]}).",
        "$ref": "#/$defs/radius_of_legs",
    }


def _object(properties: Schema) -> Schema:
    return {"type": "object", "additionalProperties": False, "properties": properties}


def _field(field: Field) -> Schema:
    kind = "size" if field.positive else _name(field.kind)
    alike = len(set(field.default)) == 1
    return {
        "description": f"{field.doc} ({_UNIT_TEXT[field.kind]}).",
        "default": field.default[0] if alike else list(field.default),
        "$ref": f"#/$defs/{kind}_of_legs",
    }


def _joint(joint: JointFact) -> Schema:
    return {
        "description": f"{joint.doc}: [lowest, highest] ({_UNIT_TEXT[joint.kind]}).",
        "$ref": f"#/$defs/{_name(joint.kind)}_limits",
    }


def _spherical(joint: JointFact) -> Schema:
    return {
        "description": f"{joint.doc}: the largest angle between stud and socket ({_UNIT_TEXT[Kind.ANGLE]}).",
        "$ref": "#/$defs/cones",
    }


def _name(kind: Kind) -> str:
    return kind.name.lower()


def _quantity(kind: Kind, **numbers: Any) -> Schema:
    """A number, or a text with a unit; bounds in `numbers` hold for both (a text by its sign)."""
    text = pattern(kind)
    if "minimum" in numbers or "exclusiveMinimum" in numbers:
        text = text.replace("[+-]?", r"\+?", 1)
    return {"anyOf": [{"type": "number", **numbers}, {"type": "string", "pattern": text}]}


def _of_legs(name: str) -> Schema:
    one = {"$ref": f"#/$defs/{name}"}
    return {"anyOf": [one, {"type": "array", "items": one, "minItems": 3, "maxItems": 3}]}


def _interval(name: str) -> Schema:
    return {"type": "array", "items": {"$ref": f"#/$defs/{name}"}, "minItems": 2, "maxItems": 2}


def _definitions() -> Schema:
    direction = {"type": "array", "items": {"type": "number"}, "minItems": 3, "maxItems": 3}
    found: Schema = {
        "length": _quantity(Kind.LENGTH),
        "angle": _quantity(Kind.ANGLE),
        "size": _quantity(Kind.LENGTH, exclusiveMinimum=0),
        "radius": _quantity(Kind.LENGTH, minimum=0),
        "tilt": _quantity(Kind.ANGLE, exclusiveMinimum=0),
        "clearance": {
            "description": "Least distance between the surfaces of links that no joint joins "
            f"({_UNIT_TEXT[Kind.LENGTH]}).",
            "$ref": "#/$defs/radius",
        },
        "axis_distance": {
            "description": f"Least distance of S_i from the first axis ({_UNIT_TEXT[Kind.LENGTH]}).",
            "$ref": "#/$defs/radius",
        },
        "elbow": {
            "description": "Angle between the links that an elbow joins: [lowest, highest], between 0 and "
            f"180 deg ({_UNIT_TEXT[Kind.ANGLE]}).",
            "$ref": "#/$defs/angle_interval",
        },
        "cone": {
            "anyOf": [
                {"$ref": "#/$defs/tilt"},
                {
                    **_object(
                        {
                            "tilt": {
                                "description": "The largest angle between stud and socket.",
                                "$ref": "#/$defs/tilt",
                            },
                            "socket": {
                                "description": "The socket's axis in the frame of the sub-leg's last link.",
                                "default": [1, 0, 0],
                                **direction,
                            },
                            "stud": {
                                "description": "The stud's axis in the frame of the redundant link.",
                                "default": [0, 0, 1],
                                **direction,
                            },
                        }
                    ),
                    "required": ["tilt"],
                },
            ]
        },
    }
    for name in ("length", "angle", "size", "radius", "cone"):
        found["cones" if name == "cone" else f"{name}_of_legs"] = _of_legs(name)
    for name in ("length", "angle"):
        found[f"{name}_interval"] = _interval(name)
        found[f"{name}_limits"] = _of_legs(f"{name}_interval")
    return found
