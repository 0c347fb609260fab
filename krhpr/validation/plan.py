"""What is checked of a robot, how, on which target and how closely: one list for the page, the tests and
`krhpr validate`.

`plan(robot)` makes the checks of a robot from the rules below; `run` carries them out, VALIDATION.md
shows them. A rule names a kind and a name; the module of that kind holds the code under the same name.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator

from krhpr.codegen.composition import RobotFunction
from krhpr.codegen.graph import Op
from krhpr.codegen.kernel import LEGS, Kernel
from krhpr.codegen.part import Part
from krhpr.codegen.robot_code import RobotCode
from krhpr.codegen.status import Status
from krhpr.validation.check import (
    BALL,
    EXACT,
    FIRST,
    ROOTS,
    ROUND_TRIP,
    ROUNDING,
    SECOND,
    Check,
    Kind,
    Samples,
    Target,
)
from krhpr.validation.rules import (
    DIFFERENCES,
    EVERY,
    FEW,
    INVARIANTS,
    INVARIANTS_OF_JAWS,
    MANY,
    PLATFORM_PROOFS,
    REFERENCES,
    ROBOT_PROOFS,
    SUBLEG_PROOFS,
    Proof,
    Rule,
)

KINDS = {
    Kind.PROOF: "The derivation: closed forms against constraint equations, differentiated independently.",
    Kind.PASSES: "The optimised kernel against the kernel as derived, at random inputs.",
    Kind.IDENTITY: "The printed text, run on exact numbers with random sizes, against the derivation.",
    Kind.DIFFERENCES: "Functions that are derivatives against central differences of what they derive.",
    Kind.AGREEMENT: "The same function on two targets, in doubles, relative to the scale of the output.",
    Kind.DIGITS: "Each target, in doubles, against the derivation to more than fifty digits.",
    Kind.INVARIANT: "What must hold whatever the formulas are: loops, round trips, virtual work, symmetries.",
    Kind.REFERENCE: "Numbers of the thesis, and values computed from the plain geometry alone.",
}

REASONS = {
    EXACT: "rational numbers: rational operations, and sines and cosines of rational angles, are not rounded",
    BALL: "300-bit ball arithmetic, where roots and arctangents occur: enclosures are narrower than 1e-80",
    ROOTS: "roundings of 1e-16 over the distance between two roots of a polynomial, which is a millionth "
    "where they are not yet in doubt",
    ROUNDING: "some hundred roundings of 1e-16, relative to the scale of the output, in configurations whose "
    "singular factors are above 0.1",
    ROUND_TRIP: "the same through several functions, times the condition of matrices inverted on the way; "
    "references have fifteen digits",
    FIRST: "central differences of sixth order, step 5e-6: rounding is 1e-10 of the scale, and truncation "
    "grows with the sixth power of step over distance to a singularity",
    SECOND: "second differences of sixth order, step 1e-4: rounding alone is 2e-7 of the scale",
}
"""Why each tolerance is what it is."""

PRINTED = (Target.C, Target.NUMPY, Target.CASADI)


def plan(robot: RobotCode) -> list[Check]:
    """Every check of a robot, in the order of reports."""
    chosen = _RULES if robot.legs == LEGS else _RULES_OF_JAWS
    checks = [check for rules in chosen for check in rules(robot)]
    order = {kind: place for place, kind in enumerate(Kind)}
    return sorted(checks, key=lambda check: order[check.kind])


# -- what functions and kernels consist of ---------------------------------------------------------

_ROOTS = frozenset({Op.SQRT, Op.ATAN2})


def has_roots(kernel: Kernel) -> bool:
    """Whether a kernel leaves the rational numbers: sines and cosines of rational angles do not; angles that
    a Newton step moves by a number do.
    """
    if any(port.name == "theta_next" for port in kernel.outputs):
        return True
    return any(node.op in _ROOTS for _, node in kernel.steps)


def needs_balls(robot: RobotCode, function: RobotFunction) -> bool:
    """Whether a function leaves the rational numbers, or has an answer within reach only; procedures choose
    among inverse solutions and do.
    """
    bounded = not robot.always_reachable and any(
        guard.status is Status.UNREACHABLE_LEG_1 for guard in function.guards
    )
    return (
        function.procedure
        or bounded
        or any(has_roots(robot.parts[call.part].kernel(call.kernel)) for call in function.calls)
    )


WITH_GAPS = ("forward_all", "pivots")
"""All solutions of a grasping robot, the function and its kernel: some are not there at most places, and
numbers without rounding do not know not-a-number.  Its text is proven with jaws so long that all are there
(tests/grasping)."""


def has_gaps(robot: RobotCode, name: str) -> bool:
    """Whether some of the solutions that a function or a kernel gives are not there."""
    return robot.legs != LEGS and name in WITH_GAPS


def _closeness(balls: bool) -> float:
    return BALL if balls else EXACT


# -- the derivation ---------------------------------------------------------------------------


def _proofs(robot: RobotCode) -> Iterator[Check]:
    for key, part, proofs in (
        ("subleg", robot.subleg, SUBLEG_PROOFS),
        ("platform", robot.platform, PLATFORM_PROOFS),
    ):
        for proof in proofs:
            known = {kernel.name for kernel in part.kernels}
            if (proof.only is None or part.name in proof.only) and proof.kernel in known:
                also = tuple(f"{key}.{name}" for name in proof.also if name in known)
                yield _proof(robot, proof, f"{key}.{proof.kernel}", also, part.name)
    functions = {function.name for function in robot.functions}
    kernels = {f"{key}.{kernel.name}" for key, part in robot.parts.items() for kernel in part.kernels}
    for proof in ROBOT_PROOFS:
        if proof.kernel not in functions or (proof.needs and proof.needs not in kernels):
            continue
        # of the kernels named, those that the arrangement has
        also = tuple(name for name in proof.also if "." not in name or name in kernels)
        yield _proof(robot, proof, proof.kernel, also, "")


def _proof(robot: RobotCode, proof: Proof, function: str, also: tuple[str, ...], shared: str) -> Check:
    return Check(
        Kind.PROOF,
        robot.identifier,
        function,
        Target.DERIVATION,
        proof.tolerance,
        proof.samples,
        proof.statement,
        proof.name,
        also,
        shared,
    )


def _kernels(robot: RobotCode) -> Iterator[tuple[str, Part, Kernel]]:
    """The kernels of the parts that its functions call, and these by key; grasping robots have no use for the
    products of three legs.
    """
    called = {call.part for function in robot.functions for call in function.calls}
    for key, part in robot.parts.items():
        if key in called:
            yield from ((key, part, kernel) for kernel in part.kernels if not has_gaps(robot, kernel.name))


def _passes(robot: RobotCode) -> Iterator[Check]:
    for key, part, kernel in _kernels(robot):
        yield Check(
            Kind.PASSES,
            robot.identifier,
            f"{key}.{kernel.name}",
            Target.DERIVATION,
            _closeness(has_roots(kernel)),
            MANY,
            "The optimised kernel equals the kernel as derived.",
            "optimised",
            (),
            part.name,
        )


# -- printed text ----------------------------------------------------------------------------------


def _identity(robot: RobotCode) -> Iterator[Check]:
    for function in robot.functions:
        if robot.finds_roots(function) or has_gaps(robot, function.name):
            continue  # its kernels' texts are checked one by one, and what it finds against what is known
        balls = needs_balls(robot, function)
        for target in PRINTED:
            if target is Target.CASADI and function.procedure:
                continue  # a procedure
            yield Check(
                Kind.IDENTITY,
                robot.identifier,
                function.name,
                target,
                _closeness(balls),
                Samples(1, 12) if balls else Samples(1, 20),
                _identity_statement(function),
                "printed text",
                same_text=_only_platform(robot, function),
            )
    for key, part, kernel in _kernels(robot):
        for target in PRINTED:
            yield Check(
                Kind.IDENTITY,
                robot.identifier,
                f"{key}.{kernel.name}",
                target,
                _closeness(has_roots(kernel)),
                FEW,
                "The printed kernel equals the derivation, the values that functions guard included.",
                "kernel text",
                (),
                part.name,
            )
    for target in PRINTED:
        yield Check(
            Kind.IDENTITY,
            robot.identifier,
            "geometry",
            target,
            EXACT,
            Samples(1, 1),
            "The default sizes are those of the catalogue.",
            "default sizes",
        )


def _only_platform(robot: RobotCode, function: RobotFunction) -> str:
    """The platform's part, where a function calls no kernel of the sub-leg."""
    parts = {call.part for call in function.calls}
    return robot.platform.name if parts and "subleg" not in parts else ""


def _identity_statement(function: RobotFunction) -> str:
    text = "The printed text equals the derivation"
    names = {port.name for port in function.inputs}
    if "mode" in names:
        text += ", in every working mode"
    if "assembly" in names:
        text += ", in every assembly mode"
    if function.chooses:
        text += ": the nearest of all modes, with full turns added"
    return text + "."


def _agreement(robot: RobotCode) -> Iterator[Check]:
    for function in robot.functions:
        for target in (Target.C, Target.CASADI):
            if target is Target.C or not function.procedure:
                yield Check(
                    Kind.AGREEMENT,
                    robot.identifier,
                    function.name,
                    target,
                    ROOTS if robot.finds_roots(function) else ROUNDING,
                    Samples(60, 2000),
                    f"{target} and NumPy agree; where they do not, a ball evaluation says which one is off.",
                    "against NumPy",
                    same_text=_only_platform(robot, function),
                )


def _digits(robot: RobotCode) -> Iterator[Check]:
    for function in robot.functions:
        if robot.finds_roots(function) or has_gaps(robot, function.name):
            continue
        for target in PRINTED:
            if target is not Target.CASADI or not function.procedure:
                yield Check(
                    Kind.DIGITS,
                    robot.identifier,
                    function.name,
                    target,
                    ROUNDING,
                    Samples(4, 60),
                    "The result in doubles against the derivation in 300-bit balls.",
                    "error of doubles",
                    same_text=_only_platform(robot, function),
                )


# -- generated functions, numerically --------------------------------------------------------------


def _numeric(kind: Kind, rules: Iterable[Rule]) -> Callable[[RobotCode], Iterator[Check]]:
    def checks(robot: RobotCode) -> Iterator[Check]:
        present = {function.name for function in robot.functions} | {EVERY}
        for rule in rules:
            if rule.applies(robot) and {rule.function, *rule.also} <= present:
                for target in rule.targets:
                    yield Check(
                        kind,
                        robot.identifier,
                        rule.function,
                        target,
                        rule.tolerance,
                        rule.samples,
                        rule.statement,
                        rule.name,
                        rule.also,
                    )

    return checks


_RULES: tuple[Callable[[RobotCode], Iterator[Check]], ...] = (
    _proofs,
    _passes,
    _identity,
    _numeric(Kind.DIFFERENCES, DIFFERENCES),
    _agreement,
    _digits,
    _numeric(Kind.INVARIANT, INVARIANTS),
    _numeric(Kind.REFERENCE, REFERENCES),
)

_RULES_OF_JAWS: tuple[Callable[[RobotCode], Iterator[Check]], ...] = (
    _passes,
    _identity,
    _agreement,
    _digits,
    _numeric(Kind.INVARIANT, INVARIANTS_OF_JAWS),
)
"""For the grasping robots, whose proofs are tests (tests/grasping)."""
