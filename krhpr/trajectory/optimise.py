"""Choose the redundant coordinates along a path: the thesis' methods, and an NLP that is better than they
are."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from enum import StrEnum
from time import perf_counter
from typing import Any

import numpy as np
from numpy.typing import NDArray

from krhpr.branches import Branch
from krhpr.robot import Robot
from krhpr.trajectory import baselines
from krhpr.trajectory.clearance import kept_apart
from krhpr.trajectory.compiled import Evaluation
from krhpr.trajectory.examine import Coordinates, Examined, Violation
from krhpr.trajectory.fastest import FastestRounds
from krhpr.trajectory.following import Following
from krhpr.trajectory.paths import Path, PathError
from krhpr.trajectory.point import PointFunctions
from krhpr.trajectory.reach import check_path, signs_at_start
from krhpr.trajectory.refusals import UnknownObjective
from krhpr.trajectory.rounds import Found, Judged, Rounds, Task
from krhpr.trajectory.terms import Bounds, Objective
from krhpr.trajectory.timing import Retimed, check_timing
from krhpr.trajectory.transcription import Solved

Floats = NDArray[np.float64]

INTERVALS = 30
"""Of the spline, unless told."""


class Method(StrEnum):
    """How redundant coordinates are chosen."""

    NLP = "nlp"
    """Each leg's by itself, by the nonlinear programme."""
    CONSTANT = "constant"
    """Equal and constant: the value given, or the best one on the grid."""
    SCAN = "scan"
    """Section 4.3: at each time the equal value on the grid (whole degrees) with the least objective."""
    ONE = "one"
    """Method one of Section 4.3: the same over a reduced range, given by `reduced`."""
    TWO = "two"
    """Method two of Section 4.3: the scan smoothed exponentially with the factor `alpha`, (4.2) corrected."""
    RECEDING = "receding"
    """The programme over the next seconds alone, again and again: `RecedingHorizon` along the path."""


@dataclass(frozen=True)
class Trajectory:
    """Redundant coordinates and joints along a path, with what was asked for and what came of it."""

    robot: Robot
    path: Path | Retimed
    """With the timing that was chosen, where the objective has the duration."""
    method: Method
    objective: Objective
    bounds: Bounds
    examined: Examined
    """The trajectory on a grid ten times finer than the spline, with its violations."""
    coordinates: Coordinates
    """Redundant coordinates as a function of time."""
    seconds: float
    """What it took."""
    iterations: int
    """Of IPOPT, in all rounds."""
    rounds: int
    """How often the programme was solved."""
    message: str
    """IPOPT's last word; empty for other methods."""
    solved: Solved | None = None

    @property
    def found(self) -> Found:
        """The same as the rounds of a programme begin with it."""
        made = Found(Judged(self.examined, self.coordinates, self.path))
        made.solved = self.solved
        return made

    @property
    def duration(self) -> float:
        """What it takes, s."""
        return float(self.times[-1] - self.times[0])

    @property
    def feasible(self) -> bool:
        """Whether all limits are met; if not it is the least infeasible trajectory that was found."""
        return self.examined.feasible

    @property
    def violations(self) -> tuple[Violation, ...]:
        """Limits that are not met, the worst first."""
        return self.examined.violations

    @property
    def integrals(self) -> dict[str, float]:
        """Over time, of eta_1^2 (m^2 s), eta_2^2 (s), log eta_3 (s) and what else the objective has."""
        return self.examined.integrals

    @property
    def maxima(self) -> dict[str, float]:
        """The largest eta_1 (m), eta_2 and eta_3."""
        return self.examined.maxima

    @property
    def times(self) -> Floats:
        """Of the grid (n), s."""
        return self.examined.motion.times

    @property
    def redundant(self) -> Floats:
        """Redundant coordinates (n, 3), rad or m."""
        return self.examined.redundant

    @property
    def swivel(self) -> Floats | None:
        """Swivels of redundant sub-legs (n, 3), rad, where they were chosen."""
        return self.examined.swivel

    @property
    def theta(self) -> Floats:
        """Actuated joints (n, 3, actuators) without jumps of full turns, rad or m."""
        return self.examined.theta

    def report(self) -> str:
        """In words: whether limits are met, and if not which, where and by how much."""
        head = f"{self.path.name}, {self.robot.name}, method {self.method}"
        if self.objective.time:
            head += f", {self.duration:.6g} s"
        values = ", ".join(f"integral of {name} {value:.6g}" for name, value in self.integrals.items())
        if self.feasible:
            return f"{head}: all limits met; {values}"
        lines = [f"{head}: NOT feasible, the least infeasible trajectory found; {values}"]
        return "\n".join([*lines, *(f"  {one}" for one in self.violations)])


def optimise(
    robot: Robot,
    path: Path,
    objective: Objective | str | Mapping[str, Any],
    bounds: Bounds,
    *,
    method: Method | str = Method.NLP,
    mode: Branch | None = None,
    characteristic_length: float = 1.0,
    intervals: int = INTERVALS,
    start: Trajectory | None = None,
    constant: float | None = None,
    reduced: tuple[float, float] | None = None,
    alpha: float = 0.2,
    horizon: float | None = None,
    progress: Callable[[str], None] = lambda step: None,
    solver: Mapping[str, Any] | None = None,
    evaluation: Evaluation | str = Evaluation.SX,
) -> Trajectory:
    """Choose the redundant coordinates of a robot along a path.

    Args:
        robot: any with an inverse in closed form; redundant sub-legs stand at a swivel of zero where
            `bounds.swivel` does not say that swivels are chosen as well.
        path: of its platform.
        objective: what to minimise: "eta_1", "eta_2", "eta_3" (integrals of eta_1^2, eta_2^2, log eta_3),
            another term of `Objective`, weights by these names, or an `Objective`.  The programme minimises
            smooth bounds of the indices; what is reported are the indices.
        bounds: limits to keep; those of the robot's file are kept as well.
        method: the programme, or the same over a receding horizon, or one of the thesis' methods, which do
            not look at limits.
        mode: the working mode, as `inverse` takes it; it is kept where `bounds.factors` say so.
        characteristic_length: of `indices`, m.
        intervals: of the spline, or steps of the thesis' methods.
        start: a trajectory of the same robot and as many intervals, from which the programme begins in place
            of the global search.
        constant: the value for `Method.CONSTANT`, rad or m; the best one unless given.
        reduced: the range for `Method.ONE`, rad or m.
        alpha: the smoothing factor for `Method.TWO`.
        horizon: how far to look ahead for `Method.RECEDING`, s, in whole intervals, four at least;
            a third of the path unless given.
        progress: is told what begins.
        solver: further options of IPOPT.
        evaluation: "compiled" makes C of the programme's functions, which takes seconds once and pays where
            many trajectories of one robot with the same limits and objective are wanted.

    Returns:
        The trajectory; where limits cannot be met, the least infeasible one found, with `feasible` false and
        its `violations`.

    Raises:
        PathError: a planar path for a spatial robot, or the other way round.
        LeavesWorkspace: where and which leg, and by what distance.
        ContradictoryLimits, UnknownObjective, NoClosedForm: what cannot be asked for.
        NoCompiler: there is none to compile with.
    """
    begin = perf_counter()
    wanted, how = Objective.of(objective), Method(method)
    bounds = bounds.of(robot)
    wanted.check(robot)
    if intervals < 2:
        raise PathError(f"{intervals} intervals; a trajectory takes two or more")
    if wanted.time:
        if how is not Method.NLP:
            raise UnknownObjective(f"method {how} chooses no timing; {Method.NLP} makes the duration least")
        check_timing(path, bounds)
    progress("workspace")
    check_path(robot, path, bounds, mode)
    point = PointFunctions(
        robot,
        wanted,
        bounds,
        signs_at_start(robot, path, bounds, mode),
        mode=mode,
        characteristic_length=characteristic_length,
        evaluation=Evaluation(evaluation),
    )
    task = Task(point, path, intervals, kept_apart(robot, bounds))
    message = None
    if how is Method.RECEDING:
        following = Following(task, horizon, mode, Evaluation(evaluation), dict(solver or {}), progress)
        found, message = following.run()
    elif how is not Method.NLP:
        progress(f"method {how}")
        found = Found(task.judged(_baseline(task, how, constant, reduced, alpha)))
    elif wanted.time:
        found = FastestRounds(task, progress, dict(solver or {})).run(None if start is None else start.found)
    else:
        found = Rounds(task, progress, dict(solver or {})).run(None if start is None else start.found)
    return Trajectory(
        robot,
        found.best.path,
        how,
        wanted,
        bounds,
        found.best.examined,
        found.best.coordinates,
        perf_counter() - begin,
        found.iterations,
        found.rounds,
        message or (found.solved.message if found.solved else ""),
        found.solved,
    )


def _baseline(
    task: Task, how: Method, constant: float | None, reduced: tuple[float, float] | None, alpha: float
) -> Coordinates:
    point, path, times = task.point, task.path, task.grid(1)
    if how is Method.CONSTANT:
        return baselines.constant(point, path, times, constant)
    if how is Method.SCAN:
        return baselines.scan(point, path, times)
    if how is Method.ONE:
        return baselines.scan(point, path, times, reduced or baselines.REDUCED)
    return baselines.smoothed(baselines.scan(point, path, times), alpha)
