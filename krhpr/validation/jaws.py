"""Random configurations of a grasping robot in doubles: well conditioned, and with an object between the
jaws.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from krhpr.validation.evaluation import CONDITION, Floats, Values, assemblies_of, evaluate
from krhpr.validation.subject import Subject

JAWS = 2


def turn(angle: Floats, vector: Floats) -> Floats:
    """Vectors (..., 2) turned by angles (...)."""
    c, s = np.cos(angle), np.sin(angle)
    return np.stack([c * vector[..., 0] - s * vector[..., 1], s * vector[..., 0] + c * vector[..., 1]], -1)


def draw_jaws(
    subject: Subject, rng: np.random.Generator, count: int, geometry: Mapping[str, Any]
) -> Values | None:
    """So many configurations of one geometry; None where they are too rare."""
    kept = _complete(subject, rng, _candidates(subject, rng, 8 * count + 40), geometry)
    if len(kept["pivot"]) < count:
        return None
    values = {name: array[:count] for name, array in kept.items()}
    values["length"] = np.broadcast_to(geometry["l_j"], (count, JAWS)).copy()
    return values | _forces(rng, count) | _objects(rng, values)


def _candidates(subject: Subject, rng: np.random.Generator, count: int) -> Values:
    """Poses about the home position, and random rates."""
    values = {
        "pivot": np.array(subject.entry.home.p) + rng.uniform(-0.02, 0.02, (count, 2)),
        "angles": np.array(subject.entry.home.redundant) + rng.uniform(-0.35, 0.35, (count, JAWS)),
    }
    for name, shape in (("pivot_rate", (2,)), ("angle_rates", (JAWS,)), ("theta_dot", (JAWS, 2))):
        values[name] = rng.uniform(-1, 1, (count, *shape))
    return values


def _complete(
    subject: Subject, rng: np.random.Generator, values: Values, geometry: Mapping[str, Any]
) -> Values:
    """What follows from the pose, in any working mode of each leg that is far from singularities."""
    values = {**values, **evaluate(subject, "end_points", values, geometry)}
    every = evaluate(subject, "inverse_all", values, geometry)["theta"]
    good, fit = np.isfinite(every).all(axis=(1, 2, 3)), []
    for mode in range(every.shape[2]):
        found = evaluate(subject, "singularity", {**values, "theta": every[:, :, mode]}, geometry)
        with np.errstate(invalid="ignore"):
            fit.append((np.abs(found["factors"]) > CONDITION).all(axis=2))
            good &= np.abs(found["sine"]) > CONDITION
    usable = np.stack(fit, axis=-1)  # (count, jaws, modes); sliders on one side of their joint are in line
    good &= usable.any(axis=-1).all(axis=-1)
    values = {name: array[good] for name, array in values.items()}
    every, usable, count = every[good], usable[good], int(good.sum())
    if not count:
        return values
    chosen = np.argmax(rng.random(usable.shape) * usable, axis=-1)
    values["theta"] = every[np.arange(count)[:, None], np.arange(JAWS)[None, :], chosen]
    values["mode"] = np.array(subject.code.mode_signs, dtype=float)[chosen]
    values["assembly"] = assemblies_of(subject, values, geometry)
    line, pivot = values["s"][:, 1] - values["s"][:, 0], values["pivot"] - values["s"][:, 0]
    values["side"] = np.sign(line[:, 0] * pivot[:, 1] - line[:, 1] * pivot[:, 0])
    return values


def _forces(rng: np.random.Generator, count: int) -> Values:
    """Forces of any size; statics are linear in them."""
    shapes: dict[str, tuple[int, ...]] = {
        "loads": (4,),
        "wrench": (3,),
        "internal_force": (),
        "actuator_forces": (JAWS, 2),
    }
    return {name: rng.uniform(-1, 1, (count, *shape)) for name, shape in shapes.items()}


def _objects(rng: np.random.Generator, values: Values) -> Values:
    """An object across the bisector of the jaws, of which one normal force is measured, and which weighs less
    than friction holds.
    """
    count, angles = len(values["pivot"]), values["angles"]
    along = np.stack([np.cos(angles), np.sin(angles)], -1).sum(axis=1)
    along /= np.linalg.norm(along, axis=-1, keepdims=True)
    across = np.stack([along[:, 1], -along[:, 0]], -1)
    sides = np.stack([across, -across], axis=1)  # to the right and to the left jaw
    touch = 0.0425 * along[:, None] + 0.02 * sides + rng.uniform(-0.005, 0.005, (count, JAWS, 2))
    inward = turn(-angles, -sides)
    measured = np.zeros((count, JAWS, 2))
    measured[np.arange(count), rng.integers(0, JAWS, count), 0] = 1.0
    return {
        "contacts": turn(-angles, touch),
        "faces": np.arctan2(inward[..., 1], inward[..., 0]) + rng.uniform(-0.1, 0.1, (count, JAWS)),
        "mass_centre": turn(-angles[:, 0], 0.0425 * along) + rng.uniform(-0.003, 0.003, (count, 2)),
        "weight": rng.uniform(-0.3, 0.3, (count, 2)),
        "sensor": measured,
        "measured_force": rng.uniform(1.5, 2.0, count),
        "friction": rng.uniform(20.0, 30.0, count),
    }
