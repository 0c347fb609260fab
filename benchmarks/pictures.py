"""Pictures of a run: how many times slower the peers are, and how time grows with poses and threads."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import matplotlib
from matplotlib import pyplot
from matplotlib.axes import Axes

from benchmarks import summary
from benchmarks.contender import OURS

matplotlib.use("Agg")

DOTS_PER_INCH = 150
COLOURS = ("#1b6ca8", "#e08e0b", "#4c9f70", "#8e5ea2", "#777777", "#c0504d")


def draw(results: summary.Results, folder: Path) -> list[Path]:
    """Write the pictures that the results have figures for, and say where."""
    folder.mkdir(parents=True, exist_ok=True)
    made = []
    if summary.slower(results, "throughput"):
        made.append(_peers(results, folder / "performance_peers.png"))
    if results["scaling"]:
        made.append(_scaling(results["scaling"], folder / "performance_scaling.png"))
    return made


def _peers(results: summary.Results, path: Path) -> Path:
    modes = {"throughput": "one pose", "latency": "each call waits for the last"}
    figure, axes = pyplot.subplots(1, len(modes), figsize=(10, 3.6), sharey=True)
    for ax, (mode, title) in zip(axes, modes.items(), strict=True):
        _bars(ax, summary.slower(results, mode), title)
    axes[0].set_ylabel("times slower than krhpr")
    axes[0].legend(frameon=False, fontsize=8, ncol=2, loc="upper left")
    figure.suptitle(
        "W1 Jacobians, W2 inverse kinematics, W5 hybrid legs: others' best form against ours", fontsize=10
    )
    return _write(figure, path)


def _bars(ax: Axes, ratios: Mapping[str, Mapping[str, float]], title: str) -> None:
    width = 0.8 / max(len(ratios), 1)
    for index, (peer, by_workload) in enumerate(ratios.items()):
        places = [k + index * width for k in range(len(by_workload))]
        ax.bar(places, list(by_workload.values()), width, label=peer, color=COLOURS[index % len(COLOURS)])
    ax.axhline(1, color="#222222", linewidth=1)
    ax.set_xticks([k + 0.4 - width / 2 for k in range(len(summary.STRAIGHT))])
    ax.set_xticklabels([summary.TITLES[key] for key in summary.STRAIGHT])
    ax.set_title(title, fontsize=10)
    ax.set_ylim(0, 6)
    for side in ("top", "right"):
        ax.spines[side].set_visible(False)


def _scaling(points: Sequence[Mapping[str, Any]], path: Path) -> Path:
    figure, ax = pyplot.subplots(figsize=(6.4, 3.6))
    for index, threads in enumerate(sorted({point["threads"] for point in points})):
        line = [(point["poses"], point["undisturbed"]) for point in points if point["threads"] == threads]
        name = "one thread" if threads == 1 else f"{threads} threads"
        ax.loglog(*zip(*line, strict=True), "o-", label=name, color=COLOURS[index % len(COLOURS)])
    ax.set_xlabel("poses in one call")
    ax.set_ylabel("nanoseconds per pose")
    ax.set_title(f"{OURS}: inverse kinematics from Python, out= given", fontsize=10)
    ax.grid(which="both", alpha=0.25)
    ax.legend(frameon=False)
    return _write(figure, path)


def _write(figure: Any, path: Path) -> Path:
    figure.tight_layout()
    figure.savefig(path, dpi=DOTS_PER_INCH)
    pyplot.close(figure)
    return path
