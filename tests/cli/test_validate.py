"""`krhpr validate`: what it shows of a run, and its exit code."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest

import krhpr
from krhpr.validation import run as validation
from krhpr.validation.outcome import State
from krhpr.validation.run import Report
from tests.cli.support import Cli


@pytest.fixture
def report(monkeypatch: pytest.MonkeyPatch) -> list[Report]:
    """A report that the next run gives in place of its own."""
    given: list[Report] = []
    monkeypatch.setattr(validation, "run", lambda *_, **__: given[0])
    return given


@pytest.fixture(scope="session")
def passed(tmp_path_factory: pytest.TempPathFactory) -> Report:
    """What a real run comes to, proofs alone."""
    kinds = [kind for kind in validation.Kind if str(kind) == "passes"]
    return validation.run(["planar_rr_a"], folder=None, kinds=kinds)


def changed(report: Report, state: State, remark: str, count: int) -> Report:
    from dataclasses import replace

    first = [replace(result, state=state, worst=0.5, remark=remark) for result in report.results[:count]]
    return replace(report, results=(*first, *report.results[count:]))


def test_a_run_that_passes(cli: Cli, report: list[Report], passed: Report) -> None:
    report.append(passed)
    result = cli("validate", "planar_rr_a", "--report", "/somewhere")
    assert result.code == 0, result.out
    count = len(passed.results)
    assert re.search(rf"^planar_rr_a +{count} +{count} +0 +0 +\d+\.\d\d$", result.out, re.MULTILINE)
    assert result.out.endswith("; /somewhere/report.md\n")


def test_failures_are_shown_and_have_their_code(cli: Cli, report: list[Report], passed: Report) -> None:
    report.append(changed(passed, State.FAILED, "one is not two", 2))
    result = cli("validate", "planar_rr_a")
    assert result.code == 3
    assert result.out.count("failed: ") == 2
    assert "one is not two" in result.out
    assert "2 failed" in result.out.splitlines()[-1]


def test_many_failures_are_counted(cli: Cli, report: list[Report], passed: Report) -> None:
    report.append(changed(passed, State.FAILED, "wrong", 25))
    out = cli("validate", "planar_rr_a").out
    assert out.count("failed: ") == 20 and "... and 5 more\n" in out


def test_what_could_not_be_run_is_no_failure_but_said(cli: Cli, report: list[Report], passed: Report) -> None:
    report.append(changed(passed, State.NOT_RUN, "no C compiler found", 3))
    result = cli("validate", "planar_rr_a")
    assert result.code == 0
    assert "not run: 3 checks: no C compiler found\n" in result.out


def test_samples_and_robots_are_passed_on(cli: Cli, monkeypatch: pytest.MonkeyPatch, passed: Report) -> None:
    calls = []

    def run(robots: list[str], samples: str, progress: object, folder: Path) -> Report:
        calls.append((robots, samples, folder))
        return passed

    monkeypatch.setattr(validation, "run", run)
    cli(
        "validate",
        "planar_grasp_rpr",
        "planar_rr_a",
        "spatial_rrr_a",
        "planar_rr_a",
        "--full",
        "--report",
        "x",
    )
    cli("validate")
    assert calls == [
        (["spatial_rrr_a", "planar_rr_a", "planar_grasp_rpr"], "large", Path("x")),
        ([*krhpr.catalogue(), *krhpr.grasping_robots()], "small", Path("build/validation")),
    ]


@pytest.mark.full
def test_a_robot_validates(cli: Cli, tmp_path: Path) -> None:
    result = cli("validate", "planar_rr_a", "--report", tmp_path)
    assert result.code == 0, result.out
    assert json.loads((tmp_path / "report.json").read_text())["ok"]
    assert "planar_rr_a: identity" in result.err
