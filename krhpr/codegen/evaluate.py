"""Evaluation of graphs and robot functions over any numbers: floats, exact rationals, balls, mpmath, symbols.

This is what "the derivation" means when printed code is compared with it: formulas are evaluated node by
node, without any printer.  Numbers need + - * / and unary minus; the rest comes from an `Arithmetic`.
"""

from __future__ import annotations

import math
import operator
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

from krhpr.codegen.composition import EachPair, Repeat, RobotFunction, Stage
from krhpr.codegen.graph import InputRef, Op
from krhpr.codegen.kernel import GEOMETRY_PREFIX, GeometryType, Kernel, Layout, Port


@dataclass(frozen=True)
class Arithmetic:
    """The functions that a kind of number offers, and how a rational constant becomes such a number."""

    constant: Callable[[Fraction], Any]
    functions: Mapping[Op, Callable[..., Any]]


def _float_sqrt(x: float) -> float:
    return math.sqrt(x) if x >= 0 else math.nan


FLOAT = Arithmetic(
    float,
    {
        Op.SQRT: _float_sqrt,
        Op.SIN: math.sin,
        Op.COS: math.cos,
        Op.ATAN2: math.atan2,
        Op.ABS: abs,
        Op.MIN: lambda a, b: a if a < b else b,
        Op.MAX: lambda a, b: a if a > b else b,
    },
)

METHODS = Arithmetic(
    lambda value: value,
    {
        Op.SQRT: lambda x: x.sqrt(),
        Op.SIN: lambda x: x.sin(),
        Op.COS: lambda x: x.cos(),
        Op.ATAN2: lambda y, x: y.arctan2(x),
        Op.ABS: abs,
        Op.MIN: lambda a, b: a if a < b else b,
        Op.MAX: lambda a, b: a if a > b else b,
    },
)
"""Numbers that bring their own functions as methods."""

_BASIC: Mapping[Op, Callable[..., Any]] = {
    Op.ADD: operator.add,
    Op.SUB: operator.sub,
    Op.MUL: operator.mul,
    Op.DIV: operator.truediv,
    Op.NEG: operator.neg,
}


def evaluate_kernel(
    kernel: Kernel,
    inputs: Mapping[str, Sequence[Any]],
    geometry: Mapping[str, Sequence[Any]] | None = None,
    arithmetic: Arithmetic = FLOAT,
) -> dict[str, list[Any]]:
    """Outputs of a kernel by port, flat and row-major; `geometry` as `prepare_geometry` gives it."""
    values: dict[int, Any] = {}
    for index, value in kernel.leaves:
        if isinstance(value, InputRef):
            values[index] = _read(value, inputs, geometry)
        else:
            values[index] = arithmetic.constant(value)
    functions = {**_BASIC, **arithmetic.functions}
    for index, operation, a, b in kernel.program:  # plain tuples: most of a proof's time is spent here
        if b is None:
            values[index] = functions[operation](values[a])
        else:
            values[index] = functions[operation](values[a], values[b])
    return {port.name: [values[node] for node in kernel.results[port.name]] for port in kernel.outputs}


def _read(
    ref: InputRef, inputs: Mapping[str, Sequence[Any]], geometry: Mapping[str, Sequence[Any]] | None
) -> Any:
    if ref.port.startswith(GEOMETRY_PREFIX):
        assert geometry is not None, f"{ref.port} needs a geometry"
        return geometry[ref.port.removeprefix(GEOMETRY_PREFIX)][ref.index]
    return inputs[ref.port][ref.index]


def prepare_geometry(
    geometry: GeometryType, fields: Mapping[str, Any], arithmetic: Arithmetic = FLOAT
) -> dict[str, list[Any]]:
    """One leg's fields and prepared vectors, each as a flat list."""
    own = {field.name: [fields[field.name]] for field in geometry.fields}
    return {**own, **evaluate_kernel(geometry.prepare, own, None, arithmetic)}


def evaluate_function(
    function: RobotFunction,
    kernel_of: Callable[[str, str], Kernel],
    geometries: Mapping[str, Sequence[Mapping[str, Sequence[Any]]]],
    inputs: Mapping[str, Sequence[Any]],
    arithmetic: Arithmetic = FLOAT,
) -> dict[str, list[Any]]:
    """Outputs of a robot's function, flat and row-major in their full shape; guards are not applied.

    `kernel_of(part, name)` gives the kernels (as derived, or optimised), `geometries[part][leg]` the prepared
    geometry.
    """
    values: dict[str, Any] = {}
    for port in function.inputs:
        flat = list(inputs[port.name])
        values[port.name] = (
            [flat[leg * port.size : (leg + 1) * port.size] for leg in range(port.legs)]
            if port.per_leg
            else flat
        )
    per_leg = {port.name: port.per_leg for port in function.inputs}
    for call in function.calls:
        kernel = kernel_of(call.part, call.kernel)
        if call.pairs is not None:
            (port,) = kernel.outputs
            name = call.variable_out(port.name)
            per_leg[name] = False
            values[name] = _of_pairs(call.pairs, kernel, values, per_leg, arithmetic)
            continue
        legs = range(function.legs) if call.stage is Stage.LEG else (None,)
        found: dict[str, list[Any]] = {port.name: [] for port in kernel.outputs}
        for leg in legs:
            arguments = {}
            for port in kernel.inputs:
                name = call.variable_in(port.name)
                if per_leg[name]:
                    parts = values[name]
                    arguments[port.name] = (
                        parts[leg] if leg is not None else [x for part in parts for x in part]
                    )
                else:
                    arguments[port.name] = values[name]
            geometry = None
            if kernel.geometry is not None:
                geometry = geometries[call.part][leg or 0]
            if call.repeat is not None:
                result = _repeated(call.repeat, kernel, arguments, geometry, arithmetic)
            else:
                result = evaluate_kernel(kernel, arguments, geometry, arithmetic)
            for name, flat in result.items():
                found[name].append(flat)
        for port in kernel.outputs:
            name = call.variable_out(port.name)
            per_leg[name] = call.stage is Stage.LEG
            values[name] = found[port.name] if per_leg[name] else found[port.name][0]
    zero = arithmetic.constant(Fraction(0))
    return {port.name: _whole(port, values[port.name], zero) for port in function.outputs}


def _of_pairs(
    pairs: EachPair,
    kernel: Kernel,
    values: Mapping[str, Any],
    per_leg: Mapping[str, bool],
    arithmetic: Arithmetic,
) -> list[Any]:
    """What a kernel gives for every pair of links."""
    flat = [
        x
        for name in pairs.places
        for part in ([*values[name]] if per_leg[name] else [values[name]])
        for x in part
    ]
    found = []
    for ends in pairs.ends:
        points = {
            port.name: flat[3 * end : 3 * end + 3] for port, end in zip(kernel.inputs, ends, strict=True)
        }
        (result,) = evaluate_kernel(kernel, points, None, arithmetic).values()
        found += result
    return found


def _repeated(
    repeat: Repeat,
    kernel: Kernel,
    arguments: Mapping[str, Sequence[Any]],
    geometry: Mapping[str, Sequence[Any]] | None,
    arithmetic: Arithmetic,
) -> dict[str, list[Any]]:
    """The results of the last call of a bounded iteration (of all elements, where values are arrays)."""
    tolerance = arithmetic.constant(Fraction(repr(repeat.tolerance)))
    state, result = arguments[repeat.before], {}
    for _ in range(repeat.limit):
        result = evaluate_kernel(kernel, {**arguments, repeat.before: state}, geometry, arithmetic)
        state = result[repeat.after]
        small = result[repeat.change][0] <= tolerance
        if small if isinstance(small, bool) else small.all():
            break
    return result


def _whole(port: Port, value: Any, zero: Any) -> list[Any]:
    if not port.per_leg:
        return list(value)
    if port.layout is not Layout.DIAGONAL:
        return [x for part in value for x in part]
    rows, columns = port.shape
    whole = [zero] * port.full_size
    for leg, block in enumerate(value):
        for row in range(rows):
            for column in range(columns):
                whole[(leg * rows + row) * columns * port.legs + leg * columns + column] = block[
                    row * columns + column
                ]
    return whole
