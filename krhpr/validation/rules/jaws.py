"""Rules for the grasping robots: what must hold whatever the formulas are."""

from __future__ import annotations

from krhpr.validation.check import ROUND_TRIP
from krhpr.validation.rules.rule import BATCH, Rule

INVARIANTS_OF_JAWS = (
    Rule(
        "pose of the jaws",
        "forward",
        ROUND_TRIP,
        BATCH,
        "Pivot and angles come back from the joints of any working mode, and are among all solutions.",
        ("inverse", "inverse_all", "subleg_inverse", "end_points", "forward_all"),
    ),
    Rule(
        "rates of the jaws",
        "joint_rates",
        ROUND_TRIP,
        BATCH,
        "Rates come back from those of the joints, and J t = K theta_dot in the three views.",
        ("twist", "jacobians_n", "jacobians_k", "jacobians_r"),
    ),
    Rule(
        "statics of the jaws",
        "forward_statics",
        ROUND_TRIP,
        BATCH,
        "Forces do as much work as what they cause, and come back, in the three views.",
        ("inverse_statics_n", "inverse_statics_k", "inverse_statics_r", "joint_rates", "twist"),
    ),
    Rule(
        "object between the jaws",
        "grasp",
        ROUND_TRIP,
        BATCH,
        "What the jaws apply holds up the object's weight and does not turn it; loads are moments about B.",
    ),
)
