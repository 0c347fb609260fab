"""Rules for proofs: what is shown of parts and robots by the derivation alone."""

from __future__ import annotations

from dataclasses import dataclass

from krhpr.validation.check import BALL, EXACT, Samples
from krhpr.validation.rules.known import FIRST_PRINCIPLES, THESIS_ROWS, THESIS_VELOCITY

MANY = Samples(2, 40)
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
    needs: str = ""
    """A kernel without which there is nothing to prove of a robot."""


SUBLEG_PROOFS = (
    Proof(
        "velocity equations",
        "velocity",
        EXACT,
        MANY,
        "A, B and M = A^-1 B equal the implicit derivative of the loop closure, found by differentiating"
        " its graph.",
        ("jacobian", "posture"),
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
        "erratum of (1.10) and (A.2); (2.15), for PRR with the slide's column; (2.32); (2.48), (2.49); "
        "(2.55); the planar RR column by column. Where a rod ends on a coupler the last rows of A and B are "
        "the printed ones over k, less k times the rows before.",
        ("jacobian",),
        THESIS_VELOCITY,
    ),
    Proof(
        "products of M",
        "project",
        EXACT,
        MANY,
        "project = N M, velocity = M theta_dot and rates = M^-1 s_dot; their guards are the factors of "
        "det M.",
        ("velocity", "rates", "transmission", "end_force", "gram", "bias"),
    ),
    Proof(
        "determinant of M",
        "determinant",
        EXACT,
        MANY,
        "The closed form of det M equals the determinant of M; the dimensionless factors multiply up to "
        "it, with a constant of the geometry; other factors equal formulas written from the description "
        "alone.",
    ),
    Proof(
        "squares of M",
        "gram",
        EXACT,
        MANY,
        "M M^T has the characteristic polynomial of M turned anyhow, slides over the length; its inverse and "
        "(N M)(N M)^T are exact.",
        ("jacobian",),
    ),
    Proof(
        "accelerations",
        "bias",
        EXACT,
        MANY,
        "Along a motion, as truncated Taylor series: s_dot = M theta_dot and s_ddot = M theta_ddot + "
        "bias for the end point "
        "of `forward`, which satisfies the closure to second order; so for the rate of a swivel.",
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
        "every assembly mode",
        "forward_all",
        EXACT,
        MANY,
        "`forward_all` has what `forward` gives in each assembly mode; each satisfies the closure, and one "
        "is the end point.",
    ),
    Proof(
        "octic",
        "octic",
        EXACT,
        MANY,
        "The octic is Sylvester's determinant of the closure of two chains along a line of the first one's "
        "cylinder, at any T; the end point is one of its roots, and the kernel gives it back there.",
        ("at_root",),
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
    ),
    Proof(
        "links",
        "points",
        EXACT,
        MANY,
        "Every link is as long as the geometry or the joint that it is named after; joints on the base are "
        "where the description says, and the last point is S_i.",
    ),
    Proof(
        "swivel",
        "swivel",
        EXACT,
        MANY,
        "The swivel's row of the velocity equations is the gradient of the swivel, the end point "
        "moving along.",
        ("swivel_difference",),
    ),
    Proof(
        "Newton step",
        "forward_step",
        EXACT,
        MANY,
        "A Newton step leaves a solution where it is, and errors are squared by it; beside it `change` is "
        "what it says.",
    ),
    Proof(
        "Newton step",
        "inverse_step",
        EXACT,
        MANY,
        "A Newton step leaves a solution where it is, and errors are squared by it; beside it `change` is "
        "what it says.",
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
        "line of the redundant coordinate",
        "line_of_redundant",
        EXACT,
        MANY,
        "Line, end point and scale are those of `line` at the end point of any pose.",
        ("line", "end_point"),
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
        "J times the twist of `solve` gives the rates back, for any S_i and any lines; its guards are "
        "det J_a and det J_n, made dimensionless.",
    ),
    Proof(
        "balance",
        "balance",
        EXACT,
        MANY,
        "J^T times the forces along the lines, and the forces along any redundant lines, add up to the "
        "wrench, for any S_i and any lines; the line of a redundant force goes through S_i; the guards are "
        "those of `solve`.",
        ("rows", "redundant_line"),
    ),
    Proof(
        "sensitivity",
        "sensitivity",
        EXACT,
        MANY,
        "The squares are those of both parts of J^-1 K in the platform frame, for any S_i; the guards are "
        "those of `solve`.",
        ("rows", "solve"),
    ),
    Proof(
        "determinant of J",
        "type_2",
        EXACT,
        MANY,
        "det J = det J_a det J_n, and both equal their closed forms in the redundant coordinates.",
    ),
    Proof(
        "degree",
        "type_2",
        EXACT,
        MANY,
        "As functions of one redundant angle det J_a is a cos + b sin and det J_n a constant more; as "
        "functions of one slide both are affine. This is what certificates rest on.",
        ("line_of_redundant",),
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
        "The redundant link's frame is a rotation and points from S_i to its joint or slider on the "
        "platform.",
        ("attachment",),
    ),
)

ROBOT_PROOFS = (
    Proof(
        "sextic",
        "forward_all",
        BALL,
        FEW,
        "The sextic is what eliminating the links' vectors leaves, at any T; the pose that the end points "
        "come from is one of its roots, and the kernel gives it back there; elsewhere `miss` is what it "
        "says.",
        ("platform.tie", "platform.sextic", "platform.assembly"),
        needs="platform.sextic",
    ),
    Proof(
        "the mode on one side",
        "forward",
        BALL,
        FEW,
        "The solution on a side of type II is that one of all whose first margin has the sign of the side.",
        ("forward_all", "platform.assembly_mode"),
        needs="platform.assembly_mode",
    ),
    Proof(
        "Newton steps of the platform",
        "forward_newton",
        BALL,
        FEW,
        "From the pose itself the steps do not move; from beside it one step squares the distance; where "
        "they end is the pose; `change` and `misfit` are what they say.",
        ("platform.tie", "platform.newton_start", "platform.newton_step", "platform.newton_pose"),
        needs="platform.newton_step",
    ),
    Proof(
        "Newton and Kantorovich",
        "forward_newton",
        BALL,
        FEW,
        "The certificate of convergence is 2 b K n by its definition, the slope inverted by elimination.",
        ("platform.newton_start",),
        needs="platform.newton_start",
    ),
    Proof(
        "orthonormalised",
        "forward_encoders_3",
        BALL,
        FEW,
        "From any state the orientation is given as it is, and made a rotation by (3.34) to (3.36).",
        ("platform.encoder_pose",),
    ),
    Proof(
        "one encoder that is wrong",
        "forward_encoders_1",
        BALL,
        FEW,
        "Both poses have S_1 where the encoder says and the second link as long as it is; the third is "
        "longer by the mismatch, which is smaller in the first and is compared with the tolerance.",
        ("platform.one_encoder", "platform.turns_1"),
    ),
    Proof(
        "encoders that are wrong",
        "forward_encoders_3",
        BALL,
        FEW,
        "Mismatches, and what is compared with the tolerances of agreement and of singularities, by their "
        "definitions from the end points in the base frame and where encoders have them in the platform.",
        ("platform.two_encoders", "platform.three_encoders"),
    ),
    Proof(
        "least squares",
        "forward_gauss_newton_3",
        BALL,
        FEW,
        "A Gauss-Newton step from anywhere solves the normal equations of the residuals by their definition.",
        ("platform.gauss_newton_2", "platform.gauss_newton_3"),
    ),
    Proof(
        "encoders",
        "forward_encoders_3",
        BALL,
        FEW,
        "With the redundant coordinates themselves measured, every approach gives the pose, the orientation "
        "as it is, and no mismatch.",
        tuple(
            f"platform.{kernel}"
            for kernel in (
                "arm",
                "turns_1",
                "turns_2",
                "turns_3",
                "one_encoder",
                "two_encoders",
                "three_encoders",
                "gauss_newton_2",
                "gauss_newton_3",
                "encoder_pose",
            )
        ),
    ),
    Proof(
        "unique in the box",
        "forward",
        BALL,
        FEW,
        "The squared distances of the end points, as functions of the redundant angles, have a Jacobian with "
        "the determinant -8 det J whose principal minors are products of its diagonal, for any sizes; the "
        "diagonal is positive where the certificate holds, and each of its conditions is looked at.",
        ("end_points", "type_2_of_redundant", "platform.uniqueness"),
        needs="platform.uniqueness",
    ),
    Proof(
        "assembly modes close",
        "forward_all",
        BALL,
        FEW,
        "Both solutions satisfy the constraint equations, their det J is that of their redundant "
        "coordinates, and one of them is the pose that the end points come from.",
        (
            "constraints",
            "redundant_coordinates",
            "type_2_of_redundant",
            "platform.tie",
            "platform.assembly_modes",
        ),
        needs="platform.assembly_modes",
    ),
    Proof(
        "distances of links",
        "clearances",
        BALL,
        FEW,
        "The distance between two links is the least of those of their ends from one another, of an end from "
        "its foot on the other link, and along their common normal where that meets both.",
        ("link_points", "algebra.segment_distance"),
    ),
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
        "non-redundant view",
        "jacobians_n",
        EXACT,
        FEW,
        "J_n [t, redundant rates, swivel rates] = K_n theta_dot, one velocity after the other; lines are "
        "those of J and K; f = (J_n^-1 K_n)^T F_n.",
        ("joint_rates", "jacobians", "inverse_statics", "subleg.non_redundant"),
    ),
    Proof(
        "virtual work",
        "inverse_statics",
        EXACT,
        FEW,
        "One velocity after the other, of the platform, of the redundant coordinates and of swivels: the "
        "actuators' power is that of the force that does work on it.",
        (
            "joint_rates",
            "platform.redundant_line",
            "platform.balance",
            "subleg.transmission",
            "subleg.torques",
        ),
    ),
    Proof(
        "transposed blocks",
        "inverse_statics",
        EXACT,
        FEW,
        "f = K_n^T [lambda, phi] for any three blocks.",
        ("subleg.torques",),
    ),
    Proof(
        "(J^-1 K)^T",
        "inverse_statics",
        EXACT,
        FEW,
        "Where the wrench alone acts: f = K^T J^-T F, (5.12), J inverted by elimination.",
        ("jacobians",),
    ),
    Proof(
        "statics there and back",
        "forward_statics",
        EXACT,
        FEW,
        "forward_statics undoes inverse_statics, and the other way round.",
        ("inverse_statics", "platform.reaction", "subleg.end_force"),
    ),
    Proof(
        "opening",
        "opening",
        EXACT,
        FEW,
        "The circle touches the faces of the jaws, which are where S_i and the slide's direction say; the "
        "shares add up to one and balance; the redundant coordinates come back.",
        ("redundant_of_opening", "platform.opening", "platform.redundant_of_opening"),
    ),
    Proof(
        "grasp",
        "grasp",
        EXACT,
        FEW,
        "The object is in equilibrium under what the jaws apply, written with jaw frames from where S_i "
        "moves; the determinants are that of its six (three) equations; along any motion of platform and "
        "jaws the power at the contacts is that of the wrench and of the redundant forces.",
        ("platform.grasp",),
        needs="platform.grasp",
    ),
    Proof(
        "det J",
        "singularity",
        EXACT,
        FEW,
        "det J equals the product of its factors, det M those of the legs.",
        ("jacobians", "subleg_jacobian"),
    ),
    Proof(
        "indices",
        "indices",
        BALL,
        FEW,
        "Squared, each index is an eigenvalue of U_p U_p^T, U_r U_r^T, M_i M_i^T or its inverse, and none is "
        "larger; eta_3 is the largest ratio among the legs.",
    ),
    Proof(
        "type II of the redundant coordinates",
        "type_2_of_redundant",
        EXACT,
        FEW,
        "Factors and margins are those that `singularity` gives at any pose.",
        ("singularity",),
    ),
)
