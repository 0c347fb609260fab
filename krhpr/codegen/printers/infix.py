"""From a graph to named lines of infix code, the form that all targets share.

A node gets a line of its own when it has a name, is used more than once, or when its expression would grow
too long; the rest is written in place.  Parentheses keep the order of operations of the graph exactly.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from fractions import Fraction

from krhpr.codegen.graph import LEAVES, InputRef, Node, Op
from krhpr.codegen.kernel import Kernel

LONGEST = 78
"""Expressions longer than this get a line of their own."""


@dataclass(frozen=True)
class Line:
    """`name = expression`, with a remark."""

    name: str
    expression: str
    note: str = ""


@dataclass(frozen=True)
class Pair:
    """The sine and the cosine of one angle, computed together."""

    sine: str
    cosine: str
    argument: str


@dataclass(frozen=True)
class Body:
    """A kernel as lines, and the expression of every element of every output."""

    lines: tuple[Line | Pair, ...]
    results: Mapping[str, tuple[str, ...]]
    inputs_used: frozenset[InputRef]


@dataclass(frozen=True)
class Dialect:
    """What differs between targets: names of functions, literals, how an input is read, words that must not
    be names.

    With `pairs`, a sine and a cosine of one angle become one statement.  `alone` writes a constant that is no
    operand: a result, or the argument of a function.
    """

    functions: Mapping[Op, str]
    constant: Callable[[Fraction], str]
    input: Callable[[InputRef], str]
    reserved: frozenset[str]
    pairs: bool = False
    alone: Callable[[str], str] = str


_INFIX = {Op.ADD: (" + ", 1), Op.SUB: (" - ", 1), Op.MUL: (" * ", 2), Op.DIV: (" / ", 2)}
_ATOM = 9
_SIGN = 0  # a sign needs parentheses wherever it is an operand


def print_body(kernel: Kernel, dialect: Dialect) -> Body:
    """The lines of a kernel in one dialect."""
    return _Printer(kernel, dialect).body()


class _Printer:
    def __init__(self, kernel: Kernel, dialect: Dialect) -> None:
        self.kernel, self.dialect = kernel, dialect
        self.graph = kernel.graph
        self.needed = self.graph.needed(kernel.result_nodes)
        self.uses: Counter[int] = Counter(kernel.result_nodes)
        for index, node in self.graph:
            if self.needed[index]:
                self.uses.update(node.args)
        self.outputs = {port.name for port in kernel.outputs}
        ports = {port.name for port in (*kernel.inputs, *kernel.outputs)}
        self.taken: set[str] = set(dialect.reserved) | ports
        for ref in self._inputs():
            self.taken.add(dialect.input(ref))
        self.text: dict[int, tuple[str, int]] = {}
        self.lines: list[Line | Pair] = []
        self.counter = 0
        self.partner = self._partners() if dialect.pairs else {}

    def body(self) -> Body:
        for index, node in self.graph:
            if not self.needed[index] or index in self.text:
                continue
            if index in self.partner:
                self._pair(index, self.partner[index])
                continue
            expression, level = self._expression(node)
            if self._stands_alone(index, node, expression):
                label = self._label(index)
                note = self.graph.names[index].note if index in self.graph.names else ""
                self.lines.append(Line(label, expression, note))
                self.text[index] = (label, _ATOM)
            else:
                self.text[index] = (expression, level)
        results = {
            port.name: tuple(self._alone(node) for node in self.kernel.results[port.name])
            for port in self.kernel.outputs
        }
        return Body(tuple(self.lines), results, frozenset(self._inputs()))

    def _stands_alone(self, index: int, node: Node, expression: str) -> bool:
        """Whether a node gets a line of its own."""
        if node.op in LEAVES:
            return False
        name = self.graph.names.get(index)
        if node.op is Op.NEG and self.uses[index] == 1 and name is None:
            return False
        named = name is not None and name.text not in self.outputs
        return named or self.uses[index] > 1 or len(expression) > LONGEST

    def _label(self, index: int) -> str:
        name = self.graph.names.get(index)
        if name is not None:
            return self._free(name.text + name.component)
        self.counter += 1
        return self._free(f"t{self.counter}")

    def _partners(self) -> dict[int, int]:
        """The cosine for each sine of the same angle, and the other way round."""
        found: dict[tuple[Op, int], int] = {}
        for index, node in self.graph:
            if self.needed[index] and node.op in (Op.SIN, Op.COS):
                found[node.op, node.args[0]] = index
        partners = {}
        for (op, argument), index in found.items():
            other = found.get((Op.COS if op is Op.SIN else Op.SIN, argument))
            if other is not None:
                partners[index] = other
        return partners

    def _pair(self, index: int, other: int) -> None:
        sine, cosine = (index, other) if self.graph.nodes[index].op is Op.SIN else (other, index)
        labels = self._label(sine), self._label(cosine)
        self.lines.append(Pair(*labels, self._alone(self.graph.nodes[sine].args[0])))
        for node, label in zip((sine, cosine), labels, strict=True):
            self.text[node] = (label, _ATOM)

    def _inputs(self) -> list[InputRef]:
        return [
            node.value
            for index, node in self.graph
            if self.needed[index] and isinstance(node.value, InputRef)
        ]

    def _expression(self, node: Node) -> tuple[str, int]:
        if isinstance(node.value, Fraction):
            text = self.dialect.constant(node.value)
            return text, _SIGN if text.startswith("-") else _ATOM
        if isinstance(node.value, InputRef):
            return self.dialect.input(node.value), _ATOM
        if node.op is Op.NEG:
            # multiplication binds tighter than the sign in value, so -a * b needs no parentheses
            return f"-{self._operand(node.args[0], 2)}", _SIGN
        if node.op in _INFIX:
            symbol, level = _INFIX[node.op]
            left = self._operand(node.args[0], level)
            right = self._operand(node.args[1], level + 1)
            return f"{left}{symbol}{right}", level
        arguments = ", ".join(self._alone(a) for a in node.args)
        return f"{self.dialect.functions[node.op]}({arguments})", _ATOM

    def _alone(self, index: int) -> str:
        text = self.text[index][0]
        return self.dialect.alone(text) if isinstance(self.graph.nodes[index].value, Fraction) else text

    def _operand(self, index: int, level: int) -> str:
        text, own = self.text[index]
        return text if own >= level else f"({text})"

    def _free(self, wanted: str) -> str:
        name, number = wanted, 1
        while name in self.taken:
            number += 1
            name = (
                f"{wanted}_{'abcdefghijklmnopqrstuvwxyz'[number - 2]}"
                if number < 28
                else f"{wanted}_{number}"
            )
        self.taken.add(name)
        return name
