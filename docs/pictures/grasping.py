"""Pictures of grasping robots."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib import pyplot
from matplotlib.figure import Figure
from sketches import ALERT, GREY, INK, arc, turn

import krhpr
from krhpr.drawing import draw_joints, label
from krhpr.study.grasp import contacts, grasp_study
from krhpr.study.grasp_capability import capability_study
from krhpr.study.grasp_capability_picture import picture as capability_picture
from krhpr.study.grasp_picture import picture as grasp_picture

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
        arc(ax, s[jaw], 0.022, 0.0, angles[jaw], (r"$\phi$", r"$\beta$")[jaw], 0.011)
    draw_joints(ax, np.vstack([s, pivot]))
    label(ax, pivot, "$B$", (14, -5), leader=False)


def _object(ax: Any) -> None:
    """The prototype's object, on which the jaws press."""
    setup = grasp_study().setup
    pivot, angles = np.array(setup.pivot), np.array([setup.phi, setup.beta])
    touch, faces, centre = contacts(setup)
    for jaw, colour in enumerate(JAW_COLOURS):
        turned = np.array([turn(angles[jaw]), turn(angles[jaw] + np.pi / 2)]).T
        at, normal = pivot + turned @ touch[jaw], turned @ turn(faces[jaw])
        face = np.stack([at - 0.012 * turn(np.pi / 2), at + 0.018 * turn(np.pi / 2)])
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
