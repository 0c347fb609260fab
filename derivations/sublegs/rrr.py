"""The serial RRR sub-leg of Section 2.3: a first axis, then two links in the linkage plane.

theta_3 is relative to the second link:

    s = c + l_2 (x cos t_2 + e_1 sin t_2) + l_3 (x cos(t_2 + t_3) + e_1 sin(t_2 + t_3))
"""

from __future__ import annotations

from krhpr.derivations.sublegs.carriers import FirstAxis
from krhpr.derivations.sublegs.linkages import CarriedLinkage
from krhpr.derivations.sublegs.two_link import TwoLink
from krhpr.derivations.terms import Joint, JointKind


class RRR(CarriedLinkage):
    """Three actuated revolute joints in series, (2.15)."""

    name = "rrr"
    notation = "RRR"
    section = "2.3"
    doc = (
        "Serial sub-leg: the first axis leans outwards by alpha, the next two are parallel to"
        " each other and normal to it."
    )
    equations = "1.5, 2.5"
    carrier = FirstAxis()
    linkage = TwoLink("l_2", "l_3")
    actuators = (
        carrier.joint,
        Joint("theta_2", JointKind.REVOLUTE, "about e_2; link i2 from x towards e_1"),
        Joint("theta_3", JointKind.REVOLUTE, "about e_2; link i3 relative to link i2"),
    )
    inverse_signs = (*carrier.signs, *linkage.signs)
    links = (*carrier.links, *linkage.links(carrier.origin))
    actuated_at = ("A", "c", "E")
    default_mode = "front/elbow-"
