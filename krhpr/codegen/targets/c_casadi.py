"""The shim by which `casadi.external` loads the compiled C: CasADi's C interface, with exact Jacobians.

For each part a header with tangent twins of its kernels (`krhpr.codegen.tangent`), for each robot one source file that
holds all of it: the robot's C, its default geometry as constants, and for each kernel function the names that CasADi looks
up.  A Jacobian runs the twins over the directions of the inputs, eight at a time.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from math import prod

from krhpr.codegen.bake import baked_geometry
from krhpr.codegen.composition import Call, RobotCode, RobotFunction, Stage, Variable, variables
from krhpr.codegen.graph import InputRef
from krhpr.codegen.kernel import LEGS, Kernel, Layout, Port
from krhpr.codegen.passes import Part
from krhpr.codegen.printers.c import FUNCTIONS, RESERVED, constant, input_text
from krhpr.codegen.printers.infix import Dialect, Line, Pair, print_body
from krhpr.codegen.tangent import (
    BRANCHES,
    SUFFIX,
    TangentFunction,
    TwinPorts,
    tangent_function,
    tangent_twin,
    twin_ports,
)
from krhpr.codegen.targets.base import File, kernel_comment, render

DIRECTIONS = 8
"""Directions that a twin takes at once: a cache line of doubles, one or two vectors on most processors."""

_IN_LOOP = re.compile(rf"{SUFFIX}\[(\d+ \+ )?k\]")


class CasadiShimTarget:
    """Prints the sources of libraries for `casadi.external`."""

    name = "casadi shim"

    def shared(self) -> Iterable[File]:
        yield File("c/casadi/krhpr_casadi.h", render("c/krhpr_casadi.h.j2", directions=DIRECTIONS))

    def part(self, part: Part) -> Iterable[File]:
        twins = [(kernel, twin) for kernel in part.kernels if (twin := tangent_twin(kernel)) is not None]
        views = [_twin_view(part, kernel, twin) for kernel, twin in twins]
        text = render("c/tangent.h.j2", part=part, twins=views, directions=DIRECTIONS)
        yield File(f"c/casadi/krhpr_{part.name}_tangent.h", text)

    def robot(self, robot: RobotCode) -> Iterable[File]:
        printer = _Patterns()
        functions = [
            _FunctionPrinter(robot, function, printer).view()
            for function in robot.functions
            if function.calls
        ]
        text = render(
            "c/casadi_shim.c.j2",
            robot=robot,
            functions=functions,
            patterns=printer.declarations(),
            geometry=baked_geometry(robot, "geometry"),
            legs=LEGS,
        )
        yield File(f"c/casadi/krhpr_{robot.identifier}_casadi.c", text)


# -- twins of kernels ---------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class _TwinView:
    """A twin as the template sees it: what is done once, and what is done for each direction."""

    symbol: str
    comment: str
    parameters: tuple[str, ...]
    unused: tuple[str, ...]
    once: tuple[str, ...]
    each: tuple[str, ...]


def _twin_view(part: Part, kernel: Kernel, twin: Kernel) -> _TwinView:
    def read(ref: InputRef) -> str:
        return _lane(ref.port, ref.index) if ref.port.endswith(SUFFIX) else input_text(twin, ref)

    body = print_body(twin, Dialect(FUNCTIONS, constant, read, RESERVED | {"k"}, pairs=True))
    lines = [_statement(line) for line in body.lines]
    first = next((number for number, line in enumerate(lines) if _IN_LOOP.search(line)), len(lines))
    once, each = lines[:first], lines[first:]
    for port in twin.outputs:
        for index, text in enumerate(body.results[port.name]):
            if port.name.endswith(SUFFIX):
                each.append(f"{_lane(port.name, index)} = {text};")
            else:
                once.append(f"{port.name}[{index}] = {text};" if port.shape else f"*{port.name} = {text};")
    used = {ref.port.split(".")[0] for ref in body.inputs_used}
    parameters = [f"const krhpr_{part.name}_geometry *g"] if kernel.geometry else []
    parameters += [_parameter(port) for port in twin.inputs]
    parameters += [f"double *KRHPR_RESTRICT {port.name}" for port in twin.outputs]
    unused = [port.name for port in twin.inputs if port.name not in used]
    if kernel.geometry and "g" not in used:
        unused.insert(0, "g")
    symbol = f"krhpr_{part.name}_{twin.name}"
    return _TwinView(symbol, kernel_comment(twin), tuple(parameters), tuple(unused), tuple(once), tuple(each))


def _lane(port: str, index: int) -> str:
    return f"{port}[{DIRECTIONS * index} + k]" if index else f"{port}[k]"


def _parameter(port: Port) -> str:
    if port.name.endswith(SUFFIX):
        return f"const double {port.name}[{DIRECTIONS * port.size}]"
    return f"const double {port.name}[{port.size}]" if port.shape else f"double {port.name}"


def _statement(line: Line | Pair) -> str:
    if isinstance(line, Pair):
        return (
            f"double {line.sine}, {line.cosine}; krhpr_sincos({line.argument}, &{line.sine}, &{line.cosine});"
        )
    return f"const double {line.name} = {line.expression};"


# -- sparsity patterns --------------------------------------------------------------------------------------------


class _Patterns:
    """Sparsity patterns in CasADi's compressed form, each printed once."""

    def __init__(self) -> None:
        self._names: dict[tuple[int, ...], str] = {}

    def dense(self, rows: int, columns: int) -> str:
        return self._name((rows, columns, 1))

    def empty(self, rows: int, columns: int) -> str:
        return self.sparse(rows, columns, [[] for _ in range(columns)])

    def sparse(self, rows: int, columns: int, entries: Sequence[Sequence[int]]) -> str:
        """A pattern from the rows of each column, in order."""
        if rows * columns and all(len(column) == rows for column in entries):
            return self.dense(rows, columns)
        starts = [0]
        for column in entries:
            starts.append(starts[-1] + len(column))
        return self._name((rows, columns, *starts, *(row for column in entries for row in column)))

    def _name(self, pattern: tuple[int, ...]) -> str:
        return self._names.setdefault(pattern, f"pattern_{len(self._names)}")

    def declarations(self) -> list[tuple[str, int, str]]:
        return [(name, len(p), ", ".join(map(str, p))) for p, name in self._names.items()]


@dataclass(frozen=True)
class _Slot:
    """An argument or result as CasADi has it: a matrix, or blocks on the diagonal of one."""

    name: str
    port: str
    rows: int
    columns: int
    blocks: int
    value: int
    """Where its elements begin among all values of the inputs (or of the outputs)."""
    tangent: int
    """Where they begin among all tangents: there, blocks follow one another and zeros have no place."""
    offset: int
    """Which element of the port's tangents comes first."""
    pattern: str
    empty: str

    def element(self, row: int, column: int) -> int:
        """Where an element of the matrix stands in the port's tangents."""
        high, wide = self.rows // self.blocks, self.columns // self.blocks
        return self.offset + (row // high) * high * wide + (row % high) * wide + column % wide

    def entries(self) -> list[list[int]]:
        """Rows of each column in which an element may differ from zero."""
        high, wide = self.rows // self.blocks, self.columns // self.blocks
        return [
            [row for row in range(self.rows) if row // high == column // wide]
            for column in range(self.columns)
        ]


# -- functions of a robot -----------------------------------------------------------------------------------------


class _FunctionPrinter:
    """One function: its tables, its call in C, and its twin."""

    def __init__(self, robot: RobotCode, function: RobotFunction, patterns: _Patterns) -> None:
        self.robot, self.function, self.patterns = robot, function, patterns
        self.known = variables(function, robot.parts)
        self.inputs = self._slots(function.inputs)
        self.outputs = self._slots(function.outputs)
        self.tangent = tangent_function(function, robot.parts)

    def view(self) -> dict[str, object]:
        """What the template prints."""
        view: dict[str, object] = {
            "name": self.function.name,
            "inputs": self.inputs,
            "outputs": self.outputs,
            "values_in": sum(port.full_size for port in self.function.inputs),
            "values_out": sum(port.full_size for port in self.function.outputs),
            "tangents_out": sum(_tangent_size(port) for port in self.function.outputs),
            "differentiable": self.tangent is not None,
            "branches": BRANCHES,
            "arguments": self._value_arguments(),
        }
        if self.tangent is not None:
            view |= {
                "structure": [self._structure(self.tangent, o, i) for o in self.outputs for i in self.inputs],
                "names": [f"jac_{o.name}_{i.name}" for o in self.outputs for i in self.inputs],
                **self._twin(self.tangent),
            }
        return view

    # -- tables -------------------------------------------------------------------------------------------------

    def _slots(self, ports: Iterable[Port]) -> list[_Slot]:
        slots: list[_Slot] = []
        value = tangent = 0
        for port in ports:
            shape = port.full_shape
            if len(shape) > 2:
                rows, columns = shape[1], prod(shape[2:])
                for leg in range(shape[0]):
                    first = leg * rows * columns
                    slots.append(
                        self._slot(port, f"{port.name}{leg + 1}", rows, columns, value, tangent, first)
                    )
            else:
                rows, columns = (*shape, 1, 1)[:2]
                slots.append(self._slot(port, port.name, rows, columns, value, tangent, 0))
            value += port.full_size
            tangent += _tangent_size(port)
        return slots

    def _slot(
        self, port: Port, name: str, rows: int, columns: int, value: int, tangent: int, first: int
    ) -> _Slot:
        blocks = LEGS if port.layout is Layout.DIAGONAL else 1
        slot = _Slot(name, port.name, rows, columns, blocks, value + first, tangent + first, first, "", "")
        pattern = self.patterns.sparse(rows, columns, slot.entries())
        empty = self.patterns.empty(rows, columns)
        return _Slot(
            name, port.name, rows, columns, blocks, value + first, tangent + first, first, pattern, empty
        )

    def _structure(self, tangent: TangentFunction, output: _Slot, given: _Slot) -> str:
        """The pattern of d output / d input, both column by column as CasADi has it."""
        rows, columns = output.rows * output.columns, given.rows * given.columns
        if given.port in BRANCHES:
            return self.patterns.empty(rows, columns)
        entries = tangent.structure[output.port, given.port]
        wanted: list[list[int]] = []
        for column in range(given.columns):
            for row in range(given.rows):
                source = given.element(row, column)
                wanted.append(
                    [
                        i + output.rows * j
                        for j, high in enumerate(output.entries())
                        for i in high
                        if (output.element(i, j), source) in entries
                    ]
                )
        return self.patterns.sparse(rows, columns, wanted)

    def _value_arguments(self) -> list[str]:
        """The arguments of the C function, out of flat arrays x and y."""
        arguments = []
        for array, ports in (("x", self.function.inputs), ("y", self.function.outputs)):
            first = 0
            for port in ports:
                text = f"{array} + {first}" if first else array
                arguments.append(f"{array}[{first}]" if array == "x" and not port.full_shape else text)
                first += port.full_size
        return arguments

    # -- the twin -----------------------------------------------------------------------------------------------

    def _twin(self, tangent: TangentFunction) -> dict[str, object]:
        read_later = {
            call.variable_in(port.name)
            for call in tangent.calls
            if call.stage is Stage.PLATFORM
            for port in self._kernel(call).inputs
        }
        used = self._used(tangent)
        inputs, first = [], 0
        for port in self.function.inputs:
            if port.name in used:
                inputs.append((port.name, first, port.name in tangent.carried))
            first += port.full_size
        outputs, first = [], 0
        for port in self.function.outputs:
            outputs.append((port.name, first))
            first += _tangent_size(port)
        whole, in_loop = [], []
        for name in used:
            variable = self.known[name]
            if variable.kind == "input":
                continue
            size = prod(variable.port.shape)
            in_leg = variable.per_leg and variable.kind == "local" and name not in read_later
            (in_loop if in_leg else whole).append(
                (name, size if in_leg else size * (LEGS if variable.per_leg else 1))
            )
        local = {name for name, _ in in_loop}
        outside = {port.name for port in self.function.outputs}
        calls = {
            stage: [self._call(call, local) for call in tangent.calls if call.stage is stage]
            for stage in Stage
        }
        return {
            "twin_inputs": inputs,
            "twin_outputs": outputs,
            "locals": [(name, size, name not in outside) for name, size in whole],
            "leg_locals": in_loop,
            "shared_calls": calls[Stage.SHARED],
            "leg_calls": calls[Stage.LEG],
            "platform_calls": calls[Stage.PLATFORM],
            "directions": DIRECTIONS,
        }

    def _used(self, tangent: TangentFunction) -> list[str]:
        """Variables that the twin's calls read or write."""
        found: dict[str, None] = {}
        for call in tangent.calls:
            ports = self._ports(call)
            for port in ports.inputs:
                found.setdefault(call.variable_in(_plain(port.name)))
            for port in ports.outputs:
                found.setdefault(call.variable_out(_plain(port.name)))
        return list(found)

    def _ports(self, call: Call) -> TwinPorts:
        ports = twin_ports(self._kernel(call))
        assert ports is not None
        return ports

    def _kernel(self, call: Call) -> Kernel:
        return self.robot.parts[call.part].kernel(call.kernel)

    def _call(self, call: Call, local: set[str]) -> str:
        kernel, ports = self._kernel(call), self._ports(call)
        arguments = [f"&geometry.{call.part}[i]"] if kernel.geometry is not None else []
        for port in ports.inputs:
            variable = self.known[call.variable_in(_plain(port.name))]
            arguments.append(_argument(variable, port, call.stage, local, output=False))
        for port in ports.outputs:
            variable = self.known[call.variable_out(_plain(port.name))]
            arguments.append(_argument(variable, port, call.stage, local, output=True))
        return f"krhpr_{self.robot.parts[call.part].name}_{kernel.name}{SUFFIX}({', '.join(arguments)});"


def _plain(name: str) -> str:
    return name.removesuffix(SUFFIX)


def _tangent_size(port: Port) -> int:
    return port.size * (LEGS if port.per_leg else 1)


def _argument(variable: Variable, port: Port, stage: Stage, local: set[str], *, output: bool) -> str:
    """How a twin's argument is written: everything is an array, of one leg (in the loop) or of all."""
    is_tangent = port.name.endswith(SUFFIX)
    name = variable.name + (SUFFIX if is_tangent else "")
    step = prod(variable.port.shape) * (DIRECTIONS if is_tangent else 1)
    one_of_three = stage is Stage.LEG and variable.per_leg and variable.name not in local
    if not port.shape and not is_tangent and not output:
        return f"{name}[{'i' if one_of_three else 0}]"
    if not one_of_three:
        return name
    return f"{name} + {step} * i" if step > 1 else f"{name} + i"
