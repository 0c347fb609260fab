"""A trajectory as one picture: redundant coordinates, joints, rates and indices over time."""

from __future__ import annotations

from pathlib import Path as File
from typing import Any

import numpy as np

from krhpr.picture import STYLE
from krhpr.trajectory.optimise import Trajectory

COLOURS = ("#1b4f72", "#b03a2e", "#1e8449")
"""Of the legs."""
LINES = ("-", "--", ":", "-.")
"""Of a leg's actuators."""


def plot(found: Trajectory) -> Any:
    """A figure of four parts; where limits are not met the title says so."""
    from matplotlib import pyplot

    times, examined = found.times, found.examined
    angles = found.robot.signature("end_points").inputs[2].unit == "rad"
    factor, unit = (180 / np.pi, "deg") if angles else (1000.0, "mm")
    labels = found.robot.signature("inverse").outputs[0].labels
    with pyplot.rc_context(STYLE):
        figure, axes = pyplot.subplots(2, 2, figsize=(11, 7), layout="constrained", sharex=True)
        for leg, colour in enumerate(COLOURS):
            axes[0, 0].plot(times, factor * found.redundant[:, leg], color=colour, label=f"leg {leg + 1}")
            for k, name in enumerate(labels):
                line = {"color": colour, "linestyle": LINES[k % len(LINES)], "linewidth": 1.2}
                label = name if leg == 0 else None
                axes[0, 1].plot(times, found.theta[:, leg, k], label=label, **line)
                axes[1, 1].plot(times, examined.theta_rate[:, leg, k], **line)
        for name, style in zip(("eta_1", "eta_2", "eta_3"), LINES, strict=False):
            values = examined.indices[name]
            shown = {"eta_1": "$\\eta_1$ (m)", "eta_2": "$\\eta_2$", "eta_3": "$\\eta_3$"}[name]
            axes[1, 0].semilogy(times, values, color="#333333", linestyle=style, label=shown)
        titles = (f"redundant coordinates ({unit})", "joints (rad or m)", "indices", "rates of joints (1/s)")
        for ax, title in zip(axes.flat, titles, strict=True):
            ax.set_title(title, fontsize=10)
            ax.spines[["top", "right"]].set_visible(False)
            ax.grid(alpha=0.3)
        for ax in axes[1]:
            ax.set_xlabel("time (s)")
        for ax in (axes[0, 0], axes[0, 1], axes[1, 0]):
            ax.margins(y=0.2)
            ax.legend(fontsize=8, frameon=False, loc="upper left", ncols=3)
        verdict = "" if found.feasible else ": NOT feasible"
        figure.suptitle(f"{found.path.name}, {found.robot.name}, method {found.method}{verdict}", fontsize=12)
    return figure


def save_plot(found: Trajectory, file: File) -> File:
    """Write the picture; no date gets into it."""
    import matplotlib
    from matplotlib import pyplot

    matplotlib.use("Agg")
    figure = plot(found)
    metadata: dict[str, Any] = (
        {"Software": None} if file.suffix == ".png" else {"Date": None, "Creator": None}
    )
    try:
        figure.savefig(file, dpi=130, metadata=metadata)
    finally:
        pyplot.close(figure)
    return file
