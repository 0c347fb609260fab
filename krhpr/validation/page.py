"""What VALIDATION.md shows of the plan: proofs of parts, statements about robots, checks of each function."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

from krhpr.codegen.robot_code import RobotCode
from krhpr.validation.check import Check, Kind
from krhpr.validation.plan import KINDS, REASONS, plan
from krhpr.validation.rules import EVERY

ONE_BY_ONE = (Kind.PROOF, Kind.DIFFERENCES, Kind.INVARIANT, Kind.REFERENCE)
"""Kinds whose checks make statements of their own; the others make one statement about every function."""


def page(robots: Sequence[RobotCode]) -> dict[str, Any]:
    """The names that the page's template uses."""
    plans = {robot.identifier: plan(robot) for robot in robots}
    return {
        "kinds": list(KINDS.items()),
        "tolerances": [(_closeness(value), reason) for value, reason in REASONS.items()],
        "total": sum(len(checks) for checks in plans.values()),
        "groups": _groups(plans),
        "statements": _statements(plans),
        "robots": [_robot(robot, plans[robot.identifier]) for robot in robots],
    }


def _closeness(value: float) -> str:
    return "exact" if value == 0.0 else f"{value:.0e}".replace("e-0", "e-")


def _samples(check: Check) -> str:
    small, large = check.samples.small, check.samples.large
    return f"{small}" if small == large else f"{small} / {large}"


def _list(names: Iterable[str]) -> str:
    return ", ".join(dict.fromkeys(names))


# -- parts -----------------------------------------------------------------------------------------


@dataclass(frozen=True)
class _Group:
    """Parts of one sort: what is proven of them, and how each part's kernels survive the passes."""

    title: str
    proofs: list[tuple[str, ...]]
    parts: list[tuple[str, ...]]


_TITLES = {"subleg": "Sub-legs", "platform": "Arrangements", "algebra": "Products"}


def _groups(plans: dict[str, list[Check]]) -> list[_Group]:
    """Proofs about parts, each once, and a row for each part."""
    return [_group(key, title, plans) for key, title in _TITLES.items()]


def _group(key: str, title: str, plans: dict[str, list[Check]]) -> _Group:
    checks = [
        check
        for found in plans.values()
        for check in found
        if check.shared and check.function.startswith(f"{key}.")
    ]
    names = list(dict.fromkeys(check.shared for check in checks))
    proofs: dict[str, list[Check]] = {}
    for check in checks:
        if check.kind is Kind.PROOF:
            proofs.setdefault(check.name, []).append(check)
    rows: list[tuple[str, ...]] = []
    for name, found in proofs.items():
        parts = list(dict.fromkeys(check.shared for check in found))
        where = "all" if parts == names else _quoted(parts)
        check = found[0]
        rows.append((name, _kernels(check), check.closeness, _samples(check), where, check.statement))
    return _Group(title, rows, [_part(name, checks) for name in names])


def _part(name: str, checks: Sequence[Check]) -> tuple[str, ...]:
    """A part's robots, and its kernels: those proven exactly and those proven in balls."""
    own = [check for check in checks if check.shared == name]
    passes = {check.function: check for check in own if check.kind is Kind.PASSES}.values()
    exact, balls = (
        _list(_kernels(check) for check in passes if (check.tolerance == 0.0) == wanted) or "–"
        for wanted in (True, False)
    )
    return f"`{name}`", _quoted(check.robot for check in own), exact, balls


def _kernels(check: Check) -> str:
    return _quoted(name.split(".")[-1] for name in (check.function, *check.also))


def _quoted(names: Iterable[str]) -> str:
    return _list(f"`{name}`" for name in names)


# -- statements ------------------------------------------------------------------------------------


@dataclass(frozen=True)
class _Statement:
    check: Check
    targets: str
    robots: str

    @property
    def row(self) -> tuple[str, ...]:
        """Kind, name, targets, tolerance, samples, robots and statement."""
        check = self.check
        return (
            str(check.kind),
            check.name,
            self.targets,
            check.closeness,
            _samples(check),
            self.robots,
            check.statement,
        )


def _statements(plans: dict[str, list[Check]]) -> list[_Statement]:
    """Checks that are not about one part, each once."""
    found: dict[tuple[Kind, str], list[Check]] = {}
    for checks in plans.values():
        for check in checks:
            if check.kind in ONE_BY_ONE and not check.shared:
                found.setdefault((check.kind, check.name), []).append(check)
    order = list(Kind)
    statements = []
    for _, checks in sorted(found.items(), key=lambda entry: order.index(entry[0][0])):
        users = dict.fromkeys(check.robot for check in checks)
        robots = "all" if len(users) == len(plans) else ", ".join(f"`{user}`" for user in users)
        statements.append(_Statement(checks[0], _list(str(check.target) for check in checks), robots))
    return statements


# -- functions -------------------------------------------------------------------------------------


def _robot(robot: RobotCode, checks: Sequence[Check]) -> dict[str, Any]:
    """A row for each function: on which targets its text is proven, and what else it takes part in."""
    everywhere = _list(check.name for check in checks if check.function == EVERY)
    rows = [_row(function.name, checks) for function in robot.functions]
    return {
        "identifier": robot.identifier,
        "notation": robot.notation,
        "count": len(checks),
        "rows": rows,
        "everywhere": everywhere,
    }


def _row(name: str, checks: Sequence[Check]) -> tuple[str, ...]:
    own = [check for check in checks if check.function == name or name in check.also]

    def targets(kind: Kind) -> str:
        return _list(str(check.target) for check in own if check.kind is kind) or "–"

    identity = [check for check in own if check.kind is Kind.IDENTITY]
    closeness = identity[0].closeness if identity else "–"
    others = _list(check.name for check in own if check.kind in ONE_BY_ONE) or "–"
    return name, targets(Kind.IDENTITY), closeness, targets(Kind.AGREEMENT), targets(Kind.DIGITS), others
