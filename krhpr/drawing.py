"""A robot as points and straight links, and pictures of it.

    from krhpr.drawing import draw, skeleton

    bones = skeleton(robot, p, Q, redundant)    # NumPy alone
    draw(robot, p, Q, redundant)                # Matplotlib

Every point comes from the generated functions: joints from `inverse`, their places from `link_points`.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from enum import StrEnum
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from krhpr.robot import Branch, Robot

Array = NDArray[np.float64]


class Kind(StrEnum):
    """What a link is, which decides how it is drawn."""

    FIXED = "fixed"
    SLIDE = "slide"
    PROXIMAL = "proximal"
    DISTAL = "distal"
    CRANK = "crank"
    ROD = "rod"
    STRUT = "strut"
    REDUNDANT = "redundant"


COLOURS: Mapping[Kind, str] = {
    Kind.FIXED: "#555555",
    Kind.SLIDE: "#56b4e9",
    Kind.PROXIMAL: "#0072b2",
    Kind.DISTAL: "#d55e00",
    Kind.CRANK: "#009e73",
    Kind.ROD: "#a05a90",
    Kind.STRUT: "#0072b2",
    Kind.REDUNDANT: "#111111",
}
PLATFORM_COLOUR = "#e6b800"


@dataclass(frozen=True)
class Link:
    """One straight link of a leg (1 to 3), named as its length in the geometry is."""

    leg: int
    name: str
    kind: Kind
    start: Array
    end: Array

    @property
    def length(self) -> float:
        """The distance between its ends."""
        return float(np.linalg.norm(self.end - self.start))


@dataclass(frozen=True)
class Skeleton:
    """A robot in one configuration: named points of the legs, links, and the platform.

    `points` has for each name an array with a row for each leg: the names of `link_points` (`A` base joint,
    `E` elbow, `S` end point of the sub-leg, ...) and `B`, joint or slider on the platform.
    """

    points: Mapping[str, Array]
    links: tuple[Link, ...]
    theta: Array
    origin: Array
    axes: Array

    @property
    def platform(self) -> Array:
        """The platform's corners: its revolute joints, or the end points where it has none."""
        return self.points["B"] if "B" in self.points else self.points["S"]

    def of_leg(self, leg: int) -> tuple[Link, ...]:
        """The links of one leg (1 to 3), from the base to the platform."""
        return tuple(link for link in self.links if link.leg == leg)


def skeleton(
    robot: Robot,
    p: ArrayLike,
    orientation: ArrayLike,
    redundant: ArrayLike,
    mode: Branch | None = None,
    theta: ArrayLike | None = None,
) -> Skeleton:
    """Points and links at one pose.

    `orientation` is Q, or phi for a planar robot; `mode` is what `Robot.inverse` takes, its default unless
    given; `theta` are the joints themselves, where `inverse` has no closed form.  Raises Unreachable where a
    leg cannot reach its end point.
    """
    s = np.asarray(robot.end_points(p, orientation, redundant))
    if theta is None:
        theta = robot.inverse(p, orientation, redundant, mode=mode, check=True)
    joints, attachment = robot.link_points(p, orientation, s, theta)
    names = robot.signature("link_points").outputs[0].labels
    points = {name: joints[:, place] for place, name in enumerate(names)}
    chain = [(name, Kind(kind), start, end) for name, kind, start, end in robot.links]
    if robot.redundant_link:
        points["B"] = np.asarray(attachment)
        chain.append((robot.redundant_link, Kind.REDUNDANT, "S", "B"))
    links = tuple(
        Link(i + 1, name, kind, points[start][i], points[end][i])
        for i in range(3)
        for name, kind, start, end in chain
    )
    axes = _rotation(orientation) if robot.planar else np.asarray(orientation, dtype=float)
    return Skeleton(points, links, np.asarray(theta), np.asarray(p, dtype=float), axes)


def _rotation(phi: ArrayLike) -> Array:
    angle = float(np.asarray(phi))
    return np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])


# -- pictures ------------------------------------------------------------------------------------------------


def draw(
    robot: Robot,
    p: ArrayLike,
    orientation: ArrayLike,
    redundant: ArrayLike,
    mode: Branch | None = None,
    ax: Any = None,
    *,
    labels: bool = True,
) -> Any:
    """Draw a robot at one pose into Matplotlib axes: new ones unless given, 3D ones for a spatial robot.

    Takes what `skeleton` takes and returns the axes.  Set the view of 3D axes before, so that labels find
    their places.  Coordinates are those of the base frame, in the geometry's unit of length.
    """
    bones = skeleton(robot, p, orientation, redundant, mode)
    ax = _new_axes(robot.planar) if ax is None else ax
    draw_base(ax, bones)
    draw_platform(ax, bones)
    for link in bones.links:
        draw_link(ax, link)
    for points in bones.points.values():
        draw_joints(ax, points)
    _frame_picture(ax, bones)
    if labels:
        centre = _on_page(ax, bones.platform.mean(axis=0))
        for name, distance in (("S", 13), ("B", -13)):  # end points outwards, platform joints inwards
            for i, point in enumerate(bones.points.get(name, ())):
                away = _on_page(ax, point) - centre
                shift = distance * away / max(float(np.linalg.norm(away)), 1e-9)
                label(ax, point, f"${name}_{i + 1}$", shift, leader=False, ha="center", va="center")
    return ax


def _new_axes(planar: bool) -> Any:
    from matplotlib import pyplot

    figure = pyplot.figure(figsize=(7.0, 5.0))
    if planar:
        return figure.add_subplot()
    ax: Any = figure.add_axes((0.0, 0.0, 1.0, 1.0), projection="3d")
    ax.view_init(elev=30, azim=-84)  # no leg is seen along its plane
    return ax


def draw_link(ax: Any, link: Link, **style: Any) -> None:
    """One link as a thick line; `style` goes to Matplotlib's plot."""
    width = 2.2 if link.kind is Kind.FIXED else 3.4
    options = {"color": COLOURS[link.kind], "linewidth": width, "solid_capstyle": "round", **style}
    _plot(ax, np.stack([link.start, link.end]), **options)


def draw_joints(ax: Any, points: Array, **style: Any) -> None:
    """Joints as small white discs."""
    options = {"marker": "o", "linestyle": "none", "markersize": 5, "zorder": 5, **style}
    _plot(ax, points, **{"markerfacecolor": "white", "markeredgecolor": "#222222", **options})


def draw_base(ax: Any, bones: Skeleton) -> None:
    """The triangle of the base joints."""
    _plot(ax, _closed(bones.points["A"]), color="#888888", linewidth=1.2, linestyle=(0, (4, 3)), zorder=1)


def draw_platform(ax: Any, bones: Skeleton) -> None:
    """The platform: the triangle of its joints, or, where end points slide, the slides from its centre."""
    corners = bones.platform
    if "B" in bones.points:
        _fill(ax, corners)
        _plot(ax, _closed(corners), color=PLATFORM_COLOUR, linewidth=2.4)
        return
    for corner in corners:
        reach = bones.origin + 1.25 * (corner - bones.origin)
        _plot(ax, np.stack([bones.origin, reach]), color=PLATFORM_COLOUR, linewidth=5, solid_capstyle="butt")


def draw_frame(ax: Any, origin: ArrayLike, axes: ArrayLike, length: float, names: Sequence[str] = ()) -> None:
    """The axes of a frame as arrows; `axes` has them as columns."""
    start, directions = np.asarray(origin, dtype=float), np.asarray(axes, dtype=float)
    for index in range(directions.shape[1]):
        along = length * directions[:, index]
        if ax.name == "3d":
            ax.quiver(*start, *along, color="#111111", linewidth=1.1, arrow_length_ratio=0.2)
        else:
            arrow = {"arrowstyle": "-|>", "color": "#111111", "shrinkA": 0, "shrinkB": 0, "linewidth": 1.1}
            ax.annotate("", start + along, start, arrowprops=arrow)
        if names:
            step = _on_page(ax, start + along) - _on_page(ax, start)
            shift = 8 * step / max(float(np.linalg.norm(step)), 1e-9)
            label(ax, start + along, names[index], shift, leader=False, ha="center", va="center")


def label(
    ax: Any, point: ArrayLike, text: str, offset: ArrayLike, *, leader: bool = True, **style: Any
) -> Any:
    """Write `text` beside a point, `offset` in points of the page; set the view of 3D axes before."""
    arrow = {"arrowstyle": "-", "color": "#777777", "linewidth": 0.7, "shrinkA": 1, "shrinkB": 3}
    options = {"fontsize": 11, "zorder": 20, **style}
    return ax.annotate(
        text,
        _on_page(ax, point),
        np.asarray(offset, dtype=float),
        textcoords="offset points",
        arrowprops=arrow if leader else None,
        annotation_clip=False,
        **options,
    )


def _on_page(ax: Any, point: ArrayLike) -> Array:
    """A point in the coordinates of the page: projected where the axes are three-dimensional."""
    position = np.asarray(point, dtype=float)
    if ax.name == "3d":
        from mpl_toolkits.mplot3d import proj3d

        position = np.array(proj3d.proj_transform(*position, ax.get_proj())[:2])
    return position


def _plot(ax: Any, points: Array, **style: Any) -> None:
    ax.plot(*points.T, clip_on=False, **style)


def _closed(points: Array) -> Array:
    return np.vstack([points, points[:1]])


def _fill(ax: Any, corners: Array) -> None:
    if ax.name == "3d":
        from mpl_toolkits.mplot3d.art3d import Poly3DCollection

        ax.add_collection3d(Poly3DCollection([corners], facecolor=PLATFORM_COLOUR, alpha=0.35))
    else:
        ax.fill(*corners.T, facecolor=PLATFORM_COLOUR, alpha=0.35, zorder=1)


def _frame_picture(ax: Any, bones: Skeleton) -> None:
    """Equal scales, no box, limits that hold every point."""
    everything = np.vstack([*bones.points.values(), bones.origin[np.newaxis]])
    low, high = everything.min(axis=0), everything.max(axis=0)
    middle, half = (low + high) / 2, 0.54 * (high - low) + 1e-9
    ax.set_axis_off()
    if ax.name == "3d":
        ax.set_box_aspect(tuple(half), zoom=1.2)  # Matplotlib scales an array in place
        for centre, reach, limit in zip(middle, half, (ax.set_xlim, ax.set_ylim, ax.set_zlim), strict=True):
            limit(centre - reach, centre + reach)
    else:
        ax.set_aspect("equal")
        ax.margins(0.08)


__all__ = [
    "COLOURS",
    "Kind",
    "Link",
    "Skeleton",
    "draw",
    "draw_base",
    "draw_frame",
    "draw_joints",
    "draw_link",
    "draw_platform",
    "label",
    "skeleton",
]
