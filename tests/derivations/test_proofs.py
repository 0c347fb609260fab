"""What the derivation says is derived: proofs of every sub-leg, every arrangement, every robot."""

from __future__ import annotations

import pytest

from krhpr.validation.check import Check, Kind
from tests.support import THOROUGH
from tests.validation.support import IDENTIFIERS, carried_out, failures, planned

PROOFS: dict[str, tuple[str, list[Check]]] = {}
for _identifier in IDENTIFIERS:
    for _check in planned(_identifier, Kind.PROOF):
        _about = _check.shared or _identifier
        if _about not in PROOFS:
            PROOFS[_about] = (_identifier, [])
        if PROOFS[_about][0] == _identifier:
            PROOFS[_about][1].append(_check)


@pytest.mark.parametrize("about", PROOFS)
def test_the_derivation_is_proven(about: str, full: bool) -> None:
    identifier, checks = PROOFS[about]
    if full and identifier not in THOROUGH:
        pytest.skip("the same in small samples")
    assert not failures(carried_out(identifier, checks, full))
