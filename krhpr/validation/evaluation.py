"""The derivation on arrays: a robot's functions at a batch of configurations, in doubles."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from krhpr.validation.arithmetic import ARRAYS
from krhpr.validation.subject import Subject

Floats = NDArray[np.float64]
Values = dict[str, Floats]

CONDITION = 0.1
"""Dimensionless factors of determinants (sines, mostly) are at least this in the configurations drawn."""


def evaluate(
    subject: Subject, name: str, values: Mapping[str, Floats], geometry: Mapping[str, Any]
) -> Values:
    """A robot's function by the derivation, on a batch."""
    function = subject.code.function(name)
    count = len(next(iter(values.values())))
    inputs = {port.name: list(values[port.name].reshape(count, -1).T) for port in function.inputs}
    with np.errstate(all="ignore"):
        outputs = subject.function(function, inputs, geometry, ARRAYS)
    shapes = {port.name: port.full_shape for port in function.outputs}
    return {key: stack(parts, count).reshape((count, *shapes[key])) for key, parts in outputs.items()}


def stack(parts: list[Any], count: int) -> Floats:
    """Components, some of them perhaps constant, as the last axis of a batch."""
    return np.stack([np.broadcast_to(np.asarray(part, dtype=float), (count,)) for part in parts], axis=-1)


def assemblies_of(subject: Subject, values: Values, geometry: Mapping[str, Any]) -> Floats:
    """The assembly mode of each leg in which its joints lead to its end point."""
    assemblies = np.array(subject.code.assembly_signs, dtype=float)
    count = len(values["s"])
    errors = []
    for signs in assemblies:
        assembly = np.broadcast_to(signs, (count, subject.code.legs, len(signs)))
        s = evaluate(subject, "subleg_forward", {**values, "assembly": assembly}, geometry)["s"]
        errors.append(np.abs(s - values["s"]).max(axis=-1))
    best = np.nanargmin(np.where(np.isnan(errors), np.inf, errors), axis=0)
    chosen: Floats = assemblies[best]
    return chosen
