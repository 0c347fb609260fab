"""Elementary functions at the two ends of a kernel, so that a target can compute them for all legs at once.

Most kernels begin with sines and cosines of their joints and end with arctangents; between the two they are
algebra.  `split` takes the ends off:

    angles:  inputs -> angle[m]                       (sums of joints)
    body:    inputs, sine[m], cosine[m] -> outputs, tail_y[t], tail_x[t]
    tail:    outputs = atan2(tail_y, tail_x)

A loop over `angle` of all legs then computes every sine and cosine side by side, which compilers turn into
vector code.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

from krhpr.codegen.graph import Graph, InputRef, Op
from krhpr.codegen.kernel import GEOMETRY_PREFIX, Frame, Kernel, Port, Unit
from krhpr.codegen.passes import remove_dead_code

_CHEAP = frozenset({Op.CONST, Op.INPUT, Op.ADD, Op.SUB, Op.NEG, Op.MUL})

_SLOW = {Op.DIV: 4, Op.SQRT: 5, Op.SIN: 15, Op.COS: 15, Op.ATAN2: 20}
"""Operations that take longer than an addition, and about how many times."""


@dataclass(frozen=True)
class Tail:
    """An output whose elements are all arctangents: element j is atan2 number slots[j]."""

    port: Port
    slots: tuple[int, ...]


@dataclass(frozen=True)
class Phases:
    """A kernel in three phases; `angles` is None and `tails` empty where a kernel has no such end."""

    angles: Kernel | None
    body: Kernel
    tails: tuple[Tail, ...]
    tail_size: int

    def covers(self, port: str) -> bool:
        """Whether every element of an input is part of an angle, which is then finite only if they are."""
        if self.angles is None:
            return False
        read = {node.value for _, node in self.angles.graph if isinstance(node.value, InputRef)}
        sizes = [candidate.size for candidate in self.angles.inputs if candidate.name == port]
        return bool(sizes) and all(InputRef(port, index) in read for index in range(sizes[0]))


def split(kernel: Kernel) -> Phases:
    """Take leading sines and cosines and trailing arctangents off a kernel."""
    arguments = _leading_angles(kernel)
    tails, pairs = _trailing_arctangents(kernel)
    graph = Graph()
    place: list[int] = []
    for index, node in kernel.graph:
        slot = arguments.get(node.args[0]) if node.op in (Op.SIN, Op.COS) else None
        if slot is None:
            place.append(graph.replay(node, place))
        else:
            place.append(graph.input("sine" if node.op is Op.SIN else "cosine", slot))
        if index in kernel.graph.names:
            graph.name(place[-1], kernel.graph.names[index])
    ended = {tail.port.name for tail in tails}
    results = {
        name: tuple(place[node] for node in nodes)
        for name, nodes in kernel.results.items()
        if name not in ended
    }
    outputs = [port for port in kernel.outputs if port.name not in ended]
    if pairs:
        for name, which in (("tail_y", 0), ("tail_x", 1)):
            outputs.append(Port(name, (len(pairs),), Unit.NONE, Frame.NONE, "operands of arctangents"))
            results[name] = tuple(place[pair[which]] for pair in pairs)
    inputs = list(kernel.inputs)
    if arguments:
        for name in ("sine", "cosine"):
            inputs.append(
                Port(name, (len(arguments),), Unit.NONE, Frame.NONE, f"{name}s of the kernel's angles")
            )
    body = replace(kernel, graph=graph, results=results, inputs=tuple(inputs), outputs=tuple(outputs))
    body = _drop_unread(remove_dead_code(body), {port.name for port in kernel.inputs}) if arguments else body
    return Phases(_angle_kernel(kernel, list(arguments)), remove_dead_code(body), tails, len(pairs))


def _leading_angles(kernel: Kernel) -> dict[int, int]:
    """Arguments of sines and cosines that are sums of inputs, numbered."""
    graph, needed = kernel.graph, kernel.graph.needed(kernel.result_nodes)
    simple: list[bool] = []
    for _, node in graph:
        of_geometry = isinstance(node.value, InputRef) and node.value.port.startswith(GEOMETRY_PREFIX)
        simple.append(node.op in _CHEAP and not of_geometry and all(simple[a] for a in node.args))
    found: dict[int, int] = {}
    for index, node in graph:
        if needed[index] and node.op in (Op.SIN, Op.COS) and simple[node.args[0]]:
            found.setdefault(node.args[0], len(found))
    return found


def _trailing_arctangents(kernel: Kernel) -> tuple[tuple[Tail, ...], list[tuple[int, int]]]:
    """Outputs made of arctangents that nothing else reads, and the operands of each arctangent.

    Those that have less to wait for come first: processors look ahead by a limited number of instructions.
    """
    graph, needed = kernel.graph, kernel.graph.needed(kernel.result_nodes)
    read = {a for index, node in graph if needed[index] for a in node.args}
    ends = [
        (port, nodes)
        for port in kernel.outputs
        for nodes in (kernel.results[port.name],)
        if all(graph.nodes[node].op is Op.ATAN2 and node not in read for node in nodes)
    ]
    waits = _waits(graph)
    found = sorted({node for _, nodes in ends for node in nodes}, key=lambda node: (waits[node], node))
    slots = {node: slot for slot, node in enumerate(found)}
    tails = tuple(Tail(port, tuple(slots[node] for node in nodes)) for port, nodes in ends)
    return tails, [(graph.nodes[node].args[0], graph.nodes[node].args[1]) for node in found]


def _waits(graph: Graph) -> list[int]:
    """How long each node waits for its operands, in units of an addition."""
    waits: list[int] = []
    for _, node in graph:
        own = 0 if node.op in (Op.CONST, Op.INPUT) else _SLOW.get(node.op, 1)
        waits.append(own + max((waits[operand] for operand in node.args), default=0))
    return waits


def _angle_kernel(kernel: Kernel, arguments: list[int]) -> Kernel | None:
    if not arguments:
        return None
    port = Port(
        "angle", (len(arguments),), Unit.RADIAN, Frame.JOINT, "angles whose sine and cosine the kernel reads"
    )
    angles = replace(
        kernel,
        name=f"{kernel.name}_angles",
        doc=f"Angles whose sines and cosines `{kernel.name}` reads.",
        equations="",
        outputs=(port,),
        results={"angle": tuple(arguments)},
        geometry=None,
    )
    return _drop_unread(remove_dead_code(angles), {port.name for port in kernel.inputs})


def _drop_unread(kernel: Kernel, candidates: set[str]) -> Kernel:
    """Without the inputs that the graph does not read any more."""
    read = {node.value.port for _, node in kernel.graph if isinstance(node.value, InputRef)}
    kept = tuple(port for port in kernel.inputs if port.name in read or port.name not in candidates)
    return replace(kernel, inputs=kept)
