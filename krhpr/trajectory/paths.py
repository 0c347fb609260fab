"""Cartesian paths of the platform: way-points with times, functions of time, and the thesis' own.

A path gives pose and twist at any time.  Positions are interpolated by straight lines or cubic splines,
orientations on SO(3): by turning about a fixed axis at a constant rate (SLERP), or by a spline with
continuous angular acceleration.  Metres, seconds, radians; a planar robot has the angle phi in place of Q.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from enum import StrEnum
from functools import cached_property, partial
from math import radians
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from krhpr.errors import TrajectoryError
from krhpr.study import trajectory as thesis

Floats = NDArray[np.float64]


class PathError(TrajectoryError):
    """A path that cannot be followed: too few way-points, times that do not increase, or what is no pose."""


class Interpolation(StrEnum):
    """What is between way-points."""

    LINEAR = "linear"
    """Straight lines and turns about fixed axes; the twist jumps at way-points."""
    SPLINE = "spline"
    """Cubic splines; twist and acceleration are continuous."""


@dataclass(frozen=True)
class Motion:
    """Poses and their rates at some times, arrays with the times first."""

    times: Floats
    p: Floats
    """(..., 3), or (..., 2) in the plane; m."""
    Q: Floats
    """Rotation matrices (..., 3, 3), or angles phi (...) in the plane."""
    twist: Floats
    """[p_dot, omega] (..., 6) or [p_dot, phi_dot] (..., 3) in the base frame; m/s, rad/s."""
    twist_rate: Floats
    """Its rate; m/s^2, rad/s^2."""


@dataclass(frozen=True)
class Path:
    """Poses of the platform at increasing times, and what lies between them."""

    times: Floats
    p: Floats
    Q: Floats
    interpolation: Interpolation = Interpolation.SPLINE
    name: str = "path"

    def __post_init__(self) -> None:
        for field in ("times", "p", "Q"):
            object.__setattr__(self, field, np.array(getattr(self, field), dtype=float))
        self._check()

    def _check(self) -> None:
        count = len(self.times) if self.times.ndim == 1 else 0
        if count < 2:
            raise PathError(f"{self.name}: {count} way-points; a path takes two or more")
        shapes = {"p": (count, 2 if self.planar else 3), "Q": (count,) if self.planar else (count, 3, 3)}
        for field, shape in shapes.items():
            got = getattr(self, field).shape
            if got != shape:
                raise PathError(f"{self.name}: {field} has shape {got}, expected {shape} for {count} times")
        for field in ("times", "p", "Q"):
            if not np.isfinite(getattr(self, field)).all():
                raise PathError(f"{self.name}: {field} has values that are not finite")
        steps = np.diff(self.times)
        if (steps <= 0).any():
            k = int(np.argmax(steps <= 0))
            raise PathError(
                f"{self.name}: times must increase; way-point {k + 2} is at {self.times[k + 1]:g} s and the "
                f"one before at {self.times[k]:g} s"
            )
        if not self.planar:
            error = np.abs(np.swapaxes(self.Q, 1, 2) @ self.Q - np.eye(3)).max(axis=(1, 2))
            wrong = (error > 1e-6) | (np.linalg.det(self.Q) < 0)
            if wrong.any():
                k = int(np.argmax(wrong))
                raise PathError(f"{self.name}: Q of way-point {k + 1} is not a rotation matrix")

    @property
    def planar(self) -> bool:
        """Whether it is the path of a planar robot."""
        return self.p.ndim == 2 and self.p.shape[1] == 2

    @property
    def duration(self) -> float:
        """From the first way-point to the last, in seconds."""
        return float(self.times[-1] - self.times[0])

    def at(self, times: ArrayLike) -> Motion:
        """Poses, twists and their rates at times (n) between the first and the last way-point."""
        at = np.asarray(times, dtype=float)
        x, v, a = (curve(at) for curve in self._curves)
        if self.planar:
            return Motion(at, x[:, :2], x[:, 2], v, a)
        Q, omega, alpha = self._turns(at)
        return Motion(at, x, Q, np.column_stack([v, omega]), np.column_stack([a, alpha]))

    @property
    def _linear(self) -> bool:
        return self.interpolation is Interpolation.LINEAR or len(self.times) == 2

    @cached_property
    def _curves(self) -> tuple[Any, Any, Any]:
        """The position, in the plane with phi, and its derivatives, as functions of time."""
        from scipy.interpolate import CubicSpline, make_interp_spline

        values = np.column_stack([self.p, self.Q]) if self.planar else self.p
        linear = self._linear
        curve = make_interp_spline(self.times, values, 1) if linear else CubicSpline(self.times, values)
        if linear:
            return curve, curve.derivative(), partial(_still, columns=values.shape[1])
        return curve, curve.derivative(), curve.derivative(2)

    @cached_property
    def _spline(self) -> Any:
        """Orientations with a continuous angular acceleration."""
        from scipy.spatial.transform import Rotation, RotationSpline

        return RotationSpline(self.times, Rotation.from_matrix(self.Q))

    @cached_property
    def _steps(self) -> tuple[Any, Floats]:
        """Orientations of the way-points, and the constant angular velocities between them."""
        from scipy.spatial.transform import Rotation

        given = Rotation.from_matrix(self.Q)
        return given, (given[1:] * given[:-1].inv()).as_rotvec() / np.diff(self.times)[:, None]

    def _turns(self, at: Floats) -> tuple[Floats, Floats, Floats]:
        """Orientations, angular velocities and accelerations in the base frame."""
        from scipy.spatial.transform import Rotation

        if not self._linear:
            Q = self._spline(at).as_matrix()
            # SciPy has them in the platform frame
            omega, alpha = (np.einsum("kij,kj->ki", Q, self._spline(at, order)) for order in (1, 2))
            return Q, omega, alpha
        given, turn = self._steps
        place = np.clip(np.searchsorted(self.times, at, side="right") - 1, 0, len(turn) - 1)
        since = Rotation.from_rotvec(turn[place] * (at - self.times[place])[:, None])
        return (since * given[place]).as_matrix(), turn[place], np.zeros((len(at), 3))


def _still(at: Floats, columns: int) -> Floats:
    return np.zeros((len(at), columns))


def way_points(
    times: ArrayLike,
    p: ArrayLike,
    Q: ArrayLike,
    interpolation: Interpolation | str = Interpolation.SPLINE,
    name: str = "path",
) -> Path:
    """A path through poses at given times; two of them are joined by a straight line and one turn.

    Args:
        times: when it is there (n), increasing; seconds.
        p: positions (n, 3), or (n, 2) in the plane; metres.
        Q: rotation matrices (n, 3, 3), or angles (n) in the plane; radians.
        interpolation: what is between them.
        name: in messages and results.

    Raises:
        PathError: fewer than two way-points, times that do not increase, or what is no pose.
    """
    arrays = [np.asarray(x, dtype=float) for x in (times, p, Q)]
    return Path(arrays[0], arrays[1], arrays[2], Interpolation(interpolation), name)


def function_of_time(
    pose: Callable[[float], tuple[Any, Any]], duration: float, count: int = 201, name: str = "path"
) -> Path:
    """A path from a function of time in seconds that gives (p, Q), or (p, phi) in the plane.

    It is sampled at `count` times and joined by splines, so that corners are rounded.

    Raises:
        PathError: the function gives no poses, or `duration` is not positive.
    """
    if not duration > 0:
        raise PathError(f"{name}: the duration is {duration:g} s; it must be positive")
    times = np.linspace(0.0, duration, count)
    poses = [pose(float(time)) for time in times]
    return way_points(times, [p for p, _ in poses], [Q for _, Q in poses], Interpolation.SPLINE, name)


# -- of the thesis -------------------------------------------------------------------------------------------


def translation(duration: float = 6.0) -> Path:
    """Section 4.3: along the x axis from 0 to 300 mm at z = 350 mm (T1)."""
    return way_points([0.0, duration], [[0.0, 0.0, 0.35], [0.3, 0.0, 0.35]], [np.eye(3)] * 2, "linear", "T1")


def tilt(duration: float = 4.0) -> Path:
    """Section 4.3: a tilt from 0 to 80 degrees about y' at z = 350 mm (T2)."""
    c, s = np.cos(radians(80)), np.sin(radians(80))
    turned = [[c, 0.0, s], [0.0, 1.0, 0.0], [-s, 0.0, c]]
    return way_points([0.0, duration], [[0.0, 0.0, 0.35]] * 2, np.array([np.eye(3), turned]), "linear", "T2")


def example(duration: float = 36.0) -> Path:
    """Sections 1.8 and 3.4: tilt, translation, circle and back, (1.46) to (1.49), in 720 equal steps of
    time."""
    p, Q = thesis.trajectory()
    times = np.linspace(0.0, duration, len(p))
    return way_points(times, p / 1000, Q, Interpolation.LINEAR, "example of Section 1.8")


BUILT_IN: dict[str, Callable[[], Path]] = {
    "T1": translation,
    "T2": tilt,
    "section-1.8": example,
    "section-3.4": example,
}
"""Paths of the thesis by name; those of Section 4.3 are T1 and T2."""
