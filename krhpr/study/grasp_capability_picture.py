"""The picture of the grasp capability: the largest grasping force, and the largest moment that is
resisted."""

from __future__ import annotations

from typing import Any

import numpy as np

from krhpr.picture import STYLE
from krhpr.study.grasp_capability import CapabilityStudy

INK = "#222222"


def picture(found: CapabilityStudy) -> Any:
    """A figure with a map for each; grey is out of reach or beyond a singularity."""
    from matplotlib import pyplot
    from matplotlib.ticker import MaxNLocator

    turns = np.broadcast_to(np.degrees(found.turns), found.heights.shape)
    with pyplot.rc_context(STYLE):
        figure, axes = pyplot.subplots(1, 2, figsize=(11, 4.2), layout="constrained", sharey=True)
        for ax, values, title, unit in zip(
            axes,
            (found.made.most, found.moment),
            ("largest grasping force", "largest moment about the mass centre, either way"),
            ("N", "N m"),
            strict=True,
        ):
            held = np.where(np.isfinite(values), values, 0.0)  # on the edge nothing is
            levels = MaxNLocator(10).tick_values(0.0, held.max())
            shown = ax.contourf(turns, 1e3 * found.heights, held, levels, cmap="viridis")
            ax.plot(0, 1e3 * found.setup.pivot[1], "o", color="white", markeredgecolor=INK, markersize=6)
            ax.set_title(title, fontsize=10)
            ax.set_xlabel("turn of the jaws (degrees)")
            ax.set_xticks(range(-180, 181, 60))
            ax.set_facecolor("#f4f4f4")
            figure.colorbar(shown, ax=ax, label=unit)
        axes[0].set_ylabel("height of the pivot (mm)")
        what = found.setup.held
        told = f"An object of {what.weight:g} N, friction {what.friction:g}, motors of"
        figure.suptitle(f"{told} {1e3 * found.torque:g} mN m", fontsize=11)
    return figure
