"""The picture of the grasp study: forces of the actuators and torques of the motors over time."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from krhpr.picture import STYLE
from krhpr.study.grasp import GraspStudy

COLOURS = ("#1b4f72", "#5dade2", "#b03a2e", "#f1948a")
"""Of the actuators: those of the right sub-leg blue, those of the left one red."""


def picture(found: GraspStudy) -> Any:
    """A figure with a column for each motion: dashed without weight, full with it."""
    from matplotlib import pyplot

    motions = list(dict.fromkeys(one.motion.name for one in found.along))
    with pyplot.rc_context(STYLE):
        figure, axes = pyplot.subplots(
            2, len(motions), figsize=(4 * len(motions), 6), layout="constrained", sharex=True, squeeze=False
        )
        for one in found.along:
            column = motions.index(one.motion.name)
            heavy = one.weight > 0
            for index in range(4):
                leg, n = divmod(index, 2)
                style = {"color": COLOURS[index], "linestyle": "-" if heavy else "--", "linewidth": 1.3}
                label = f"$\\rho_{index + 1}$" if heavy else None
                axes[0, column].plot(one.times, one.forces[:, leg, n], label=label, **style)
                axes[1, column].plot(one.times, 1e3 * one.torques[:, leg, n], **style)
        for column, name in enumerate(motions):
            axes[0, column].set_title(name, fontsize=10)
            axes[1, column].set_xlabel("time (s)")
        axes[0, 0].set_ylabel("actuator forces (N)")
        axes[1, 0].set_ylabel("motor torques (mN m)")
        for ax in axes.flat:
            ax.spines[["top", "right"]].set_visible(False)
            ax.grid(alpha=0.3)
        axes[0, -1].legend(fontsize=8, frameon=False, ncols=4, loc="upper right")
        axes[0, -1].margins(y=0.25)
        held = found.setup.held
        figure.suptitle(
            f"Grasping with {found.setup.force:g} N: an object of {held.weight:g} N (full), without weight "
            "(dashed)",
            fontsize=11,
        )
    return figure


def save_picture(found: GraspStudy, path: Path) -> Path:
    """Write the picture; no date gets into it."""
    import matplotlib
    from matplotlib import pyplot

    matplotlib.use("Agg")
    figure = picture(found)
    metadata: dict[str, Any] = (
        {"Software": None} if path.suffix == ".png" else {"Date": None, "Creator": None}
    )
    try:
        figure.savefig(path, dpi=150, metadata=metadata)
    finally:
        pyplot.close(figure)
    return path
