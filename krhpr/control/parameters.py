"""What the plant and the controllers of Section 5.5 are made of; SI units throughout.

What belongs to a motor is given at its shaft, forces and stiffnesses at the belt: a force f of the belt is
the torque r f / N, (5.69), and a motor's inertia J moves with it as the mass J (N / r)^2.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum
from math import inf, isfinite, pi

from krhpr.errors import ControlError
from krhpr.study.grasp import Drive


def _positive(part: str, of: object, *names: str) -> None:
    for name in names:
        value = getattr(of, name)
        if not 0 < value < inf:
            raise ControlError(f"{part}: {name} is {value:g}; it must be positive and finite")


def _not_negative(part: str, of: object, *names: str) -> None:
    for name in names:
        value = getattr(of, name)
        if not (value >= 0 and isfinite(value)):
            raise ControlError(f"{part}: {name} is {value:g}; it must not be negative, and finite")


class Scheme(StrEnum):
    """The control schemes of Section 5.5; the values are the thesis' names."""

    POSITION = "i"
    """Position control of the actuators alone; the jaws are told to close into the object."""
    FEEDFORWARD = "ii"
    """Position control, and the actuator forces that the static model wants for the grasping force."""
    COMBINED = "iii"
    """Scheme ii, and a PID controller that corrects the grasping force by the measured one."""


@dataclass(frozen=True)
class Motor:
    """A motor whose current follows the wanted torque."""

    inertia: float
    """J of the rotor and the gear (kg m2)."""
    torque_limit: float
    """Largest torque (N m)."""

    def __post_init__(self) -> None:
        _positive("motor", self, "inertia", "torque_limit")


@dataclass(frozen=True)
class GearFriction:
    """Friction of one actuator, as bristles that bend before they slide (Dahl's model with Stribeck's curve).

    With v the rate of the actuator, z the bend of the bristles and f the force that the gear transmits

        z_dot = v - sigma |v| z / g,     g = (f_c + share |f|) (1 + (stiction - 1) exp(-(v / v_s)^2)),
        friction = sigma z + viscous v.

    It holds up to g without sliding, slides against g, and is passive whatever g > 0 is: the power into it is
    the rate of sigma z^2 / 2 and what is lost, sigma^2 z^2 |v| / g + viscous v^2.
    """

    torque: float
    """Coulomb's friction at the motor's shaft (N m)."""
    load_share: float
    """Share of the transmitted force that is added to it."""
    stiction: float
    """Friction at rest over sliding friction, at least 1."""
    stribeck_speed: float
    """v_s, about which friction at rest falls to sliding friction (m/s at the belt)."""
    presliding: float
    """Bend of the bristles under Coulomb's friction, which is f_c / sigma (m at the belt)."""
    viscous: float
    """(N s/m at the belt)"""

    def __post_init__(self) -> None:
        _not_negative("gear friction", self, "torque", "load_share", "viscous")
        _positive("gear friction", self, "stribeck_speed", "presliding")
        if not self.stiction >= 1:
            raise ControlError(
                f"gear friction: stiction is {self.stiction:g}; friction at rest is no less: 1 or more"
            )
        if self.load_share > 0 and not self.torque > 0:
            raise ControlError(
                "gear friction: load_share needs a torque that is positive; a gear without load rubs too"
            )

    @property
    def slides(self) -> bool:
        """Whether there is any dry friction."""
        return self.torque > 0


@dataclass(frozen=True)
class Contact:
    """What is between a jaw and the object: a spring along the line through the contacts (Hunt and Crossley).

    With delta by how much the object is compressed, the jaws press with
    stiffness/2 delta (1 + damping delta_dot), and never pull.
    """

    stiffness: float
    """Of each of the two contacts (N/m)."""
    damping: float
    """Share of the force for each unit of the rate of compression (s/m)."""

    def __post_init__(self) -> None:
        _positive("contact", self, "stiffness")
        _not_negative("contact", self, "damping")


@dataclass(frozen=True)
class Sensors:
    """Encoders on the motors' shafts, and the load cell."""

    encoder_counts: float
    """Counts of one turn of a motor's shaft; infinity: exact."""
    force_noise: float
    """Standard deviation of the measured force (N)."""

    def __post_init__(self) -> None:
        if not self.encoder_counts > 0:
            raise ControlError(f"sensors: encoder_counts is {self.encoder_counts:g}; it must be positive")
        _not_negative("sensors", self, "force_noise")


@dataclass(frozen=True)
class PositionGains:
    """PD control of every actuator, in N/m and N s/m at the belt."""

    stiffness: float
    damping: float
    filter_time: float
    """Time constant of the error's rate, a filtered difference (s)."""

    def __post_init__(self) -> None:
        _positive("position", self, "stiffness")
        _not_negative("position", self, "damping", "filter_time")


@dataclass(frozen=True)
class ForceGains:
    """PID control of the grasping force; what it adds to the wanted force goes through the static model."""

    proportional: float
    integral: float
    """(1/s)"""
    derivative: float
    """(s), of the measured force: the wanted one is constant."""
    filter_time: float
    """Time constant of the measured force (s)."""
    least: float
    """Least grasping force that is asked of the static model (N): jaws press."""
    most: float
    """Largest one (N); the integral is kept within it, so that it cannot wind up."""

    def __post_init__(self) -> None:
        _not_negative("force", self, "proportional", "integral", "derivative", "filter_time")
        _positive("force", self, "least")
        if not self.most > self.least:
            raise ControlError(
                f"force: most is {self.most:g} N, and must be more than least, {self.least:g} N"
            )


@dataclass(frozen=True)
class ControlSetup:
    """All of it."""

    rate: float
    """Steps of the controller in a second."""
    motor: Motor
    friction: GearFriction
    contact: Contact
    sensors: Sensors
    position: PositionGains
    force: ForceGains
    seed: int = 0
    """Of the noise."""

    def __post_init__(self) -> None:
        _positive("controller", self, "rate")

    @property
    def period(self) -> float:
        """Between two steps of the controller (s)."""
        return 1.0 / self.rate

    def mass(self, drive: Drive) -> float:
        """A motor's inertia as a mass at the belt (kg)."""
        return self.motor.inertia * (drive.ratio / drive.radius) ** 2

    def coulomb(self, drive: Drive) -> float:
        """f_c, Coulomb's friction at the belt (N)."""
        return self.friction.torque * drive.ratio / drive.radius

    def resolution(self, drive: Drive) -> float:
        """What one count of an encoder is at the belt (m); zero for an exact one."""
        return 2 * pi * drive.radius / drive.ratio / self.sensors.encoder_counts


PROTOTYPE = ControlSetup(
    rate=500.0,
    motor=Motor(inertia=4.2e-7, torque_limit=0.012),
    friction=GearFriction(
        torque=0.00008,
        load_share=0.3,
        stiction=1.2,
        stribeck_speed=0.001,
        presliding=1.5e-6,
        viscous=10.0,
    ),
    contact=Contact(stiffness=1.5e5, damping=20.0),
    sensors=Sensors(encoder_counts=2048, force_noise=0.02),
    position=PositionGains(stiffness=5000.0, damping=600.0, filter_time=0.004),
    force=ForceGains(
        proportional=0.8, integral=30.0, derivative=0.015, filter_time=0.004, least=0.05, most=10.0
    ),
)
"""For the prototype of Section 5.5.  Motor and encoder are those that the thesis names (RE-max 24 of 11 W, MR
type M with 512 counts and four edges each); it prints no gains, no friction, no stiffness and no rate."""
