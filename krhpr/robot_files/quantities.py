"""Quantities as people write them: `0.125`, `125 mm`, `120 deg`, `5 N/mm`; a strict pattern and no more."""

from __future__ import annotations

import math
import re
from enum import StrEnum
from fractions import Fraction

from krhpr.robot_files.problems import shown
from krhpr.robot_files.tree import Node, Text, described

_NUMBER = r"[+-]?(?:(?:0|[1-9][0-9]*)(?:\.[0-9]*)?|\.[0-9]+)(?:[eE][+-]?[0-9]{1,3})?"
_LONGEST = 40


class Kind(StrEnum):
    """What a number measures; the value is the unit of plain numbers."""

    LENGTH = "m"
    ANGLE = "rad"
    NUMBER = "1"
    FORCE = "N"
    TORQUE = "N m"
    TIME = "s"
    FREQUENCY = "Hz"
    SPEED = "m/s"
    STIFFNESS = "N/m"
    DAMPING = "N s/m"
    INERTIA = "kg m2"

    @property
    def noun(self) -> str:
        """`a length`."""
        return _WORDS[self][0]

    @property
    def expected(self) -> str:
        """What a message says that is allowed."""
        return _WORDS[self][1]

    @property
    def units(self) -> tuple[str, ...]:
        """Units that may stand behind the number."""
        return tuple(_UNITS[self])


_UNITS: dict[Kind, dict[str, Fraction]] = {
    Kind.LENGTH: {"mm": Fraction(1, 1000), "cm": Fraction(1, 100), "m": Fraction(1)},
    Kind.ANGLE: {"deg": Fraction(1), "rad": Fraction(1)},
    Kind.NUMBER: {},
    Kind.FORCE: {"mN": Fraction(1, 1000), "N": Fraction(1)},
    Kind.TORQUE: {"mN m": Fraction(1, 1000), "N m": Fraction(1)},
    Kind.TIME: {"ms": Fraction(1, 1000), "s": Fraction(1)},
    Kind.FREQUENCY: {"kHz": Fraction(1000), "Hz": Fraction(1)},
    Kind.SPEED: {"mm/s": Fraction(1, 1000), "m/s": Fraction(1)},
    Kind.STIFFNESS: {"N/mm": Fraction(1000), "N/m": Fraction(1)},
    Kind.DAMPING: {"N s/mm": Fraction(1000), "N s/m": Fraction(1)},
    Kind.INERTIA: {"g cm2": Fraction(1, 10**7), "kg m2": Fraction(1)},
}

_WORDS = {
    Kind.LENGTH: ("a length", "a length in metres (0.125), or with its unit (125 mm, 12.5 cm, 0.125 m)"),
    Kind.ANGLE: ("an angle", "an angle in radians (2.09), or with its unit (120 deg, 2.09 rad)"),
    Kind.NUMBER: ("a number", "a number"),
    Kind.FORCE: ("a force", "a force in newtons (2), or with its unit (20 mN, 2 N)"),
    Kind.TORQUE: ("a torque", "a torque in newton metres (0.012), or with its unit (12 mN m, 0.012 N m)"),
    Kind.TIME: ("a time", "a time in seconds (0.005), or with its unit (5 ms, 0.005 s)"),
    Kind.FREQUENCY: ("a rate", "a rate in hertz (500), or with its unit (0.5 kHz, 500 Hz)"),
    Kind.SPEED: ("a speed", "a speed in metres per second (0.001), or with its unit (1 mm/s, 0.001 m/s)"),
    Kind.STIFFNESS: (
        "a stiffness",
        "a stiffness in newtons per metre (5000), or with its unit (5 N/mm, 5000 N/m)",
    ),
    Kind.DAMPING: (
        "a damping",
        "a damping in newton seconds per metre (400), or with its unit (0.4 N s/mm, 400 N s/m)",
    ),
    Kind.INERTIA: (
        "a moment of inertia",
        "a moment of inertia in kg m2 (4.2e-7), or with its unit (4.2 g cm2, 4.2e-7 kg m2)",
    ),
}


def pattern(kind: Kind) -> str:
    """The pattern of a text with a unit, as JSON Schema takes it (ECMAScript and Python read it alike)."""
    return rf"^{_NUMBER} *({'|'.join(kind.units)})$"


class BadQuantity(ValueError):
    """A value that is no quantity of its kind; the message says what was found and what is expected."""


def parse(node: Node, kind: Kind) -> float:
    """A value in SI units, rounded once.  Degrees become radians as `math.radians` makes them.

    Raises BadQuantity.
    """
    if not isinstance(node, Text):
        raise BadQuantity(f"found {described(node)}, expected {kind.expected}")
    text = node.text
    if len(text) > _LONGEST:
        raise BadQuantity(f"found {shown(text)}, expected {kind.expected}")
    match = re.fullmatch(rf"({_NUMBER})(?: *([A-Za-z][A-Za-z0-9/ ]*))?", text)
    if match is None:
        raise BadQuantity(f"found {described(node)}, expected {kind.expected}")
    unit = match[2]
    if unit is None and not node.plain:
        raise BadQuantity(f"found the text {shown(text)}, expected {kind.expected}; leave the quotes out")
    if unit is not None and unit not in _UNITS[kind]:
        raise BadQuantity(f"found {described(node)}, expected {kind.expected}")
    return _value(match[1], unit, kind, node)


def _value(number: str, unit: str | None, kind: Kind, node: Text) -> float:
    try:
        if unit == "deg":
            value = math.radians(float(number))
        else:
            value = float(Fraction(number) * (_UNITS[kind][unit] if unit else 1))
    except OverflowError:
        value = math.inf
    if not math.isfinite(value):
        raise BadQuantity(f"found {described(node)}, expected a finite number")
    return value


def has_unit(node: Node) -> bool:
    """Whether a length or an angle says its unit."""
    return isinstance(node, Text) and node.text[-1:].isalpha()
