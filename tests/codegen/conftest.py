from __future__ import annotations

import pytest

from krhpr.codegen.pipeline import Derived
from krhpr.codegen.targets.base import File
from tests.support import derived_robots, printed_files


@pytest.fixture(scope="session")
def derived() -> Derived:
    """Every robot of the catalogue, derived afresh."""
    return derived_robots()


@pytest.fixture(scope="session")
def printed() -> list[File]:
    """Every file, printed afresh."""
    return list(printed_files())
