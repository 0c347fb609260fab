"""The legs of one pose side by side: leg kernels over lanes, and how arrays get there and back.

Each variable of a leg's kernel is an array of lanes, called like the variable with `_legs` behind it.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from math import prod

from krhpr.codegen.composition import Call, RobotFunction, Stage, Variable
from krhpr.codegen.kernel import LEGS, Kernel, Layout
from krhpr.codegen.part import Part
from krhpr.codegen.printers.c import print_lanes
from krhpr.codegen.robot_code import RobotCode
from krhpr.codegen.targets.base import broken
from krhpr.codegen.targets.c_numbers import LANES, holds


@dataclass(frozen=True)
class LegsView:
    """The stage of the legs as the template sees it, in the order of the source."""

    angle_loads: tuple[str, ...]
    """What the angles read, of all legs or of each, brought into lanes."""
    angle_count: int
    angle_calls: tuple[str, ...]
    loads: tuple[str, ...]
    """What only the kernels read."""
    made: tuple[str, ...]
    """Declarations of what the kernels make."""
    calls: tuple[str, ...]
    tail_count: int
    tail_stores: tuple[tuple[str, str], ...]
    fine: tuple[str, ...]
    """The guards of the legs as conditions in lanes."""
    stores: tuple[str, ...]


def legs_view(
    robot: RobotCode, function: RobotFunction, known: Mapping[str, Variable], outside: set[str]
) -> LegsView | None:
    """The legs side by side; None where there is no such stage, one with a procedure in it or one that only
    copies, or where the robot has not the three legs for which there are lanes.
    """
    calls = function.stage(Stage.LEG)
    kernels = [robot.parts[call.part].kernel(call.kernel) for call in calls]
    if (
        robot.legs != LEGS
        or not any(kernel.operations.total for kernel in kernels)
        or any(call.repeat is not None or call.each is not None for call in calls)
    ):
        return None
    return _Legs(robot, function, known, outside).view()


class _Legs:
    def __init__(
        self, robot: RobotCode, function: RobotFunction, known: Mapping[str, Variable], outside: set[str]
    ) -> None:
        self.robot, self.known, self.outside = robot, known, outside
        self.read = function.read(robot.parts, guards=True)
        self.loads: dict[str, str] = {}
        self.angle_inputs: set[str] = set()
        self.made: dict[str, str] = {}
        self.stores: list[str] = []
        self.angle_calls: list[str] = []
        self.calls: list[str] = []
        self.tail_stores: list[tuple[str, str]] = []
        self.angle_count = self.tail_count = 0
        self._angles_at: dict[str, int] = {}
        for call in function.stage(Stage.LEG):
            self._add(call)
        self._guards = [guard for guard in function.guards if known[guard.variable].per_leg]

    def view(self) -> LegsView:
        return LegsView(
            tuple(text for name, text in self.loads.items() if name in self.angle_inputs),
            self.angle_count,
            tuple(self.angle_calls),
            tuple(text for name, text in self.loads.items() if name not in self.angle_inputs),
            tuple(self.made.values()),
            tuple(self.calls),
            self.tail_count,
            tuple(self.tail_stores),
            tuple(holds(guard, f"{_lanes(guard.variable)}[0]", LANES) for guard in self._guards),
            tuple(self.stores),
        )

    def _add(self, call: Call) -> None:
        part = self.robot.parts[call.part]
        phases = part.phases[call.kernel]
        special: dict[str, str] = {}
        if phases.angles is not None:
            special = self._angles(call, part, phases.angles)
        for port in phases.body.outputs:
            if port.name not in ("tail_y", "tail_x"):
                self._make(call.variable_out(port.name))
        if phases.tails:
            special |= {name: _part(_lanes(name), self.tail_count) for name in ("tail_y", "tail_x")}
            for tail in phases.tails:
                name = call.variable_out(tail.port.name)
                if self.known[name].kind == "output" or name in self.read:
                    self._make(name)
                    self.tail_stores += [
                        (f"{_lanes(name)}[{index}]", f"{_lanes('tail')}[{self.tail_count + slot}]")
                        for index, slot in enumerate(tail.slots)
                    ]
            self.tail_count += phases.tail_size
        self.calls.append(self._text(call, part, phases.body, special))

    def _angles(self, call: Call, part: Part, kernel: Kernel) -> dict[str, str]:
        """Where the body finds its sines and cosines; two kernels that read the same angles share them."""
        late = [
            port.name for port in kernel.inputs if self.known[call.variable_in(port.name)].kind != "input"
        ]
        if late:
            raise ValueError(f"{part.name}.{call.kernel}: sines of {late} come too late")
        self.angle_inputs |= {call.variable_in(port.name) for port in kernel.inputs}
        key = f"{[call.variable_in(port.name) for port in kernel.inputs]} {print_lanes(kernel).results}"
        if key not in self._angles_at:
            self._angles_at[key] = self.angle_count
            angle = _part(_lanes("angle"), self.angle_count)
            self.angle_calls.append(self._text(call, part, kernel, {"angle": angle}))
            self.angle_count += kernel.output_port("angle").size
        return {name: _part(_lanes(name), self._angles_at[key]) for name in ("sine", "cosine")}

    def _make(self, name: str) -> None:
        """A variable that a kernel makes, and where it goes if anything outside the legs reads it."""
        variable = self.known[name]
        size = prod(variable.port.shape)
        self.made[name] = f"{LANES.real} {_lanes(name)}[{size}];"
        if variable.kind != "output" and name not in self.outside:
            return
        if variable.port.layout is Layout.DIAGONAL:
            rows, columns = variable.port.shape
            width = variable.port.full_shape[1]
            self.stores += [
                _store(
                    _part(name, row * width),
                    rows * width + columns,
                    _part(_lanes(name), row * columns),
                    columns,
                )
                for row in range(rows)
            ]
        else:
            self.stores.append(_store(name, size, _lanes(name), size))

    def _text(self, call: Call, part: Part, kernel: Kernel, special: Mapping[str, str]) -> str:
        arguments = [f"&g->{call.part}", "i"] if kernel.geometry is not None else []
        for port in kernel.inputs:
            arguments.append(special.get(port.name) or self._input(call.variable_in(port.name)))
        for port in kernel.outputs:
            arguments.append(special.get(port.name) or _lanes(call.variable_out(port.name)))
        return broken(f"krhpr_{part.name}_{kernel.name}_lanes", arguments, ";", 8)

    def _input(self, name: str) -> str:
        """A kernel's argument, which is brought there first."""
        variable = self.known[name]
        size, scalar = prod(variable.port.shape), not variable.port.shape
        if name not in self.made:
            declared = f"{LANES.real} {_lanes(name)}[{size}]; "
            if variable.per_leg:
                self.loads[name] = f"{declared}krhpr_legs_load({_lanes(name)}, {name}, {size}, i);"
            else:
                source = f"&{name}" if scalar else name
                self.loads[name] = f"{declared}krhpr_legs_spread({_lanes(name)}, {source}, {size});"
        return f"{_lanes(name)}[0]" if scalar else _lanes(name)


def _lanes(name: str) -> str:
    return f"{name}_legs"


def _part(array: str, first: int) -> str:
    return f"{array} + {first}" if first else array


def _store(target: str, step: int, source: str, count: int) -> str:
    return f"krhpr_legs_store({target}, {step}, {source}, {count}, i);"
