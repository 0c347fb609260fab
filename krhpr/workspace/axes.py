"""Families of poses: named coordinates, and the poses that they stand for."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from krhpr.errors import WorkspaceError
from krhpr.workspace.limits import Stop

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Axis:
    """A coordinate and its values."""

    name: str
    values: Floats
    unit: str
    doc: str

    def __post_init__(self) -> None:
        values = np.atleast_1d(np.asarray(self.values, dtype=float))
        if values.ndim != 1 or not values.size or not np.isfinite(values).all():
            raise WorkspaceError(f"{self.name}: expected one number or more, all finite")
        if (np.diff(values) <= 0).any():
            raise WorkspaceError(f"{self.name}: its values must increase")
        object.__setattr__(self, "values", values)

    def __len__(self) -> int:
        return len(self.values)

    def settings(self) -> dict[str, Any]:
        """As plain values, for stores."""
        return {"name": self.name, "unit": self.unit, "values": self.values.tolist()}


Slopes = Mapping[Stop, float]
"""By how much margins (m, rad) change at most for one unit of a coordinate."""


class Family(ABC):
    """Poses by coordinates; the last one is the distance or angle from where rays begin."""

    names: ClassVar[tuple[str, ...]]
    units: ClassVar[tuple[str, ...]]
    docs: ClassVar[tuple[str, ...]]
    slopes: ClassVar[Slopes]
    """Of the last coordinate: of the printed sizes, by samples and not proven; bisection finds gaps that keep
    them."""

    @abstractmethod
    def poses(self, *coordinates: Floats) -> tuple[Floats, Floats]:
        """p (n, 3) and Q (n, 3, 3) from n values of each coordinate."""

    @abstractmethod
    def settings(self) -> dict[str, Any]:
        """As plain values, for stores."""

    def axes(self, *values: ArrayLike) -> tuple[Axis, ...]:
        """The first coordinates with values."""
        return tuple(
            Axis(name, np.asarray(value, dtype=float), unit, doc)
            for name, value, unit, doc in zip(self.names, values, self.units, self.docs, strict=False)
        )


@dataclass(frozen=True)
class Layers(Family):
    """Positions in layers of equal height, (1.38): p = [d_p cos theta_c, d_p sin theta_c, h]."""

    Q: tuple[tuple[float, ...], ...] = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
    """The orientation, the same everywhere."""
    names = ("h", "theta_c", "d_p")
    units = ("m", "rad", "m")
    docs = ("height of the platform", "direction of the ray", "distance from the z-axis")
    # S_i moves with the platform.  Joints and links move faster where a leg is nearly stretched: with links
    # of 0.3 m an elbow that is 10 degrees away from it turns by 38 rad/m.
    slopes = MappingProxyType(
        {
            Stop.AXIS: 1.0,
            Stop.ELBOW: 40.0,
            Stop.SPHERICAL: 40.0,
            Stop.ACTUATOR: 40.0,
            Stop.PASSIVE: 40.0,
            Stop.BODIES: 6.0,
        }
    )

    def poses(self, *coordinates: Floats) -> tuple[Floats, Floats]:
        h, theta_c, d_p = coordinates
        p = np.stack([d_p * np.cos(theta_c), d_p * np.sin(theta_c), h], axis=-1)
        return p, np.broadcast_to(np.array(self.Q), (len(p), 3, 3))

    def settings(self) -> dict[str, Any]:
        return {"family": "layers", "Q": [list(row) for row in self.Q]}


@dataclass(frozen=True)
class Box(Family):
    """Positions by their Cartesian coordinates."""

    Q: tuple[tuple[float, ...], ...] = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
    """The orientation, the same everywhere."""
    names = ("x", "y", "z")
    units = ("m", "m", "m")
    docs = ("position of O'", "position of O'", "position of O'")
    slopes = MappingProxyType({**Layers.slopes, Stop.BASE: 1.0})

    def poses(self, *coordinates: Floats) -> tuple[Floats, Floats]:
        p = np.stack(coordinates, axis=-1)
        return p, np.broadcast_to(np.array(self.Q), (len(p), 3, 3))

    def settings(self) -> dict[str, Any]:
        return {"family": "box", "Q": [list(row) for row in self.Q]}


@dataclass(frozen=True)
class TiltTorsion(Family):
    """Orientations at one position by torsion, direction and tilt, (1.40): Q = Q_torsion Q_tilt.

    The platform is tilted by phi about u = [cos theta_c, sin theta_c, 0] in its own frame, and then turned
    by psi about the z-axis of the base.
    """

    p: tuple[float, float, float] = (0.0, 0.0, 0.35)
    names = ("psi", "theta_c", "phi")
    units = ("rad", "rad", "rad")
    docs = ("torsion", "direction of the axis of tilt", "tilt")
    # S_i is some 0.2 m from O' and moves by as much for a radian
    slopes = MappingProxyType(
        {
            Stop.AXIS: 0.2,
            Stop.ELBOW: 1.0,
            Stop.SPHERICAL: 1.5,
            Stop.ACTUATOR: 1.5,
            Stop.PASSIVE: 1.5,
            Stop.BODIES: 0.1,
        }
    )

    def poses(self, *coordinates: Floats) -> tuple[Floats, Floats]:
        Q = tilt_torsion(*coordinates)
        return np.broadcast_to(np.array(self.p), (len(Q), 3)), Q

    def settings(self) -> dict[str, Any]:
        return {"family": "tilt and torsion", "p": list(self.p)}


def tilt_torsion(psi: Floats, theta_c: Floats, phi: Floats) -> Floats:
    """Q (n, 3, 3) from torsion, direction and tilt (n,), (1.40) to (1.45)."""
    c, s = np.cos(phi), np.sin(phi)
    x, y = np.cos(theta_c), np.sin(theta_c)
    cross = x * y * (1 - c)
    tilt = np.stack(
        [c + x**2 * (1 - c), cross, y * s, cross, c + y**2 * (1 - c), -x * s, -y * s, x * s, c], -1
    )
    tilt = tilt.reshape(-1, 3, 3)
    C, S = np.cos(psi)[:, None], np.sin(psi)[:, None]
    return np.stack([C * tilt[:, 0] - S * tilt[:, 1], S * tilt[:, 0] + C * tilt[:, 1], tilt[:, 2]], axis=1)


def steps(low: float, high: float, step: float) -> Floats:
    """low, low + step, ... up to high (with it where it is one of them)."""
    if not (step > 0 and high >= low):
        raise WorkspaceError(
            f"from {low:g} to {high:g} in steps of {step:g}: expected a positive step upwards"
        )
    count = int(np.floor((high - low) / step * (1 + 1e-12) + 1e-9)) + 1
    return np.asarray(low + step * np.arange(count), dtype=np.float64)


def directions(count: int) -> Floats:
    """So many directions around a full turn, from 0 on (rad)."""
    if count < 1:
        raise WorkspaceError(f"{count} directions; expected 1 or more")
    return 2 * np.pi * np.arange(count) / count
