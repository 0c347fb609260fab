from __future__ import annotations

import pytest

from krhpr.codegen.pipeline import Derived, derive, print_all
from krhpr.codegen.targets.base import File


@pytest.fixture(scope="session")
def derived() -> Derived:
    """Every robot of the catalogue, derived afresh."""
    return derive()


@pytest.fixture(scope="session")
def printed(derived: Derived) -> list[File]:
    """Every file, printed afresh."""
    return print_all(derived)
