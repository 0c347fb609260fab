"""The rules of the plan as tables: a row says what is checked, how closely, and in one sentence what it
means.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from krhpr.codegen.composition import RobotCode
from krhpr.validation.check import BALL, EXACT, FIRST, ROUND_TRIP, SECOND, Samples, Target

NUMERIC = (Target.C, Target.NUMPY)

EVERY = "every function"
"""The name under which checks of all functions together go."""

FIRST_PRINCIPLES = ("subleg_rrr", "subleg_r_fivebar", "subleg_planar_rr")
"""Sub-legs whose closure is written a second time from rotations of vectors, and whose thesis matrices
are copied.
"""

THESIS_ROWS = ("platform_spatial_a", "platform_spatial_c", "platform_planar_a")
"""Arrangements whose J is written as the thesis prints it."""

WITH_REFERENCE = ("spatial_rrr_a", "spatial_r_fivebar_a", "spatial_rrr_c", "planar_rr_a")
"""Robots with reference configurations."""

MANY = Samples(4, 40)
FEW = Samples(2, 12)


@dataclass(frozen=True)
class Proof:
    """A statement about a part's kernel or a robot's function, made of the derivation alone."""

    name: str
    kernel: str
    tolerance: float
    samples: Samples
    statement: str
    also: tuple[str, ...] = ()
    only: tuple[str, ...] | None = None


SUBLEG_PROOFS = (
    Proof(
        "velocity equations",
        "velocity",
        EXACT,
        MANY,
        "A, B and M = A^-1 B equal the implicit derivative of the loop closure, found by differentiating"
        " its graph.",
        ("jacobian",),
    ),
    Proof(
        "first principles",
        "jacobian",
        EXACT,
        MANY,
        "The closure equals one written from rotations of vectors, and M equals its implicit derivative "
        "by SymPy.",
        only=FIRST_PRINCIPLES,
    ),
    Proof(
        "thesis matrices",
        "velocity",
        EXACT,
        MANY,
        "A, B and M equal the thesis' matrices written in the base frame: (1.10) to (1.15) with the "
        "erratum of (1.10) and "
        "(A.2); (2.15); the planar RR column by column.",
        ("jacobian",),
        FIRST_PRINCIPLES,
    ),
    Proof(
        "products of M",
        "project",
        EXACT,
        MANY,
        "project = N M, velocity = M theta_dot and rates = M^-1 s_dot; their guards are the factors of "
        "det M.",
        ("velocity", "rates"),
    ),
    Proof(
        "determinant of M",
        "determinant",
        EXACT,
        MANY,
        "The closed form of det M equals the determinant of M; the dimensionless factors multiply up to "
        "it, with a "
        "constant of the geometry.",
    ),
    Proof(
        "accelerations",
        "bias",
        EXACT,
        MANY,
        "Along a motion, as truncated Taylor series: s_dot = M theta_dot and s_ddot = M theta_ddot + "
        "bias for the end point "
        "of `forward`, which satisfies the closure to second order.",
        ("forward", "velocity"),
    ),
    Proof(
        "forward closes",
        "forward",
        EXACT,
        MANY,
        "`forward` satisfies the closure in every assembly mode, and its posture is that of `posture`.",
        ("forward_posture", "posture"),
    ),
    Proof(
        "inverse closes",
        "inverse",
        BALL,
        MANY,
        "`inverse` satisfies the closure in every working mode, each a different solution; `inverse_all`"
        " has them in order.",
        ("inverse_all",),
    ),
    Proof(
        "reach",
        "reach",
        EXACT,
        MANY,
        "At random points within and out of reach: `reach` is positive just where the working mode does "
        "not exist.",
    ),
    Proof(
        "passive joints",
        "passive",
        EXACT,
        MANY,
        "The links, laid end to end with the passive angles, meet in S_i; the last link's frame is a "
        "rotation.",
        only=FIRST_PRINCIPLES,
    ),
)

PLATFORM_PROOFS = (
    Proof(
        "closure",
        "end_point",
        EXACT,
        MANY,
        "The end point satisfies the constraint equations, and the redundant coordinate comes back from it.",
        ("residual", "redundant"),
    ),
    Proof(
        "rows",
        "rows",
        EXACT,
        MANY,
        "J t - N s_dot equals the derivative of the constraint equations along any twist and s_dot.",
        ("residual",),
    ),
    Proof("thesis rows", "rows", EXACT, MANY, "J equals (1.31), (2.28), (2.7) as printed.", only=THESIS_ROWS),
    Proof(
        "lines",
        "line",
        EXACT,
        MANY,
        "Lines and points are the rows of J and S_i in the platform frame.",
    ),
    Proof(
        "end velocity and acceleration",
        "end_velocity",
        EXACT,
        MANY,
        "Along a motion, as truncated Taylor series: s_dot and s_ddot equal the derivatives of `end_point`.",
        ("end_acceleration",),
    ),
    Proof(
        "row bias",
        "row_bias",
        EXACT,
        MANY,
        "Along a motion: J t_dot = N s_ddot + bias, with s_ddot differentiated from `end_point`.",
    ),
    Proof(
        "solve",
        "solve",
        EXACT,
        MANY,
        "J times the twist of `solve` gives the rates back, for any S_i; its guards are det J_a and det J_n, "
        "made dimensionless.",
    ),
    Proof(
        "determinant of J",
        "type_2",
        EXACT,
        MANY,
        "det J = det J_a det J_n, and both equal their closed forms in the redundant coordinates.",
    ),
    Proof(
        "equilateral",
        "type_2",
        EXACT,
        MANY,
        "For legs at 120 deg and equal lengths, in the field of rationals with sqrt(3): -l^3 r f and g, "
        "or (sqrt3/2) s1 and "
        "(sqrt3/2) s2.",
        only=THESIS_ROWS,
    ),
    Proof(
        "joint",
        "joint",
        EXACT,
        MANY,
        "The redundant link's frame is a rotation and points from S_i to its joint.",
    ),
)

ROBOT_PROOFS = (
    Proof(
        "joint motion",
        "joint_rates",
        EXACT,
        FEW,
        "Along a motion of the platform: joints with these rates and accelerations satisfy the legs' "
        "closure to second "
        "order, as truncated Taylor series.",
        ("joint_accelerations",),
    ),
    Proof(
        "inverse maps",
        "twist",
        EXACT,
        FEW,
        "twist undoes joint_rates, and platform_acceleration undoes joint_accelerations.",
        ("joint_rates", "platform_acceleration", "joint_accelerations"),
    ),
    Proof(
        "velocity equation",
        "jacobians",
        EXACT,
        FEW,
        "J t = K theta_dot for the twist and the rates above, with K from its blocks; N M is K.",
        ("jacobian_blocks", "subleg_jacobian", "twist"),
    ),
    Proof(
        "det J",
        "singularity",
        EXACT,
        FEW,
        "det J equals the product of its factors, det M those of the legs.",
        ("jacobians", "subleg_jacobian"),
    ),
)


# -- generated functions, numerically ---------------------


@dataclass(frozen=True)
class Rule:
    """A check of a generated function in doubles."""

    name: str
    function: str
    tolerance: float
    samples: Samples
    statement: str
    also: tuple[str, ...] = ()
    applies: Callable[[RobotCode], bool] = lambda robot: True
    targets: Sequence[Target] = NUMERIC


_BATCH = Samples(40, 2000)

DIFFERENCES = (
    Rule(
        "M of forward",
        "subleg_jacobian",
        FIRST,
        _BATCH,
        "M equals the difference quotients of subleg_forward.",
        ("subleg_forward",),
    ),
    Rule(
        "M of inverse",
        "subleg_jacobian",
        FIRST,
        _BATCH,
        "M times the difference quotients of subleg_inverse is the identity, in every working mode.",
        ("subleg_inverse",),
    ),
    Rule(
        "J",
        "jacobians",
        FIRST,
        _BATCH,
        "J equals the difference quotients of constraints over the pose.",
        ("constraints",),
    ),
    Rule(
        "K",
        "jacobians",
        FIRST,
        _BATCH,
        "K equals those of constraints over the joints, through subleg_forward.",
        ("constraints", "subleg_forward"),
    ),
    Rule(
        "J and blocks",
        "jacobian_blocks",
        FIRST,
        _BATCH,
        "J and the blocks of K equal difference quotients of constraints.",
        ("constraints", "subleg_forward"),
    ),
    Rule(
        "rates",
        "joint_rates",
        FIRST,
        _BATCH,
        "joint_rates equals difference quotients of inverse along a motion.",
        ("inverse", "end_points"),
    ),
    Rule(
        "twist",
        "twist",
        FIRST,
        _BATCH,
        "twist of the difference quotients of inverse is the twist of the motion.",
        ("inverse",),
    ),
    Rule(
        "accelerations",
        "joint_accelerations",
        FIRST,
        _BATCH,
        "joint_accelerations equals difference quotients of joint_rates along a motion.",
        ("joint_rates",),
    ),
    Rule(
        "second differences",
        "joint_accelerations",
        SECOND,
        _BATCH,
        "joint_accelerations equals second differences of inverse along a motion.",
        ("inverse",),
    ),
    Rule(
        "platform acceleration",
        "platform_acceleration",
        FIRST,
        _BATCH,
        "platform_acceleration of the difference quotients of joint_rates is that of the motion.",
        ("joint_rates",),
    ),
)


def factors_are_signs(robot: RobotCode) -> bool:
    """Whether the signs of a working mode are those of the leg's first factors."""
    return robot.subleg.name in FIRST_PRINCIPLES


INVARIANTS = (
    Rule(
        "loop closure",
        "constraints",
        ROUND_TRIP,
        _BATCH,
        "End points satisfy the constraint equations.",
        ("end_points",),
    ),
    Rule(
        "redundant coordinates",
        "redundant_coordinates",
        ROUND_TRIP,
        _BATCH,
        "Redundant coordinates come back from the end points.",
        ("end_points",),
    ),
    Rule(
        "forward after inverse",
        "subleg_inverse",
        ROUND_TRIP,
        _BATCH,
        "Every working mode leads back to the end point, in an assembly mode of its own.",
        ("subleg_forward",),
    ),
    Rule(
        "inverse after forward",
        "subleg_forward",
        ROUND_TRIP,
        _BATCH,
        "In every assembly mode the joints are found again among the working modes.",
        ("subleg_inverse",),
    ),
    Rule(
        "modes",
        "inverse_all",
        ROUND_TRIP,
        _BATCH,
        "inverse, inverse_all and subleg_inverse give the same joints in the same order of modes.",
        ("inverse", "subleg_inverse"),
    ),
    Rule(
        "signs of modes",
        "inverse",
        EXACT,
        _BATCH,
        "The signs of the working mode are those of the leg's factors.",
        ("singularity",),
        factors_are_signs,
    ),
    Rule(
        "defaults",
        "inverse",
        ROUND_TRIP,
        _BATCH,
        "Without a mode the default working mode is used, and without an assembly mode its end point "
        "comes back.",
        ("subleg_forward",),
    ),
    Rule(
        "virtual work",
        "twist",
        ROUND_TRIP,
        _BATCH,
        "The power of any wrench equals that of the torques (J^-1 K)^T F that balance it.",
        ("jacobians",),
    ),
    Rule(
        "J t = K theta_dot",
        "jacobians",
        ROUND_TRIP,
        _BATCH,
        "The velocity equation holds.",
        ("joint_rates", "jacobian_blocks"),
    ),
    Rule("rates and twist", "joint_rates", ROUND_TRIP, _BATCH, "twist undoes joint_rates.", ("twist",)),
    Rule(
        "accelerations",
        "joint_accelerations",
        ROUND_TRIP,
        _BATCH,
        "platform_acceleration undoes joint_accelerations.",
        ("platform_acceleration",),
    ),
    Rule(
        "determinants",
        "singularity",
        ROUND_TRIP,
        _BATCH,
        "det M and the factors of det J are those of the matrices.",
        ("subleg_jacobian", "jacobians"),
    ),
    Rule(
        "margins",
        "singularity",
        EXACT,
        _BATCH,
        "Margins are positive inside the working box of the redundant coordinates.",
        ("end_points",),
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
        _BATCH,
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
        _BATCH,
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

REFERENCES = (
    Rule(
        "robots",
        "jacobians",
        ROUND_TRIP,
        Samples(1, 1),
        "End points, all inverse solutions, M, J, K and det J of the reference configurations.",
        ("end_points", "redundant_coordinates", "subleg_inverse", "subleg_jacobian", "singularity"),
        lambda robot: robot.identifier in WITH_REFERENCE,
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
        lambda robot: robot.platform.name in ("platform_spatial_a", "platform_spatial_c"),
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
