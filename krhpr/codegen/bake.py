"""A geometry as constants: the prepared C structure with its numbers written out.

What is prepared is computed with many digits and rounded once, so that the text is the same on every machine.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import mpmath

from krhpr.codegen.evaluate import Arithmetic, prepare_geometry
from krhpr.codegen.graph import Op
from krhpr.codegen.kernel import PLACES
from krhpr.codegen.part import Part
from krhpr.codegen.robot_code import RobotCode

_DIGITS = mpmath.MPContext()
_DIGITS.dps = 50


def _larger(a: Any, b: Any) -> Any:
    return a if a > b else b


_PRECISE = Arithmetic(
    lambda value: _DIGITS.mpf(value.numerator) / value.denominator,
    {
        Op.SQRT: _DIGITS.sqrt,
        Op.SIN: _DIGITS.sin,
        Op.COS: _DIGITS.cos,
        Op.ATAN2: _DIGITS.atan2,
        Op.ABS: abs,
        Op.MIN: lambda a, b: -_larger(-a, -b),
        Op.MAX: _larger,
    },
)


Values = Mapping[str, Sequence[float]]
"""Fields and what is prepared from them by name, flat: the members of one leg's C structure, in order."""


def baked_geometry(robot: RobotCode, name: str, geometry: Mapping[str, Sequence[float]] | None = None) -> str:
    """`static const krhpr_<robot>_geometry <name> = {...};`, every field and everything prepared from
    them.
    """
    members = [
        f"    .{member} = {{\n{_c_member(robot.parts[member], legs)}\n    }}"
        for member, legs in baked_values(robot, geometry).items()
    ]
    return f"static const krhpr_{robot.identifier}_geometry {name} = {{\n" + ",\n".join(members) + "\n};\n"


def baked_values(
    robot: RobotCode, geometry: Mapping[str, Sequence[float]] | None = None
) -> dict[str, list[Values]]:
    """For `subleg` and `platform`, the values of each leg as doubles."""
    sizes = robot.default_geometry if geometry is None else geometry
    return {
        member: [_prepared(robot.parts[member], sizes, leg) for leg in range(robot.legs)]
        for member in ("subleg", "platform")
    }


def scalars(part: Part) -> set[str]:
    """Names of the values that are single numbers: the fields."""
    assert part.geometry is not None
    return {field.name for field in part.geometry.fields}


def _prepared(part: Part, sizes: Mapping[str, Sequence[float]], leg: int) -> Values:
    assert part.geometry is not None
    fields = {field.name: _DIGITS.mpf(float(sizes[field.name][leg])) for field in part.geometry.fields}
    prepared = prepare_geometry(part.geometry, fields, _PRECISE)
    return {name: [float(number) for number in numbers] for name, numbers in prepared.items()}


def _c_member(part: Part, legs: Sequence[Values]) -> str:
    """The members of a part's structure: each number of all legs, the last one where places are left."""
    texts = []
    for name in legs[0]:
        places = [leg[name] for leg in (*legs, *[legs[-1]] * (PLACES - len(legs)))]
        rows = [f"{{{', '.join(map(repr, row))}}}" for row in zip(*places, strict=True)]
        value = rows[0] if name in scalars(part) else f"{{{', '.join(rows)}}}"
        texts.append(f"        .{name} = {value}")
    return ",\n".join(texts)
