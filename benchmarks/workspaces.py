"""How long workspaces take on one core: grids of more and more nodes, and the maps of Section 1.7.

The limits are those of Section 1.7 for the 3-[R(RR-RRR)SR] robot, 180 pairs of bodies among them.

    python -m benchmarks.workspaces 22 46 100 215 464

makes the grids alone, of so many values of each of three angles: here from 10^4 to 10^8 nodes.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass
from functools import partial
from typing import Any

import numpy as np

import krhpr
from krhpr import workspace

ROBOT = "spatial_r_fivebar_a"
BETA = np.radians(97)
SIDES = (22, 46, 100, 215)
"""Values of each of the three angles: 10^4 to 10^7 nodes in all."""
TORSION, TILT = (-110, 110), (0, 144)
"""In degrees: a whole grid with steps of one."""


@dataclass(frozen=True)
class Row:
    """One map."""

    what: str
    nodes: int
    """Of the map, whether they had to be looked at or not."""
    seconds: float
    """Of the process."""

    def as_json(self) -> dict[str, Any]:
        """For results.json."""
        return asdict(self)


def grids(sides: Sequence[int]) -> list[Row]:
    """Grids of orientations with so many values of each angle."""
    robot = krhpr.load(ROBOT, backend="compiled")
    rows = []
    for side in sides:
        job = _grid(
            robot, np.linspace(-2.5, 0.8, side), workspace.directions(side), np.linspace(0, 2.5, side)
        )
        rows.append(_timed("grid of orientations", job.nodes, partial(workspace.run, job)))
    return rows


def _grid(robot: krhpr.Robot, *values: Any) -> workspace.GridMap:
    family = workspace.TiltTorsion()
    limits, chosen = workspace.section_1_7(robot), workspace.constant(BETA)
    return workspace.GridMap(robot, limits, chosen, family, family.axes(*values))


def measure(sides: Sequence[int] = SIDES) -> list[Row]:
    """Every map once."""
    robot = krhpr.load(ROBOT, backend="compiled")
    rows = grids(sides)
    degree = np.pi / 180
    whole = _grid(
        robot,
        degree * np.arange(TORSION[0], TORSION[1] + 1),
        workspace.directions(360),
        degree * np.arange(TILT[0], TILT[1] + 1),
    )
    rows.append(_timed("whole grid, 1 degree", whole.nodes, partial(workspace.run, whole)))
    span = workspace.torsion(robot, redundancy=BETA)
    torsions = round(span.span / degree) + 1
    for tracing in ("bisect", "march"):
        rows.append(
            _timed(
                f"largest tilts, 1 degree, {tracing}",
                torsions * 360 * 181,
                partial(workspace.orientational, robot, redundancy=BETA, tracing=tracing),
            )
        )
        rows.append(
            _timed(
                f"layer z = 350 mm, 1 mm and 1 degree, {tracing}",
                360 * 1001,
                partial(
                    workspace.translational, robot, [0.35], redundancy=BETA, farthest=1.0, tracing=tracing
                ),
            )
        )
    return rows


def _timed(what: str, nodes: int, make: Callable[[], Any]) -> Row:
    begin = time.process_time()
    make()
    return Row(what, nodes, time.process_time() - begin)


def section(rows: Sequence[Row]) -> str:
    """A table of the report."""
    lines = [
        f"| {row.what} | {row.nodes:,} | {row.seconds:.2f} | {1e6 * row.seconds / row.nodes:.2f} |"
        for row in rows
    ]
    head = ["## Workspaces\n", "| Map | nodes | s | µs a node |", "|---|---:|---:|---:|"]
    return "\n".join([*head, *lines, ""])


if __name__ == "__main__":
    print(section(grids([int(side) for side in sys.argv[1:]])))
