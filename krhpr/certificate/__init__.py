"""Certificates of freedom from type II singularities: proofs that det J keeps its sign in a whole box.

    from krhpr.certificate import certify, largest_box

    certify(robot, low, high)          free, singular (with a point), or undecided (with the smallest cell)
    largest_box(robot, centre)         the largest box around a point that is certified
    certify_unique(robot, low, high)   whether the forward kinematics has one solution at most in a box

det J = det J_a det J_n depends on the three redundant coordinates alone, and on each of them in a known way
(`Form`); the numbers come from the generated function `type_2_of_redundant`, evaluated without rounding. So
no formula of a robot stands here, and lengths, radii and azimuths may differ from leg to leg.  NumPy alone
is needed.
"""

from krhpr.certificate.answer import Certificate, Finding, Method, Verdict
from krhpr.certificate.boxes import Box
from krhpr.certificate.certify import certify
from krhpr.certificate.factors import Factor, Form
from krhpr.certificate.largest import Largest, largest_box
from krhpr.certificate.unique import certify_unique

__all__ = [
    "Box",
    "Certificate",
    "Factor",
    "Finding",
    "Form",
    "Largest",
    "Method",
    "Verdict",
    "certify",
    "certify_unique",
    "largest_box",
]
