"""Pictures of docs/conventions.md: views of the base, of an axis, of a linkage and of every platform."""

from __future__ import annotations

from typing import Any

import numpy as np
from linkages import draw_flat, linkage_plane
from matplotlib import pyplot
from matplotlib.figure import Figure
from sketches import ALERT, GREY, HOME, INK, OUTSIDE, RADIAL, UPRIGHT, Point, angle, arc, arrow, turn

import krhpr
from krhpr.drawing import COLOURS, PLATFORM_COLOUR, Kind, draw_frame, draw_joints, label, skeleton
from krhpr.robot import Robot


def conventions() -> Figure:
    """Where the angles of a leg with a first axis are measured from."""
    robot = krhpr.load("spatial_r_fivebar_a")
    figure, axes = pyplot.subplots(1, 3, figsize=(12.6, 4.5), width_ratios=(1, 1.05, 1.25))
    _base_view(axes[0], robot)
    _axis_view(axes[1], robot)
    _linkage_view(axes[2], robot)
    figure.tight_layout(w_pad=0.5)
    return figure


def arrangements() -> Figure:
    """Platform arrangements (a), (b) and (c) seen from +z'."""
    figure, axes = pyplot.subplots(1, 3, figsize=(13.0, 4.7))
    beta, slides = np.radians([60.0, 97.0, 130.0]), np.array([0.11, 0.08, 0.14])
    for ax, letter, redundant in zip(axes, "abc", (beta, 0.7 * slides, slides), strict=True):
        bones = skeleton(krhpr.load(f"spatial_rrr_{letter}"), HOME, UPRIGHT, redundant, "front/elbow-")
        flat = {name: (points - HOME)[:, :2] for name, points in bones.points.items()}
        if letter == "a":
            _platform_a(ax, flat, beta)
        elif letter == "b":
            assert bones.middles is not None
            _platform_b(ax, flat, (bones.middles - HOME)[:, :2])
        else:
            _platform_c(ax, flat["S"])
        draw_frame(ax, (0, 0), np.eye(2), 0.045)
        label(ax, (0.045, 0), "$x'$", (-3, -15), leader=False)
        label(ax, (0, 0.045), "$y'$", (-4, 5), leader=False)
        label(ax, (0, 0), "$O'$", (-20, -4) if "B" in flat else (-48, -4), leader="B" not in flat)
        ax.set_aspect("equal")
        ax.set_axis_off()
        ax.set_xlim(-0.175, 0.185)
        ax.set_ylim(-0.175, 0.165)
    axes[0].set_title(r"(a)  redundant links, angles $\beta_i$", fontsize=11)
    axes[1].set_title("(b)  tangential slides, displacements $d_i$", fontsize=11)
    axes[2].set_title("(c)  radial slides, displacements $d_i$", fontsize=11)
    figure.tight_layout()
    return figure


def _base_view(ax: Any, robot: Robot) -> None:
    """The base seen from above."""
    bones = skeleton(robot, HOME, UPRIGHT, RADIAL, OUTSIDE)
    joints = bones.points["A"][:, :2]
    ax.plot(*np.vstack([joints, joints[:1]]).T, color=GREY, linewidth=1.2, linestyle=(0, (4, 3)))
    radius = float(robot.geometry.R_b[0])
    ax.add_patch(pyplot.Circle((0, 0), radius, fill=False, color="#cccccc", linewidth=1))
    for i, (joint, azimuth) in enumerate(zip(joints, robot.geometry.azimuth, strict=True)):
        shift = ((18, 12), (-24, 14), (-22, -8))[i]
        label(ax, joint, f"leg {i + 1}", shift, leader=False, ha="center", va="center")
        if i == 1:
            arrow(ax, joint, 0.12 * turn(azimuth), "$e_r$")
            arrow(ax, joint, 0.12 * turn(azimuth + np.pi / 2), "$e_t$")
            ax.plot(*np.stack([np.zeros(2), joint]).T, color=INK, linewidth=1)
            label(ax, joint / 2, "$R_b$", (-20, -4), leader=False)
            arc(ax, np.zeros(2), 0.075, 0.0, azimuth, "", 0.0)
            blank = {"facecolor": "white", "edgecolor": "none", "pad": 0.6}
            label(ax, 0.075 * turn(0.45), "azimuth", (3, 0), leader=False, fontsize=9, bbox=blank)
    draw_joints(ax, joints)
    draw_frame(ax, (0, 0), np.eye(2), 0.1, ("$x$", "$y$"))
    label(ax, (0, 0), "$O$", (-14, -13), leader=False)
    ax.set_title("base, seen from $+z$", fontsize=11)
    ax.set_aspect("equal")
    ax.set_axis_off()
    ax.set_xlim(-0.34, 0.34)
    ax.set_ylim(-0.29, 0.37)


def _axis_view(ax: Any, robot: Robot) -> None:
    """The vertical plane through O and the base joint of a leg."""
    alpha, radius = float(robot.geometry.alpha[0]), 0.25
    joint, e_1 = np.array([radius, 0.0]), np.array([-np.cos(alpha), np.sin(alpha)])
    e_x = np.array([-np.sin(alpha), -np.cos(alpha)])  # e_1 x e_t
    c = joint + 0.11 * e_1  # l_1 is drawn longer than it is
    ax.plot([0, radius], [0, 0], color=GREY, linewidth=1.2, linestyle=(0, (4, 3)))
    ax.plot(
        *np.stack([joint - 0.05 * e_1, joint + 0.27 * e_1]).T,
        color=GREY,
        linewidth=0.8,
        linestyle=(0, (8, 3, 1, 3)),
    )
    ax.plot(*np.stack([joint, c]).T, color=COLOURS[Kind.FIXED], linewidth=3.4)
    label(ax, (joint + c) / 2, "$l_1$", (7, -9), leader=False)
    arrow(ax, c, 0.13 * e_1, "")
    label(ax, c + 0.13 * e_1, "$e_1$", (6, -8), leader=False)
    arrow(ax, c, 0.13 * e_x, "$e_x$")
    ax.plot(*c, marker="o", markersize=8, color="white", markeredgecolor=INK, zorder=6)
    ax.plot(*c, marker="x", markersize=5, color=INK, zorder=7)
    label(ax, c, "$e_t$ (into the page)", (12, -4), leader=False, fontsize=9)
    label(ax, c, "$c$", (-14, -7), leader=False)
    arc(ax, joint, 0.06, np.pi, np.pi - alpha, r"$\alpha$", 0.025)
    arrow(ax, np.zeros(2), np.array([0.1, 0.0]), "")
    arrow(ax, np.zeros(2), np.array([0.0, 0.1]), "$z$")
    label(ax, (0.1, 0), "$e_r$", (0, -16), leader=False, ha="center")
    label(ax, (0, 0), "$O$", (-14, -13), leader=False)
    draw_joints(ax, np.stack([joint]))
    label(ax, joint, "base joint", (14, -14), leader=False, ha="left")
    ax.set_title("first axis, in the vertical plane through $O$", fontsize=11)
    ax.set_aspect("equal")
    ax.set_axis_off()
    ax.set_xlim(-0.06, 0.55)
    ax.set_ylim(-0.17, 0.40)


def _linkage_view(ax: Any, robot: Robot) -> None:
    """The linkage plane of the five-bar sub-leg with its vectors and angles."""
    bones = skeleton(robot, HOME, UPRIGHT, RADIAL, OUTSIDE)
    flat = linkage_plane(bones)
    draw_flat(ax, flat)
    origin = flat["c"]
    arrow(ax, origin, np.array([0.2, 0.0]), "$x$")
    arrow(ax, np.array([0.0, 0.32]), np.array([0.0, 0.07]), "")
    label(ax, (0.0, 0.38), "$e_1$", (5, -2), leader=False)
    theta_2, theta_3 = bones.theta[0, 1], bones.theta[0, 2]
    arc(ax, origin, 0.10, 0.0, theta_2, r"$\theta_2$", 0.035)
    arc(ax, origin, 0.065, 0.0, theta_3, "", 0.0)
    label(ax, 0.065 * turn(2.2), r"$\theta_3$", (-13, 3), leader=False)
    ax.plot(*origin, marker="o", markersize=9, color="white", markeredgecolor=INK, zorder=6)
    ax.plot(*origin, marker="o", markersize=2.5, color=INK, zorder=7)
    label(ax, origin, "$c$", (-13, -13), leader=False)
    label(ax, origin, "$e_2$ (out of the page)", (10, -14), leader=False, fontsize=9)
    for name, shift in {"E": (7, 6), "C": (-15, -10), "P": (-6, 9), "S": (9, -2)}.items():
        label(ax, flat[name], f"${name}$", shift, leader=False)
    names = {
        ("c", "E"): ("$u_1$, length $l_4$", (7, 22), Kind.PROXIMAL),
        ("c", "C"): ("$u_2$, $l_2$", (-30, -19), Kind.CRANK),
        ("C", "P"): ("$v_2$, $l_3$", (-45, -4), Kind.ROD),
        ("P", "E"): ("$w$", (-2, 9), Kind.DISTAL),
        ("E", "S"): ("$v_1$, $l_6$  ($P$ to $S$: $l_5$)", (-14, 15), Kind.DISTAL),
    }
    for (start, end), (text, shift, kind) in names.items():
        label(ax, (flat[start] + flat[end]) / 2, text, shift, leader=False, color=COLOURS[kind])
    ax.set_title(r"linkage plane $(x, e_1)$ at $\theta_1$", fontsize=11)
    ax.set_aspect("equal")
    ax.set_axis_off()
    ax.set_xlim(-0.27, 0.36)
    ax.set_ylim(-0.07, 0.43)


def _platform_a(ax: Any, flat: dict[str, Point], beta: Point) -> None:
    b, s = flat["B"], flat["S"]
    ax.fill(*b.T, facecolor=PLATFORM_COLOUR, alpha=0.3)
    ax.plot(*np.vstack([b, b[:1]]).T, color=PLATFORM_COLOUR, linewidth=2.4)
    for i in range(3):
        outward = b[i] / np.linalg.norm(b[i])
        ax.plot(*np.stack([b[i], 0.35 * b[i]]).T, color=GREY, linewidth=1, linestyle=(0, (4, 3)))
        ax.plot(*np.stack([b[i], s[i]]).T, color=COLOURS[Kind.REDUNDANT], linewidth=4)
        away = s[i] - b[i]
        line = np.stack([b[i] - 1.6 * away, s[i] + 1.6 * away])
        ax.plot(*line.T, color=ALERT, linewidth=0.8, linestyle=(0, (1, 2)), zorder=0)
        inward = angle(-b[i])
        arc(ax, b[i], 0.03, inward, inward - beta[i], "", 0.0)
        # a narrow angle is cut in halves by the platform's edge
        share, away_from = (0.5, 0.043) if beta[i] > 1.2 else (0.25, 0.06)
        place = b[i] + away_from * turn(inward - share * beta[i])
        label(ax, place, rf"$\beta_{i + 1}$", (0, 0), leader=False, ha="center", va="center")
        label(ax, b[i], f"$B_{i + 1}$", 13 * outward, leader=False, ha="center", va="center")
        beyond = away / np.linalg.norm(away)
        label(
            ax,
            s[i],
            f"$S_{i + 1}$",
            8 * beyond + 12 * turn(angle(beyond) - np.pi / 2),
            leader=False,
            ha="center",
            va="center",
        )
    draw_joints(ax, np.vstack([b, s]))


def _platform_b(ax: Any, flat: dict[str, Point], middles: Point) -> None:
    s, sliders = flat["S"], flat["B"]
    ax.fill(*middles.T, facecolor=PLATFORM_COLOUR, alpha=0.3)
    ax.plot(*np.vstack([middles, middles[:1]]).T, color=PLATFORM_COLOUR, linewidth=2.4)
    for i in range(3):
        outward = middles[i] / np.linalg.norm(middles[i])
        across = np.array([-outward[1], outward[0]])
        rail = np.stack([middles[i] - 0.02 * across, middles[i] + 0.125 * across])
        ax.plot(*rail.T, color=PLATFORM_COLOUR, linewidth=5, solid_capstyle="butt", zorder=1)
        ax.plot(*np.stack([s[i], sliders[i]]).T, color=COLOURS[Kind.REDUNDANT], linewidth=4)
        line = np.stack([s[i] - 0.07 * outward, sliders[i] + 0.04 * outward])
        ax.plot(*line.T, color=ALERT, linewidth=0.8, linestyle=(0, (1, 2)), zorder=0)
        shift = 0.018 * outward
        both_ends = {"arrowstyle": "<|-|>", "color": INK, "shrinkA": 0, "shrinkB": 0, "linewidth": 0.9}
        ax.annotate("", sliders[i] + shift, middles[i] + shift, arrowprops=both_ends)
        place = (middles[i] + sliders[i]) / 2 + shift
        label(ax, place, f"$d_{i + 1}$", 11 * outward, leader=False, ha="center", va="center")
        label(ax, (s[i] + sliders[i]) / 2, "$l_r$", 10 * across, leader=False, ha="center", va="center")
        place = -9 * outward + 13 * across
        label(ax, s[i], f"$S_{i + 1}$", place, leader=False, ha="center", va="center")
    draw_joints(ax, np.vstack([s, sliders]))


def _platform_c(ax: Any, s: Point) -> None:
    for i in range(3):
        outward = s[i] / np.linalg.norm(s[i])
        across = np.array([-outward[1], outward[0]])
        slide = np.stack([np.zeros(2), 0.17 * outward])
        ax.plot(*slide.T, color=PLATFORM_COLOUR, linewidth=5, solid_capstyle="butt", zorder=1)
        ax.plot(
            *np.stack([s[i] - 0.06 * across, s[i] + 0.06 * across]).T,
            color=ALERT,
            linewidth=0.8,
            linestyle=(0, (1, 2)),
        )
        shift = 0.018 * across
        both_ends = {"arrowstyle": "<|-|>", "color": INK, "shrinkA": 0, "shrinkB": 0, "linewidth": 0.9}
        ax.annotate("", s[i] + shift, shift, arrowprops=both_ends)
        label(ax, 0.6 * s[i] + shift, f"$d_{i + 1}$", 11 * across, leader=False, ha="center", va="center")
        place = 9 * outward - 13 * across
        label(ax, s[i], f"$S_{i + 1}$", place, leader=False, ha="center", va="center")
    draw_joints(ax, s)
