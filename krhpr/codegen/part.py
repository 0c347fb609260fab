"""A part: kernels that share one geometry, from the derivation's to what the printers take."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

from krhpr.codegen.kernel import GeometryType, Kernel
from krhpr.codegen.passes import (
    fold_prepared_constants,
    hoist_reciprocals,
    pair_sine_cosine,
    precompute_parameters,
    remove_dead_code,
)
from krhpr.codegen.phases import Phases, split


@dataclass(frozen=True)
class Part:
    """The kernels that share one geometry (a sub-leg, a platform arrangement, or plain algebra), ready to
    print.

    `derived` are the same kernels as the derivation states them, before any pass.
    """

    name: str
    doc: str
    geometry: GeometryType | None
    kernels: tuple[Kernel, ...]
    derived: tuple[Kernel, ...]

    def kernel(self, name: str) -> Kernel:
        """A kernel by name."""
        for entry in self.kernels:
            if entry.name == name:
                return entry
        raise KeyError(f"part {self.name!r} has no kernel {name!r}")

    @cached_property
    def written(self) -> Mapping[str, int]:
        """Operations of each kernel's formulas as they were written."""
        return {kernel.name: kernel.written for kernel in self.derived}

    @cached_property
    def phases(self) -> Mapping[str, Phases]:
        """Every kernel with its leading sines and cosines and trailing arctangents taken off."""
        return {kernel.name: split(kernel) for kernel in self.kernels}


def optimise(name: str, doc: str, geometry: GeometryType | None, kernels: Sequence[Kernel]) -> Part:
    """All passes, in order, over the kernels of one part."""
    shared = [hoist_reciprocals(kernel) for kernel in kernels]
    if geometry is not None:
        shared = [fold_prepared_constants(geometry, kernel) for kernel in shared]
        geometry, shared = precompute_parameters(geometry, shared)
        geometry = replace(geometry, prepare=pair_sine_cosine(remove_dead_code(geometry.prepare)))
        shared = [replace(kernel, geometry=geometry) if kernel.geometry else kernel for kernel in shared]
    done = tuple(pair_sine_cosine(remove_dead_code(kernel)) for kernel in shared)
    return Part(name, doc, geometry, done, tuple(kernels))
