"""What the commands need, and how failures, interruptions and closed pipes end."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import warnings
from dataclasses import replace
from pathlib import Path
from typing import NoReturn

import pytest

from krhpr.backend import SLOWER
from krhpr.cli import app, common
from tests.cli.support import Cli
from tests.support import ROOT, run_python
from tests.test_packaging import HEAVY

POSE = '{"p": [0.01, -0.02], "phi": 0.1, "redundant": [1.5, 1.4, 1.6]}'

MAIN = """
import sys

from krhpr.cli import main

code = main({arguments!r})
print(sorted({{name.partition(".")[0] for name in sys.modules}} & {heavy!r}), file=sys.stderr)
sys.exit(code)
"""

BLOCK = """
import sys

class Blocked:
    def find_spec(self, name, path=None, target=None):
        if name.partition(".")[0] in {blocked!r}:
            raise ModuleNotFoundError(f"No module named {{name!r}}", name=name)

sys.meta_path.insert(0, Blocked())

from krhpr.cli import main

sys.exit(main({arguments!r}))
"""

LIGHT = {
    "help": ["--help"],
    "list": ["list"],
    "info": ["info", "planar_rr_a"],
    "function": ["info", "planar_rr_a", "--function", "inverse"],
    "eval": ["eval", "planar_rr_a", "inverse"],
}


@pytest.mark.parametrize("arguments", LIGHT.values(), ids=LIGHT)
def test_looking_up_and_computing_take_numpy_alone(arguments: list[str]) -> None:
    code = MAIN.format(arguments=arguments, heavy={*HEAVY, "numpy"} if "--help" in arguments else set(HEAVY))
    run = run_python("-c", code, env={"KRHPR_BACKEND": "numpy"}, input=POSE)
    assert run.returncode == 0, run.stderr
    if arguments != ["--help"]:  # which ends before anything is printed here
        assert run.stderr == "[]\n"


@pytest.mark.parametrize(
    "arguments",
    [*LIGHT.values(), pytest.param(["compile", "planar_rr_a"], marks=pytest.mark.compiler)],
    ids=[*LIGHT, "compile"],
)
def test_they_work_where_nothing_else_is_installed(arguments: list[str]) -> None:
    run = run_python("-c", BLOCK.format(arguments=arguments, blocked=HEAVY), input=POSE)
    assert run.returncode == 0, run.stderr


@pytest.mark.parametrize(("missing", "extra"), [("sympy", "generate"), ("jinja2", "generate")])
def test_what_is_missing_is_named_with_its_extra(missing: str, extra: str) -> None:
    run = run_python("-c", BLOCK.format(arguments=["generate", "--check"], blocked=(missing,)))
    assert run.returncode == 1
    assert run.stderr.endswith(f"krhpr: {missing} is not installed: pip install 'krhpr[{extra}]'\n")


def test_generating_does_without_rich(tmp_path: Path) -> None:
    arguments = ["generate", "planar_rr_a", "--out", str(tmp_path / "arm")]
    run = run_python("-c", BLOCK.format(arguments=arguments, blocked=("rich",)))
    assert run.returncode == 0, run.stderr


def test_generating_takes_its_extra_alone(tmp_path: Path) -> None:
    """What makes the environment of `make generate`."""
    others = tuple(name for name in HEAVY if name not in ("sympy", "mpmath", "jinja2", "rich"))
    arguments = ["generate", "planar_rr_a", "--out", str(tmp_path / "here")]
    run = run_python("-c", BLOCK.format(arguments=arguments, blocked=others))
    assert run.returncode == 0, run.stderr


def test_python_m_krhpr_is_the_command_line() -> None:
    run = run_python("-m", "krhpr", "list", "--json")
    assert json.loads(run.stdout)


# -- failures ------------------------------------------------------------------------------------------------


def failing(monkeypatch: pytest.MonkeyPatch, error: BaseException) -> None:
    """Make `krhpr list` fail."""

    def fail(options: object) -> NoReturn:
        raise error

    first, *others = app.COMMANDS
    monkeypatch.setattr(app, "COMMANDS", (replace(first, run=fail), *others))


def test_an_unexpected_failure_is_one_line(cli: Cli, monkeypatch: pytest.MonkeyPatch) -> None:
    failing(monkeypatch, ZeroDivisionError("by zero"))
    result = cli("list")
    assert (result.code, result.out) == (1, "")
    assert result.err == "krhpr: ZeroDivisionError: by zero\nkrhpr: --debug shows where\n"


@pytest.mark.parametrize("arguments", [["--debug", "list"], ["list", "--debug"]])
def test_debug_shows_where(arguments: list[str], cli: Cli, monkeypatch: pytest.MonkeyPatch) -> None:
    failing(monkeypatch, ZeroDivisionError("by zero"))
    result = cli(*arguments)
    assert result.code == 1
    assert result.err.startswith("Traceback") and "in fail" in result.err
    assert result.err.endswith("krhpr: ZeroDivisionError: by zero\n")


def test_a_file_that_fails_is_named(cli: Cli, monkeypatch: pytest.MonkeyPatch) -> None:
    failing(monkeypatch, OSError(28, "No space left on device", "/tmp/x"))
    assert cli("list").err.startswith("krhpr: /tmp/x: No space left on device\n")


def test_an_interruption_has_its_code(cli: Cli, monkeypatch: pytest.MonkeyPatch) -> None:
    failing(monkeypatch, KeyboardInterrupt())
    result = cli("list")
    assert (result.code, result.err) == (130, "krhpr: interrupted\n")


def test_a_closed_pipe_ends_quietly() -> None:
    read, write = os.pipe()
    os.close(read)
    run = subprocess.run(
        [sys.executable, "-m", "krhpr", "info", "planar_rr_a", "--json"],
        stdout=write,
        stderr=subprocess.PIPE,
        text=True,
        check=False,
    )
    os.close(write)
    assert (run.returncode, run.stderr) == (1, "")


def test_a_warning_is_one_line(cli: Cli, monkeypatch: pytest.MonkeyPatch) -> None:
    def warn(options: object) -> int:
        warnings.warn("slower", RuntimeWarning, stacklevel=2)
        return 0

    first, *others = app.COMMANDS
    monkeypatch.setattr(app, "COMMANDS", (replace(first, run=warn), *others))
    monkeypatch.setattr(warnings, "filters", [("always", None, Warning, None, 0)])
    assert cli("list").err == "krhpr: warning: slower\n"


# -- in a terminal -------------------------------------------------------------------------------------------


def test_a_table_in_a_terminal_is_drawn(cli: Cli, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("COLUMNS", "140")
    monkeypatch.setattr("_pytest.capture.CaptureIO.isatty", lambda self: True)
    out = cli("list").out
    assert "─" in out
    assert "3-[R(RR-RRR)SR]" in out  # and is not taken for markup


def test_a_table_in_a_terminal_without_rich_is_plain(cli: Cli, monkeypatch: pytest.MonkeyPatch) -> None:
    plain = cli("list").out
    monkeypatch.setattr("_pytest.capture.CaptureIO.isatty", lambda self: True)
    monkeypatch.setattr(common, "_rich", lambda: None)
    assert cli("list").out == plain


def test_progress_in_a_terminal_leaves_nothing_behind_but_the_results(
    cli: Cli, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setattr("_pytest.capture.CaptureIO.isatty", lambda self: True)
    monkeypatch.setenv("TERM", "xterm")
    result = cli("generate", "planar_rr_a", "--out", tmp_path / "arm")
    assert result.code == 0
    assert "derive planar_rr_a" in result.err


@pytest.mark.full  # it collects all tests, which takes half a minute
def test_without_a_compiler_tests_are_skipped_and_it_is_said(tmp_path: Path) -> None:
    """All are collected; of one that needs a compiler it is told why it is skipped, and what is slower."""
    common = ["-m", "pytest", "-p", "no:cacheprovider", "-p", "no:xdist", "-q"]
    environment = {"KRHPR_CC": "none", "KRHPR_CACHE": str(tmp_path)}
    collected = run_python(*common, "--collect-only", "tests", env=environment, cwd=ROOT)
    assert collected.returncode == 0, collected.stdout
    one = run_python(*common, "tests/cli/test_compile.py", env=environment, cwd=ROOT)
    assert one.returncode == 0, one.stdout
    assert f"compilers are disabled.\nRobots ran on the pure NumPy modules: {SLOWER}.\n" in one.stdout
    assert "     2 skipped: compiled kernels cannot be tested here\n" in one.stdout
