"""Agreement: targets against one another, and each against the derivation to more than fifty digits."""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np

from krhpr.codegen.composition import RobotFunction
from krhpr.validation.arithmetic import BALLS
from krhpr.validation.check import Check, Target
from krhpr.validation.conditioning import SURE, condition
from krhpr.validation.exact import derivation, in_balls
from krhpr.validation.numbers import Ball, ball_precision
from krhpr.validation.numeric import Floats, Numeric, target
from krhpr.validation.outcome import Measured, Runner
from krhpr.validation.sampling import Batch, draw
from krhpr.validation.scale import relative, worst_of
from krhpr.validation.subject import Subject


def arguments(subject: Subject, check: Check, function: RobotFunction, count: int) -> Batch:
    """Consistent configurations; beside them for errors and residuals, which cancel there."""
    batch = draw(subject, check.seed, count)
    beside = {"constraints": "s", "rotation_error": "Q"}.get(function.name)
    if beside is None:
        return batch
    values = batch.values[beside]
    rng = np.random.default_rng(check.seed)
    return batch.changed(**{beside: values + rng.uniform(-0.03, 0.03, values.shape)})


def against_numpy(subject: Subject, check: Check, count: int) -> Measured:
    """A target and the NumPy module; where they part, the fifty digits say which one is off."""
    function = subject.code.function(check.function)
    batch = arguments(subject, check, function, count)
    one, other = target(subject, check.target), target(subject, Target.NUMPY)
    results = [which.call(function.name, batch.of(function), batch.geometry) for which in (one, other)]
    growth = condition(function, batch, check.seed)
    sure = np.isfinite(growth)
    found = Measured(check, samples=int(sure.sum()))
    for port in function.outputs:
        errors = relative(port, results[0][port.name], results[1][port.name]).reshape(len(batch), -1)
        error, index = worst_of(np.where(sure[:, None], errors / growth[:, None], 0.0))
        found.worse(error, partial(_blame, batch, function, index, port.name, (one, other), check))
    found.worse(float(sure.mean() < SURE), "too many configurations without a condition")
    if "status" in results[0]:
        apart = (results[0]["status"] != results[1]["status"]) & sure
        found.worse(apart.astype(float), "the statuses differ")
    return found


def _blame(
    batch: Batch, function: RobotFunction, index: int, name: str, pair: tuple[Numeric, Numeric], check: Check
) -> str:
    """Where two targets differ, and how far each is from the derivation."""
    text = f"{name} at sample {index} (seed {check.seed})"
    if batch.subject.code.finds_roots(function):
        return text
    truth = true_values(batch, function, index)
    port = next(port for port in function.outputs if port.name == name)
    for which, label in zip(pair, (check.target, Target.NUMPY), strict=True):
        values = {key: array[index : index + 1] for key, array in batch.of(function).items()}
        got = which.call(function.name, values, batch.geometry)[name]
        error, _ = worst_of(relative(port, got, truth[name][None]))
        text += f"; {label} is {error:.1e} from the derivation"
    return text


def true_values(batch: Batch, function: RobotFunction, index: int) -> dict[str, Floats]:
    """The derivation at one configuration, in 300-bit balls, rounded to doubles at the end."""
    geometry = {name: [Ball(value) for value in values] for name, values in batch.geometry.items()}
    with ball_precision():
        results = derivation(batch.subject, function, in_balls(batch, function, index), geometry, BALLS)
    shapes = {port.name: port.full_shape for port in function.outputs}
    return {
        name: np.array([_double(x) for x in values]).reshape(shapes[name]) for name, values in results.items()
    }


def _double(value: Any) -> float:
    return value.to_float() if isinstance(value, Ball) else float(value)


def error_of_doubles(subject: Subject, check: Check, count: int) -> Measured:
    """A target against the derivation to fifty digits."""
    function = subject.code.function(check.function)
    batch = arguments(subject, check, function, count)
    results = target(subject, check.target).call(function.name, batch.of(function), batch.geometry)
    growth = condition(function, batch, check.seed)
    found = Measured(check, samples=len(batch))
    for index in range(len(batch)):
        truth = true_values(batch, function, index)
        for port in function.outputs:
            error = relative(port, results[port.name][index][None], truth[port.name][None]) / growth[index]
            found.worse(error, f"{port.name} at sample {index} (seed {check.seed})")
    return found


RUNNERS: dict[str, Runner] = {"against NumPy": against_numpy, "error of doubles": error_of_doubles}
"""The code of each check by its name in the plan."""
