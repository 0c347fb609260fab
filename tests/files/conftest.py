from __future__ import annotations

from pathlib import Path

import pytest

from tests.files.support import Write, dedent


@pytest.fixture
def write(tmp_path: Path) -> Write:
    """Writes `arm.yaml`."""

    def here(text: str) -> Path:
        path = tmp_path / "arm.yaml"
        path.write_text(dedent(text), encoding="utf-8")
        return path

    return here
