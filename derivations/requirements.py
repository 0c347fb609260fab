"""What sub-legs and platforms require of all three legs' sizes together, beyond positive lengths.

A platform or sub-leg names its requirements; robot files are held to them.  Plain numbers: no SymPy here, so
that a file can be checked where only the generated code is installed.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from enum import StrEnum

Legs = tuple[float, float, float]
"""A number for each leg."""

Sizes = Mapping[str, Legs]
"""Fields of all legs by name (metres and radians)."""


class Requirement(StrEnum):
    """A condition on the sizes; the value is its name in generated code."""

    END_POINTS_NEVER_COLLINEAR = "end_points_never_collinear"

    @property
    def doc(self) -> str:
        """What it says."""
        return {
            Requirement.END_POINTS_NEVER_COLLINEAR: (
                "no redundant angles bring S_1, S_2, S_3 onto a line (det J_n = 0): no line meets the three "
                "circles of radius l_r about B_i; with equal legs 120 deg apart, l_r < 3 R_p / 4, (1.35)"
            )
        }[self]


def end_points_never_collinear(sizes: Sizes) -> str | None:
    """Why S_1, S_2, S_3 can be collinear although each stays on its circle about B_i; None if they cannot.

    A line with the unit normal n meets three circles if the intervals n.B_i +- l_i have a point in common:
    |n.(B_i - B_j)| <= l_i + l_j for every two of them.  The directions n for which that holds are arcs;
    where all arcs meet at all, they meet at an end of one.
    """
    azimuths, radii, lengths = sizes["platform_azimuth"], sizes["R_p"], sizes["l_r"]
    x = [radius * math.cos(azimuth) for azimuth, radius in zip(azimuths, radii, strict=True)]
    y = [radius * math.sin(azimuth) for azimuth, radius in zip(azimuths, radii, strict=True)]
    pairs = []
    for i, j in ((0, 1), (1, 2), (2, 0)):
        dx, dy = x[j] - x[i], y[j] - y[i]
        pairs.append((math.hypot(dx, dy), math.atan2(dy, dx), lengths[i] + lengths[j]))
    directions = [0.0]
    for distance, along, reach in pairs:
        if reach < distance:
            bend = math.asin(reach / distance)
            directions += [along + side * math.pi / 2 + bend for side in (1, -1)]
            directions += [along + side * math.pi / 2 - bend for side in (1, -1)]
    scale = max(*radii, *lengths)
    for direction in directions:
        if all(
            abs(distance * math.cos(direction - along)) <= reach + 1e-12 * scale
            for distance, along, reach in pairs
        ):
            return _collinear(radii, lengths, azimuths)
    return None


def _collinear(radii: Legs, lengths: Legs, azimuths: Legs) -> str:
    why = "S_1, S_2, S_3 can become collinear, where det J_n = 0 (a type II singularity)"
    thirds = all(
        math.isclose(math.cos(azimuths[(i + 1) % 3] - azimuths[i]), -0.5, abs_tol=1e-9) for i in range(3)
    )
    if thirds and len(set(radii)) == 1 and len(set(lengths)) == 1:
        limit = 3 * radii[0] / 4
        return f"{why}: l_r is {lengths[0]:.6g} m and must be less than 3 R_p / 4 = {limit:.6g} m, (1.35)"
    return f"{why}: a line meets all three circles of radius l_r about B_i; shorten l_r or enlarge R_p"


CHECKS: Mapping[Requirement, Callable[[Sizes], str | None]] = {
    Requirement.END_POINTS_NEVER_COLLINEAR: end_points_never_collinear
}
"""For each requirement, why sizes do not meet it."""
