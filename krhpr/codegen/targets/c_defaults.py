"""What stands for optional inputs that are NULL, as constants of the C text."""

from __future__ import annotations

from collections.abc import Iterable

from krhpr.codegen.composition import OPTIONAL_INPUTS, RobotFunction
from krhpr.codegen.kernel import Port
from krhpr.codegen.robot_code import RobotCode


def default(port: Port) -> str:
    """The constant that stands for an optional input; empty for others."""
    return f"{port.name}_default" if port.name in OPTIONAL_INPUTS else ""


def default_constants(robot: RobotCode, functions: Iterable[RobotFunction]) -> dict[str, tuple[float, ...]]:
    """The constants that these functions need, by name."""
    values = {
        "mode_default": robot.legs * robot.default_mode,
        "assembly_default": robot.legs * robot.default_assembly,
        "box_default": tuple(limit for box in robot.default_box for limit in box),
        "swivel_default": robot.legs * (0.0,),
    }
    needed = {default(port) for function in functions for port in function.inputs}
    return {name: numbers for name, numbers in values.items() if name in needed}
