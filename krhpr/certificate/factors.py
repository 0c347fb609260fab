"""The factors of det J of a robot as functions of the redundant coordinates, by exact coefficients.

What is used of a factor is its degree in one coordinate, the others held (`Form`).  It follows from the
kind of the redundant joint.  A link that turns about a fixed point B_i has a line whose direction and
moment are proportional to (cos, sin), and det J_a is linear in that line; S_i is B_i plus such a vector,
and det J_n is linear in S_i.  A slide moves S_i and the moment of its line along straight lines, and keeps
the direction. `krhpr validate` proves it of each arrangement from the constraint equations (proof
"degree").

Such a function is known by 2 or 3 of its values in each coordinate: here by the generated function
`type_2_of_redundant`, run on exact numbers.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum
from fractions import Fraction
from functools import cached_property, lru_cache
from importlib import import_module
from types import ModuleType
from typing import Any

import numpy as np

from krhpr.certificate.boxes import LEGS
from krhpr.certificate.exact import Angle, Number, number
from krhpr.generated.python.runtime import Geometry
from krhpr.robot import Robot

Floats = np.ndarray[Any, np.dtype[np.float64]]
Coordinate = Angle | Number


class Form(StrEnum):
    """What a factor is as a function of one redundant coordinate, the others held."""

    SINUSOIDAL = "a cos + b sin"
    TRIGONOMETRIC = "constant + a cos + b sin"
    AFFINE = "constant + a d"


@dataclass(frozen=True, eq=False)
class Factor:
    """A factor of det J: a number for each product of three basis functions, one of each coordinate.

    The basis is (cos, sin), (1, cos, sin) or (1, d), as `form` says.  `margin` is the constant by which the
    factor is multiplied to become its margin.
    """

    name: str
    form: Form
    coefficients: np.ndarray[Any, Any]
    margin: float
    collinear: bool = False
    """Whether it is det J_n of arrangement (a), which vanishes where S_1, S_2, S_3 are in line."""

    def at(self, point: Sequence[Coordinate]) -> Number:
        """Its value, without rounding."""
        value: Any = self.coefficients
        for coordinate in point:
            value = np.tensordot(np.array(self._basis(coordinate), dtype=object), value, (0, 0))
        return number(value.item())

    def _basis(self, coordinate: Coordinate) -> list[Number]:
        if isinstance(coordinate, Number):
            return [_ONE, coordinate]
        wave = [coordinate.cos(), coordinate.sin()]
        return wave if self.form is Form.SINUSOIDAL else [_ONE, *wave]

    def coordinate(self, value: float) -> Coordinate:
        """A coordinate of a point from a double."""
        return number(value) if self.form is Form.AFFINE else Angle.of(value)

    @cached_property
    def rounded(self) -> Floats:
        """Its coefficients as doubles."""
        return np.array([entry.nearest() for entry in self.coefficients.flat]).reshape(
            self.coefficients.shape
        )

    @cached_property
    def rounding(self) -> float:
        """How far a coefficient is from its double at most."""
        pairs = zip(self.coefficients.flat, self.rounded.flat, strict=True)
        gaps = [entry - float(near) for entry, near in pairs]
        worst = max(max(abs(gap.low()), abs(gap.high())) for gap in gaps)
        return float(worst) * (1 + 2.0**-50)

    def near(self, points: Floats) -> Floats:
        """Its values at points (..., 3) in doubles, with their rounding."""
        value: Floats = np.broadcast_to(self.rounded, (*points.shape[:-1], *self.rounded.shape))
        for leg in range(LEGS):
            basis = self.bases(points[..., leg])
            value = np.einsum("...a,...abc->...bc" if leg == 0 else _SHORTER[leg], basis, value)
        return value

    def bases(self, coordinates: Floats) -> Floats:
        """The basis functions (..., m) at coordinates (...), in doubles."""
        if self.form is Form.AFFINE:
            return np.stack([np.ones_like(coordinates), coordinates], axis=-1)
        wave = [np.cos(coordinates), np.sin(coordinates)]
        one = [] if self.form is Form.SINUSOIDAL else [np.ones_like(coordinates)]
        return np.stack([*one, *wave], axis=-1)


_ONE = Number(Fraction(1))
_SHORTER = {1: "...a,...ab->...b", 2: "...a,...a->..."}


def is_angular(robot: Robot) -> bool:
    """Whether the redundant coordinates are angles."""
    (port,) = robot.signature("type_2_of_redundant").inputs
    return port.unit == "rad"


def factors(robot: Robot) -> tuple[Factor, ...]:
    """Both factors of det J, or the one of a planar robot."""
    return _factors(robot.identifier, robot.geometry)


@lru_cache(maxsize=64)
def _factors(identifier: str, geometry: Geometry) -> tuple[Factor, ...]:
    module = import_module(f"krhpr.generated.python.{identifier}")
    robot = Robot(module, geometry, "numpy")
    angular = is_angular(robot)
    samples: list[Coordinate] = CORNERS if angular else [number(0), _ONE]
    grid = np.empty((len(samples),) * LEGS + (LEGS,), dtype=object)
    for index in np.ndindex(*grid.shape[:-1]):
        grid[index] = [samples[place] for place in index]
    values = module.type_2_of_redundant(grid, geometry=exact_geometry(module, geometry)).type_2
    names = robot.signature("type_2_of_redundant").outputs[0].labels
    forms = (Form.SINUSOIDAL, Form.TRIGONOMETRIC) if angular else (Form.AFFINE, Form.AFFINE)
    return tuple(
        Factor(
            name,
            forms[place],
            _coefficients(values[..., place], forms[place]),
            _margin(robot, place),
            collinear=forms[place] is Form.TRIGONOMETRIC,
        )
        for place, name in enumerate(names)
    )


CORNERS: list[Coordinate] = [Angle.of(0.0), Angle.of(np.pi / 2), Angle.of(np.pi)]
"""0, 90 and 180 degrees, exactly."""


def _coefficients(values: Any, form: Form) -> Any:
    """From values at the samples to coefficients, axis by axis."""
    for axis in range(LEGS):
        parts = np.moveaxis(values, axis, 0)
        if form is Form.AFFINE:
            parts = np.stack([parts[0], parts[1] - parts[0]])
        elif form is Form.SINUSOIDAL:
            parts = parts[:2]
        else:
            constant = (parts[0] + parts[2]) * Fraction(1, 2)
            parts = np.stack([constant, parts[0] - constant, parts[1] - constant])
        values = np.moveaxis(parts, 0, axis)
    return values


def _margin(robot: Robot, place: int) -> float:
    """margin / factor, at the one of some points where the factor is largest."""
    points = np.random.default_rng(1).uniform(0.1, 1.1, (32, LEGS))
    found = robot.type_2_of_redundant(points)
    value, margin = found.type_2[:, place], found.margins[:, place]
    best = int(np.argmax(np.abs(value)))
    return float(margin[best] / value[best]) if value[best] else 1.0


def exact_geometry(module: ModuleType, geometry: Geometry) -> Geometry:
    """The geometry with the platform's lengths and angles as exact numbers."""
    units = dict(module.DOCUMENTATION["units"])
    fields = {}
    for name, values in geometry.fields.items():
        if name in module.platform.FIELDS:
            exact = np.empty(LEGS, dtype=object)
            make: Any = Angle.of if units[name] == "rad" else number
            exact[:] = [make(float(value)) for value in values]
            fields[name] = exact
        else:
            fields[name] = values
    return Geometry(fields, geometry.order, geometry.positive)
