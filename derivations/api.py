"""What a sub-leg of your own is written with: one import for all of it.

A file that states a sub-leg, anywhere, begins with `from krhpr.derivations.api import ...` and ends with a
`Plugin`; `krhpr generate --plugin FILE` does the rest.  docs/adding-a-sub-leg.md explains how, and
examples/plugins/ has complete ones.
"""

from krhpr.codegen.kernel import Frame, GeometryField, GeometryType, Layout, Port, Unit
from krhpr.codegen.writer import KernelWriter
from krhpr.derivations.plugin import Plugin
from krhpr.derivations.sublegs.base import (
    Forward,
    Passive,
    PassiveLoops,
    Posture,
    SubLeg,
    VelocityEquations,
)
from krhpr.derivations.sublegs.carriers import (
    FIRST_LINK,
    SHOULDER,
    Carrier,
    FirstAxis,
    ParallelSlide,
    Slide,
    base_points,
    begin_geometry,
    in_plane,
    leg_frame_geometry,
    radial,
)
from krhpr.derivations.sublegs.five_bar import FiveBar
from krhpr.derivations.sublegs.linkages import (
    CarriedLinkage,
    Linkage,
    PlanarLinkage,
    PlaneForward,
    PlaneVelocity,
    planar_geometry,
)
from krhpr.derivations.sublegs.two_link import ELBOW, TwoLink, distance, outside, two_link
from krhpr.derivations.terms import Factor, Joint, JointKind, Link, LinkKind, Sign, Space
from krhpr.derivations.vectors import E, cross, cross2, dot

__all__ = [
    "ELBOW",
    "FIRST_LINK",
    "SHOULDER",
    "CarriedLinkage",
    "Carrier",
    "E",
    "Factor",
    "FirstAxis",
    "FiveBar",
    "Forward",
    "Frame",
    "GeometryField",
    "GeometryType",
    "Joint",
    "JointKind",
    "KernelWriter",
    "Layout",
    "Link",
    "LinkKind",
    "Linkage",
    "ParallelSlide",
    "Passive",
    "PassiveLoops",
    "PlanarLinkage",
    "PlaneForward",
    "PlaneVelocity",
    "Plugin",
    "Port",
    "Posture",
    "Sign",
    "Slide",
    "Space",
    "SubLeg",
    "TwoLink",
    "Unit",
    "VelocityEquations",
    "base_points",
    "begin_geometry",
    "cross",
    "cross2",
    "distance",
    "dot",
    "in_plane",
    "leg_frame_geometry",
    "outside",
    "planar_geometry",
    "radial",
    "two_link",
]
