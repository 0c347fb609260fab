"""Kernels and geometry as the C templates see them."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass

from krhpr.codegen.kernel import GEOMETRY_PREFIX, GeometryType, Kernel, Port
from krhpr.codegen.part import Part
from krhpr.codegen.printers.c import input_text, lane_text, print_kernel, print_lanes
from krhpr.codegen.printers.infix import Body, Line, Pair
from krhpr.codegen.robot_code import RobotCode
from krhpr.codegen.targets.base import kernel_comment
from krhpr.codegen.targets.c_numbers import LANES, NUMBER, Writing


@dataclass(frozen=True)
class KernelView:
    """A kernel as the template sees it."""

    symbol: str
    comment: str
    parameters: tuple[str, ...]
    unused: tuple[str, ...]
    lines: tuple[tuple[str, str], ...]
    stores: tuple[tuple[str, str], ...]


def kernel_view(part: str, kernel: Kernel, writing: Writing = NUMBER) -> KernelView:
    """A kernel with its lines printed in C, over one number or over lanes."""
    body = print_kernel(kernel) if writing is NUMBER else print_lanes(kernel)
    used = {ref.port.split(".")[0] for ref in body.inputs_used}
    parameters = [f"const krhpr_{part}_geometry *g", "int i"] if kernel.geometry else []
    parameters += [_parameter(port, writing=writing) for port in kernel.inputs]
    parameters += [_parameter(port, output=True, writing=writing) for port in kernel.outputs]
    unused = [port.name for port in kernel.inputs if port.name not in used]
    if kernel.geometry and "g" not in used:
        unused[:0] = ["g", "i"]
    loads = [] if writing is NUMBER else _loads(kernel, body)
    stores = (
        (_element(port, index, output=True), text)
        for port in kernel.outputs
        for index, text in enumerate(body.results[port.name])
    )
    return KernelView(
        f"krhpr_{part}_{kernel.name}{writing.suffix}",
        kernel_comment(kernel),
        tuple(parameters),
        tuple(unused),
        (*loads, *(_statement(line, str, writing) for line in body.lines)),
        tuple(stores),
    )


def prepare_view(part: str, kernel: Kernel) -> KernelView:
    """The kernel that prepares a geometry: it reads and writes members of the structure."""
    body = print_kernel(kernel)
    stores = (
        (f"g->{_element(port, index)}[i]", _fields_of_g(kernel, text))
        for port in kernel.outputs
        for index, text in enumerate(body.results[port.name])
    )
    return KernelView(
        f"krhpr_{part}_prepare",
        kernel_comment(kernel),
        (f"krhpr_{part}_geometry *g", "int i"),
        (),
        tuple(_statement(line, lambda text: _fields_of_g(kernel, text)) for line in body.lines),
        tuple(stores),
    )


def _loads(kernel: Kernel, body: Body) -> list[tuple[str, str]]:
    """Statements that bring the numbers of the geometry into lanes, in the order of the structure."""
    fields = sorted(
        (ref for ref in body.inputs_used if ref.port.startswith(GEOMETRY_PREFIX)),
        key=lambda ref: (_place(kernel, ref.port.removeprefix(GEOMETRY_PREFIX)), ref.index),
    )
    return [
        (
            f"const {LANES.real} {lane_text(kernel, ref)} = "
            f"krhpr_of_leg({input_text(kernel, ref).removesuffix('[i]')}, i);",
            "",
        )
        for ref in fields
    ]


def _place(kernel: Kernel, field: str) -> int:
    """Where a member stands in its part's structure."""
    assert kernel.geometry is not None
    names = [entry.name for entry in kernel.geometry.fields]
    names += [port.name for port in kernel.geometry.prepare.outputs]
    return names.index(field)


def _statement(
    line: Line | Pair, rewrite: Callable[[str], str], writing: Writing = NUMBER
) -> tuple[str, str]:
    """A statement and the remark behind it."""
    if isinstance(line, Pair):
        names = f"{writing.real} {line.sine}, {line.cosine};"
        arguments = f"{rewrite(line.argument)}, &{line.sine}, &{line.cosine}"
        return f"{names} {writing.prefix}sincos({arguments});", ""
    return f"const {writing.real} {line.name} = {rewrite(line.expression)};", line.note


def _fields_of_g(kernel: Kernel, text: str) -> str:
    """`prepare` reads the geometry's own fields: scalar parameters become members."""
    names = "|".join(sorted((re.escape(port.name) for port in kernel.inputs), key=len, reverse=True))
    return re.sub(rf"(?<![\w>.])({names})(?![\w\[])", r"g->\1[i]", text)


def _parameter(port: Port, *, output: bool = False, writing: Writing = NUMBER) -> str:
    if output:
        return f"{writing.array} *KRHPR_RESTRICT {port.name}"
    return f"const {writing.array} {port.name}[{port.size}]" if port.shape else f"{writing.real} {port.name}"


def _element(port: Port, index: int, *, output: bool = False) -> str:
    if port.shape:
        return f"{port.name}[{index}]"
    return f"*{port.name}" if output else port.name


def geometry_view(geometry: GeometryType | None) -> dict[str, list[tuple[str, str]]]:
    """Members of a part's structure, arrays over the legs: what a person sets, what `prepare` computes."""
    if geometry is None:
        return {"fields": [], "prepared": []}
    fields = [
        (f"double {field.name}[KRHPR_PLACES];", f"{field.doc} ({field.unit})") for field in geometry.fields
    ]
    prepared = [
        (f"double {port.name}[{port.size}][KRHPR_PLACES];", port.doc) for port in geometry.prepare.outputs
    ]
    return {"fields": fields, "prepared": prepared}


def field_names(part: Part) -> list[str]:
    """Names of the fields that a person sets."""
    assert part.geometry is not None
    return [field.name for field in part.geometry.fields]


def field_count(robot: RobotCode) -> int:
    """Number of fields of all legs."""
    return robot.legs * (len(field_names(robot.subleg)) + len(field_names(robot.platform)))


def positive_fields(robot: RobotCode) -> list[str]:
    """Members that must be positive."""
    found = []
    for member, part in (("subleg", robot.subleg), ("platform", robot.platform)):
        assert part.geometry is not None
        found += [f"{member}.{field.name}[i]" for field in part.geometry.fields if field.positive]
    return found


def default_rows(robot: RobotCode) -> list[str]:
    """Default fields, a row for each leg."""
    names = [*field_names(robot.subleg), *field_names(robot.platform)]
    return [", ".join(repr(robot.default_geometry[name][leg]) for name in names) for leg in range(robot.legs)]
