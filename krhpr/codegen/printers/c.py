"""The C dialect: how kernels and robot functions read in C99."""

from __future__ import annotations

from fractions import Fraction

from krhpr.codegen.graph import InputRef, Op
from krhpr.codegen.kernel import GEOMETRY_PREFIX, GeometryType, Kernel
from krhpr.codegen.printers.infix import Body, Dialect, print_body
from krhpr.codegen.printers.literals import decimal

FUNCTIONS = {
    Op.SQRT: "sqrt",
    Op.SIN: "krhpr_sin",
    Op.COS: "krhpr_cos",
    Op.ATAN2: "krhpr_atan2",
    Op.ABS: "fabs",
    Op.MIN: "krhpr_min",
    Op.MAX: "krhpr_max",
}

LANE_FUNCTIONS = {op: f"krhpr_lanes_{name.removeprefix('krhpr_')}" for op, name in FUNCTIONS.items()}
"""The same functions side by side."""

_WORDS = """
auto break case char const continue default do double else enum extern float for goto if inline int long
register restrict return short signed sizeof static struct switch typedef union unsigned void volatile while
near far I j0 j1 jn y0 y1 yn gamma signgam g leg i k angle sine cosine tail tail_x tail_y status
"""
RESERVED = frozenset(_WORDS.split())
"""Keywords, macros, functions of math.h and the names that the templates use."""


def constant(value: Fraction) -> str:
    """A literal that the compiler reads as the nearest double, and that is exact when read as decimal
    text.
    """
    if value.denominator == 1:
        return f"{value.numerator}.0"
    return decimal(value) or f"({value.numerator}.0 / {value.denominator}.0)"


def print_kernel(kernel: Kernel) -> Body:
    """Lines of a kernel; inputs are elements of arrays, scalars are plain parameters."""
    return print_body(
        kernel, Dialect(FUNCTIONS, constant, lambda ref: input_text(kernel, ref), RESERVED, pairs=True)
    )


def print_lanes(kernel: Kernel) -> Body:
    """The same lines over lanes; numbers of the geometry are variables (`lane_text`)."""
    alone = "krhpr_all({})".format
    return print_body(
        kernel,
        Dialect(
            LANE_FUNCTIONS, constant, lambda ref: lane_text(kernel, ref), RESERVED, pairs=True, alone=alone
        ),
    )


def lane_text(kernel: Kernel, ref: InputRef) -> str:
    """An input, or the variable that holds a number of the geometry: `g_l_3`, `g_e_x_0`."""
    if not ref.port.startswith(GEOMETRY_PREFIX):
        return input_text(kernel, ref)
    assert kernel.geometry is not None
    field = ref.port.removeprefix(GEOMETRY_PREFIX)
    return f"g_{field}_{ref.index}" if is_array(kernel.geometry, field) else f"g_{field}"


def input_text(kernel: Kernel, ref: InputRef) -> str:
    """How a kernel reads one component of an input, or of the geometry of leg `i`."""
    if ref.port.startswith(GEOMETRY_PREFIX):
        assert kernel.geometry is not None
        field = ref.port.removeprefix(GEOMETRY_PREFIX)
        return f"g->{field}[{ref.index}][i]" if is_array(kernel.geometry, field) else f"g->{field}[i]"
    return f"{ref.port}[{ref.index}]" if kernel.input_port(ref.port).shape else ref.port


def is_array(geometry: GeometryType, field: str) -> bool:
    """Whether a geometry's field is an array (prepared) or a scalar (set by a person)."""
    return all(entry.name != field for entry in geometry.fields)
