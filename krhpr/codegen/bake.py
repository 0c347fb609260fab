"""A geometry as constants: the prepared C structure with its numbers written out.

What is prepared is computed with many digits and rounded once, so that the text is the same on every machine.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import mpmath

from krhpr.codegen.composition import RobotCode
from krhpr.codegen.evaluate import Arithmetic, prepare_geometry
from krhpr.codegen.graph import Op
from krhpr.codegen.kernel import LEGS
from krhpr.codegen.passes import Part

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


def baked_geometry(robot: RobotCode, name: str, geometry: Mapping[str, Sequence[float]] | None = None) -> str:
    """`static const krhpr_<robot>_geometry <name> = {...};`, every field and everything prepared from
    them.
    """
    values = robot.default_geometry if geometry is None else geometry
    members = [
        f"    .{member} = {{\n" + ",\n".join(_leg(part, values, leg) for leg in range(LEGS)) + "\n    }"
        for member, part in (("subleg", robot.subleg), ("platform", robot.platform))
    ]
    return f"static const krhpr_{robot.identifier}_geometry {name} = {{\n" + ",\n".join(members) + "\n};\n"


def _leg(part: Part, values: Mapping[str, Sequence[float]], leg: int) -> str:
    assert part.geometry is not None
    fields = {field.name: _DIGITS.mpf(float(values[field.name][leg])) for field in part.geometry.fields}
    prepared = prepare_geometry(part.geometry, fields, _PRECISE)
    scalars = {field.name for field in part.geometry.fields}
    texts = []
    for name, numbers in prepared.items():
        digits = ", ".join(repr(float(number)) for number in numbers)
        texts.append(f".{name} = {digits}" if name in scalars else f".{name} = {{{digits}}}")
    return "        { " + ", ".join(texts) + " }"
