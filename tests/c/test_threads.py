"""Functions keep no state: several threads at once get what one thread gets."""

from __future__ import annotations

import subprocess

import pytest

from tests.c.conftest import Build
from tests.c.support import run
from tests.support import SOME, large


@pytest.mark.usefixtures("in_turns")
def test_threads_agree_bit_by_bit(robot: str, compiler: str, build: Build, full: bool) -> None:
    if robot == SOME[0] and not full:
        pytest.skip("small samples: under the thread sanitizer below")
    run([build("threads.c", robot, compiler, "-O0", "-pthread")])


@pytest.mark.usefixtures("in_turns")
def test_no_data_race(robot: str, compiler: str, build: Build, full: bool) -> None:
    if robot != SOME[0] and not large(robot, full):
        pytest.skip("small samples: the first robot only")
    binary = build("threads.c", robot, compiler, "-O0", "-g", "-pthread", "-fsanitize=thread")
    done = subprocess.run([binary], capture_output=True, text=True, check=False)
    if "FATAL: ThreadSanitizer" in done.stderr:
        pytest.skip(f"the thread sanitizer does not run here: {done.stderr.splitlines()[0]}")
    assert done.returncode == 0, done.stdout + done.stderr
    assert "WARNING: ThreadSanitizer" not in done.stderr
