"""What `krhpr study workspace` does: make the maps of Section 1.7, print, write."""

from __future__ import annotations

import argparse
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

import krhpr
from krhpr.cli.common import Column, Step, WrongUse, print_table, progress
from krhpr.cli.studying import tell, write
from krhpr.study.workspace import PRINTED_SPAN, ROBOT, WorkspaceStudy, workspace_study
from krhpr.study.workspace_pictures import workspace_figures

TENTHS = 10
"""Progress is told so often for each map."""


def run(options: argparse.Namespace) -> int:
    """The workspace study."""
    if options.coarser < 1 or 360 % options.coarser:
        raise WrongUse(f"--coarser is {options.coarser}; it must be a divisor of 360")
    robot = krhpr.load(options.robot or ROBOT)
    with progress(4 * (TENTHS + 1)) as step:
        found = workspace_study(
            robot,
            coarser=options.coarser,
            store=options.store,
            workers=options.workers,
            progress=_tenths(step),
        )
    written = write(options.out, "workspace", _facts(found), lambda: workspace_figures(found))
    _print(found)
    code = tell(found.claims())
    print(", ".join(map(str, written)))
    return code


def _tenths(step: Step) -> Callable[[str, int, int], None]:
    """Tells a step whenever another tenth of a map is there."""
    told = set()

    def tell(name: str, done: int, of: int) -> None:
        at = (name, TENTHS * done // max(of, 1))
        if at not in told:
            told.add(at)
            step(f"{name}: {done} of {of}")

    return tell


def _print(found: WorkspaceStudy) -> None:
    columns = [Column("bodies and joints", whole=True)]
    columns += [
        Column(title, numeric=True) for title in ("torsion (deg)", "from", "to", "tilt, best", "tilt, worst")
    ]
    rows = [
        (
            one.name,
            *(f"{np.degrees(x):.0f}" for x in (one.torsion.span, one.torsion.low, one.torsion.high)),
            f"{np.degrees(one.best):.0f}",
            f"{np.degrees(one.worst):.0f}",
        )
        for one in found.readings
    ]
    print_table(columns, rows)
    wider = [Column(title, numeric=True) for title in ("steps (mm, deg)", "positions", "orientations")]
    print()
    print_table(wider, [(one.times, one.positions, one.orientations) for one in found.refinements])
    print()
    translations, orientations = found.volumes()
    level = np.degrees(found.level["boundary"])
    print(f"translational workspace: {translations}")
    print(f"orientational workspace: {orientations}")
    print(
        f"tilt without torsion: {level.min():.0f} to {level.max():.0f} degrees over {level.size} directions"
    )
    print(f"the thesis prints a torsion span of {PRINTED_SPAN:g} degrees, without the details of its bodies")


def _facts(found: WorkspaceStudy) -> dict[str, object]:
    translations, orientations = found.volumes()
    return {
        "settings": found.layers.job.settings(),
        "readings": [
            {
                "name": one.name,
                "torsion": [one.torsion.low, one.torsion.high],
                "stopped_by": [one.torsion.stopped_low, one.torsion.stopped_high],
                "tilt": [one.worst, one.best],
            }
            for one in found.readings
        ],
        "translational_volume_m3": [translations.value, translations.error],
        "share_of_all_orientations": [orientations.value, orientations.error],
        "by_wider_steps": [
            {
                "steps_mm_deg": one.times,
                "volume_m3": [one.positions.value, one.positions.error],
                "share_of_all_orientations": [one.orientations.value, one.orientations.error],
            }
            for one in found.refinements
        ],
        "heights_m": found.layers.axis("h").tolist(),
        "layers_m": _rows(found.layers["boundary"]),
        "tilt_without_torsion": found.level["boundary"][0].tolist(),
    }


def _rows(values: NDArray[np.float64]) -> list[list[float | None]]:
    """Numbers as JSON has them: no NaN."""
    return [[None if np.isnan(x) else float(x) for x in row] for row in values]
