"""Performance indices against singular value decompositions."""

from __future__ import annotations

import numpy as np

from krhpr.validation.differences import call
from krhpr.validation.invariants.batch import close, runner
from krhpr.validation.numeric import Floats, Numeric
from krhpr.validation.outcome import Measured, Runner
from krhpr.validation.sampling import Batch

ORDER = 16
"""Of the Schatten norms."""


def _singular_values(one: Numeric, batch: Batch) -> tuple[Floats, Floats, Floats]:
    """Of the position and the rotation part of U, and of the M_i (count, 3, d), slides over the length."""
    subleg = one.subject.subleg
    result, M = call(one, batch, "jacobians"), call(one, batch, "subleg_jacobian")["M"]
    prismatic = np.array([joint.kind == "prismatic" for joint in subleg.actuators])
    factors = np.where(prismatic, batch.values["characteristic_length"][:, None], 1.0)
    U = np.linalg.solve(result["J"], result["K"]) * np.tile(factors, 3)[:, None, :]
    d = subleg.space.dimension

    def values(matrix: Floats) -> Floats:
        return np.asarray(np.linalg.svd(matrix, compute_uv=False))

    return values(U[:, :d]), values(U[:, d:]), values(M * factors[:, None, None, :])


def indices(one: Numeric, batch: Batch, found: Measured) -> None:
    """2-norms and condition numbers."""
    result = call(one, batch, "indices")
    position, rotation, legs = _singular_values(one, batch)
    close(found, result["eta_1"], position[:, 0], "eta_1", 0)
    close(found, result["eta_2"], rotation[:, 0], "eta_2", 0)
    close(found, result["eta_3"], legs.max(axis=(1, 2)) / legs.min(axis=(1, 2)), "eta_3", 0)
    close(found, result["condition"], legs[..., 0] / legs[..., -1], "condition", 0)


def bounds(one: Numeric, batch: Batch, found: Measured) -> None:
    """Schatten norms, and where they lie."""
    result, exact = call(one, batch, "index_bounds"), call(one, batch, "indices")
    position, rotation, legs = _singular_values(one, batch)
    flat = legs.reshape(len(batch), -1)
    wanted = {
        "eta_1": _schatten(position),
        "eta_2": _schatten(rotation),
        "eta_3": _schatten(flat) * _schatten(1 / flat),
    }
    most = {"eta_1": 1.072, "eta_2": 1.072, "eta_3": 1.317}
    for name, value in wanted.items():
        close(found, result[name], value, name, 0)
        ratio = result[name] / exact[name]
        found.worse(((ratio < 1 - 1e-11) | (ratio > most[name])).astype(float), f"{name} is no bound")


def _schatten(values: Floats) -> Floats:
    return np.asarray((values**ORDER).sum(axis=-1) ** (1 / ORDER))


RUNNERS: dict[str, Runner] = {"indices": runner(indices), "bounds of the indices": runner(bounds)}
