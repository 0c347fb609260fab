"""Expression graphs: straight-line programs in which no expression stands twice.

A `Graph` is a list of nodes in evaluation order.  Nodes are value-numbered: asking for an operation that
exists returns the node that exists, so common sub-expressions are shared from the start.  Only identities
that hold in exact arithmetic *and* never turn a finite floating-point result into a different one are applied
on the way in (x + 0, x * 1, double negation, signs moved outwards, folding of rational constants).
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from enum import StrEnum
from fractions import Fraction


class Op(StrEnum):
    """The operations of the graph.  Every target's printer knows exactly these."""

    CONST = "const"
    INPUT = "input"
    ADD = "add"
    SUB = "sub"
    MUL = "mul"
    DIV = "div"
    NEG = "neg"
    SQRT = "sqrt"
    SIN = "sin"
    COS = "cos"
    ATAN2 = "atan2"
    ABS = "abs"
    MIN = "min"
    MAX = "max"


COMMUTATIVE = frozenset({Op.ADD, Op.MUL})
# MIN and MAX are not: where the first operand is NaN the second is the result (a > b ? a : b)
LEAVES = frozenset({Op.CONST, Op.INPUT})
KINKS = frozenset({Op.ABS, Op.MIN, Op.MAX})
"""Operations without a derivative somewhere."""


@dataclass(frozen=True, order=True)
class InputRef:
    """One scalar component of an input port (row-major index)."""

    port: str
    index: int


@dataclass(frozen=True)
class Node:
    """One operation; `args` are indices of earlier nodes, `value` is set for leaves only."""

    op: Op
    args: tuple[int, ...] = ()
    value: Fraction | InputRef | None = None


@dataclass(frozen=True)
class Name:
    """The name that a derivation gave to a node (`u_1`, component 0), with a remark such as an equation
    number.
    """

    text: str
    component: str = ""
    note: str = ""


class GraphError(ValueError):
    """A graph was asked for something that has no meaning (division by the constant zero, say)."""


@dataclass
class Graph:
    """A value-numbered straight-line program."""

    nodes: list[Node] = field(default_factory=list)
    names: dict[int, Name] = field(default_factory=dict)
    _known: dict[Node, int] = field(default_factory=dict)

    def __len__(self) -> int:
        return len(self.nodes)

    def __iter__(self) -> Iterator[tuple[int, Node]]:
        return iter(enumerate(self.nodes))

    # -- leaves ---------------------------------------------------------------------------------------------

    def constant(self, value: int | Fraction) -> int:
        """A rational constant."""
        return self._emit(Node(Op.CONST, (), Fraction(value)))

    def input(self, port: str, index: int) -> int:
        """One component of an input port."""
        return self._emit(Node(Op.INPUT, (), InputRef(port, index)))

    def value(self, node: int) -> Fraction | None:
        """The constant at `node`, or None when it is not a constant."""
        entry = self.nodes[node]
        return entry.value if isinstance(entry.value, Fraction) else None

    # -- operations -----------------------------------------------------------------------------------------

    def add(self, a: int, b: int) -> int:
        """The node of a + b."""
        x, y = self.value(a), self.value(b)
        if x is not None and y is not None:
            return self.constant(x + y)
        if x == 0:
            return b
        if y == 0:
            return a
        negated_a, negated_b = self._negated(a), self._negated(b)
        if negated_b is not None:
            return self.sub(a, negated_b)
        if negated_a is not None:
            return self.sub(b, negated_a)
        return self._emit(Node(Op.ADD, (a, b)))

    def sub(self, a: int, b: int) -> int:
        """The node of a - b."""
        x, y = self.value(a), self.value(b)
        if x is not None and y is not None:
            return self.constant(x - y)
        if y == 0:
            return a
        if x == 0:
            return self.neg(b)
        if a == b:
            return self.constant(0)
        negated_a, negated_b = self._negated(a), self._negated(b)
        if negated_b is not None:
            return self.add(a, negated_b)
        if negated_a is not None:
            return self.neg(self.add(negated_a, b))
        return self._emit(Node(Op.SUB, (a, b)))

    def mul(self, a: int, b: int) -> int:
        """The node of a * b."""
        x, y = self.value(a), self.value(b)
        if x is not None and y is not None:
            return self.constant(x * y)
        for value, other in ((x, b), (y, a)):
            if value == 0:
                return self.constant(0)
            if value == 1:
                return other
            if value == -1:
                return self.neg(other)
        for value, other in ((x, b), (y, a)):
            if value is not None and value < 0:
                return self.neg(self.mul(self.constant(-value), other))
        negated_a, negated_b = self._negated(a), self._negated(b)
        if negated_a is not None and negated_b is not None:
            return self.mul(negated_a, negated_b)
        if negated_a is not None:
            return self.neg(self.mul(negated_a, b))
        if negated_b is not None:
            return self.neg(self.mul(a, negated_b))
        return self._emit(Node(Op.MUL, (a, b)))

    def div(self, a: int, b: int) -> int:
        """The node of a / b; division by a constant becomes a product."""
        x, y = self.value(a), self.value(b)
        if y == 0:
            raise GraphError("division by the constant zero")
        if x == 0:
            return self.constant(0)
        if y is not None:
            return self.mul(a, self.constant(1 / y))
        negated_a, negated_b = self._negated(a), self._negated(b)
        if negated_a is not None:
            return self.neg(self.div(negated_a, b))
        if negated_b is not None:
            return self.neg(self.div(a, negated_b))
        return self._emit(Node(Op.DIV, (a, b)))

    def neg(self, a: int) -> int:
        """The node of -a."""
        x = self.value(a)
        if x is not None:
            return self.constant(-x)
        node = self.nodes[a]
        if node.op is Op.NEG:
            return node.args[0]
        if node.op is Op.SUB:
            return self.sub(node.args[1], node.args[0])
        return self._emit(Node(Op.NEG, (a,)))

    def power(self, a: int, exponent: int) -> int:
        """An integer power as products (repeated squaring), a negative one as one division."""
        if exponent < 0:
            return self.div(self.constant(1), self.power(a, -exponent))
        result, square = self.constant(1), a
        while exponent:
            if exponent & 1:
                result = self.mul(result, square)
            exponent >>= 1
            if exponent:
                square = self.mul(square, square)
        return result

    def sqrt(self, a: int) -> int:
        """The node of the square root."""
        if self.value(a) in (0, 1):
            return a
        return self._emit(Node(Op.SQRT, (a,)))

    def sin(self, a: int) -> int:
        """The node of the sine; signs move outwards."""
        if self.value(a) == 0:
            return a
        negated = self._negated(a)
        if negated is not None:
            return self.neg(self.sin(negated))
        return self._emit(Node(Op.SIN, (a,)))

    def cos(self, a: int) -> int:
        """The node of the cosine; signs vanish."""
        if self.value(a) == 0:
            return self.constant(1)
        negated = self._negated(a)
        if negated is not None:
            return self.cos(negated)
        return self._emit(Node(Op.COS, (a,)))

    def atan2(self, y: int, x: int) -> int:
        """The node of the angle of (x, y)."""
        return self._emit(Node(Op.ATAN2, (y, x)))

    def absolute(self, a: int) -> int:
        """The node of |a|."""
        negated = self._negated(a)
        return self._emit(Node(Op.ABS, (a if negated is None else negated,)))

    def minimum(self, a: int, b: int) -> int:
        """The smaller of two; the second where the first is NaN."""
        return a if a == b else self._emit(Node(Op.MIN, (a, b)))

    def maximum(self, a: int, b: int) -> int:
        """The larger of two; the second where the first is NaN."""
        return a if a == b else self._emit(Node(Op.MAX, (a, b)))

    def apply(self, op: Op, args: Sequence[int]) -> int:
        """The operation `op` on existing nodes, simplified as on first construction."""
        return _METHODS[op](self, *args)

    def replay(self, node: Node, place: Sequence[int]) -> int:
        """A node of another graph written here; `place[i]` is where its argument i stands in this one."""
        if node.value is None:
            return self.apply(node.op, [place[argument] for argument in node.args])
        if isinstance(node.value, InputRef):
            return self.input(node.value.port, node.value.index)
        return self.constant(node.value)

    # -- structure ------------------------------------------------------------------------------------------

    def name(self, node: int, name: Name) -> None:
        """Name a node; the first name stays, and leaves keep the name of their port."""
        if self.nodes[node].op not in LEAVES:
            self.names.setdefault(node, name)

    def copy_into(
        self, target: Graph, bound: Mapping[InputRef, int], *, keep_names: bool = True
    ) -> list[int]:
        """Write this graph into `target` with its inputs replaced; returns the node there of every node
        here.
        """
        place: list[int] = []
        for index, node in self:
            replaced = bound.get(node.value) if isinstance(node.value, InputRef) else None
            here = target.replay(node, place) if replaced is None else replaced
            if keep_names and index in self.names:
                target.name(here, self.names[index])
            place.append(here)
        return place

    def needed(self, outputs: Iterable[int]) -> list[bool]:
        """For every node, whether one of `outputs` depends on it."""
        needed = [False] * len(self.nodes)
        for output in outputs:
            needed[output] = True
        for index in range(len(self.nodes) - 1, -1, -1):
            if needed[index]:
                for argument in self.nodes[index].args:
                    needed[argument] = True
        return needed

    def _negated(self, node: int) -> int | None:
        entry = self.nodes[node]
        return entry.args[0] if entry.op is Op.NEG else None

    def _emit(self, node: Node) -> int:
        if node.op in COMMUTATIVE and node.args[0] > node.args[1]:
            node = Node(node.op, (node.args[1], node.args[0]))
        known = self._known.get(node)
        if known is None:
            known = len(self.nodes)
            self.nodes.append(node)
            self._known[node] = known
        return known


_METHODS: Mapping[Op, Callable[..., int]] = {
    Op.ADD: Graph.add,
    Op.SUB: Graph.sub,
    Op.MUL: Graph.mul,
    Op.DIV: Graph.div,
    Op.NEG: Graph.neg,
    Op.SQRT: Graph.sqrt,
    Op.SIN: Graph.sin,
    Op.COS: Graph.cos,
    Op.ATAN2: Graph.atan2,
    Op.ABS: Graph.absolute,
    Op.MIN: Graph.minimum,
    Op.MAX: Graph.maximum,
}


@dataclass(frozen=True)
class OperationCount:
    """How many operations of each kind a straight-line program performs."""

    add: int = 0
    multiply: int = 0
    divide: int = 0
    square_root: int = 0
    sine_cosine: int = 0
    arctangent: int = 0
    select: int = 0

    def __add__(self, other: OperationCount) -> OperationCount:
        return self._zip(other, 1)

    def __mul__(self, times: int) -> OperationCount:
        return OperationCount(*(times * value for value in self.as_dict().values()))

    def _zip(self, other: OperationCount, sign: int) -> OperationCount:
        mine, theirs = self.as_dict(), other.as_dict()
        return OperationCount(**{key: mine[key] + sign * theirs[key] for key in mine})

    @property
    def total(self) -> int:
        """All operations together."""
        return sum(self.as_dict().values())

    def as_dict(self) -> dict[str, int]:
        """Counts by kind."""
        return {
            "add": self.add,
            "multiply": self.multiply,
            "divide": self.divide,
            "square_root": self.square_root,
            "sine_cosine": self.sine_cosine,
            "arctangent": self.arctangent,
            "select": self.select,
        }


_KIND = {
    Op.ADD: "add",
    Op.SUB: "add",
    Op.MUL: "multiply",
    Op.DIV: "divide",
    Op.SQRT: "square_root",
    Op.SIN: "sine_cosine",
    Op.COS: "sine_cosine",
    Op.ATAN2: "arctangent",
    Op.ABS: "select",
    Op.MIN: "select",
    Op.MAX: "select",
}


def count_operations(graph: Graph, outputs: Iterable[int]) -> OperationCount:
    """Operations that `outputs` need.  A sine and cosine of one angle count as one pair; signs are free."""
    needed = graph.needed(outputs)
    counts = dict.fromkeys(OperationCount().as_dict(), 0)
    angles: set[int] = set()
    for index, node in graph:
        kind = _KIND.get(node.op)
        if kind is None or not needed[index]:
            continue
        if kind == "sine_cosine":
            if node.args[0] in angles:
                continue
            angles.add(node.args[0])
        counts[kind] += 1
    return OperationCount(**counts)
