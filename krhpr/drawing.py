"""A robot as points and straight links, and pictures of it.

    from krhpr.drawing import draw, skeleton

    bones = skeleton(robot, p, Q, redundant)    # NumPy alone
    draw(robot, p, Q, redundant)                # Matplotlib

Every point comes from the generated functions: joints from `inverse`, their places from `link_points`.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from enum import StrEnum
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from krhpr.errors import NoConvergence
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
    PARALLELOGRAM = "parallelogram"
    REDUNDANT = "redundant"


COLOURS: Mapping[Kind, str] = {
    Kind.FIXED: "#555555",
    Kind.SLIDE: "#56b4e9",
    Kind.PROXIMAL: "#0072b2",
    Kind.DISTAL: "#d55e00",
    Kind.CRANK: "#009e73",
    Kind.ROD: "#a05a90",
    Kind.STRUT: "#0072b2",
    Kind.PARALLELOGRAM: "#d55e00",
    Kind.REDUNDANT: "#111111",
}
PLATFORM_COLOUR = "#e6b800"
RAIL_COLOUR, CYLINDER_COLOUR, BAR_COLOUR = "#c9d3da", "#7fa8c9", "#e08a4a"
ACTUATOR_COLOURS: Mapping[str, str] = {"revolute": "#cc0000", "prismatic": "#0b8f3c"}


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
    slides: Array | None = None
    """Directions of the platform's slides in the base frame, a row for each leg; None without slides."""
    middles: Array | None = None
    """Where on the slides the redundant coordinates are zero."""

    @property
    def platform(self) -> Array:
        """The platform's joints: revolute ones or sliders, or the end points where these slide on it."""
        return self.points["B"] if "B" in self.points else self.points["S"]

    @property
    def feet(self) -> Array | None:
        """Where the legs stand: A, c, or the middle of three joints; None where no point is fixed."""
        if "G_1" in self.points:
            return (self.points["G_1"] + self.points["G_2"] + self.points["G_3"]) / 3
        return self.points.get("A", self.points.get("c"))

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
    given; `theta` are the joints themselves.  Where `inverse` has no closed form and no joints are given,
    they are those to which Newton steps lead from the first of some fixed starts.  Raises Unreachable where
    a leg cannot reach its end point, NoConvergence where no start leads to joints.
    """
    s = np.asarray(robot.end_points(p, orientation, redundant))
    if theta is None:
        theta = _joints(robot, (p, orientation, redundant), mode)
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
    found = Skeleton(points, links, np.asarray(theta), np.asarray(p, dtype=float), axes)
    if robot.signature("passive_joints").outputs[-1].unit != "m":
        return found
    d = np.broadcast_to(np.asarray(redundant, dtype=float), (3,))
    along = np.asarray(robot.end_points(p, orientation, d + 1.0)) - s
    return replace(found, slides=along, middles=found.platform - d[:, np.newaxis] * along)


_STARTS = 200
"""How many starts Newton steps are tried from."""


def _joints(robot: Robot, pose: tuple[ArrayLike, ArrayLike, ArrayLike], mode: Branch | None) -> Array:
    """Joints at a pose, in a mode or by Newton steps."""
    if all(port.name != "theta_near" for port in robot.signature("inverse").inputs):
        return np.asarray(robot.inverse(*pose, mode=mode, check=True))
    about = robot.documentation
    kinds, names = dict(about["joint kinds"]), [name for name, _ in about["actuators"]]
    angular = np.array([kinds[name] == "revolute" for name in names])
    shares = np.random.default_rng(0).uniform(-1, 1, (_STARTS, 1, len(names)))  # alike for all legs
    near = np.broadcast_to(shares * np.where(angular, np.pi, 0.5), (_STARTS, 3, len(names)))
    found = np.asarray(robot.inverse(*pose, near=near))
    found = np.where(angular, found - 2 * np.pi * np.round(found / (2 * np.pi)), found)
    solved = np.isfinite(found).all(axis=-1)  # (starts, 3)
    if not solved.any(axis=0).all():
        leg = int(np.argmin(solved.any(axis=0))) + 1
        raise NoConvergence(
            f"{robot.identifier}: Newton steps from {_STARTS} starts find no joints of leg {leg}"
        )
    alike = solved.all(axis=1)
    if alike.any():
        return np.asarray(found[np.argmax(alike)])
    first: Array = np.take_along_axis(found, np.argmax(solved, axis=0)[None, :, None], axis=0)[0]
    return first


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
    draw_skeleton(ax, bones)
    if labels:
        centre = on_page(ax, bones.platform.mean(axis=0))
        for name, distance in (("S", 13), ("B", -13)):  # end points outwards, platform joints inwards
            for i, point in enumerate(bones.points.get(name, ())):
                away = on_page(ax, point) - centre
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


def draw_skeleton(ax: Any, bones: Skeleton) -> None:
    """Links and joints alone."""
    for link in bones.links:
        _draw_around(ax, link, bones)
        draw_link(ax, link)
    for points in bones.points.values():
        draw_joints(ax, points)
    _frame_picture(ax, bones)


def draw_link(ax: Any, link: Link, **style: Any) -> None:
    """One link as a thick line, a slide's or a strut's travel as a thin one; `style` goes to Matplotlib's
    plot.
    """
    options = {"color": COLOURS[link.kind], "linewidth": 3.4, "solid_capstyle": "round"}
    options |= {**_STYLES.get(link.kind, {}), **style}
    _plot(ax, np.stack([link.start, link.end]), **options)


_STYLES: Mapping[Kind, Mapping[str, Any]] = {
    Kind.FIXED: {"linewidth": 2.2},
    Kind.SLIDE: {"linewidth": 1.8},
    Kind.STRUT: {"linewidth": 2.4},
    Kind.PARALLELOGRAM: {"linewidth": 0.8, "linestyle": (0, (3, 2))},
}


def _draw_around(ax: Any, link: Link, bones: Skeleton) -> None:
    """What a link has around its line: a slide its rail, a strut its cylinder, a parallelogram its bars."""
    ends = np.stack([link.start, link.end])
    along = link.end - link.start
    if link.kind is Kind.SLIDE:
        reach = 0.1 * along + _RAIL * along / max(link.length, 1e-9)
        _plot(
            ax,
            ends + np.stack([-reach, reach]),
            color=RAIL_COLOUR,
            linewidth=7,
            solid_capstyle="butt",
            zorder=1.5,
        )
    elif link.kind is Kind.STRUT:
        cylinder = np.stack([link.start, link.start + 0.55 * along])
        _plot(ax, cylinder, color=CYLINDER_COLOUR, linewidth=7, solid_capstyle="butt", zorder=1.5)
    elif link.kind is Kind.PARALLELOGRAM:
        across = _parallelogram_axis(link, bones)
        bars = [ends + side * across for side in (-1, 1)]
        for bar in (*bars, *(np.stack([bars[0][i], bars[1][i]]) for i in (0, 1))):
            _plot(ax, bar, color=BAR_COLOUR, linewidth=2.2, solid_capstyle="round", zorder=1.8)


_RAIL = 0.02
"""What a rail reaches beyond the slider's travel, in the unit of length."""


def _parallelogram_axis(link: Link, bones: Skeleton) -> Array:
    """Half of a short side: normal to the arm that carries the parallelogram, and level."""
    arm = next(other for other in bones.of_leg(link.leg) if np.array_equal(other.end, link.start))
    level = np.cross(arm.end - arm.start, [0.0, 0.0, 1.0])
    half: Array = 0.05 * link.length * level / max(float(np.linalg.norm(level)), 1e-9)
    return half


def draw_joints(ax: Any, points: Array, **style: Any) -> None:
    """Joints as small white discs."""
    options = {"marker": "o", "linestyle": "none", "markersize": 5, "zorder": 5, **style}
    _plot(ax, points, **{"markerfacecolor": "white", "markeredgecolor": "#222222", **options})


def draw_base(ax: Any, bones: Skeleton) -> None:
    """The triangle of the base joints, or of the centres of what stands for them."""
    feet = bones.feet
    if "G_1" in bones.points:
        for i in range(3):
            ring = np.stack([bones.points[f"G_{n}"][i] for n in (1, 2, 3)])
            _plot(ax, _closed(ring), color="#888888", linewidth=1.2, zorder=1)
    if feet is not None:
        _plot(ax, _closed(feet), color="#888888", linewidth=1.2, linestyle=(0, (4, 3)), zorder=1)


def draw_platform(ax: Any, bones: Skeleton) -> None:
    """The platform: the triangle of its joints, or its slides and what joins them."""
    corners = bones.platform if bones.middles is None else bones.middles
    if np.ptp(corners, axis=0).max() > 1e-9:
        _fill(ax, corners)
        _plot(ax, _closed(corners), color=PLATFORM_COLOUR, linewidth=2.4, zorder=1.6)
    for corner, middle in zip(bones.platform, corners, strict=True):
        if bones.slides is not None:
            rail = np.stack([middle, corner + 0.25 * (corner - middle)])
            _plot(ax, rail, color=PLATFORM_COLOUR, linewidth=5, solid_capstyle="butt", zorder=1.6)


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
            step = on_page(ax, start + along) - on_page(ax, start)
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
        on_page(ax, point),
        np.asarray(offset, dtype=float),
        textcoords="offset points",
        arrowprops=arrow if leader else None,
        annotation_clip=False,
        **options,
    )


def on_page(ax: Any, point: ArrayLike) -> Array:
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
    middles = () if bones.middles is None else (bones.middles,)
    everything = np.vstack([*bones.points.values(), *middles, bones.origin[np.newaxis]])
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
    "ACTUATOR_COLOURS",
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
    "draw_skeleton",
    "label",
    "on_page",
    "skeleton",
]
