"""Section 4.2: what redundant angles, redundant links and the platform's size make of the workspace.

Three families of the 3-RRRSR robot, Figs. 4.1 and 4.2: the layer z = 350 mm and the tilts without torsion,
the way along x and the tilt about y', and the performance indices at the boundary. Which limits stop the
platform the section does not say; three readings are compared.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

import krhpr
from krhpr import workspace
from krhpr.design import REDUNDANT, DesignSpace, Tie, Variable
from krhpr.errors import WorkspaceError
from krhpr.robot import Robot
from krhpr.study.claims import Claim
from krhpr.workspace import (
    BoundaryMap,
    Family,
    Layers,
    TiltTorsion,
    Workspace,
    WorkspaceLimits,
    constant,
    directions,
    run,
    steps,
)

Floats = NDArray[np.float64]

ROBOT = "spatial_rrr_a"
DEGREE, MILLIMETRE = np.pi / 180, 1e-3
HEIGHT = 0.35
FEW, MANY = 64, 16
"""Steps between nodes that are looked at first: along one ray, where calls cost, and along many."""
FARTHEST = 0.9
"""Along x (m), beyond what any of the robots reaches."""

Step = Callable[[str, int, int], None]


@dataclass(frozen=True)
class Case:
    """A family of robots by one variable."""

    name: str
    variable: Variable
    unit: float
    """Radians or metres for one of the units of the pictures."""
    label: str
    step: float
    """Between robots of Fig. 4.2."""
    shown: tuple[float, ...]
    """Four magnitudes for Fig. 4.1, in the units of the pictures."""

    def values(self, coarser: int = 1) -> Floats:
        """Of the variable (rad or m)."""
        return steps(self.variable.low, self.variable.high, coarser * self.step)

    def robot(self, base: Robot, value: float) -> Robot:
        """One of them."""
        return DesignSpace(base, [self.variable]).robot_of([value])


CASES = (
    Case(
        "angles",
        Variable(REDUNDANT, 55 * DEGREE, 175 * DEGREE),
        DEGREE,
        r"$\beta_i$ (deg)",
        5 * DEGREE,
        (60, 97, 140, 175),
    ),
    Case("links", Variable("l_r", 0.05, 0.2), MILLIMETRE, r"$l_{i4}$ (mm)", 0.005, (50, 80, 120, 160)),
    Case(
        "platform",
        Variable("l_r", 0.05, 0.12, (Tie("R_p", 2.5),)),
        MILLIMETRE,
        r"$l_{i4}$ (mm), $R_p = 5\,l_{i4}/2$",
        0.005,
        (50, 60, 80, 100),
    ),
)
"""The three cases of Section 4.2.1."""


def readings_of(robot: Robot) -> dict[str, WorkspaceLimits]:
    """Which limits stop the platform: the text leaves the choice."""
    limits = workspace.section_1_7(robot)
    return {
        "all limits": limits,
        "spherical joints free": replace(limits, cone=None),
        "reach alone": WorkspaceLimits(lowest=0.0),
    }


ALL, FREE, REACH = "all limits", "spherical joints free", "reach alone"


@dataclass(frozen=True)
class Slice:
    """How far the platform goes in one direction, over the values of a family."""

    values: Floats
    """Of the variable (n,)."""
    boundary: Floats
    """Along x (m), or tilt (rad) (n,); NaN where the robot cannot be at home."""
    eta: Floats
    """eta_1 (m), eta_2, eta_3 there (n, 3)."""
    stops: tuple[str, ...]
    """What stops the platform."""

    def at(self, value: float) -> float:
        """The boundary at the value nearest to one."""
        return float(self.boundary[int(np.abs(self.values - value).argmin())])

    def index(self, number: int, value: float) -> float:
        """eta_1 to eta_3 at the value nearest to one."""
        return float(self.eta[int(np.abs(self.values - value).argmin()), number - 1])


@dataclass(frozen=True)
class Found:
    """Of one case under one reading."""

    along_x: Slice
    tilt: Slice
    layers: tuple[Workspace | None, ...]
    """The layer z = 350 mm for each magnitude shown; None where the robot cannot be at home."""
    tilts: tuple[Workspace | None, ...]
    """The tilts without torsion for each of them."""

    def areas(self) -> tuple[Floats, Floats]:
        """Of the layers (m^2) and of the tilts (rad^2), NaN where there are none."""
        every = [
            np.array([np.nan if made is None else workspace.areas(made)[0] for made in maps])
            for maps in (self.layers, self.tilts)
        ]
        return every[0], every[1]


@dataclass(frozen=True)
class Enlargement:
    """What Section 4.2 looks at."""

    robot: Robot
    found: dict[tuple[str, str], Found]
    """By case and reading."""

    def claims(self) -> tuple[Claim, ...]:
        """What the section says, with the reading of the limits under which it is so."""
        angles = {reading: self.found["angles", reading] for reading in (ALL, REACH)}
        reach = angles[REACH].along_x
        grows = reach.boundary[-1] / reach.boundary[0]
        turned = angles[ALL].tilt
        margin = float(self.robot.type_2_of_redundant(np.full(3, np.pi)).margins.min())
        eta_1, eta_3 = reach.eta[:, 0], reach.eta[:, 2]
        long = self.found["links", FREE]
        large = self.found["platform", ALL]
        sudden = [
            slice_.index(2, 175 * DEGREE) / slice_.index(2, 140 * DEGREE)
            for slice_ in (reach, angles[ALL].tilt)
        ]
        return (
            Claim(
                f"{REACH}: the way along x grows with beta, though not by much",
                bool((np.diff(reach.boundary) >= 0).all() and 1 < grows < 1.25),
            ),
            Claim(f"{REACH}: eta_1 is stable at the boundary", bool(eta_1.max() < 1.25 * eta_1.min())),
            Claim(f"{REACH}: eta_3 says that a type I singularity is near", bool(eta_3.min() > 50)),
            Claim(
                f"{ALL}: beta enlarges the tilt about y' significantly",
                turned.at(140 * DEGREE) > 1.5 * turned.at(60 * DEGREE),
            ),
            Claim("eta_2 increases abruptly as beta becomes large", min(sudden) > 4),
            Claim("at beta = 180 degrees the robot is singular (type II)", abs(margin) < 1e-12),
            Claim(
                f"{FREE}: redundant links of up to 160 mm enlarge both workspaces",
                all(
                    bool((np.diff(part.boundary[part.values < 0.161]) >= 0).all())
                    for part in (long.along_x, long.tilt)
                )
                and all(area[-1] > 1.1 * area[0] for area in long.areas()),
            ),
            Claim(
                f"{ALL}: a larger platform with longer links reduces both considerably",
                all(bool((np.diff(part.boundary) < 0).all()) for part in (large.along_x, large.tilt))
                and all(area[-1] < area[0] / 2 for area in large.areas()),
            ),
        )


def enlargement(
    robot: Robot | None = None, *, rays: int = 360, coarser: int = 1, progress: Step | None = None
) -> Enlargement:
    """Everything of Section 4.2.1 and Fig. 4.2, in steps of 1 mm and 1 degree.

    Args:
        robot: the 3-RRRSR robot unless given.
        rays: directions of the boundaries of Fig. 4.1.
        coarser: how many times wider the steps of Fig. 4.2 are than 5 degrees and 5 mm.
        progress: called after each case and reading.
    """
    base = krhpr.load(ROBOT) if robot is None else robot
    readings = readings_of(base)
    found: dict[tuple[str, str], Found] = {}
    for case in CASES:
        for reading, limits in readings.items():
            found[case.name, reading] = _found(base, case, limits, rays, coarser)
            if progress is not None:
                progress(f"Section 4.2, {case.name}", len(found), len(CASES) * len(readings))
    return Enlargement(base, found)


def _found(base: Robot, case: Case, limits: WorkspaceLimits, rays: int, coarser: int) -> Found:
    values = case.values(coarser)
    robots = [case.robot(base, value) for value in values]
    shown = [case.robot(base, value * case.unit) for value in case.shown]
    ways, tilts = Layers(), TiltTorsion((0.0, 0.0, HEIGHT))
    far, steep = steps(0.0, FARTHEST, MILLIMETRE), steps(0.0, np.pi, DEGREE)

    def maps(family: Family, along: Floats, first: float) -> Iterator[Workspace | None]:
        for robot in shown:
            yield _map(robot, limits, family, [first], directions(rays), along)

    return Found(
        _slice(robots, values, limits, ways, HEIGHT, 0.0, far),
        _slice(robots, values, limits, tilts, 0.0, np.pi / 2, steep),
        tuple(maps(ways, far, HEIGHT)),
        tuple(maps(tilts, steep, 0.0)),
    )


def _slice(
    robots: list[Robot],
    values: Floats,
    limits: WorkspaceLimits,
    family: Family,
    first: float,
    direction: float,
    along: Floats,
) -> Slice:
    boundary, eta, stops = np.full(len(robots), np.nan), np.full((len(robots), 3), np.nan), []
    for at, robot in enumerate(robots):
        made = _map(robot, limits, family, [first], [direction], along)
        if made is None:
            stops.append("not at home")
            continue
        boundary[at], eta[at] = made["boundary"][0, 0], made["eta"][0, 0]
        stops.append(made.job.examiner.name(int(made["stops"][0, 0]), int(made["which"][0, 0])))
    return Slice(values, boundary, eta, tuple(stops))


def _map(
    robot: Robot,
    limits: WorkspaceLimits,
    family: Family,
    first: list[float],
    second: list[float] | Floats,
    along: Floats,
) -> Workspace | None:
    """Boundaries with the indices; None where bodies collide at home."""
    redundancy = constant(robot.home.redundant)
    axes = family.axes(first, second, along)
    try:
        coarse = FEW if len(second) == 1 else MANY
        return run(BoundaryMap(robot, limits, redundancy, family, axes, with_indices=True, coarse=coarse))
    except WorkspaceError:
        return None
