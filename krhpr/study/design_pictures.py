"""Pictures of Section 4.2, Figs. 4.1 and 4.2, and of designs over the whole workspace."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from krhpr.design import Evaluation, Objective
from krhpr.design.front import front as front_of
from krhpr.picture import STYLE
from krhpr.study.enlargement import ALL, CASES, FREE, REACH, Case, Enlargement, Slice

Floats = NDArray[np.float64]

SHADES = ("#4477aa", "#228833", "#cc7711", "#b00020")
"""Of the four magnitudes."""
INDICES = ("#cc7711", "#228833", "#b00020")
INK, GREY = "#222222", "#bbbbbb"
DASHED = (0, (4, 2))
SCALES = (10.0, 1.0, 1.0)
"""eta_1 in metres over 100 mm, as the thesis draws it."""
NAMES = (r"$\eta_1 / 100$ mm", r"$\eta_2$", r"$\eta_3$")


def enlargement_figures(found: Enlargement) -> dict[str, Any]:
    """Figs. 4.1 and 4.2."""
    from matplotlib import pyplot

    with pyplot.rc_context({**STYLE, "font.size": 9}):
        return {"design_families": families(found), "design_slices": slices(found)}


def families(found: Enlargement) -> Any:
    """Fig. 4.1: the layer z = 350 mm above, tilts without torsion below; dashed without the limits of
    spherical joints."""
    from matplotlib import pyplot

    figure = pyplot.figure(figsize=(8.8, 6.4), layout="constrained")
    for column, case in enumerate(CASES):
        layer = figure.add_subplot(2, 3, column + 1)
        tilt: Any = figure.add_subplot(2, 3, column + 4, projection="polar")
        for reading, style in ((ALL, "-"), (FREE, DASHED)):
            of = found.found[case.name, reading]
            for number, (value, colour) in enumerate(zip(case.shown, SHADES, strict=True)):
                options: dict[str, Any] = {"color": colour, "linestyle": style}
                options |= {"linewidth": 1.5 if reading == ALL else 0.9}
                name = f"{value:g}" if reading == ALL else None
                layer_map, tilt_map = of.layers[number], of.tilts[number]
                if layer_map is not None:
                    r, theta = _closed(1e3 * layer_map["boundary"][0], layer_map.axis("theta_c"))
                    layer.plot(r * np.cos(theta), r * np.sin(theta), label=name, **options)
                if tilt_map is not None:
                    r, theta = _closed(np.degrees(tilt_map["boundary"][0]), tilt_map.axis("theta_c"))
                    tilt.plot(theta, r, **options)
        layer.set(aspect="equal", xlabel="x (mm)", ylabel="y (mm)", xlim=(-640, 640), ylim=(-640, 640))
        layer.spines[["top", "right"]].set_visible(False)
        layer.legend(
            title=case.label,
            frameon=False,
            fontsize=8,
            title_fontsize=9,
            loc="lower center",
            bbox_to_anchor=(0.5, 1.0),
            ncols=4,
            handlelength=1.2,
            columnspacing=1.2,
        )
        tilt.set_rlim(0, 180)
        tilt.set_rticks([45, 90, 135, 180], ["45°", "90°", "135°", ""], fontsize=7, color="#777777")
        tilt.set_rlabel_position(70)
        tilt.tick_params(axis="x", labelsize=7, pad=-2)
    return figure


def _closed(values: Floats, theta: Floats) -> tuple[Floats, Floats]:
    return np.append(values, values[:1]), np.append(theta, 2 * np.pi)


def slices(found: Enlargement) -> Any:
    """Fig. 4.2: the way along x above, the tilt about y' below, and the indices at the boundary."""
    from matplotlib import pyplot

    figure, rows = pyplot.subplots(2, 3, figsize=(9.6, 6.0), layout="constrained")
    for column, case in enumerate(CASES):
        for row, (part, unit) in enumerate((("along_x", 1e3), ("tilt", 180 / np.pi))):
            ax = rows[row, column]
            shown = {
                reading: getattr(found.found[case.name, reading], part) for reading in (ALL, FREE, REACH)
            }
            if part == "tilt":
                del shown[REACH]  # it goes all the way round
            _slice(ax, case, shown, unit)
            if column == len(CASES) - 1:
                ax.twin.set_ylabel("indices with all limits")
            if column == 0:
                ax.set_ylabel(("way along x (mm)", "tilt about y' (deg)")[row])
            if row == 1:
                ax.set_xlabel(case.label)
    handles = rows[0, 0].get_legend_handles_labels()
    more = rows[0, 0].twin.get_legend_handles_labels()
    figure.legend(
        [*handles[0], *more[0]], [*handles[1], *more[1]], loc="outside lower center", ncols=6, frameon=False
    )
    return figure


def _slice(ax: Any, case: Case, shown: dict[str, Slice], unit: float) -> None:
    styles: dict[str, Any] = {ALL: "-", FREE: DASHED, REACH: (0, (1, 1.5))}
    for reading, of in shown.items():
        at = of.values / case.unit
        ax.plot(at, unit * of.boundary, color=INK, linestyle=styles[reading], linewidth=1.4, label=reading)
    ax.set_ylim(0, 680 if unit == 1e3 else 185)
    ax.spines["top"].set_visible(False)
    ax.twin = twin = ax.twinx()
    first = shown[ALL]
    for number, (name, scale) in enumerate(zip(NAMES, SCALES, strict=True)):
        twin.plot(
            first.values / case.unit,
            scale * first.eta[:, number],
            color=INDICES[number],
            linewidth=1.2,
            marker="o",
            markersize=2.5,
            label=name,
        )
    twin.set_yscale("log")
    twin.set_ylim(0.5, 100)
    twin.spines["top"].set_visible(False)


# -- designs -------------------------------------------------------------------------------------------------

SIGNS = {Objective.VOLUME: r"volume of positions (m$^3$)", Objective.BOX: "edge of the cube (mm)"}
UNITS = {Objective.BOX: 1e3}


def _label(one: Objective) -> str:
    if one in SIGNS:
        return SIGNS[one]
    if one.value.startswith("eta"):
        unit = " (m)" if one.unit == "m" else ""
        return rf"largest $\eta_{one.value[-1]}${unit}"
    return one.words if one.unit == "1" else f"{one.words} ({one.unit})"


def front_figure(
    designs: Sequence[Evaluation],
    objectives: Sequence[Objective],
    marked: dict[str, Evaluation],
) -> dict[str, Any]:
    """All designs over the first two objectives, those of the front coloured by a third."""
    from matplotlib import pyplot

    with pyplot.rc_context({**STYLE, "font.size": 9}):
        return {"design_front": _front(designs, objectives, marked)}


def _front(
    designs: Sequence[Evaluation], objectives: Sequence[Objective], marked: dict[str, Evaluation]
) -> Any:
    from matplotlib import pyplot

    names = [*dict.fromkeys([*objectives, Objective.VOLUME, Objective.ETA_2, Objective.BOX])][:3]
    working = [one for one in designs if one.works]
    best = front_of(designs, objectives)

    def numbers(of: Sequence[Evaluation]) -> Floats:
        found = [[UNITS.get(name, 1.0) * one.results[name] for name in names] for one in of]
        return np.array(found, dtype=float).reshape(len(of), 3)

    figure, ax = pyplot.subplots(figsize=(7.2, 4.8), layout="constrained")
    every, of_front = numbers(working), numbers(best)
    ax.scatter(every[:, 0], every[:, 1], s=6, color=GREY, linewidths=0, label="designs")
    dots = ax.scatter(
        of_front[:, 0],
        of_front[:, 1],
        c=of_front[:, 2],
        s=26,
        cmap="viridis",
        edgecolors="white",
        linewidths=0.4,
        label="front",
    )
    for (name, one), marker in zip(marked.items(), "*^sDvP", strict=False):
        (at,) = numbers([one])
        style: dict[str, Any] = {"s": 120 if marker == "*" else 70, "facecolors": "none", "linewidths": 1.4}
        ax.scatter(*at[:2], marker=marker, edgecolors="#b00020", label=name.replace("_", " "), **style)
    ax.set(xlabel=_label(names[0]), ylabel=_label(names[1]))
    low, high = (np.quantile(every[:, 1], q) for q in (0.0, 0.97))
    ax.set_ylim(low - 0.05 * (high - low), high + 0.1 * (high - low))
    ax.spines[["top", "right"]].set_visible(False)
    figure.colorbar(dots, ax=ax, label=_label(names[2]))
    ax.legend(frameon=False, fontsize=8)
    return figure
