"""The serial PRR sub-legs of Section 2.4.1: a slide, then two links in the plane normal to it.

    s = c + d e_t + l_2 (e_x cos t_2 + e_1 sin t_2) + l_3 (e_x cos(t_2 + t_3) + e_1 sin(t_2 + t_3))

The first column of M_i is the slide's direction, and there is no shoulder singularity.
"""

from __future__ import annotations

from krhpr.derivations.sublegs.carriers import ParallelSlide, Slide
from krhpr.derivations.sublegs.linkages import CarriedLinkage
from krhpr.derivations.sublegs.two_link import TwoLink
from krhpr.derivations.terms import Joint, JointKind


class PRR(CarriedLinkage):
    """A slide along e_t, then two actuated revolute joints about it, (2.15) with its first column
    replaced.
    """

    name = "prr"
    notation = "PRR"
    section = "2.4.1"
    doc = "Serial sub-leg: a slide along e_t, then two revolute joints whose axes are parallel to it."
    equations = "2.4.1, 2.5"
    carrier: Slide = Slide()
    linkage = TwoLink("l_2", "l_3")
    actuators = (
        carrier.joint,
        Joint("theta_2", JointKind.REVOLUTE, "about e_t; link i2 from e_x towards e_1"),
        Joint("theta_3", JointKind.REVOLUTE, "about e_t; link i3 relative to link i2"),
    )
    inverse_signs = linkage.signs
    links = (*carrier.links, *linkage.links(carrier.origin))
    actuated_at = ("d", "D", "E")
    default_mode = "elbow-"


class ParallelPRR(PRR):
    """PRR sub-legs whose slides are parallel (Fig. 2.11): along them the robot's travel is unlimited."""

    name = "prr_parallel"
    doc = (
        "Serial sub-leg: a slide whose direction is that of the other legs' slides, then two revolute joints "
        "whose axes are parallel to it."
    )
    section = "2.4.1, Fig. 2.11"
    carrier = ParallelSlide()
    actuators = (carrier.joint, *PRR.actuators[1:])
