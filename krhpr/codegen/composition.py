"""Functions of a robot: kernels called leg by leg and then for the whole platform.

A `RobotFunction` has three stages: SHARED kernels (once), LEG kernels (for each of the legs, in C a
loop, in NumPy an array axis, in lanes a register), PLATFORM kernels (once, with all legs' results).  It is
the same for every target; the printers only translate calls.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from enum import StrEnum

from krhpr.codegen.kernel import LEGS, Frame, Kernel, Port, Unit
from krhpr.codegen.part import Part
from krhpr.codegen.status import Status


class Stage(StrEnum):
    """When a kernel is called."""

    SHARED = "shared"
    LEG = "leg"
    PLATFORM = "platform"


class Relation(StrEnum):
    """How a guarded value is compared with its limit."""

    AT_LEAST = ">="
    AT_MOST = "<="


@dataclass(frozen=True)
class Repeat:
    """A kernel called again with its own result, until that moves no more: a bounded iteration.

    Its input port `before` begins as the variable `start` and becomes the output port `after`; the output
    port `change` is at most `tolerance` when it ends well, and it ends after `limit` calls in any case.
    """

    before: str
    after: str
    start: str
    change: str
    tolerance: float = 1e-20
    limit: int = 25


@dataclass(frozen=True)
class Only:
    """Which of the solutions at roots is the answer: the only one with its angles in a box.

    `box` is the variable with the least and the largest angle of each leg; an angle is found there with the
    full turns that bring it in. `certificate` is the variable whose elements are all at least zero where a
    theorem says that a box holds one solution; the function's output `certified` is then 1, and solutions
    in doubt are known to lie elsewhere.
    """

    angles: str = "redundant"
    box: str = "box"
    certificate: str = "certificate"
    certified: str = "certified"
    inside: str = "inside"
    """The variable that counts the solutions in the box, and 1 more where some are in doubt."""
    ambiguous: str = "ambiguous"
    """The variable that is not zero where they cannot be told apart."""


@dataclass(frozen=True)
class EachRoot:
    """A kernel, of a leg or of the whole platform, called at every real root of a polynomial: a procedure.

    `polynomial` is the variable with its coefficients, the constant one first; the kernel's input port
    `root` is a root as a point, and its output port `miss` at most `tolerance` where the root is a solution
    (it is in doubt otherwise). What the other output ports give is collected along the first axis of the
    function's outputs, sorted by the one called `order`, NaN behind the last.
    """

    polynomial: str
    degree: int
    error: float
    """How uncertain the coefficients are, relative to the sum of their sizes."""
    tolerance: float
    order: str
    root: str = "root"
    miss: str = "miss"
    count: str = "count"
    doubtful: str = "doubtful"
    found: str = "found"
    """The variable that is zero where there is no solution, and none in doubt."""
    only: Only | None = None
    """Whether one solution is the answer; then nothing is collected."""

    @property
    def numbers(self) -> tuple[str, ...]:
        """Outputs of the function that count solutions."""
        return (self.count, self.doubtful) if self.only is None else (self.count, self.only.certified)

    @property
    def locals(self) -> tuple[tuple[str, str], ...]:
        """Variables for guards, with their meanings."""
        if self.only is None:
            return ((self.found, "solutions, and 1 more where some are in doubt"),)
        return (
            (self.only.inside, "solutions in the box, and 1 more where some are in doubt"),
            (self.only.ambiguous, "1 where solutions cannot be told apart"),
        )

    @property
    def reads(self) -> tuple[str, ...]:
        """Variables that it reads beside those of its kernel."""
        return (
            (self.polynomial,)
            if self.only is None
            else (
                self.polynomial,
                self.only.box,
                self.only.certificate,
            )
        )


@dataclass(frozen=True)
class EachPair:
    """A kernel of the platform called for every pair of links: a loop over a table.

    The elements of the variables `places`, one after the other and three by three, are points; `ends` has for
    each pair the numbers of those that the kernel's input ports take, in their order.  What its only output
    port (a number) gives is collected pair by pair.
    """

    places: tuple[str, ...]
    ends: tuple[tuple[int, ...], ...]


@dataclass(frozen=True)
class Call:
    """One kernel of a part, with the robot's variables bound to its ports.

    `inputs` names the variable for each input port that is not called like its variable; `outputs` likewise.
    With `repeat` it is an iteration, with `each` it is called at every root of a
    polynomial, with `pairs` for every pair of links.
    """

    stage: Stage
    part: str
    kernel: str
    inputs: Mapping[str, str]
    outputs: Mapping[str, str]
    repeat: Repeat | None = None
    each: EachRoot | None = None
    pairs: EachPair | None = None

    def __post_init__(self) -> None:
        if self.pairs is not None and self.stage is not Stage.PLATFORM:
            raise ValueError(f"{self.part}.{self.kernel}: pairs of links are the platform's")
        if self.each is not None and self.stage is Stage.SHARED:
            raise ValueError(f"{self.part}.{self.kernel}: shared kernels are not called at roots")
        if self.repeat is not None and self.stage is Stage.SHARED:
            raise ValueError(f"{self.part}.{self.kernel}: shared kernels are not repeated")

    def variable_in(self, port: str) -> str:
        """The variable that an input port of the kernel reads (at first, where it is repeated)."""
        if self.repeat is not None and port == self.repeat.before:
            return self.repeat.start
        return self.inputs.get(port, port)

    def variable_out(self, port: str) -> str:
        """The variable that an output port of the kernel makes."""
        return self.outputs.get(port, port)

    def reads(self, kernel: Kernel) -> tuple[str, ...]:
        """The variables that its kernel reads."""
        if self.pairs is not None:
            return self.pairs.places
        return tuple(self.variable_in(port.name) for port in kernel.inputs)


OPTIONAL_INPUTS = ("mode", "assembly", "swivel", "box")
"""Inputs that have a default: the working mode, the assembly mode, a swivel of zero, and the box of redundant
coordinates.
"""


SINGULAR_TOLERANCE = 1e-12
"""A dimensionless factor of a determinant below this is singular."""


@dataclass(frozen=True)
class Guard:
    """A value that must keep a limit; where it does not (or is NaN) the answer is NaN and the status says
    why.

    For a leg's value only that leg's part of the answer is NaN, and where `status` names the first leg the
    status is that of the leg.
    `spoils` names the outputs that have no meaning then (all unless given), `empties` those that are 0 then.
    """

    variable: str
    index: int
    relation: Relation
    limit: float
    status: Status
    spoils: tuple[str, ...] = ()
    empties: tuple[str, ...] = ()

    def spoilt(self, outputs: Iterable[Port]) -> tuple[Port, ...]:
        """The outputs that are NaN where the guard fails; the guarded value itself stays."""
        return tuple(
            port
            for port in outputs
            if port.name not in (self.variable, *self.empties)
            and (not self.spoils or port.name in self.spoils)
        )


@dataclass(frozen=True)
class Step:
    """One of a robot's functions, called by another that is a sequence of them.

    `inputs` names the variable for each input that is not called like it; outputs keep their names.
    """

    function: str
    inputs: Mapping[str, str] = field(default_factory=dict)

    def variable_in(self, port: str) -> str:
        """The variable that an input reads."""
        return self.inputs.get(port, port)


@dataclass(frozen=True)
class RobotFunction:
    """One function of a robot, the same for all targets: calls of kernels, or a sequence of functions."""

    name: str
    doc: str
    equations: str
    inputs: tuple[Port, ...]
    outputs: tuple[Port, ...]
    calls: tuple[Call, ...]
    guards: tuple[Guard, ...] = ()
    steps: tuple[Step, ...] = ()
    """Functions of the robot that it calls in this order; the first status that is not OK is its own."""
    legs: int = LEGS
    """How many legs it is a function of."""

    @property
    def chooses(self) -> bool:
        """Whether it is the procedure that chooses among inverse solutions, which templates hold."""
        return not self.calls and not self.steps

    @property
    def procedure(self) -> bool:
        """Whether it loops (but over a table) or chooses: it is then no straight line of kernels, and has no
        CasADi form."""
        return not self.calls or any(call.repeat is not None or call.each is not None for call in self.calls)

    @property
    def each(self) -> EachRoot | None:
        """The polynomial at whose roots its last kernel is called, if it has one."""
        return self.calls[-1].each if self.calls else None

    def stage(self, stage: Stage) -> tuple[Call, ...]:
        """The calls of one stage, in order."""
        return tuple(call for call in self.calls if call.stage is stage)

    def read(self, parts: Mapping[str, Part], *, guards: bool) -> set[str]:
        """Variables that something reads: a later kernel, the caller, or a guard."""
        found = {port.name for port in self.outputs}
        for call in self.calls:
            found |= set(call.reads(parts[call.part].kernel(call.kernel)))
            if call.each is not None:
                found |= set(call.each.reads)
        return found | ({guard.variable for guard in self.guards} if guards else set())

    def uses_geometry(self, parts: Mapping[str, Part]) -> bool:
        """Whether any of its kernels reads the geometry; sequences hand it on."""
        return bool(self.steps) or any(
            parts[call.part].kernel(call.kernel).geometry is not None for call in self.calls
        )

    @property
    def signature(self) -> str:
        """The generalized-ufunc signature; the last output is the status."""
        inputs, outputs = (",".join(map(_core, ports)) for ports in (self.inputs, self.outputs))
        return f"{inputs}->{outputs},()"


def _core(port: Port) -> str:
    return "(" + ",".join(str(length) for length in port.full_shape) + ")"


@dataclass(frozen=True)
class Variable:
    """A value inside a robot function and where it lives."""

    name: str
    port: Port
    per_leg: bool
    kind: str  # input, output, local


def variables(function: RobotFunction, parts: Mapping[str, Part]) -> dict[str, Variable]:
    """Every variable of a function, with the stage in which it is made deciding whether each leg has its
    own.
    """
    found: dict[str, Variable] = {}
    for port in function.inputs:
        found[port.name] = Variable(port.name, port, port.per_leg, "input")
    outputs = {port.name: port for port in function.outputs}
    for call in function.calls:
        kernel = parts[call.part].kernel(call.kernel)
        for wanted in call.reads(kernel):
            if call.each is not None and wanted == call.each.root:
                continue
            if wanted not in found:
                raise ValueError(
                    f"{function.name}: {call.part}.{call.kernel} reads {wanted!r} before it is made"
                )
        for port in kernel.outputs:
            if call.each is not None and port.name == call.each.miss:
                continue  # of one root, and looked at there
            name = call.variable_out(port.name)
            kind = "output" if name in outputs else "local"
            found[name] = Variable(name, outputs.get(name, port), call.stage is Stage.LEG, kind)
        if call.each is not None:
            for name in call.each.numbers:
                found[name] = Variable(name, outputs[name], call.stage is Stage.LEG, "output")
            for name, doc in call.each.locals:
                port = Port(name, (1,), Unit.NONE, Frame.NONE, doc)
                found[name] = Variable(name, port, call.stage is Stage.LEG, "local")
    for name in outputs:
        if name not in found:
            raise ValueError(f"{function.name}: nothing computes the output {name!r}")
    return found
