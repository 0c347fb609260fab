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
from krhpr.codegen.phases import Phases, split
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
    uses_geometry: bool
    angle_count: int
    shared_angle_calls: tuple[str, ...]
    leg_angle_calls: tuple[str, ...]
    shared_calls: tuple[str, ...]
    leg_calls: tuple[str, ...]
    scatters: tuple[_Scatter, ...]
    tail_count: int
    tail_stores: tuple[tuple[str, str], ...]
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
        kernels = []
        for kernel in part.kernels:
            phases = split(kernel)
            if phases.angles is not None:
                kernels.append(_kernel_view(part.name, phases.angles))
            kernels.append(_kernel_view(part.name, phases.body))
        prepare = None
        if part.geometry is not None:
            prepare = _kernel_view(part.name, part.geometry.prepare)
        yield File(
            f"c/krhpr_{part.name}.h",
            render(
                "c/part.h.j2",
                part=part,
                kernels=kernels,
                prepare=prepare,
                geometry=_geometry_view(part.geometry),
            ),
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


# -- kernels
# ----------------------------------------------------------------------------------------------------------


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
        return _KernelView(
            f"krhpr_{part}_prepare", kernel_comment(kernel), tuple(parameters), (), body_lines, stores
        )
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


# -- geometry
# ---------------------------------------------------------------------------------------------------------


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


# -- functions of a robot
# ---------------------------------------------------------------------------------------------


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
    outside = _read_outside_the_loop(robot, function)
    plan = _Plan(robot, function, known, outside)
    diagonal = [port for port in function.outputs if port.layout is Layout.DIAGONAL]
    made = {variable.name: variable for variable in known.values() if variable.kind == "local"}
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
        optional=tuple(
            (port.name, f"{port.name}_default")
            for port in function.inputs
            if port.name in ("mode", "assembly")
        ),
        finite=tuple((_address(port), port.full_size) for port in function.inputs),
        fills=tuple((port.name, port.full_size) for port in function.outputs),
        zeros=tuple((port.name, port.full_size) for port in diagonal),
        shared_locals=tuple(
            _local(variable, legs=variable.per_leg)
            for variable in made.values()
            if not variable.per_leg or variable.name in outside
        ),
        leg_locals=tuple(
            [
                _local(variable, legs=False)
                for variable in made.values()
                if variable.per_leg and variable.name not in outside
            ]
            + [f"double {port.name}_block[{port.size}];" for port in diagonal]
        ),
        uses_geometry=function.uses_geometry(robot.parts),
        angle_count=plan.angle_count,
        shared_angle_calls=tuple(plan.shared_angle_calls),
        leg_angle_calls=tuple(plan.leg_angle_calls),
        shared_calls=tuple(plan.calls[Stage.SHARED]),
        leg_calls=tuple(plan.calls[Stage.LEG]),
        scatters=tuple(
            _Scatter(f"{port.name}_block", port.name, port.shape[0], port.shape[1], port.full_shape[1])
            for port in diagonal
        ),
        tail_count=plan.tail_count,
        tail_stores=tuple(plan.tail_stores),
        platform_calls=tuple(plan.calls[Stage.PLATFORM]),
        leg_guards=tuple(_leg_guard(guard, function) for guard in leg_guards),
        platform_guards=tuple(
            _platform_guard(guard, function) for guard in function.guards if guard not in leg_guards
        ),
        batch_arguments=tuple(_batch_input(port, index) for index, port in enumerate(function.inputs))
        + tuple(f"out[{index}] + k * out_step[{index}]" for index in range(len(function.outputs))),
        in_sizes=tuple(port.full_size for port in function.inputs),
        out_sizes=tuple(port.full_size for port in function.outputs),
    )


def _read_outside_the_loop(robot: RobotCode, function: RobotFunction) -> set[str]:
    """Variables that the loop over the legs makes and that something after it reads: each leg needs its
    own.
    """
    read = {guard.variable for guard in function.guards}
    for call in function.stage(Stage.PLATFORM):
        read |= {call.variable_in(port.name) for port in robot.parts[call.part].kernel(call.kernel).inputs}
    return read


class _Plan:
    """The statements of a function: calls of kernels, with all legs' sines, cosines and arctangents put
    together.
    """

    def __init__(
        self, robot: RobotCode, function: RobotFunction, known: dict[str, Variable], outside: set[str]
    ) -> None:
        self.robot, self.known, self.outside = robot, known, outside
        self.angle_count = self.tail_count = 0
        self.shared_angle_calls: list[str] = []
        self.leg_angle_calls: list[str] = []
        self.tail_stores: list[tuple[str, str]] = []
        self.calls: dict[Stage, list[str]] = {stage: [] for stage in Stage}
        self._offsets: dict[str, str] = {}
        for call in function.calls:
            self._add(call)

    def _add(self, call: Call) -> None:
        part = self.robot.parts[call.part]
        phases = split(part.kernel(call.kernel))
        special = self._angles(call, part, phases)
        special |= self._tails(call, phases)
        self.calls[call.stage].append(self._text(call, part, phases.body, special))

    def _angles(self, call: Call, part: Part, phases: Phases) -> dict[str, str]:
        """Where the body finds its sines and cosines; the angles are computed before."""
        if phases.angles is None:
            return {}
        kernel = phases.angles
        late = [
            port.name for port in kernel.inputs if self.known[call.variable_in(port.name)].kind != "input"
        ]
        if late or call.stage is Stage.PLATFORM:
            raise ValueError(
                f"{part.name}.{call.kernel}: sines of {late or 'the platform stage'} come too late"
            )
        count = kernel.output_port("angle").size
        per_leg = call.stage is Stage.LEG
        # two kernels that read the same angles share them
        key = (
            f"{[call.variable_in(port.name) for port in kernel.inputs]} "
            f"{print_kernel(kernel).results} {per_leg}"
        )
        if key not in self._offsets:
            first = str(self.angle_count) if self.angle_count else ""
            self._offsets[key] = " + ".join(
                term for term in (first, f"{count} * i" if per_leg else "") if term
            )
            self.angle_count += count * (LEGS if per_leg else 1)
            target = self.leg_angle_calls if per_leg else self.shared_angle_calls
            target.append(self._text(call, part, kernel, {"angle": self._offset("angle", key)}))
        return {name: self._offset(name, key) for name in ("sine", "cosine")}

    def _offset(self, name: str, key: str) -> str:
        return f"{name} + {self._offsets[key]}" if self._offsets[key] else name

    def _tails(self, call: Call, phases: Phases) -> dict[str, str]:
        """Where the body leaves the operands of its arctangents; they are computed after the loop."""
        if not phases.tails:
            return {}
        if call.stage is not Stage.LEG:
            raise ValueError(f"{call.part}.{call.kernel}: arctangents are expected in leg kernels only")
        first = f"{self.tail_count} + " if self.tail_count else ""
        where = f"{first}{phases.tail_size} * i"
        for tail in phases.tails:
            variable = self.known[call.variable_out(tail.port.name)]
            if variable.kind != "output":
                raise ValueError(
                    f"{call.part}.{call.kernel}: the arctangents {tail.port.name!r} are not an output"
                )
            for index, slot in enumerate(tail.slots):
                size = len(tail.slots)
                target = f"{variable.name}[{f'{size} * i + {index}' if size > 1 else 'i'}]"
                self.tail_stores.append((target, f"tail[{where} + {slot}]"))
        self.tail_count += phases.tail_size * LEGS
        return {"tail_y": f"tail_y + {where}", "tail_x": f"tail_x + {where}"}

    def _text(self, call: Call, part: Part, kernel: Kernel, special: dict[str, str]) -> str:
        arguments = [f"&g->{call.part}[i]"] if kernel.geometry is not None else []
        for port in kernel.inputs:
            arguments.append(
                special.get(port.name) or self._reference(call.variable_in(port.name), call.stage)
            )
        for port in kernel.outputs:
            text = special.get(port.name)
            arguments.append(text or self._reference(call.variable_out(port.name), call.stage, output=True))
        return f"krhpr_{part.name}_{kernel.name}({', '.join(arguments)});"

    def _reference(self, name: str, stage: Stage, *, output: bool = False) -> str:
        """How a kernel's argument is written: a value, an array, or a pointer to a leg's part of an array."""
        variable = self.known[name]
        size, scalar = prod(variable.port.shape), not variable.port.shape
        if variable.port.layout is Layout.DIAGONAL:
            return f"{name}_block"
        if stage is Stage.LEG and variable.per_leg and (variable.kind != "local" or name in self.outside):
            if scalar:
                return f"&{name}[i]" if output else f"{name}[i]"
            return f"{name} + {size} * i" if size > 1 else f"{name} + i"
        if scalar and output and variable.kind == "local":
            return f"&{name}"
        return name


def _address(port: Port) -> str:
    return port.name if port.full_shape else f"&{port.name}"


def _batch_input(port: Port, index: int) -> str:
    element = f"in[{index}] + k * in_step[{index}]"
    if port.name in ("mode", "assembly"):
        return f"in[{index}] ? {element} : NULL"
    return element if port.full_shape else f"*({element})"


def _local(variable: Variable, *, legs: bool) -> str:
    size = prod(variable.port.shape) * (LEGS if legs else 1)
    return f"double {variable.name}[{size}];" if legs or variable.port.shape else f"double {variable.name};"


def _leg_guard(guard: Guard, function: RobotFunction) -> _GuardView:
    """A leg's guard: where it fails, that leg's part of every leg-wise output is NaN."""
    fills: list[tuple[str, int]] = []
    if not function.stage(Stage.PLATFORM):
        for port in function.outputs:
            if not port.per_leg or port.name == guard.variable:
                continue
            if port.layout is Layout.DIAGONAL:
                rows, columns = port.shape
                width = port.full_shape[1]
                fills += [
                    (f"{port.name} + {rows * width + columns} * i + {row * width}", columns)
                    for row in range(rows)
                ]
            else:
                fills.append((f"{port.name} + {port.size} * i", port.size))
    operator = ">=" if guard.relation is Relation.AT_LEAST else "<="
    return _GuardView(
        f"{guard.variable}[i] {operator} {guard.limit!r}", f"KRHPR_{guard.status.name} + i", tuple(fills)
    )


def _platform_guard(guard: Guard, function: RobotFunction) -> _GuardView:
    """A guard of the whole platform: where it fails, every output is NaN."""
    operator = ">=" if guard.relation is Relation.AT_LEAST else "<="
    fills = tuple((port.name, port.full_size) for port in function.outputs)
    return _GuardView(
        f"{guard.variable}[{guard.index}] {operator} {guard.limit!r}", f"KRHPR_{guard.status.name}", fills
    )
