"""The planar serial RR sub-leg of Section 2.2: r = o + l_1 u(t_1) + l_2 u(t_1 + t_2)."""

from __future__ import annotations

from krhpr.derivations.sublegs.linkages import PlanarLinkage
from krhpr.derivations.sublegs.two_link import TwoLink
from krhpr.derivations.terms import Joint, JointKind


class RR(PlanarLinkage):
    """Two actuated revolute joints in series, (2.4)."""

    name = "rr"
    notation = "RR"
    section = "2.2"
    doc = "Planar serial sub-leg with two actuated revolute joints."
    equations = "2.2.1, 2.5"
    linkage = TwoLink("l_1", "l_2")
    actuators = (
        Joint("theta_1", JointKind.REVOLUTE, "first link, from the x axis of the base"),
        Joint("theta_2", JointKind.REVOLUTE, "second link relative to the first"),
    )
    inverse_signs = linkage.signs
    links = linkage.links("A")
    actuated_at = ("A", "E")
    default_mode = "elbow+"
