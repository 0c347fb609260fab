"""What `krhpr study grasp-capability` does: the maps, print, write."""

from __future__ import annotations

import argparse

import numpy as np
from numpy.typing import NDArray

from krhpr.cli.common import Column, WrongUse, print_table, progress
from krhpr.cli.studying import tell, write
from krhpr.study.grasp import PROTOTYPE
from krhpr.study.grasp_capability import TURNS, CapabilityStudy, capability_study
from krhpr.study.grasp_capability_picture import picture

Floats = NDArray[np.float64]

EVERY = 3
"""Columns of the map for each row of the table."""


def run(options: argparse.Namespace) -> int:
    """What the prototype, or the robot of a file, can hold."""
    if not 0 <= options.torque < float("inf"):
        raise WrongUse(f"--torque is {options.torque:g}; it must be a number of N m that is not negative")
    if options.coarser < 1:
        raise WrongUse(f"--coarser is {options.coarser}; it must be 1 or more")
    setup = PROTOTYPE
    if options.file is not None:
        from krhpr.study.grasp_file import read_grasp_file  # takes the extra `files`

        setup = read_grasp_file(options.file)
    with progress(2) as step:
        step("maps")
        found = capability_study(setup, options.torque, TURNS[:: options.coarser])
        step("results")
        written = write(
            options.out, "grasp_capability", _facts(found), lambda: {"grasp_capability": picture(found)}
        )
    _print(found)
    pose = found.at_pose
    for what, extreme in (("least", pose.least), ("most", pose.most), ("moment", pose.strongest)):
        if extreme is not None:
            limits = "; ".join(map(str, extreme.stopped_by)) or "nothing"
            print(f"at the pose, {what}: {extreme.value:.4g} {'N m' if what == 'moment' else 'N'}: {limits}")
    for limit in pose.conflict:
        print(f"at the pose the object cannot be held: {limit}")
    code = tell(found.claims())
    print(", ".join(map(str, written)))
    return code


def _print(found: CapabilityStudy) -> None:
    columns = [Column("turn (deg)", numeric=True)]
    columns += [
        Column(title, numeric=True) for title in ("height (mm)", "least (N)", "most (N)", "moment (N m)")
    ]
    rows = []
    for column in range(0, len(found.turns), EVERY):
        ranges = (
            _range(values[:, column])
            for values in (1e3 * found.heights, found.made.least, found.made.most, found.moment)
        )
        rows.append((f"{np.degrees(found.turns[column]):.0f}", *ranges))
    print_table(columns, rows)


def _range(values: Floats) -> str:
    good = values[np.isfinite(values)]
    return f"{good.min():.3g} to {good.max():.3g}" if good.size else "-"


def _facts(found: CapabilityStudy) -> dict[str, object]:
    made = found.made
    return {
        "units": {"turns": "rad", "heights": "m", "least": "N", "most": "N", "moment": "N m"},
        "torque_Nm": found.torque,
        "turns": found.turns.tolist(),
        **{
            name: [[None if np.isnan(x) else x for x in row] for row in values.tolist()]
            for name, values in (
                ("heights", found.heights),
                ("least", made.least),
                ("most", made.most),
                ("moment", found.moment),
            )
        },
        "most_stopped_by": [[[str(limit) for limit in cell] for cell in row] for row in made.stopped_by],
    }
