"""The fastest timing along a path: redundant coordinates and speed are chosen together.

The path's own time is a parameter u.  Unknown are the redundant coordinates as a spline over u, and the
squared speed b = (du/dt)^2, linear between samples, so that c = d^2u/dt^2 = b'/2 is constant there.  With
derivatives by u from the generated functions (a dash), rates and accelerations are

    theta_dot^2 = theta'^2 b,    theta_ddot = theta'' b + theta' c

linear in b and c; the duration is the sum of 2 du / (sqrt(b_k) + sqrt(b_k+1)).  Where accelerations are
limited the motion goes from rest to rest, and b is zero at both ends.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from krhpr.trajectory.examine import Coordinates
from krhpr.trajectory.paths import Interpolation, Motion, Path, PathError
from krhpr.trajectory.point import PointFunctions, Quantity
from krhpr.trajectory.refusals import ContradictoryLimits
from krhpr.trajectory.terms import Bounds
from krhpr.trajectory.transcription import Curve, Programme, Solved

Floats = NDArray[np.float64]

SLOWEST, FASTEST = 1e-10, 1e8
"""Bounds of the squared speed where it is not zero: far from what limits of joints leave."""


@dataclass(frozen=True)
class Clock:
    """When the path's parameter u (its own time) has which value: speeds at places u, accelerating evenly
    between them.
    """

    u: Floats
    """Places (n), increasing."""
    speed: Floats
    """du/dt there (n)."""

    @cached_property
    def times(self) -> Floats:
        """When u is there (n), from 0 on, s."""
        steps = 2 * np.diff(self.u) / (self.speed[1:] + self.speed[:-1])
        return np.concatenate([[0.0], np.cumsum(steps)])

    def at(self, times: Any) -> tuple[Floats, Floats, Floats]:
        """u, du/dt and d^2u/dt^2 at times (n)."""
        wanted = np.clip(np.asarray(times, dtype=float), 0.0, self.times[-1])
        k = np.clip(np.searchsorted(self.times, wanted, side="right") - 1, 0, len(self.u) - 2)
        since = wanted - self.times[k]
        gained = (np.diff(self.speed) / np.diff(self.times))[k]
        u = self.u[k] + self.speed[k] * since + gained * since**2 / 2
        return np.clip(u, self.u[0], self.u[-1]), self.speed[k] + gained * since, gained

    def slower(self, factor: float) -> Clock:
        """The same with all times longer by a factor."""
        return Clock(self.u, self.speed / factor)


@dataclass(frozen=True)
class Retimed:
    """A path with another timing."""

    path: Path
    clock: Clock

    @property
    def name(self) -> str:
        """That of the path."""
        return self.path.name

    @property
    def planar(self) -> bool:
        """Whether it is the path of a planar robot."""
        return self.path.planar

    @property
    def times(self) -> Floats:
        """The first and the last one, s."""
        return self.clock.times[[0, -1]]

    @property
    def duration(self) -> float:
        """What it takes, s."""
        return float(self.clock.times[-1])

    def at(self, times: Any) -> Motion:
        """Poses, twists and their rates at times (n)."""
        u, speed, gained = self.clock.at(times)
        own = self.path.at(u)
        v, a = speed[:, None], gained[:, None]
        return Motion(
            np.asarray(times, dtype=float), own.p, own.Q, own.twist * v, own.twist_rate * v**2 + own.twist * a
        )


@dataclass(frozen=True)
class RetimedCoordinates:
    """Redundant coordinates over u as a function of time."""

    over_u: Coordinates
    clock: Clock

    def at(self, times: Floats, order: int = 0) -> Floats:
        """Their values (n, 3), or their first or second derivatives."""
        u, speed, gained = self.clock.at(times)
        if order == 0:
            return self.over_u.at(u)
        slope = self.over_u.at(u, 1)
        if order == 1:
            return slope * speed[:, None]
        return self.over_u.at(u, 2) * speed[:, None] ** 2 + slope * gained[:, None]


def check_timing(path: Path, bounds: Bounds) -> None:
    """Whether there is a fastest timing.

    Raises:
        ContradictoryLimits: nothing limits the speed.
        PathError: accelerations are limited, and the path has corners.
    """
    if bounds.actuator_rate is None and bounds.actuator_acceleration is None:
        raise ContradictoryLimits(
            "the duration cannot be least where nothing limits it; give actuator_rate or "
            "actuator_acceleration"
        )
    corners = path.interpolation is Interpolation.LINEAR and len(path.times) > 2
    if corners and bounds.actuator_acceleration is not None:
        raise PathError(
            f"{path.name}: {len(path.times)} way-points joined by straight lines are corners, where limited "
            'accelerations allow no speed; join them by interpolation "spline"'
        )


class TimedFunctions(PointFunctions):
    """Integrand and quantities at one place of a path, with the speed among the local variables."""

    def __init__(self, *given: Any, **options: Any) -> None:
        super().__init__(*given, **options)
        self.accelerated, self.order = True, 3

    @property
    def own(self) -> int:
        """Local variables without those of pairs: r, r', r'', b, and c before and behind the sample."""
        return 3 * self.width + 3

    @cached_property
    def _made(self) -> tuple[Any, list[tuple[Quantity, Any]]]:
        z, _ = self._symbols
        here, bounds = self._here, self.bounds
        w = self.width
        slope, bend = z[w : 2 * w], z[2 * w : 3 * w]
        b, before, behind = z[3 * w], z[3 * w + 1], z[3 * w + 2]
        theta_slope = here.f.joint_rates(*here.at, here.twist, *self._parts(slope))
        integrand, _ = self._integrand(here, slope, theta_slope)
        rows = self._of_posture(here)
        if (most := bounds.redundant_rate) is not None:
            rows += self._of_redundant(slope**2 * b, -np.inf, most**2, most**2)
        if (most := bounds.swivel_rate) is not None and w == 6:
            rows += self._of_swivels(slope[3:] ** 2 * b, -np.inf, most**2, most**2)
        if (most := bounds.actuator_rate) is not None:
            rows += self._of_actuators(theta_slope**2 * b, "squared rate", most**2, "^2/s^2")
        if (most := bounds.actuator_acceleration) is not None:
            moving = (here.twist, slope[:3], theta_slope, here.twist_rate, *self._parts(bend))
            theta_bend = here.f.joint_accelerations(*here.at, *moving)
            for side, c in (("before", before), ("behind", behind)):
                value = theta_bend * b + theta_slope * c
                rows += self._of_actuators(value, f"acceleration {side}", most, "/s^2", 2)
        return integrand, rows + self._of_pairs(here, z)


class TimedProgramme(Programme):
    """The NLP with squared speeds at the samples as further variables; `times` are places u."""

    def __init__(self, point: TimedFunctions, knots: Floats, times: Floats, options: Any) -> None:
        self.at_rest = point.bounds.actuator_acceleration is not None
        self.initial = np.ones(len(times))
        super().__init__(point, knots, times, options)

    def speeds(self, solved: Solved) -> Clock:
        """The timing of a solution."""
        found = np.array(solved.state[0]).ravel()[self._with_pairs :]
        b = np.concatenate([[0.0], found, [0.0]]) if self.at_rest else found
        return Clock(self.times, np.sqrt(np.maximum(b, 0.0)))

    def _further(self) -> int:
        return len(self.times) - (2 if self.at_rest else 0)

    def _variable(self, sample: int) -> int | None:
        """The column of a sample's squared speed; None where it is zero."""
        if not self.at_rest:
            return self._with_pairs + sample
        return self._with_pairs + sample - 1 if 0 < sample < len(self.times) - 1 else None

    def _entries(self) -> tuple[list[int], list[int], list[float]]:
        rows, columns, values = super()._entries()
        last = len(self.times) - 1
        steps = np.diff(self.times)
        for k in range(last + 1):
            # before the first sample and behind the last one as on their other sides
            left, right = (k - 1, k) if k else (0, 1), (k, k + 1) if k < last else (last - 1, last)
            first = 3 * self.point.width
            entries = [(first, k, 1.0)]
            for row, (low, high) in ((first + 1, left), (first + 2, right)):
                share = 1 / (2 * steps[low])
                entries += [(row, low, -share), (row, high, share)]
            for row, sample, value in entries:
                if (column := self._variable(sample)) is not None:
                    rows.append(k * self.point.size + row)
                    columns.append(column)
                    values.append(float(value))
        return rows, columns, values

    def _more(self, X: Any) -> tuple[Any, Any, Any]:
        import casadi as ca

        b = ca.SX.sym("b", self._further())
        v = ca.sqrt(ca.vertcat(0, b, 0) if self.at_rest else b)
        duration = ca.sum1(2 * ca.DM(np.diff(self.times)) / (v[1:] + v[:-1]))
        duration *= self.point.objective.time
        hessian, slopes = ca.hessian(duration, b)
        of = ca.Function("duration", [b], [duration, slopes, hessian])
        value, gradient, bend = of(X[self._with_pairs :])
        front = self._with_pairs
        return value, ca.vertcat(ca.MX(front, 1), gradient), ca.diagcat(ca.MX(front, front), bend)

    def _beginning(self, start: Curve) -> tuple[Floats, Floats, Floats]:
        inner = self.initial[1:-1] if self.at_rest else self.initial
        return inner, np.full(len(inner), SLOWEST), np.full(len(inner), FASTEST)


def first_speeds(point: TimedFunctions, q: Floats, curve: Curve, places: Floats) -> Floats:
    """Squared speeds that limits of rates and accelerations allow along a curve: a parabola from rest to
    rest, or a constant, as large as they leave it."""
    at_rest = point.bounds.actuator_acceleration is not None
    x = (places - places[0]) / (places[-1] - places[0])
    shape = 4 * x * (1 - x) if at_rest else np.ones(len(x))
    gained = np.gradient(shape, places, edge_order=2) / 2
    z = np.zeros((point.size, len(places)))
    first = 3 * point.width
    z[:first] = np.hstack([curve.at(places, order) for order in range(3)]).T
    z[first : first + 3] = shape, gained, gained
    _, scaled = point.function.map(len(places))(z, q.T)
    rows = [k for k, one in enumerate(point.quantities) if one.moving]
    worst = float(np.nanmax(np.abs(scaled.full()[rows]), initial=1e-9))
    return np.asarray(np.maximum(0.8 * shape / worst, SLOWEST))
