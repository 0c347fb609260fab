"""The search for the front: a sample of all designs, and then an evolution strategy in every direction.

CMA-ES (the package `cma`) improves one number; here the largest weighted way from the best value of each
objective, for many weights, each begun at the best design that is known. What is returned is the front of
all designs that were looked at. The search is a function of its settings and the seed: designs are judged in
this process or in others, and those that a log has are not judged again.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from contextlib import contextmanager
from dataclasses import asdict, dataclass
from importlib import import_module
from multiprocessing import get_context
from pathlib import Path
from typing import Any, Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from krhpr.design.evaluation import Evaluation
from krhpr.design.front import chebyshev, costs, front, non_dominated, weights
from krhpr.design.objectives import Objective
from krhpr.design.variables import DesignSpace
from krhpr.errors import DesignError
from krhpr.workspace.execute import RETRIES, connected

Floats = NDArray[np.float64]

Progress = Callable[[str, int, int], None]
"""Called with what is being done, how many designs were looked at, and how many there will be at most."""

Evaluate = Callable[[Floats], list[Evaluation]]
"""Designs (n, variables) -> what they are worth."""

BEYOND = 1e3
"""The cost of a design that does not work, to which its shortfall is added: more than any that works."""


class Judged(Protocol):
    """What can be searched: `Problem`, or anything else with these."""

    @property
    def space(self) -> DesignSpace:
        """A robot and what may be changed of it."""

    @property
    def objectives(self) -> tuple[Objective, ...]:
        """What is to be good."""

    def evaluate(self, values: ArrayLike) -> Evaluation:
        """What a design is worth."""

    def settings(self) -> dict[str, Any]:
        """Everything that results depend on, as plain values."""


@dataclass(frozen=True)
class Effort:
    """How long is searched."""

    samples: int = 64
    """Designs all over the range, to begin with."""
    parts: int = 6
    """Into which weights are divided: `parts` + 1 directions for two objectives."""
    generations: int = 12
    """In each direction."""
    population: int = 8
    """Designs in each generation."""
    seed: int = 0

    def __post_init__(self) -> None:
        for name, least in (("samples", 1), ("parts", 1), ("generations", 1), ("population", 4)):
            if getattr(self, name) < least:
                raise DesignError(f"{name} is {getattr(self, name)}; expected {least} or more")

    def evaluations(self, objectives: int) -> int:
        """The most designs that are looked at."""
        directions = len(weights(objectives, self.parts))
        return 1 + self.samples + directions * self.generations * self.population


@dataclass(frozen=True)
class Found:
    """What came of a search."""

    designs: tuple[Evaluation, ...]
    """All that were looked at, in the order of the search; the first is the robot itself."""
    front: tuple[Evaluation, ...]
    """Those that no other beats, by the first objective, the best first."""

    @property
    def own(self) -> Evaluation:
        """The robot itself, within the bounds."""
        return self.designs[0]

    def demand(self) -> Found:
        """Itself, if there is a front.

        Raises:
            DesignError: no design works; which limits stop them, and one of them where.
        """
        if self.front:
            return self
        nearest = min(self.designs, key=lambda one: one.shortfall)
        raise DesignError(
            f"none of {len(self.designs)} designs works; the nearest is off by {nearest.shortfall:.3g}: "
            f"{nearest.reason}; widen the bounds, or give another home pose"
        )


def search(
    problem: Judged,
    effort: Effort | None = None,
    *,
    workers: int | str = 1,
    log: Path | None = None,
    progress: Progress | None = None,
) -> Found:
    """The front of a problem.

    Args:
        problem: what is varied and how it is judged.
        effort: how long is searched.
        workers: processes that judge designs, or the address of a Dask scheduler; the results are the same.
        log: a file (JSON lines) of all designs; a search that was interrupted goes on there.
        progress: called after each generation.

    Raises:
        DesignError: a log of another search, or a number of workers below 1.
        WorkspaceError: no scheduler answers.
    """
    effort = effort or Effort()
    if isinstance(workers, int) and workers < 1:
        raise DesignError(f"{workers} workers; expected 1 or more")
    with _judge(problem, workers) as evaluate:
        return _Search(problem, effort, evaluate, _Log(log, problem, effort), progress).run()


class _Search:
    """Designs that were looked at, and how more of them are chosen."""

    def __init__(
        self, problem: Judged, effort: Effort, evaluate: Evaluate, log: _Log, progress: Progress | None
    ) -> None:
        self._problem, self._effort, self._evaluate, self._log = problem, effort, evaluate, log
        self._progress = progress
        self._most = effort.evaluations(len(problem.objectives))
        self._designs: dict[tuple[float, ...], Evaluation] = {}
        self._asked = 0

    def run(self) -> Found:
        """Everything."""
        problem, effort = self._problem, self._effort
        space = problem.space
        self._judge("samples", space.own[None])
        self._judge("samples", space.values(_spread(effort.samples, len(space.variables), effort.seed)))
        for number, weight in enumerate(weights(len(problem.objectives), effort.parts)):
            self._improve(number, weight)
        designs = tuple(self._designs.values())
        return Found(designs, front(designs, problem.objectives))

    def _judge(self, what: str, values: Floats) -> list[Evaluation]:
        """Designs (n, variables); those that are known are not judged again."""
        keys = [tuple(row) for row in values.tolist()]
        new = list(dict.fromkeys(key for key in keys if key not in self._designs))
        left = [key for key in new if key not in self._log.known]
        judged = dict(zip(left, self._evaluate(np.array(left)) if left else [], strict=True))
        for key in new:
            self._designs[key] = judged[key] if key in judged else self._log.known[key]
        self._log.put(judged.values())
        self._asked += len(keys)
        if self._progress is not None:
            self._progress(what, self._asked, self._most)
        return [self._designs[key] for key in keys]

    def _improve(self, number: int, weight: Floats) -> None:
        """CMA-ES in one direction, from the best design that is known for it."""
        space, effort = self._problem.space, self._effort
        designs = list(self._designs.values())
        cost = costs(designs, self._problem.objectives)
        ideal, nadir = _ends(cost)
        values = _value(designs, cost, ideal, nadir, weight)
        start = space.shares(designs[int(np.argmin(values))].values)
        source = np.random.default_rng([effort.seed, number + 1])
        strategy = _cma().CMAEvolutionStrategy(
            np.clip(start, 0.0, 1.0),
            0.15,
            {
                "bounds": [0.0, 1.0],
                "popsize": effort.population,
                "randn": lambda *shape: source.standard_normal(shape),
                "seed": np.nan,
                "verbose": -9,
            },
        )
        where = f"direction {number + 1}, weights {', '.join(f'{w:.2f}' for w in weight)}"
        for _ in range(effort.generations):
            asked = strategy.ask()
            judged = self._judge(where, space.values(np.array(asked)))
            cost = costs(judged, self._problem.objectives)
            strategy.tell(asked, _value(judged, cost, ideal, nadir, weight).tolist())


def _value(
    designs: Sequence[Evaluation], cost: Floats, ideal: Floats, nadir: Floats, weight: Floats
) -> Floats:
    """What is to be small in one direction; designs that do not work by how far they are from doing so."""
    works = np.asarray(np.isfinite(cost).all(axis=1))
    shortfall = np.array([design.shortfall for design in designs])
    some = chebyshev(np.where(works[:, None], cost, ideal), ideal, nadir, weight)
    return np.where(works, some, BEYOND + shortfall)


def _ends(cost: Floats) -> tuple[Floats, Floats]:
    """The best and the worst of each objective over the front that is known."""
    best = cost[non_dominated(cost)]
    if not len(best):
        zero = np.zeros(cost.shape[1])
        return zero, zero + 1
    return best.min(axis=0), best.max(axis=0)


def _spread(count: int, variables: int, seed: int) -> Floats:
    """Places (count, variables) all over the unit cube, evenly: Halton's, moved round by a random shift."""
    from scipy.stats import qmc

    places = qmc.Halton(variables, scramble=False).random(count)
    return np.asarray((places + np.random.default_rng([seed, 0]).random(variables)) % 1.0)


def _cma() -> Any:
    try:
        return import_module("cma")
    except ImportError as lacking:
        raise DesignError("the search needs cma: pip install 'krhpr[design]'") from lacking


# -- other processes -----------------------------------------------------------------------------------------


@contextmanager
def _judge(problem: Judged, workers: int | str) -> Iterator[Evaluate]:
    if isinstance(workers, str):
        with connected(workers) as client:
            # with the problem in every task, for what lies on one worker is lost with it
            yield lambda values: client.gather(
                client.map(problem.evaluate, list(values), retries=RETRIES, pure=False)
            )
        return
    if workers == 1:
        yield lambda values: [problem.evaluate(row) for row in values]
        return
    # a process of its own begins afresh: compiled kernels and threads do not survive being copied everywhere
    with ProcessPoolExecutor(workers, get_context("spawn")) as pool:
        yield lambda values: list(pool.map(problem.evaluate, values))


# -- the log -------------------------------------------------------------------------------------------------


class _Log:
    """A file with the settings in its first line, and a design in each other."""

    def __init__(self, path: Path | None, problem: Judged, effort: Effort) -> None:
        self._path = path
        self.known: dict[tuple[float, ...], Evaluation] = {}
        if path is None:
            return
        settings = json.loads(json.dumps({**problem.settings(), "seed": asdict(effort)["seed"]}))
        if path.exists() and path.stat().st_size:
            self._read(path, settings)
        else:
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(json.dumps(settings) + "\n", encoding="utf-8")

    def _read(self, path: Path, settings: dict[str, Any]) -> None:
        text = path.read_text(encoding="utf-8")
        whole, _, torn = text.rpartition("\n")
        lines = whole.split("\n")
        try:
            before = json.loads(lines[0])
            found = [Evaluation.from_json(json.loads(line)) for line in lines[1:]]
        except (ValueError, KeyError, TypeError) as problem:
            raise DesignError(
                f"{path}: no log of a search ({type(problem).__name__}); give a path where nothing is"
            ) from problem
        if before != settings:
            differ = [name for name in {**before, **settings} if before.get(name) != settings.get(name)]
            raise DesignError(
                f"{path}: the log is of another search: {', '.join(differ)} differ; remove it, or give "
                "another path"
            )
        self.known = {one.values: one for one in found}
        if torn:  # the last line was being written
            path.write_text(whole + "\n", encoding="utf-8")

    def put(self, judged: Any) -> None:
        """More designs."""
        lines = [json.dumps(one.as_json()) + "\n" for one in judged]
        if self._path is not None and lines:
            with self._path.open("a", encoding="utf-8") as file:
                file.writelines(lines)
