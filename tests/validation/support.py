"""Subjects of the catalogue, each made once for a test process, and results shared among robots."""

from __future__ import annotations

from functools import cache

from krhpr.derivations.catalogue import catalogue
from krhpr.validation.check import Check, Kind
from krhpr.validation.outcome import State
from krhpr.validation.plan import plan
from krhpr.validation.run import Result, carry_out
from krhpr.validation.subject import Subject
from tests.support import derived_robots, large

ENTRIES = {entry.identifier: entry for entry in catalogue()}
IDENTIFIERS = list(ENTRIES)


@cache
def subject(identifier: str) -> Subject:
    return Subject(ENTRIES[identifier], parts=derived_robots().parts)


@cache
def planned(identifier: str, kind: Kind) -> tuple[Check, ...]:
    return tuple(check for check in plan(subject(identifier).code) if check.kind is kind)


def failures(results: list[Result]) -> list[str]:
    return [str(result) for result in results if result.state is State.FAILED]


def carried_out(identifier: str, checks: list[Check], full: bool) -> list[Result]:
    size = "large" if large(identifier, full) else "small"
    return [carry_out(subject(identifier), check, size) for check in checks]
