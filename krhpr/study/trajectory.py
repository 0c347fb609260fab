"""The example trajectory of Section 1.8, which Section 3.4 uses too."""

from __future__ import annotations

from math import radians
from typing import Any

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

TILT = 80
"""phi_max, (1.46), in degrees."""
RADIUS = 100
"""Of the circle (1.49), in millimetres."""
HEIGHT = 350.0
"""Of the platform, in millimetres."""


def trajectory() -> tuple[Floats, Floats]:
    """p (721, 3) in millimetres and Q (721, 3, 3) along (1.46) to (1.49) and back, in steps of one degree or
    one millimetre, both ends included.
    """
    tilts = [([0.0, 0.0, HEIGHT], _tilt(radians(angle), 0.0)) for angle in range(TILT + 1)]
    shifts = [([float(x), 0.0, HEIGHT], _tilt(radians(TILT), 0.0)) for x in range(1, RADIUS + 1)]
    circle = [
        ([RADIUS * np.cos(zeta), RADIUS * np.sin(zeta), HEIGHT], _tilt(radians(TILT), zeta))
        for zeta in np.radians(np.arange(1.0, 361.0))
    ]
    there = tilts + shifts
    poses: list[Any] = there + circle + there[-2::-1]
    return np.array([p for p, _ in poses]), np.array([q for _, q in poses])


def _tilt(phi: float, zeta: float) -> Floats:
    """(1.48), which is (1.46) at zeta = 0."""
    c, s, a, b = np.cos(phi), np.sin(phi), np.cos(zeta), np.sin(zeta)
    return np.array(
        [
            [b * b + a * a * c, a * b * (c - 1), a * s],
            [a * b * (c - 1), a * a + b * b * c, b * s],
            [-a * s, -b * s, c],
        ]
    )
