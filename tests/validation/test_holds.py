"""The plan, carried out: every check of every robot, kind by kind (proofs are in tests/derivations)."""

from __future__ import annotations

from functools import cache

import pytest

from krhpr.validation.check import Kind
from krhpr.validation.outcome import State
from tests.support import THOROUGH, cover
from tests.validation.support import IDENTIFIERS, carried_out, failures, planned

COVER = cover(IDENTIFIERS)


EVERYWHERE = (Kind.AGREEMENT, Kind.REFERENCE)
"""Checks of every robot in small samples."""


@cache
def first_robots(kind: Kind, full: bool) -> dict[tuple[str, ...], str]:
    """The robot at which a check that several share is carried out: one of large samples, or of `COVER`."""
    order = list(dict.fromkeys([*(THOROUGH if full else ()), *COVER, *IDENTIFIERS]))
    return {check.once: identifier for identifier in reversed(order) for check in planned(identifier, kind)}


@pytest.mark.parametrize("kind", [kind for kind in Kind if kind is not Kind.PROOF])
@pytest.mark.parametrize("identifier", IDENTIFIERS)
def test_the_plan_holds(identifier: str, kind: Kind, full: bool) -> None:
    """Every kernel and every template is among the functions of `COVER`; what other robots print of them is
    compared with the derivation in doubles, and in every other way with --full, where some robots have large
    samples.  What both runs have in common is left to the first.
    """
    in_small = identifier in COVER or kind in EVERYWHERE
    if full and in_small and identifier not in THOROUGH:
        pytest.skip("the same in small samples")
    if not full and not in_small:
        pytest.skip("small samples: one robot of each sub-leg")
    first = first_robots(kind, full)
    checks = [check for check in planned(identifier, kind) if first[check.once] == identifier]
    results = carried_out(identifier, list(checks), full)
    assert not failures(results)
    left_out = {result.remark for result in results if result.state is State.NOT_RUN}
    if left_out and len(left_out) == 1 and all(result.state is State.NOT_RUN for result in results):
        pytest.skip(left_out.pop())
