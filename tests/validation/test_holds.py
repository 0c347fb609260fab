"""The plan, carried out: every check of every robot, kind by kind (proofs are in tests/derivations)."""

from __future__ import annotations

from functools import cache

import pytest

from krhpr.validation.check import Kind
from krhpr.validation.outcome import State
from tests.validation.support import IDENTIFIERS, carried_out, failures, planned


@cache
def first_robots(kind: Kind) -> dict[tuple[str, ...], str]:
    """The robot at which a check that several share is carried out."""
    return {
        check.once: identifier for identifier in reversed(IDENTIFIERS) for check in planned(identifier, kind)
    }


@pytest.mark.parametrize("kind", [kind for kind in Kind if kind is not Kind.PROOF])
@pytest.mark.parametrize("identifier", IDENTIFIERS)
def test_the_plan_holds(identifier: str, kind: Kind, full: bool) -> None:
    first = first_robots(kind)
    checks = [check for check in planned(identifier, kind) if first[check.once] == identifier]
    results = carried_out(identifier, list(checks), full)
    assert not failures(results)
    left_out = {result.remark for result in results if result.state is State.NOT_RUN}
    if left_out and len(left_out) == 1 and all(result.state is State.NOT_RUN for result in results):
        pytest.skip(left_out.pop())
