"""Rules for finite differences: functions that are derivatives."""

from __future__ import annotations

from krhpr.validation.check import FIRST, SECOND
from krhpr.validation.rules.rule import BATCH, Rule

DIFFERENCES = (
    Rule(
        "M of forward",
        "subleg_jacobian",
        FIRST,
        BATCH,
        "M equals the difference quotients of subleg_forward.",
        ("subleg_forward",),
    ),
    Rule(
        "M of inverse",
        "subleg_jacobian",
        FIRST,
        BATCH,
        "M times the difference quotients of subleg_inverse is the identity, in every working mode.",
        ("subleg_inverse",),
    ),
    Rule(
        "J",
        "jacobians",
        FIRST,
        BATCH,
        "J equals the difference quotients of constraints over the pose.",
        ("constraints",),
    ),
    Rule(
        "K",
        "jacobians",
        FIRST,
        BATCH,
        "K equals those of constraints over the joints, through subleg_forward.",
        ("constraints", "subleg_forward"),
    ),
    Rule(
        "J and blocks",
        "jacobian_blocks",
        FIRST,
        BATCH,
        "J and the blocks of K equal difference quotients of constraints.",
        ("constraints", "subleg_forward"),
    ),
    Rule(
        "rates",
        "joint_rates",
        FIRST,
        BATCH,
        "joint_rates equals difference quotients of inverse along a motion.",
        ("inverse", "end_points"),
    ),
    Rule(
        "twist",
        "twist",
        FIRST,
        BATCH,
        "twist of the difference quotients of inverse is the twist of the motion.",
        ("inverse",),
    ),
    Rule(
        "accelerations",
        "joint_accelerations",
        FIRST,
        BATCH,
        "joint_accelerations equals difference quotients of joint_rates along a motion.",
        ("joint_rates",),
    ),
    Rule(
        "second differences",
        "joint_accelerations",
        SECOND,
        BATCH,
        "joint_accelerations equals second differences of inverse along a motion.",
        ("inverse",),
    ),
    Rule(
        "platform acceleration",
        "platform_acceleration",
        FIRST,
        BATCH,
        "platform_acceleration of the difference quotients of joint_rates is that of the motion.",
        ("joint_rates",),
    ),
)
