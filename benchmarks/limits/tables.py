"""Tables of instructions, operations and limits, from what results.json says."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

Found = Mapping[str, Any]

FORMS = {
    ("throughput", "aos"): "one pose",
    ("batch", "blocked8"): "batch, blocks of eight",
    ("batch", "soa"): "batch, structure of arrays",
    ("batch", "aos"): "batch, array of structures",
}
HEAD = (
    "",
    "",
    "ns",
    "operations",
    "instructions",
    "at AVX2 (callgrind)",
    "share of the ports",
    "busiest",
    "share of the operations",
)


def page(results: Found) -> str:
    """The quickest of every name in every form: those that callgrind counted."""
    limits = results["limits"]
    rows = [row for row in limits["rows"] if row["callgrind"] is not None] or _quickest(limits["rows"])
    return f"{peaks(limits['peaks'])}\n{table(rows)}"


def section(limits: Found) -> str:
    """Everything, for the report."""
    notes = "".join(f"* {note}\n" for note in limits["notes"])
    if limits["peaks"] is None:
        return f"## Limits\n\n{notes}"
    return f"## Limits\n\n{notes}\n{peaks(limits['peaks'])}\n{table(limits['rows'])}"


def peaks(found: Found) -> str:
    """What the processor does at most."""
    vector = ", ".join(f"{rate:.1f} of {width} bits" for width, rate in found["vector"].items())
    return (
        f"Measured peaks per nanosecond: {found['flops']:.0f} operations; vector instructions: {vector}; "
        f"{found['instructions']:.1f} instructions of any kind.\n"
    )


def table(rows: Iterable[Found]) -> str:
    """One line for each contender and form."""
    lines = [_line(row) for row in rows]
    rule = ["---", "---", *["---:"] * (len(HEAD) - 2)]
    return "\n".join(f"| {' | '.join(line)} |" for line in (HEAD, rule, *lines)) + "\n"


def _line(row: Found) -> Sequence[str]:
    return (
        row["workload"].upper() + ", " + FORMS[row["mode"], row["layout"]],
        f"{row['contender']}, {row['variant']}",
        f"{row['ns']:,.0f}",
        f"{row['flops']:,.0f}",
        f"{row['instructions']:,.0f}",
        "" if row["callgrind"] is None else f"{row['callgrind']:,.0f}",
        f"{100 * row['share_of_ports']:.0f} %",
        row["least_ns"]["busiest"],
        f"{100 * row['share_of_operations']:.0f} %",
    )


def _quickest(rows: Sequence[Found]) -> list[Found]:
    best: dict[tuple[str, ...], Found] = {}
    for row in rows:
        key = (row["workload"], row["mode"], row["layout"], row["contender"])
        if key not in best or row["ns"] < best[key]["ns"]:
            best[key] = row
    return list(best.values())
