"""Rules for invariants: what must hold whatever the formulas are."""

from __future__ import annotations

from krhpr.codegen.robot_code import RobotCode
from krhpr.validation.check import EXACT, ROUND_TRIP, Samples
from krhpr.validation.rules.known import FIRST_PRINCIPLES
from krhpr.validation.rules.rule import BATCH, EVERY, Rule


def factors_are_signs(robot: RobotCode) -> bool:
    """Whether the signs of a working mode are those of the leg's first factors."""
    return robot.subleg.name in FIRST_PRINCIPLES


INVARIANTS = (
    Rule(
        "loop closure",
        "constraints",
        ROUND_TRIP,
        BATCH,
        "End points satisfy the constraint equations.",
        ("end_points",),
    ),
    Rule(
        "redundant coordinates",
        "redundant_coordinates",
        ROUND_TRIP,
        BATCH,
        "Redundant coordinates come back from the end points.",
        ("end_points",),
    ),
    Rule(
        "forward after inverse",
        "subleg_inverse",
        ROUND_TRIP,
        BATCH,
        "Every working mode leads back to the end point, in an assembly mode of its own.",
        ("subleg_forward",),
    ),
    Rule(
        "inverse after forward",
        "subleg_forward",
        ROUND_TRIP,
        BATCH,
        "In every assembly mode the joints are found again among the working modes.",
        ("subleg_inverse",),
    ),
    Rule(
        "modes",
        "inverse_all",
        ROUND_TRIP,
        BATCH,
        "inverse, inverse_all and subleg_inverse give the same joints in the same order of modes.",
        ("inverse", "subleg_inverse"),
    ),
    Rule(
        "signs of modes",
        "inverse",
        EXACT,
        BATCH,
        "The signs of the working mode are those of the leg's factors.",
        ("singularity",),
        factors_are_signs,
    ),
    Rule(
        "defaults",
        "inverse",
        ROUND_TRIP,
        BATCH,
        "Without a mode the default working mode is used, and without an assembly mode its end point "
        "comes back.",
        ("subleg_forward",),
    ),
    Rule(
        "virtual work",
        "twist",
        ROUND_TRIP,
        BATCH,
        "The power of any wrench equals that of the torques (J^-1 K)^T F that balance it.",
        ("jacobians",),
    ),
    Rule(
        "J t = K theta_dot",
        "jacobians",
        ROUND_TRIP,
        BATCH,
        "The velocity equation holds.",
        ("joint_rates", "jacobian_blocks"),
    ),
    Rule("rates and twist", "joint_rates", ROUND_TRIP, BATCH, "twist undoes joint_rates.", ("twist",)),
    Rule(
        "accelerations",
        "joint_accelerations",
        ROUND_TRIP,
        BATCH,
        "platform_acceleration undoes joint_accelerations.",
        ("platform_acceleration",),
    ),
    Rule(
        "virtual work of actuators",
        "inverse_statics",
        ROUND_TRIP,
        BATCH,
        "The power of the actuators is that of the forces that the robot applies; f = (J^-1 K)^T F where the "
        "wrench alone acts.",
        ("joint_rates", "jacobians"),
    ),
    Rule(
        "non-redundant view",
        "jacobians_n",
        ROUND_TRIP,
        BATCH,
        "J_n [t, redundant rates, swivel rates] = K_n theta_dot, and f = (J_n^-1 K_n)^T F_n.",
        ("joint_rates", "inverse_statics"),
    ),
    Rule(
        "statics there and back",
        "forward_statics",
        ROUND_TRIP,
        BATCH,
        "forward_statics undoes inverse_statics.",
        ("inverse_statics",),
    ),
    Rule(
        "opening",
        "opening",
        ROUND_TRIP,
        BATCH,
        "The slides at which the jaws touch an object have its diameter and centre as their opening; the "
        "jaws surround it.",
        ("redundant_of_opening",),
    ),
    Rule(
        "grasp",
        "grasp",
        ROUND_TRIP,
        BATCH,
        "What the jaws apply holds up the object's weight and does not turn it.",
        ("end_points",),
    ),
    Rule(
        "singular statics",
        "inverse_statics",
        EXACT,
        Samples(10, 300),
        "Where a leg is straight its force is unknown, where the platform is singular it bears no wrench, "
        "and the status says so.",
        ("forward_statics",),
    ),
    Rule(
        "determinants",
        "singularity",
        ROUND_TRIP,
        BATCH,
        "det M and the factors of det J are those of the matrices.",
        ("subleg_jacobian", "jacobians"),
    ),
    Rule(
        "margins",
        "singularity",
        EXACT,
        BATCH,
        "Margins are positive inside the working box of the redundant coordinates.",
        ("end_points",),
    ),
    Rule(
        "type II of the redundant coordinates",
        "type_2_of_redundant",
        ROUND_TRIP,
        BATCH,
        "Factors of det J and margins are those that `singularity` gives at the pose.",
        ("singularity",),
    ),
    Rule(
        "indices",
        "indices",
        ROUND_TRIP,
        BATCH,
        "The indices are singular values, by the SVD, of J^-1 K and of the M_i.",
        ("jacobians", "subleg_jacobian"),
    ),
    Rule(
        "bounds of the indices",
        "index_bounds",
        ROUND_TRIP,
        BATCH,
        "The bounds are Schatten norms by the SVD: not below the indices, and above them by less than is "
        "stated.",
        ("indices", "jacobians", "subleg_jacobian"),
    ),
    Rule(
        "assembly modes of the sub-leg",
        "subleg_forward_all",
        ROUND_TRIP,
        BATCH,
        "Each end point closes its leg with the joints given, and one is that of the pose.",
        ("end_points",),
    ),
    Rule(
        "assembly modes",
        "forward_all",
        ROUND_TRIP,
        BATCH,
        "The pose is among the solutions, an even number, each of which closes the platform and has the "
        "det J of its redundant coordinates; of the two of (b) and (c) each has its side of type II.",
        ("end_points", "constraints", "type_2_of_redundant"),
    ),
    Rule(
        "pose after inverse",
        "forward",
        ROUND_TRIP,
        BATCH,
        "From the joints alone the pose and the redundant coordinates come back, on their side of type II.",
        ("forward_all",),
    ),
    Rule(
        "passive joints of the actuated ones",
        "passive_joints_of_theta",
        ROUND_TRIP,
        BATCH,
        "From the actuated joints alone come the passive joints at the pose.",
        ("passive_joints",),
    ),
    Rule(
        "singular configurations",
        "twist",
        EXACT,
        Samples(10, 300),
        "Where a leg is straight, or the platform's lines or end points are dependent, the status says so "
        "and only what depends on it is NaN.",
        ("joint_rates", "platform_acceleration", "joint_accelerations"),
    ),
    Rule(
        "status of inverse",
        "inverse_status",
        EXACT,
        BATCH,
        "The excess is positive, and the status names the first leg, just where inverse has no answer.",
        ("inverse",),
    ),
    Rule(
        "nearest mode",
        "inverse_near",
        ROUND_TRIP,
        Samples(3, 12),
        "Along closed paths across +-pi inverse_near goes on without a jump, stays a solution and returns.",
        ("inverse",),
    ),
    Rule(
        "passive joints",
        "passive_joints",
        ROUND_TRIP,
        BATCH,
        "Links laid end to end with the actuated and passive angles lead to the platform's joint.",
        (),
        factors_are_signs,
    ),
    Rule(
        "turned base",
        EVERY,
        ROUND_TRIP,
        Samples(10, 300),
        "Turning the base about z turns vectors in the base frame and leaves joints and scalars alone.",
    ),
    Rule(
        "legs exchanged",
        EVERY,
        ROUND_TRIP,
        Samples(10, 300),
        "Exchanging unequal legs exchanges their results, leaves the platform's and gives det J the sign"
        " of the permutation.",
    ),
    Rule(
        "lengths scaled",
        EVERY,
        EXACT,
        Samples(10, 300),
        "With all lengths doubled each result is multiplied by the power of two of its unit, to the last"
        " bit.",
    ),
)
