"""The tables of docs/performance.md, from what a run measured."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from benchmarks import summary
from benchmarks.contender import HAND, OURS


def row(
    contender: str, mode: str, low: float, layout: str | None = None, text: int | None = 100
) -> dict[str, Any]:
    """Medians are far from what is shown."""
    return {
        "workload": "w1",
        "language": "C",
        "contender": contender,
        "variant": "only",
        "layout": layout,
        "text_bytes": text,
        "tenth_percentile_ns": {mode: low},
        "median_ns": {mode: 1000 * low},
    }


@pytest.fixture
def results() -> dict[str, Any]:
    rows = [
        row(OURS, "batch", 20.0, "soa"),
        row(OURS, "throughput", 50.0),
        row(summary.LANES, "batch", 30.0, "soa"),
        row("SymPy", "throughput", 120.0),
        row(HAND, "throughput", 110.0),
        row("MuJoCo", "throughput", 900.0, text=None),
    ]
    return {"rows": rows, "scaling": [], "every robot": [], "limits": {"rows": []}, "warnings": []}


def test_batches_are_compared_with_peers_by_what_they_take_undisturbed(results: dict[str, Any]) -> None:
    """The hand-written yardstick is no peer."""
    assert "| W1 | structure of arrays | 20 | 1.50 | 6.00 |  |  |" in summary.batches(results)


def test_code_in_a_library_of_others_has_no_size(results: dict[str, Any]) -> None:
    lines = summary.one_pose(results).splitlines()
    (mujoco,) = (line for line in lines if line.startswith("| MuJoCo"))
    (sympy,) = (line for line in lines if line.startswith("| SymPy |"))
    assert mujoco.split("|")[2].strip() == "18.00"
    assert (mujoco.split("|")[-2].strip(), sympy.split("|")[-2].strip()) == ("", "1.00")


def test_the_report_has_what_was_measured_and_no_more(results: dict[str, Any]) -> None:
    assert summary.sections(results) == []
    results["scaling"] = [{"poses": n, "threads": 1, "undisturbed": 50 + 4000 / n} for n in (10, 1000)]
    poses, calls = summary.sections(results)
    assert "| 1,000 | 54 |" in poses
    assert "4.0 µs a call and 50 ns a pose" in calls


def test_tables_of_what_was_not_measured_stay(results: dict[str, Any], tmp_path: Path) -> None:
    page = tmp_path / "page.md"
    kept = "<!-- measured: scaling -->\n\nold\n\n<!-- end -->"
    page.write_text(f"Text.\n\n<!-- measured: batches -->\n\nold\n\n<!-- end -->\n\n{kept}\n")
    results["machine"] = {"processor": "x", "C compiler": "y"}
    summary.update(page, results)
    text = page.read_text()
    assert kept in text
    assert text.count("old") == 1
    assert "| 6.00 |" in text
