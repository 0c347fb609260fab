"""The robots that the project knows: which sub-leg, which platform arrangement, which default sizes.

A new sub-leg is a file in `sublegs/`; a new robot is a line in `catalogue()` with its sizes.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from math import radians

from krhpr.derivations.platforms.planar_a import PlanarA
from krhpr.derivations.platforms.spatial_a import SpatialA
from krhpr.derivations.platforms.spatial_c import SpatialC
from krhpr.derivations.robots import Robot
from krhpr.derivations.sublegs.planar_rr import RR
from krhpr.derivations.sublegs.r_fivebar import RFiveBar
from krhpr.derivations.sublegs.rrr import RRR

Sizes = Mapping[str, tuple[float, float, float]]


@dataclass(frozen=True)
class Entry:
    """A robot of the catalogue with its default sizes (metres and radians, a value for each leg)."""

    robot: Robot
    sizes: Sizes
    title: str
    thesis: str

    @property
    def identifier(self) -> str:
        """The name of the robot, `spatial_rrr_a`."""
        return self.robot.identifier


def _alike(value: float) -> tuple[float, float, float]:
    return (value, value, value)


_THIRDS = (0.0, radians(120.0), radians(240.0))
_PLANAR = (radians(210.0), radians(330.0), radians(90.0))

# Section 1.7: the base, the first axis and the sub-legs' links
_BASE = {"azimuth": _THIRDS, "R_b": _alike(0.25), "alpha": _alike(radians(120.0)), "l_1": _alike(0.05)}
_RRR = {**_BASE, "l_2": _alike(0.3), "l_3": _alike(0.45)}
_R_FIVEBAR = {
    **_BASE,
    "l_2": _alike(0.15),
    "l_3": _alike(0.3),
    "l_4": _alike(0.3),
    "l_5": _alike(0.45),
    "l_6": _alike(0.3),
}
_RR = {"azimuth": _PLANAR, "R_b": _alike(0.25), "l_1": _alike(0.15), "l_2": _alike(0.16)}

_SPATIAL_A = {"platform_azimuth": _THIRDS, "R_p": _alike(0.125), "l_r": _alike(0.05)}
_SPATIAL_C = {"platform_azimuth": _THIRDS}
_PLANAR_A = {"platform_azimuth": _PLANAR, "R_p": _alike(0.125), "l_r": _alike(0.05)}


def catalogue() -> tuple[Entry, ...]:
    """Every robot, in the order of the documentation."""
    return (
        Entry(
            Robot(RRR(), SpatialA()),
            {**_RRR, **_SPATIAL_A},
            "RRR legs, redundant links to revolute joints",
            "2.3",
        ),
        Entry(Robot(RFiveBar(), SpatialA()), {**_R_FIVEBAR, **_SPATIAL_A}, "the flagship of Chapter 1", "1"),
        Entry(Robot(RRR(), SpatialC()), {**_RRR, **_SPATIAL_C}, "RRR legs, radial slides", "2.3"),
        Entry(Robot(RR(), PlanarA()), {**_RR, **_PLANAR_A}, "planar RR legs, redundant links", "2.2"),
    )
