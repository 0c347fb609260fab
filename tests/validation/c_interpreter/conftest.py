"""The sample text as files."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.validation.c_interpreter.sample import HEADER, SOURCE


@pytest.fixture(scope="module")
def files(tmp_path_factory: pytest.TempPathFactory) -> list[Path]:
    folder = tmp_path_factory.mktemp("sample")
    (folder / "sample_leg.h").write_text(HEADER)
    (folder / "sample.c").write_text(SOURCE)
    return [folder / "sample_leg.h", folder / "sample.c"]
