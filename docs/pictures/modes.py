"""Pictures of working modes and of assembly modes."""

from __future__ import annotations

import numpy as np
from linkages import FIVE_BAR, draw_flat, five_bar_points, linkage_plane
from matplotlib import pyplot
from matplotlib.figure import Figure
from sketches import HOME, INK, OUTSIDE, RADIAL, UPRIGHT, arrow

import krhpr
from krhpr.drawing import COLOURS, draw_joints, label, skeleton


def working_modes() -> Figure:
    """The eight working modes of one leg, in its linkage plane."""
    robot = krhpr.load("spatial_r_fivebar_a")
    figure, axes = pyplot.subplots(2, 4, figsize=(11.0, 6.6), sharex=True, sharey=True)
    for ax, mode in zip(axes.flat, robot.modes, strict=True):
        bones = skeleton(robot, HOME, UPRIGHT, RADIAL, mode)
        flat = linkage_plane(bones)
        x = np.array([1.0 if mode.startswith("front") else -1.0, 0.0])
        draw_flat(ax, flat)
        corner = np.array([-0.17, -0.25])
        arrow(ax, corner, 0.07 * x, "$x$")
        arrow(ax, corner, np.array([0.0, 0.07]), "$e_1$")
        angles = ", ".join(f"{value:.1f}°" for value in np.degrees(bones.theta[0]))
        ax.set_title(f"{mode}\n({angles})", fontsize=10)
        if ax is axes.flat[0]:
            for name, shift in {
                "c": (-11, 5),
                "S": (8, -3),
                "E": (8, -3),
                "C": (-14, -4),
                "P": (8, -3),
            }.items():
                label(ax, flat[name], f"${name}$", shift, leader=False, fontsize=10)
        ax.set_aspect("equal")
        ax.set_axis_off()
        ax.set_xlim(-0.29, 0.36)
        ax.set_ylim(-0.27, 0.38)
    figure.tight_layout(h_pad=2.5, w_pad=0.2)
    return figure


def assembly_modes() -> Figure:
    """The two assembly modes of one leg at the same actuated joints."""
    robot = krhpr.load("spatial_r_fivebar_a")
    theta = np.asarray(robot.inverse(HOME, UPRIGHT, RADIAL, mode=OUTSIDE))
    figure, axes = pyplot.subplots(1, 2, figsize=(9.0, 4.2), sharex=True, sharey=True)
    for ax, assembly in zip(axes, robot.assemblies, strict=True):
        s = np.asarray(robot.subleg_forward(theta, assembly))
        flat = five_bar_points(robot, theta[0], s[0])
        for kind, start, end in FIVE_BAR:
            ax.plot(*np.stack([flat[start], flat[end]]).T, color=COLOURS[kind], linewidth=3.4, zorder=2)
        ax.plot(*np.stack([flat["C"], flat["E"]]).T, color=INK, linewidth=1, linestyle=(0, (4, 3)), zorder=3)
        middle, along = (flat["C"] + flat["E"]) / 2, flat["E"] - flat["C"]
        ax.annotate(
            "", middle + 0.04 * along, middle - 0.04 * along, arrowprops={"arrowstyle": "-|>", "color": INK}
        )
        draw_joints(ax, np.stack(list(flat.values())))
        shifts = {"c": (-4, -16), "E": (-4, 9), "C": (-17, -4), "P": (-4, 9), "S": (10, -4)}
        if assembly == "right":
            shifts |= {"P": (8, -12), "S": (-4, 10), "E": (8, 2)}
        for name, shift in shifts.items():
            label(ax, flat[name], f"${name}$", shift, leader=False)
        ax.set_title(f'"{assembly}": $P$ lies {assembly} of $C \\to E$', fontsize=11)
        ax.set_aspect("equal")
        ax.set_axis_off()
        ax.margins(0.12)
    figure.tight_layout()
    return figure
