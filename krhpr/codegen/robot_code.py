"""A robot as the printers see it: its parts, its functions, and what they cost."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from krhpr.codegen.composition import Call, RobotFunction, Stage
from krhpr.codegen.graph import OperationCount
from krhpr.codegen.kernel import Kernel
from krhpr.codegen.part import Part
from krhpr.limits import Limits


@dataclass(frozen=True)
class RobotCode:
    """A robot as the printers see it: its parts and its functions."""

    identifier: str
    title: str
    notation: str
    doc: str
    subleg: Part
    platform: Part
    algebra: Part
    functions: tuple[RobotFunction, ...]
    default_geometry: Mapping[str, tuple[float, ...]]
    default_mode: tuple[float, ...]
    default_assembly: tuple[float, ...]
    mode_names: tuple[str, ...]
    mode_labels: tuple[str, ...]
    mode_signs: tuple[tuple[int, ...], ...]
    assembly_labels: tuple[str, ...]
    assembly_signs: tuple[tuple[int, ...], ...]
    angular: tuple[bool, ...]
    links: tuple[tuple[str, str, str, str], ...]
    redundant_link: str
    documentation: Mapping[str, tuple[tuple[str, str], ...]]
    home_p: tuple[float, ...]
    """Where the platform stands at home, parallel to the base."""
    home_redundant: tuple[float, ...]
    default_box: tuple[tuple[float, float], ...] = ()
    """Where the redundant angles of the answer of `forward` lie, where it is looked for among several."""
    limits: Limits = field(default_factory=Limits)
    """Of joints and links, out of a robot file."""
    baked: bool = False
    """Whether the default geometry is a constant of the code, and no argument of its functions."""
    of: str = ""
    """The robot of the catalogue whose kernels and functions it has, where it has a name of its own."""

    @property
    def legs(self) -> int:
        """How many legs it has."""
        return self.functions[0].legs

    @property
    def architecture(self) -> str:
        """The robot of the catalogue that it is, by whatever name and of whatever size."""
        return self.of or self.identifier

    @property
    def parts(self) -> dict[str, Part]:
        """Its parts by the names that calls use."""
        return {"subleg": self.subleg, "platform": self.platform, "algebra": self.algebra}

    @property
    def always_reachable(self) -> bool:
        """Whether the sub-legs reach every point: their kernel `reach` then reads nothing."""
        return not any(kernel.inputs for kernel in self.subleg.kernels if kernel.name == "reach")

    @property
    def has_swivel(self) -> bool:
        """Whether its sub-legs are redundant."""
        return any(port.name == "swivel" for function in self.functions for port in function.inputs)

    def function(self, name: str) -> RobotFunction:
        """A function by name."""
        for entry in self.functions:
            if entry.name == name:
                return entry
        raise KeyError(f"{self.identifier} has no function {name!r}")

    def finds_roots(self, function: RobotFunction) -> bool:
        """Whether a function, or one that it calls, is called at the roots of a polynomial."""
        steps = (self.function(step.function) for step in function.steps)
        return function.each is not None or any(self.finds_roots(step) for step in steps)

    def operations(self, function: RobotFunction) -> OperationCount:
        """Operations of one call: leg kernels count once a leg, those at roots as often as there can be."""
        total = OperationCount()
        for call in function.calls:
            times = _times(call, function.legs)
            total = total + self.parts[call.part].kernel(call.kernel).operations * times
        for step in function.steps:
            total = total + self.operations(self.function(step.function))
        return total

    def written(self, function: RobotFunction) -> int:
        """Operations of one call as the formulas were written."""
        steps = sum(self.written(self.function(step.function)) for step in function.steps)
        return steps + sum(
            self.parts[call.part].written[call.kernel] * _times(call, function.legs)
            for call in function.calls
        )


def _times(call: Call, legs: int) -> int:
    """How often a kernel is called, at most for roots, once for each pair of links."""
    if call.each is not None:
        return call.each.degree * (legs if call.stage is Stage.LEG else 1)
    if call.pairs is not None:
        return len(call.pairs.ends)
    return legs if call.stage is Stage.LEG else 1


def kernels_used(functions: tuple[RobotFunction, ...], parts: Mapping[str, Part]) -> dict[str, list[Kernel]]:
    """The kernels of each part that the functions call, in printing order."""
    used = {(call.part, call.kernel) for function in functions for call in function.calls}
    return {
        name: [kernel for kernel in part.kernels if (name, kernel.name) in used]
        for name, part in parts.items()
    }
