"""Tables, ratios first: how many times slower than ours each contender is."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from benchmarks.contender import HAND, NOT_PEERS, OURS, Missing
from benchmarks.from_python import PythonResult, PythonRow
from benchmarks.measure import POOL, STREAMED, Row, Series
from benchmarks.workloads import Workload


@dataclass
class Result:
    """All that was measured in C for one workload."""

    workload: Workload
    rows: list[Row]
    missing: list[Missing]
    overhead: dict[str, Series]


@dataclass(frozen=True)
class Entry:
    """A row of a table, whatever it came from."""

    name: str
    variant: str
    error: float
    tolerance: float
    series: Mapping[str, Series]
    text: int | None = None  # what lies in a library of others is not known
    generate_ms: float | None = None
    layout: str | None = None
    extra_flags: str = ""

    @property
    def label(self) -> str:
        return f"{self.name} [{self.variant}]"


def entries(rows: Sequence[Row]) -> list[Entry]:
    """Rows measured in C."""
    result = []
    for row in rows:
        c = row.built.contender
        ms = None if c.generate_seconds is None else 1e3 * c.generate_seconds
        flags = " ".join(c.extra_flags)
        size = row.built.text_bytes if c.self_contained else None
        result.append(
            Entry(c.name, c.variant, row.error, row.tolerance, row.series, size, ms, c.batch_layout, flags)
        )
    return result


def python_entries(rows: Sequence[PythonRow]) -> list[Entry]:
    """Rows measured from Python."""
    return [Entry(r.contender.name, r.contender.variant, r.error, r.tolerance, r.series) for r in rows]


def best(candidates: Sequence[Entry], mode: str) -> Entry | None:
    """The quickest in one mode."""
    timed = [entry for entry in candidates if mode in entry.series]
    return min(timed, key=lambda entry: entry.series[mode].median, default=None)


def peers(candidates: Sequence[Entry]) -> list[Entry]:
    """Neither ours nor the hand-written yardstick."""
    return [entry for entry in candidates if entry.name not in NOT_PEERS]


def base_name(candidates: Sequence[Entry]) -> str:
    """Whose times are 1: ours, or while that is missing the hand-written yardstick, or the quickest."""
    names = {entry.name for entry in candidates if entry.series}
    return next((name for name in (OURS, HAND) if name in names), "the best peer")


def base_of(candidates: Sequence[Entry], mode: str) -> Entry | None:
    """The quickest variant of the base."""
    name = base_name(candidates)
    return best([e for e in candidates if e.name == name] or candidates, mode)


def times(value: float | None) -> str:
    """A ratio."""
    return "–" if value is None else f"{value:.2f}x"


def ns(entry: Entry, mode: str) -> str:
    """A time with its spread."""
    if mode not in entry.series:
        return "–"
    series = entry.series[mode]
    digits = 0 if series.median >= 1_000 else 1
    return f"{series.median:,.{digits}f} ±{50 * series.spread:.0f}%"


def bytes_of(entry: Entry) -> str:
    """The size of its code."""
    return "–" if entry.text is None else f"{entry.text:,}"


def ratio(entry: Entry, base: Entry | None, mode: str) -> float | None:
    """How many times slower than the base."""
    if base is None or mode not in entry.series or mode not in base.series:
        return None
    return entry.series[mode].ratio_to(base.series[mode])


def markdown(header: Sequence[str], lines: Sequence[Sequence[str]], text_columns: int = 2) -> str:
    """An aligned Markdown table, numbers to the right."""
    widths = [max(len(line[k]) for line in (header, *lines)) for k in range(len(header))]

    def row(cells: Sequence[str]) -> str:
        padded = [
            cell.ljust(width) if k < text_columns else cell.rjust(width)
            for k, (cell, width) in enumerate(zip(cells, widths, strict=True))
        ]
        return "| " + " | ".join(padded) + " |"

    rule = [("-" * w if k < text_columns else "-" * (w - 1) + ":") for k, w in enumerate(widths)]
    return "\n".join([row(header), row(rule), *map(row, lines)])


def headline(candidates: Sequence[Entry], modes: Sequence[str]) -> str:
    """The base against the best peer in every mode."""
    parts = []
    for mode in modes:
        base, peer = base_of(candidates, mode), best(peers(candidates), mode)
        if base is not None and peer is not None and base is not peer:
            parts.append(f"{mode} **{times(ratio(peer, base, mode))}** ({peer.label})")
    if not parts:
        return "No peer to compare with."
    return f"{base_name(candidates)} against the best peer: " + ", ".join(parts) + "."


def by_time(candidates: Sequence[Entry], mode: str) -> list[Entry]:
    """Quickest first."""
    return sorted((e for e in candidates if mode in e.series), key=lambda e: e.series[mode].median)


def single_table(candidates: Sequence[Entry]) -> str:
    """One call for one pose."""
    modes = ("throughput", "latency")
    bases = {mode: base_of(candidates, mode) for mode in modes}
    size = bases["throughput"].text if bases["throughput"] else None
    header = ["contender", "variant", "throughput", "latency", ".text"]
    header += ["throughput ns", "latency ns", ".text B", "generated in ms", "error"]
    lines = [
        [
            e.name,
            e.variant,
            *(times(ratio(e, bases[mode], mode)) for mode in modes),
            times(e.text / size if e.text and size else None),
            *(ns(e, mode) for mode in modes),
            bytes_of(e),
            "–" if e.generate_ms is None else f"{e.generate_ms:,.0f}",
            f"{e.error:.0e}",
        ]
        for e in by_time(candidates, "throughput")
    ]
    return markdown(header, lines)


def one_by_one(candidates: Sequence[Entry]) -> list[Entry]:
    """The best peer that has no batch function, called pose by pose: a batch with the layout ``aos``."""
    scalar = best(peers(candidates), "throughput")
    if scalar is None:
        return []
    series = {"batch": scalar.series["throughput"]}
    variant = f"{scalar.variant}, one call per pose"
    return [replace(scalar, variant=variant, series=series, generate_ms=None, layout="aos")]


def batch_table(candidates: Sequence[Entry]) -> str:
    """Whole batches in every layout that somebody offers."""
    pool = [e for e in candidates if "batch" in e.series]
    if not pool:
        return ""
    pool += one_by_one(candidates)
    ours = [e for e in pool if e.name == OURS]
    parts = []
    for layout in sorted({str(e.layout) for e in ours}):
        mine, peer = (
            best([e for e in group if e.layout == layout], "batch") for group in (ours, peers(pool))
        )
        if mine and peer:
            parts.append(f"{layout} **{times(ratio(peer, mine, 'batch'))}** ({peer.label})")
    base = best(ours or pool, "batch")
    lines = [
        [
            e.name,
            e.variant,
            str(e.layout),
            times(ratio(e, base, "batch")),
            ns(e, "batch"),
            ns(e, "streaming"),
            bytes_of(e),
            f"{e.error:.0e}",
        ]
        for e in by_time(pool, "batch")
    ]
    header = [
        "contender",
        "variant",
        "layout",
        "ratio",
        "ns per pose",
        f"ns of {STREAMED:,}",
        ".text B",
        "error",
    ]
    whose = f"{OURS} at its best" if ours else "the quickest"
    line = f"{OURS} against the best peer with the same layout: {', '.join(parts)}.\n\n" if parts else ""
    table = markdown(header, lines, text_columns=3)
    title = f"Batch of {POOL} poses in cache, and of {STREAMED:,} that stream; ratios against {whose}."
    return f"{title}\n\n{line}{table}\n"


def flags_note(candidates: Sequence[Entry]) -> str:
    """Who is compiled with more flags than the others."""
    extra = {f"{e.name}: `{e.extra_flags}`" for e in candidates if e.extra_flags}
    return "Flags beyond those of all: " + "; ".join(sorted(extra)) + ".\n" if extra else ""


def excluded(candidates: Sequence[Entry], missing: Sequence[Missing]) -> str:
    """Who is not in the table, and why. Always printed."""
    lines = [f"* MISSING: {m.name}: {m.reason}" for m in missing]
    lines += [
        f"* WRONG, not timed: {e.label} differs by {e.error:.1e} of the output's scale "
        f"(allowed {e.tolerance:.0e})"
        for e in candidates
        if not e.error <= e.tolerance
    ]
    return "\n".join(lines) + "\n" if lines else ""


def c_section(result: Result) -> str:
    """One workload in C."""
    candidates = entries(result.rows)
    correct = [e for e in candidates if e.error <= e.tolerance]
    overhead = ", ".join(f"{mode} {series.median:.1f} ns" for mode, series in result.overhead.items())
    parts = [
        f"## {result.workload.key.upper()}: {result.workload.title}\n",
        excluded(candidates, result.missing),
        headline(correct, ("throughput", "latency")) + "\n",
        f"Ratios are times slower (or larger) than {base_name(correct)} at its best.\n",
        single_table(correct) + "\n",
        f"In every time: the loop around an empty function, {overhead}.\n",
        batch_table(correct),
        flags_note(correct),
    ]
    return "\n".join(part for part in parts if part)


def python_section(result: PythonResult) -> str:
    """One workload called from Python."""
    candidates = python_entries(result.rows)
    correct = [e for e in candidates if e.error <= e.tolerance]
    header: dict[str, Callable[[Entry], str]] = {
        "contender": lambda e: e.name,
        "variant": lambda e: e.variant,
    }
    ours = any(e.name == OURS for e in correct)
    tables = []
    for mode, title in (("batch", "Batches of 10^4 poses"), ("single", "Single calls")):
        base = best([e for e in correct if e.name == OURS] or correct, mode)
        lines = [
            [
                *(show(e) for show in header.values()),
                times(ratio(e, base, mode)),
                ns(e, mode),
                f"{e.error:.0e}",
            ]
            for e in by_time(correct, mode)
        ]
        table = markdown([*header, "ratio", "ns per pose", "error"], lines)
        tables.append(f"{title}; ratios against {OURS if ours else 'the quickest'}.\n\n{table}\n")
    parts = [
        f"## {result.workload.key.upper()} from Python: {result.workload.title}\n",
        excluded(candidates, result.missing),
        headline(correct, ("batch", "single")) + "\n" if ours else "",
        *tables,
        f"In single calls: an empty Python function in the loop, {result.empty_call_ns:.0f} ns.\n",
    ]
    return "\n".join(part for part in parts if part)


def document(
    machine: Mapping[str, str], versions: Mapping[str, str], warnings: Sequence[str], sections: Sequence[str]
) -> str:
    """The whole report."""
    facts = [f"* {key}: {value}" for key, value in machine.items()]
    facts.append(
        "* packages: " + ", ".join(f"{name} {version}" for name, version in sorted(versions.items()))
    )
    notes = [f"* WARNING: {warning}" for warning in warnings]
    method = (
        "Medians over rounds in which all contenders take turns in random order in one process; thread "
        "CPU time; ± is half the interquartile range. Ratios are medians of the ratios within a round. "
        f"Throughput: independent calls over {POOL} random poses in cache. Latency: each call waits for "
        "every word of the previous output. `.text`: the function and all that it calls in its object, "
        "without libm. Error: largest difference from the reference, relative to the output's scale."
    )
    return "\n".join(["# Benchmark\n", *facts, *notes, "", method, "", *sections])


def as_json(results: Sequence[Result], python: Sequence[PythonResult]) -> list[dict[str, Any]]:
    """Everything that the tables show, for programs."""

    def plain(entry: Entry, language: str, key: str, base: Callable[[str], Entry | None]) -> dict[str, Any]:
        return {
            "workload": key,
            "language": language,
            "contender": entry.name,
            "variant": entry.variant,
            "layout": entry.layout,
            "error": entry.error,
            "text_bytes": entry.text,
            "generate_ms": entry.generate_ms,
            "median_ns": {mode: series.median for mode, series in entry.series.items()},
            "tenth_percentile_ns": {mode: series.low for mode, series in entry.series.items()},
            "spread": {mode: series.spread for mode, series in entry.series.items()},
            "ratio_to_base": {mode: ratio(entry, base(mode), mode) for mode in entry.series},
        }

    rows = []
    for language, key, candidates, missing in [
        *(("C", r.workload.key, entries(r.rows), r.missing) for r in results),
        *(("Python", r.workload.key, python_entries(r.rows), r.missing) for r in python),
    ]:
        correct = [e for e in candidates if e.error <= e.tolerance]

        def base(mode: str, correct: list[Entry] = correct) -> Entry | None:
            return base_of(correct, mode)

        rows += [plain(e, language, key, base) for e in candidates]
        rows += [
            {"workload": key, "language": language, "contender": m.name, "missing": m.reason} for m in missing
        ]
    return rows
