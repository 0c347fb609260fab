"""The tables of docs/performance.md, from what a run measured.

Each table stands between `<!-- measured: NAME -->` and `<!-- end -->`; what was there is replaced.
"""

from __future__ import annotations

import re
import sys
from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

from benchmarks import cost_model
from benchmarks.contender import NOT_PEERS, OURS
from benchmarks.limits import tables

Row = Mapping[str, Any]
Results = Mapping[str, Any]

LANES = "SymPy + libmvec"
"""The peer that computes batches with vector instructions."""

TITLES = {"w1": "W1", "w2": "W2", "w3": "W3", "w4": "W4", "w5": "W5"}
STRAIGHT = ("w1", "w2", "w5")
"""Workloads without iterations."""

TIMES = "tenth_percentile_ns"
"""What code takes when nobody disturbs: other processes slow code that keeps the vector units busy more than
code that waits for the C library.  The medians are in results.md.
"""


def update(page: Path, results: Results) -> None:
    """Put the tables of a run into a page."""
    text = page.read_text()
    for name, table in TABLES.items():
        if not _is_measured(name, results):
            continue
        mark = f"<!-- measured: {name} -->\n"
        pattern = re.compile(f"{re.escape(mark)}.*?<!-- end -->", re.DOTALL)
        if not pattern.search(text):
            print(
                f"{page} has no place {mark.strip()} ... <!-- end -->: that table is left out",
                file=sys.stderr,
            )
            continue
        made = f"{mark}\n{table(results)}\n<!-- end -->"
        text = pattern.sub(lambda _, made=made: made, text)  # type: ignore[misc]
    page.write_text(text)


def machine(results: Results) -> str:
    """Where it was measured, and what was noisy."""
    facts = results["machine"]
    lines = [f"Measured on {facts['processor']}, {facts['C compiler']}."]
    lines += [f"Warning: {warning}." for warning in results["warnings"]]
    return "\n".join(lines) + "\n"


def one_pose(results: Results) -> str:
    """Every peer's best form against ours, throughput and latency."""
    columns = [(key, mode) for key in STRAIGHT for mode in ("throughput", "latency")]
    head = ["", *(f"{TITLES[key]} {mode}" for key, mode in columns), "W1 `.text`"]
    base = {(key, mode): _best(_of(results, key, OURS), mode) for key, mode in columns}
    ours = [_ns(base[column], column[1]) for column in columns]
    lines = [[f"{OURS} (ns, bytes)", *ours, f"{_text(base['w1', 'throughput']):,} B"]]
    names = dict.fromkeys(row["contender"] for row in _rows(results, "C") if row["workload"] in STRAIGHT)
    for name in sorted(set(names) - {OURS}):
        cells = [_times(_best(_of(results, key, name), mode), base[key, mode], mode) for key, mode in columns]
        if any(cells):
            size = _best(_of(results, "w1", name), "throughput")
            own = base["w1", "throughput"]
            share = f"{_text(size) / _text(own):.2f}" if _text(size) and _text(own) else ""
            lines.append([name, *cells, share])
    variants = dict.fromkeys(
        row["variant"] for row in _of(results, "w1", OURS) if "throughput" in _times_of(row)
    )
    for variant in list(variants)[1:]:
        cells = []
        for key, mode in columns:
            found = [row for row in _of(results, key, OURS) if row["variant"] == variant]
            cells.append(_times(_best(found, mode), base[key, mode], mode))
        lines.append([f"{OURS}, {variant}", *cells, ""])
    return _table(head, lines)


def batches(results: Results) -> str:
    """Poses side by side: nanoseconds, and how many times slower the peers are."""
    head = ["", "layout", f"{OURS} (ns per pose)", f"{LANES}, same layout", "best peer, one pose at a time"]
    head += ["streaming (ns per pose)", f"{LANES}, streaming"]
    lines = []
    for key in STRAIGHT:
        everybody = (row for row in _rows(results, "C") if row["workload"] == key)
        peers = [row for row in everybody if row["contender"] not in NOT_PEERS]
        scalar = _best(peers, "throughput")
        for layout, words in LAYOUTS.items():
            own = _best([row for row in _of(results, key, OURS) if row.get("layout") == layout], "batch")
            if own is None:
                continue
            vector = _best([row for row in _of(results, key, LANES) if row.get("layout") == layout], "batch")
            slower = _times(scalar, own, "throughput", "batch")
            in_cache = [_ns(own, "batch"), _times(vector, own, "batch"), slower]
            streaming = [_ns(own, "streaming"), _times(vector, own, "streaming")]
            lines.append([TITLES[key], words, *in_cache, *streaming])
    return _table(head, lines)


LAYOUTS = {
    "blocked8": "structure of arrays, blocks of eight",
    "soa": "structure of arrays",
    "aos": "array of structures",
}


def forward(results: Results) -> str:
    """Solutions of the forward kinematics, and Newton steps."""
    head = ["", "throughput", "latency"]
    lines = []
    for key, words in (
        ("w3", "every real solution from the end points (W3)"),
        ("w4", "one Newton step (W4)"),
    ):
        base = {mode: _best(_of(results, key, OURS), mode) for mode in ("throughput", "latency")}
        lines.append([f"{OURS}, {words}", *(_ns(base[mode], mode) for mode in base)])
        own = _best(_of(results, key, OURS), "batch")
        if own is not None:
            lines.append(
                [f"{OURS}, poses in lanes", _times(own, base["throughput"], "batch", "throughput"), ""]
            )
        for row in _rows(results, "C"):
            if row["workload"] == key and row["contender"] != OURS and "throughput" in _times_of(row):
                label = f"{row['contender']}, {row['variant']}"
                lines.append([label, *(_times(row, base[mode], mode) for mode in base)])
    return _table(head, lines)


def from_python(results: Results) -> str:
    """Batches of 10,000 poses and single calls."""
    keys = ("w1", "w2")
    head = ["", *(f"{TITLES[key]} {mode}" for key in keys for mode in ("batch", "single call"))]
    labels = dict.fromkeys(
        (row["contender"], row["variant"])
        for row in _rows(results, "Python")
        if row["workload"] in keys and _times_of(row)
    )
    lines = []
    for contender, variant in labels:
        cells = []
        for key in keys:
            found = [row for row in _of(results, key, contender, "Python") if row["variant"] == variant]
            cells += [_ns(_best(found, mode), mode) for mode in ("batch", "single")]
        lines.append([f"{contender}, {variant}", *cells])
    return _table(head, lines)


def every_robot(results: Results) -> str:
    """Each robot of the catalogue."""
    head = ["", "W1", "W1, batch", "W2", "W2, batch", "`.text`", "batches", "s to compile"]
    lines = []
    for row in results["every robot"]:
        times, sizes, seconds = row["undisturbed"], row["text_bytes"], row["seconds"]
        cells = [f"{times[f'{key} {mode}']:.0f}" for key in ("w1", "w2") for mode in ("single", "batch")]
        cells += [f"{sizes[kind] / 1024:.0f}" for kind in ("single", "batch")]
        lines.append([f"`{row['robot']}`", *cells, f"{sum(seconds.values()):.1f}"])
    return _table(head, lines)


def scaling(results: Results) -> str:
    """How time grows with poses and threads."""
    points = results["scaling"]
    threads = sorted({point["threads"] for point in points})
    head = ["poses", *(f"{count} thread{'s' if count > 1 else ''}" for count in threads)]
    lines = []
    for poses in sorted({point["poses"] for point in points}):
        found = {point["threads"]: point["undisturbed"] for point in points if point["poses"] == poses}
        lines.append([f"{poses:,}", *(f"{found[count]:,.0f}" for count in threads)])
    return _table(head, lines)


def slower(results: Results, mode: str) -> dict[str, dict[str, float]]:
    """How many times slower than ours every peer's best form is, by workload."""
    names = sorted({row["contender"] for row in _rows(results, "C")} - {OURS})
    found: dict[str, dict[str, float]] = {}
    for name in names:
        ratios = {}
        for key in STRAIGHT:
            theirs, own = (_best(_of(results, key, who), mode) for who in (name, OURS))
            if theirs is not None and own is not None:
                ratios[key] = theirs[TIMES][mode] / own[TIMES][mode]
        if len(ratios) == len(STRAIGHT):
            found[name] = ratios
    return found


TABLES: Mapping[str, Callable[[Results], str]] = {
    "machine": machine,
    "one pose": one_pose,
    "batches": batches,
    "forward": forward,
    "from Python": from_python,
    "limits": tables.page,
    "scaling": scaling,
    "cost model": cost_model.text,
    "every robot": every_robot,
}


IN_REPORT = {"scaling": "Poses and threads", "cost model": "Calls and joints", "every robot": "Every robot"}
"""Tables that the report shows as the page does, and their titles there."""


def sections(results: Results) -> list[str]:
    """Those of them that a run has figures for."""
    return [
        f"## {title}\n\n{TABLES[name](results)}"
        for name, title in IN_REPORT.items()
        if _is_measured(name, results)
    ]


def _is_measured(table: str, results: Results) -> bool:
    """Whether a run has figures for a table; one that it leaves out stays as it is."""
    languages = {row["language"] for row in results["rows"]}
    match table:
        case "machine":
            return True
        case "limits":
            return bool(results[table]["rows"])
        case "cost model":
            return bool(results["scaling"] or results["every robot"])
        case "scaling" | "every robot":
            return bool(results[table])
        case "from Python":
            return "Python" in languages
        case _:
            return "C" in languages


def _rows(results: Results, language: str) -> list[Row]:
    return [row for row in results["rows"] if row["language"] == language and "missing" not in row]


def _of(results: Results, key: str, name: str, language: str = "C") -> list[Row]:
    return [row for row in _rows(results, language) if (row["workload"], row["contender"]) == (key, name)]


def _times_of(row: Row) -> Mapping[str, float]:
    found: Mapping[str, float] = row.get(TIMES) or {}
    return found


def _best(rows: Iterable[Row], mode: str) -> Row | None:
    timed = [row for row in rows if mode in _times_of(row)]
    return min(timed, key=lambda row: float(row[TIMES][mode]), default=None)


def _text(row: Row | None) -> int:
    return int(row["text_bytes"] or 0) if row else 0


def _ns(row: Row | None, mode: str) -> str:
    return f"{row[TIMES][mode]:,.0f}" if row and mode in _times_of(row) else ""


def _times(row: Row | None, base: Row | None, mode: str, base_mode: str = "") -> str:
    if row is None or base is None or mode not in _times_of(row):
        return ""
    return f"{row[TIMES][mode] / base[TIMES][base_mode or mode]:.2f}"


def _table(head: Sequence[str], lines: Iterable[Sequence[str]]) -> str:
    rule = ["---", *["---:"] * (len(head) - 1)]
    return "\n".join(f"| {' | '.join(row)} |" for row in (head, rule, *lines)) + "\n"
