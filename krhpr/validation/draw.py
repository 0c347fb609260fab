"""Random exact numbers: rationals with few digits, rational angles and rotations, and arguments of any
port.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from random import Random
from typing import Any

from krhpr.codegen.composition import RobotFunction
from krhpr.codegen.kernel import LEGS, GeometryType, Port, Unit
from krhpr.codegen.robot_code import RobotCode
from krhpr.validation.numbers import Angle, Exact


def euler_rotation(a: Any, b: Any, c: Any, d: Any) -> list[Any]:
    """The rotation with the Euler parameters (a, b, c, d), whatever their norm, row by row."""
    norm = a * a + b * b + c * c + d * d
    rows = (
        (a * a + b * b - c * c - d * d, 2 * (b * c - a * d), 2 * (b * d + a * c)),
        (2 * (b * c + a * d), a * a - b * b + c * c - d * d, 2 * (c * d - a * b)),
        (2 * (b * d - a * c), 2 * (c * d + a * b), a * a - b * b - c * c + d * d),
    )
    return [entry / norm for row in rows for entry in row]


class FiniteAngle(Angle):
    """An angle that C's test for finite numbers accepts: its size is unknown, but it is not infinite."""

    def __abs__(self) -> Any:
        return Exact(0)


class Draw:
    """A source of random exact numbers."""

    def __init__(self, seed: int) -> None:
        self.random = Random(seed)

    def rational(self, low: float = -1.0, high: float = 1.0) -> Exact:
        """A rational number between two bounds.

        Denominators of six digits: two draws are then never equal by chance, so that no sample falls on a
        singular configuration, where formulas divide by zero.
        """
        denominator = self.random.randint(100_003, 999_983)
        numerator = self.random.randint(int(low * denominator), int(high * denominator))
        return Exact(Fraction(numerator, denominator))

    def nonzero(self, low: float = -1.0, high: float = 1.0) -> Exact:
        """A rational number other than zero."""
        while True:
            value = self.rational(low, high)
            if value != 0:
                return value

    def length(self) -> Exact:
        """A positive rational number of the order of one."""
        return self.nonzero(0.2, 1.2)

    def angle(self) -> Angle:
        """A rational angle, anywhere but on the axes."""
        half = self.nonzero(-3.0, 3.0)
        while abs(half) == 1:
            half = self.nonzero(-3.0, 3.0)
        angle = Angle.from_half_tangent(half)
        return FiniteAngle(angle.cos(), angle.sin())

    def sign(self) -> int:
        """+1 or -1."""
        return self.random.choice((1, -1))

    def rotation(self, dimension: int = 3) -> list[Any]:
        """A rational rotation matrix, row by row (Cayley's formula in space)."""
        if dimension == 2:
            angle = self.angle()
            return [angle.cos(), -angle.sin(), angle.sin(), angle.cos()]
        return euler_rotation(*(self.nonzero() for _ in range(4)))

    def vector(self, count: int) -> list[Any]:
        """Rational numbers."""
        return [self.rational() for _ in range(count)]

    def positive(self, shape: tuple[int, ...]) -> list[Any]:
        """A positive definite matrix, row by row, or positive numbers."""
        if len(shape) < 2:
            return [self.length() for _ in range(shape[0] if shape else 1)]
        rows = [self.vector(shape[1]) for _ in range(shape[0])]
        return [sum((x * y for x, y in zip(a, b, strict=True)), Exact(0)) for a in rows for b in rows]

    # -- arguments ---------------------------------------------------------------------------------

    def geometry(self, *kinds: GeometryType, legs: int = LEGS) -> dict[str, list[Any]]:
        """Lengths and angles for the legs, all different."""
        return {
            field.name: [self.field(field.unit) for _ in range(legs)]
            for kind in kinds
            for field in kind.fields
        }

    def field(self, unit: Unit) -> Any:
        """One geometry field: an angle, or a positive length."""
        return self.angle() if unit is Unit.RADIAN else self.length()

    def port(self, port: Port, angular: Sequence[bool], *, full: bool) -> list[Any]:
        """An argument for a port (of one leg, or of the robot if `full`), flat and row by row."""
        size = port.full_size if full else port.size
        if port.name == "Q":
            return self.rotation(port.shape[0])
        if port.name == "friction":  # enough for any draw of the forces
            return [Exact(10**6)]
        if port.name == "normal_forces":
            return [self.length() for _ in range(size)]
        if port.name in ("mode", "assembly"):
            return [Exact(self.sign()) for _ in range(size)]
        if port.unit is Unit.RADIAN and port.name != "box":  # which is compared, not turned by
            return [self.angle() for _ in range(size)]
        if port.unit is Unit.ACTUATOR:
            return [self.angle() if angular[i % len(angular)] else self.rational() for i in range(size)]
        return [self.nonzero() for _ in range(size)]

    def inputs(self, robot: RobotCode, function: RobotFunction) -> dict[str, list[Any]]:
        """Arguments of a robot's function, with no relation among them."""
        return {port.name: self.port(port, robot.angular, full=True) for port in function.inputs}
