"""Every contender of a workload: what it executes for a pose, the least time of that, the time it took."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from benchmarks.build import BuildError, Tools
from benchmarks.limits import callgrind, executed
from benchmarks.limits.bound import Bounds, bounds
from benchmarks.limits.mix import Mix
from benchmarks.limits.peaks import Peaks, measure_peaks
from benchmarks.limits.program import Job, build_program
from benchmarks.measure import Bench, Row
from benchmarks.workloads import Workload


@dataclass(frozen=True)
class Count:
    """One contender in one form."""

    workload: str
    row: Row
    job: Job
    mix: Mix
    simulated: float | None = None
    """Instructions per pose by callgrind; of the quickest of every name alone."""

    @property
    def nanoseconds(self) -> float:
        """What it took when nobody disturbed."""
        return self.row.series[self.job.mode].low

    def bounds(self, peaks: Peaks) -> Bounds:
        """The least that it could take on this processor."""
        return bounds(self.mix, peaks)

    def as_json(self, peaks: Peaks) -> dict[str, Any]:
        """For results.json."""
        contender = self.row.built.contender
        least = self.bounds(peaks)
        return {
            "workload": self.workload,
            "contender": contender.name,
            "variant": contender.variant,
            "mode": self.job.mode,
            "layout": self.job.layout,
            "ns": self.nanoseconds,
            "instructions": self.mix.instructions,
            "flops": self.mix.flops,
            "callgrind": self.simulated,
            "least_ns": least.as_json(),
            "share_of_ports": least.ports / self.nanoseconds,
            "share_of_operations": least.operations / self.nanoseconds,
        }


@dataclass
class Limits:
    """What a run found out, and what it could not."""

    peaks: Peaks | None = None
    counts: list[Count] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)

    def __bool__(self) -> bool:
        return self.peaks is not None or bool(self.notes)

    def measure(self, vectors: str, out: Path, tools: Tools) -> None:
        """The processor's peaks, if it has the instructions that they are made of."""
        self.peaks = measure_peaks(vectors, out, tools)
        if self.peaks is None:
            self.note(f"No limits: this processor has {vectors}, AVX2 with fused operations is needed.")

    def note(self, text: str) -> None:
        """Once."""
        if text not in self.notes:
            self.notes.append(text)

    def as_json(self) -> dict[str, Any]:
        """For results.json."""
        if self.peaks is None:
            return {"peaks": None, "rows": [], "notes": self.notes}
        rows = [count.as_json(self.peaks) for count in self.counts]
        return {"peaks": self.peaks.as_json(), "rows": rows, "notes": self.notes}


def count(
    limits: Limits, workload: Workload, bench: Bench, rows: Sequence[Row], out: Path, tools: Tools
) -> None:
    """Adds the rows that were timed; what cannot be counted is noted."""
    why = executed.why_not()
    if why is not None:
        limits.note(f"Nothing is counted: {why}.")
        return
    jobs = [(row, job) for row in rows if row.series for job in jobs_of(row)]
    try:
        program = build_program(workload, bench, bench.path, out, tools)
        mixes = executed.executed(program, [job for _, job in jobs], out, tools)
    except (BuildError, executed.CannotCount) as failure:
        limits.note(f"{workload.key.upper()} is not counted: {failure}.")
        return
    found = [Count(workload.key, row, job, mix) for (row, job), mix in zip(jobs, mixes, strict=True)]
    limits.counts += _simulated(limits, workload, bench, found, out, tools)


def jobs_of(row: Row) -> list[Job]:
    """The functions of a contender; a call alone executes what a call after another executes."""
    built = row.built
    found = [Job(built.single_symbol, "throughput")] if built.single_symbol else []
    if built.batch_symbol and built.contender.batch_layout:
        found.append(Job(built.batch_symbol, "batch", built.contender.batch_layout))
    return found


def quickest(found: Sequence[Count]) -> list[int]:
    """Places of the quickest of every name in every form and layout."""
    best: dict[tuple[str, str, str], int] = {}
    for place, one in enumerate(found):
        key = (one.row.built.contender.name, one.job.mode, one.job.layout)
        if key not in best or one.nanoseconds < found[best[key]].nanoseconds:
            best[key] = place
    return sorted(best.values())


def _simulated(
    limits: Limits, workload: Workload, bench: Bench, found: list[Count], out: Path, tools: Tools
) -> list[Count]:
    why = callgrind.why_not()
    if why is not None:
        limits.note(f"Callgrind counts nothing: {why}.")
        return found
    places = quickest(found)
    try:
        chosen = [(found[place].row.built, found[place].job) for place in places]
        numbers = callgrind.simulated(workload, bench, chosen, out / "callgrind", tools)
    except BuildError as failure:
        limits.note(f"Callgrind does not count {workload.key.upper()}: {failure}.")
        return found
    with_numbers = dict(zip(places, numbers, strict=True))
    return [replace(one, simulated=with_numbers.get(place)) for place, one in enumerate(found)]
