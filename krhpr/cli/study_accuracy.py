"""What `krhpr study forward-accuracy` does: run, print, write."""

from __future__ import annotations

import argparse

import numpy as np

from krhpr.cli.common import Column, WrongUse, print_table, progress
from krhpr.cli.studying import tell, write
from krhpr.study.forward_accuracy import APPROACHES, LIMIT, Accuracy, Spread, forward_accuracy
from krhpr.study.histograms import Histogram, accuracy_figures, histograms


def run(options: argparse.Namespace) -> int:
    """The accuracy study."""
    if not options.bound > 0:
        raise WrongUse(f"--bound is {options.bound:g}; it must be positive")
    if options.repeat < 1:
        raise WrongUse(f"--repeat is {options.repeat}; it must be 1 or more")
    with progress(len(APPROACHES) + 3) as step:
        found = forward_accuracy(
            seed=options.seed,
            spread=Spread(options.errors),
            error=options.bound,
            repeat=options.repeat,
            progress=step,
        )
        step("results")
        tables = {one.name: _table(one) for one in histograms(found)}
        facts = {"seed": found.seed, "errors": found.spread, **tables}
        written = write(options.out, "accuracy", facts, lambda: accuracy_figures(found))
    _print(found)
    code = tell(found.claims())
    count = found.position.shape[1]
    beyond = found.beyond()
    others = [0, 1, 4, 5, 6]
    print(
        f"the thesis has no error of position above {1e3 * LIMIT:g} mm for approaches one, two, five to "
        f"seven; here the largest is {1e3 * found.position[others].max():.2f} mm, and the approach with most "
        f"has {int(beyond[others].max())} of {count} above"
    )
    print(", ".join(map(str, written)))
    return code


def _print(found: Accuracy) -> None:
    columns = [Column("approach", whole=True)]
    columns += [
        Column(title, numeric=True)
        for title in ("mean e_p (mm)", "95 %", "largest", "above 2.5 mm", "mean e_oc", "mean e_on")
    ]
    rows = []
    for number, name in enumerate(APPROACHES):
        p = 1e3 * found.position[number]
        rows.append(
            (
                name,
                f"{p.mean():.3f}",
                f"{np.quantile(p, 0.95):.2f}",
                f"{p.max():.2f}",
                int(found.beyond()[number]),
                f"{found.raw[number].mean():.4f}",
                f"{found.orthonormal[number].mean():.4f}",
            )
        )
    print_table(columns, rows)


def _table(one: Histogram) -> dict[str, object]:
    counts = {name: row.tolist() for name, row in zip(one.series, one.counts, strict=True)}
    return {"title": one.title, "unit": one.unit, "ranges": one.ranges, "counts": counts}
