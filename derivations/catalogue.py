"""The robots that the project knows: every sub-leg on every platform arrangement of its space, with default
sizes.

A new sub-leg is a file in `sublegs/` and a line in `SUBLEGS` with its sizes; it then comes in all
arrangements.  Default sizes are those of the thesis where it prints them.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from math import acos, pi, radians, sqrt

from krhpr.derivations.platforms.base import Platform
from krhpr.derivations.platforms.planar_a import PlanarA
from krhpr.derivations.platforms.planar_slides import PlanarB, PlanarC
from krhpr.derivations.platforms.spatial_a import SpatialA
from krhpr.derivations.platforms.spatial_slides import SpatialB, SpatialC
from krhpr.derivations.robots import Robot
from krhpr.derivations.sublegs.base import SubLeg
from krhpr.derivations.sublegs.cpr import CPR3
from krhpr.derivations.sublegs.delta import Delta
from krhpr.derivations.sublegs.hybrid import PFiveBar, RFiveBar
from krhpr.derivations.sublegs.planar_parallel import PRR2, RPR2, PlanarFiveBar, PlanarFiveBarCoupler
from krhpr.derivations.sublegs.planar_rr import RR
from krhpr.derivations.sublegs.planar_rrr import PlanarRRR
from krhpr.derivations.sublegs.planar_serial import PP, PR, RP
from krhpr.derivations.sublegs.prr import PRR, ParallelPRR
from krhpr.derivations.sublegs.rrr import RRR
from krhpr.derivations.sublegs.rrrr import RRRR
from krhpr.derivations.sublegs.tripods import UPS3, UPU3
from krhpr.derivations.sublegs.tripteron import Tripteron
from krhpr.derivations.terms import JointKind, Space

Triple = tuple[float, float, float]
Sizes = Mapping[str, float | Triple]
"""A value for each field: one for all legs, or three."""


@dataclass(frozen=True)
class Home:
    """A pose at which a robot of default size is far from every singularity in its default working mode: the
    platform's position, parallel to the base, and the redundant coordinates.
    """

    p: tuple[float, ...]
    redundant: Triple


@dataclass(frozen=True)
class Entry:
    """A robot of the catalogue with its default sizes (metres and radians, a value for each leg)."""

    robot: Robot
    sizes: Mapping[str, Triple]
    home: Home
    title: str
    thesis: str

    @property
    def identifier(self) -> str:
        """The name of the robot, `spatial_rrr_a`."""
        return self.robot.identifier


_THIRDS = (0.0, radians(120.0), radians(240.0))
_PLANAR = (radians(210.0), radians(330.0), radians(90.0))

# Section 1.7: the base and the first axis
_BASE: Sizes = {"azimuth": _THIRDS, "R_b": 0.25, "alpha": radians(120.0), "l_1": 0.05}
_FIVEBAR: Sizes = {"l_2": 0.15, "l_3": 0.3, "l_4": 0.3, "l_5": 0.45, "l_6": 0.3}
_TRIAD = acos(1.0 / sqrt(3.0))  # three axes at right angles to one another, all alike to e_x
_CPR: Sizes = {
    **{f"tilt_{n}": _TRIAD for n in (1, 2, 3)},
    **{f"turn_{n}": radians(120.0 * (n - 1)) for n in (1, 2, 3)},
    **{"x_1": 0.03, "y_1": 0.0, "z_1": -0.01},
    **{"x_2": 0.0, "y_2": -0.02, "z_2": 0.005},
    **{"x_3": 0.01, "y_3": 0.0, "z_3": 0.04},
}
_AROUND: Sizes = {f"a_{k}": radians(120.0 * (k - 1)) for k in (1, 2, 3)}
_PLANE: Sizes = {"azimuth": _PLANAR, "R_b": 0.25}

SUBLEGS: tuple[tuple[SubLeg, Sizes], ...] = (
    (RRR(), {**_BASE, "l_2": 0.3, "l_3": 0.45}),
    (RFiveBar(), {**_BASE, **_FIVEBAR}),
    (PRR(), {**_BASE, "l_2": 0.3, "l_3": 0.45}),
    (ParallelPRR(), {**_BASE, "alpha": pi / 2, "slide_azimuth": 0.0, "l_2": 0.3, "l_3": 0.45}),
    (RRRR(), {**_BASE, "l_2": 0.3, "l_3": 0.45}),
    (PFiveBar(), {**_BASE, **_FIVEBAR, "l_3": 0.28}),
    (CPR3(), {**_BASE, **_CPR}),
    (Tripteron(), {**_BASE, "l_2": 0.3, "l_3": 0.3}),
    (UPU3(), {**_BASE, "r_g": 0.12, **_AROUND}),
    (UPS3(), {**_BASE, "r_g": 0.12, **_AROUND}),
    (Delta(), {**_BASE, "r_g": 0.06, "L": 0.25, "R": 0.42, **_AROUND}),
    (RR(), {**_PLANE, "l_1": 0.15, "l_2": 0.16}),
    (PR(), {**_PLANE, "slide": pi / 2, "l_1": 0.22}),
    (RP(), {**_PLANE, "h": 0.01}),
    (PP(), {**_PLANE, "slide_1": 0.0, "slide_2": 1.7}),
    (PlanarFiveBar(), {**_PLANE, "l_0": 0.08, "l_2": 0.12, "l_3": 0.165, "l_4": 0.12, "l_6": 0.17}),
    (
        PlanarFiveBarCoupler(),
        {**_PLANE, "l_0": 0.0, "l_2": 0.08, "l_3": 0.15, "l_4": 0.15, "l_5": 0.24, "l_6": 0.16},
    ),
    (
        PRR2(),
        {**_PLANE, "R_b": 0.32, "l_0": 0.2, "slide_1": pi, "slide_2": pi, "l_1": 0.2, "l_2": 0.2},
    ),
    (RPR2(), {**_PLANE, "l_0": 0.2}),
    (PlanarRRR(), {**_PLANE, "l_1": 0.11, "l_2": 0.1, "l_3": 0.06}),
)
"""Every sub-leg with its default sizes, in the order of the documentation."""

PLATFORMS: tuple[tuple[Platform, Sizes], ...] = (
    (SpatialA(), {"platform_azimuth": _THIRDS, "R_p": 0.125, "l_r": 0.05}),
    (SpatialB(), {"platform_azimuth": _THIRDS, "R_p": 0.125, "l_r": 0.05}),
    (SpatialC(), {"platform_azimuth": _THIRDS}),
    (PlanarA(), {"platform_azimuth": _PLANAR, "R_p": 0.125, "l_r": 0.05}),
    (
        PlanarB(),
        {
            "platform_azimuth": _PLANAR,
            "b_x": (0.01, -0.004, 0.006),
            "b_y": (0.005, 0.012, -0.009),
            "l_r": (0.02, 0.025, 0.03),
        },
    ),
    (PlanarC(), {"platform_azimuth": _PLANAR}),
)
"""Every arrangement with its default sizes."""

_OWN_PLACE = {"spatial_r_fivebar_a": ("the flagship of Chapter 1", "1")}
"""Robots that the thesis treats by themselves: title and section."""

_HOME_HEIGHT = 0.35  # Section 1.8
_HOME_BETA = radians(97.0)
_HOME_SLIDE = 0.11
_OWN_SLIDES = {"spatial_upu3_b": 0.05}
"""Slides at home where the usual ones bring the sub-legs near a constraint singularity."""


def catalogue() -> tuple[Entry, ...]:
    """Every robot: sub-leg by sub-leg, each in the arrangements of its space."""
    return tuple(
        entry(subleg, platform, {**sizes, **places})
        for subleg, sizes in SUBLEGS
        for platform, places in PLATFORMS
        if subleg.space is platform.space
    )


def entry(subleg: SubLeg, platform: Platform, sizes: Sizes, home: Home | None = None) -> Entry:
    """A sub-leg on an arrangement, with the home pose that robots usually have unless it is given."""
    robot = Robot(subleg, platform)
    title = f"{subleg.notation} sub-legs, arrangement ({platform.arrangement})"
    sections = f"{subleg.section}, {platform.section}".split(", ")
    thesis = ", ".join(dict.fromkeys(sections))
    title, thesis = _OWN_PLACE.get(robot.identifier, (title, thesis))
    return Entry(
        robot, {name: _triple(value) for name, value in sizes.items()}, home or _home(robot), title, thesis
    )


def _home(robot: Robot) -> Home:
    p = (0.0, 0.0) if robot.space is Space.PLANAR else (0.0, 0.0, _HOME_HEIGHT)
    if robot.platform.redundant_joint.kind is JointKind.REVOLUTE:
        return Home(p, _triple(_HOME_BETA))
    return Home(p, _triple(_OWN_SLIDES.get(robot.identifier, _HOME_SLIDE)))


def _triple(value: float | Triple) -> Triple:
    return value if isinstance(value, tuple) else (value, value, value)
