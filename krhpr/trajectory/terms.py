"""What is asked of a trajectory: the objective, and the limits to keep."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from math import radians
from typing import Any

import numpy as np
from numpy.typing import NDArray

from krhpr.errors import nearest
from krhpr.robot import Robot
from krhpr.trajectory.grip import Grip
from krhpr.trajectory.refusals import ContradictoryLimits, UnknownObjective

Floats = NDArray[np.float64]

TERMS = ("eta_1", "eta_2", "eta_3", "rates", "time")


@dataclass(frozen=True)
class Objective:
    """Weights of integrals over time, which are added up."""

    eta_1: float = 0.0
    """Of eta_1^2 (1/m^2)."""
    eta_2: float = 0.0
    """Of eta_2^2."""
    eta_3: float = 0.0
    """Of log eta_3; not to be used alone, for eta_3 does not see type II singularities."""
    rates: float = 1e-3
    """Of the squared rates of the redundant coordinates (s^2 per rad^2 or m^2), relative to the rest: makes
    the answer unique and smooth.
    """
    time: float = 0.0
    """Of the duration (1/s).  Where it has a weight, the timing is chosen as well, from rest to rest, and the
    other integrals are over the path's own time.
    """

    def __post_init__(self) -> None:
        weights = {name: getattr(self, name) for name in TERMS}
        wrong = [f"{name} = {weight:g}" for name, weight in weights.items() if not 0 <= weight < np.inf]
        if wrong:
            raise UnknownObjective(f"weights of an objective are not negative: {', '.join(wrong)}")
        if not any(weight for name, weight in weights.items() if name != "rates"):
            raise UnknownObjective("the objective has no weight; give one to eta_1, eta_2, eta_3 or time")

    @classmethod
    def of(cls, given: Objective | str | Mapping[str, float]) -> Objective:
        """From a name (the index whose integral is minimised) or weights by name.

        Raises:
            UnknownObjective: what is given is none; it says which there are.
        """
        if isinstance(given, Objective):
            return given
        weights = {given: 1.0} if isinstance(given, str) else dict(given)
        for name in weights:
            if name not in TERMS:
                raise UnknownObjective(f"no objective is called {name!r}; {nearest(name, TERMS)}")
        return cls(**weights)

    def value(self, eta_1: Any, eta_2: Any, eta_3: Any, log: Any = np.log) -> Any:
        """The integrand without rates; arrays, or symbols with their `log`."""
        total: Any = 0.0 * eta_1
        if self.eta_1:
            total = total + self.eta_1 * eta_1**2
        if self.eta_2:
            total = total + self.eta_2 * eta_2**2
        if self.eta_3:
            total = total + self.eta_3 * log(eta_3)
        return total


@dataclass(frozen=True)
class Bounds:
    """Limits along a trajectory; what is None or not there is not limited.  SI units.

    Limits of actuated and of spherical joints in the robot's file (`robot.limits`) are held as well.
    """

    redundant: tuple[Any, Any]
    """The least and the largest redundant coordinates: numbers, or three of each (rad or m)."""
    redundant_rate: float | None = None
    """The largest absolute rate of redundant coordinates (rad/s or m/s)."""
    actuator_rate: float | None = None
    """The largest absolute rate of actuated joints (rad/s or m/s)."""
    actuator_acceleration: float | None = None
    """The largest absolute acceleration of actuated joints (rad/s^2 or m/s^2)."""
    margins: tuple[float, ...] = ()
    """Least type II margins, with their sign, in the order of `singularity`."""
    factors: Mapping[str, float] = field(default_factory=dict)
    """Least absolute factors of det M_i by name; the sign is that of the start, so that the mode is kept."""
    cone: float | None = None
    """The largest angle between the last link of a sub-leg and the redundant link (rad)."""
    clearance: float | None = None
    """The least distance (m) between the axes of links that no joint joins."""
    grip: Grip | None = None
    """What the gripper of arrangement (b) or (c) holds: its opening stays as it is."""

    def box(self) -> tuple[Floats, Floats]:
        """Bounds of the three redundant coordinates."""
        low, high = (np.broadcast_to(np.asarray(x, dtype=float), (3,)) for x in self.redundant)
        return low, high

    def check(self, robot: Robot) -> None:
        """Whether anything can meet them, and whether they are the robot's.

        Raises:
            ContradictoryLimits: which limit, and what is expected.
        """
        low, high = self.box()
        if not (low <= high).all():
            leg = int(np.argmax(~(low <= high)))
            raise ContradictoryLimits(
                f"redundant coordinate of leg {leg + 1}: the least value {low[leg]:g} is above the largest "
                f"{high[leg]:g}"
            )
        for name in ("redundant_rate", "actuator_rate", "actuator_acceleration", "cone", "clearance"):
            value = getattr(self, name)
            if value is not None and not value > 0:
                raise ContradictoryLimits(f"{name} is {value:g}; it must be positive")
        signature = robot.signature("singularity").outputs
        labels = {port.name: port.labels for port in signature}
        if len(self.margins) > len(labels["margins"]):
            raise ContradictoryLimits(
                f"{len(self.margins)} margins; there are {', '.join(labels['margins'])}"
            )
        for name in self.factors:
            if name not in labels["factors"]:
                raise ContradictoryLimits(
                    f"no factor of det M_i is called {name!r}; {nearest(name, labels['factors'])}"
                )
        if self.grip is not None:
            self.grip.check(robot, low, high)


def chapter_4() -> Bounds:
    """Limits of Section 4 for the 3-RRRSR robot with the thesis' sizes: those of Section 1.7 and of Chapter
    4.

    Angles beta from 55 to 175 deg at no more than 60 deg/s, joints at 2 rad/s, S_i at 20 mm or more from the
    first axis, elbows from 10 to 170 deg, D of 0.5 or more, an area of S_1 S_2 S_3 of 5000 mm^2 or more, at
    most 150 deg between distal and redundant link, and axes of links 20 mm or more apart.
    """
    return Bounds(
        redundant=(radians(55), radians(175)),
        redundant_rate=radians(60),
        actuator_rate=2.0,
        margins=(0.5, 2 * 0.005 / 0.125**2),
        factors={"shoulder": 0.02 / 0.75, "elbow": float(np.sin(radians(10)))},
        cone=radians(150),
        clearance=0.02,
    )
