"""Batches of a robot's functions as the C templates see them."""

from __future__ import annotations

from dataclasses import dataclass

from krhpr.codegen.composition import RobotFunction
from krhpr.codegen.kernel import Port
from krhpr.codegen.robot_code import RobotCode
from krhpr.codegen.targets.c_defaults import default
from krhpr.codegen.targets.c_functions import FunctionView, function_view
from krhpr.codegen.targets.c_numbers import LANES

PARAMETERS = [
    "size_t count",
    "const double *const in[]",
    "const ptrdiff_t in_step[]",
    "double *const out[]",
    "const ptrdiff_t out_step[]",
    "int *status",
    "ptrdiff_t status_step",
]
"""Parameters of every batch function, after the geometry."""


SOA_PARAMETERS = ["size_t count", "size_t block", *PARAMETERS[1:6]]
"""Those of its form for a structure of arrays."""


@dataclass(frozen=True)
class Argument:
    """An input or output: its name, its numbers for one pose, and what stands for it where it is NULL."""

    name: str
    size: int
    default: str = ""


@dataclass(frozen=True)
class BatchView:
    """A batch: poses side by side if `poses` is there, else calls of the function one after the other."""

    symbol: str
    poses: FunctionView | None
    inputs: tuple[Argument, ...]
    outputs: tuple[Argument, ...]
    arguments: tuple[str, ...]
    """Those of the call for pose k of an array of structures."""
    values: tuple[str, ...]
    """Those of a call with variables."""

    @property
    def names(self) -> list[str]:
        """Variables of all arguments over lanes."""
        return [f"{port.name}_lanes" for port in (*self.inputs, *self.outputs)]


def goes_side_by_side(function: RobotFunction) -> bool:
    """Whether a function's batch is computed over lanes: all but those with roots, choices or steps."""
    return bool(function.calls) and function.each is None


def batch_view(robot: RobotCode, function: RobotFunction) -> BatchView:
    """The batch of a function."""
    return BatchView(
        symbol=f"krhpr_{robot.identifier}_{function.name}",
        poses=function_view(robot, function, LANES) if goes_side_by_side(function) else None,
        inputs=tuple(Argument(port.name, port.full_size, default(port)) for port in function.inputs),
        outputs=tuple(Argument(port.name, port.full_size) for port in function.outputs),
        arguments=(
            *(_input(port, index) for index, port in enumerate(function.inputs)),
            *(f"out[{index}] + k * out_step[{index}]" for index in range(len(function.outputs))),
        ),
        values=(
            *(_value(port, index) for index, port in enumerate(function.inputs)),
            *(f"{port.name}_pose" for port in function.outputs),
        ),
    )


def _value(port: Port, index: int) -> str:
    if default(port):
        return f"in[{index}] ? {port.name}_pose : NULL"
    return f"{port.name}_pose" if port.full_shape else f"{port.name}_pose[0]"


def _input(port: Port, index: int) -> str:
    element = f"in[{index}] + k * in_step[{index}]"
    if default(port):
        return f"in[{index}] ? {element} : NULL"
    return element if port.full_shape else f"*({element})"
