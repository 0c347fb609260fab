"""Fronts of Pareto: what no other design beats in everything."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from krhpr.design.evaluation import Evaluation
from krhpr.design.objectives import Objective

Floats = NDArray[np.float64]


def costs(found: Sequence[Evaluation], objectives: Sequence[Objective]) -> Floats:
    """Objectives (n, k) as numbers that are to be small; infinite where a design does not work."""
    rows = [
        [(-1 if one.more_is_better else 1) * design.results[one] for one in objectives]
        if design.works
        else [np.inf] * len(objectives)
        for design in found
    ]
    return np.array(rows, dtype=float).reshape(len(found), len(objectives))


def non_dominated(cost: Floats) -> NDArray[np.bool_]:
    """Rows (n, k) than which no other row is smaller somewhere and nowhere larger; of equal rows the first.
    Rows with a number that is not finite do not count."""
    kept = np.asarray(np.isfinite(cost).all(axis=1))
    for row in np.flatnonzero(kept):
        others = kept.copy()
        others[row] = False
        no_worse = (cost <= cost[row]).all(axis=1) & others
        better = no_worse & (cost < cost[row]).any(axis=1)
        equal_before = no_worse[:row] & (cost[:row] == cost[row]).all(axis=1)
        kept[row] = not (better.any() or equal_before.any())
    return kept


def front(found: Sequence[Evaluation], objectives: Sequence[Objective]) -> tuple[Evaluation, ...]:
    """The designs that no other beats, by the first objective, the best first."""
    cost = costs(found, objectives)
    chosen = np.flatnonzero(non_dominated(cost)).tolist()
    return tuple(found[k] for k in sorted(chosen, key=lambda k: tuple(cost[k])))


def weights(objectives: int, parts: int) -> Floats:
    """Directions (n, objectives) in which the front is looked for: all of whole `parts`, corners first."""
    if objectives == 1:
        return np.ones((1, 1))
    every = np.array([row for row in np.ndindex(*[parts + 1] * objectives) if sum(row) == parts]) / parts
    order = np.argsort(-every.max(axis=1), kind="stable")
    return np.asarray(every[order])


def chebyshev(cost: Floats, ideal: Floats, nadir: Floats, weight: Floats) -> Floats:
    """The largest weighted way (n,) from the best that there is of each objective, with a little of their
    sum, so that of several the one is least that no other beats."""
    span = np.where(nadir > ideal, nadir - ideal, 1.0)
    far = np.maximum(weight, 1e-3) * (cost - ideal) / span
    return np.asarray(far.max(axis=1) + 1e-3 * far.sum(axis=1))
