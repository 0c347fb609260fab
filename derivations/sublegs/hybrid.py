"""The hybrid sub-legs: a five-bar linkage whose plane turns about a first axis, R(RR-RRR) of Chapter 1, or
moves along a slide, P(RR-RRR) of Section 2.4.2.

(2.47) calls theta_1 what is the slide d here; theta_2 and theta_3 are both measured in the linkage plane
from x.
"""

from __future__ import annotations

from krhpr.derivations.sublegs.carriers import Carrier, FirstAxis, Slide
from krhpr.derivations.sublegs.five_bar import FiveBar
from krhpr.derivations.sublegs.linkages import CarriedLinkage
from krhpr.derivations.terms import Joint, JointKind, Sign


class RFiveBar(CarriedLinkage):
    """An actuated revolute joint and a five-bar linkage with two coaxial actuated cranks, (1.9) to (1.16)."""

    name = "r_fivebar"
    notation = "R(RR-RRR)"
    section = "1.3, App. A, App. B"
    doc = (
        "Hybrid sub-leg: the first axis carries a five-bar linkage whose two cranks turn "
        "about one axis normal to the first."
    )
    equations = "App. B"
    carrier: Carrier = FirstAxis()
    linkage = FiveBar(coupler=True, coaxial=True)
    actuators = (
        carrier.joint,
        Joint("theta_2", JointKind.REVOLUTE, "crank u_1 (l_4), from x towards e_1"),
        Joint("theta_3", JointKind.REVOLUTE, "crank u_2 (l_2), from x towards e_1"),
    )
    passive_joints = linkage.passive_joints
    inverse_signs: tuple[Sign, ...] = (*carrier.signs, *linkage.signs)
    forward_signs = linkage.forward_signs
    links = (*carrier.links, *linkage.links(carrier.origin))
    actuated_at = ("A", "c", "c")
    default_mode = "front/elbow-/rod-"
    default_assembly = "left"


class PFiveBar(RFiveBar):
    """A slide and a five-bar linkage with two coaxial actuated cranks, (2.33) to (2.50)."""

    name = "p_fivebar"
    notation = "P(RR-RRR)"
    section = "2.4.2"
    doc = (
        "Hybrid sub-leg: a slide carries a five-bar linkage whose two cranks turn about one axis "
        "along the slide."
    )
    equations = "2.4.2, App. B"
    carrier = Slide()
    actuators = (carrier.joint, *RFiveBar.actuators[1:])
    inverse_signs = RFiveBar.linkage.signs
    links = (*carrier.links, *RFiveBar.linkage.links(carrier.origin))
    actuated_at = ("d", "D", "D")
    default_mode = "elbow-/rod-"
