"""Functions of a robot as the C template sees them: calls of kernels, elementary functions put together."""

from __future__ import annotations

from dataclasses import dataclass
from math import prod

from krhpr.codegen.composition import OPTIONAL_INPUTS, Guard, RobotFunction, Stage, Variable, variables
from krhpr.codegen.kernel import Layout, Port
from krhpr.codegen.robot_code import RobotCode
from krhpr.codegen.status import LEG_STATUSES
from krhpr.codegen.targets.base import port_text
from krhpr.codegen.targets.c_defaults import default
from krhpr.codegen.targets.c_legs import LegsView, legs_view
from krhpr.codegen.targets.c_numbers import LANES, NUMBER, Writing, holds
from krhpr.codegen.targets.c_plan import Plan
from krhpr.codegen.targets.c_statements import Statement


@dataclass(frozen=True)
class FunctionView:
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
    """Inputs that are looked at by themselves."""
    of_angles: tuple[tuple[str, int], ...]
    """Inputs that need no look where the angles made of them are near zero."""
    fills: tuple[tuple[str, int], ...]
    whole_fills: tuple[tuple[str, int], ...]
    """Outputs that are NaN as a whole where any guard fails; what some guards leave is in their own fills."""
    empties: tuple[str, ...]
    zeros: tuple[tuple[str, int], ...]
    shared_locals: tuple[str, ...]
    leg_locals: tuple[str, ...]
    uses_geometry: bool
    angle_count: int
    shared_angle_calls: tuple[str, ...]
    leg_angle_calls: tuple[str, ...]
    shared_calls: tuple[str, ...]
    leg_calls: tuple[Statement, ...]
    scatters: tuple[Scatter, ...]
    tail_count: int
    tail_stores: tuple[tuple[str, str], ...]
    platform_tail_stores: tuple[tuple[str, str], ...]
    platform_calls: tuple[Statement, ...]
    leg_guards: tuple[GuardView, ...]
    platform_guards: tuple[GuardView, ...]
    legs: LegsView | None
    """The legs side by side; what calls, locals and angles of legs there are otherwise, is then there."""
    in_sizes: tuple[int, ...]
    out_sizes: tuple[int, ...]

    @property
    def has_roots(self) -> bool:
        """Whether it needs the roots of a polynomial."""
        return any(call.at_roots for call in (*self.leg_calls, *self.platform_calls))


@dataclass(frozen=True)
class Scatter:
    """A leg's block copied to its place on the diagonal of the whole matrix."""

    block: str
    target: str
    rows: int
    columns: int
    width: int


@dataclass(frozen=True)
class GuardView:
    """A condition that must hold, the status where it does not, and what is then NaN."""

    condition: str
    status: str
    fills: tuple[tuple[str, int], ...]


def _full_parameter(port: Port, *, output: bool = False, writing: Writing = NUMBER) -> str:
    if output:
        return f"{writing.array} *KRHPR_RESTRICT {port.name}"
    array = port.full_shape or writing is LANES  # vectors do not go through registers
    return f"const {writing.array} {port.name}[{port.full_size}]" if array else f"{writing.real} {port.name}"


def prototype(robot: RobotCode, function: RobotFunction) -> dict[str, object]:
    """A function as the header declares and documents it."""
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
    return "; NULL for the default" if port.name in OPTIONAL_INPUTS else ""


def function_view(robot: RobotCode, function: RobotFunction, writing: Writing = NUMBER) -> FunctionView:
    """A function's statements in the order of the source: of one pose, or of poses side by side."""
    known = variables(function, robot.parts)
    outside = _read_outside_the_loop(robot, function)
    legs = legs_view(robot, function, known, outside) if writing is NUMBER else None
    plan = Plan(robot, function, known, outside, writing, leave_out=Stage.LEG if legs else None)
    if writing is LANES:
        covered = _covered(robot, function, (Stage.SHARED, Stage.LEG))
    else:
        covered = _covered(robot, function, (Stage.LEG,)) if legs else set()
    diagonal = [port for port in function.outputs if port.layout is Layout.DIAGONAL]
    of_roots = {  # they have variables of their own
        call.variable_out(port.name)
        for call in function.calls
        if call.each is not None
        for port in robot.parts[call.part].kernel(call.kernel).outputs
    }
    made = {
        variable.name: variable
        for variable in known.values()
        if variable.kind == "local" and variable.name not in of_roots
    }
    leg_guards = [guard for guard in function.guards if known[guard.variable].per_leg]
    # a leg's guard has seen to the legs' parts
    shared = [port for port in function.outputs if not port.per_leg or len(leg_guards) < len(function.guards)]
    whole = [port for port in shared if all(port in guard.spoilt([port]) for guard in function.guards)]
    partly = [port for port in shared if port not in whole]
    return FunctionView(
        name=function.name,
        symbol=f"krhpr_{robot.identifier}_{function.name}",
        doc=function.doc,
        equations=function.equations,
        inputs=tuple(port_text(port, full=True) for port in function.inputs),
        outputs=tuple(port_text(port, full=True) for port in function.outputs),
        parameters=tuple(_full_parameter(port, writing=writing) for port in function.inputs)
        + tuple(_full_parameter(port, output=True, writing=writing) for port in function.outputs),
        optional=tuple((port.name, default(port)) for port in function.inputs if default(port)),
        finite=tuple(
            (_address(port, writing), port.full_size) for port in function.inputs if port.name not in covered
        ),
        of_angles=tuple(
            (_address(port, writing), port.full_size) for port in function.inputs if port.name in covered
        ),
        fills=tuple((port.name, port.full_size) for port in function.outputs),
        whole_fills=tuple((port.name, port.full_size) for port in whole),
        empties=tuple(dict.fromkeys(name for guard in function.guards for name in guard.empties)),
        zeros=tuple((port.name, port.full_size) for port in diagonal),
        shared_locals=tuple(
            _local(variable, writing, robot.legs if variable.per_leg else 0)
            for variable in made.values()
            if not variable.per_leg or variable.name in outside
        ),
        leg_locals=()
        if legs
        else tuple(
            [
                _local(variable, writing, 0)
                for variable in made.values()
                if variable.per_leg and variable.name not in outside
            ]
            + [f"{writing.real} {port.name}_block[{port.size}];" for port in diagonal]
        ),
        uses_geometry=function.uses_geometry(robot.parts),
        angle_count=plan.angle_count,
        shared_angle_calls=tuple(plan.shared_angle_calls),
        leg_angle_calls=tuple(plan.leg_angle_calls),
        shared_calls=tuple(plan.shared_calls),
        leg_calls=tuple(plan.leg_calls),
        scatters=tuple(
            Scatter(f"{port.name}_block", port.name, port.shape[0], port.shape[1], port.full_shape[1])
            for port in diagonal
        ),
        tail_count=plan.tail_count,
        tail_stores=tuple(plan.tail_stores),
        platform_tail_stores=tuple(plan.platform_tail_stores),
        platform_calls=tuple(plan.platform_calls),
        leg_guards=tuple(_leg_guard(guard, function, writing, partly) for guard in leg_guards),
        platform_guards=tuple(
            _platform_guard(guard, writing, partly) for guard in function.guards if guard not in leg_guards
        ),
        legs=legs,
        in_sizes=tuple(port.full_size for port in function.inputs),
        out_sizes=tuple(port.full_size for port in function.outputs),
    )


def _covered(robot: RobotCode, function: RobotFunction, stages: tuple[Stage, ...]) -> set[str]:
    """Inputs whose every element is part of an angle of these stages."""
    return {
        call.variable_in(port.name)
        for call in function.calls
        if call.stage in stages and call.repeat is None and call.each is None
        for phases in (robot.parts[call.part].phases[call.kernel],)
        if phases.angles is not None
        for port in phases.angles.inputs
        if phases.covers(port.name)
    }


def _read_outside_the_loop(robot: RobotCode, function: RobotFunction) -> set[str]:
    """Variables that the loop over the legs makes and that something after it reads: each leg needs its
    own.
    """
    read = {guard.variable for guard in function.guards}
    for call in function.stage(Stage.PLATFORM):
        read |= set(call.reads(robot.parts[call.part].kernel(call.kernel)))
    return read


def _address(port: Port, writing: Writing) -> str:
    return port.name if port.full_shape or writing is LANES else f"&{port.name}"


def _local(variable: Variable, writing: Writing, legs: int) -> str:
    size = prod(variable.port.shape) * (legs or 1)
    array = f"[{size}]" if legs or variable.port.shape else ""
    return f"{writing.real} {variable.name}{array};"


def _leg_guard(guard: Guard, function: RobotFunction, writing: Writing, partly: list[Port]) -> GuardView:
    """A leg's guard: where it fails, that leg's part of every leg-wise output is NaN."""
    leg_named = guard.status in LEG_STATUSES
    fills = [(port.name, port.full_size) for port in guard.spoilt(partly) if not port.per_leg]
    for port in guard.spoilt(port for port in function.outputs if port.per_leg):
        if port.layout is Layout.DIAGONAL:
            rows, columns = port.shape
            width = port.full_shape[1]
            fills += [
                (f"{port.name} + {rows * width + columns} * i + {row * width}", columns)
                for row in range(rows)
            ]
        else:
            fills.append((f"{port.name} + {port.size} * i", port.size))
    return GuardView(
        holds(guard, f"{guard.variable}[i]", writing),
        f"KRHPR_{guard.status.name}" + (" + i" if leg_named else ""),
        tuple(fills),
    )


def _platform_guard(guard: Guard, writing: Writing, partly: list[Port]) -> GuardView:
    """A guard of the whole platform: where it fails, it spoils these outputs beside those that all spoil."""
    fills = tuple((port.name, port.full_size) for port in guard.spoilt(partly))
    return GuardView(
        holds(guard, f"{guard.variable}[{guard.index}]", writing), f"KRHPR_{guard.status.name}", fills
    )
