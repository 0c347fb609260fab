"""Pictures of the type II margin and of the surface where it is 0."""

from __future__ import annotations

from itertools import permutations, product

import matplotlib
import numpy as np
from matplotlib import pyplot
from matplotlib.figure import Figure
from mpl_toolkits.mplot3d.art3d import Poly3DCollection
from sketches import HOME, INK, UPRIGHT, Point, line_of_sight, wire_box

import krhpr
from krhpr.certificate import largest_box


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
        sight = line_of_sight(elevation, azimuth)
        light = 0.45 + 0.55 * np.abs(normals @ (sight + np.array([0.2, -0.3, 0.5])) / 1.3)
        colours = np.clip(light[:, np.newaxis] * matplotlib.colors.to_rgb("#e08a6a"), 0, 1)
        # what lies before the box lets it show through; seen along the diagonal nothing does
        before = (triangles.mean(axis=1) - 90.0) @ sight > (0 if place == 0 else np.inf)
        for which, order, alpha in ((~before, 1, 1.0), (before, 3, 0.4)):
            part = {"facecolors": colours[which], "edgecolors": "none", "antialiased": alpha < 1}
            ax.add_collection3d(Poly3DCollection(triangles[which], alpha=alpha, zorder=order, **part))
        wire_box(ax, low, high, sight)
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
