"""The C99 target: one header per part with its kernels, one header and source per robot."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from math import prod

from krhpr.codegen.composition import (
    STATUS_DOC,
    Call,
    Guard,
    Relation,
    RobotCode,
    RobotFunction,
    Stage,
    Status,
    Variable,
    variables,
)
from krhpr.codegen.kernel import LEGS, GeometryType, Kernel, Layout, Port
from krhpr.codegen.passes import Part
from krhpr.codegen.printers.c import print_kernel
from krhpr.codegen.printers.infix import Line, Pair
from krhpr.codegen.targets.base import File, kernel_comment, port_text, render


@dataclass(frozen=True)
class _KernelView:
    """A kernel as the template sees it."""

    symbol: str
    comment: str
    parameters: tuple[str, ...]
    unused: tuple[str, ...]
    lines: tuple[tuple[str, str], ...]
    stores: tuple[tuple[str, str], ...]


@dataclass(frozen=True)
class _FunctionView:
    """A robot's function as the template sees it."""

    name: str
    symbol: str
    doc: str
    equations: str
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
    parameters: tuple[str, ...]
    optional: tuple[tuple[str, str], ...]
    finite: tuple[tuple[str, int], ...]
    fills: tuple[tuple[str, int], ...]
    zeros: tuple[tuple[str, int], ...]
    shared_locals: tuple[str, ...]
    leg_locals: tuple[str, ...]
    shared_calls: tuple[str, ...]
    leg_calls: tuple[str, ...]
    scatters: tuple[_Scatter, ...]
    platform_calls: tuple[str, ...]
    leg_guards: tuple[_GuardView, ...]
    platform_guards: tuple[_GuardView, ...]
    batch_arguments: tuple[str, ...]
    in_sizes: tuple[int, ...]
    out_sizes: tuple[int, ...]


@dataclass(frozen=True)
class _Scatter:
    """A leg's block copied to its place on the diagonal of the whole matrix."""

    block: str
    target: str
    rows: int
    columns: int
    width: int


@dataclass(frozen=True)
class _GuardView:
    condition: str
    status: str
    fills: tuple[tuple[str, int], ...]


class CTarget:
    """Prints C99."""

    name = "c"

    def shared(self) -> Iterable[File]:
        statuses = [(status.name, status.value, STATUS_DOC[status]) for status in Status]
        yield File("c/krhpr_elementary.h", render("c/krhpr_elementary.h.j2"))
        yield File("c/krhpr.h", render("c/krhpr.h.j2", statuses=statuses))

    def part(self, part: Part) -> Iterable[File]:
        kernels = [_kernel_view(part.name, kernel) for kernel in part.kernels]
        prepare = None
        if part.geometry is not None:
            prepare = _kernel_view(part.name, part.geometry.prepare)
        yield File(
            f"c/krhpr_{part.name}.h",
            render("c/part.h.j2", part=part, kernels=kernels, prepare=prepare, geometry=_geometry_view(part.geometry)),
        )

    def robot(self, robot: RobotCode) -> Iterable[File]:
        functions = [_function_view(robot, function) for function in robot.functions if function.calls]
        near = next((function for function in robot.functions if function.name == "inverse_near"), None)
        context = {
            "robot": robot,
            "functions": functions,
            "near": near,
            "subleg_fields": _field_names(robot.subleg),
            "platform_fields": _field_names(robot.platform),
            "positive": _positive_fields(robot),
            "default_geometry": _default_geometry(robot),
            "prototypes": [_prototype(robot, function) for function in robot.functions],
            "legs": LEGS,
        }
        yield File(f"c/krhpr_{robot.identifier}.h", render("c/robot.h.j2", **context))
        yield File(f"c/krhpr_{robot.identifier}.c", render("c/robot.c.j2", **context))


# -- kernels ----------------------------------------------------------------------------------------------------------


def _kernel_view(part: str, kernel: Kernel) -> _KernelView:
    body = print_kernel(kernel)
    used = {ref.port.split(".")[0] for ref in body.inputs_used}
    parameters = [f"const krhpr_{part}_geometry *g"] if kernel.geometry else []
    parameters += [_parameter(port) for port in kernel.inputs]
    unused = [port.name for port in kernel.inputs if port.name not in used]
    if kernel.geometry and "g" not in used:
        unused.insert(0, "g")
    if kernel.name == "prepare":
        parameters, unused = [f"krhpr_{part}_geometry *g"], []
        body_lines = tuple(_statement(line, lambda text: _fields_of_g(kernel, text)) for line in body.lines)
        stores = tuple(
            (f"g->{_element(port, index)}", _fields_of_g(kernel, text))
            for port in kernel.outputs
            for index, text in enumerate(body.results[port.name])
        )
        return _KernelView(f"krhpr_{part}_prepare", kernel_comment(kernel), tuple(parameters), (), body_lines, stores)
    parameters += [_parameter(port, output=True) for port in kernel.outputs]
    stores = tuple(
        (_element(port, index, output=True), text)
        for port in kernel.outputs
        for index, text in enumerate(body.results[port.name])
    )
    lines = tuple(_statement(line, str) for line in body.lines)
    return _KernelView(
        f"krhpr_{part}_{kernel.name}", kernel_comment(kernel), tuple(parameters), tuple(unused), lines, stores
    )


def _statement(line: Line | Pair, rewrite: Callable[[str], str]) -> tuple[str, str]:
    """A statement and the remark behind it."""
    if isinstance(line, Pair):
        names = f"double {line.sine}, {line.cosine};"
        return f"{names} krhpr_sincos({rewrite(line.argument)}, &{line.sine}, &{line.cosine});", ""
    return f"const double {line.name} = {rewrite(line.expression)};", line.note


def _fields_of_g(kernel: Kernel, text: str) -> str:
    """`prepare` reads the geometry's own fields: scalar parameters become members."""
    names = "|".join(sorted((re.escape(port.name) for port in kernel.inputs), key=len, reverse=True))
    return re.sub(rf"(?<![\w>.])({names})(?![\w\[])", r"g->\1", text)


def _parameter(port: Port, *, output: bool = False) -> str:
    if output:
        return f"double *KRHPR_RESTRICT {port.name}"
    return f"const double {port.name}[{port.size}]" if port.shape else f"double {port.name}"


def _element(port: Port, index: int, *, output: bool = False) -> str:
    if port.shape:
        return f"{port.name}[{index}]"
    return f"*{port.name}" if output else port.name


# -- geometry ---------------------------------------------------------------------------------------------------------


def _geometry_view(geometry: GeometryType | None) -> dict[str, list[tuple[str, str]]]:
    if geometry is None:
        return {"fields": [], "prepared": []}
    fields = [(f"double {field.name};", f"{field.doc} ({field.unit})") for field in geometry.fields]
    prepared = [(f"double {port.name}[{port.size}];", port.doc) for port in geometry.prepare.outputs]
    return {"fields": fields, "prepared": prepared}


def _field_names(part: Part) -> list[str]:
    assert part.geometry is not None
    return [field.name for field in part.geometry.fields]


def _positive_fields(robot: RobotCode) -> list[str]:
    found = []
    for member, part in (("subleg", robot.subleg), ("platform", robot.platform)):
        assert part.geometry is not None
        found += [f"{member}[i].{field.name}" for field in part.geometry.fields if field.positive]
    return found


def _default_geometry(robot: RobotCode) -> list[str]:
    names = [*_field_names(robot.subleg), *_field_names(robot.platform)]
    return [", ".join(repr(robot.default_geometry[name][leg]) for name in names) for leg in range(LEGS)]


# -- functions of a robot ---------------------------------------------------------------------------------------------


def _full_parameter(port: Port, *, output: bool = False) -> str:
    if output:
        return f"double *KRHPR_RESTRICT {port.name}"
    return f"const double {port.name}[{port.full_size}]" if port.full_shape else f"double {port.name}"


def _prototype(robot: RobotCode, function: RobotFunction) -> dict[str, object]:
    return {
        "name": function.name,
        "symbol": f"krhpr_{robot.identifier}_{function.name}",
        "doc": function.doc,
        "equations": function.equations,
        "inputs": [port_text(port, full=True) + _optional_remark(port) for port in function.inputs],
        "outputs": [port_text(port, full=True) for port in function.outputs],
        "parameters": [_full_parameter(port) for port in function.inputs]
        + [_full_parameter(port, output=True) for port in function.outputs],
        "in_order": [f"{port.name} ({port.full_size})" for port in function.inputs],
        "out_order": [f"{port.name} ({port.full_size})" for port in function.outputs],
    }


def _optional_remark(port: Port) -> str:
    return "; NULL for the default" if port.name in ("mode", "assembly") else ""


def _function_view(robot: RobotCode, function: RobotFunction) -> _FunctionView:
    known = variables(function, robot.parts)
    in_platform = {
        call.variable_in(port.name)
        for call in function.stage(Stage.PLATFORM)
        for port in robot.parts[call.part].kernel(call.kernel).inputs
    }
    diagonal = {port.name: port for port in function.outputs if port.layout is Layout.DIAGONAL}
    leg_guards = [guard for guard in function.guards if known[guard.variable].per_leg]
    return _FunctionView(
        name=function.name,
        symbol=f"krhpr_{robot.identifier}_{function.name}",
        doc=function.doc,
        equations=function.equations,
        inputs=tuple(port_text(port, full=True) for port in function.inputs),
        outputs=tuple(port_text(port, full=True) for port in function.outputs),
        parameters=tuple(_full_parameter(port) for port in function.inputs)
        + tuple(_full_parameter(port, output=True) for port in function.outputs),
        optional=tuple((port.name, f"{port.name}_default") for port in function.inputs if port.name in ("mode", "assembly")),
        finite=tuple((_address(port), port.full_size) for port in function.inputs),
        fills=tuple((port.name, port.full_size) for port in function.outputs),
        zeros=tuple((port.name, port.full_size) for port in diagonal.values()),
        shared_locals=tuple(
            _local(variable, legs=variable.per_leg)
            for variable in known.values()
            if variable.kind == "local" and (not variable.per_leg or variable.name in in_platform)
        ),
        leg_locals=tuple(
            _local(variable, legs=False)
            for variable in known.values()
            if variable.per_leg and (variable.kind == "local" or variable.name in diagonal) and variable.name not in in_platform
        ),
        shared_calls=tuple(_call(robot, call, known, in_platform) for call in function.stage(Stage.SHARED)),
        leg_calls=tuple(_call(robot, call, known, in_platform) for call in function.stage(Stage.LEG)),
        scatters=tuple(
            _Scatter(f"{port.name}_block", port.name, port.shape[0], port.shape[1], port.full_shape[1])
            for port in diagonal.values()
        ),
        platform_calls=tuple(_call(robot, call, known, in_platform) for call in function.stage(Stage.PLATFORM)),
        leg_guards=tuple(_guard(guard, known, function, in_platform) for guard in leg_guards),
        platform_guards=tuple(
            _guard(guard, known, function, in_platform) for guard in function.guards if guard not in leg_guards
        ),
        batch_arguments=tuple(_batch_input(port, index) for index, port in enumerate(function.inputs))
        + tuple(f"out[{index}] + k * out_step[{index}]" for index in range(len(function.outputs))),
        in_sizes=tuple(port.full_size for port in function.inputs),
        out_sizes=tuple(port.full_size for port in function.outputs),
    )


def _address(port: Port) -> str:
    return port.name if port.full_shape else f"&{port.name}"


def _batch_input(port: Port, index: int) -> str:
    element = f"in[{index}] + k * in_step[{index}]"
    if port.name in ("mode", "assembly"):
        return f"in[{index}] ? {element} : NULL"
    return element if port.full_shape else f"*({element})"


def _local(variable: Variable, *, legs: bool) -> str:
    size = prod(variable.port.shape) * (LEGS if legs else 1)
    name = f"{variable.name}_block" if variable.port.layout is Layout.DIAGONAL else variable.name
    return f"double {name}[{size}];" if legs or variable.port.shape else f"double {name};"


def _reference(variable: Variable, stage: Stage, in_platform: set[str], *, output: bool) -> str:
    """How a kernel's argument is written: a value, an array, or a pointer to a leg's part of an array."""
    size = prod(variable.port.shape)
    scalar = not variable.port.shape
    if variable.port.layout is Layout.DIAGONAL:
        return f"{variable.name}_block"
    if stage is Stage.LEG and variable.per_leg and (variable.kind != "local" or variable.name in in_platform):
        if scalar:
            return f"&{variable.name}[i]" if output else f"{variable.name}[i]"
        return f"{variable.name} + {size} * i" if size > 1 else f"{variable.name} + i"
    if scalar and not (stage is Stage.PLATFORM and variable.per_leg):
        pointer = variable.kind == "output" and output
        return f"&{variable.name}" if output and not pointer else variable.name
    return variable.name


def _call(robot: RobotCode, call: Call, known: dict[str, Variable], in_platform: set[str]) -> str:
    part = robot.parts[call.part]
    kernel = part.kernel(call.kernel)
    arguments = [f"&g->{call.part}[i]"] if kernel.geometry is not None else []
    for port in kernel.inputs:
        arguments.append(_reference(known[call.variable_in(port.name)], call.stage, in_platform, output=False))
    for port in kernel.outputs:
        arguments.append(_reference(known[call.variable_out(port.name)], call.stage, in_platform, output=True))
    return f"krhpr_{part.name}_{kernel.name}({', '.join(arguments)});"


def _guard(guard: Guard, known: dict[str, Variable], function: RobotFunction, in_platform: set[str]) -> _GuardView:
    variable = known[guard.variable]
    value = variable.name
    if variable.per_leg:
        if variable.kind == "output" or variable.name in in_platform:
            value = f"{variable.name}[i]"
        fills = tuple(
            (f"{port.name} + {port.size} * i", port.size)
            for port in function.outputs
            if port.per_leg and known[port.name].per_leg and port.name != guard.variable and port.layout is not Layout.DIAGONAL
        )
        fills += tuple(
            (f"{port.name}_block", port.size) for port in function.outputs if port.layout is Layout.DIAGONAL
        )
        if function.stage(Stage.PLATFORM):
            fills = ()
    else:
        value = f"{variable.name}[{guard.index}]"
        fills = tuple((port.name, port.full_size) for port in function.outputs)
    operator = ">=" if guard.relation is Relation.AT_LEAST else "<="
    status = f"KRHPR_{guard.status.name}" + (" + i" if variable.per_leg else "")
    return _GuardView(f"{value} {operator} {guard.limit!r}", status, fills)
