"""Random straight-line programs, written into a graph and computed beside it, operation by operation.

Numbers and angles are kept apart, as exact angles can only be added, and their sines and cosines taken.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Any

from hypothesis import strategies as st

from krhpr.codegen.evaluate import Arithmetic
from krhpr.codegen.graph import Graph, InputRef, Op
from krhpr.codegen.kernel import Frame, GeometryField, GeometryType, Kernel, Port, Unit
from krhpr.validation.numbers import Angle, Exact

NUMBERS, ANGLES = 4, 2
CONSTANTS = [Fraction(n, d) for n, d in ((0, 1), (1, 1), (-1, 1), (2, 1), (1, 2), (-3, 1), (1, 3), (-5, 4))]

_BINARY = (Op.ADD, Op.SUB, Op.MUL, Op.DIV, Op.MIN, Op.MAX)
_UNARY = (Op.NEG, Op.ABS, Op.SIN, Op.COS)
SMOOTH = (Op.ADD, Op.SUB, Op.MUL, Op.DIV, Op.NEG, Op.SIN, Op.COS)

Step = tuple[Op, int, int]
"""An operation and where its operands are found (counted from the start, modulo what there is)."""


def steps(ops: Sequence[Op] = (*_BINARY, *_UNARY), longest: int = 25) -> st.SearchStrategy[list[Step]]:
    place = st.integers(0, 40)
    return st.lists(st.tuples(st.sampled_from(list(ops)), place, place), min_size=1, max_size=longest)


rationals = st.fractions(min_value=-3, max_value=3, max_denominator=7)
half_tangents = st.fractions(min_value=-3, max_value=3, max_denominator=5)


@st.composite
def points(draw: st.DrawFn) -> list[Any]:
    """Values of the inputs: numbers, then angles."""
    numbers = [Exact(draw(rationals)) for _ in range(NUMBERS)]
    return [*numbers, *(Angle.from_half_tangent(draw(half_tangents)) for _ in range(ANGLES))]


def references(prefix: str = "") -> list[InputRef]:
    """The inputs `n` and `a`; with a prefix, scalar fields of a geometry."""
    if prefix:
        return [InputRef(f"{prefix}n{i}", 0) for i in range(NUMBERS)] + [
            InputRef(f"{prefix}a{i}", 0) for i in range(ANGLES)
        ]
    return [InputRef("n", i) for i in range(NUMBERS)] + [InputRef("a", i) for i in range(ANGLES)]


@dataclass
class Program:
    """A graph and, for every number written into it, its node and its value computed directly."""

    graph: Graph = field(default_factory=Graph)
    numbers: list[tuple[int, Any]] = field(default_factory=list)
    angles: list[tuple[int, Any]] = field(default_factory=list)

    def leaves(self, inputs: Sequence[InputRef], values: Sequence[Any], arithmetic: Arithmetic) -> None:
        for ref, value in zip(inputs, values, strict=True):
            angle = ref.port.removeprefix("g.").startswith("a")
            pool = self.angles if angle else self.numbers
            pool.append((self.graph.input(ref.port, ref.index), value))
        for constant in CONSTANTS:
            self.numbers.append((self.graph.constant(constant), arithmetic.constant(constant)))

    def write(self, program: Sequence[Step], arithmetic: Arithmetic) -> None:
        for op, i, j in program:
            if op in (Op.SIN, Op.COS):
                node, value = self.angles[i % len(self.angles)]
                self.numbers.append((self.graph.apply(op, (node,)), arithmetic.functions[op](value)))
                if i % 3 == 0:  # angles make new angles on the way
                    other, more = self.angles[j % len(self.angles)]
                    self.angles.append((self.graph.sub(node, other), value - more))
                    self.angles.append((self.graph.neg(node), -value))
                continue
            (a, x), (b, y) = self.numbers[i % len(self.numbers)], self.numbers[j % len(self.numbers)]
            if op is Op.DIV and (not y or self.graph.value(b) == 0):
                continue
            if op in (Op.NEG, Op.ABS):
                node, value = self.graph.apply(op, (a,)), -x if op is Op.NEG else abs(x)
            else:
                node, value = self.graph.apply(op, (a, b)), direct(op, x, y, arithmetic)
            self.numbers.append((node, value))


def direct(op: Op, x: Any, y: Any, arithmetic: Arithmetic) -> Any:
    match op:
        case Op.ADD:
            return x + y
        case Op.SUB:
            return x - y
        case Op.MUL:
            return x * y
        case Op.DIV:
            return x / y
        case _:
            return arithmetic.functions[op](x, y)


def kernel(graph: Graph, nodes: Sequence[int], geometry: GeometryType | None = None) -> Kernel:
    """A kernel of the inputs `n` and `a` with some nodes as its output."""
    inputs = (
        Port("n", (NUMBERS,), Unit.NONE, Frame.NONE, ""),
        Port("a", (ANGLES,), Unit.RADIAN, Frame.NONE, ""),
    )
    output = Port("out", (len(nodes),), Unit.NONE, Frame.NONE, "")
    return Kernel("random", "", "", inputs, (output,), graph, {"out": tuple(nodes)}, 0, geometry)


def inputs_of(values: Sequence[Any]) -> dict[str, Sequence[Any]]:
    """Numbers and angles as the kernel's inputs."""
    return {"n": values[:NUMBERS], "a": values[NUMBERS:]}


def geometry_of(program: Program) -> GeometryType:
    """A geometry with scalar fields and a prepared vector: the last numbers of a program over the fields."""
    names = [ref.port for ref in field_references()]
    results = tuple(node for node, _ in program.numbers[-3:])
    inputs = tuple(Port(name, (), Unit.NONE, Frame.NONE, "") for name in names)
    outputs = (Port("v", (3,), Unit.NONE, Frame.NONE, ""),)
    prepare = Kernel("prepare", "", "", inputs, outputs, program.graph, {"v": results}, 0)
    fields = tuple(GeometryField(name, Unit.NONE, "") for name in names)
    return GeometryType("random", "", fields, prepare)


def field_references() -> list[InputRef]:
    return [InputRef(f"n{i}", 0) for i in range(NUMBERS)] + [InputRef(f"a{i}", 0) for i in range(ANGLES)]
