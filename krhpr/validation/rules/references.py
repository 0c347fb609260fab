"""Rules for references: numbers of the thesis and of its plain geometry."""

from __future__ import annotations

from krhpr.validation.check import ROUND_TRIP, Samples
from krhpr.validation.rules.known import WITHOUT_REFERENCE
from krhpr.validation.rules.rule import Rule

REFERENCES = (
    Rule(
        "robots",
        "jacobians",
        ROUND_TRIP,
        Samples(1, 1),
        "End points, all inverse solutions, M, J, K and det J of the reference configurations.",
        ("end_points", "redundant_coordinates", "subleg_inverse", "subleg_jacobian", "singularity"),
        lambda robot: robot.subleg.name not in WITHOUT_REFERENCE,
    ),
    Rule(
        "platforms",
        "constraints",
        ROUND_TRIP,
        Samples(1, 1),
        "Poses that hold given end points, the example of Section 3.2.1 among them, satisfy the "
        "constraints and have the "
        "redundant coordinates of the reference.",
        ("redundant_coordinates",),
        lambda robot: not robot.identifier.startswith("planar"),
    ),
    Rule(
        "chapter 1",
        "inverse_near",
        ROUND_TRIP,
        Samples(1, 1),
        "Section 1.8: joint ranges along 721 poses (at most 59.96 deg), condition numbers of M and norms"
        " of J^-1 K.",
        ("end_points", "jacobians", "subleg_jacobian"),
        lambda robot: robot.identifier == "spatial_r_fivebar_a",
    ),
    Rule(
        "chapter 4",
        "jacobians",
        ROUND_TRIP,
        Samples(1, 1),
        "Chapter 4: end points, M, J, K, the indices eta and the margin D at sixteen configurations.",
        ("end_points", "inverse", "subleg_jacobian", "singularity"),
        lambda robot: robot.identifier == "spatial_rrr_a",
    ),
)
