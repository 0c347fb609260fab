"""What is asked of a trajectory: the objective, and the limits to keep."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from math import radians
from typing import Any

import numpy as np
from numpy.typing import NDArray

from krhpr.errors import nearest
from krhpr.robot import Robot
from krhpr.trajectory.grip import Grip
from krhpr.trajectory.refusals import ContradictoryLimits, UnknownObjective

Floats = NDArray[np.float64]

INDICES = ("eta_1", "eta_2", "eta_3")
MAXIMA = ("max_eta_1", "max_eta_2", "max_eta_3")
OF_JOINTS = ("torques", "travel", "joint_rates")
TERMS = (*INDICES, *MAXIMA, *OF_JOINTS, "rates", "time")
PLATFORM_JOINT = "platform_joint"
"""The redundant coordinate among the passive joints."""
SMOOTH = 0.01
"""The programme takes sqrt(x^2 + SMOOTH^2) for the absolute rate of an actuator, rad/s."""


@dataclass(frozen=True)
class Load:
    """What the robot applies to its environment, as `inverse_statics` takes it."""

    wrench: Any
    """[force, moment about O'] in the base frame, (6), or [f_x, f_y, m] in the plane (3); N, N m."""
    redundant_forces: Any = (0.0, 0.0, 0.0)
    """Forces or moments along the redundant coordinates (3), as those of jaws on an object; N, N m."""

    def __post_init__(self) -> None:
        for name in ("wrench", "redundant_forces"):
            values = np.ravel(np.asarray(getattr(self, name), dtype=float))
            object.__setattr__(self, name, tuple(values.tolist()))


@dataclass(frozen=True)
class Objective:
    """Weights of integrals over time and of largest values, which are added up.

    Actuators that slide count by their displacement over the characteristic length, and by their force times
    this length.
    """

    eta_1: float = 0.0
    """Of the integral of eta_1^2 (1/m^2)."""
    eta_2: float = 0.0
    """Of that of eta_2^2."""
    eta_3: float = 0.0
    """Of that of log eta_3; not to be used alone, for eta_3 does not see type II singularities."""
    max_eta_1: float = 0.0
    """Of the largest eta_1^2 on the path (1/m^2)."""
    max_eta_2: float = 0.0
    """Of the largest eta_2^2."""
    max_eta_3: float = 0.0
    """Of the largest log eta_3."""
    torques: float = 0.0
    """Of the integral of the sum of the actuators' squared torques under `load` (1/(N m)^2)."""
    travel: float = 0.0
    """Of what all actuators together travel (1/rad)."""
    joint_rates: float = 0.0
    """Of the integral of the sum of the actuators' squared rates (s/rad^2)."""
    rates: float = 1e-3
    """Of the integral of the squared rates of the redundant coordinates (s^2 per rad^2 or m^2), relative to
    the rest: makes the answer unique and smooth.
    """
    time: float = 0.0
    """Of the duration (1/s).  Where it has a weight, the timing is chosen as well, from rest to rest, and the
    other integrals are over the path's own time.
    """
    load: Load | None = None
    """What the torques are for."""

    def __post_init__(self) -> None:
        weights = {name: getattr(self, name) for name in TERMS}
        wrong = [f"{name} = {weight:g}" for name, weight in weights.items() if not 0 <= weight < np.inf]
        if wrong:
            raise UnknownObjective(f"weights of an objective are not negative: {', '.join(wrong)}")
        if not any(weight for name, weight in weights.items() if name != "rates"):
            others = [name for name in TERMS if name != "rates"]
            raise UnknownObjective(f"the objective has no weight; give one to {', '.join(others)}")
        if bool(self.torques) != (self.load is not None):
            given = "torques have a weight and there is no load" if self.torques else "a load without torques"
            raise UnknownObjective(f"{given}: give both, a weight of torques and the load that they hold")
        if self.time and self.largest:
            raise UnknownObjective(f"time and {', '.join(self.largest)} cannot be weighed together")

    @classmethod
    def of(cls, given: Objective | str | Mapping[str, Any]) -> Objective:
        """From a name (the term that is minimised) or weights by name, `load` a `Load` or its fields.

        Raises:
            UnknownObjective: what is given is none; it says which there are.
        """
        if isinstance(given, Objective):
            return given
        weights: dict[str, Any] = {given: 1.0} if isinstance(given, str) else dict(given)
        for name in weights:
            if name not in (*TERMS, "load"):
                raise UnknownObjective(f"no objective is called {name!r}; {nearest(name, TERMS)}")
        if isinstance(load := weights.get("load"), Mapping):
            weights["load"] = Load(**load)
        return cls(**weights)

    @property
    def largest(self) -> tuple[str, ...]:
        """Terms of `MAXIMA` that have a weight."""
        return tuple(name for name in MAXIMA if getattr(self, name))

    @property
    def of_poses(self) -> bool:
        """Whether a pose alone has a value."""
        return any(getattr(self, name) for name in (*INDICES, *MAXIMA, "torques"))

    def check(self, robot: Robot) -> None:
        """Whether the load is one of this robot.

        Raises:
            UnknownObjective: how many numbers are expected.
        """
        if self.load is None:
            return
        for name, count in (("wrench", 3 if robot.planar else 6), ("redundant_forces", 3)):
            given = getattr(self.load, name)
            if len(given) != count or not np.isfinite(given).all():
                raise UnknownObjective(
                    f"{name} of the load is {list(given)}; {robot.name} takes {count} finite numbers"
                )

    def value(self, eta_1: Any, eta_2: Any, eta_3: Any, log: Any = np.log) -> Any:
        """What indices add to the integrand; arrays, or symbols with their `log`."""
        total: Any = 0.0 * eta_1
        for name, term in zip(INDICES, terms_of_indices(eta_1, eta_2, eta_3, log), strict=True):
            if weight := getattr(self, name):
                total = total + weight * term
        return total

    def peaks(self, eta_1: Any, eta_2: Any, eta_3: Any, log: Any = np.log) -> dict[str, Any]:
        """What is to have a small largest value, by the names in `largest`."""
        terms = terms_of_indices(eta_1, eta_2, eta_3, log)
        return {name: term for name, term in zip(MAXIMA, terms, strict=True) if getattr(self, name)}


def terms_of_indices(eta_1: Any, eta_2: Any, eta_3: Any, log: Any = np.log) -> tuple[Any, Any, Any]:
    """What is made small of each index: eta_1^2, eta_2^2, log eta_3."""
    return eta_1**2, eta_2**2, log(eta_3)


@dataclass(frozen=True)
class Bounds:
    """Limits along a trajectory; what is None or not there is not limited.  SI units.

    Limits of the robot's file (`robot.limits`) are held as well: of joints, actuated and passive, and of
    distances between links, which are cylinders with the radii that it gives.
    """

    redundant: tuple[Any, Any]
    """The least and the largest redundant coordinates: numbers, or three of each (rad or m)."""
    redundant_rate: float | None = None
    """The largest absolute rate of redundant coordinates (rad/s or m/s)."""
    swivel: tuple[Any, Any] | None = None
    """The least and the largest swivels of redundant sub-legs (rad): numbers, or three of each.  Where it is
    None they stand at zero.
    """
    swivel_rate: float | None = None
    """The largest absolute rate of swivels (rad/s)."""
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

    def of(self, robot: Robot) -> Bounds:
        """With what the robot's file says of the redundant coordinates, checked.

        Raises:
            ContradictoryLimits: which limit, and what is expected.
        """
        given = robot.limits.passive.get(PLATFORM_JOINT)
        if given is None:
            self.check(robot)
            return self
        low, high = self.box()
        least, most = (np.array([getattr(one, side) for one in given]) for side in ("low", "high"))
        if (apart := (low > most) | (high < least)).any():
            leg = int(np.argmax(apart))
            raise ContradictoryLimits(
                f"redundant coordinate of leg {leg + 1}: {low[leg]:g} to {high[leg]:g} is asked for, and the "
                f"file of {robot.name} allows {least[leg]:g} to {most[leg]:g}"
            )
        within = replace(self, redundant=(np.maximum(low, least), np.minimum(high, most)))
        within.check(robot)
        return within

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
        if self.swivel is not None:
            self._check_swivel(robot)
        for name in (
            "redundant_rate",
            "swivel_rate",
            "actuator_rate",
            "actuator_acceleration",
            "cone",
            "clearance",
        ):
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

    def _check_swivel(self, robot: Robot) -> None:
        if not robot.redundant_legs:
            raise ContradictoryLimits(f"{robot.name} has no redundant sub-legs, and no swivels to choose")
        low, high = (np.broadcast_to(np.asarray(x, dtype=float), (3,)) for x in self.swivel or ())
        if not (low <= high).all():
            leg = int(np.argmax(~(low <= high)))
            raise ContradictoryLimits(
                f"swivel of leg {leg + 1}: the least value {low[leg]:g} is above the largest {high[leg]:g}"
            )


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
