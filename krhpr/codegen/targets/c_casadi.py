"""The shim by which `casadi.external` loads the compiled C: CasADi's C interface, with exact Jacobians.

For each part there is a header with tangent twins of its kernels (`krhpr.codegen.tangent`), for each robot
one source that holds all: the robot's C, its default geometry as constants, and for each kernel function the
names that CasADi looks up.  A Jacobian runs the twins over the directions of the inputs, eight at a time.
"""

from __future__ import annotations

from collections.abc import Iterable

from krhpr.codegen.bake import baked_geometry
from krhpr.codegen.composition import RobotFunction
from krhpr.codegen.part import Part
from krhpr.codegen.robot_code import RobotCode
from krhpr.codegen.tangent import BRANCHES, TangentFunction, tangent_function
from krhpr.codegen.targets.base import File, render
from krhpr.codegen.targets.c_tangent import DIRECTIONS, TwinFunction, twin_views
from krhpr.codegen.targets.casadi_layout import Patterns, Slot, slots


class CasadiShimTarget:
    """Prints the sources of libraries for `casadi.external`."""

    name = "casadi shim"

    def shared(self) -> Iterable[File]:
        """What all shims include."""
        yield File("c/casadi/krhpr_dual.h", render("c/krhpr_dual.h.j2", directions=DIRECTIONS))
        yield File("c/casadi/krhpr_casadi.h", render("c/krhpr_casadi.h.j2"))

    def part(self, part: Part) -> Iterable[File]:
        """The tangent twins of a part's kernels."""
        text = render("c/tangent.h.j2", part=part, twins=twin_views(part), directions=DIRECTIONS)
        yield File(f"c/casadi/krhpr_{part.name}_tangent.h", text)

    def robot(self, robot: RobotCode) -> Iterable[File]:
        """A robot's shim, one source."""
        patterns = Patterns()
        printers = [
            FunctionPrinter(robot, function, patterns)
            for function in robot.functions
            if not function.procedure
        ]
        text = render(
            "c/casadi_shim.c.j2",
            robot=robot,
            functions=[printer.view() for printer in printers],
            patterns=patterns.declarations(),
            geometry=baked_geometry(robot, "geometry"),
            legs=robot.legs,
        )
        yield File(f"c/casadi/krhpr_{robot.identifier}_casadi.c", text)


class FunctionPrinter:
    """One function: its tables, its call in C, and the twin that its Jacobian runs."""

    def __init__(self, robot: RobotCode, function: RobotFunction, patterns: Patterns) -> None:
        self.robot, self.function, self.patterns = robot, function, patterns
        self.inputs = slots(function.inputs, patterns)
        self.outputs = slots(function.outputs, patterns)

    def view(self) -> dict[str, object]:
        """What the template prints."""
        tangent = tangent_function(self.function, self.robot.parts)
        view: dict[str, object] = {
            "name": self.function.name,
            "inputs": self.inputs,
            "outputs": self.outputs,
            "branches": BRANCHES,
            "arguments": self._value_arguments(),
            "twin": None,
        }
        if tangent is not None:
            blocks = [(output, given) for output in self.outputs for given in self.inputs]
            view |= {
                "twin": TwinFunction(self.robot, self.function, tangent),
                "structure": [self._structure(tangent, output, given) for output, given in blocks],
                "names": [f"jac_{output.name}_{given.name}" for output, given in blocks],
            }
        return view

    def _structure(self, tangent: TangentFunction, output: Slot, given: Slot) -> str:
        """The pattern of d output / d input, both column by column as CasADi has it."""
        rows, columns = output.rows * output.columns, given.rows * given.columns
        if given.port in BRANCHES:
            return self.patterns.empty(rows, columns)
        depends = tangent.structure[output.port, given.port]
        present = [(row, column) for column, rows_there in enumerate(output.entries()) for row in rows_there]
        entries: list[list[int]] = []
        for source in (
            given.element(row, column) for column, rows_ in enumerate(given.entries()) for row in rows_
        ):
            found = [(i, j) for i, j in present if (output.element(i, j), source) in depends]
            entries.append([i + output.rows * j for i, j in found])
        return self.patterns.sparse(rows, columns, entries)

    def _value_arguments(self) -> list[str]:
        """The arguments of the C function, out of flat arrays x and y."""
        arguments = []
        for array, ports in (("x", self.function.inputs), ("y", self.function.outputs)):
            first = 0
            for port in ports:
                by_value = array == "x" and not port.full_shape
                arguments.append(f"{array}[{first}]" if by_value else _part(array, first))
                first += port.full_size
        return arguments


def _part(array: str, first: int) -> str:
    return f"{array} + {first}" if first else array
