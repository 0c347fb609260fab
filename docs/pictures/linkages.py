"""Five-bar linkages in their plane, and where redundant links are attached."""

from __future__ import annotations

from typing import Any

import numpy as np
from sketches import GREY, Point, angle, arc

import krhpr
from krhpr.drawing import COLOURS, PLATFORM_COLOUR, Kind, Skeleton, draw_joints, label
from krhpr.robot import Robot

FIVE_BAR = (
    (Kind.PROXIMAL, "c", "E"),
    (Kind.CRANK, "c", "C"),
    (Kind.ROD, "C", "P"),
    (Kind.DISTAL, "P", "S"),
)


def linkage_plane(bones: Skeleton) -> dict[str, Point]:
    """Points of leg 1 in its linkage plane: rightwards from the first axis to S_1, upwards e_1."""
    origin, base = bones.points["c"][0], bones.points["A"][0]
    e_1 = (origin - base) / np.linalg.norm(origin - base)
    across = bones.points["S"][0] - origin
    across = across - e_1 * (across @ e_1)
    across /= np.linalg.norm(across)
    plane = np.stack([across, e_1])
    return {name: plane @ (points[0] - origin) for name, points in bones.points.items() if name in "cECPS"}


def draw_flat(ax: Any, flat: dict[str, Point]) -> None:
    """A linkage in its plane."""
    for kind, start, end in FIVE_BAR:
        ax.plot(
            *np.stack([flat[start], flat[end]]).T,
            color=COLOURS[kind],
            linewidth=3.2,
            solid_capstyle="round",
            zorder=2,
        )
    ax.plot([0, 0], [-0.2, 0.36], color=GREY, linewidth=0.8, linestyle=(0, (8, 3, 1, 3)), zorder=0)
    draw_joints(ax, np.stack(list(flat.values())), markersize=4.5)


def five_bar_points(robot: Robot, theta: Point, s: Point) -> dict[str, Point]:
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


def attachment(ax: Any, bones: Skeleton, leg: int, joint: str, end: str) -> None:
    """The redundant link of one leg of a planar robot, with its angle."""
    b, s, centre = bones.points["B"][leg], bones.points["S"][leg], bones.origin
    corners = bones.points["B"]
    ax.fill(*corners.T, facecolor=PLATFORM_COLOUR, alpha=0.3)
    ax.plot(*np.vstack([corners, corners[:1]]).T, color=PLATFORM_COLOUR, linewidth=2.4)
    ax.plot(*np.stack([b, s]).T, color=COLOURS[Kind.REDUNDANT], linewidth=4)
    ax.plot(*np.stack([b, centre]).T, color=GREY, linewidth=1, linestyle=(0, (4, 3)))
    inward, along = angle(centre - b), angle(s - b)
    difference = np.mod(inward - along, 2 * np.pi)
    arc(ax, b, 0.026, inward, inward - difference, r"$\beta_3$", 0.011)
    draw_joints(ax, np.stack([b, s, centre]))
    label(ax, b, joint, (10, 2), leader=False)
    label(ax, s, end, (-18, -4), leader=False)
    label(ax, (b + s) / 2, "$l$", (-4, 8), leader=False)
    label(ax, centre, "$O'$", (8, -10), leader=False)
    ax.set_aspect("equal")
    ax.set_axis_off()
    ax.set_xlim(-0.085, 0.085)
    ax.set_ylim(-0.025, 0.15)
