"""The plan: complete, unambiguous, and the same for the page, for `krhpr validate` and for these tests."""

from __future__ import annotations

import subprocess
import sys

import pytest

from krhpr.codegen.kernel import LEGS
from krhpr.codegen.report import report_files
from krhpr.derivations.catalogue import catalogue
from krhpr.derivations.sublegs.kernels import SubLegKernels
from krhpr.validation.check import Check, Kind, Target
from krhpr.validation.configurations import LEGS_BY_NAME
from krhpr.validation.page import page
from krhpr.validation.plan import KINDS, REASONS, plan
from krhpr.validation.proofs.first_principles import CLOSURES
from krhpr.validation.proofs.passive import PASSIVE
from krhpr.validation.proofs.places import OTHERS
from krhpr.validation.proofs.singularities import EQUILATERAL
from krhpr.validation.proofs.thesis import ATTACHMENTS, ROWS, VELOCITY
from krhpr.validation.rules import EVERY, FIRST_PRINCIPLES, THESIS_ROWS, THESIS_VELOCITY
from krhpr.validation.run import RUNNERS
from tests.support import catalogued, derived_robots

DERIVED = derived_robots()
CATALOGUED = catalogued()
PLANS = {robot.identifier: plan(robot) for robot in CATALOGUED}
OF_JAWS = [plan(robot) for robot in DERIVED.robots if robot.legs != LEGS]
ROBOTS = pytest.mark.parametrize("robot", CATALOGUED, ids=lambda robot: robot.identifier)

DERIVATIVES = {
    "subleg_jacobian",
    "jacobians",
    "jacobian_blocks",
    "twist",
    "joint_rates",
    "platform_acceleration",
    "joint_accelerations",
}


def checks(identifier: str, kind: Kind, target: Target | None = None) -> list[Check]:
    return [c for c in PLANS[identifier] if c.kind is kind and (target is None or c.target is target)]


def test_every_rule_has_code_and_all_code_is_used() -> None:
    planned = {(check.kind, check.name) for found in (*PLANS.values(), *OF_JAWS) for check in found}
    written = {(kind, name) for kind, runners in RUNNERS.items() for name in runners}
    shared = {Kind.PASSES, Kind.IDENTITY}, {Kind.AGREEMENT, Kind.DIGITS}
    for kinds in shared:  # one module for two kinds
        names = {name for kind, name in planned if kind in kinds}
        written = {entry for entry in written if entry[0] not in kinds or entry[1] not in names}
        written |= {entry for entry in planned if entry[0] in kinds}
    assert planned == written
    assert set(KINDS) == set(Kind) == set(RUNNERS)
    assert {check.tolerance for found in PLANS.values() for check in found} == set(REASONS)


def test_what_is_known_of_parts_is_known_everywhere() -> None:
    parts = {robot.subleg.name for robot in CATALOGUED}
    assert set(FIRST_PRINCIPLES) == set(CLOSURES) == set(LEGS_BY_NAME)
    assert set(THESIS_VELOCITY) == set(VELOCITY)
    assert set(THESIS_ROWS) == set(ROWS) == set(EQUILATERAL) == set(ATTACHMENTS)
    assert set(FIRST_PRINCIPLES) < set(THESIS_VELOCITY) < set(PASSIVE) == parts
    assert set(OTHERS) == {
        entry.robot.subleg.geometry().name
        for entry in catalogue()
        if SubLegKernels(entry.robot.subleg).factors()[2]
    }
    assert set(THESIS_ROWS) == {robot.platform.name for robot in CATALOGUED}


@ROBOTS
def test_every_function_is_checked_on_every_target(robot) -> None:
    for function in robot.functions:
        targets = {Target.C, Target.NUMPY} | (set() if function.procedure else {Target.CASADI})
        # what is found at the roots of a polynomial is held to the proven kernels by invariants
        exact = (Kind.INVARIANT,) if robot.finds_roots(function) else (Kind.IDENTITY, Kind.DIGITS)
        for kind in exact:
            assert {
                c.target for c in checks(robot.identifier, kind) if c.function == function.name
            } == targets
        others = {c.target for c in checks(robot.identifier, Kind.AGREEMENT) if c.function == function.name}
        assert others == targets - {Target.NUMPY}


@ROBOTS
def test_every_kernel_is_checked(robot) -> None:
    kernels = {f"{key}.{kernel.name}" for key, part in robot.parts.items() for kernel in part.kernels}
    assert {check.function for check in checks(robot.identifier, Kind.PASSES)} == kernels
    proven = {
        name
        for check in checks(robot.identifier, Kind.PROOF)
        for name in (check.function, *check.also)
        if "." in name
    }
    unproven = {name for name in kernels - proven if not name.startswith("algebra.")}
    assert not unproven, "kernels without a proof"


@ROBOTS
def test_every_derivative_is_checked_by_differences(robot) -> None:
    names = {function.name for function in robot.functions}
    assert names >= DERIVATIVES
    for target in (Target.C, Target.NUMPY):
        assert {c.function for c in checks(robot.identifier, Kind.DIFFERENCES, target)} == DERIVATIVES


@ROBOTS
def test_checks_name_what_exists(robot) -> None:
    known = {function.name for function in robot.functions} | {"geometry", EVERY}
    known |= {f"{key}.{kernel.name}" for key, part in robot.parts.items() for kernel in part.kernels}
    found = PLANS[robot.identifier]
    for check in found:
        assert {check.function, *check.also} <= known, check.identifier
        assert check.robot == robot.identifier
        assert 0 < check.samples.small <= check.samples.large
        assert check.statement.endswith(".") and "|" not in check.statement
    assert len({check.identifier for check in found}) == len(found)
    assert list(dict.fromkeys(check.kind for check in found)) == [
        kind for kind in Kind if any(check.kind is kind for check in found)
    ]


def test_the_page_shows_every_check_and_does_not_change() -> None:
    files = {file.path: file.text for file in report_files(DERIVED.robots, DERIVED.parts, [])}
    text = files["VALIDATION.md"]
    for found in PLANS.values():
        for check in found:
            assert check.name in text or check.kind in (
                Kind.PASSES,
                Kind.IDENTITY,
                Kind.AGREEMENT,
                Kind.DIGITS,
            )
            if check.kind in (Kind.PROOF, Kind.DIFFERENCES, Kind.INVARIANT, Kind.REFERENCE):
                assert check.statement in text
    for robot in CATALOGUED:
        for function in robot.functions:
            assert f"| `{function.name}` |" in text
    again = {file.path: file.text for file in report_files(DERIVED.robots, DERIVED.parts, [])}
    assert again["VALIDATION.md"] == text
    assert page(CATALOGUED)["total"] == sum(len(found) for found in PLANS.values())


def test_the_plan_needs_nothing_heavy() -> None:
    """The generator imports it."""
    program = (
        "import sys, krhpr.validation.page\n"
        "heavy = {'flint', 'casadi', 'pycparser', 'mpmath', 'sympy'} & set(sys.modules)\n"
        "assert not heavy, heavy"
    )
    subprocess.run([sys.executable, "-c", program], check=True)
