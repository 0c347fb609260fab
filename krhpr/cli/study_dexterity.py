"""What `krhpr study dexterity` does: run, print, write."""

from __future__ import annotations

import argparse

import numpy as np

from krhpr.cli.common import Column, print_table, progress
from krhpr.cli.studying import tell, write
from krhpr.study.dexterity import Dexterity, dexterity
from krhpr.study.figures import dexterity_figures


def run(options: argparse.Namespace) -> int:
    """The example of Section 1.8."""
    with progress(2) as step:
        step("721 poses")
        found = dexterity()
        step("results")
        written = write(options.out, "dexterity", _facts(found), lambda: dexterity_figures(found))
    titles = [Column("leg", numeric=True)]
    titles += [Column(f"range of theta_{k + 1} (deg)", numeric=True) for k in range(3)]
    titles += [Column("least cond M", numeric=True), Column("largest", numeric=True)]
    rows = [
        (
            leg + 1,
            *np.degrees(found.ranges[leg]).tolist(),
            float(found.condition[:, leg].min()),
            float(found.condition[:, leg].max()),
        )
        for leg in range(3)
    ]
    print_table(titles, rows)
    code = tell(found.claims())
    print(", ".join(map(str, written)))
    return code


def _facts(found: Dexterity) -> dict[str, object]:
    return {
        "units": {"range": "rad", "condition": "1", "position": "m", "rotation": "1"},
        "range": found.ranges.tolist(),
        "condition": found.condition.tolist(),
        "condition_of_J_1": found.condition_of_all.tolist(),
        "position": found.position.tolist(),
        "rotation": found.rotation.tolist(),
    }
