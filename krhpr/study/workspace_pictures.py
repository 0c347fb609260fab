"""Pictures of the workspaces: Figs. 1.6 to 1.9, with Matplotlib."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from krhpr.study.workspace import WorkspaceStudy
from krhpr.workspace import Stop, Workspace

Floats = NDArray[np.float64]

STYLE: Any = {
    "font.family": "DejaVu Sans",
    "mathtext.fontset": "dejavusans",
    "font.size": 10,
    "figure.facecolor": "white",
    "savefig.facecolor": "white",
}
COLOURS = {
    Stop.REACH: "#222222",
    Stop.AXIS: "#b00020",
    Stop.ELBOW: "#4477aa",
    Stop.SPHERICAL: "#228833",
    Stop.BODIES: "#cc7711",
}
OTHER = "#777777"


def _closed(values: Floats) -> Floats:
    """Round to where it began."""
    return np.concatenate([values, values[..., :1]], axis=-1)


def _colours(made: Workspace) -> Any:
    lookup = [COLOURS.get(Stop(code), OTHER) for code in range(len(Stop))]
    return np.array(lookup, dtype=object)[made["stops"].astype(int)]


def _legend(ax: Any, made: Workspace, **options: Any) -> None:
    from matplotlib.lines import Line2D

    kinds = [Stop(int(code)) for code in np.unique(made["stops"]) if code != Stop.NONE]
    handles = [
        Line2D([], [], color=COLOURS.get(kind, OTHER), linewidth=2.5, label=kind.words) for kind in kinds
    ]
    ax.legend(handles=handles, frameon=False, fontsize=8, **options)


def layers(found: WorkspaceStudy) -> Any:
    """Fig. 1.6: the boundary of each layer, coloured by what stops the platform there."""
    from matplotlib import pyplot
    from mpl_toolkits.mplot3d.art3d import Line3DCollection

    made = found.layers
    heights, theta = made.axis("h"), _closed(made.axis("theta_c"))
    figure = pyplot.figure(figsize=(7.2, 5.6))
    ax: Any = figure.add_axes((0.0, 0.0, 1.0, 1.0), projection="3d")
    colours = _colours(made)
    for row, height in enumerate(heights):
        r = 1e3 * _closed(made["boundary"][row])
        points = np.stack([r * np.cos(theta), r * np.sin(theta), np.full(len(r), 1e3 * height)], axis=-1)
        pieces = np.stack([points[:-1], points[1:]], axis=1)
        ax.add_collection3d(Line3DCollection(pieces, colors=colours[row], linewidths=1.6))
    most = 1.05e3 * np.nanmax(made["boundary"])
    ax.set(xlim=(-most, most), ylim=(-most, most), zlim=(0, 1e3 * heights[-1]))
    ax.set(xlabel="x (mm)", ylabel="y (mm)", zlabel="z (mm)")
    ax.set_box_aspect((1, 1, 0.62))
    _legend(ax, made, loc="upper left")
    return figure


def top(found: WorkspaceStudy) -> Any:
    """Fig. 1.7: the layers from above."""
    from matplotlib import pyplot

    made = found.layers
    heights, theta = made.axis("h"), _closed(made.axis("theta_c"))
    figure, ax = pyplot.subplots(figsize=(6.2, 5.6), layout="constrained")
    shades = pyplot.get_cmap("viridis")(np.linspace(0.05, 0.92, len(heights)))
    for row, height in enumerate(heights):
        r = 1e3 * _closed(made["boundary"][row])
        ax.plot(
            r * np.cos(theta),
            r * np.sin(theta),
            color=shades[row],
            linewidth=1.3,
            label=f"{1e3 * height:.0f}",
        )
    ax.set(aspect="equal", xlabel="x (mm)", ylabel="y (mm)")
    ax.spines[["top", "right"]].set_visible(False)
    ax.legend(
        title="z (mm)",
        frameon=False,
        fontsize=8,
        title_fontsize=8,
        loc="center left",
        bbox_to_anchor=(1, 0.5),
    )
    return figure


def orientations(found: WorkspaceStudy) -> Any:
    """Fig. 1.8: torsion upwards, tilt outwards, about the direction of the axis of tilt."""
    from matplotlib import pyplot
    from matplotlib.colors import to_rgb

    made = found.tilts
    every = max(1, len(made.axis("theta_c")) // 180)
    theta, r = _closed(made.axis("theta_c")[::every]), np.degrees(_closed(made["boundary"][:, ::every]))
    psi = np.degrees(made.axis("psi"))[:, None] + 0 * r
    colours = np.array([[to_rgb(c) for c in row] for row in _closed(_colours(made)[:, ::every])])
    shade = 0.72 + 0.28 * np.cos(theta - np.radians(230))[None, :, None]
    figure = pyplot.figure(figsize=(6.6, 5.6))
    ax: Any = figure.add_axes((-0.04, 0.0, 1.0, 1.0), projection="3d")
    ax.plot_surface(
        r * np.cos(theta),
        r * np.sin(theta),
        psi,
        facecolors=np.clip(colours * shade, 0, 1),
        rcount=100,
        ccount=120,
        linewidth=0,
        antialiased=False,
        shade=False,
    )
    ax.set(
        xlabel=r"$\phi\cos\theta_c$ (deg)", ylabel=r"$\phi\sin\theta_c$ (deg)", zlabel=r"torsion $\psi$ (deg)"
    )
    ax.set_box_aspect((1, 1, 0.9))
    ax.view_init(elev=20, azim=-60)
    _legend(ax, made, loc="upper left")
    return figure


def level(found: WorkspaceStudy) -> Any:
    """Fig. 1.9: the section without torsion."""
    from matplotlib import pyplot
    from matplotlib.collections import LineCollection

    made = found.level
    theta, r = _closed(made.axis("theta_c")), np.degrees(_closed(made["boundary"][0]))
    figure = pyplot.figure(figsize=(5.6, 5.4), layout="constrained")
    ax: Any = figure.add_subplot(projection="polar")
    points = np.stack([theta, r], axis=-1)
    points[-1, 0] = 2 * np.pi
    pieces = np.stack([points[:-1], points[1:]], axis=1)
    ax.fill(theta, r, color="#eeeeee")
    ax.add_collection(LineCollection(list(pieces), colors=list(_colours(made)[0]), linewidths=2.2))
    ax.set_rlim(0, 180)
    ax.set_rticks([45, 90, 135, 180], ["45°", "90°", "135°", "180°"], fontsize=8)
    ax.set_rlabel_position(100)
    _legend(ax, made, loc="lower left", bbox_to_anchor=(-0.08, -0.08))
    return figure


def convergence(found: WorkspaceStudy) -> Any:
    """Both volumes and their errors by the width of steps."""
    from matplotlib import pyplot

    figure, axes = pyplot.subplots(1, 2, figsize=(8.0, 3.2), layout="constrained")
    steps = [one.times for one in found.refinements]
    for ax, measures, label in (
        (axes[0], [one.positions for one in found.refinements], r"volume of positions (m$^3$)"),
        (axes[1], [one.orientations for one in found.refinements], "share of all orientations"),
    ):
        values = [one.value for one in measures]
        ax.errorbar(
            steps,
            values,
            [one.error for one in measures],
            color=COLOURS[Stop.ELBOW],
            marker="o",
            markersize=4,
            linewidth=1,
            capsize=3,
        )
        ax.axhline(values[0], color=OTHER, linewidth=0.8, linestyle=(0, (4, 3)))
        ax.set(xlabel="steps (mm and degrees)", ylabel=label, xlim=(0, 1.05 * steps[-1]))
        ax.spines[["top", "right"]].set_visible(False)
    return figure


PICTURES: dict[str, Callable[[WorkspaceStudy], Any]] = {
    "workspace_layers": layers,
    "workspace_top": top,
    "workspace_orientations": orientations,
    "workspace_level": level,
    "workspace_convergence": convergence,
}
"""By the names of their files."""


def workspace_figures(found: WorkspaceStudy) -> dict[str, Any]:
    """Every figure by the name of its file."""
    from matplotlib import pyplot

    with pyplot.rc_context(STYLE):
        return {name: picture(found) for name, picture in PICTURES.items()}
