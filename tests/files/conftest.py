from __future__ import annotations

from pathlib import Path

import pytest

from tests.cli.conftest import cli
from tests.files.support import Write, dedent

__all__ = ["cli", "write"]


@pytest.fixture
def write(tmp_path: Path) -> Write:
    """Writes `arm.yaml`."""

    def here(text: str) -> Path:
        path = tmp_path / "arm.yaml"
        path.write_text(dedent(text), encoding="utf-8")
        return path

    return here
