"""What all tests share: the option --full, and Hypothesis' settings."""

from __future__ import annotations

import gc
from collections import Counter
from functools import cache

import pytest
from hypothesis import is_hypothesis_test, settings

from krhpr.backend import SLOWER
from krhpr.native import NoCompiler, extension_paths, find_compiler

# The same examples on every run and machine; no deadline, as kernels are compiled or derived on first use.
settings.register_profile("small", deadline=None, derandomize=True, max_examples=50)
settings.register_profile("full", deadline=None, derandomize=True, max_examples=300)


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption(
        "--full",
        action="store_true",
        help="run the tests that have large samples on these; the others are those of a run without it",
    )


def pytest_configure(config: pytest.Config) -> None:
    # what robots are derived to stays: looking through it for cycles takes a sixth of the time
    gc.set_threshold(100_000, 50, 1000)
    settings.load_profile("full" if config.getoption("--full") else "small")


@cache
def no_compiler() -> str:
    """Why there are no compiled kernels here; empty where there are."""
    try:
        find_compiler()
        extension_paths()
    except NoCompiler as error:
        return str(error)
    return ""


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    reason = no_compiler()
    if reason:
        skip = pytest.mark.skip(reason=f"compiled kernels cannot be tested here: {reason}")
        for item in items:
            parameters = getattr(item, "callspec", None)
            if item.get_closest_marker("compiler") or (
                parameters is not None
                and any(isinstance(p, str) and p == "compiled" for p in parameters.params.values())
            ):
                item.add_marker(skip)
    if config.getoption("--full"):
        left_out = [item for item in items if not _is_larger(item)]
    else:
        left_out = [item for item in items if item.get_closest_marker("full")]
    if left_out:
        config.hook.pytest_deselected(items=left_out)
        out = set(left_out)
        items[:] = [item for item in items if item not in out]


def _is_larger(item: pytest.Item) -> bool:
    """Whether large samples are another test: more examples, more robots, or not run on small ones."""
    marked = item.get_closest_marker("full") or item.get_closest_marker("larger")
    return bool(marked or "full" in getattr(item, "fixturenames", ())) or is_hypothesis_test(
        getattr(item, "function", None)
    )


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter) -> None:
    """Without a compiler: how many tests were skipped for each reason, and what ran more slowly."""
    reason = no_compiler()
    if not reason or terminalreporter.config.option.collectonly:
        return
    terminalreporter.section("no compiled kernels")
    terminalreporter.write_line(f"{reason}.")
    terminalreporter.write_line(f"Robots ran on the pure NumPy modules: {SLOWER}.")
    reports = terminalreporter.stats.get("skipped", [])
    reasons = Counter(str(report.longrepr[2]).removeprefix("Skipped: ") for report in reports)
    for said, count in reasons.most_common():
        terminalreporter.write_line(f"{count:6} skipped: {said.replace(f': {reason}', '')}")


@pytest.fixture(scope="session")
def full(request: pytest.FixtureRequest) -> bool:
    """Whether the large samples are wanted: `samples = 20_000 if full else 200`."""
    return bool(request.config.getoption("--full"))
