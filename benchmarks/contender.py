"""What takes part in the benchmark: C or C++ sources, and some glue with the workload's prototype."""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass, field
from pathlib import Path

OURS = "krhpr"
HAND = "hand-written C"
"""A yardstick, not a peer."""
NOT_PEERS = (OURS, HAND)


@dataclass(frozen=True)
class Contender:
    """One implementation of one workload.

    ``glue`` is source text that defines ``workload.prototype()`` and, if ``batch_layout`` is set,
    ``workload.batch_prototype()``. It is compiled apart from ``sources``, with the same flags, unless it
    includes them itself. Everything but the glue's own functions is made local to the contender's object, so
    different builds of one library can compete.
    """

    name: str
    workload: str
    variant: str
    glue: str
    glue_language: str = "c"  # or "c++"
    sources: tuple[str, ...] = ()
    include_dirs: tuple[str, ...] = ()
    extra_flags: tuple[str, ...] = ()  # beyond those that all contenders share; shown in the table
    libraries: tuple[str, ...] = ()
    self_contained: bool = True  # False: what it computes lies in its libraries, and its size says nothing
    single: bool = True  # False: offers the batch function only
    batch_layout: str | None = None  # "aos", "soa" or "blocked8" (see layouts.py)
    generate_seconds: float | None = None

    @property
    def label(self) -> str:
        return f"{self.name} [{self.variant}]"


@dataclass(frozen=True)
class Missing:
    """A contender that could not take part, and why; always shown."""

    name: str
    reason: str


@dataclass
class Manifest:
    """What one peer's generator wrote: its contenders and the versions of its packages."""

    contenders: list[Contender] = field(default_factory=list)
    versions: dict[str, str] = field(default_factory=dict)

    def write(self, path: Path) -> None:
        path.write_text(json.dumps(asdict(self), indent=1) + "\n")

    @classmethod
    def read(cls, path: Path) -> Manifest:
        data = json.loads(path.read_text())
        tuples = ("sources", "include_dirs", "extra_flags", "libraries")
        contenders = [
            Contender(**{**c, **{key: tuple(c[key]) for key in tuples}}) for c in data["contenders"]
        ]
        return cls(contenders, data["versions"])
