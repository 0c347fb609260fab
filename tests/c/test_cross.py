"""The generated C for another processor: 64-bit ARM, whose registers hold two lanes, under emulation."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.c.support import HERE, KINDS, SOURCES, program, run, table
from tests.c.test_hostile import may_be_nan
from tests.support import SOME, large

COMPILER, EMULATOR = "aarch64-linux-gnu-gcc", "qemu-aarch64"


@pytest.mark.parametrize("contraction", ["off", "fast"])
def test_two_lanes_of_another_processor(robot: str, contraction: str, tmp_path: Path, full: bool) -> None:
    """Every function, its batches and structures of arrays keep their promises (tests/c/hostile.c) there."""
    if not large(robot, full):
        pytest.skip("large samples only")
    if contraction == "off" and robot != SOME[0]:
        pytest.skip("without fused operations: the first robot, as all kernels are alike in this")
    compiler, emulator = program(COMPILER), program(EMULATOR)
    (tmp_path / "table.h").write_text(table(robot))
    sources = [HERE / "hostile.c", *(SOURCES / f"krhpr_{robot}{kind}.c" for kind in KINDS)]
    binary = tmp_path / "hostile"
    flags = ["-std=c11", "-O2", "-Wall", "-Wextra", "-Werror", "-static", f"-ffp-contract={contraction}"]
    flags += ["-fno-math-errno", "-DTOLERANCE=1e-9"] if contraction == "fast" else []
    places = [f"-I{place}" for place in (tmp_path, HERE, SOURCES)]
    run([compiler, *flags, *places, *sources, "-o", binary, "-lm"])
    run([emulator, binary, "2000", *may_be_nan(robot)])
