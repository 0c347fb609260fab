"""What is validated: a robot's derivation, its optimised kernels, and the texts printed from them.

A subject is made from the catalogue and `generated/`, or, to see whether a check would notice a mistake,
from a changed derivation or changed texts in a folder of their own.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from functools import cached_property
from pathlib import Path
from types import ModuleType
from typing import Any

from krhpr.backend import compile_robot
from krhpr.codegen.build import Parts, build
from krhpr.codegen.composition import RobotFunction
from krhpr.codegen.evaluate import Arithmetic, evaluate_function, evaluate_kernel, prepare_geometry
from krhpr.codegen.kernel import LEGS, GeometryType, Kernel
from krhpr.codegen.robot_code import RobotCode
from krhpr.derivations.catalogue import Entry, catalogue
from krhpr.derivations.grasping.catalogue import grasping
from krhpr.derivations.platforms.base import Platform
from krhpr.derivations.sublegs.base import SubLeg
from krhpr.printed_package import GENERATED, submodule

Fields = Mapping[str, Sequence[Any]]
"""A geometry: for each field the values of the three legs."""
Inputs = Mapping[str, Sequence[Any]]
"""Arguments of a function by port, flat and row-major."""
Outputs = dict[str, list[Any]]


class Subject:
    """One robot under validation."""

    def __init__(self, entry: Entry, folder: Path = GENERATED, parts: Parts | None = None) -> None:
        self.entry = entry
        self.folder = folder
        self.code: RobotCode = build(entry, parts or Parts())
        self._derived: dict[str, dict[str, Kernel]] = {}

    @property
    def identifier(self) -> str:
        """The robot's identifier."""
        return self.entry.identifier

    @property
    def subleg(self) -> SubLeg:
        """The derivation's sub-leg."""
        return self.entry.robot.subleg

    @property
    def platform(self) -> Platform:
        """The derivation's platform arrangement."""
        return self.entry.robot.platform

    @property
    def planar(self) -> bool:
        """Whether the robot moves in the plane."""
        return self.platform.space.value == "planar"

    # -- the derivation ----------------------------------------------------------------------------

    def derived(self, part: str, name: str) -> Kernel:
        """A kernel as the derivation states it, before any pass."""
        if part not in self._derived:
            self._derived[part] = {kernel.name: kernel for kernel in self.code.parts[part].derived}
            if part == "subleg":
                closure = self.subleg.closure_kernel()
                self._derived[part][closure.name] = closure
        return self._derived[part][name]

    @cached_property
    def geometry_types(self) -> dict[str, GeometryType]:
        """The geometries of the parts, as derived."""
        return {"subleg": self.subleg.geometry(), "platform": self.platform.geometry()}

    @property
    def fields(self) -> tuple[str, ...]:
        """The names of all geometry fields, in the order of the C structure."""
        return tuple(field.name for kind in self.geometry_types.values() for field in kind.fields)

    def prepare(self, geometry: Fields, arithmetic: Arithmetic) -> dict[str, list[dict[str, list[Any]]]]:
        """The prepared geometry of each part and leg."""
        return {
            part: [
                prepare_geometry(
                    kind, {field.name: geometry[field.name][leg] for field in kind.fields}, arithmetic
                )
                for leg in range(self.code.legs)
            ]
            for part, kind in self.geometry_types.items()
        }

    def kernel(
        self,
        part: str,
        kernel: Kernel | str,
        inputs: Inputs,
        geometry: Fields,
        leg: int,
        arithmetic: Arithmetic,
    ) -> Outputs:
        """A kernel of a part (as derived, where it is named) evaluated for one leg."""
        kind = self.geometry_types.get(part)
        prepared = None
        if kind is not None:
            fields = {field.name: geometry[field.name][leg] for field in kind.fields}
            prepared = prepare_geometry(kind, fields, arithmetic)
        found = self.derived(part, kernel) if isinstance(kernel, str) else kernel
        return evaluate_kernel(found, inputs, prepared, arithmetic)

    def ties(self, geometry: Fields, arithmetic: Arithmetic) -> Outputs:
        """What the forward kinematics knows of all legs' places on the platform."""
        found: dict[str, list[Any]] = {}
        known = {kernel.name for kernel in self.code.platform.kernels}
        for kernel in ("tie", "arm"):
            for leg in range(LEGS if kernel in known else 0):
                for name, values in self.kernel("platform", kernel, {}, geometry, leg, arithmetic).items():
                    found.setdefault(name, []).extend(values)
        return found

    def function(
        self, function: RobotFunction, inputs: Inputs, geometry: Fields, arithmetic: Arithmetic
    ) -> Outputs:
        """A robot's function by the derivation, guards not applied."""
        return evaluate_function(
            function, self.derived, self.prepare(geometry, arithmetic), inputs, arithmetic
        )

    def call(self, name: str, inputs: Inputs, geometry: Fields, arithmetic: Arithmetic) -> Outputs:
        """`function`, by its name."""
        return self.function(self.code.function(name), inputs, geometry, arithmetic)

    # -- the printed texts -------------------------------------------------------------------------

    @property
    def module(self) -> ModuleType:
        """The generated NumPy module."""
        return submodule(self.folder, f"python.{self.identifier}")

    @property
    def casadi(self) -> ModuleType:
        """The generated CasADi module."""
        return submodule(self.folder, f"casadi.{self.identifier}")

    @property
    def source(self) -> Path:
        """The generated C source."""
        return self.folder / "c" / f"krhpr_{self.identifier}.c"

    @cached_property
    def library(self) -> Path:
        """The generated C, compiled for speed; raises `NoCompiler` where nothing compiles it."""
        return compile_robot(self.identifier, self.source.parent)

    def c_sources(self, kind: str = "") -> list[tuple[str, str]]:
        """The C source (`_batch`: that of its batches) and the headers that it includes, each before what
        uses it.
        """
        return _with_headers(self.source.with_stem(f"{self.source.stem}{kind}"), set())


def subjects(
    identifiers: Iterable[str] | None = None, folder: Path = GENERATED, among: Iterable[Entry] | None = None
) -> list[Subject]:
    """Robots of the catalogue and grasping robots, or robots of `among` (all unless named), which share what
    they have in common.
    """
    every: Iterable[Any] = (*catalogue(), *grasping()) if among is None else among
    entries = {entry.identifier: entry for entry in every}
    names = list(entries if identifiers is None else identifiers)
    unknown = [name for name in names if name not in entries]
    if unknown:
        raise KeyError(f"no robot is called {', '.join(unknown)}; there are {', '.join(entries)}")
    parts = Parts()
    return [Subject(entries[name], folder, parts) for name in names]


_INCLUDE = re.compile(r'^#include "([^"]+)"', re.MULTILINE)


def _with_headers(path: Path, seen: set[str]) -> list[tuple[str, str]]:
    text = path.read_text(encoding="utf-8")
    found = []
    for header in _INCLUDE.findall(text):
        if header not in seen:
            seen.add(header)
            found += _with_headers(path.parent / header, seen)
    return [*found, (path.name, text)]
