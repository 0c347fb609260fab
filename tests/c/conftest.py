from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from tests.c.support import COMPILERS, COVER, HERE, KINDS, ROBOTS, SOURCES, program, run, table
from tests.support import SOME, THOROUGH

Build = Callable[..., Path]


def pytest_generate_tests(metafunc: pytest.Metafunc) -> None:
    """Some robots, or with --full those of large samples, for robots share kernels; where a test is marked
    `every_robot`, one of each sub-leg, or every robot with --full.
    """
    own = any("robot" in mark.args[0] for mark in metafunc.definition.iter_markers("parametrize"))
    if "robot" in metafunc.fixturenames and not own:
        if metafunc.definition.get_closest_marker("every_robot") is None:
            small, large = SOME, THOROUGH
        else:
            small, large = COVER, ROBOTS
        full = metafunc.config.getoption("--full")
        robots = [pytest.param(robot, marks=pytest.mark.larger) for robot in large] if full else small
        metafunc.parametrize("robot", robots)


@pytest.fixture(params=COMPILERS)
def compiler(request: pytest.FixtureRequest) -> str:
    """Each C compiler; a test with one that is not installed is skipped and says so."""
    program(request.param)
    return str(request.param)


@pytest.fixture
def in_turns(robot: str, compiler: str) -> None:
    """One compiler for each robot, in turns, and both for the first: what compilers read differently comes
    from the templates, which all robots share.
    """
    if COMPILERS[len(robot) % 2] != compiler and robot != SOME[0]:
        pytest.skip("one compiler for each robot, in turns; both for the first")


@pytest.fixture
def build(tmp_path: Path) -> Build:
    """Compiles one of the harnesses here with a robot's functions."""

    def build(harness: str, robot: str, compiler: str, *flags: str, folder: Path = SOURCES) -> Path:
        (tmp_path / "table.h").write_text(table(robot))
        binary = tmp_path / harness.removesuffix(".c")
        sources = [HERE / harness, *(folder / f"krhpr_{robot}{kind}.c" for kind in KINDS)]
        warnings = ["-std=c11", "-Wall", "-Wextra", "-Werror"]
        streams = ["-DKRHPR_STREAM_BYTES=0"]  # small batches are written as large ones are
        places = [f"-I{place}" for place in (tmp_path, HERE, folder)]
        run([compiler, *warnings, *streams, *flags, *places, *sources, "-o", binary, "-lm"])
        return binary

    return build
