"""Tangent twins in C: of kernels (values once, then a loop over the directions) and of a robot's functions.

A number with its derivatives is a `krhpr_dual`: `x[j].v` is the value, `x[j].t[k]` its derivative along
direction k.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from math import prod

from krhpr.codegen.composition import Call, RobotFunction, Stage, Variable, variables
from krhpr.codegen.graph import InputRef
from krhpr.codegen.kernel import GEOMETRY_PREFIX, Kernel, Port
from krhpr.codegen.part import Part
from krhpr.codegen.printers.c import FUNCTIONS, RESERVED, constant, input_text
from krhpr.codegen.printers.infix import Dialect, Line, Pair, print_body
from krhpr.codegen.robot_code import RobotCode
from krhpr.codegen.tangent import BRANCHES, SUFFIX, TangentFunction, is_tangent, tangent_twin
from krhpr.codegen.targets.base import broken, kernel_comment

DIRECTIONS = 8
"""Directions that a twin takes at once: one or two vectors on most processors."""

_IN_LOOP = re.compile(r"\.t\[k\]")


# -- kernels ------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class TwinView:
    """A twin as the template sees it."""

    symbol: str
    comment: str
    parameters: tuple[str, ...]
    unused: tuple[str, ...]
    once: tuple[str, ...]
    each: tuple[str, ...]


def twin_views(part: Part) -> list[TwinView]:
    """The twins of a part's kernels, without those that only guard."""
    twins = ((kernel, tangent_twin(kernel)) for kernel in part.kernels)
    return [_twin_view(part, kernel, twin) for kernel, twin in twins if twin is not None]


def _twin_view(part: Part, kernel: Kernel, twin: Kernel) -> TwinView:
    body = print_body(
        twin, Dialect(FUNCTIONS, constant, lambda ref: _read(twin, ref), RESERVED | {"k"}, pairs=True)
    )
    lines = [_statement(line) for line in body.lines]
    first = next((number for number, line in enumerate(lines) if _IN_LOOP.search(line)), len(lines))
    once, each = lines[:first], lines[first:]
    for port in kernel.smooth_outputs:
        once += [f"{port.name}[{j}].v = {text};" for j, text in enumerate(body.results[port.name])]
        each += [
            f"{port.name}[{j}].t[k] = {text};" for j, text in enumerate(body.results[port.name + SUFFIX])
        ]
    parameters = [f"const krhpr_{part.name}_geometry *g", "int i"] if kernel.geometry else []
    parameters += [f"const {_type(port)} *{port.name}" for port in kernel.inputs]
    parameters += [f"krhpr_dual *KRHPR_RESTRICT {port.name}" for port in kernel.smooth_outputs]
    used = {ref.port.split(".")[0].removesuffix(SUFFIX) for ref in body.inputs_used}
    unused = [port.name for port in kernel.inputs if port.name not in used]
    if kernel.geometry and "g" not in used:
        unused[:0] = ["g", "i"]
    symbol = f"krhpr_{part.name}_{twin.name}"
    return TwinView(symbol, kernel_comment(twin), tuple(parameters), tuple(unused), tuple(once), tuple(each))


def _type(port: Port) -> str:
    return "double" if port.name in BRANCHES else "krhpr_dual"


def _read(twin: Kernel, ref: InputRef) -> str:
    if ref.port.startswith(GEOMETRY_PREFIX):
        return input_text(twin, ref)
    if is_tangent(ref):
        return f"{ref.port.removesuffix(SUFFIX)}[{ref.index}].t[k]"
    return f"{ref.port}[{ref.index}]" + ("" if ref.port in BRANCHES else ".v")


def _statement(line: Line | Pair) -> str:
    if isinstance(line, Pair):
        call = f"krhpr_sincos({line.argument}, &{line.sine}, &{line.cosine});"
        return f"double {line.sine}, {line.cosine}; {call}"
    return f"const double {line.name} = {line.expression};"


# -- functions of a robot -----------------------------------------------------------------------------------


class TwinFunction:
    """A robot's function on dual numbers, out of a flat array `given` into a flat array `found`."""

    def __init__(self, robot: RobotCode, function: RobotFunction, tangent: TangentFunction) -> None:
        self.robot, self.function, self.tangent = robot, function, tangent
        self.known = variables(function, robot.parts)
        self.used = self._used()
        together = {
            call.variable_in(port.name)
            for call in tangent.calls
            if call.stage is Stage.PLATFORM
            for port in self._kernel(call).inputs
        }
        self.in_loop = {
            name
            for name in self.used
            if self.known[name].per_leg and self.known[name].kind == "local" and name not in together
        }

    @property
    def declarations(self) -> list[str]:
        """Arguments as parts of the flat arrays, then arrays of all legs, or of none."""
        lines = []
        for array, ports, qualifier in (
            ("given", self.function.inputs, "const "),
            ("found", self.function.outputs, ""),
        ):
            first = 0
            for port in ports:
                if port.name in self.used and port.name not in BRANCHES:
                    lines.append(f"{qualifier}krhpr_dual *const {port.name} = {_part(array, first)};")
                first += port.size * (port.legs if port.per_leg else 1)
        for name in self.used:
            variable = self.known[name]
            if variable.kind == "local" and name not in self.in_loop:
                times = self.function.legs if variable.per_leg else 1
                lines.append(f"krhpr_dual {name}[{prod(variable.port.shape) * times}];")
        return lines

    @property
    def branches(self) -> list[tuple[str, int, int]]:
        """Inputs that are plain numbers: name, where they begin in `given`, how many."""
        found, first = [], 0
        for port in self.function.inputs:
            if port.name in BRANCHES and port.name in self.used:
                found.append((port.name, first, port.full_size))
            first += port.full_size
        return found

    @property
    def leg_declarations(self) -> list[str]:
        """Arrays of one leg."""
        return [
            f"krhpr_dual {name}[{prod(self.known[name].port.shape)}];"
            for name in self.used
            if name in self.in_loop
        ]

    def calls(self, stage: str) -> list[str]:
        """The calls of one stage."""
        return [self._call(call) for call in self.tangent.calls if call.stage == stage]

    def _used(self) -> list[str]:
        """Variables that the calls read or write."""
        found: dict[str, None] = {}
        for call in self.tangent.calls:
            kernel = self._kernel(call)
            for port in kernel.inputs:
                found.setdefault(call.variable_in(port.name))
            for port in kernel.smooth_outputs:
                found.setdefault(call.variable_out(port.name))
        return list(found)

    def _kernel(self, call: Call) -> Kernel:
        return self.robot.parts[call.part].kernel(call.kernel)

    def _call(self, call: Call) -> str:
        kernel = self._kernel(call)
        arguments = [f"&geometry.{call.part}", "i"] if kernel.geometry is not None else []
        names = [call.variable_in(port.name) for port in kernel.inputs]
        names += [call.variable_out(port.name) for port in kernel.smooth_outputs]
        arguments += [self._argument(self.known[name], call.stage) for name in names]
        symbol = f"krhpr_{self.robot.parts[call.part].name}_{kernel.name}{SUFFIX}"
        return broken(symbol, arguments, ";", indent=8 if call.stage is Stage.LEG else 4)

    def _argument(self, variable: Variable, stage: Stage) -> str:
        """Everything is an array, of one leg (in the loop) or of all."""
        if stage is not Stage.LEG or not variable.per_leg or variable.name in self.in_loop:
            return variable.name
        size = prod(variable.port.shape)
        return f"{variable.name} + {size} * i" if size > 1 else f"{variable.name} + i"


def _part(array: str, first: int) -> str:
    return f"{array} + {first}" if first else array
