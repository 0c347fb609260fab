"""The least time that a contender's instructions take, and the share of it in the time that they took."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from typing import Any

from benchmarks.limits.mix import Mix
from benchmarks.limits.peaks import Peaks


@dataclass(frozen=True)
class Bounds:
    """Nanoseconds per pose that each part of the processor is busy for, at least."""

    operations: float
    """The fused units, if nothing else were to be done: operations over the peak."""
    vector: float
    """The ports of the vector unit."""
    divider: float
    issue: float
    """Everything that is executed, through the front end."""

    @property
    def ports(self) -> float:
        """Whatever is busy longest."""
        return max(self.vector, self.divider, self.issue)

    @property
    def busiest(self) -> str:
        """Which it is."""
        found = {"vector unit": self.vector, "divider": self.divider, "front end": self.issue}
        return max(found, key=lambda name: found[name])

    def as_json(self) -> dict[str, Any]:
        """For results.json."""
        return asdict(self) | {"ports": self.ports, "busiest": self.busiest}


def bounds(mix: Mix, peaks: Peaks) -> Bounds:
    """From what is executed for one pose."""
    return Bounds(
        operations=mix.flops / peaks.flops,
        vector=_time(mix.vector, peaks.vector),
        divider=_time(mix.divides, peaks.divides) + _time(mix.roots, peaks.roots),
        issue=mix.instructions / peaks.instructions,
    )


def _time(executed: Mapping[int, float], rates: Mapping[int, float]) -> float:
    return sum(times / rates[width] for width, times in executed.items())
