"""The workspaces of Section 1.7: Figs. 1.6 to 1.9, and what of their numbers comes out."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

import krhpr
from krhpr import workspace
from krhpr.robot import Robot
from krhpr.study.claims import Claim
from krhpr.study.convergence import STEPS, Refinement, convergence
from krhpr.workspace import Measure, Redundancy, Torsion, Workspace, WorkspaceLimits

Floats = NDArray[np.float64]

ROBOT = "spatial_r_fivebar_a"
BETA = float(np.radians(97))
HEIGHTS = np.arange(0.05, 0.6001, 0.05)
"""Of the layers, in metres: the thesis does not print its own."""
MILLIMETRE, DEGREE = 1e-3, np.pi / 180
FARTHEST = 1.0
COARSEST = 36
"""Times 1 mm and 1 degree: wider steps tell nothing."""
COARSE_STEP, COARSE_RAYS = 2 * DEGREE, 24
"""With these steps of tilt and directions the extremes are 144 and 116 degrees."""
PRINTED_SPAN = 220.0

Step = Callable[[str, int, int], None]
"""Called with what is made, the chunks that are there and those that there will be."""


@dataclass(frozen=True)
class Reading:
    """A reading of the body model, which the thesis does not print in full, and what follows from it."""

    name: str
    torsion: Torsion
    best: float
    worst: float
    """The largest tilt in the best and in the worst direction, without torsion (rad)."""


@dataclass(frozen=True)
class WorkspaceStudy:
    """The maps of Section 1.7 for one robot."""

    robot: Robot
    layers: Workspace
    """Boundaries of the layers, Figs. 1.6 and 1.7."""
    tilts: Workspace
    """The largest tilt at every torsion, Fig. 1.8."""
    level: Workspace
    """The same without torsion, Fig. 1.9."""
    readings: tuple[Reading, ...]
    """The first is the one of the maps."""
    refinements: tuple[Refinement, ...]
    """Both volumes by coarser and coarser maps."""

    def claims(self) -> tuple[Claim, ...]:
        """What Section 1.7 says of its robot; nothing of others."""
        if self.robot.identifier != ROBOT:
            return ()
        margins = self.robot.type_2_of_redundant(np.array(self.layers.job.redundancy.candidates)).margins
        low = self.layers["stops"][: len(HEIGHTS) // 3]
        first = self.readings[0]
        return (
            Claim("no singularity in the translational workspace", bool((margins > 0).all())),
            Claim(
                "its lower part is limited by the first axes",
                bool(
                    (low == workspace.Stop.AXIS).any()
                    and not (self.layers["stops"][-1] == workspace.Stop.AXIS).any()
                ),
            ),
            Claim("tilts of more than 135 degrees in some directions", first.best > 135 * DEGREE),
            Claim("tilts of more than 90 degrees in the worst", first.worst > 90 * DEGREE),
        )

    def volumes(self) -> tuple[Measure, Measure]:
        """Of the translational and of the orientational workspace."""
        return workspace.volume(self.layers), workspace.volume(self.tilts)


def readings_of(robot: Robot) -> dict[str, WorkspaceLimits]:
    """Body models between which the text leaves the choice."""
    limits = workspace.section_1_7(robot)
    return {
        "edges are links, spherical joints within 150 degrees": limits,
        "edges are links": replace(limits, cone=None),
        "spherical joints within 150 degrees": replace(limits, edges=False),
        "neither": replace(limits, cone=None, edges=False),
        "both, links of 7.5 mm that may touch": replace(limits, clearance=0.0),
        "both, links without thickness": replace(limits, clearance=0.0, radius=0.0),
        "edges are links, all 7.5 mm across": replace(limits, cone=None, radius=0.00375),
    }


def workspace_study(
    robot: Robot | None = None,
    *,
    coarser: int = 1,
    store: Path | None = None,
    workers: int | str = 1,
    progress: Step | None = None,
) -> WorkspaceStudy:
    """Every map of Section 1.7, with steps `coarser` times those of the thesis (1 mm and 1 degree).

    Args:
        robot: that of Section 1.7 unless given; its limits are those of the section.
        coarser: a divisor of 360.
        store: a folder in which maps are kept, so that an interrupted study goes on.
        workers: as for `workspace.run`.
        progress: called as maps are made.
    """
    one = krhpr.load(ROBOT) if robot is None else robot
    redundancy = _redundancy(one)
    step, rays = coarser * DEGREE, 360 // coarser

    def told(name: str) -> Callable[[int, int], None]:
        return lambda done, of: progress(name, done, of) if progress is not None else None

    def kept(name: str) -> Path | None:
        return None if store is None else store / f"{one.name}-{name}-{coarser}"

    limits = workspace.section_1_7(one)
    layers = workspace.translational(
        one,
        HEIGHTS,
        limits=limits,
        redundancy=redundancy,
        step=coarser * MILLIMETRE,
        rays=rays,
        farthest=FARTHEST,
        store=kept("layers"),
        workers=workers,
        progress=told("layers"),
    ).demand()
    tilts = workspace.orientational(
        one,
        limits=limits,
        redundancy=redundancy,
        step=step,
        rays=rays,
        store=kept("tilts"),
        workers=workers,
        progress=told("tilts"),
    ).demand()
    level = workspace.orientational(
        one, limits=limits, redundancy=redundancy, torsions=[0.0], step=step, rays=rays
    )
    found = []
    models = readings_of(one)
    for number, (name, limits) in enumerate(models.items()):
        told("readings of the bodies")(number, len(models))
        found.append(_reading(one, name, limits))
    told("readings of the bodies")(len(models), len(models))
    wider = [coarser * n for n in STEPS if 360 % (coarser * n) == 0 and coarser * n <= COARSEST]
    refined = convergence(
        one, models[next(iter(models))], redundancy, times=wider, progress=told("volumes by wider steps")
    )
    return WorkspaceStudy(one, layers, tilts, level, tuple(found), refined)


def _redundancy(robot: Robot) -> Redundancy:
    """The thesis' angles, or where redundant coordinates slide those of the home pose."""
    slides = robot.signature("end_points").inputs[2].unit != "rad"
    return workspace.constant(robot.home.redundant if slides else BETA)


def _reading(robot: Robot, name: str, limits: WorkspaceLimits) -> Reading:
    redundancy = _redundancy(robot)
    span = workspace.torsion(robot, limits=limits, redundancy=redundancy)
    tilt = workspace.orientational(
        robot, limits=limits, redundancy=redundancy, torsions=[0.0], step=COARSE_STEP, rays=COARSE_RAYS
    )["boundary"]
    return Reading(name, span, float(tilt.max()), float(tilt.min()))
