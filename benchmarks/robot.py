"""The robot that all contenders are specialised to: spatial 3-RRRSR, arrangement (a), and a hybrid leg.

Metres. Exact zeros and ones are integers, so that no back end has to carry ``0.0*x`` or ``1.0*x`` around.
Only the standard library is used here: peers import this module inside environments of their own.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

Vector = tuple[float, float, float]

R_BASE = 0.25
R_PLATFORM = 0.125
L1 = 0.05
L2 = 0.3
L3 = 0.45
L_REDUNDANT = 0.05
SIN_60 = math.sqrt(0.75)
ALPHA_COS_SIN = (-0.5, SIN_60)  # alpha = 120 deg
AZIMUTHS_COS_SIN = ((1, 0), (-0.5, SIN_60), (-0.5, -SIN_60))  # 0, 120, 240 deg


@dataclass(frozen=True)
class HybridLeg:
    """Lengths of R(RR-RRR) in the names of chapter 1: cranks u1 (``l4``) and u2 (``l2``), rod v2 (``l3``),
    whole distal link (``l5``) and its part next to S (``l6``)."""

    l4: float = 0.3
    l2: float = 0.15
    l3: float = 0.29
    l5: float = 0.45
    l6: float = 0.3


HYBRID = HybridLeg()


@dataclass(frozen=True)
class LegFrame:
    """Constants of one leg: azimuth vectors, first axis ``e1``, in-plane start ``e_x`` and shoulder ``c``."""

    e_r: Vector
    e_t: Vector
    e_x: Vector
    e_1: Vector
    c: Vector


def _exact(value: float) -> float:
    """Integers for 0, 1 and -1, quarters without their rounding error, anything else as it is."""
    for simple in (0, 1, -1, 0.25, -0.25, 0.5, -0.5, 0.75, -0.75):
        if abs(value - simple) < 1e-14:
            return simple
    return value


def _vector(x: float, y: float, z: float) -> Vector:
    return (_exact(x), _exact(y), _exact(z))


def _leg(cos_az: float, sin_az: float) -> LegFrame:
    cos_al, sin_al = ALPHA_COS_SIN
    radius = R_BASE - L1 * cos_al
    return LegFrame(
        e_r=_vector(cos_az, sin_az, 0.0),
        e_t=_vector(-sin_az, cos_az, 0.0),
        e_x=_vector(-sin_al * cos_az, -sin_al * sin_az, -cos_al),
        e_1=_vector(-cos_al * cos_az, -cos_al * sin_az, sin_al),
        c=_vector(radius * cos_az, radius * sin_az, L1 * sin_al),
    )


LEGS: tuple[LegFrame, ...] = tuple(_leg(*azimuth) for azimuth in AZIMUTHS_COS_SIN)

# Projections of every shoulder on its own e_x and e_1; that on e_t is zero.
SHOULDER_X = sum(a * b for a, b in zip(LEGS[0].c, LEGS[0].e_x, strict=True))
SHOULDER_1 = sum(a * b for a, b in zip(LEGS[0].c, LEGS[0].e_1, strict=True))
