"""Passes over kernels: each takes a kernel (or the kernels of one part) and returns an equal, cheaper one.

Common sub-expressions, integer powers as products and signs are dealt with when a graph is built
(`graph.py`).
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import replace
from fractions import Fraction

from krhpr.codegen.graph import LEAVES, Graph, InputRef, Name, Node, Op
from krhpr.codegen.kernel import GEOMETRY_PREFIX, Frame, GeometryType, Kernel, Port, Unit

DERIVED = "k"
"""The prepared array that holds parameter-only sub-expressions found by `precompute_parameters`."""


def hoist_reciprocals(kernel: Kernel) -> Kernel:
    """One division for each denominator: where several quotients share it, multiply by its reciprocal.

    A denominator of the geometry alone becomes a reciprocal too, so that it can be computed ahead.
    """
    needed = kernel.graph.needed(kernel.result_nodes)
    constant = _depends_on_geometry_alone(kernel)
    uses = Counter(node.args[1] for index, node in kernel.graph if node.op is Op.DIV and needed[index])

    def rule(target: Graph, index: int, node: Node, place: Sequence[int]) -> int | None:
        if node.op is not Op.DIV:
            return None
        above, below = node.args
        if uses[below] < 2 and (constant[above] or not constant[below]):
            return None
        reciprocal = target.div(target.constant(1), place[node.args[1]])
        return target.mul(place[node.args[0]], reciprocal)

    return _replay(kernel, rule)


def fold_prepared_constants(geometry: GeometryType, kernel: Kernel) -> Kernel:
    """Prepared components that are the same for every geometry (e_t has no z) become constants in the
    kernel.
    """
    known: dict[InputRef, Fraction] = {}
    for name, nodes in geometry.prepare.results.items():
        for index, result in enumerate(nodes):
            value = geometry.prepare.graph.value(result)
            if value is not None:
                known[InputRef(GEOMETRY_PREFIX + name, index)] = value

    def rule(target: Graph, index: int, node: Node, place: Sequence[int]) -> int | None:
        return (
            target.constant(known[node.value])
            if isinstance(node.value, InputRef) and node.value in known
            else None
        )

    return _replay(kernel, rule)


def precompute_parameters(
    geometry: GeometryType, kernels: Sequence[Kernel]
) -> tuple[GeometryType, list[Kernel]]:
    """Compute once, in `prepare`, what depends on the geometry alone; kernels read it from the array `k`."""
    prepare = geometry.prepare
    graph = Graph()
    place = prepare.graph.copy_into(graph, {})
    results = {name: tuple(place[node] for node in nodes) for name, nodes in prepare.results.items()}
    columns: dict[int, int] = {}  # node of the new prepare -> index in `k`
    bound = {
        InputRef(GEOMETRY_PREFIX + name, index): node
        for name, nodes in results.items()
        for index, node in enumerate(nodes)
    }
    for entry in geometry.fields:
        bound[InputRef(GEOMETRY_PREFIX + entry.name, 0)] = graph.input(entry.name, 0)
    rewritten = [_read_prepared(kernel, graph, bound, columns) for kernel in kernels]
    if not columns:
        return geometry, list(kernels)
    derived = Port(
        DERIVED,
        (len(columns),),
        Unit.MIXED,
        Frame.NONE,
        "sub-expressions of the geometry alone, computed once",
    )
    for node, column in columns.items():
        graph.name(node, Name(DERIVED, f"_{column}"))
    full = Kernel(
        prepare.name,
        prepare.doc,
        prepare.equations,
        prepare.inputs,
        (*prepare.outputs, derived),
        graph,
        {**results, DERIVED: tuple(columns)},
        prepare.written,
    )
    return replace(geometry, prepare=full), rewritten


def _read_prepared(
    kernel: Kernel, prepare: Graph, bound: dict[InputRef, int], columns: dict[int, int]
) -> Kernel:
    """A kernel whose geometry-only nodes are read from `k`; they are written into the graph of `prepare`."""
    constant = _depends_on_geometry_alone(kernel)
    wanted = _frontier(kernel, constant)
    there = _copy_some(kernel.graph, prepare, bound, constant)

    def rule(target: Graph, index: int, node: Node, place: Sequence[int]) -> int | None:
        if index not in wanted:
            return None
        return target.input(GEOMETRY_PREFIX + DERIVED, columns.setdefault(there[index], len(columns)))

    return _replay(kernel, rule)


def remove_dead_code(kernel: Kernel) -> Kernel:
    """Keep only what the outputs need, in the order in which it was written."""
    needed = kernel.graph.needed(kernel.result_nodes)
    return _replay(kernel, order=[index for index, _ in kernel.graph if needed[index]])


def pair_sine_cosine(kernel: Kernel) -> Kernel:
    """Put the sine and the cosine of one angle side by side, so that one call can compute both."""
    partner = {(node.op, node.args[0]): index for index, node in kernel.graph if node.op in _OTHER}
    order: dict[int, None] = {}
    for index, node in kernel.graph:
        order.setdefault(index)
        if node.op in _OTHER and (_OTHER[node.op], node.args[0]) in partner:
            order.setdefault(partner[_OTHER[node.op], node.args[0]])
    return _replay(kernel, order=list(order))


_OTHER = {Op.SIN: Op.COS, Op.COS: Op.SIN}

Rule = Callable[[Graph, int, Node, Sequence[int]], "int | None"]


def _replay(kernel: Kernel, rule: Rule | None = None, order: Sequence[int] | None = None) -> Kernel:
    """Write a kernel's graph anew: in another order, without some nodes, or with a rule that replaces
    nodes.
    """
    target = Graph()
    place = [-1] * len(kernel.graph)
    for index in range(len(kernel.graph)) if order is None else order:
        node = kernel.graph.nodes[index]
        here = rule(target, index, node, place) if rule else None
        if here is None:
            here = target.replay(node, place)
        if index in kernel.graph.names:
            target.name(here, kernel.graph.names[index])
        place[index] = here
    results = {name: tuple(place[node] for node in nodes) for name, nodes in kernel.results.items()}
    return replace(kernel, graph=target, results=results)


def _depends_on_geometry_alone(kernel: Kernel) -> list[bool]:
    alone: list[bool] = []
    for _, node in kernel.graph:
        if isinstance(node.value, InputRef):
            alone.append(node.value.port.startswith(GEOMETRY_PREFIX))
        elif isinstance(node.value, Fraction):
            alone.append(True)
        else:
            alone.append(all(alone[a] for a in node.args))
    return alone


def _frontier(kernel: Kernel, alone: Sequence[bool]) -> set[int]:
    """The geometry-only nodes that the rest of the kernel reads; leaves and mere sign changes are left where
    they are.
    """
    graph = kernel.graph
    needed = graph.needed(kernel.result_nodes)
    readers: set[int] = set(kernel.result_nodes)
    for index, node in graph:
        if needed[index] and not alone[index]:
            readers.update(node.args)
    frontier: set[int] = set()
    for index in readers:
        node = graph.nodes[index]
        while node.op is Op.NEG:
            index = node.args[0]
            node = graph.nodes[index]
        if alone[index] and node.op not in LEAVES:
            frontier.add(index)
    return frontier


def _copy_some(source: Graph, target: Graph, bound: dict[InputRef, int], wanted: Sequence[bool]) -> list[int]:
    place: list[int] = []
    for index, node in source:
        if not wanted[index]:
            place.append(-1)
        elif isinstance(node.value, InputRef):
            place.append(bound[node.value])
        else:
            place.append(target.replay(node, place))
    return place
