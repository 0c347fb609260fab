"""Functions that call others of the robot one after the other, as the C template sees them."""

from __future__ import annotations

from dataclasses import dataclass
from math import prod

from krhpr.codegen.composition import RobotFunction, Step
from krhpr.codegen.kernel import Port
from krhpr.codegen.robot_code import RobotCode
from krhpr.codegen.targets.base import broken
from krhpr.codegen.targets.c_functions import prototype


@dataclass(frozen=True)
class SequenceView:
    """A sequence as the template sees it: locals and calls."""

    symbol: str
    parameters: tuple[str, ...]
    locals: tuple[str, ...]
    calls: tuple[str, ...]


def sequence_view(robot: RobotCode, function: RobotFunction) -> SequenceView:
    """A sequence's statements in the order of the source."""
    about = prototype(robot, function)
    known: dict[str, Port] = {port.name: port for port in (*function.inputs, *function.outputs)}
    made: dict[str, Port] = {}
    calls = []
    for step in function.steps:
        called = robot.function(step.function)
        for port in called.outputs:
            if port.name not in known:
                made[port.name] = known[port.name] = port
        calls.append(_call(robot, function, step, made))
    return SequenceView(
        symbol=str(about["symbol"]),
        parameters=tuple(about["parameters"]),  # type: ignore[arg-type]
        locals=tuple(
            f"double {port.name}[{prod(port.full_shape)}];" if port.full_shape else f"double {port.name};"
            for port in made.values()
        ),
        calls=tuple(calls),
    )


def _call(robot: RobotCode, function: RobotFunction, step: Step, made: dict[str, Port]) -> str:
    called = robot.function(step.function)
    written = {port.name for port in function.outputs if not port.full_shape}  # through pointers
    names = [step.variable_in(port.name) for port in called.inputs]
    arguments = [] if robot.baked else ["g"]
    arguments += [f"*{name}" if name in written else name for name in names]
    arguments += [
        f"&{port.name}" if port.name in made and not port.full_shape else port.name for port in called.outputs
    ]
    return broken(f"here = krhpr_{robot.identifier}_{called.name}", arguments, ";", 4)
