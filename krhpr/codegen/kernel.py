"""Typed straight-line functions: the unit that is derived, optimised, printed and proven."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from enum import StrEnum
from fractions import Fraction
from functools import cached_property
from math import prod

from krhpr.codegen.graph import KINKS, Graph, InputRef, Node, Op, OperationCount, count_operations


class Unit(StrEnum):
    """SI units; formulas are homogeneous in length, so any consistent unit of length works."""

    NONE = "1"
    METRE = "m"
    RADIAN = "rad"
    ACTUATOR = "rad or m"
    SQUARE_METRE = "m^2"
    CUBIC_METRE = "m^3"
    METRE_PER_SECOND = "m/s"
    ACTUATOR_RATE = "rad/s or m/s"
    TWIST = "m/s, rad/s"
    METRE_PER_SECOND_SQUARED = "m/s^2"
    ACTUATOR_ACCELERATION = "rad/s^2 or m/s^2"
    TWIST_RATE = "m/s^2, rad/s^2"
    NEWTON = "N"
    NEWTON_METRE = "N m"
    ACTUATOR_FORCE = "N m or N"
    WRENCH = "N, N m"
    MIXED = "mixed"


class Frame(StrEnum):
    """The frame in which a vector or matrix is expressed."""

    NONE = "-"
    BASE = "base"
    PLATFORM = "platform"
    JOINT = "joint"


class Layout(StrEnum):
    """How the legs' parts of an array make the whole."""

    SHARED = "shared"  # one for the robot
    STACKED = "stacked"  # leg by leg along a first axis
    ROWS = "rows"  # the legs' rows below one another: (2, 6) for a leg, (6, 6) in all
    DIAGONAL = "block diagonal"  # the legs' blocks on a diagonal, zeros elsewhere


LEGS = 3
"""Legs of a robot, unless its functions say otherwise."""

PLACES = 4
"""Places of an array of the geometry in C, `KRHPR_PLACES`: those behind the last leg repeat it."""


@dataclass(frozen=True)
class Port:
    """One input or output: its name, shape, unit, frame and meaning.

    `shape` is that of one leg where `layout` is not SHARED; `full_shape` is the robot's.
    """

    name: str
    shape: tuple[int, ...]
    unit: Unit
    frame: Frame
    doc: str
    layout: Layout = Layout.SHARED
    labels: tuple[str, ...] = ()
    legs: int = LEGS

    @property
    def size(self) -> int:
        """Number of elements of one leg's part (of the whole where it is shared)."""
        return prod(self.shape)

    @property
    def per_leg(self) -> bool:
        """Whether each leg has a part of its own."""
        return self.layout is not Layout.SHARED

    @property
    def full_shape(self) -> tuple[int, ...]:
        """Shape of the robot's array."""
        if self.layout is Layout.SHARED:
            return self.shape
        if self.layout is Layout.STACKED:
            return (self.legs, *self.shape)
        if self.layout is Layout.ROWS:
            return (self.legs * self.shape[0], *self.shape[1:])
        return (self.legs * self.shape[0], self.legs * self.shape[1])

    @property
    def full_size(self) -> int:
        """Number of elements of the robot's array."""
        return prod(self.full_shape)

    def one_step_on(self) -> Port:
        """What an iteration makes of it."""
        return replace(self, name=f"{self.name}_next", doc=f"{self.doc}, one step on")


@dataclass(frozen=True)
class GeometryField:
    """One length or angle that the owner of a robot sets, for one leg."""

    name: str
    unit: Unit
    doc: str
    positive: bool = False


@dataclass(frozen=True)
class GeometryType:
    """The geometry of one leg's part: the fields that a person sets and the vectors prepared from them.

    `prepare` is a kernel from the fields (scalars) to the prepared vectors and matrices, which every kernel
    may use.
    """

    name: str
    doc: str
    fields: tuple[GeometryField, ...]
    prepare: Kernel

    def __post_init__(self) -> None:
        scalars = [port.name for port in self.prepare.outputs if not port.shape]
        if scalars:
            raise ValueError(
                f"{self.name}: {', '.join(scalars)} of its prepared values has no dimension; prepare "
                "vectors and "
                "matrices, for what kernels compute of the geometry alone is prepared by itself"
            )

    def field(self, name: str) -> GeometryField:
        """A field by name."""
        return next(entry for entry in self.fields if entry.name == name)


GEOMETRY_PREFIX = "g."


@dataclass(frozen=True)
class Kernel:
    """A straight-line function with typed inputs and outputs.

    `results` gives, for each output port, its nodes in row-major order.  Inputs of the graph that start with
    `g.` are fields of `geometry` (`g.l_2`) or vectors prepared from it (`g.e_1`). `written` counts operations
    in the formulas as they were written, before anything is shared.
    """

    name: str
    doc: str
    equations: str
    inputs: tuple[Port, ...]
    outputs: tuple[Port, ...]
    graph: Graph
    results: Mapping[str, tuple[int, ...]]
    written: int
    geometry: GeometryType | None = None
    notes: tuple[str, ...] = field(default=())

    @property
    def result_nodes(self) -> tuple[int, ...]:
        """Nodes of all outputs, port by port."""
        return tuple(node for port in self.outputs for node in self.results[port.name])

    @cached_property
    def steps(self) -> tuple[tuple[int, Node], ...]:
        """The nodes that the outputs depend on, each behind its arguments."""
        needed = self.graph.needed(self.result_nodes)
        return tuple((index, node) for index, node in self.graph if needed[index])

    @cached_property
    def leaves(self) -> tuple[tuple[int, InputRef | Fraction], ...]:
        """The inputs and constants among the steps."""
        return tuple((index, node.value) for index, node in self.steps if node.value is not None)

    @cached_property
    def program(self) -> tuple[tuple[int, Op, int, int | None], ...]:
        """The operations among the steps, and the nodes of their one or two arguments."""
        steps = ((index, node.op, node.args) for index, node in self.steps if node.value is None)
        return tuple((index, op, args[0], args[1] if len(args) > 1 else None) for index, op, args in steps)

    @cached_property
    def operations(self) -> OperationCount:
        """Operations of one call."""
        return count_operations(self.graph, self.result_nodes)

    @cached_property
    def smooth_outputs(self) -> tuple[Port, ...]:
        """Outputs without a kink (absolute value, least, largest) on the way: all but those that serve
        guards.
        """
        kinked: list[bool] = []
        for _, node in self.graph:
            kinked.append(node.op in KINKS or any(kinked[argument] for argument in node.args))
        return tuple(p for p in self.outputs if not any(kinked[node] for node in self.results[p.name]))

    @cached_property
    def sources(self) -> Mapping[str, tuple[frozenset[InputRef], ...]]:
        """For each element of each output, the inputs' elements (and what is prepared of the geometry) on
        which it depends.
        """
        found: list[frozenset[InputRef]] = []
        for _, node in self.graph:
            if isinstance(node.value, InputRef):
                found.append(frozenset({node.value}))
            else:
                found.append(frozenset().union(*(found[argument] for argument in node.args)))
        return {port.name: tuple(found[node] for node in self.results[port.name]) for port in self.outputs}

    def input_port(self, name: str) -> Port:
        """An input by name."""
        return _find(self.inputs, name, self.name)

    def output_port(self, name: str) -> Port:
        """An output by name."""
        return _find(self.outputs, name, self.name)


def _find(ports: tuple[Port, ...], name: str, kernel: str) -> Port:
    for port in ports:
        if port.name == name:
            return port
    raise KeyError(f"kernel {kernel!r} has no port {name!r}; it has {', '.join(port.name for port in ports)}")
