"""Pictures of robots and sub-legs with their names."""

from __future__ import annotations

from typing import Any

import numpy as np
from linkages import attachment
from matplotlib import pyplot
from matplotlib.figure import Figure
from sketches import GREY, HOME, OUTSIDE, RADIAL, UPRIGHT, angle, arc, turn

import krhpr
from krhpr.derivations.catalogue import SUBLEGS
from krhpr.drawing import COLOURS, draw, draw_frame, label, skeleton
from krhpr.picture import VIEW, draw_leg, picture


def flagship() -> Figure:
    """3-[R(RR-RRR)SR] at the reference pose, with the names of Chapter 1."""
    robot = krhpr.load("spatial_r_fivebar_a")
    figure = pyplot.figure(figsize=(9.0, 6.0))
    ax = figure.add_axes((-0.02, -0.28, 1.0, 1.52), projection="3d")
    ax.view_init(elev=30, azim=-84)
    draw(robot, HOME, UPRIGHT, RADIAL, OUTSIDE, ax, labels=False)
    bones = skeleton(robot, HOME, UPRIGHT, RADIAL, OUTSIDE)
    draw_frame(ax, (0, 0, 0), UPRIGHT, 0.09, ("$x$", "$y$", "$z$"))
    draw_frame(ax, HOME, UPRIGHT, 0.075, ("", "", "$z'$"))
    label(ax, (0, 0, 0), "$O$", (-14, -12), leader=False)
    label(ax, HOME, "platform frame $O'x'y'z'$", (44, 70), ha="center", fontsize=10)
    offsets = {
        "A": ((-36, -24), (40, 6), (34, -22)),
        "c": ((-30, 12), (34, 10), (30, 2)),
        "S": ((16, 26), (-8, 34), (34, -14)),
        "B": ((2, -32), (-2, 34), (20, 12)),
    }
    names = {"A": "base joint {}", "c": "$c_{}$", "S": "$S_{}$", "B": "$B_{}$"}
    for name, shifts in offsets.items():
        for i, shift in enumerate(shifts):
            label(ax, bones.points[name][i], names[name].format(i + 1), shift, ha="center", fontsize=10)
    texts = {
        "l_1": ("link $l_{11}$", (28, -42)),
        "l_4": ("$l_{14}$, crank $u_{11}$", (-58, 8)),
        "l_2": ("$l_{12}$, crank $u_{12}$", (52, -40)),
        "l_3": ("$l_{13}$, rod $v_{12}$", (62, -10)),
        "l_5": ("distal link $l_{15}$,\nof which $l_{16}$ from the crank to $S_1$", (66, 30)),
        "l_r": ("redundant link $l_{17}$", (92, 58)),
    }
    for link in bones.of_leg(1):
        text, shift = texts[link.name]
        middle = (link.start + link.end) / 2
        label(ax, middle, text, shift, color=COLOURS[link.kind], fontsize=10, ha="center")
    return figure


def planar() -> Figure:
    """3-RRRR with its names, and the redundant angle at one joint enlarged."""
    robot = krhpr.load("planar_rr_a")
    figure, (ax, close) = pyplot.subplots(1, 2, figsize=(9.0, 4.6), width_ratios=(1.25, 1))
    p, phi, beta = np.array([0.0, 0.0]), 0.0, np.radians([97.0, 97.0, 97.0])
    draw(robot, p, phi, beta, "elbow+", ax, labels=False)
    bones = skeleton(robot, p, phi, beta, "elbow+")
    draw_frame(ax, (0, 0), np.eye(2), 0.035, ("$x$", "$y$"))
    label(ax, (0, 0), "$O = O'$", (-22, -17), leader=False)
    outward = bones.points["A"] / np.linalg.norm(bones.points["A"], axis=1)[:, np.newaxis]
    for i in range(3):
        shift = 15 * outward[i] if i != 1 else (-6, -16)
        label(ax, bones.points["A"][i], f"$o_{i + 1}$", shift, leader=False, ha="center", va="center")
    for name, shifts in {"S": ((12, -18), (-12, 6), (8, -16)), "B": ((-14, 2), (-4, -16), (12, 2))}.items():
        text = {"S": "$r_{}$", "B": "$B_{}$"}[name]
        for i, shift in enumerate(shifts):
            label(ax, bones.points[name][i], text.format(i + 1), shift, leader=False, ha="center")
    o_2, elbow, end = (bones.points[name][1] for name in ("A", "E", "S"))
    first, second = (angle(b - a) for a, b in ((o_2, elbow), (elbow, end)))
    ax.plot(*np.stack([o_2, o_2 + np.array([0.075, 0.0])]).T, color=GREY, linewidth=0.8)
    ax.plot(*np.stack([elbow, elbow + 0.075 * turn(first)]).T, color=GREY, linewidth=0.8)
    arc(ax, o_2, 0.06, 0.0, first, r"$\theta_{21}$", 0.028)
    arc(ax, elbow, 0.05, first, second, r"$\theta_{22}$", 0.03)
    texts = {"l_1": ("$l_{21}$", (-27, -5)), "l_2": ("$l_{22}$", (4, 9)), "l_r": ("$l$", (5, -9))}
    for link in bones.of_leg(2):
        text, shift = texts[link.name]
        label(ax, (link.start + link.end) / 2, text, shift, leader=False, color=COLOURS[link.kind])
    ax.set_xlim(-0.31, 0.42)
    ax.set_ylim(-0.27, 0.30)
    ax.set_title(f"{robot.notation} ({robot.identifier})", fontsize=11)
    attachment(close, bones, 2, r"$B_3$", r"$r_3$")
    close.set_title(r"$\beta_i$ is measured at $B_i$ from the ray $B_i \to O'$, clockwise", fontsize=10)
    figure.tight_layout()
    return figure


def sub_legs() -> Figure:
    """Leg 1 of every sub-leg at its robot's home pose."""
    notations = {f"{subleg.space}_{subleg.name}_a": subleg.notation for subleg, _ in SUBLEGS}
    columns, rows = 5, -(-len(notations) // 5)
    figure = pyplot.figure(figsize=(14.0, 3.1 * rows))
    for place, (name, notation) in enumerate(notations.items()):
        robot = krhpr.load(name, backend="numpy")
        row, column = divmod(place, columns)
        left, low, width, height = column / columns, 1 - (row + 1) / rows, 1 / columns, 1 / rows
        bounds = (left + 0.13 * width, low + 0.1 * height, 0.74 * width, 0.68 * height)
        ax: Any = figure.add_axes(bounds) if robot.planar else figure.add_axes(bounds, projection="3d")
        if not robot.planar:
            ax.view_init(*VIEW)
        x, y, wide, high = bounds
        ax.patch.set_visible(False)
        draw_leg(robot, ax, (x, x + wide, y, y + high))
        subleg = name.partition("_")[2].removesuffix("_a")
        space = "planar " if robot.planar else ""
        figure.text(left + width / 2, low + 0.93 * height, space + notation, ha="center", fontsize=12)
        figure.text(left + width / 2, low + 0.865 * height, subleg, ha="center", fontsize=9, color=GREY)
    return figure


def delta() -> Figure:
    """What `krhpr info spatial_delta_a --picture` draws."""
    return picture(krhpr.load("spatial_delta_a", backend="numpy"))  # type: ignore[no-any-return]
