"""The search, against what is known in closed form and against looking at everything."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

import krhpr
from krhpr.design import DesignSpace, Effort, Evaluation, Grid, Objective, Problem, Tie, Variable, search
from krhpr.design.front import costs, front, non_dominated, weights
from krhpr.errors import DesignError
from krhpr.workspace import WorkspaceLimits, section_1_7

ROBOT = krhpr.load("spatial_rrr_a")
PAIR = (Objective.VOLUME, Objective.ETA_1)
QUICK = Effort(samples=8, parts=2, generations=2, population=4)


@dataclass(frozen=True)
class Toy:
    """volume = -(x - 1)^2 - y^2 and eta_1 = (x + 1)^2 + y^2: the front is y = 0, -1 <= x <= 1, on which
    sqrt(-volume) + sqrt(eta_1) = 2. Nothing works where x + y > 1.5."""

    space: DesignSpace
    objectives: tuple[Objective, ...] = PAIR

    def evaluate(self, values: Any) -> Evaluation:
        x, y = np.asarray(values) / 0.1 - 3
        own = tuple(np.asarray(values).tolist())
        if x + y > 1.5:
            return Evaluation(own, float(x + y - 1.5), "too far")
        results = {Objective.VOLUME: -((x - 1) ** 2) - y**2, Objective.ETA_1: (x + 1) ** 2 + y**2}
        return Evaluation(own, 0.0, "", MappingProxyType({k: float(v) for k, v in results.items()}))

    def settings(self) -> dict[str, Any]:
        return {"toy": 1}


TOY = Toy(DesignSpace(ROBOT, [Variable("R_p", 0.1, 0.5), Variable("l_r", 0.1, 0.5)]))


def test_a_front_in_closed_form() -> None:
    found = search(TOY, Effort(samples=32, parts=6, generations=12))
    cost = costs(found.front, PAIR)
    off = np.abs(np.sqrt(cost).sum(axis=1) - 2)
    assert len(cost) > 50 and off.max() < 0.2 and np.median(off) < 0.005  # at its ends the front is steep
    x, y = np.array([one.values for one in found.front]).T / 0.1 - 3
    assert x.min() < -0.95 and x.max() > 0.95 and np.median(np.abs(y)) < 0.05
    assert np.diff(np.sort(cost[:, 0])).max() < 0.7  # all along
    assert [tuple(row) for row in cost] == sorted(map(tuple, cost))


def test_one_objective_in_closed_form() -> None:
    """The shortest two equal links that reach the home pose: half the distance from c to S_i each."""
    p, redundant = np.array(ROBOT.home.p), np.array(ROBOT.home.redundant)
    s = ROBOT.end_points(p, np.eye(3), redundant)
    c = ROBOT.link_points(p, np.eye(3), s, np.zeros((3, 3))).points[:, 1]
    shortest = float(np.linalg.norm(s - c, axis=-1).max()) / 2

    @dataclass(frozen=True)
    class Lengths(Problem):
        def grid_of(self, robot: Any, values: Any, grid: Any = None) -> Evaluation:
            size = {Objective.LENGTH: float(robot.geometry.l_2[0])}
            return Evaluation(values, 0.0, "", MappingProxyType(size))

    space = DesignSpace(
        ROBOT, [Variable("l_2", 0.05, 0.5, (Tie("l_3", 1.0),)), Variable("R_b", 0.2499, 0.2501)]
    )
    found = search(
        Lengths(space, (Objective.LENGTH,), WorkspaceLimits()), Effort(samples=8, parts=1, generations=25)
    )
    (best,) = found.demand().front
    # the base may be smaller by 0.1 mm, and values have four places
    assert shortest - 2e-4 < best.values[0] < shortest + 2e-4
    assert any("reach of leg" in one.reason for one in found.designs)


@given(arrays(float, st.tuples(st.integers(0, 12), st.integers(1, 3)), elements=st.integers(0, 4)))
@settings(max_examples=60, deadline=None)
def test_what_no_other_row_beats(cost: np.ndarray) -> None:
    kept = non_dominated(cost)

    def beats(a: np.ndarray, b: np.ndarray) -> bool:
        return bool((a <= b).all() and (a < b).any())

    for k, row in enumerate(cost):
        beaten = any(beats(other, row) for other in cost)
        again = any((other == row).all() for other in cost[:k])
        assert kept[k] == (not beaten and not again)


def test_infinite_costs_do_not_count() -> None:
    cost = np.array([[1.0, np.inf], [2.0, 2.0], [np.nan, 0.0], [np.inf, np.inf]])
    assert non_dominated(cost).tolist() == [False, True, False, False]


def test_weights() -> None:
    assert weights(1, 5).tolist() == [[1.0]]
    assert weights(2, 2).tolist() == [[0, 1], [1, 0], [0.5, 0.5]]
    assert len(weights(3, 4)) == 15 and np.allclose(weights(3, 4).sum(axis=1), 1)


class Steps(DesignSpace):
    """Five values of each variable alone, so that all designs can be looked at."""

    def values(self, shares: Any) -> Any:
        return super().values(np.round(np.asarray(shares) * 4) / 4)


def robots(kind: type[DesignSpace] = Steps) -> Problem:
    space = kind(ROBOT, [Variable("redundant", 1.2, 2.6), Variable("l_r", 0.03, 0.09)])
    grid = Grid(step=0.09, angle=np.pi / 6, balls=100)
    return Problem(space, (Objective.VOLUME, Objective.ETA_2), section_1_7(ROBOT), grid)


def test_the_front_of_robots_is_that_of_all_of_them() -> None:
    """25 designs, one by one, and by the search."""
    problem = robots()
    places = np.stack(np.meshgrid(*[np.arange(5) / 4] * 2, indexing="ij"), axis=-1).reshape(-1, 2)
    every = [problem.evaluate(row) for row in problem.space.values(places)]
    whole = front(every, problem.objectives)
    found = search(problem, Effort(samples=24, parts=6, generations=6, population=6))
    assert 1 < len(whole) < 25

    def numbers(designs: Any) -> set[tuple[float, ...]]:
        return {one.values for one in designs}

    # the robot itself is none of the 25
    own = found.own
    assert numbers(found.front) - {own.values} == numbers(front([own, *every], problem.objectives)) - {
        own.values
    }


def test_the_same_seed_finds_the_same_and_another_one_another() -> None:
    first, again = search(TOY, QUICK), search(TOY, QUICK)
    assert first == again
    other = search(TOY, Effort(8, 2, 2, 4, seed=1))
    assert other.designs[1:] != first.designs[1:]


def test_numpys_own_random_numbers_are_left_alone() -> None:
    np.random.seed(3)
    before = np.random.get_state()[1].tolist()  # type: ignore[union-attr]
    search(TOY, QUICK)
    assert np.random.get_state()[1].tolist() == before  # type: ignore[union-attr]


def test_workers_change_nothing() -> None:
    distributed = pytest.importorskip("distributed")
    problem = robots(DesignSpace)
    told: list[tuple[str, int, int]] = []
    alone = search(problem, QUICK, progress=lambda *at: told.append(at))
    assert search(problem, QUICK, workers=2) == alone
    counts = [done for _, done, _ in told]
    assert counts == sorted(counts) and counts[-1] == told[-1][2] == QUICK.evaluations(2)
    with distributed.LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster:
        assert search(problem, QUICK, workers=cluster.scheduler_address) == alone
    with pytest.raises(DesignError, match="0 workers; expected 1 or more"):
        search(problem, QUICK, workers=0)


def test_an_interrupted_search_goes_on(tmp_path: Path) -> None:
    """A log that ends anywhere, in the middle of a line too, leads to the same; what it has is not judged
    again."""
    log = tmp_path / "deep" / "log.jsonl"
    whole = search(TOY, QUICK, log=log)
    lines = log.read_text("utf-8").splitlines(keepends=True)
    assert len(lines) == 1 + len(whole.designs)
    for kept in (1, 3, len(lines) - 1):
        log.write_text("".join(lines[:kept]) + lines[min(kept, len(lines) - 1)][:20], "utf-8")
        judged = []

        class Counted(Toy):
            def evaluate(self, values: Any, judged: Any = judged) -> Evaluation:
                judged.append(1)
                return super().evaluate(values)

        assert search(Counted(TOY.space), QUICK, log=log) == whole
        assert len(judged) == len(lines) - kept
        assert log.read_text("utf-8").splitlines(keepends=True) == lines


def test_logs_of_something_else(tmp_path: Path) -> None:
    log = tmp_path / "log.jsonl"
    search(TOY, QUICK, log=log)
    with pytest.raises(DesignError, match="the log is of another search: seed differ"):
        search(TOY, Effort(8, 2, 2, 4, seed=5), log=log)
    with pytest.raises(DesignError, match="the log is of another search: toy, version"):
        search(robots(), QUICK, log=log)
    log.write_text("no log\n", "utf-8")
    with pytest.raises(DesignError, match=r"no log of a search \(JSONDecodeError\)"):
        search(TOY, QUICK, log=log)
    log.write_text(json.dumps({"toy": 1, "seed": 0}) + "\n[]\n", "utf-8")
    with pytest.raises(DesignError, match="no log of a search"):
        search(TOY, QUICK, log=log)


@pytest.mark.parametrize("wrong", [{"samples": 0}, {"parts": 0}, {"generations": 0}, {"population": 3}])
def test_efforts_that_are_none(wrong: dict[str, int]) -> None:
    (name,) = wrong
    with pytest.raises(DesignError, match=f"{name} is {wrong[name]}; expected"):
        Effort(**wrong)
