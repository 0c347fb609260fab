"""The runner: what passes, fails and is not run, and the reports that say so."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from krhpr.validation import reference, run
from krhpr.validation.check import BALL, EXACT, Check, Kind, Samples, Target
from krhpr.validation.numbers import Angle, Ball, Exact, ball_precision
from krhpr.validation.outcome import Measured, State
from krhpr.validation.run import Report, Result, carry_out
from krhpr.validation.subject import subjects
from tests.validation.support import planned, subject

CHECK = Check(Kind.PROOF, "robot", "function", Target.DERIVATION, EXACT, Samples(2, 7), "It holds.", "name")


def test_a_run_covers_the_plan_and_writes_reports(tmp_path: Path) -> None:
    steps: list[str] = []
    report = run.run(
        ["planar_rr_a"], progress=steps.append, folder=tmp_path / "validation", kinds={Kind.PROOF}
    )
    assert report.ok and not report.failed and steps == ["planar_rr_a: proof"]
    assert [result.check for result in report.results] == list(planned("planar_rr_a", Kind.PROOF))
    assert report.counts() == {"passed": len(report.results), "failed": 0, "not run": 0}
    written = json.loads((tmp_path / "validation" / "report.json").read_text())
    assert written["ok"] and len(written["results"]) == len(report.results)
    assert written["results"][0]["robot"] == "planar_rr_a" and written["results"][0]["state"] == "passed"
    text = (tmp_path / "validation" / "report.md").read_text()
    worst = max(report.results, key=lambda result: result.worst).check
    assert f"| {worst.name}, `{worst.function}` |" in text and report.summary() in text


def test_parts_are_checked_once_for_all_robots() -> None:
    report = run.run(["spatial_rrr_a", "spatial_rrr_c"], folder=None, kinds={Kind.PASSES})
    sublegs = [result for result in report.results if result.check.shared == "subleg_rrr"]
    first = [result for result in sublegs if result.check.robot == "spatial_rrr_a"]
    second = [result for result in sublegs if result.check.robot == "spatial_rrr_c"]
    assert len(first) == len(second) > 5 and all(result.seconds == 0.0 for result in second)
    assert [result.worst for result in first] == [result.worst for result in second]


def test_unknown_robots_and_sizes_are_refused() -> None:
    with pytest.raises(KeyError, match="no robot is called nobody; there are spatial_rrr_a"):
        run.run(["nobody"], folder=None)
    with pytest.raises(ValueError, match="'small' or 'large'"):
        run.run(["planar_rr_a"], "medium", folder=None)


def test_without_a_compiler_the_rest_runs(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("KRHPR_CC", "none")
    (other,) = subjects(["planar_rr_a"])  # whose library nobody has asked for
    for kind in (Kind.INVARIANT, Kind.AGREEMENT):
        for check in planned("planar_rr_a", kind)[:4]:
            result = carry_out(other, check, "small")
            wanted = State.NOT_RUN if check.compiles else State.PASSED
            assert result.state is wanted, str(result)
            assert ("KRHPR_CC" in result.remark) == check.compiles
    report = Report("small", (Result(CHECK, State.NOT_RUN, remark="no compiler"),) * 3)
    assert report.ok and "* no compiler (3 checks)" in report.as_markdown()


def test_without_reference_values_the_check_is_not_run(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setattr(reference, "FOLDER", tmp_path)
    reference.load.cache_clear()
    check = next(c for c in planned("planar_rr_a", Kind.REFERENCE) if c.target is Target.NUMPY)
    result = carry_out(subject("planar_rr_a"), check, "small")
    reference.load.cache_clear()
    assert result.state is State.NOT_RUN and "source tree" in result.remark


def test_an_error_in_a_check_is_its_failure(monkeypatch: pytest.MonkeyPatch) -> None:
    def broken(*_: object) -> Measured:
        raise RuntimeError("out of order\nand more")

    monkeypatch.setitem(run.RUNNERS[Kind.PROOF], "rows", broken)  # type: ignore[arg-type]
    check = next(c for c in planned("planar_rr_a", Kind.PROOF) if c.name == "rows")
    result = carry_out(subject("planar_rr_a"), check, "small")
    assert result.state is State.FAILED and result.remark == "RuntimeError: out of order"
    report = Report("small", (result,))
    assert not report.ok and "## Failed" in report.as_markdown() and "out of order" in report.as_markdown()


def test_samples_follow_the_size() -> None:
    seen = []

    def runner(_subject: object, check: Check, count: int) -> Measured:
        seen.append(count)
        return Measured(check, samples=count)

    original = run.RUNNERS[Kind.PROOF]["rows"]
    try:
        run.RUNNERS[Kind.PROOF]["rows"] = runner  # type: ignore[index]
        check = replace(CHECK, name="rows")
        for size in ("small", "large"):
            carry_out(subject("planar_rr_a"), check, size)
    finally:
        run.RUNNERS[Kind.PROOF]["rows"] = original  # type: ignore[index]
    assert seen == [2, 7]


def test_the_worst_error_is_kept() -> None:
    found = Measured(replace(CHECK, tolerance=0.5), samples=1)
    found.worse(0.1, "here")
    assert found.ok and found.where == ""
    found.worse(np.array([0.2, 0.7]), lambda: "there")
    found.worse(0.6, "later")
    assert not found.ok and (found.worst, found.where) == (0.7, "there")
    found.worse([np.nan], "nowhere")
    assert found.worst > 1e300 and found.where == "nowhere"
    assert not Measured(CHECK).ok, "a check that looked at nothing does not hold"


def test_exact_numbers_are_compared_without_tolerance() -> None:
    found = Measured(CHECK, samples=1)
    angle = Angle("3/5", "4/5")
    found.equal([[Exact(1)], [Exact("1/3")]], [Exact(1), Exact("2/6")])
    found.equal([angle, 0], [angle + Angle.half_turn() + Angle.half_turn(), Exact(0)])
    assert found.ok and found.worst == 0.0
    found.equal([Exact(1)], [Exact(1) + Exact("1e-90")], "s")
    assert not found.ok and found.where.startswith("s[0]: Exact('1') is not Exact('")
    other = Measured(CHECK, samples=1)
    other.equal([angle], [-angle])
    assert not other.ok
    with pytest.raises(ValueError, match="zip"):
        found.equal([Exact(1)], [Exact(1), Exact(2)])


def test_balls_are_compared_within_the_tolerance() -> None:
    with ball_precision():
        found = Measured(replace(CHECK, tolerance=BALL), samples=1)
        root = Ball(2).sqrt()
        found.equal([root, root * root], [2 / root, 2])
        assert found.ok and found.worst < 1e-80
        found.equal([root], [root + Ball("1e-55")])
        assert not found.ok
        exact = Measured(CHECK, samples=1)
        exact.equal([root * root], [Exact(2)])
        assert exact.ok and exact.worst == 0.0
        exact.equal([root * root], [Exact(3)])
        assert not exact.ok
