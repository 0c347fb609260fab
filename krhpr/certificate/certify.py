"""Is a box of redundant coordinates free of type II singularities?"""

from __future__ import annotations

from numpy.typing import ArrayLike

from krhpr.certificate.answer import Certificate, Finding, Method, Verdict
from krhpr.certificate.boxes import Box, make_box
from krhpr.certificate.circles import never_collinear
from krhpr.certificate.factors import Factor, Form, factors, is_angular
from krhpr.certificate.intervals import CELLS, interval_test
from krhpr.certificate.points import sign_change
from krhpr.certificate.vertices import vertex_test
from krhpr.robot import Robot


def certify(
    robot: Robot, low: ArrayLike, high: ArrayLike, *, closed: bool = True, cells: int = CELLS
) -> Certificate:
    """Whether every factor of det J keeps the sign that it has at the centre of a box.

    Args:
        robot: the robot with its geometry.
        low: lower bounds of the redundant coordinates (rad or m): one for all legs or three.
        high: upper bounds, each above its lower bound; of angles at most a full turn.
        closed: whether the box's faces belong to it.
        cells: how many cells the interval test may look at.

    Raises:
        InvalidInput: bounds that are not finite, of another shape, in the wrong order or too far apart.
    """
    box = make_box(low, high, angular=is_angular(robot), closed=closed)
    return judge(robot, box, cells)


def judge(robot: Robot, box: Box, cells: int = CELLS, *, bounds: bool = True) -> Certificate:
    """The same for a box; without `bounds`, a factor that never vanishes is not bounded further."""
    findings = tuple(certify_factor(robot, factor, box, cells, bounds) for factor in factors(robot))
    return Certificate(robot.identifier, box, findings)


def certify_factor(robot: Robot, factor: Factor, box: Box, cells: int, bounds: bool = True) -> Finding:
    """What is known of one factor in a box."""
    regular = factor.collinear and never_collinear(robot)
    method = Method.INTERVALS if factor.form is Form.TRIGONOMETRIC else Method.VERTICES
    sign = factor.at([factor.coordinate(x) for x in box.centre]).sign()
    if sign is None:
        point = sign_change(factor, box)
        if point is not None:
            return Finding(factor.name, Verdict.SINGULAR, method, 0, point=point)
        return Finding(factor.name, Verdict.UNDECIDED, method, 0, cell=Box(box.centre, box.centre))
    if sign == 0:
        return Finding(factor.name, Verdict.SINGULAR, method, 0, point=box.centre)
    if factor.form is not Form.TRIGONOMETRIC:
        return vertex_test(factor, box, sign)
    if not regular:
        return interval_test(factor, box, sign, cells)
    bound = interval_test(factor, box, sign, cells).bound if bounds else 0.0
    margin_sign = sign if factor.margin > 0 else -sign
    return Finding(factor.name, Verdict.FREE, Method.CLOSED_FORM, margin_sign, bound)
