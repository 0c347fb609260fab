"""What `krhpr study trajectory` does: run, print, write."""

from __future__ import annotations

import argparse

from krhpr.cli.common import Column, print_table, progress
from krhpr.cli.studying import tell, write
from krhpr.study.figures import redundancy_figures
from krhpr.study.redundancy import DEGREES, INDICES, OBJECTIVES, Redundancy, Sweep, redundancy


def run(options: argparse.Namespace) -> int:
    """The redundant angles of Section 4.3."""
    with progress(2 + 2 * len(OBJECTIVES)) as step:
        found = redundancy(step)
        step("results")
        written = write(options.out, "trajectory", _facts(found), lambda: redundancy_figures(found))
    columns = [Column(title, whole=True) for title in ("path", "objective", "method")]
    columns += [Column("integral", numeric=True), Column("limits"), Column("worst violation")]
    rows = [
        (
            path,
            f"{objective}^2",
            str(method),
            f"{one.integrals[f'{objective}^2']:.4f}",
            "met" if one.feasible else "not met",
            str(one.violations[0]) if one.violations else "",
        )
        for (path, objective), methods in found.compared.items()
        for method, one in methods.items()
    ]
    print_table(columns, rows)
    code = tell(found.claims())
    print(", ".join(map(str, written)))
    return code


def _facts(found: Redundancy) -> dict[str, object]:
    return {
        "units": {"x": "m", "tilt": "rad", "angles": "deg", "eta_1^2": "m^2 s", "eta_2^2": "s"},
        "translation": {"x": found.translation.place.tolist(), **_best(found.translation)},
        "rotation": {"tilt": found.tilt.place.tolist(), **_best(found.tilt)},
        "filtered": {name: values.tolist() for name, values in found.filtered.items()},
        "tried": DEGREES.tolist(),
        "compared": [
            {
                "path": path,
                "objective": objective,
                "method": str(method),
                "integrals": one.integrals,
                "feasible": one.feasible,
                "violations": [str(violation) for violation in one.violations],
            }
            for (path, objective), methods in found.compared.items()
            for method, one in methods.items()
        ],
    }


def _best(sweep: Sweep) -> dict[str, list[float]]:
    return {f"least {index}": sweep.best(index).tolist() for index in INDICES}
