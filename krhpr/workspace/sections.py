"""The workspaces of Section 1.7, in one call each."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike, NDArray

from krhpr.branches import Branch
from krhpr.errors import WorkspaceError
from krhpr.robot import Robot
from krhpr.workspace.axes import Layers, TiltTorsion, directions, steps
from krhpr.workspace.choices import Redundancy, choose, constant
from krhpr.workspace.execute import Progress, run
from krhpr.workspace.limits import Stop, WorkspaceLimits, section_1_7
from krhpr.workspace.maps import BoundaryMap, Workspace
from krhpr.workspace.margins import Examiner
from krhpr.workspace.trace import Tracing

Floats = NDArray[np.float64]

DEGREE = np.pi / 180
FARTHEST = 2.0
"""Metres beyond which no boundary is looked for, unless told."""


@dataclass(frozen=True)
class Torsion:
    """The torsion angles (1.42) around zero, without tilt (rad), and what stops them."""

    low: float
    high: float
    stopped_low: str
    stopped_high: str

    @property
    def span(self) -> float:
        """From the least to the largest."""
        return self.high - self.low


def translational(
    robot: Robot,
    heights: ArrayLike,
    *,
    limits: WorkspaceLimits | None = None,
    redundancy: Redundancy | ArrayLike | None = None,
    Q: ArrayLike | None = None,
    step: float = 0.001,
    rays: int = 360,
    farthest: float = FARTHEST,
    tracing: Tracing | str = Tracing.BISECT,
    coarse: int = 16,
    with_indices: bool = False,
    mode: Branch | None = None,
    store: str | Path | None = None,
    workers: int | str = 1,
    progress: Progress | None = None,
) -> Workspace:
    """Boundaries of the layers at `heights` along rays from the z-axis, (1.38), (1.39).

    Unless given, limits are those of the robot's file, or where it has none those of Section 1.7, and
    redundant coordinates are those of the home pose.
    """
    turned = np.eye(3) if Q is None else np.asarray(Q, dtype=float)
    family = Layers(tuple(tuple(row) for row in turned.tolist()))
    axes = family.axes(heights, directions(rays), steps(0.0, farthest, step))
    job = BoundaryMap(
        robot,
        _limits(robot, limits),
        _redundancy(robot, redundancy),
        family,
        axes,
        mode,
        with_indices,
        tracing=Tracing(tracing),
        coarse=coarse,
    )
    return run(job, store=store, workers=workers, progress=progress)


def torsion(
    robot: Robot,
    *,
    limits: WorkspaceLimits | None = None,
    redundancy: Redundancy | ArrayLike | None = None,
    p: Sequence[float] | None = None,
    step: float = DEGREE,
    mode: Branch | None = None,
) -> Torsion:
    """The first step of Section 1.7.2: the torsion angles that can be reached from zero without tilt.

    Raises:
        WorkspaceError: there are none: what stops the pose without torsion.
    """
    examiner = Examiner(robot, _limits(robot, limits), mode=mode)
    chosen = _redundancy(robot, redundancy)
    family = TiltTorsion(_position(robot, p))
    angles = steps(0.0, np.pi, step)
    ends, names = [], []
    for side in (-1.0, 1.0):
        nothing = np.zeros(len(angles))
        answer = choose(examiner, chosen, *family.poses(side * angles, nothing, nothing))
        stopped = np.flatnonzero(answer.stops != Stop.NONE)
        first = int(stopped[0]) if len(stopped) else len(angles)
        name = examiner.name(int(answer.stops[first]), int(answer.which[first])) if len(stopped) else ""
        if first == 0:
            raise WorkspaceError(
                f"{robot.name}: the platform cannot be at p = {list(family.p)} without torsion and "
                f"tilt: {name}"
            )
        ends.append(side * float(angles[first - 1]))
        names.append(name)
    return Torsion(ends[0], ends[1], names[0], names[1])


def orientational(
    robot: Robot,
    *,
    limits: WorkspaceLimits | None = None,
    redundancy: Redundancy | ArrayLike | None = None,
    p: Sequence[float] | None = None,
    torsions: ArrayLike | None = None,
    step: float = DEGREE,
    rays: int = 360,
    steepest: float = np.pi,
    tracing: Tracing | str = Tracing.BISECT,
    coarse: int = 16,
    with_indices: bool = False,
    mode: Branch | None = None,
    store: str | Path | None = None,
    workers: int | str = 1,
    progress: Progress | None = None,
) -> Workspace:
    """The largest tilt about each direction, (1.43) to (1.45), at each torsion: the second step of 1.7.2.

    `torsions` are those that can be reached without tilt, in steps of `step`, unless given; `p` is the home
    position unless given.  Limits and redundant coordinates as for `translational`.
    """
    held = _limits(robot, limits)
    chosen = _redundancy(robot, redundancy)
    family = TiltTorsion(_position(robot, p))
    if torsions is None:
        span = torsion(robot, limits=held, redundancy=chosen, p=family.p, step=step, mode=mode)
        torsions = step * np.arange(round(span.low / step), round(span.high / step) + 1)
    axes = family.axes(torsions, directions(rays), steps(0.0, steepest, step))
    job = BoundaryMap(
        robot, held, chosen, family, axes, mode, with_indices, tracing=Tracing(tracing), coarse=coarse
    )
    return run(job, store=store, workers=workers, progress=progress)


def _limits(robot: Robot, given: WorkspaceLimits | None) -> WorkspaceLimits:
    if given is not None:
        return given
    return WorkspaceLimits() if robot.limits else section_1_7(robot)


def _redundancy(robot: Robot, given: Redundancy | ArrayLike | None) -> Redundancy:
    if isinstance(given, Redundancy):
        return given
    return constant(robot.home.redundant if given is None else given)


def _position(robot: Robot, given: Sequence[float] | None) -> tuple[float, float, float]:
    x, y, z = (float(value) for value in (robot.home.p if given is None else given))
    return x, y, z
