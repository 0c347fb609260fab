"""What may be changed of a robot: fields of its geometry, redundant coordinates and the home height."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from krhpr.derivations.requirements import CHECKS, Requirement
from krhpr.errors import DesignError, nearest
from krhpr.robot import Robot

Floats = NDArray[np.float64]

REDUNDANT = "redundant"
"""The redundant coordinate of all legs, constant, and that of the home pose (rad or m)."""
HEIGHT = "height"
"""Of O' at home (m)."""


@dataclass(frozen=True)
class Tie:
    """A field that goes with a variable: factor * value + offset."""

    field: str
    factor: float
    offset: float = 0.0

    def at(self, value: float) -> float:
        """The field's value."""
        return self.factor * value + self.offset


@dataclass(frozen=True)
class Variable:
    """A field of the geometry, `redundant` or `height`, alike in the three legs, within bounds (m, rad)."""

    name: str
    low: float
    high: float
    ties: tuple[Tie, ...] = ()
    """Fields that follow from it: with l_2 + l_3 constant, or with a platform of the same shape."""

    def settings(self) -> dict[str, Any]:
        """As plain values."""
        ties = [[tie.field, tie.factor, tie.offset] for tie in self.ties]
        return {"name": self.name, "low": self.low, "high": self.high, "ties": ties}

    def fields(self, value: float) -> Iterator[tuple[str, float]]:
        """What it sets."""
        yield self.name, value
        for tie in self.ties:
            yield tie.field, tie.at(value)


class DesignSpace:
    """A robot and what may be changed of it."""

    def __init__(self, robot: Robot, variables: Sequence[Variable]) -> None:
        """Every variable with its bounds.

        Raises:
            DesignError: a field that the robot does not have, bounds that are crossed or make no length, or a
                field that two variables set.
        """
        self.robot, self.variables = robot, tuple(variables)
        if not self.variables:
            raise DesignError(f"{robot.name}: no variables; expected one or more of {', '.join(self._known)}")
        seen: dict[str, str] = {}
        for variable in self.variables:
            self._check(variable)
            for field, _ in variable.fields(variable.low):
                if field in seen:
                    raise DesignError(
                        f"{robot.name}: {field} is set by {seen[field]} and again by {variable.name}"
                    )
                seen[field] = variable.name

    @property
    def names(self) -> tuple[str, ...]:
        """Of the variables."""
        return tuple(variable.name for variable in self.variables)

    @property
    def own(self) -> Floats:
        """The values that the robot has, moved into the bounds where they are outside."""
        home, fields = self.robot.home, self.robot.geometry.fields
        found = {REDUNDANT: home.redundant[0], HEIGHT: home.p[-1]}
        values = np.array([found.get(one.name, fields.get(one.name, [0.0])[0]) for one in self.variables])
        return np.asarray(np.clip(values, *self._bounds), dtype=float)

    def values(self, shares: ArrayLike) -> Floats:
        """Values from their places between the bounds, 0 to 1, rounded to a decimal place: a thousandth to a
        ten-thousandth of the range."""
        low, high = self._bounds
        places = (3 - np.floor(np.log10(high - low))).astype(int)
        exact = low + np.asarray(shares, dtype=float) * (high - low)
        rounded = [np.round(value, place) for value, place in zip(exact.T, places, strict=True)]
        return np.asarray(np.clip(np.stack(rounded, axis=-1), low, high), dtype=float)

    def shares(self, values: ArrayLike) -> Floats:
        """The places of values between the bounds."""
        low, high = self._bounds
        return np.asarray((np.asarray(values, dtype=float) - low) / (high - low))

    def robot_of(self, values: ArrayLike, *, name: str | None = None) -> Robot:
        """The robot with these values of the variables.

        Raises:
            DesignError: not one finite value for each variable.
        """
        given = np.asarray(values, dtype=float)
        if given.shape != (len(self.variables),) or not np.isfinite(given).all():
            raise DesignError(
                f"{self.robot.name}: the values are {given.tolist()}; expected a finite one for each of "
                f"{', '.join(self.names)}"
            )
        fields: dict[str, float] = {}
        for variable, value in zip(self.variables, given.tolist(), strict=True):
            fields.update(variable.fields(value))
        home = self.robot.home
        redundant = fields.pop(REDUNDANT, home.redundant)
        p = (*home.p[:-1], fields.pop(HEIGHT, home.p[-1]))
        return self.robot.with_geometry(**fields).with_home(p, redundant, name=name)

    def settings(self) -> dict[str, Any]:
        """As plain values."""
        return {"variables": [variable.settings() for variable in self.variables]}

    @property
    def _bounds(self) -> tuple[Floats, Floats]:
        low, high = np.array([[one.low, one.high] for one in self.variables]).T
        return low, high

    @property
    def _known(self) -> list[str]:
        return [*self.robot.geometry.fields, REDUNDANT, HEIGHT]

    def _check(self, variable: Variable) -> None:
        where = f"{self.robot.name}: {variable.name}"
        if not (np.isfinite([variable.low, variable.high]).all() and variable.low < variable.high):
            raise DesignError(
                f"{where}: the bounds are {variable.low:g} and {variable.high:g}; expected the lower one "
                "first, and a greater one"
            )
        for field, _ in variable.fields(variable.low):
            if field not in self._known:
                raise DesignError(
                    f"{self.robot.name}: there is no {field} to vary; {nearest(field, self._known)}"
                )
        for end in (variable.low, variable.high):
            for field, value in variable.fields(end):
                if field in self.robot.geometry.positive and value <= 0:
                    raise DesignError(
                        f"{where}: with {variable.name} = {end:g} the length {field} is {value:g}; expected "
                        "bounds that keep it greater than 0"
                    )


def requirement(robot: Robot) -> str:
    """Why no robot file may have these sizes, as (1.35); empty where they are allowed."""
    sizes = {name: (float(a), float(b), float(c)) for name, (a, b, c) in robot.geometry.fields.items()}
    for name, _ in robot.documentation["requirements"]:
        why = CHECKS[Requirement(name)](sizes)
        if why:
            return why
    return ""
