"""Does a box of redundant coordinates hold one solution of the forward kinematics at most?

Arrangement (a): with D_i = |S_i S_i+1|^2, the Jacobian of (D_1, D_2, D_3) with respect to the redundant
angles has two entries in each row, so that its principal minors are products of the diagonal entries
dD_i/dbeta_i, and its determinant, -8 det J_a det J_n.  Where no diagonal entry vanishes in a box, and the
determinant has the sign of their product, the theorem of Gale and Nikaido says that (D_1, D_2, D_3) tells the
angles (errata, 4, for equal legs).  This holds for any sizes; what is proven is that the signs hold.

Arrangements (b) and (c): of the two solutions one is on each side of type II, so that a box in which det J_a
does not vanish holds one.
"""

from __future__ import annotations

from fractions import Fraction
from itertools import product
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from krhpr.certificate.answer import Certificate, Finding, Method, Verdict
from krhpr.certificate.boxes import LEGS, make_box
from krhpr.certificate.certify import certify_factor
from krhpr.certificate.exact import number
from krhpr.certificate.factors import CORNERS, Factor, Form, exact_geometry, factors, is_angular
from krhpr.certificate.intervals import CELLS
from krhpr.robot import Robot


def certify_unique(
    robot: Robot, low: ArrayLike, high: ArrayLike, *, closed: bool = True, cells: int = CELLS
) -> Certificate:
    """Whether `forward` has one answer at most in a box of redundant coordinates: free if it is proven.

    The arguments are those of `certify`.  The findings are the diagonal entries and the factors of the
    determinant; where their signs do not belong together, the last one is undecided.
    """
    box = make_box(low, high, angular=is_angular(robot), closed=closed)
    if not is_angular(robot):
        in_plane = certify_factor(robot, factors(robot)[0], box, cells)
        return Certificate(robot.identifier, box, (in_plane,))
    legs = [_Leg(robot, leg) for leg in range(LEGS)]
    wanted = [_diagonal(legs, leg) for leg in range(LEGS)]
    determinant = [*factors(robot), *([_area(legs)] if robot.planar else [])]
    findings = [certify_factor(robot, factor, box, cells) for factor in (*wanted, *determinant)]
    if all(finding.verdict is Verdict.FREE for finding in findings):
        signs = [
            finding.sign * (1 if factor.margin > 0 else -1)
            for finding, factor in zip(findings, (*wanted, *determinant), strict=True)
        ]
        if np.prod(signs) > 0:  # the determinant is -8 times the last ones
            last = findings[-1]
            findings[-1] = Finding(last.factor, Verdict.UNDECIDED, Method.INTERVALS, last.sign, cell=box)
    return Certificate(robot.identifier, box, tuple(findings))


class _Leg:
    """S_i = B_i - cos(beta_i) r + sin(beta_i) t in the platform frame, without rounding."""

    def __init__(self, robot: Robot, leg: int) -> None:
        module = robot._module
        geometry = exact_geometry(module, robot.geometry)
        count = len(CORNERS)
        p = np.empty((count, 2 if robot.planar else 3), dtype=object)
        p[...] = number(0)
        turn = np.empty((count,) if robot.planar else (count, 3, 3), dtype=object)
        for index in np.ndindex(*turn.shape):
            turn[index] = CORNERS[0] if robot.planar else number(int(index[1] == index[2]))
        grid = np.empty((count, LEGS), dtype=object)
        for index in np.ndindex(*grid.shape):
            grid[index] = CORNERS[index[0]]
        s = module.end_points(p, turn, grid, geometry=geometry)[:, leg, :2]
        half = Fraction(1, 2)
        self.joint = [(a + b) * half for a, b in zip(s[0], s[2], strict=True)]
        self.radial = [(b - a) * half for a, b in zip(s[0], s[2], strict=True)]
        self.across = [a - b for a, b in zip(s[1], self.joint, strict=True)]

    def point(self) -> list[Any]:
        """S_i in the basis (1, cos, sin)."""
        return [[b, -r, t] for b, r, t in zip(self.joint, self.radial, self.across, strict=True)]

    def slope(self) -> list[Any]:
        """dS_i/dbeta_i in the same basis."""
        return [[number(0), t, r] for r, t in zip(self.radial, self.across, strict=True)]


def _diagonal(legs: list[_Leg], i: int) -> Factor:
    """(S_i - S_i+1)^T dS_i/dbeta_i, without its part |S_i - B_i|^2, whose slope is zero."""
    j = (i + 1) % LEGS
    own, other, slope = legs[i], legs[j].point(), legs[i].slope()
    coefficients = _zeros()
    for axis, a, b in product(range(2), range(3), range(3)):
        arm = (own.joint[axis] if b == 0 else number(0)) - other[axis][b]
        place = [0, 0, 0]
        place[i], place[j] = a, b
        coefficients[tuple(place)] = coefficients[tuple(place)] + slope[axis][a] * arm
    return Factor(f"dD_{i + 1}/dbeta_{i + 1}", Form.TRIGONOMETRIC, coefficients, 1.0)


def _area(legs: list[_Leg]) -> Factor:
    """Twice the signed area, which is det J_n in space."""
    coefficients = _zeros()
    for i in range(LEGS):
        j = (i + 1) % LEGS
        first, second = legs[i].point(), legs[j].point()
        for a, b in product(range(3), range(3)):
            place = [0, 0, 0]
            place[i], place[j] = a, b
            moment = first[0][a] * second[1][b] - first[1][a] * second[0][b]
            coefficients[tuple(place)] = coefficients[tuple(place)] + moment
    return Factor("area of S_1 S_2 S_3", Form.TRIGONOMETRIC, coefficients, 1.0)


def _zeros() -> Any:
    found = np.empty((3, 3, 3), dtype=object)
    found[...] = number(0)
    return found
