"""Draw the pictures of the documentation from the generated functions.

    python docs/pictures/make.py [FOLDER]      (`make docs` does it, into docs/pictures)

The pictures are a function of the code alone; their bytes depend on the version of Matplotlib.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from io import BytesIO
from itertools import permutations, product
from pathlib import Path
from typing import Any

import designs
import matplotlib
import numpy as np
import workspaces
from matplotlib import pyplot
from matplotlib.figure import Figure
from matplotlib.patches import Arc
from mpl_toolkits.mplot3d.art3d import Poly3DCollection
from PIL import Image

import krhpr
from krhpr.certificate import largest_box
from krhpr.derivations.catalogue import SUBLEGS
from krhpr.drawing import (
    COLOURS,
    PLATFORM_COLOUR,
    Kind,
    Skeleton,
    draw,
    draw_frame,
    draw_joints,
    label,
    skeleton,
)
from krhpr.picture import VIEW, draw_leg, picture
from krhpr.robot import Robot
from krhpr.study.dexterity import dexterity
from krhpr.study.figures import dexterity_figures, redundancy_figures
from krhpr.study.forward_accuracy import forward_accuracy
from krhpr.study.grasp import contacts, grasp_study
from krhpr.study.grasp_capability import capability_study
from krhpr.study.grasp_capability_picture import picture as capability_picture
from krhpr.study.grasp_control import grasp_control
from krhpr.study.grasp_control_figures import grasp_control_figures
from krhpr.study.grasp_picture import picture as grasp_picture
from krhpr.study.histograms import accuracy_figures
from krhpr.study.redundancy import redundancy

matplotlib.use("Agg")

FOLDER = Path(__file__).resolve().parent
DOTS_PER_INCH = 150
COLOURS_KEPT = 96
GREY, INK, ALERT = "#777777", "#222222", "#b00020"

HOME = np.array([0.0, 0.0, 0.35])
UPRIGHT = np.eye(3)
RADIAL = np.radians([97.0, 97.0, 97.0])
"""Section 1.8: the reference pose."""

OUTSIDE = "front/elbow-/rod-"
"""The working mode of the five-bar legs with the upper crank outside and the linkage a parallelogram."""

Point = Any

STYLE = {
    "font.family": "DejaVu Sans",
    "mathtext.fontset": "dejavusans",
    "font.size": 10,
    "figure.facecolor": "white",
    "savefig.facecolor": "white",
}


# -- pictures -----------------------------------------------------------------------------------------------


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
    first, second = (_angle(b - a) for a, b in ((o_2, elbow), (elbow, end)))
    ax.plot(*np.stack([o_2, o_2 + np.array([0.075, 0.0])]).T, color=GREY, linewidth=0.8)
    ax.plot(*np.stack([elbow, elbow + 0.075 * _turn(first)]).T, color=GREY, linewidth=0.8)
    _arc(ax, o_2, 0.06, 0.0, first, r"$\theta_{21}$", 0.028)
    _arc(ax, elbow, 0.05, first, second, r"$\theta_{22}$", 0.03)
    texts = {"l_1": ("$l_{21}$", (-27, -5)), "l_2": ("$l_{22}$", (4, 9)), "l_r": ("$l$", (5, -9))}
    for link in bones.of_leg(2):
        text, shift = texts[link.name]
        label(ax, (link.start + link.end) / 2, text, shift, leader=False, color=COLOURS[link.kind])
    ax.set_xlim(-0.31, 0.42)
    ax.set_ylim(-0.27, 0.30)
    ax.set_title(f"{robot.notation} ({robot.identifier})", fontsize=11)
    _attachment(close, bones, 2, r"$B_3$", r"$r_3$")
    close.set_title(r"$\beta_i$ is measured at $B_i$ from the ray $B_i \to O'$, clockwise", fontsize=10)
    figure.tight_layout()
    return figure


def conventions() -> Figure:
    """Where the angles of a leg with a first axis are measured from."""
    robot = krhpr.load("spatial_r_fivebar_a")
    figure, axes = pyplot.subplots(1, 3, figsize=(12.6, 4.5), width_ratios=(1, 1.05, 1.25))
    _base_view(axes[0], robot)
    _axis_view(axes[1], robot)
    _linkage_view(axes[2], robot)
    figure.tight_layout(w_pad=0.5)
    return figure


def working_modes() -> Figure:
    """The eight working modes of one leg, in its linkage plane."""
    robot = krhpr.load("spatial_r_fivebar_a")
    figure, axes = pyplot.subplots(2, 4, figsize=(11.0, 6.6), sharex=True, sharey=True)
    for ax, mode in zip(axes.flat, robot.modes, strict=True):
        bones = skeleton(robot, HOME, UPRIGHT, RADIAL, mode)
        flat = _linkage_plane(bones)
        x = np.array([1.0 if mode.startswith("front") else -1.0, 0.0])
        _draw_flat(ax, flat)
        corner = np.array([-0.17, -0.25])
        _arrow(ax, corner, 0.07 * x, "$x$")
        _arrow(ax, corner, np.array([0.0, 0.07]), "$e_1$")
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
        flat = _five_bar_points(robot, theta[0], s[0])
        for kind, start, end in _FIVE_BAR:
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


def type_2_margin() -> Figure:
    """The type II margin of arrangement (a) over two redundant angles, the third held."""
    robot = krhpr.load("spatial_rrr_a")
    figure, axes = pyplot.subplots(1, 3, figsize=(12.0, 4.3), sharey=True, layout="constrained")
    degrees = np.arange(0.0, 361.0, 4.0)
    first, second = np.meshgrid(degrees, degrees, indexing="ij")
    levels = np.arange(-2.75, 2.76, 0.25)
    for ax, third in zip(axes, (90.0, 120.0, 150.0), strict=True):
        beta = np.radians(np.stack([first, second, np.full_like(first, third)], axis=-1))
        s = robot.end_points(HOME, UPRIGHT, beta)
        theta = robot.inverse(HOME, UPRIGHT, beta)
        margin = robot.singularity(HOME, UPRIGHT, s, theta).margins[..., 0]
        shown = ax.contourf(first, second, margin, levels, cmap="RdBu", extend="both")
        ax.contour(first, second, margin, [0.0], colors=INK, linewidths=1.6)
        ax.plot([30, 150, 150, 30, 30], [30, 30, 150, 150, 30], color="#009e73", linewidth=2.2)
        ax.set_title(rf"$\beta_3 = {third:.0f}°$", fontsize=11)
        ax.set_xlabel(r"$\beta_1$ (degrees)")
        ax.set_aspect("equal")
        ax.set_xticks(range(0, 361, 60))
        ax.set_yticks(range(0, 361, 60))
    axes[0].set_ylabel(r"$\beta_2$ (degrees)")
    figure.colorbar(
        shown, ax=axes, label=r"margin $f$ = −det $J_a$ / ($l^3 R_p$)", ticks=np.arange(-2.5, 2.6, 1.25)
    )
    return figure


def singularity_locus() -> Figure:
    """Fig. 1.5: where the flagship is singular in the space of its redundant angles; the certified box."""
    robot = krhpr.load("spatial_r_fivebar_a")
    largest = largest_box(robot, np.radians(90.0))
    degrees = np.linspace(0.0, 180.0, 25)
    grid = np.stack(np.meshgrid(degrees, degrees, degrees, indexing="ij"), axis=-1)
    triangles = _level_set(grid, robot.type_2_of_redundant(np.radians(grid)).margins[..., 0])
    normals = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    areas = np.linalg.norm(normals, axis=1)
    triangles, normals = triangles[areas > 1e-9], normals[areas > 1e-9] / areas[areas > 1e-9, np.newaxis]
    figure = pyplot.figure(figsize=(10.0, 5.0))
    low, high = (
        np.degrees(bound[0]) for bound in (largest.certificate.box.low, largest.certificate.box.high)
    )
    for place, (elevation, azimuth) in enumerate(((22, -58), (35.26, 45))):
        ax = figure.add_axes((-0.03 + 0.5 * place, 0.0, 0.53, 1.0), projection="3d", computed_zorder=False)
        ax.view_init(elevation, azimuth)
        ax.set_proj_type("ortho")
        sight = _sight(elevation, azimuth)
        light = 0.45 + 0.55 * np.abs(normals @ (sight + np.array([0.2, -0.3, 0.5])) / 1.3)
        colours = np.clip(light[:, np.newaxis] * matplotlib.colors.to_rgb("#e08a6a"), 0, 1)
        # what lies before the box lets it show through; seen along the diagonal nothing does
        before = (triangles.mean(axis=1) - 90.0) @ sight > (0 if place == 0 else np.inf)
        for which, order, alpha in ((~before, 1, 1.0), (before, 3, 0.4)):
            part = {"facecolors": colours[which], "edgecolors": "none", "antialiased": alpha < 1}
            ax.add_collection3d(Poly3DCollection(triangles[which], alpha=alpha, zorder=order, **part))
        _wire_box(ax, low, high, sight)
        ax.set(xlim=(0, 180), ylim=(0, 180), zlim=(0, 180))
        ax.set(xticks=(30, 90, 150), yticks=(30, 90, 150), zticks=(30, 90, 150))
        ax.set(xlabel=r"$\beta_1$ (degrees)", ylabel=r"$\beta_2$ (degrees)", zlabel=r"$\beta_3$ (degrees)")
        ax.tick_params(labelsize=8, pad=1)
        ax.set_box_aspect((1, 1, 1), zoom=0.88)
    figure.text(
        0.5,
        0.95,
        r"det $J_a = 0$ (orange) and the open box of 30 to 150 degrees that is free of it (green)",
        ha="center",
        fontsize=11,
    )
    return figure


STUDIES: dict[str, Callable[[], dict[str, Figure]]] = {
    "accuracy": lambda: accuracy_figures(forward_accuracy()),
    "dexterity": lambda: dexterity_figures(dexterity()),
    "redundancy": lambda: redundancy_figures(redundancy()),
    "grasp_control": lambda: grasp_control_figures(grasp_control()),
}
"""Figures of `krhpr study`, several of each: 3.8 to 3.11, 1.10 to 1.12, 4.3 and 4.4, 5.7 and 5.9 to 5.11."""


JAW_COLOURS = ("#1b4f72", "#b03a2e")
"""Of the right and the left jaw, as those of their actuators in the study."""


def grasping() -> Figure:
    """Both grasping robots at home with their names, the prototype's with the object and its forces."""
    figure, axes = pyplot.subplots(1, 2, figsize=(11.0, 3.6))
    for ax, name in zip(axes, krhpr.grasping_robots(), strict=True):
        robot = krhpr.load_grasping(name, backend="numpy")
        _grasping_robot(ax, robot)
        ax.set_title(f"{robot.notation} ({robot.identifier})", fontsize=11)
        ax.set(aspect="equal", xlim=(-0.2, 0.2), ylim=(-0.03, 0.16))
        ax.axis("off")
    _object(axes[0])
    figure.tight_layout()
    return figure


def grasping_study() -> Figure:
    """What the prototype's actuators and motors give along its trajectories."""
    figure: Figure = grasp_picture(grasp_study())
    return figure


def grasping_capability() -> Figure:
    """What the prototype can grasp with, and the moments that it resists."""
    figure: Figure = capability_picture(capability_study())
    return figure


PICTURES: dict[str, Callable[[], Figure]] = {
    "flagship": flagship,
    "planar": planar,
    "conventions": conventions,
    "working_modes": working_modes,
    "assembly_modes": assembly_modes,
    "arrangements": arrangements,
    "sub-legs": sub_legs,
    "delta": delta,
    "type_2_margin": type_2_margin,
    "singularity_locus": singularity_locus,
    "grasping": grasping,
    "grasping_study": grasping_study,
    "grasping_capability": grasping_capability,
    **workspaces.PICTURES,
    **designs.PICTURES,
}


# -- parts of pictures --------------------------------------------------------------------------------------

_FIVE_BAR = (
    (Kind.PROXIMAL, "c", "E"),
    (Kind.CRANK, "c", "C"),
    (Kind.ROD, "C", "P"),
    (Kind.DISTAL, "P", "S"),
)


def _level_set(points: Point, values: Point) -> Point:
    """Triangles (n, 3, 3) of the surface where a function on a grid is zero: marching tetrahedra."""
    corners = np.array(list(product((0, 1), repeat=3)))
    # six tetrahedra around the diagonal of a cell, one for each order of the axes
    paths = [np.cumsum(np.eye(3, dtype=int)[list(order)], axis=0) for order in permutations(range(3))]
    found = []
    cells = [size - 1 for size in values.shape]

    def at(array: Point, corner: Point) -> Point:
        a, b, c = corner
        part = array[a : a + cells[0], b : b + cells[1], c : c + cells[2]]
        return part.reshape((-1, *array.shape[3:]))

    for path in paths:
        chain = [corners[0], *path]
        place, value = (np.stack([at(array, c) for c in chain], axis=1) for array in (points, values))
        for inside in product((False, True), repeat=4):
            chosen = ((value > 0) == inside).all(axis=1)
            plus, minus = [i for i in range(4) if inside[i]], [i for i in range(4) if not inside[i]]
            if not plus or not minus or not chosen.any():
                continue
            edges = [(i, j) for i in plus for j in minus]
            p, v = place[chosen], value[chosen]
            cuts = [
                p[:, i] + (p[:, j] - p[:, i]) * (v[:, i] / (v[:, i] - v[:, j]))[:, None] for i, j in edges
            ]
            found.append(np.stack(cuts[:3], axis=1))
            if len(cuts) == 4:
                found.append(np.stack(cuts[1:], axis=1))
    return np.concatenate(found)


def _sight(elevation: float, azimuth: float) -> Point:
    """From the scene to the eye."""
    e, a = np.radians([elevation, azimuth])
    return np.array([np.cos(e) * np.cos(a), np.cos(e) * np.sin(a), np.sin(e)])


def _wire_box(ax: Any, low: float, high: float, sight: Point) -> None:
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


def _turn(angle: float) -> Point:
    return np.array([np.cos(angle), np.sin(angle)])


def _angle(vector: Point) -> float:
    return float(np.arctan2(vector[1], vector[0]))


def _arrow(ax: Any, start: Point, along: Point, text: str, colour: str = INK) -> None:
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


def _arc(ax: Any, centre: Point, radius: float, start: float, end: float, text: str, away: float) -> None:
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
        centre + radius * _turn(end),
        centre + radius * _turn(end - step),
        arrowprops={"arrowstyle": "-|>", "color": INK, "shrinkA": 0, "shrinkB": 0, "mutation_scale": 9},
    )
    label(
        ax,
        centre + (radius + away) * _turn((start + end) / 2),
        text,
        (0, 0),
        leader=False,
        ha="center",
        va="center",
    )


def _linkage_plane(bones: Skeleton) -> dict[str, Point]:
    """Points of leg 1 in its linkage plane: rightwards from the first axis to S_1, upwards e_1."""
    origin, base = bones.points["c"][0], bones.points["A"][0]
    e_1 = (origin - base) / np.linalg.norm(origin - base)
    across = bones.points["S"][0] - origin
    across = across - e_1 * (across @ e_1)
    across /= np.linalg.norm(across)
    plane = np.stack([across, e_1])
    return {name: plane @ (points[0] - origin) for name, points in bones.points.items() if name in "cECPS"}


def _draw_flat(ax: Any, flat: dict[str, Point]) -> None:
    for kind, start, end in _FIVE_BAR:
        ax.plot(
            *np.stack([flat[start], flat[end]]).T,
            color=COLOURS[kind],
            linewidth=3.2,
            solid_capstyle="round",
            zorder=2,
        )
    ax.plot([0, 0], [-0.2, 0.36], color=GREY, linewidth=0.8, linestyle=(0, (8, 3, 1, 3)), zorder=0)
    draw_joints(ax, np.stack(list(flat.values())), markersize=4.5)


def _five_bar_points(robot: Robot, theta: Point, s: Point) -> dict[str, Point]:
    """Points of leg 1 in the plane (x, e_1) from its joints and its end point."""
    module = krhpr.generated.python.spatial_r_fivebar_a  # type: ignore[attr-defined]
    prepared = module.prepare(robot.geometry).subleg
    legs = tuple(np.repeat(value, 3) for value in s), tuple(np.repeat(value, 3) for value in theta)
    _, _, d, u_1, u_2 = (
        [np.asarray(part)[0] for part in vector] for vector in module.subleg.posture(prepared, *legs)
    )
    end, elbow, crank = np.array(d), np.array(u_1), np.array(u_2)
    ratio = 1 - robot.geometry.l_5[0] / robot.geometry.l_6[0]
    return {"c": np.zeros(2), "E": elbow, "C": crank, "P": elbow + ratio * (end - elbow), "S": end}


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
            _arrow(ax, joint, 0.12 * _turn(azimuth), "$e_r$")
            _arrow(ax, joint, 0.12 * _turn(azimuth + np.pi / 2), "$e_t$")
            ax.plot(*np.stack([np.zeros(2), joint]).T, color=INK, linewidth=1)
            label(ax, joint / 2, "$R_b$", (-20, -4), leader=False)
            _arc(ax, np.zeros(2), 0.075, 0.0, azimuth, "", 0.0)
            blank = {"facecolor": "white", "edgecolor": "none", "pad": 0.6}
            label(ax, 0.075 * _turn(0.45), "azimuth", (3, 0), leader=False, fontsize=9, bbox=blank)
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
    _arrow(ax, c, 0.13 * e_1, "")
    label(ax, c + 0.13 * e_1, "$e_1$", (6, -8), leader=False)
    _arrow(ax, c, 0.13 * e_x, "$e_x$")
    ax.plot(*c, marker="o", markersize=8, color="white", markeredgecolor=INK, zorder=6)
    ax.plot(*c, marker="x", markersize=5, color=INK, zorder=7)
    label(ax, c, "$e_t$ (into the page)", (12, -4), leader=False, fontsize=9)
    label(ax, c, "$c$", (-14, -7), leader=False)
    _arc(ax, joint, 0.06, np.pi, np.pi - alpha, r"$\alpha$", 0.025)
    _arrow(ax, np.zeros(2), np.array([0.1, 0.0]), "")
    _arrow(ax, np.zeros(2), np.array([0.0, 0.1]), "$z$")
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
    flat = _linkage_plane(bones)
    _draw_flat(ax, flat)
    origin = flat["c"]
    _arrow(ax, origin, np.array([0.2, 0.0]), "$x$")
    _arrow(ax, np.array([0.0, 0.32]), np.array([0.0, 0.07]), "")
    label(ax, (0.0, 0.38), "$e_1$", (5, -2), leader=False)
    theta_2, theta_3 = bones.theta[0, 1], bones.theta[0, 2]
    _arc(ax, origin, 0.10, 0.0, theta_2, r"$\theta_2$", 0.035)
    _arc(ax, origin, 0.065, 0.0, theta_3, "", 0.0)
    label(ax, 0.065 * _turn(2.2), r"$\theta_3$", (-13, 3), leader=False)
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


def _attachment(ax: Any, bones: Skeleton, leg: int, joint: str, end: str) -> None:
    """The redundant link of one leg of a planar robot, with its angle."""
    b, s, centre = bones.points["B"][leg], bones.points["S"][leg], bones.origin
    corners = bones.points["B"]
    ax.fill(*corners.T, facecolor=PLATFORM_COLOUR, alpha=0.3)
    ax.plot(*np.vstack([corners, corners[:1]]).T, color=PLATFORM_COLOUR, linewidth=2.4)
    ax.plot(*np.stack([b, s]).T, color=COLOURS[Kind.REDUNDANT], linewidth=4)
    ax.plot(*np.stack([b, centre]).T, color=GREY, linewidth=1, linestyle=(0, (4, 3)))
    inward, along = _angle(centre - b), _angle(s - b)
    difference = np.mod(inward - along, 2 * np.pi)
    _arc(ax, b, 0.026, inward, inward - difference, r"$\beta_3$", 0.011)
    draw_joints(ax, np.stack([b, s, centre]))
    label(ax, b, joint, (10, 2), leader=False)
    label(ax, s, end, (-18, -4), leader=False)
    label(ax, (b + s) / 2, "$l$", (-4, 8), leader=False)
    label(ax, centre, "$O'$", (8, -10), leader=False)
    ax.set_aspect("equal")
    ax.set_axis_off()
    ax.set_xlim(-0.085, 0.085)
    ax.set_ylim(-0.025, 0.15)


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
        inward = _angle(-b[i])
        _arc(ax, b[i], 0.03, inward, inward - beta[i], "", 0.0)
        # a narrow angle is cut in halves by the platform's edge
        share, away_from = (0.5, 0.043) if beta[i] > 1.2 else (0.25, 0.06)
        place = b[i] + away_from * _turn(inward - share * beta[i])
        label(ax, place, rf"$\beta_{i + 1}$", (0, 0), leader=False, ha="center", va="center")
        label(ax, b[i], f"$B_{i + 1}$", 13 * outward, leader=False, ha="center", va="center")
        beyond = away / np.linalg.norm(away)
        label(
            ax,
            s[i],
            f"$S_{i + 1}$",
            8 * beyond + 12 * _turn(_angle(beyond) - np.pi / 2),
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


def _grasping_robot(ax: Any, robot: krhpr.GraspingRobot) -> None:
    """Sub-legs, jaws, names of Figs. 5.1 and 5.2."""
    pivot, angles = map(np.array, robot.home)
    s = robot.end_points(pivot, angles)
    theta = robot.inverse(pivot, angles)
    found = robot.link_points(s, theta)
    names = robot.signature("link_points").outputs[0].labels
    low = found[..., 1].min()
    ax.plot([-0.19, 0.19], [low, low], color=GREY, linewidth=0.6, zorder=0)
    for jaw, colour in enumerate(JAW_COLOURS):
        points = dict(zip(names, found[jaw], strict=True))
        for link in robot.links:
            if link[1] != "slide":
                ends = np.stack([points[link[2]], points[link[3]]])
                ax.plot(*ends.T, color=colour, linewidth=2.2, alpha=0.75)
        for n in (1, 2):
            at = points["D_" + str(n)] if f"D_{n}" in points else points["A" if n == 1 else "A_2"]
            ax.plot(*at, marker="s" if f"D_{n}" in points else "^", markersize=10, color=GREY, zorder=3)
            label(ax, at, f"$a_{2 * jaw + n}$", (0, -20), leader=False, ha="center")
            place = 0.65 * at + 0.35 * s[jaw]
            text = f"$u_{2 * jaw + n}$" if f"D_{n}" in points else rf"$\rho_{2 * jaw + n}$"
            label(ax, place, text, (-10 if n == 1 else 8, 6), leader=False, ha="center", color=colour)
        ax.plot(*np.stack([s[jaw], pivot]).T, color=colour, linewidth=5, solid_capstyle="round")
        label(ax, s[jaw], "$P$" if jaw == 0 else "$S$", (0, -16), leader=False, ha="center")
        place, text = (s[jaw] + pivot) / 2, "$b$" if jaw == 0 else "$l$"
        label(ax, place, text, (-10, 4) if jaw == 0 else (-7, -13), leader=False, ha="center")
        ax.plot([s[jaw, 0], s[jaw, 0] + 0.03], [s[jaw, 1]] * 2, color=GREY, linewidth=0.8)
        _arc(ax, s[jaw], 0.022, 0.0, angles[jaw], (r"$\phi$", r"$\beta$")[jaw], 0.011)
    draw_joints(ax, np.vstack([s, pivot]))
    label(ax, pivot, "$B$", (14, -5), leader=False)


def _object(ax: Any) -> None:
    """The prototype's object, on which the jaws press."""
    setup = grasp_study().setup
    pivot, angles = np.array(setup.pivot), np.array([setup.phi, setup.beta])
    touch, faces, centre = contacts(setup)
    for jaw, colour in enumerate(JAW_COLOURS):
        turned = np.array([_turn(angles[jaw]), _turn(angles[jaw] + np.pi / 2)]).T
        at, normal = pivot + turned @ touch[jaw], turned @ _turn(faces[jaw])
        face = np.stack([at - 0.012 * _turn(np.pi / 2), at + 0.018 * _turn(np.pi / 2)])
        ax.plot(*np.stack([pivot, face[0]]).T, color=colour, linewidth=3.5, solid_capstyle="round")
        ax.plot(*face.T, color=colour, linewidth=3.5, solid_capstyle="round")
        text = ("$f_{ro}$", "$f_{lo}$")[jaw]
        arrow = {"arrowstyle": "-|>", "color": ALERT, "linewidth": 1.6}
        ax.annotate("", at, at - 0.03 * normal, arrowprops=arrow, zorder=8)
        label(ax, at - 0.03 * normal, text, -12 * normal + (0, 4), leader=False, ha="center", color=ALERT)
        if jaw == 0:
            middle = pivot + turned @ centre
    half = np.array([setup.held.width / 2, 0.011])
    corners = middle + half * np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])
    ax.fill(*corners.T, color="#eeeeee", edgecolor=INK, linewidth=1, zorder=4)
    ax.annotate(
        "",
        middle - (0, 0.03),
        middle,
        arrowprops={"arrowstyle": "-|>", "color": INK, "linewidth": 1.2},
        zorder=9,
    )
    label(ax, middle - (0, 0.022), r"$m\mathbf{g}$", (-46, -6), leader=False)


# -- files --------------------------------------------------------------------------------------------------


def save(figure: Figure, path: Path) -> None:
    """Write a figure as a small PNG: few colours, no metadata."""
    buffer = BytesIO()
    figure.savefig(buffer, format="png", dpi=DOTS_PER_INCH, metadata={"Software": None})
    pyplot.close(figure)
    image = Image.open(buffer).convert("RGB").quantize(COLOURS_KEPT, dither=Image.Dither.NONE)
    image.save(path, optimize=True)


def main(folder: Path = FOLDER) -> None:
    """Draw every picture."""
    folder.mkdir(parents=True, exist_ok=True)
    with matplotlib.rc_context(STYLE):
        for name, picture in PICTURES.items():
            save(picture(), folder / f"{name}.png")
        for figures in STUDIES.values():
            for name, figure in figures().items():
                save(figure, folder / f"{name}.png")


if __name__ == "__main__":
    main(*map(Path, sys.argv[1:2]))
