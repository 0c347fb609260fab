"""A labelled picture of a robot at its home pose: `krhpr info ROBOT --picture FILE`.

    from krhpr.picture import picture, save_picture

    save_picture(krhpr.load("spatial_delta_a"), "delta.svg")

Leg 1 has the names of its joints and lengths, as the geometry and `link_points` call them; actuated joints
are marked and coloured by kind.  The file is a function of the robot and of Matplotlib's version.
"""

from __future__ import annotations

import os
import re
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from krhpr.drawing import (
    ACTUATOR_COLOURS,
    COLOURS,
    Kind,
    Skeleton,
    draw,
    draw_frame,
    draw_skeleton,
    label,
    on_page,
    skeleton,
)
from krhpr.robot import Branch, Robot

Array = NDArray[np.float64]

FORMATS = (".png", ".svg", ".pdf")
SIZE = {True: (7.6, 7.0), False: (8.6, 7.0)}
VIEW = (24.0, -72.0)
"""Elevation and azimuth from which no leg of a spatial robot is seen along its plane."""
STYLE: Any = {
    "font.family": "DejaVu Sans",
    "mathtext.fontset": "dejavusans",
    "figure.facecolor": "white",
    "savefig.facecolor": "white",
    "svg.hashsalt": "krhpr",
}
MARKS = {"revolute": "o", "prismatic": "s"}


def save_picture(robot: Robot, path: str | os.PathLike[str], mode: Branch | None = None) -> None:
    """Write `picture` to a file; its ending, one of FORMATS, says how.  No date gets into it."""
    import matplotlib
    from matplotlib import pyplot

    metadata: Any = {
        ".png": {"Software": None},
        ".svg": {"Date": None, "Creator": None},
        ".pdf": {"CreationDate": None, "Creator": None, "Producer": None},
    }
    with matplotlib.rc_context(STYLE):
        figure = picture(robot, mode)
        try:
            figure.savefig(path, dpi=150, metadata=metadata[Path(path).suffix.lower()])
        finally:
            pyplot.close(figure)


def picture(robot: Robot, mode: Branch | None = None) -> Any:
    """A figure of the robot at home, with names and a legend."""
    from matplotlib import pyplot

    figure = pyplot.figure(figsize=SIZE[robot.planar])
    box = (0.03, 0.10, 0.94, 0.80)
    ax: Any = figure.add_axes(box) if robot.planar else figure.add_axes(box, projection="3d")
    if not robot.planar:
        ax.view_init(*VIEW)
    bones = draw_home(robot, ax, mode, named=True)
    if not robot.planar:
        fill(ax, np.vstack([*bones.points.values(), np.zeros((1, 3))]), (0.07, 0.93, 0.13, 0.87))
    figure.canvas.draw()  # the projection that labels need
    _write_names(ax, robot, bones)
    figure.text(0.5, 0.955, f"{robot.notation}  ({robot.name})", ha="center", fontsize=14)
    figure.text(0.5, 0.922, robot.title, ha="center", fontsize=9.5, color="#555555")
    _legend(figure, robot)
    return figure


def fill(ax: Any, points: Array, box: tuple[float, float, float, float]) -> None:
    """Scale and shift 3D axes so that points fill a box of the figure: left, right, low, high."""
    figure, (left, right, low, high) = ax.figure, box

    def extent() -> tuple[Array, Array]:
        figure.canvas.draw()
        pixels = ax.transData.transform([on_page(ax, point) for point in points])
        page = figure.transFigure.inverted().transform(pixels)
        return page.min(axis=0), page.max(axis=0)

    lowest, highest = extent()
    scale = float(np.min(np.array([right - left, high - low]) / (highest - lowest)))
    place = ax.get_position()
    width, height = place.width * scale, place.height * scale
    ax.set_position((0.5 - width / 2, 0.5 - height / 2, width, height))
    lowest, highest = extent()
    x, y = np.array([left + right, low + high]) / 2 - (lowest + highest) / 2
    ax.set_position((0.5 - width / 2 + x, 0.5 - height / 2 + y, width, height))


def draw_leg(robot: Robot, ax: Any, box: tuple[float, float, float, float]) -> None:
    """Leg 1 of a robot at home with names, without platform; a spatial one fills `box` of the figure."""
    whole = skeleton(robot, *robot.home)
    points = {name: at[:1] for name, at in whole.points.items() if name != "B"}
    links = tuple(link for link in whole.of_leg(1) if link.kind is not Kind.REDUNDANT)
    bones = replace(whole, points=points, links=links, slides=None, middles=None)
    draw_skeleton(ax, bones)
    mark_actuators(ax, robot, bones, size=6.5)
    if not robot.planar:
        fill(ax, np.vstack(list(points.values())), box)
    ax.figure.canvas.draw()
    names = _Names(ax, bones)
    _write_actuators(names, robot, bones)
    names.write(points["S"][0], "$S$", fontsize=9)
    _write_joints(names, bones, fontsize=8)
    _write_links(names, robot, bones, fontsize=9)


def draw_home(robot: Robot, ax: Any, mode: Branch | None = None, *, named: bool = False) -> Skeleton:
    """The robot at home with its actuators marked, and the base frame, its axes perhaps named."""
    p, orientation, redundant = robot.home
    bones = skeleton(robot, p, orientation, redundant, mode)
    draw(robot, p, orientation, redundant, mode, ax, labels=False)
    mark_actuators(ax, robot, bones)
    names = ("$x$", "$y$", "$z$")[: len(bones.origin)] if named else ()
    draw_frame(ax, np.zeros_like(bones.origin), np.eye(len(bones.origin)), _frame_length(bones), names)
    return bones


def _frame_length(bones: Skeleton) -> float:
    return 0.16 * float(np.ptp(np.vstack(list(bones.points.values())), axis=0).max())


def mark_actuators(ax: Any, robot: Robot, bones: Skeleton, size: float = 8.5) -> None:
    """A disc at each actuated revolute joint, a square on each actuated slide or strut."""
    kinds = dict(robot.documentation["joint kinds"])
    for name, place in robot.documentation["actuated at"]:
        style = {"marker": MARKS[kinds[name]], "color": ACTUATOR_COLOURS[kinds[name]], "markersize": size}
        # two joints may share an axis: the second one is the ring around the first
        shared = [other for other, at in robot.documentation["actuated at"] if at == place].index(name)
        if shared:
            style |= {"markerfacecolor": "none", "markeredgewidth": 1.4, "markersize": 1.6 * size}
        points = np.stack(
            [_place(bones, place, leg, kinds[name]) for leg in sorted({link.leg for link in bones.links})]
        )
        ax.plot(*points.T, linestyle="none", zorder=6, clip_on=False, **style)


def _place(bones: Skeleton, place: str, leg: int, kind: str) -> Array:
    """A point of a leg by its name, or the place of a joint on the link of that name."""
    if place in bones.points:
        point: Array = bones.points[place][leg - 1]
        return point
    link = next(link for link in bones.of_leg(leg) if link.name == place)
    share = 1.0 if link.kind is Kind.SLIDE else 0.55 if kind == "prismatic" else 0.5
    return link.start + share * (link.end - link.start)


# -- names ---------------------------------------------------------------------------------------------------


def symbol(name: str, index: str = "") -> str:
    """A name as mathematics: `theta_1`, `l_2`, `beta`, `A`."""
    match = re.fullmatch(r"([A-Za-z]+)(?:_(\w+))?", name)
    if match is None:
        return name
    letter = match[1] if len(match[1]) == 1 else rf"\{match[1]}"
    below = ",".join(part for part in (index, match[2]) if part)
    return f"${letter}_{{{below}}}$" if below else f"${letter}$"


def _write_names(ax: Any, robot: Robot, bones: Skeleton) -> None:
    names = _Names(ax, bones)
    # what matters most finds its place first
    _write_actuators(names, robot, bones)
    for name in ("S", "B"):
        for i, point in enumerate(bones.points.get(name, ())):
            names.write(point, symbol(name, str(i + 1)))
    _write_joints(names, bones, fontsize=10)
    _write_links(names, robot, bones, fontsize=11)
    feet = next(iter(bones.points.values())) if bones.feet is None else bones.feet
    for i in (1, 2):
        names.write(feet[i], f"leg {i + 1}", fontsize=9, color="#777777")
    for group in _coincident({"$O$": np.zeros_like(bones.origin), "$O'$": bones.origin}):
        at = bones.origin if group[0] != "$O$" else np.zeros_like(bones.origin)
        names.write(at, ", ".join(group), fontsize=10)


def _write_actuators(names: _Names, robot: Robot, bones: Skeleton) -> None:
    kinds = dict(robot.documentation["joint kinds"])
    for name, place in robot.documentation["actuated at"]:
        point = _place(bones, place, 1, kinds[name])
        names.write(point, symbol(name), color=ACTUATOR_COLOURS[kinds[name]], fontsize=12)


def _write_joints(names: _Names, bones: Skeleton, fontsize: float) -> None:
    for group in _coincident({name: at[0] for name, at in bones.points.items() if name not in "SB"}):
        text = ", ".join(symbol(name) for name in group)
        names.write(bones.points[group[0]][0], text, fontsize=fontsize, color="#444444")


def _write_links(names: _Names, robot: Robot, bones: Skeleton, fontsize: float) -> None:
    written = {name for name, _ in robot.documentation["actuators"]}
    for link in bones.of_leg(1):
        if link.name not in written and link.length > 1e-9:
            written.add(link.name)
            middle = (link.start + link.end) / 2
            names.write(middle, symbol(link.name), color=COLOURS[link.kind], fontsize=fontsize)


def _coincident(points: Mapping[str, Array]) -> list[list[str]]:
    """Names of points, those of one place together."""
    groups: list[list[str]] = []
    for name, point in points.items():
        same = [group for group in groups if np.abs(points[group[0]] - point).max() < 1e-9]
        if same:
            same[0].append(name)
        else:
            groups.append([name])
    return groups


class _Names:
    """Writes names where they cover neither links nor joints nor one another."""

    def __init__(self, ax: Any, bones: Skeleton) -> None:
        self.ax = ax
        self.boxes: list[tuple[float, float, float, float]] = []
        self.segments = [np.stack([self._pixel(link.start), self._pixel(link.end)]) for link in bones.links]
        corners = bones.platform if bones.middles is None else bones.middles
        self.segments += self._ring(corners)
        if bones.feet is not None:
            self.segments += self._ring(bones.feet)
        frame = 1.2 * _frame_length(bones) * np.eye(len(bones.origin))
        zero = np.zeros_like(bones.origin)
        self.segments += [np.stack([self._pixel(zero), self._pixel(axis)]) for axis in frame]
        joints = np.stack([self._pixel(point) for point in np.vstack(list(bones.points.values()))])
        turns = np.arange(8) * np.pi / 4
        around = 4.0 * np.stack([np.cos(turns), np.sin(turns)], axis=1)
        self.samples = np.vstack(
            [
                *(a + np.linspace(0, 1, 40)[:, np.newaxis] * (b - a) for a, b in self.segments),
                (joints[:, np.newaxis] + around).reshape(-1, 2),
            ]
        )

    def _ring(self, corners: Array) -> list[Array]:
        return [
            np.stack([self._pixel(a), self._pixel(b)])
            for a, b in zip(corners, np.roll(corners, 1, 0), strict=True)
        ]

    def _pixel(self, point: Array) -> Array:
        """A point in points of the page."""
        found: Array = np.asarray(self.ax.transData.transform(on_page(self.ax, point)), dtype=float)
        return found * (72.0 / float(self.ax.figure.dpi))

    def write(self, point: Array, text: str, fontsize: float = 11, color: str = "#111111") -> None:
        """Write beside a point: the nearest place that is free, else the least covered one."""
        at = self._pixel(point)
        letters = len(re.sub(r"\\[a-z]+", "x", text).translate(str.maketrans("", "", "${}_\\")))
        half = np.array([0.31 * fontsize * letters + 1.0, 0.62 * fontsize])
        best, least = (0.0, 0.0), np.inf
        for distance in (13.0, 18.0, 25.0, 34.0):
            for turn in range(16):
                angle = 2 * np.pi * turn / 16
                shift = (distance + 0.5 * (half[0] - half[1]) * abs(np.cos(angle))) * np.array(
                    [np.cos(angle), np.sin(angle)]
                )
                cost = 0.35 * distance + self._covered(at + shift, half)
                if cost < least - 1e-6:
                    least, best = cost, (float(shift[0]), float(shift[1]))
        x, y = at + np.array(best)
        self.boxes.append((x - half[0], x + half[0], y - half[1], y + half[1]))
        far = float(np.hypot(*best)) > 24
        style = {"ha": "center", "va": "center", "fontsize": fontsize, "color": color}
        label(self.ax, point, text, best, leader=far, **style)

    def _covered(self, centre: Array, half: Array) -> float:
        inside = (np.abs(self.samples - centre) < half + 2.0).all(axis=1).sum()
        over = sum(
            max(0.0, min(centre[0] + half[0], high) - max(centre[0] - half[0], low))
            * max(0.0, min(centre[1] + half[1], top) - max(centre[1] - half[1], bottom))
            for low, high, bottom, top in self.boxes
        )
        return 2.0 * float(inside) + 0.4 * float(over)


def _legend(figure: Any, robot: Robot) -> None:
    """What the marks mean."""
    from matplotlib.lines import Line2D

    kinds = dict(robot.documentation["joint kinds"])
    used = [
        kind for kind in MARKS if any(kinds[name] == kind for name, _ in robot.documentation["actuators"])
    ]
    entries = [
        Line2D([], [], linestyle="none", marker=MARKS[kind], color=ACTUATOR_COLOURS[kind], markersize=8)
        for kind in used
    ]
    entries.append(
        Line2D([], [], linestyle="none", marker="o", color="#222222", markerfacecolor="white", markersize=6)
    )
    names = [f"actuated, {kind}" for kind in used] + ["passive joint"]
    if robot.redundant_link:
        entries.append(Line2D([], [], color=COLOURS[Kind.REDUNDANT], linewidth=3.4))
        names.append("redundant link")
    (redundant, _), *_ = robot.documentation["redundant"]
    names_of_legs = ", ".join(symbol(redundant, str(i)) for i in (1, 2, 3))
    figure.legend(entries, names, loc="lower center", ncols=4, frameon=False, fontsize=9.5)
    figure.text(0.5, 0.065, f"redundant coordinates {names_of_legs}", ha="center", fontsize=9.5)


__all__ = ["FORMATS", "draw_home", "draw_leg", "fill", "mark_actuators", "picture", "save_picture", "symbol"]
