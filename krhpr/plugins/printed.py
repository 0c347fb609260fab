"""Robots that are not in krhpr.generated, printed to a folder of their own and imported from there."""

from __future__ import annotations

import tempfile
from collections.abc import Callable, Sequence
from pathlib import Path
from types import ModuleType
from typing import Self

from krhpr.codegen.output import write
from krhpr.codegen.pipeline import Derived, derive, print_all
from krhpr.codegen.targets.base import Target
from krhpr.derivations.catalogue import Entry
from krhpr.printed_package import submodule
from krhpr.robot import Robot


class Printed:
    """Robots with a sub-leg of one's own as `krhpr.generated` would have them, in a temporary folder.

        with Printed(plugin.entries()) as printed:
            robot = printed.robot("spatial_offset_wrist_a")

    The folder is gone after the block; Python modules that were imported stay usable.  `targets` are those
    that are printed: `NUMPY` alone is enough to call robots, and takes a third of the time.
    """

    def __init__(
        self,
        entries: Sequence[Entry],
        progress: Callable[[str], None] = lambda step: None,
        targets: Sequence[Target] | None = None,
    ) -> None:
        self.entries = tuple(entries)
        self.derived: Derived = derive(self.entries, progress)
        self._files = print_all(self.derived, progress, targets)
        self._temporary: tempfile.TemporaryDirectory[str] | None = None

    def __enter__(self) -> Self:
        self._temporary = tempfile.TemporaryDirectory(prefix="krhpr-")
        write(self._files, self.folder)
        return self

    def __exit__(self, *raised: object) -> None:
        assert self._temporary is not None
        self._temporary.cleanup()
        self._temporary = None

    @property
    def folder(self) -> Path:
        """Where the files are."""
        assert self._temporary is not None, "use it as a context: `with Printed(...) as printed:`"
        return Path(self._temporary.name).resolve() / "generated"

    @property
    def identifiers(self) -> tuple[str, ...]:
        """The names of the robots."""
        return tuple(entry.identifier for entry in self.entries)

    def module(self, identifier: str) -> ModuleType:
        """A robot's NumPy module."""
        return submodule(self.folder, f"python.{identifier}")

    def robot(self, identifier: str) -> Robot:
        """A robot on its NumPy module."""
        return Robot(self.module(identifier), backend="numpy")
