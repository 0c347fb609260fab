"""What is checked of a robot, how, on which target and how closely: one list for the page, the tests and `krhpr validate`.

`plan(robot)` makes the checks of a robot from the rules below; `run` carries them out, VALIDATION.md shows them.
A rule names a kind and a name; the module of that kind holds the code under the same name.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from enum import StrEnum
from zlib import crc32

from krhpr.codegen.composition import RobotCode, RobotFunction
from krhpr.codegen.graph import Op
from krhpr.codegen.kernel import Kernel
from krhpr.codegen.passes import Part


class Kind(StrEnum):
    """Ways of checking; the order is that of reports."""

    PROOF = "proof"
    PASSES = "passes"
    IDENTITY = "identity"
    DIFFERENCES = "finite differences"
    AGREEMENT = "agreement"
    DIGITS = "fifty digits"
    INVARIANT = "invariant"
    REFERENCE = "reference"


KINDS = {
    Kind.PROOF: "The derivation itself: closed forms against the constraint equations, differentiated independently.",
    Kind.PASSES: "The optimised kernel against the kernel as derived, at random inputs.",
    Kind.IDENTITY: "The printed text, run on exact numbers, against the derivation, with all lengths and angles random.",
    Kind.DIFFERENCES: "Functions that are derivatives against central differences of the functions that they derive.",
    Kind.AGREEMENT: "The same function on two targets, in doubles, relative to the scale of the output.",
    Kind.DIGITS: "Each target, in doubles, against the derivation to more than fifty digits.",
    Kind.INVARIANT: "What must hold whatever the formulas: closed loops, round trips, virtual work, symmetries.",
    Kind.REFERENCE: "Numbers of the thesis, and values computed from the plain geometry without its equations.",
}


class Target(StrEnum):
    """What is checked."""

    DERIVATION = "derivation"
    C = "C"
    NUMPY = "NumPy"
    CASADI = "CasADi"


PRINTED = (Target.C, Target.NUMPY, Target.CASADI)
NUMERIC = (Target.C, Target.NUMPY)


@dataclass(frozen=True)
class Samples:
    """How many random configurations (of a batch, or of exact numbers) a check takes."""

    small: int
    large: int

    def of(self, size: str) -> int:
        """The number for `small` or `large`."""
        return self.large if size == "large" else self.small


EXACT = 0.0
"""Equality of rational numbers, no tolerance."""
BALL = 1e-60
"""Enclosures of 300 bits equal to this: what has roots or arctangents in it."""

ROUNDING = 1e-13
"""A function in doubles."""
ROUND_TRIP = 1e-11
"""Functions in doubles, one after the other, there and back."""
FIRST = 1e-8
"""First differences."""
SECOND = 1e-6
"""Second differences."""
DECIMALS = 1e-9
"""Numbers with some twelve decimals."""

REASONS = {
    EXACT: "rational numbers: rational operations, and sines and cosines of rational angles, are computed without rounding",
    BALL: "300-bit ball arithmetic, where roots and arctangents occur: enclosures are narrower than 1e-80",
    ROUNDING: "some hundred roundings of 1e-16, relative to the scale of the output, in configurations whose singular "
    "factors are above 0.1",
    ROUND_TRIP: "the same through several functions, amplified by the condition of the matrices that are inverted on the way",
    FIRST: "central differences of fourth order, step 3e-5: rounding is 1e-11 of the scale, truncation grows with the "
    "fourth power of step over distance to a singularity",
    SECOND: "second differences of fourth order, step 3e-4: rounding alone is 1e-8 of the scale",
    DECIMALS: "references are printed with twelve or more digits in millimetres; paths are compared from step to step",
}
"""Why each tolerance is what it is."""


@dataclass(frozen=True)
class Check:
    """One thing that is checked of one robot.

    `function` is the robot's function, or a kernel as `part.kernel`; `also` are others that take part.  `shared` names
    the part that the check is about where it does not depend on the rest of the robot: robots that share the part share
    the result.
    """

    kind: Kind
    robot: str
    function: str
    target: Target
    tolerance: float
    samples: Samples
    statement: str
    name: str
    also: tuple[str, ...] = ()
    shared: str = ""

    @property
    def identifier(self) -> str:
        """A readable name that is unique among the checks of a robot."""
        return f"{self.robot}: {self.kind}, {self.name}, {self.function}, {self.target}"

    @property
    def seed(self) -> int:
        """Where random numbers of this check start; the same on every machine, and for all robots that share it."""
        subject = self.shared or self.robot
        return crc32(f"{subject}/{self.kind}/{self.name}/{self.function}".encode())

    @property
    def compiles(self) -> bool:
        """Whether the check needs a C compiler."""
        return self.target is Target.C and self.kind is not Kind.IDENTITY

    @property
    def closeness(self) -> str:
        """The tolerance in words."""
        return "exact" if self.tolerance == EXACT else f"{self.tolerance:.0e}".replace("e-0", "e-")


def plan(robot: RobotCode) -> list[Check]:
    """Every check of a robot, in the order of reports."""
    checks = [check for rules in _RULES for check in rules(robot)]
    order = {kind: place for place, kind in enumerate(Kind)}
    return sorted(checks, key=lambda check: order[check.kind])


# -- what functions and kernels consist of ----------------------------------------------------------------------------

_ROOTS = frozenset({Op.SQRT, Op.ATAN2})


def has_roots(kernel: Kernel) -> bool:
    """Whether a kernel leaves the rational numbers (sines and cosines of rational angles do not)."""
    needed = kernel.graph.needed(kernel.result_nodes)
    return any(node.op in _ROOTS for index, node in kernel.graph if needed[index])


def needs_balls(robot: RobotCode, function: RobotFunction) -> bool:
    """Whether a function leaves the rational numbers; procedures choose among inverse solutions and do."""
    return not function.calls or any(has_roots(robot.parts[call.part].kernel(call.kernel)) for call in function.calls)


def _closeness(balls: bool) -> float:
    return BALL if balls else EXACT


# -- proofs -----------------------------------------------------------------------------------------------------------

FIRST_PRINCIPLES = ("subleg_rrr", "subleg_r_fivebar", "subleg_planar_rr")
"""Sub-legs whose closure is written a second time from rotations of vectors, and whose thesis matrices are copied."""

THESIS_ROWS = ("platform_spatial_a", "platform_spatial_c", "platform_planar_a")
"""Arrangements whose J is written as the thesis prints it."""

CLOSED_LOOPS = ("subleg_r_fivebar",)
"""Sub-legs with passive joints of their own, whose angles are proven to close the loop."""

_MANY = Samples(4, 40)
_FEW = Samples(2, 12)


@dataclass(frozen=True)
class _Proof:
    name: str
    kernel: str
    tolerance: float
    samples: Samples
    statement: str
    also: tuple[str, ...] = ()
    only: tuple[str, ...] | None = None


_SUBLEG_PROOFS = (
    _Proof(
        "velocity equations", "velocity", EXACT, _MANY,
        "A, B and M = A^-1 B equal the implicit derivative of the loop closure, found by differentiating its graph.",
        ("jacobian",),
    ),
    _Proof(
        "first principles", "jacobian", EXACT, _MANY,
        "The closure equals one written from rotations of vectors, and M equals its implicit derivative by SymPy.",
        only=FIRST_PRINCIPLES,
    ),
    _Proof(
        "thesis matrices", "velocity", EXACT, _MANY,
        "A, B and M equal the thesis' matrices written in the base frame: (1.10) to (1.15) with the erratum of (1.10) and "
        "(A.2); (2.15); the planar RR column by column.",
        ("jacobian",), FIRST_PRINCIPLES,
    ),
    _Proof(
        "products of M", "project", EXACT, _MANY,
        "project = N M, velocity = M theta_dot and rates = M^-1 s_dot.", ("velocity", "rates"),
    ),
    _Proof(
        "determinant of M", "determinant", EXACT, _MANY,
        "The closed form of det M equals the determinant of M; the dimensionless factors multiply up to it, with a "
        "constant of the geometry.",
    ),
    _Proof(
        "accelerations", "bias", EXACT, _MANY,
        "Along a motion, as truncated Taylor series: s_dot = M theta_dot and s_ddot = M theta_ddot + bias for the end point "
        "of `forward`, which satisfies the closure to second order.",
        ("forward", "velocity"),
    ),
    _Proof(
        "forward closes", "forward", EXACT, _MANY,
        "`forward` satisfies the closure in every assembly mode, and its posture is that of `posture`.",
        ("forward_posture", "posture"),
    ),
    _Proof(
        "inverse closes", "inverse", BALL, _MANY,
        "`inverse` satisfies the closure in every working mode, each a different solution; `inverse_all` has them in order.",
        ("inverse_all",),
    ),
    _Proof(
        "reach", "reach", EXACT, _MANY,
        "At random points within and out of reach: `reach` is positive just where the working mode does not exist.",
    ),
    _Proof(
        "passive joints", "passive", EXACT, _MANY,
        "The links, laid end to end with the passive angles, meet in S_i; the last link's frame is a rotation.",
        only=FIRST_PRINCIPLES,
    ),
)

_PLATFORM_PROOFS = (
    _Proof(
        "closure", "end_point", EXACT, _MANY,
        "The end point satisfies the constraint equations, and the redundant coordinate comes back from it.",
        ("residual", "redundant"),
    ),
    _Proof(
        "rows", "rows", EXACT, _MANY,
        "J t - N s_dot equals the derivative of the constraint equations along any twist and s_dot.", ("residual",),
    ),
    _Proof("thesis rows", "rows", EXACT, _MANY, "J equals (1.31), (2.28), (2.7) as printed.", only=THESIS_ROWS),
    _Proof(
        "lines", "line", EXACT, _MANY,
        "Lines and points are the rows of J and S_i in the platform frame.",
    ),
    _Proof(
        "end velocity and acceleration", "end_velocity", EXACT, _MANY,
        "Along a motion, as truncated Taylor series: s_dot and s_ddot equal the derivatives of `end_point`.",
        ("end_acceleration",),
    ),
    _Proof(
        "row bias", "row_bias", EXACT, _MANY,
        "Along a motion: J t_dot = N s_ddot + bias, with s_ddot differentiated from `end_point`.",
    ),
    _Proof("solve", "solve", EXACT, _MANY, "J times the twist of `solve` gives the rates back, for any S_i."),
    _Proof(
        "determinant of J", "type_2", EXACT, _MANY,
        "det J = det J_a det J_n, and both equal their closed forms in the redundant coordinates.",
    ),
    _Proof(
        "equilateral", "type_2", EXACT, _MANY,
        "For legs at 120 deg and equal lengths, in the field of rationals with sqrt(3): -l^3 r f and g, or (sqrt3/2) s1 and "
        "(sqrt3/2) s2.",
        only=THESIS_ROWS,
    ),
    _Proof("joint", "joint", EXACT, _MANY, "The redundant link's frame is a rotation and points from S_i to its joint."),
)

_ROBOT_PROOFS = (
    _Proof(
        "joint motion", "joint_rates", EXACT, _FEW,
        "Along a motion of the platform: joints with these rates and accelerations satisfy the legs' closure to second "
        "order, as truncated Taylor series.",
        ("joint_accelerations",),
    ),
    _Proof(
        "inverse maps", "twist", EXACT, _FEW,
        "twist undoes joint_rates, and platform_acceleration undoes joint_accelerations.",
        ("joint_rates", "platform_acceleration", "joint_accelerations"),
    ),
    _Proof(
        "velocity equation", "jacobians", EXACT, _FEW,
        "J t = K theta_dot for the twist and the rates above, with K from its blocks; N M is K.",
        ("jacobian_blocks", "subleg_jacobian", "twist"),
    ),
    _Proof(
        "det J", "singularity", EXACT, _FEW,
        "det J equals the product of its factors, det M those of the legs.", ("jacobians", "subleg_jacobian"),
    ),
)


def _proofs(robot: RobotCode) -> Iterator[Check]:
    for key, part, proofs in (
        ("subleg", robot.subleg, _SUBLEG_PROOFS),
        ("platform", robot.platform, _PLATFORM_PROOFS),
    ):
        for proof in proofs:
            if proof.only is None or part.name in proof.only:
                yield _proof(robot, proof, f"{key}.{proof.kernel}", tuple(f"{key}.{k}" for k in proof.also), part.name)
    for proof in _ROBOT_PROOFS:
        yield _proof(robot, proof, proof.kernel, proof.also, "")


def _proof(robot: RobotCode, proof: _Proof, function: str, also: tuple[str, ...], shared: str) -> Check:
    return Check(
        Kind.PROOF, robot.identifier, function, Target.DERIVATION, proof.tolerance, proof.samples, proof.statement,
        proof.name, also, shared,
    )


def _passes(robot: RobotCode) -> Iterator[Check]:
    for key, part in robot.parts.items():
        for kernel in part.kernels:
            yield Check(
                Kind.PASSES, robot.identifier, f"{key}.{kernel.name}", Target.DERIVATION, _closeness(has_roots(kernel)),
                _MANY, "The optimised kernel equals the kernel as derived.", "optimised", (), part.name,
            )


# -- printed text -----------------------------------------------------------------------------------------------------


def _identity(robot: RobotCode) -> Iterator[Check]:
    for function in robot.functions:
        balls = needs_balls(robot, function)
        for target in PRINTED:
            if target is Target.CASADI and not function.calls:
                continue  # a procedure
            yield Check(
                Kind.IDENTITY, robot.identifier, function.name, target, _closeness(balls),
                _FEW if balls else Samples(3, 20), _identity_statement(function), "printed text",
            )
    for target in PRINTED:
        yield Check(
            Kind.IDENTITY, robot.identifier, "geometry", target, EXACT, Samples(1, 1),
            "The default sizes are those of the catalogue.", "default sizes",
        )


def _identity_statement(function: RobotFunction) -> str:
    text = "The printed text equals the derivation"
    names = {port.name for port in function.inputs}
    if "mode" in names:
        text += ", in every working mode"
    if "assembly" in names:
        text += ", in every assembly mode"
    if not function.calls:
        text += ": the nearest of all modes, with full turns added"
    return text + "."


def _agreement(robot: RobotCode) -> Iterator[Check]:
    for function in robot.functions:
        for target in (Target.C, Target.CASADI):
            if target is Target.C or function.calls:
                yield Check(
                    Kind.AGREEMENT, robot.identifier, function.name, target, ROUNDING, Samples(60, 2000),
                    f"{target} and NumPy agree; where they do not, a ball evaluation says which one is off.", "against NumPy",
                )


def _digits(robot: RobotCode) -> Iterator[Check]:
    for function in robot.functions:
        for target in PRINTED:
            if target is not Target.CASADI or function.calls:
                yield Check(
                    Kind.DIGITS, robot.identifier, function.name, target, ROUNDING, Samples(4, 60),
                    "The result in doubles against the derivation in 300-bit balls.", "error of doubles",
                )


# -- generated functions, numerically ----------------------------------------------------------------------------------


@dataclass(frozen=True)
class _Rule:
    name: str
    function: str
    tolerance: float
    samples: Samples
    statement: str
    also: tuple[str, ...] = ()
    applies: Callable[[RobotCode], bool] = lambda robot: True
    targets: Sequence[Target] = NUMERIC


_BATCH = Samples(40, 2000)

_DIFFERENCES = (
    _Rule(
        "M of forward", "subleg_jacobian", FIRST, _BATCH,
        "M equals the difference quotients of subleg_forward.", ("subleg_forward",),
    ),
    _Rule(
        "M of inverse", "subleg_jacobian", FIRST, _BATCH,
        "M times the difference quotients of subleg_inverse is the identity, in every working mode.", ("subleg_inverse",),
    ),
    _Rule("J", "jacobians", FIRST, _BATCH, "J equals the difference quotients of constraints over the pose.", ("constraints",)),
    _Rule(
        "K", "jacobians", FIRST, _BATCH,
        "K equals those of constraints over the joints, through subleg_forward.", ("constraints", "subleg_forward"),
    ),
    _Rule(
        "J and blocks", "jacobian_blocks", FIRST, _BATCH,
        "J and the blocks of K equal difference quotients of constraints.", ("constraints", "subleg_forward"),
    ),
    _Rule(
        "rates", "joint_rates", FIRST, _BATCH,
        "joint_rates equals difference quotients of inverse along a motion.", ("inverse", "end_points"),
    ),
    _Rule(
        "twist", "twist", FIRST, _BATCH,
        "twist of the difference quotients of inverse is the twist of the motion.", ("inverse",),
    ),
    _Rule(
        "accelerations", "joint_accelerations", FIRST, _BATCH,
        "joint_accelerations equals difference quotients of joint_rates along a motion.", ("joint_rates",),
    ),
    _Rule(
        "second differences", "joint_accelerations", SECOND, _BATCH,
        "joint_accelerations equals second differences of inverse along a motion.", ("inverse",),
    ),
    _Rule(
        "platform acceleration", "platform_acceleration", FIRST, _BATCH,
        "platform_acceleration of the difference quotients of joint_rates is that of the motion.", ("joint_rates",),
    ),
)


def _numeric(kind: Kind, rules: Iterable[_Rule]) -> Callable[[RobotCode], Iterator[Check]]:
    def checks(robot: RobotCode) -> Iterator[Check]:
        for rule in rules:
            if rule.applies(robot):
                for target in rule.targets:
                    yield Check(
                        kind, robot.identifier, rule.function, target, rule.tolerance, rule.samples, rule.statement,
                        rule.name, rule.also,
                    )

    return checks


def factors_are_signs(robot: RobotCode) -> bool:
    """Whether the signs of a working mode are those of the leg's first factors."""
    return robot.subleg.name in FIRST_PRINCIPLES


_INVARIANTS = (
    _Rule(
        "loop closure", "constraints", ROUND_TRIP, _BATCH,
        "End points satisfy the constraint equations.", ("end_points",),
    ),
    _Rule(
        "redundant coordinates", "redundant_coordinates", ROUND_TRIP, _BATCH,
        "Redundant coordinates come back from the end points.", ("end_points",),
    ),
    _Rule(
        "forward after inverse", "subleg_inverse", ROUND_TRIP, _BATCH,
        "Every working mode leads back to the end point, in an assembly mode of its own.", ("subleg_forward",),
    ),
    _Rule(
        "inverse after forward", "subleg_forward", ROUND_TRIP, _BATCH,
        "In every assembly mode the joints are found again among the working modes.", ("subleg_inverse",),
    ),
    _Rule(
        "modes", "inverse_all", ROUND_TRIP, _BATCH,
        "inverse, inverse_all and subleg_inverse give the same joints in the same order of modes.",
        ("inverse", "subleg_inverse"),
    ),
    _Rule(
        "signs of modes", "inverse", EXACT, _BATCH,
        "The signs of the working mode are those of the leg's factors.", ("singularity",), factors_are_signs,
    ),
    _Rule(
        "defaults", "inverse", ROUND_TRIP, _BATCH,
        "Without a mode the default working mode is used, and without an assembly mode its end point comes back.",
        ("subleg_forward",),
    ),
    _Rule(
        "virtual work", "twist", ROUND_TRIP, _BATCH,
        "The power of any wrench equals that of the torques (J^-1 K)^T F that balance it.", ("jacobians",),
    ),
    _Rule("J t = K theta_dot", "jacobians", ROUND_TRIP, _BATCH, "The velocity equation holds.", ("joint_rates", "jacobian_blocks")),
    _Rule("rates and twist", "joint_rates", ROUND_TRIP, _BATCH, "twist undoes joint_rates.", ("twist",)),
    _Rule(
        "accelerations", "joint_accelerations", ROUND_TRIP, _BATCH,
        "platform_acceleration undoes joint_accelerations.", ("platform_acceleration",),
    ),
    _Rule(
        "determinants", "singularity", ROUND_TRIP, _BATCH,
        "det M and the factors of det J are those of the matrices.", ("subleg_jacobian", "jacobians"),
    ),
    _Rule(
        "margins", "singularity", EXACT, _BATCH,
        "Margins are positive inside the working box of the redundant coordinates.", ("end_points",),
    ),
    _Rule(
        "status of inverse", "inverse_status", EXACT, _BATCH,
        "The excess is positive, and the status names the first leg, just where inverse has no answer.", ("inverse",),
    ),
    _Rule(
        "nearest mode", "inverse_near", DECIMALS, Samples(3, 12),
        "Along closed paths across +-pi inverse_near goes on without a jump, stays a solution and returns.", ("inverse",),
    ),
    _Rule(
        "passive joints", "passive_joints", ROUND_TRIP, _BATCH,
        "Links laid end to end with the actuated and passive angles lead to the platform's joint.", (), factors_are_signs,
    ),
    _Rule(
        "turned base", "all", ROUND_TRIP, Samples(10, 300),
        "Turning the base about z turns vectors in the base frame and leaves joints and scalars alone.",
    ),
    _Rule(
        "legs exchanged", "all", ROUND_TRIP, Samples(10, 300),
        "Exchanging unequal legs exchanges their results, leaves the platform's and gives det J the sign of the permutation.",
    ),
    _Rule(
        "lengths scaled", "all", EXACT, Samples(10, 300),
        "With all lengths doubled each result is multiplied by the power of two of its unit, to the last bit.",
    ),
)

REFERENCE_FILE = "spatial"

_REFERENCES = (
    _Rule(
        "robots", "jacobians", DECIMALS, Samples(1, 1),
        "End points, all inverse solutions, M, J, K and det J of the reference configuration.",
        ("end_points", "subleg_inverse", "subleg_jacobian", "singularity"),
    ),
    _Rule(
        "chapter 1", "inverse_near", DECIMALS, Samples(1, 1),
        "Section 1.8: joint ranges along 721 poses (at most 59.96 deg), condition numbers of M and norms of J^-1 K.",
        ("jacobians", "subleg_jacobian"), lambda robot: robot.identifier == "spatial_r_fivebar_a",
    ),
    _Rule(
        "chapter 4", "jacobians", DECIMALS, Samples(1, 1),
        "Chapter 4: end points, M, J, K and the indices eta at sixteen configurations.",
        ("end_points", "inverse", "subleg_jacobian"), lambda robot: robot.identifier == "spatial_rrr_a",
    ),
)

_RULES: tuple[Callable[[RobotCode], Iterator[Check]], ...] = (
    _proofs,
    _passes,
    _identity,
    _numeric(Kind.DIFFERENCES, _DIFFERENCES),
    _agreement,
    _digits,
    _numeric(Kind.INVARIANT, _INVARIANTS),
    _numeric(Kind.REFERENCE, _REFERENCES),
)


def parts_of(robots: Iterable[RobotCode]) -> list[Part]:
    """The parts of all robots, each once, in the order of the robots."""
    found: dict[str, Part] = {}
    for robot in robots:
        for part in robot.parts.values():
            found.setdefault(part.name, part)
    return list(found.values())
