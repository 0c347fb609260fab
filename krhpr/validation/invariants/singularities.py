"""Singularities: determinants, margins, and what is said where a robot is singular."""

from __future__ import annotations

import numpy as np

from krhpr.codegen.kernel import LEGS
from krhpr.codegen.status import Status
from krhpr.validation.differences import call
from krhpr.validation.evaluation import evaluate
from krhpr.validation.invariants.batch import close, runner
from krhpr.validation.numeric import Floats, Numeric
from krhpr.validation.outcome import Measured, Runner
from krhpr.validation.sampling import Batch, redundant_box
from krhpr.validation.subject import Subject


def determinants(one: Numeric, batch: Batch, found: Measured) -> None:
    """Determinants of the matrices, relative to the product of their rows' lengths (Hadamard)."""
    result = call(one, batch, "singularity")
    M = call(one, batch, "subleg_jacobian")["M"]
    J = call(one, batch, "jacobians")["J"]
    for name, matrix, value in (("det M", M, result["type_1"]), ("det J", J, result["type_2"].prod(axis=-1))):
        bound = np.linalg.norm(matrix, axis=-1).prod(axis=-1)
        found.worse(np.abs(_determinant(matrix) - value) / bound, name)


def _determinant(matrix: Floats) -> Floats:
    """det M, or sqrt(det(M M^T)), the product of the singular values, for redundant legs."""
    if matrix.shape[-2] == matrix.shape[-1]:
        return np.asarray(np.linalg.det(matrix))
    return np.asarray(np.linalg.svd(matrix, compute_uv=False).prod(axis=-1))


def margins(one: Numeric, batch: Batch, found: Measured) -> None:
    """Positive over nearly the whole box, for the default platform and unequal redundant coordinates."""
    rng = np.random.default_rng(len(batch))
    redundant = redundant_box(one.subject, rng, len(batch), wide=True)
    inputs = {**batch.values, "redundant": redundant}
    code = one.subject.code

    def run(name: str) -> dict[str, Floats]:
        return one.call(name, {port.name: inputs[port.name] for port in code.function(name).inputs})

    inputs["s"] = run("end_points")["s"]
    found.worse((run("singularity")["margins"] <= 0).astype(float), "a margin is not positive")


def type_2_of_redundant(one: Numeric, batch: Batch, found: Measured) -> None:
    """Without a pose the same as with one."""
    result, wanted = call(one, batch, "type_2_of_redundant"), call(one, batch, "singularity")
    for name in ("type_2", "margins"):
        close(found, result[name], wanted[name], name, 0)


STRAIGHT = {"subleg_rrr": 2, "subleg_planar_rr": 1}
"""Sub-legs that are singular where one joint is zero, and that joint."""


def singular_configurations(one: Numeric, batch: Batch, found: Measured) -> None:
    """A straight leg; redundant coordinates at which the platform's lines, or the end points, are
    dependent.
    """
    joint = STRAIGHT.get(one.subject.code.subleg.name)
    for leg in range(LEGS) if joint is not None else ():
        theta = batch.values["theta"].copy()
        theta[:, leg, joint] = 0.0
        values = {"theta": theta, "s": call(one, batch, "subleg_forward", theta=theta)["s"]}
        for name in ("joint_rates", "joint_accelerations"):
            result = call(one, batch, name, **values)
            rates = result["theta_dot" if name == "joint_rates" else "theta_ddot"]
            wrong = result["status"] != int(Status.SINGULAR_LEG_1) + leg
            missing = np.isnan(rates).any(axis=-1) != (np.arange(LEGS) == leg)
            found.worse(
                (wrong | missing.any(axis=-1)).astype(float), f"{name} where leg {leg + 1} is straight"
            )
    for status, redundant in singular_platforms(one.subject, batch):
        values = {"redundant": np.broadcast_to(redundant, (len(batch), LEGS))}
        values["s"] = call(one, batch, "end_points", **values)["s"]
        for name in ("twist", "platform_acceleration"):
            result = call(one, batch, name, **values)
            answer = result["twist" if name == "twist" else "twist_rate"]
            wrong = (result["status"] != int(status)) | ~np.isnan(answer).all(axis=-1)
            found.worse(wrong.astype(float), f"{name} where {status.name}")


def singular_platforms(subject: Subject, batch: Batch) -> list[tuple[Status, Floats]]:
    """Redundant coordinates of type II singularities: links through O'; slides of which the third makes a
    factor of det J vanish.
    """
    if subject.platform.redundant_joint.kind == "revolute":
        return [(Status.SINGULAR_IN_PLANE, np.full(LEGS, np.pi))]
    found = [(Status.SINGULAR_IN_PLANE, _zero(subject, batch, 0, 0.1, -0.03))]
    if not subject.planar:
        found.append((Status.SINGULAR_NORMAL, _zero(subject, batch, 1, 0.1, 0.02)))
    return found


def _zero(subject: Subject, batch: Batch, factor: int, first: float, second: float) -> Floats:
    """Slides, two of them given, at which a factor of det J vanishes; it is affine in the third."""
    trial = np.array([[first, second, 0.0], [first, second, 0.1]])
    values = {"p": np.zeros((2, 1)), "redundant": trial}
    at = evaluate(subject, "type_2_of_redundant", values, batch.geometry)["type_2"][:, factor]
    return np.array([first, second, -0.1 * at[0] / (at[1] - at[0])])


RUNNERS: dict[str, Runner] = {
    "determinants": runner(determinants),
    "margins": runner(margins),
    "type II of the redundant coordinates": runner(type_2_of_redundant),
    "singular configurations": runner(singular_configurations),
}
