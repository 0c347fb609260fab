"""Twins of kernels that carry tangents: with the values go their derivatives along several directions.

`tangent_twin` differentiates a kernel on its graph (forward mode).  The twin first computes, once, what
does not depend on the directions; the rest is straight-line and linear in them, so that a target prints it
as a loop over the directions, which compilers turn into vector code.  `tangent_function` finds what a robot's
function needs: its calls without those that only guard, and the structure (sparsity) of its Jacobian.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from krhpr.codegen.composition import Call, RobotFunction, Stage
from krhpr.codegen.differentiate import tangents
from krhpr.codegen.graph import LEAVES, Graph, InputRef, Name, Op
from krhpr.codegen.kernel import Kernel, Port
from krhpr.codegen.part import Part
from krhpr.codegen.passes import pair_sine_cosine, remove_dead_code

SUFFIX = "_tangent"
BRANCHES = ("mode", "assembly")
"""Inputs that choose a branch by signs: nothing is differentiated with respect to them."""


def is_tangent(ref: InputRef) -> bool:
    """Whether an input of a twin's graph is a derivative."""
    return ref.port.endswith(SUFFIX)


def tangent_twin(kernel: Kernel) -> Kernel | None:
    """A kernel with a tangent for every input (but branches) and every output that has a derivative.

    Nodes that do not depend on tangents come first, and those that the others read have names.  A kernel that
    only serves guards has no twin.
    """
    outputs = kernel.smooth_outputs
    if not outputs:
        return None
    carried = [port for port in kernel.inputs if port.name not in BRANCHES]
    graph = Graph()
    place = kernel.graph.copy_into(graph, {})
    seeds = {
        InputRef(port.name, index): graph.input(port.name + SUFFIX, index)
        for port in carried
        for index in range(port.size)
    }
    wanted = [node for port in outputs for node in kernel.results[port.name]]
    dots = tangents(kernel.graph, graph, place, seeds, wanted)
    zero = graph.constant(0)
    results: dict[str, tuple[int, ...]] = {}
    for port in outputs:
        nodes = kernel.results[port.name]
        results[port.name] = tuple(place[node] for node in nodes)
        rates = (dots[node] for node in nodes)
        results[port.name + SUFFIX] = tuple(zero if rate is None else rate for rate in rates)
    twin = replace(
        kernel,
        name=kernel.name + SUFFIX,
        doc=f"`{kernel.name}` with the derivatives of its outputs along directions of its inputs.",
        inputs=(*kernel.inputs, *map(_tangent_port, carried)),
        outputs=(*outputs, *map(_tangent_port, outputs)),
        graph=graph,
        results=results,
    )
    return _values_first(pair_sine_cosine(remove_dead_code(_multiply_by_reciprocals(twin))))


def _tangent_port(port: Port) -> Port:
    return replace(port, name=port.name + SUFFIX, doc=f"derivative of {port.name}", labels=())


def _varying(graph: Graph) -> list[bool]:
    """For every node, whether it depends on a tangent."""
    found: list[bool] = []
    for _, node in graph:
        found.append(
            is_tangent(node.value) if isinstance(node.value, InputRef) else any(found[a] for a in node.args)
        )
    return found


def _multiply_by_reciprocals(kernel: Kernel) -> Kernel:
    """Divide once for all directions: a tangent over a value is the tangent times the value's reciprocal."""
    varying = _varying(kernel.graph)
    target = Graph()
    place: list[int] = []
    for index, node in kernel.graph:
        if node.op is Op.DIV and varying[index] and not varying[node.args[1]]:
            reciprocal = target.div(target.constant(1), place[node.args[1]])
            place.append(target.mul(place[node.args[0]], reciprocal))
        else:
            place.append(target.replay(node, place))
        _keep_name(kernel.graph, index, target, place[index])
    return _moved(kernel, target, place)


def _values_first(kernel: Kernel) -> Kernel:
    """Values before tangents, and a name for every value that a tangent reads."""
    varying = _varying(kernel.graph)
    order = sorted(range(len(kernel.graph)), key=lambda index: varying[index])
    target = Graph()
    place = [-1] * len(kernel.graph)
    for index in order:
        place[index] = target.replay(kernel.graph.nodes[index], place)
        _keep_name(kernel.graph, index, target, place[index])
    number = 0
    late = _varying(target)
    for index, node in list(target):
        for argument in node.args if late[index] else ():
            unnamed = argument not in target.names and target.nodes[argument].op not in LEAVES
            if unnamed and not late[argument]:
                number += 1
                target.name(argument, Name(f"h{number}"))
    return _moved(kernel, target, place)


def _keep_name(source: Graph, index: int, target: Graph, here: int) -> None:
    if index in source.names:
        target.name(here, source.names[index])


def _moved(kernel: Kernel, graph: Graph, place: Sequence[int]) -> Kernel:
    results = {name: tuple(place[node] for node in nodes) for name, nodes in kernel.results.items()}
    return replace(kernel, graph=graph, results=results)


# -- functions ----------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class TangentFunction:
    """What the Jacobian of a robot's function takes."""

    calls: tuple[Call, ...]
    carried: frozenset[str]
    """Variables that have a tangent."""
    structure: Mapping[tuple[str, str], frozenset[tuple[int, int]]]
    """(output, input) -> (element, element) where the derivative may be other than zero; arrays of legs one
    after the other.
    """


def tangent_function(function: RobotFunction, parts: Mapping[str, Part]) -> TangentFunction | None:
    """The differentiated function; None where an output has no derivative everywhere, or all are
    constants.
    """
    calls = _needed_calls(function, parts)
    carried = {port.name for port in function.inputs if port.name not in BRANCHES}
    made = set(carried)
    for call in calls:
        kernel = parts[call.part].kernel(call.kernel)
        reads = {call.variable_in(port.name) for port in kernel.inputs if port.name not in BRANCHES}
        if not reads <= made:
            return None
        made |= {call.variable_out(port.name) for port in kernel.smooth_outputs}
    if any(port.name not in made for port in function.outputs):
        return None
    structure = _structure(function, calls, parts)
    if not any(structure.values()):
        return None  # constants
    return TangentFunction(calls, frozenset(made), structure)


def _needed_calls(function: RobotFunction, parts: Mapping[str, Part]) -> tuple[Call, ...]:
    """Calls on which an output depends, in order."""
    wanted = {port.name for port in function.outputs}
    found: list[Call] = []
    for call in reversed(function.calls):
        kernel = parts[call.part].kernel(call.kernel)
        if wanted & {call.variable_out(port.name) for port in kernel.outputs}:
            wanted |= {call.variable_in(port.name) for port in kernel.inputs}
            found.append(call)
    return tuple(reversed(found))


Sources = list[frozenset[tuple[str, int]]]
"""For each element of a variable, the elements of the function's inputs on which it depends."""


def _structure(
    function: RobotFunction, calls: Sequence[Call], parts: Mapping[str, Part]
) -> dict[tuple[str, str], frozenset[tuple[int, int]]]:
    known: dict[str, Sources] = {
        port.name: [frozenset({(port.name, index)}) for index in range(port.full_size)]
        for port in function.inputs
    }
    per_leg = {port.name: port.per_leg for port in function.inputs}
    for call in calls:
        kernel = parts[call.part].kernel(call.kernel)
        legs = range(function.legs) if call.stage is Stage.LEG else (None,)
        outputs: dict[str, Sources] = {port.name: [] for port in kernel.outputs}
        for leg in legs:
            arguments: dict[str, Sources] = {}
            for port in kernel.inputs:
                name = call.variable_in(port.name)
                size = port.size
                whole = known[name]
                part = whole[leg * size : (leg + 1) * size] if leg is not None and per_leg[name] else whole
                arguments[port.name] = part
            for name, sources in _kernel_sources(kernel, arguments).items():
                outputs[name] += sources
        for port in kernel.outputs:
            known[call.variable_out(port.name)] = outputs[port.name]
            per_leg[call.variable_out(port.name)] = call.stage is Stage.LEG
    return {
        (output.name, given.name): frozenset(
            (row, index)
            for row, sources in enumerate(known[output.name])
            for name, index in sources
            if name == given.name
        )
        for output in function.outputs
        for given in function.inputs
    }


def _kernel_sources(kernel: Kernel, arguments: Mapping[str, Sources]) -> dict[str, Sources]:
    """Those of a kernel's outputs, given those of its inputs; the geometry is none."""

    def whole(refs: frozenset[InputRef]) -> frozenset[tuple[str, int]]:
        own = (arguments[ref.port][ref.index] for ref in refs if ref.port in arguments)
        return frozenset().union(*own)

    return {name: [whole(refs) for refs in entries] for name, entries in kernel.sources.items()}
