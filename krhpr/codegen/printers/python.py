"""The Python dialects: component-wise NumPy, and CasADi's SX, which differ in the names of functions
alone.
"""

from __future__ import annotations

import keyword
from collections.abc import Mapping
from fractions import Fraction

from krhpr.codegen.graph import InputRef, Op
from krhpr.codegen.kernel import GEOMETRY_PREFIX, Kernel
from krhpr.codegen.printers.c import is_array
from krhpr.codegen.printers.infix import Body, Dialect, print_body
from krhpr.codegen.printers.literals import decimal

NUMPY = {
    Op.SQRT: "np.sqrt",
    Op.SIN: "np.sin",
    Op.COS: "np.cos",
    Op.ATAN2: "np.arctan2",
    Op.ABS: "np.abs",
    Op.MIN: "np.fmin",
    Op.MAX: "np.fmax",
}

CASADI = {
    Op.SQRT: "ca.sqrt",
    Op.SIN: "ca.sin",
    Op.COS: "ca.cos",
    Op.ATAN2: "ca.atan2",
    Op.ABS: "ca.fabs",
    Op.MIN: "ca.fmin",
    Op.MAX: "ca.fmax",
}

RESERVED = frozenset(keyword.kwlist) | {"np", "ca", "g"}


def constant(value: Fraction) -> str:
    """A literal; whole numbers stay whole, so that the code runs on exact numbers too."""
    if value.denominator == 1:
        return str(value.numerator)
    return decimal(value) or f"({value.numerator} / {value.denominator})"


def component(port: str, index: int, shape: tuple[int, ...]) -> str:
    """The local name of one element of a port: `s_0`, `Q_12`, or `phi` for a scalar."""
    if not shape:
        return port
    digits = ""
    for length in reversed(shape):
        index, digit = divmod(index, length)
        digits = f"{digit}{digits}"
    return f"{port}_{digits}"


def print_kernel(kernel: Kernel, functions: Mapping[Op, str]) -> Body:
    """Lines of a kernel; elements of inputs are local names."""
    return print_body(kernel, Dialect(functions, constant, lambda ref: _input(kernel, ref), RESERVED))


def _input(kernel: Kernel, ref: InputRef) -> str:
    if ref.port.startswith(GEOMETRY_PREFIX):
        assert kernel.geometry is not None
        field = ref.port.removeprefix(GEOMETRY_PREFIX)
        return f"g.{field}[{ref.index}]" if is_array(kernel.geometry, field) else f"g.{field}"
    return component(ref.port, ref.index, kernel.input_port(ref.port).shape)
