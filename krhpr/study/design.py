"""Beyond Section 4.2: designs judged by their whole workspaces, and the best of them as robot files."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from krhpr import workspace
from krhpr.design import (
    HEIGHT,
    REDUNDANT,
    DesignSpace,
    Effort,
    Evaluation,
    Found,
    Grid,
    Objective,
    Problem,
    Tie,
    Variable,
    best,
    search,
    write_design,
)
from krhpr.errors import DesignError, nearest
from krhpr.robot import Robot

Step = Callable[[str, int, int], None]

OBJECTIVES = (Objective.VOLUME, Objective.ETA_2, Objective.BOX)
EFFORT = Effort(samples=64, parts=4, generations=8, population=8)
FINER = 2
"""How many times finer the grids are on which the best designs are looked at again, with more balls."""
REACH = 0.75
"""Of the legs of the 3-RRRSR robot, l_2 + l_3 (m), which is kept."""


@dataclass(frozen=True)
class Chosen:
    """A design of the front that is best in one objective."""

    name: str
    """Of its robot file."""
    design: Evaluation
    finer: Evaluation
    """The same on finer grids."""


@dataclass(frozen=True)
class DesignStudy:
    """The search and the best designs."""

    problem: Problem
    found: Found
    own: Chosen
    """The robot itself, on the same finer grids."""
    chosen: tuple[Chosen, ...]
    """The best in each objective, and one between them."""

    def write(self, folder: Path) -> list[Path]:
        """The best designs as robot files; the numbers in their remarks are those of the finer grids."""
        return [write_design(folder, self.problem, one.finer, one.name) for one in self.chosen]


def default_variables(robot: Robot) -> tuple[Variable, ...]:
    """What is varied of a robot unless told: its platform, its base and, of RRR sub-legs, how their length is
    divided."""
    turns = robot.signature("end_points").inputs[2].unit == "rad"
    fields = robot.geometry.fields
    home = float(robot.home.p[-1])
    angle = np.radians
    wished = {
        "l_r": (0.03, 0.15, ()),
        "R_p": (0.08, 0.25, ()),
        "alpha": (float(angle(90)), float(angle(180)), ()),
    }
    found = [Variable(REDUNDANT, float(angle(40)), float(angle(170)))] if turns else []
    found += [Variable(name, *bounds) for name, bounds in wished.items() if name in fields]
    if robot.identifier.startswith("spatial_rrr"):
        found.append(Variable("l_2", 0.2, 0.55, (Tie("l_3", -1.0, REACH),)))
    return (*found, Variable(HEIGHT, round(0.6 * home, 3), round(1.4 * home, 3)))


def variables_from(text: str) -> tuple[Variable, ...]:
    """Variables as people write them: `redundant=0.7:3,l_r=0.03:0.15`, metres and radians.

    Raises:
        DesignError: a part that is none.
    """
    found = []
    for part in text.split(","):
        name, _, bounds = part.strip().partition("=")
        low, _, high = bounds.partition(":")
        try:
            found.append(Variable(name.strip(), float(low), float(high)))
        except ValueError as problem:
            raise DesignError(
                f"{part.strip()!r} is no variable; expected NAME=LOW:HIGH in metres or radians, such as "
                "l_r=0.03:0.15"
            ) from problem
    return tuple(found)


def objectives_from(text: str) -> tuple[Objective, ...]:
    """Objectives by their names: `volume,eta_2`.

    Raises:
        DesignError: a name of none.
    """
    found = []
    for name in (part.strip() for part in text.split(",")):
        if name not in list(Objective):
            raise DesignError(f"there is no objective {name!r}; {nearest(name, list(Objective))}")
        found.append(Objective(name))
    return tuple(found)


def problem_of(
    robot: Robot,
    variables: Sequence[Variable] = (),
    objectives: Sequence[Objective] = OBJECTIVES,
    grid: Grid | None = None,
) -> Problem:
    """A robot within the limits of its file, or of Section 1.7 where it has none.

    Args:
        robot: in space, with an inverse in closed form.
        variables: those of `default_variables` unless given.
        objectives: of `Objective`.
        grid: at which nodes designs are looked at.

    Raises:
        DesignError: what is varied cannot be used.
        WorkspaceError: a robot for which there are no workspaces.
    """
    limits = workspace.WorkspaceLimits(lowest=0.0) if robot.limits else workspace.section_1_7(robot)
    workspace.Examiner(robot, limits)  # a robot that has no workspaces has no height to vary either
    space = DesignSpace(robot, tuple(variables) or default_variables(robot))
    return Problem(space, tuple(objectives), limits, grid or Grid())


def design_study(
    problem: Problem,
    effort: Effort = EFFORT,
    *,
    workers: int | str = 1,
    log: Path | None = None,
    progress: Step | None = None,
) -> DesignStudy:
    """Search the designs, and look at the best again.

    Args:
        problem: of `problem_of`.
        effort: how long is searched.
        workers: processes that judge designs, or the address of a Dask scheduler.
        log: as for `krhpr.design.search`.
        progress: called as designs are judged.

    Raises:
        DesignError: no design works.
        WorkspaceError: no scheduler answers.
    """
    found = search(problem, effort, workers=workers, log=log, progress=progress).demand()
    names = {f"best_{one}": best(found.front, one) for one in problem.objectives}
    if len(problem.objectives) > 1:
        names["between"] = between(found.front, problem.objectives)
    chosen = []
    for number, (name, one) in enumerate(names.items()):
        if progress is not None:
            progress("the best on finer grids", number, len(names))
        chosen.append(_again(problem, name, one))
    return DesignStudy(problem, found, _again(problem, "own", found.own), tuple(chosen))


def between(front: Sequence[Evaluation], objectives: Sequence[Objective]) -> Evaluation:
    """The design of a front that is nearest to the best of every objective, each over its range."""
    values = np.array([[one.results[name] for name in objectives] for one in front])
    good = np.where([name.more_is_better for name in objectives], values.max(axis=0), values.min(axis=0))
    span = np.ptp(values, axis=0)
    away = np.abs(values - good) / np.where(span > 0, span, 1.0)
    return front[int(np.argmin(away.max(axis=1)))]


def _again(problem: Problem, name: str, design: Evaluation) -> Chosen:
    """A design on finer grids, the cube proven with more balls."""
    if not design.works:
        return Chosen(name, design, design)
    robot = problem.space.robot_of(design.values)
    finer = problem.grid_of(robot, design.values, problem.grid.finer(FINER))
    return Chosen(name, design, finer)
