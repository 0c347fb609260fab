"""What a design is worth: its whole workspace on grids, its indices, and the cube that is proven."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from types import MappingProxyType
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from krhpr.branches import Branch
from krhpr.design.connected import connected, cut, largest_cube
from krhpr.design.objectives import Objective
from krhpr.design.variables import DesignSpace, requirement
from krhpr.errors import DesignError, WorkspaceError
from krhpr.robot import Robot
from krhpr.workspace import (
    Box,
    Certifier,
    Cube,
    Examiner,
    GridMap,
    Stop,
    TiltTorsion,
    Workspace,
    WorkspaceLimits,
    constant,
    run,
    steps,
    volume,
)
from krhpr.workspace.margins import LENGTH, LENGTHS

Floats = NDArray[np.float64]

REFUSED = 10.0
"""The shortfall of sizes that no robot file may have; more than that of a home pose out of reach or limit."""


@dataclass(frozen=True)
class Grid:
    """The nodes at which every design is looked at: the same for all of them."""

    across: float = 0.76
    """Largest |x| and |y| (m)."""
    heights: tuple[float, float] = (0.0, 0.84)
    """Least and largest z (m)."""
    step: float = 0.04
    """Of x, y and z (m)."""
    angle: float = np.pi / 12
    """Of torsion and direction; of tilt half as much (rad)."""
    balls: int = 6000
    """How many balls may be looked at to prove a cube."""

    def __post_init__(self) -> None:
        low, high = self.heights
        if not (0 < self.step <= min(self.across, high - low) and 0 < self.angle <= np.pi / 2):
            raise DesignError(
                f"the grid has steps of {self.step:g} m and {self.angle:g} rad over {self.across:g} m and "
                f"heights from {low:g} to {high:g} m; expected positive steps that fit in, and angles of "
                "pi / 2 at most"
            )

    def coarser(self, times: int) -> Grid:
        """With wider steps over the same range, and fewer balls."""
        step = min(self.step * times, self.across, self.heights[1] - self.heights[0])
        angle = min(self.angle * times, np.pi / 2)
        return Grid(self.across, self.heights, step, angle, max(1, self.balls // times**3))

    def finer(self, times: int) -> Grid:
        """With smaller steps over the same range, and more balls."""
        return Grid(self.across, self.heights, self.step / times, self.angle / times, self.balls * times**3)


@dataclass(frozen=True)
class Evaluation:
    """Of one design."""

    values: tuple[float, ...]
    """Of the variables."""
    shortfall: float
    """0 where the robot can be at home; else by how much it cannot (m over `LENGTH`, rad)."""
    reason: str = ""
    """Which limit is not kept at home, or why there is no such robot; empty where there is one."""
    results: Mapping[Objective, float] = field(default_factory=lambda: MappingProxyType({}))
    """Every objective; empty where the robot cannot be at home."""
    cube: Cube | None = None
    """The largest cube of positions."""
    proven: bool = False
    """Whether the cube is proven, and not checked at nodes alone."""
    cut: bool = False
    """Whether the workspace reaches the end of the grid, so that it is larger than is counted."""

    @property
    def works(self) -> bool:
        """Whether the robot can be at home."""
        return self.shortfall == 0.0

    def __reduce__(self) -> tuple[Any, ...]:
        rest = (self.cube, self.proven, self.cut)
        return _evaluation, (self.values, self.shortfall, self.reason, dict(self.results), *rest)

    def as_json(self) -> dict[str, Any]:
        """As plain values."""
        return {
            "values": list(self.values),
            "shortfall": self.shortfall,
            "reason": self.reason,
            "results": {str(name): value for name, value in self.results.items()},
            "cube": None if self.cube is None else asdict(self.cube),
            "proven": self.proven,
            "cut": self.cut,
        }

    @classmethod
    def from_json(cls, made: Mapping[str, Any]) -> Evaluation:
        """From plain values."""
        cube = made["cube"]
        return cls(
            tuple(made["values"]),
            made["shortfall"],
            made["reason"],
            MappingProxyType({Objective(name): value for name, value in made["results"].items()}),
            None if cube is None else Cube(tuple(cube["centre"]), cube["side"]),
            made["proven"],
            made["cut"],
        )


def _evaluation(*parts: Any) -> Evaluation:
    values, shortfall, reason, results, *rest = parts
    return Evaluation(values, shortfall, reason, MappingProxyType(results), *rest)


@dataclass(frozen=True)
class Problem:
    """What is varied, and by what it is judged."""

    space: DesignSpace
    objectives: tuple[Objective, ...]
    limits: WorkspaceLimits
    """Beside those of the robot's file."""
    grid: Grid = Grid()
    mode: Branch | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "objectives", tuple(Objective(one) for one in self.objectives))
        if not self.objectives or len(set(self.objectives)) < len(self.objectives):
            raise DesignError(
                f"the objectives are {', '.join(self.objectives) or 'none'}; expected one or more of "
                f"{', '.join(Objective)}, each once"
            )
        Examiner(self.space.robot, self.limits, mode=self.mode)  # a robot or a limit that cannot be used

    def evaluate(self, values: ArrayLike) -> Evaluation:
        """All that is told of a design; a function of the values alone."""
        values = np.asarray(values, dtype=float)
        robot = self.space.robot_of(values)
        own = tuple(values.tolist())
        why = requirement(robot)
        if why:
            return Evaluation(own, REFUSED, why)
        try:
            shortfall, why = self.at_home(robot)
        except WorkspaceError as problem:
            return Evaluation(own, REFUSED, str(problem))
        if shortfall > 0:
            return Evaluation(own, shortfall, why)
        return self.grid_of(robot, own)

    def grid_of(self, robot: Robot, values: tuple[float, ...], grid: Grid | None = None) -> Evaluation:
        """All objectives of a robot that can be at home."""
        grid = self.grid if grid is None else grid
        positions, orientations = self.positions(robot, grid), self.orientations(robot, grid)
        etas = np.concatenate([made["eta"][made.free] for made in (positions, orientations)])
        worst = np.where(np.isnan(etas), np.inf, etas).max(axis=0, initial=0.0).tolist()
        cube, proven = self.cube(robot, largest_cube(positions), grid)
        results = {
            Objective.VOLUME: volume(positions).value,
            Objective.ORIENTATIONS: volume(orientations).value,
            Objective.BOX: cube.side,
            Objective.ETA_1: worst[0],
            Objective.ETA_2: worst[1],
            Objective.ETA_3: worst[2],
            Objective.LENGTH: length(robot),
        }
        return Evaluation(
            values, 0.0, "", MappingProxyType(results), cube, proven, cut(positions, self.limits.lowest)
        )

    def positions(self, robot: Robot, grid: Grid | None = None) -> Workspace:
        """The grid of positions in the home orientation, as far as it is connected with the home pose."""
        grid = self.grid if grid is None else grid
        family = Box()
        low, high = grid.heights
        count = int(np.floor(grid.across / grid.step * (1 + 1e-12)))
        line = grid.step * np.arange(-count, count + 1)
        made = run(self._map(robot, family, family.axes(line, line, steps(low, high, grid.step))))
        return connected(made, robot.home.p)

    def orientations(self, robot: Robot, grid: Grid | None = None) -> Workspace:
        """The grid of orientations at the home position, as far as it is connected with the home pose."""
        grid = self.grid if grid is None else grid
        family = TiltTorsion(tuple(float(x) for x in robot.home.p))  # type: ignore[arg-type]
        half = max(2, round(np.pi / grid.angle))
        turns = np.pi * np.arange(-half, half + 1) / half
        tilts = np.pi * np.arange(2 * half + 1) / (2 * half)
        made = run(self._map(robot, family, family.axes(turns, turns + np.pi, tilts)))
        return connected(made, (0.0, 0.0, 0.0))

    def cube(self, robot: Robot, checked: Cube, grid: Grid) -> tuple[Cube, bool]:
        """The largest cube that is proven around the centre of one that was checked, and whether there is a
        proof for such robots; else the one that was checked."""
        examiner = Examiner(robot, self.limits, mode=self.mode)
        try:
            certifier = Certifier(examiner, robot.home.redundant)
        except WorkspaceError:
            return checked, False
        if not checked.side:
            return checked, True
        most = checked.side + grid.step
        return certifier.largest(checked.centre, most, share=0.05, balls=grid.balls), True

    def at_home(self, robot: Robot) -> tuple[float, str]:
        """(0, nothing), or by how much the home pose is out of reach or beyond a limit, and which one."""
        p, Q = np.array([robot.home.p]), np.eye(3)[None]
        redundant = np.array([robot.home.redundant])
        examiner = Examiner(robot, self.limits, mode=self.mode)
        found = examiner.examine(p, Q, redundant, thorough=True)
        if found.free[0]:
            return 0.0, ""
        what = examiner.name(int(found.stops[0]), int(found.which[0]))
        where = f"p = {p[0].round(4).tolist()}, redundant = {redundant[0].round(4).tolist()}"
        if found.stops[0] == Stop.REACH:
            _, excess = robot.inverse_status(p[0], Q[0], redundant[0], mode=self.mode)
            by = float(np.nansum(np.maximum(excess, 0.0)))
            return 1.0 + by / LENGTH, f"not at home ({where}): {what}, {by:.4g} m too far"
        margins = {stop: float(value[0]) for stop, value in found.values.items()}
        beyond = [-m / LENGTH if stop in LENGTHS else -m for stop, m in margins.items() if m < 0]
        stop = Stop(int(found.stops[0]))
        unit = " m" if stop in LENGTHS else "" if stop is Stop.TYPE_2 else " rad"
        why = f"not at home ({where}): {what}, by {-margins[stop]:.4g}{unit}"
        return min(max(beyond, default=1.0), 1.0), why

    def settings(self) -> dict[str, Any]:
        """Everything that results depend on, as plain values."""
        import krhpr

        robot, mode = self.space.robot, self.mode
        return {
            "version": krhpr.__version__,
            "robot": robot.name,
            "identifier": robot.identifier,
            "geometry": {name: list(map(float, v)) for name, v in robot.geometry.fields.items()},
            "home": [list(robot.home.p), list(robot.home.redundant)],
            "robot_limits": repr(robot.limits) if robot.limits else "",
            "limits": self.limits.settings(),
            "mode": robot.default_mode if mode is None else np.asarray(mode).tolist(),
            **self.space.settings(),
            "objectives": list(self.objectives),
            "grid": asdict(self.grid),
        }

    def _map(self, robot: Robot, family: Any, axes: Any) -> GridMap:
        redundancy = constant(robot.home.redundant)
        return GridMap(robot, self.limits, redundancy, family, axes, self.mode, with_indices=True)


def length(robot: Robot) -> float:
    """Of all links of the three legs and of the redundant links (m)."""
    names = {name for name, *_ in robot.links} | {robot.redundant_link}
    return float(sum(values.sum() for name, values in robot.geometry.fields.items() if name in names))
