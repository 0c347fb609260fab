from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from tests.c.support import COMPILERS, HERE, ROBOTS, SOURCES, program, run, table

Build = Callable[..., Path]


@pytest.fixture(params=ROBOTS)
def robot(request: pytest.FixtureRequest) -> str:
    return str(request.param)


@pytest.fixture(params=COMPILERS)
def compiler(request: pytest.FixtureRequest) -> str:
    """Each C compiler; a test with one that is not installed is skipped and says so."""
    program(request.param)
    return str(request.param)


@pytest.fixture
def build(tmp_path: Path) -> Build:
    """Compiles one of the harnesses here with a robot's functions."""

    def build(harness: str, robot: str, compiler: str, *flags: str, folder: Path = SOURCES) -> Path:
        (tmp_path / "table.h").write_text(table(robot))
        binary = tmp_path / harness.removesuffix(".c")
        sources = [HERE / harness, folder / f"krhpr_{robot}.c"]
        warnings = ["-std=c11", "-Wall", "-Wextra", "-Werror"]
        places = [f"-I{place}" for place in (tmp_path, HERE, folder)]
        run([compiler, *warnings, *flags, *places, *sources, "-o", binary, "-lm"])
        return binary

    return build
