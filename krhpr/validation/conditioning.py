"""How much rounding a problem magnifies, whoever solves it.

The forward kinematics loses digits near singularities: there, end points that differ by rounding belong to
poses that differ by much more.  No code can do better, so that its errors are measured against this.
"""

from __future__ import annotations

import numpy as np

from krhpr.codegen.composition import RobotFunction
from krhpr.validation.check import Target
from krhpr.validation.numeric import Floats, target
from krhpr.validation.sampling import Batch
from krhpr.validation.scale import relative

STEP = 1e-7
"""How far inputs are moved, relative to the largest element of each."""

DIRECTIONS = 3
"""How many times, in random directions."""

MEASURED = ("s", "theta", "measured", "p_near", "Q_near", "phi_near")
"""Inputs that are known with errors."""

SURE = 0.97
"""The share of configurations that must not be next to ones with other solutions."""


def solves(function: RobotFunction) -> bool:
    """Whether a function solves for a pose, so that its errors are those of its condition."""
    return function.name.startswith(("forward", "subleg_forward_all")) or bool(function.steps)


def condition(function: RobotFunction, batch: Batch, seed: int) -> Floats:
    """The growth of relative errors of the inputs of a function that solves, for each configuration.

    At least one; infinite where inputs moved by `STEP` have no answer, or another number of answers.
    """
    if not solves(function):
        return np.ones(len(batch))
    one, rng = target(batch.subject, Target.NUMPY), np.random.default_rng(seed)
    here = one.call(function.name, batch.of(function), batch.geometry)
    found = np.ones(len(batch))
    for _ in range(DIRECTIONS):
        moved = batch.changed(**{name: _moved(rng, batch.values[name]) for name in _solved(function)})
        there = one.call(function.name, moved.of(function), batch.geometry)
        for port in function.outputs:
            error = relative(port, there[port.name], here[port.name]).reshape(len(batch), -1).max(axis=1)
            found = np.maximum(found, np.where(np.isnan(error), np.inf, error) / STEP)
    return found


def _solved(function: RobotFunction) -> list[str]:
    """The inputs that are measured; signs that choose among solutions are exact."""
    return [port.name for port in function.inputs if port.name in MEASURED]


def _moved(rng: np.random.Generator, values: Floats) -> Floats:
    size = np.abs(values).reshape(len(values), -1).max(axis=1)
    step: Floats = STEP * size.reshape(-1, *[1] * (values.ndim - 1)) * rng.uniform(-1, 1, values.shape)
    return values + step
