"""A geometry as constants: the prepared C structure with its numbers written out."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from krhpr.codegen.composition import RobotCode
from krhpr.codegen.evaluate import prepare_geometry
from krhpr.codegen.kernel import LEGS
from krhpr.codegen.passes import Part


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
    fields = {field.name: float(values[field.name][leg]) for field in part.geometry.fields}
    prepared = prepare_geometry(part.geometry, fields)
    scalars = {field.name for field in part.geometry.fields}
    texts = []
    for name, numbers in prepared.items():
        digits = ", ".join(repr(float(number)) for number in numbers)
        texts.append(f".{name} = {digits}" if name in scalars else f".{name} = {{{digits}}}")
    return "        { " + ", ".join(texts) + " }"
