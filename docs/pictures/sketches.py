"""What the pictures share: poses, colours, arrows, arcs and boxes."""

from __future__ import annotations

from itertools import product
from typing import Any

import numpy as np
from matplotlib.patches import Arc

from krhpr.drawing import label

GREY, INK, ALERT = "#777777", "#222222", "#b00020"

HOME = np.array([0.0, 0.0, 0.35])
UPRIGHT = np.eye(3)
RADIAL = np.radians([97.0, 97.0, 97.0])
"""Section 1.8: the reference pose."""

OUTSIDE = "front/elbow-/rod-"
"""The working mode of the five-bar legs with the upper crank outside and the linkage a parallelogram."""

Point = Any


def line_of_sight(elevation: float, azimuth: float) -> Point:
    """From the scene to the eye."""
    e, a = np.radians([elevation, azimuth])
    return np.array([np.cos(e) * np.cos(a), np.cos(e) * np.sin(a), np.sin(e)])


def wire_box(ax: Any, low: float, high: float, sight: Point) -> None:
    """The edges of a cube and its faces, lightly filled; those away from the eye are dashed."""
    bounds = (low, high)
    for axis in range(3):
        others = [other for other in range(3) if other != axis]
        for a, b in product((0, 1), repeat=2):
            ends = np.empty((2, 3))
            ends[:, others[0]], ends[:, others[1]], ends[:, axis] = bounds[a], bounds[b], bounds
            away = all((sight[other] > 0) != (side == 1) for other, side in zip(others, (a, b), strict=True))
            style = (0, (3, 2)) if away else "-"
            ax.plot(
                *ends.T,
                color="#00714f",
                linewidth=1.2 if away else 2.0,
                linestyle=style,
                zorder=2 if away else 4,
            )


def turn(angle: float) -> Point:
    """The unit vector at an angle."""
    return np.array([np.cos(angle), np.sin(angle)])


def angle(vector: Point) -> float:
    """The angle of a vector."""
    return float(np.arctan2(vector[1], vector[0]))


def arrow(ax: Any, start: Point, along: Point, text: str, colour: str = INK) -> None:
    ax.annotate(
        "",
        start + along,
        start,
        arrowprops={"arrowstyle": "-|>", "color": colour, "shrinkA": 0, "shrinkB": 0},
    )
    if text:
        size = float(np.linalg.norm(along))
        label(
            ax,
            start + along * (1 + 0.028 / size),
            text,
            (0, 0),
            leader=False,
            ha="center",
            va="center",
            color=colour,
        )


def arc(ax: Any, centre: Point, radius: float, start: float, end: float, text: str, away: float) -> None:
    """The arc of an angle from `start` to `end` in radians, with an arrow head at `end`."""
    low, high = sorted((start, end))
    ax.add_patch(
        Arc(
            centre,
            2 * radius,
            2 * radius,
            theta1=np.degrees(low),
            theta2=np.degrees(high),
            color=INK,
            linewidth=1,
        )
    )
    step = 0.14 if end > start else -0.14
    ax.annotate(
        "",
        centre + radius * turn(end),
        centre + radius * turn(end - step),
        arrowprops={"arrowstyle": "-|>", "color": INK, "shrinkA": 0, "shrinkB": 0, "mutation_scale": 9},
    )
    label(
        ax,
        centre + (radius + away) * turn((start + end) / 2),
        text,
        (0, 0),
        leader=False,
        ha="center",
        va="center",
    )
