"""From SymPy formulas to a graph: a derivation is written as a list of named expressions.

    k = KernelWriter("jacobian", doc="...", equations="(2.15)", geometry=GEOMETRY)
    s = k.input("s", (3,), Unit.METRE, Frame.BASE, "centre of S_i")
    theta = k.input("theta", (3,), ...)
    x = k.let("x", cos(theta[0]) * k.g.e_x - sin(theta[0]) * k.g.e_t)
    k.output("M", ...)
    kernel = k.kernel()

`let` gives a SymPy expression a name and hands back fresh symbols for it, so that SymPy never sees an
expression grow and the generated code keeps the thesis' names.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping
from fractions import Fraction
from types import SimpleNamespace
from typing import Any

import sympy as sp

from krhpr.codegen.differentiate import tangents
from krhpr.codegen.graph import Graph, GraphError, InputRef, Name
from krhpr.codegen.kernel import (
    GEOMETRY_PREFIX,
    Frame,
    GeometryType,
    Kernel,
    Layout,
    Port,
    Unit,
)

RESERVED = frozenset(
    {"I", "if", "lambda", "near", "far", "complex", "in", "is", "not", "int", "double", "for", "g"}
)


class KernelWriter:
    """Collects the formulas of one kernel; `kernel()` ends it."""

    def __init__(
        self, name: str, doc: str, equations: str = "", geometry: GeometryType | None = None
    ) -> None:
        self._name, self._doc, self._equations = name, doc, equations
        self._geometry = geometry
        self._graph = Graph()
        self._inputs: list[Port] = []
        self._outputs: list[Port] = []
        self._results: dict[str, tuple[int, ...]] = {}
        self._place: dict[sp.Expr, int] = {}
        self._symbols: dict[int, sp.Symbol] = {}
        self._written = 0
        self.g = self._geometry_symbols(geometry)

    # -- ports ----------------------------------------------------------------------------------------------

    def input(
        self,
        name: str,
        shape: tuple[int, ...],
        unit: Unit = Unit.NONE,
        frame: Frame = Frame.NONE,
        doc: str = "",
        layout: Layout = Layout.SHARED,
        labels: tuple[str, ...] = (),
    ) -> Any:
        """Declare an input; returns a Symbol for shape (), else a Matrix (a vector is a column)."""
        return self.add_input(Port(name, shape, unit, frame, doc, layout, labels))

    def add_input(self, port: Port) -> Any:
        """Declare an input with a port that exists."""
        if port.name in RESERVED:
            raise GraphError(f"{port.name!r} is a reserved word in a target language; choose another name")
        self._inputs.append(port)
        return self._leaves(port.name, port.shape)

    def output(
        self,
        name: str,
        value: Any,
        unit: Unit = Unit.NONE,
        frame: Frame = Frame.NONE,
        doc: str = "",
        layout: Layout = Layout.SHARED,
        labels: tuple[str, ...] = (),
    ) -> None:
        """Declare an output with its value (expression, vector or matrix)."""
        shape: tuple[int, ...] = ()
        if isinstance(value, sp.MatrixBase):
            shape = (value.rows,) if value.cols == 1 else (value.rows, value.cols)
        self.add_output(Port(name, shape, unit, frame, doc, layout, labels), value)

    def add_output(self, port: Port, value: Any) -> None:
        """Declare an output with a port that exists; `value` may have any shape with the port's number of
        elements.
        """
        flat = _flat(value)
        if len(flat) != port.size:
            raise GraphError(
                f"output {port.name!r} of {self._name!r} has {len(flat)} elements, not {port.shape}"
            )
        nodes = tuple(self._convert(entry) for entry in flat)
        for component, node in zip(_components(port.shape), nodes, strict=True):
            self._graph.name(node, Name(port.name, component, ""))
        self._outputs.append(port)
        self._results[port.name] = nodes

    # -- formulas -------------------------------------------------------------------------------------------

    def let(self, name: str, value: Any, note: str = "") -> Any:
        """Give an expression a name; returns symbols that stand for it."""
        if isinstance(value, sp.MatrixBase):
            shape = (value.rows,) if value.cols == 1 else (value.rows, value.cols)
            parts = [
                self._let_scalar(Name(name, component, note), entry)
                for component, entry in zip(_components(shape), _flat(value), strict=True)
            ]
            return sp.Matrix(value.rows, value.cols, parts)
        return self._let_scalar(Name(name, "", note), sp.sympify(value))

    def signed_root(self, name: str, sign: Any, square: Any, note: str = "") -> Any:
        """A square root with a sign (+1 or -1), named.  Where its square is asked for it is `square`, which
        need not wait for the root.
        """
        square = self.let(f"{name}2", square)
        found = self._let_scalar(Name(name, "", note), sp.sympify(sign * sp.sqrt(square)))
        self._place[found**2] = self._node(square)
        return found

    def inverse_root(self, name: str, square: Any, note: str = "") -> Any:
        """1 / sqrt(square), named, as the root times the reciprocal: neither need wait for the other."""
        square = self.let(f"{name}_of", square)
        return self.let(name, sp.sqrt(square) * self.let(f"{name}2", 1 / square), note)

    def atan2(self, y: Any, x: Any) -> sp.Symbol:
        """The angle of (x, y) in (-pi, pi], kept as one operation (SymPy would rewrite special cases)."""
        return self._symbol(self._graph.atan2(self._convert(y), self._convert(x)))

    def minimum(self, *values: Any) -> sp.Symbol:
        """The smallest of several values."""
        return self._fold(values, self._graph.minimum)

    def maximum(self, *values: Any) -> sp.Symbol:
        """The largest of several values."""
        return self._fold(values, self._graph.maximum)

    def absolute(self, value: Any) -> sp.Symbol:
        """The absolute value, kept as one operation."""
        return self._symbol(self._graph.absolute(self._convert(value)))

    def sign(self, value: Any) -> sp.Expr:
        """-1 or +1; +1 for zero, to which is added what is nothing beside all other numbers."""
        shifted = self._symbol(self._convert(value + sp.Rational(1, 10**300)))
        return shifted / self.absolute(shifted)

    def call(self, kernel: Kernel, /, **arguments: Any) -> SimpleNamespace:
        """Write another kernel's formulas here, with its inputs given; returns its outputs by name."""
        bound = self._bind(kernel, arguments)
        place = kernel.graph.copy_into(self._graph, bound)
        self._written += kernel.written
        return self._collect(kernel, [place[node] for node in range(len(kernel.graph))])

    def call_tangent(
        self, kernel: Kernel, output: str, arguments: Mapping[str, Any], directions: Mapping[str, Any]
    ) -> tuple[Any, Any]:
        """One output of a kernel and its derivative along `directions` (inputs without a direction stay
        fixed).

        Differentiation happens on the graph (forward mode), so nothing is expanded.
        """
        bound = self._bind(kernel, arguments)
        place = kernel.graph.copy_into(self._graph, bound)
        before = len(self._graph)
        seeds: dict[InputRef, int] = {}
        for name, direction in directions.items():
            for index, entry in enumerate(_flat(direction)):
                seeds[InputRef(name, index)] = self._convert(entry)
        dots = tangents(kernel.graph, self._graph, place, seeds, kernel.results[output])
        zero = self._graph.constant(0)
        self._written += kernel.written + (len(self._graph) - before)
        rates = [zero if dot is None else dot for dot in dots]
        return getattr(self._collect(kernel, place), output), getattr(self._collect(kernel, rates), output)

    def kernel(self, prune: Collection[str] = ()) -> Kernel:
        """The finished kernel; inputs named in `prune` are dropped where no output depends on them."""
        needed = self._graph.needed(node for nodes in self._results.values() for node in nodes)
        read = {node.value.port for i, node in self._graph if needed[i] and isinstance(node.value, InputRef)}
        return Kernel(
            self._name,
            self._doc,
            self._equations,
            tuple(port for port in self._inputs if port.name in read or port.name not in prune),
            tuple(self._outputs),
            self._graph,
            dict(self._results),
            self._written,
            self._geometry,
        )

    # -- conversion -----------------------------------------------------------------------------------------

    def _geometry_symbols(self, geometry: GeometryType | None) -> SimpleNamespace:
        symbols: dict[str, Any] = {}
        if geometry is not None:
            for entry in geometry.fields:
                symbols[entry.name] = self._leaves(GEOMETRY_PREFIX + entry.name, ())
            for port in geometry.prepare.outputs:
                symbols[port.name] = self._leaves(GEOMETRY_PREFIX + port.name, port.shape)
        return SimpleNamespace(**symbols)

    def _leaves(self, name: str, shape: tuple[int, ...]) -> Any:
        if len(shape) > 2:
            size = 1
            for length in shape:
                size *= length
            return [self._symbol(self._graph.input(name, index), f"{name}_{index}") for index in range(size)]
        parts = [
            self._symbol(self._graph.input(name, index), f"{name}{component}")
            for index, component in enumerate(_components(shape))
        ]
        if not shape:
            return parts[0]
        return sp.Matrix(shape[0], shape[1] if len(shape) == 2 else 1, parts)

    def _symbol(self, node: int, text: str = "") -> Any:
        """A SymPy object that stands for a node: a number where the node is constant, else a symbol."""
        value = self._graph.value(node)
        if value is not None:
            return sp.Rational(value.numerator, value.denominator)
        if node not in self._symbols:
            symbol = sp.Symbol(text or f"n{node}", real=True)
            if symbol in self._place:
                symbol = sp.Symbol(f"{text or 'n'}#{node}", real=True)
            self._symbols[node] = symbol
            self._place[symbol] = node
        return self._symbols[node]

    def _let_scalar(self, name: Name, value: sp.Expr) -> Any:
        node = self._convert(value)
        self._graph.name(node, name)
        # the symbol carries the derivation's order, so that SymPy's sorting of terms is the same in every run
        return self._symbol(node, f"{name.text}{name.component}")

    def _fold(self, values: Iterable[Any], operation: Any) -> sp.Symbol:
        nodes = [self._convert(value) for value in values]
        result = nodes[0]
        for node in nodes[1:]:
            result = operation(result, node)
        return self._symbol(result)

    def _bind(self, kernel: Kernel, arguments: Mapping[str, Any]) -> dict[InputRef, int]:
        expected = {port.name for port in kernel.inputs}
        if set(arguments) != expected:
            raise GraphError(f"{kernel.name!r} takes {sorted(expected)}, got {sorted(arguments)}")
        bound: dict[InputRef, int] = {}
        for port in kernel.inputs:
            flat = _flat(arguments[port.name])
            if len(flat) != port.size:
                raise GraphError(
                    f"{port.name!r} of {kernel.name!r} has {len(flat)} elements, not {port.shape}"
                )
            for index, entry in enumerate(flat):
                bound[InputRef(port.name, index)] = self._convert(entry)
        return bound

    def _collect(self, kernel: Kernel, place: list[int]) -> SimpleNamespace:
        values: dict[str, Any] = {}
        for port in kernel.outputs:
            parts = [self._symbol(place[node]) for node in kernel.results[port.name]]
            if not port.shape:
                values[port.name] = parts[0]
            elif len(port.shape) <= 2:
                values[port.name] = sp.Matrix(
                    port.shape[0], port.shape[1] if len(port.shape) == 2 else 1, parts
                )
            else:
                values[port.name] = parts
        return SimpleNamespace(**values)

    def _convert(self, expression: Any) -> int:
        expression = sp.sympify(expression)
        if expression in self._place:
            return self._place[expression]
        self._written += _written_operations(expression)
        return self._node(expression)

    def _node(self, expression: sp.Expr) -> int:
        known = self._place.get(expression)
        if known is None:
            known = self._place[expression] = self._build(expression)
        return known

    def _build(self, e: sp.Expr) -> int:
        graph = self._graph
        if e.is_Rational:
            return graph.constant(Fraction(int(e.p), int(e.q)))
        if e.is_Add:
            common, rest = e.primitive()
            shared = all(abs(term.as_coeff_Mul()[0]) == common for term in e.args)
            if common != 1 and shared and len(e.args) > 2:
                # SymPy multiplies sums out; of two terms each half is often wanted elsewhere
                return graph.mul(self._node(rest), self._node(common))
            positive = [term for term in e.args if not term.could_extract_minus_sign()]
            negative = [-term for term in e.args if term.could_extract_minus_sign()]
            if not positive:
                return graph.neg(self._sum(negative))
            result = self._sum(positive)
            for term in negative:
                result = graph.sub(result, self._node(term))
            return result
        if e.is_Mul:
            return self._product(e)
        if e.is_Pow:
            base, exponent = e.args
            if exponent.is_Integer:
                return graph.power(self._node(base), int(exponent))
            if exponent == sp.Rational(1, 2):
                return graph.sqrt(self._node(base))
            if exponent == sp.Rational(-1, 2):
                return graph.div(graph.constant(1), graph.sqrt(self._node(base)))
        if isinstance(e, sp.sin):
            return graph.sin(self._node(e.args[0]))
        if isinstance(e, sp.cos):
            return graph.cos(self._node(e.args[0]))
        if isinstance(e, sp.Abs):
            return graph.absolute(self._node(e.args[0]))
        if e.is_Symbol:
            raise GraphError(f"{e} in {self._name!r} is neither an input nor the name of an expression")
        raise GraphError(f"{self._name!r}: no operation of the graph stands for {e.func.__name__} in {e}")

    def _sum(self, terms: list[sp.Expr]) -> int:
        result = self._node(terms[0])
        for term in terms[1:]:
            result = self._graph.add(result, self._node(term))
        return result

    def _product(self, e: sp.Expr) -> int:
        graph = self._graph
        coefficient, factors = e.as_coeff_mul()
        above = [f for f in factors if not (f.is_Pow and f.exp.is_number and f.exp.is_negative)]
        below = [1 / f for f in factors if f not in above]
        result = graph.constant(Fraction(int(coefficient.p), int(coefficient.q)))
        for factor in above:
            result = graph.mul(result, self._node(factor))
        if below:
            denominator = self._node(below[0])
            for factor in below[1:]:
                denominator = graph.mul(denominator, self._node(factor))
            result = graph.div(result, denominator)
        return result


def _flat(value: Any) -> list[Any]:
    """The elements of a scalar, a Matrix (row-major) or a nested list."""
    if isinstance(value, sp.MatrixBase):
        return list(value)
    if isinstance(value, (list, tuple)):
        return [entry for part in value for entry in _flat(part)]
    return [value]


def _components(shape: tuple[int, ...]) -> list[str]:
    """Suffixes of the elements of an array, in row-major order: `_0`, `_1`, ... or `_00`, `_01`, ..."""
    names = [""]
    for length in shape:
        names = [f"{prefix}{index}" for prefix in names for index in range(length)]
    return [f"_{name}" if name else "" for name in names]


def _written_operations(e: sp.Expr) -> int:
    """Additions, multiplications, divisions, roots and function calls in an expression as written."""
    if e.is_Atom:
        return 0
    inner = sum(_written_operations(argument) for argument in e.args)
    if e.is_Add:
        return inner + len(e.args) - 1
    if e.is_Mul:
        signs = sum(1 for argument in e.args if argument == -1)
        return inner + len(e.args) - 1 - signs
    if e.is_Pow:
        return inner + (abs(int(e.exp)) - 1 if e.exp.is_Integer and abs(int(e.exp)) > 1 else 1)
    return inner + 1
