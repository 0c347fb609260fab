"""Carrying out the plan: which checks of which robots hold, with the worst error of each.

    report = run(["spatial_rrr_a"], "small", print)
    report.ok, report.write(Path("build/validation"))

Without a C compiler the checks of compiled C are reported as not run; all others need none.
"""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Callable, Collection, Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from time import perf_counter
from typing import Any

from krhpr.derivations.catalogue import Entry
from krhpr.native import NoCompiler
from krhpr.printed_package import GENERATED
from krhpr.validation import agreement, differences, exact, invariants, proofs, reference
from krhpr.validation.check import Check, Kind
from krhpr.validation.numbers import ball_precision
from krhpr.validation.outcome import Runner, State
from krhpr.validation.plan import plan
from krhpr.validation.reference import NoReference
from krhpr.validation.subject import Subject, subjects

Progress = Callable[[str], None]

RUNNERS: Mapping[Kind, Mapping[str, Runner]] = {
    Kind.PROOF: proofs.RUNNERS,
    Kind.PASSES: exact.RUNNERS,
    Kind.IDENTITY: exact.RUNNERS,
    Kind.DIFFERENCES: differences.RUNNERS,
    Kind.AGREEMENT: agreement.RUNNERS,
    Kind.DIGITS: agreement.RUNNERS,
    Kind.INVARIANT: invariants.RUNNERS,
    Kind.REFERENCE: reference.RUNNERS,
}
"""The code of every check of the plan, by kind and name."""


@dataclass(frozen=True)
class Result:
    """How one check ended."""

    check: Check
    state: State
    worst: float = 0.0
    samples: int = 0
    seconds: float = 0.0
    remark: str = ""

    def __str__(self) -> str:
        error = f"error {self.worst:.1e} of {self.check.closeness}" if self.state is not State.NOT_RUN else ""
        return ", ".join(filter(None, (f"{self.check.identifier}: {self.state}", error, self.remark)))


@dataclass(frozen=True)
class Report:
    """The results of a run."""

    size: str
    results: tuple[Result, ...]

    @property
    def ok(self) -> bool:
        """Whether no check failed (what could not be run is no failure)."""
        return not self.failed

    @property
    def failed(self) -> list[Result]:
        """The checks that failed."""
        return [result for result in self.results if result.state is State.FAILED]

    @property
    def not_run(self) -> list[Result]:
        """The checks that could not be run; their remarks say why."""
        return [result for result in self.results if result.state is State.NOT_RUN]

    def counts(self) -> dict[str, int]:
        """How many checks passed, failed, and were not run."""
        found = Counter(str(result.state) for result in self.results)
        return {str(state): found[str(state)] for state in State}

    def summary(self) -> str:
        """One line: counts and time."""
        counts = ", ".join(f"{number} {state}" for state, number in self.counts().items() if number)
        return f"{counts or 'no checks'} in {sum(result.seconds for result in self.results):.1f} s"

    def as_json(self) -> str:
        """Every result, for programs."""
        rows = [
            {
                "robot": result.check.robot,
                "kind": str(result.check.kind),
                "name": result.check.name,
                "function": result.check.function,
                "target": str(result.check.target),
                "state": str(result.state),
                "worst": result.worst,
                "tolerance": result.check.tolerance,
                "samples": result.samples,
                "seconds": round(result.seconds, 3),
                "remark": result.remark,
            }
            for result in self.results
        ]
        whole = {"ok": self.ok, "samples": self.size, **self.counts(), "results": rows}
        return json.dumps(whole, indent=1) + "\n"

    def as_markdown(self) -> str:
        """The worst error of each kind, robot by robot, and what failed."""
        lines = [f"# Validation, {self.size} samples", "", self.summary(), ""]
        for title, results in (("Failed", self.failed), ("Not run", self.not_run)):
            if results:
                lines += [f"## {title}", "", *_grouped(results), ""]
        lines += ["## Worst errors", "", "| Robot | Kind | Check | Target | Worst | Tolerance | Samples |"]
        lines.append("|---|---|---|---|---:|---:|---:|")
        for result in _worst_of_each(self.results):
            check = result.check
            what = f"{check.name}, `{check.function}`"
            error = "exact" if result.worst == 0.0 else f"{result.worst:.1e}"
            lines.append(
                f"| `{check.robot}` | {check.kind} | {what} | {check.target} | {error} | {check.closeness} "
                f"| {result.samples} |"
            )
        return "\n".join(lines) + "\n"

    def write(self, folder: Path) -> None:
        """Write report.json and report.md."""
        folder.mkdir(parents=True, exist_ok=True)
        (folder / "report.json").write_text(self.as_json(), encoding="utf-8")
        (folder / "report.md").write_text(self.as_markdown(), encoding="utf-8")


def _grouped(results: Iterable[Result]) -> list[str]:
    """Results with one remark in one line."""
    by_remark: dict[str, list[Result]] = {}
    for result in results:
        key = result.remark if result.state is State.NOT_RUN else str(result)
        by_remark.setdefault(key, []).append(result)
    return [
        f"* {remark}" + (f" ({len(found)} checks)" if len(found) > 1 else "")
        for remark, found in by_remark.items()
    ]


def _worst_of_each(results: Iterable[Result]) -> list[Result]:
    """Of each robot, kind and target the result that came nearest to its tolerance."""
    found: dict[tuple[Any, ...], Result] = {}
    for result in results:
        key = (result.check.robot, result.check.kind, result.check.target)
        here = found.get(key)
        if result.state is not State.NOT_RUN and (here is None or _share(result) > _share(here)):
            found[key] = result
    return list(found.values())


def _share(result: Result) -> float:
    return result.worst / result.check.tolerance if result.check.tolerance else result.worst


def carry_out(subject: Subject, check: Check, size: str) -> Result:
    """One check on samples of a size (`small` or `large`); errors of any kind are failures of the check."""
    begin = perf_counter()
    try:
        with ball_precision():
            found = RUNNERS[check.kind][check.name](subject, check, check.samples.of(size))
    except (NoCompiler, NoReference) as error:
        return Result(check, State.NOT_RUN, seconds=perf_counter() - begin, remark=_first_line(error))
    except Exception as error:
        remark = f"{type(error).__name__}: {_first_line(error)}"
        return Result(check, State.FAILED, float("inf"), 0, perf_counter() - begin, remark)
    state = State.PASSED if found.ok else State.FAILED
    remark = "" if found.ok else found.where or "no samples"
    return Result(check, state, found.worst, found.samples, perf_counter() - begin, remark)


def _first_line(error: BaseException) -> str:
    return (str(error).splitlines() or [""])[0]


def run(
    robots: Iterable[str] | None = None,
    samples: str = "small",
    progress: Progress = lambda step: None,
    *,
    kinds: Collection[Kind] | None = None,
    generated: Path = GENERATED,
    among: Iterable[Entry] | None = None,
    folder: Path | None = Path("build/validation"),
) -> Report:
    """Carry out the plan for robots of the catalogue (all unless named) and write the report to `folder`.

    `among` are other robots, whose code is in the folder `generated`.
    `samples` is `small` or `large`.  `progress` is told what begins.
    """
    if samples not in ("small", "large"):
        raise ValueError(f"samples are 'small' or 'large', not {samples!r}")
    shared: dict[tuple[str, ...], Result] = {}
    results = []
    for subject in subjects(robots, generated, among):
        before = None
        for check in plan(subject.code):
            if kinds is not None and check.kind not in kinds:
                continue
            if check.kind is not before:
                before = check.kind
                progress(f"{subject.identifier}: {check.kind}")
            results.append(_once(subject, check, samples, shared))
    report = Report(samples, tuple(results))
    if folder is not None:
        report.write(folder)
    return report


def _once(subject: Subject, check: Check, size: str, shared: dict[tuple[str, ...], Result]) -> Result:
    """A check, or the result that another robot with the same part has had."""
    if check.once not in shared:
        shared[check.once] = carry_out(subject, check, size)
        return shared[check.once]
    earlier = shared[check.once]
    return Result(check, earlier.state, earlier.worst, earlier.samples, 0.0, earlier.remark)
