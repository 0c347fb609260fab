"""Histograms of the accuracy study as in Figs. 3.8 to 3.11, as numbers and as pictures."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from krhpr.picture import STYLE
from krhpr.study.forward_accuracy import APPROACHES, Accuracy

Floats = NDArray[np.float64]

COLOURS = ("#1b4f72", "#5dade2", "#b03a2e", "#e59866", "#1e8449", "#d4ac0d", "#82e0aa")
"""Of the approaches."""


@dataclass(frozen=True)
class Histogram:
    """How many values of each series fall into each range; the last range has no upper bound, where it is
    infinite.
    """

    name: str
    title: str
    unit: str
    series: tuple[str, ...]
    edges: Floats
    counts: NDArray[np.int64]
    """(series, ranges)."""

    @property
    def ranges(self) -> list[str]:
        """The ranges as text."""
        texts = []
        for low, high in zip(self.edges[:-1], self.edges[1:], strict=True):
            texts.append(f"> {low:g}" if np.isinf(high) else f"{low:g} - {high:g}")
        return texts


def histograms(found: Accuracy) -> tuple[Histogram, ...]:
    """Encoder errors of the first leg, e_p, e_oc and e_on."""
    largest = np.abs(found.encoder_errors).max()
    size = 0.005 if largest <= 0.005 else float(np.ceil(largest * 1000) / 1000)
    joints = ("joint 1", "joint 2", "joint 3", "redundant joint")
    errors = np.round(np.linspace(-size, size, 11), 6)
    position = np.append(np.arange(0, 4.1, 0.5), np.inf)
    turn = np.append(np.round(np.arange(0, 0.0351, 0.005), 6), np.inf)
    return (
        _histogram(
            "encoders",
            "Encoder errors of the first leg (Fig. 3.8)",
            "rad",
            joints,
            errors,
            found.encoder_errors,
        ),
        _histogram(
            "position",
            "Errors of the position, e_p (Fig. 3.9)",
            "mm",
            APPROACHES,
            position,
            1e3 * found.position,
        ),
        _histogram(
            "orientation",
            "Errors of the orientation as computed, e_oc (Fig. 3.10)",
            "",
            APPROACHES,
            turn,
            found.raw,
        ),
        _histogram(
            "orthonormal",
            "Errors of the orientation made a rotation, e_on (Fig. 3.11)",
            "",
            APPROACHES,
            turn,
            found.orthonormal,
        ),
    )


def _histogram(
    name: str, title: str, unit: str, series: Sequence[str], edges: Floats, values: Floats
) -> Histogram:
    counts = np.stack([np.histogram(row, edges)[0] for row in values])
    return Histogram(name, title, unit, tuple(series), edges, counts)


def picture(one: Histogram) -> Any:
    """A figure: for each range a group of bars, each with its number."""
    from matplotlib import pyplot

    with pyplot.rc_context(STYLE):
        figure, ax = pyplot.subplots(figsize=(11, 4.6), layout="constrained")
        count, groups = len(one.series), np.arange(len(one.ranges))
        width = 0.86 / count
        for k, (name, row) in enumerate(zip(one.series, one.counts, strict=True)):
            bars = ax.bar(groups + (k - (count - 1) / 2) * width, row, width, label=name, color=COLOURS[k])
            ax.bar_label(
                bars, fontsize=5.5, padding=1, rotation=90, labels=[str(x) if x else "" for x in row]
            )
        ax.set_xticks(groups, one.ranges, fontsize=8)
        ax.set_xlabel(f"range{f' ({one.unit})' if one.unit else ''}")
        ax.set_ylabel("configurations")
        ax.set_title(one.title, fontsize=11)
        ax.margins(y=0.12)
        ax.spines[["top", "right"]].set_visible(False)
        ax.legend(fontsize=8, frameon=False, ncols=1 if count > 4 else 2)
    return figure


def accuracy_figures(found: Accuracy) -> dict[str, Any]:
    """Every histogram's figure by the name of its picture."""
    return {f"accuracy_{one.name}": picture(one) for one in histograms(found)}
