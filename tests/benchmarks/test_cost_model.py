"""The model of what a call costs."""

from __future__ import annotations

import pytest

from benchmarks.cost_model import legs, lines, text


def points(call: float, pose: float, threads: int = 1) -> list[dict[str, float]]:
    counts = [10**k for k in range(1, 8)]
    return [{"poses": n, "threads": threads, "undisturbed": call / n + pose} for n in counts]


def test_a_line_is_found_again() -> None:
    one, two = lines([*points(4000, 55), *points(6500, 37, threads=2)])
    assert (one.threads, one.call, one.pose) == (1, pytest.approx(4000), pytest.approx(55))
    assert (two.threads, two.call, two.pose) == (2, pytest.approx(6500), pytest.approx(37))
    assert max(one.worst, two.worst) < 1e-9


def test_every_batch_has_the_same_weight_and_the_worst_is_told() -> None:
    """What is wrong by a tenth at ten million poses does not drown what a call costs."""
    measured = points(4000, 55)
    measured[-1]["undisturbed"] *= 1.1
    (line,) = lines(measured)
    assert line.call == pytest.approx(4000, rel=0.02)
    assert line.pose == pytest.approx(55, rel=0.04)
    assert 0.05 < line.worst < 0.1


def test_legs_are_told_apart_by_their_joints_alone() -> None:
    def robot(name: str, ns: float) -> dict[str, object]:
        return {
            "robot": name,
            "undisturbed": dict.fromkeys(("w1 single", "w1 batch", "w2 single", "w2 batch"), ns),
        }

    found = legs(
        [
            robot("spatial_rrr_a", 10),
            robot("spatial_rrr_b", 20),
            robot("spatial_rrrr_a", 40),
            robot("planar_rr_a", 5),
            robot("planar_fivebar_a", 1000),
            robot("spatial_prr_parallel_a", 1000),
        ]
    )
    assert [(one.kind, one.joints, one.nanoseconds["w1 batch"]) for one in found] == [
        ("planar", 2, 5),
        ("spatial", 3, 15),
        ("spatial", 4, 40),
    ]


def test_a_joint_more_is_told_within_its_kind() -> None:
    columns = ("w1 single", "w1 batch", "w2 single", "w2 batch")
    names = {"planar_rr_a": 10.0, "planar_rrr_a": 12.0, "spatial_rrr_a": 20.0, "spatial_rrrr_a": 25.0}
    robots = [{"robot": name, "undisturbed": dict.fromkeys(columns, ns)} for name, ns in names.items()]
    said = text({"scaling": [], "every robot": robots})
    assert "3 joints in planar legs where there were 2: 1.20 times as long" in said
    assert "4 joints in spatial legs where there were 3: 1.25 times as long" in said
    assert said.count("times as long") == 2


def test_words_say_what_was_measured() -> None:
    said = text({"scaling": points(4000, 55), "every robot": []})
    assert "4.0 µs a call and 55 ns a pose" in said
    assert "within 0 %" in said
