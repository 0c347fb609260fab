"""Figures of the studies of Sections 1.8 and 4.3."""

from __future__ import annotations

from typing import Any

import numpy as np

from krhpr.picture import STYLE
from krhpr.study.dexterity import Dexterity
from krhpr.study.redundancy import DEGREES, SHOWN, Redundancy
from krhpr.trajectory import Method

COLOURS = ("#1b4f72", "#b03a2e", "#1e8449")
"""Of legs, and of indices."""
INK = "#333333"
NAMES = {"eta_1": r"$\eta_1$", "eta_2": r"$\eta_2$", "eta_3": r"$\eta_3$"}


def _axes(columns: int, size: tuple[float, float], **options: Any) -> tuple[Any, Any]:
    from matplotlib import pyplot

    figure, axes = pyplot.subplots(1, columns, figsize=size, layout="constrained", **options)
    for ax in np.ravel(axes):
        ax.spines[["top", "right"]].set_visible(False)
        ax.grid(alpha=0.3)
        ax.set_axisbelow(True)
    return figure, axes


# -- Section 1.8 ---------------------------------------------------------------------------------------------


def dexterity_figures(found: Dexterity) -> dict[str, Any]:
    """Figs. 1.10 to 1.12."""
    from matplotlib import pyplot

    with pyplot.rc_context(STYLE):
        return {"dexterity_ranges": _ranges(found), "dexterity_indices": _dexterity_indices(found)}


def _ranges(found: Dexterity) -> Any:
    figure, ax = _axes(1, (7.0, 3.6))
    for leg, colour in enumerate(COLOURS):
        at = np.arange(3) + 0.27 * (leg - 1)
        bars = ax.bar(at, np.degrees(found.ranges[leg]), 0.25, color=colour, label=f"leg {leg + 1}")
        ax.bar_label(bars, fmt="%.2f", fontsize=8, padding=1)
    ax.axhline(60, color=INK, linewidth=0.8, linestyle="--")
    ax.set_xticks(np.arange(3), [rf"$\theta_{{i{j + 1}}}$" for j in range(3)])
    ax.set_ylabel("degrees")
    ax.set_title("Absolute motion range of the nine actuators (Fig. 1.10)", fontsize=11)
    ax.margins(y=0.12)
    ax.legend(fontsize=8, frameon=False, ncols=3, loc="upper left")
    return figure


def _dexterity_indices(found: Dexterity) -> Any:
    figure, (left, right) = _axes(2, (11.0, 3.8))
    for leg, colour in enumerate(COLOURS):
        left.plot(found.condition[:, leg], color=colour, linewidth=1.2, label=rf"$\mathbf{{M}}_{leg + 1}$")
    left.plot(found.condition_of_all, color=INK, linewidth=1.2, linestyle="--", label=r"$\mathbf{J}_1$")
    left.set_title("Condition numbers (Fig. 1.11)", fontsize=11)
    right.plot(found.position, color=COLOURS[0], label=r"position, $\eta_1$ (m)")
    right.plot(found.rotation, color=COLOURS[1], label=r"rotation, $\eta_2$")
    right.set_title("Kinematic sensitivity (Fig. 1.12)", fontsize=11)
    for ax in (left, right):
        ax.set_xlabel("configuration")
        ax.set_ylim(bottom=0)
        ax.margins(x=0)
        ax.legend(fontsize=8, frameon=False, ncols=2)
    return figure


# -- Section 4.3 ---------------------------------------------------------------------------------------------


def redundancy_figures(found: Redundancy) -> dict[str, Any]:
    """Figs. 4.3 and 4.4, and the angles that the programme finds."""
    from matplotlib import pyplot

    with pyplot.rc_context(STYLE):
        return {
            "redundancy_best": _best(found),
            "redundancy_minima": _minima(found),
            "redundancy_programme": _programme(found),
        }


def _best(found: Redundancy) -> Any:
    figure, axes = _axes(2, (11.0, 3.8), sharey=True)
    motions = (
        (found.translation, 1000 * found.translation.place, "x (mm)", "Translation (Fig. 4.3a)"),
        (found.tilt, np.degrees(found.tilt.place), r"tilt $\phi$ (degrees)", "Rotation (Fig. 4.3b)"),
    )
    for ax, (sweep, place, unit, title) in zip(axes, motions, strict=True):
        for (index, name), colour in zip(NAMES.items(), COLOURS, strict=True):
            ax.plot(place, sweep.best(index), color=colour, label=f"least {name}")
        ax.set_title(title, fontsize=11)
        ax.set_xlabel(unit)
        ax.margins(x=0)
    axes[0].set_ylabel(r"$\beta_1 = \beta_2 = \beta_3$ (degrees)")
    axes[0].legend(fontsize=8, frameon=False)
    return figure


def _minima(found: Redundancy) -> Any:
    from matplotlib import colormaps

    figure, (left, right) = _axes(2, (11.0, 4.0))
    sweep = found.translation
    for place, shade in zip(SHOWN, np.linspace(0.15, 0.9, len(SHOWN)), strict=True):
        row = sweep.indices["eta_1"][int(np.abs(sweep.place - place).argmin())]
        colour = colormaps["viridis"](shade)
        left.plot(DEGREES, 10 * row, color=colour, linewidth=1.3, label=f"x = {1000 * place:g} mm")
        at = sweep.minima("eta_1", place)
        left.plot(at, 10 * row[np.searchsorted(DEGREES, at)], "o", color=colour, markersize=4)
    left.set_ylim(3.0, 4.3)
    left.set_xlabel(r"$\beta_1 = \beta_2 = \beta_3$ (degrees)")
    left.set_ylabel(r"$\eta_1 / 100$ (mm)")
    left.set_title(r"Minima of $\eta_1$ (Fig. 4.4a)", fontsize=11)
    styles = {"least eta_1": (INK, "-"), "method one": (COLOURS[1], "--")}
    shades = iter(np.linspace(0.2, 0.85, len(found.filtered) - len(styles)))
    labels = {"least eta_1": r"least $\eta_1$", "method one": "method one, 140 to 160 degrees"}
    for name, values in found.filtered.items():
        colour, line = styles[name] if name in styles else (colormaps["viridis"](next(shades)), "-")
        text = labels.get(name, name.replace("alpha", r"$\alpha$ ="))
        right.plot(1000 * sweep.place, values, color=colour, linestyle=line, linewidth=1.2, label=text)
    right.set_xlim(200, 300)
    right.set_xlabel("x (mm)")
    right.set_ylabel("degrees")
    right.set_title(r"Filtered $\beta_i$ (Fig. 4.4b)", fontsize=11)
    for ax in (left, right):
        ax.legend(fontsize=7, frameon=False, ncols=2 if ax is left else 1)
    return figure


def _programme(found: Redundancy) -> Any:
    figure, axes = _axes(2, (11.0, 3.9), sharey=True)
    for ax, (path, objective) in zip(axes, (("T1", "eta_1"), ("T2", "eta_2")), strict=True):
        of = found.compared[path, objective]
        scan, best = of[Method.SCAN], of[Method.NLP]
        ax.plot(scan.times, np.degrees(scan.redundant[:, 0]), color=INK, linewidth=1, label="scan, equal")
        for leg, colour in enumerate(COLOURS):
            values = np.degrees(best.redundant[:, leg])
            ax.plot(best.times, values, color=colour, label=rf"programme, $\beta_{leg + 1}$")
        ax.set_title(f"{path}, least integral of {NAMES[objective]}$^2$", fontsize=11)
        ax.set_xlabel("time (s)")
        ax.margins(x=0)
    axes[0].set_ylabel("degrees")
    axes[0].legend(fontsize=8, frameon=False)
    return figure
