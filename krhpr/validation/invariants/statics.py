"""Statics of generated functions: virtual work, the transposed Jacobian, there and back."""

from __future__ import annotations

import numpy as np

from krhpr.codegen.kernel import LEGS
from krhpr.codegen.status import Status
from krhpr.validation.differences import call
from krhpr.validation.invariants.batch import close, runner
from krhpr.validation.invariants.singularities import STRAIGHT, singular_platforms
from krhpr.validation.numeric import Floats, Numeric
from krhpr.validation.outcome import Measured, Runner
from krhpr.validation.sampling import Batch

WORKS_ON = {"wrench": "twist", "redundant_forces": "redundant_rates", "swivel_forces": "swivel_rates"}
"""Forces, and the velocities on which they do work."""


def _power(force: Floats, rate: Floats) -> Floats:
    count = len(force)
    return np.asarray((force.reshape(count, -1) * rate.reshape(count, -1)).sum(axis=-1))


def virtual_work(one: Numeric, batch: Batch, found: Measured) -> None:
    """F^T t + phi^T rates = f^T theta_dot, and f = K^T J^-T F where the wrench alone acts."""
    forces = call(one, batch, "inverse_statics")["actuator_forces"]
    rates = call(one, batch, "joint_rates")["theta_dot"]
    acting = [
        port.name for port in one.subject.code.function("inverse_statics").inputs if port.name in WORKS_ON
    ]
    power = sum(_power(batch.values[name], batch.values[WORKS_ON[name]]) for name in acting)
    size = np.linalg.norm(forces, axis=(1, 2)) * np.linalg.norm(rates, axis=(1, 2))
    found.worse(np.abs(_power(forces, rates) - power) / size, "power")
    nothing = {name: np.zeros_like(batch.values[name]) for name in acting if name != "wrench"}
    alone = call(one, batch, "inverse_statics", **nothing)["actuator_forces"]
    result = call(one, batch, "jacobians")
    along = np.linalg.solve(result["J"].swapaxes(-1, -2), batch.values["wrench"][..., None])
    wanted = (result["K"].swapaxes(-1, -2) @ along).reshape(alone.shape)
    close(found, alone, wanted, "f = (J^-1 K)^T F", 2)


def non_redundant(one: Numeric, batch: Batch, found: Measured) -> None:
    """J_n [t, redundant rates, swivel rates] = K_n theta_dot, and f = (J_n^-1 K_n)^T F_n."""
    result = call(one, batch, "jacobians_n")
    rates = call(one, batch, "joint_rates")["theta_dot"].reshape(len(batch), -1)
    names = [name for name in WORKS_ON if WORKS_ON[name] != "swivel_rates" or one.subject.subleg.redundant]
    moving = np.concatenate([batch.values[WORKS_ON[name]] for name in names], axis=-1)
    left = (result["J"] @ moving[..., None])[..., 0]
    right = (result["K"] @ rates[..., None])[..., 0]
    scale = np.abs(result["K"]).max(axis=(-2, -1)) * np.abs(rates).max(axis=-1)
    found.worse(np.abs(left - right).max(axis=-1) / scale, "J_n t_n - K_n theta_dot")
    acting = np.concatenate([batch.values[name] for name in names], axis=-1)
    along = np.linalg.solve(result["J"].swapaxes(-1, -2), acting[..., None])
    forces = call(one, batch, "inverse_statics")["actuator_forces"]
    wanted = (result["K"].swapaxes(-1, -2) @ along).reshape(forces.shape)
    close(found, forces, wanted, "f = (J_n^-1 K_n)^T F_n", 2)


def there_and_back(one: Numeric, batch: Batch, found: Measured) -> None:
    """forward_statics after inverse_statics, relative to the largest of all forces."""
    forces = call(one, batch, "inverse_statics")["actuator_forces"]
    result = call(one, batch, "forward_statics", actuator_forces=forces)
    scale = np.abs(forces).max(axis=(1, 2))[:, None]
    for port in one.subject.code.function("forward_statics").outputs:
        gap = np.abs(result[port.name] - batch.values[port.name])
        found.worse(gap / np.maximum(scale, 1.0), port.name)


def singular_configurations(one: Numeric, batch: Batch, found: Measured) -> None:
    """A straight leg gives no force at its end point but moves the others' not; a platform that is singular
    bears no wrench.
    """
    joint = STRAIGHT.get(one.subject.code.subleg.name)
    for leg in range(LEGS) if joint is not None else ():
        theta = batch.values["theta"].copy()
        theta[:, leg, joint] = 0.0
        s = call(one, batch, "subleg_forward", theta=theta)["s"]
        result = call(one, batch, "forward_statics", theta=theta, s=s)
        wrong = result["status"] != int(Status.SINGULAR_LEG_1) + leg
        missing = np.isnan(result["redundant_forces"]) != (np.arange(LEGS) == leg)
        lost = np.isnan(result["wrench"]).all(axis=-1)
        found.worse((wrong | missing.any(axis=-1) | ~lost).astype(float), f"where leg {leg + 1} is straight")
    for status, redundant in singular_platforms(one.subject, batch):
        values = {"redundant": np.broadcast_to(redundant, (len(batch), LEGS))}
        values["s"] = call(one, batch, "end_points", **values)["s"]
        result = call(one, batch, "inverse_statics", **values)
        lost = np.isnan(result["actuator_forces"]).all(axis=(1, 2))
        wrong = (result["status"] != int(status)) | ~lost
        found.worse(wrong.astype(float), f"where {status.name}")


def opening(one: Numeric, batch: Batch, found: Measured) -> None:
    """opening after redundant_of_opening."""
    slides = call(one, batch, "redundant_of_opening")["redundant"]
    result = call(one, batch, "opening", redundant=slides)
    for name in ("opening", "centre"):
        gap = np.abs(result[name] - batch.values[name])
        found.worse(gap.reshape(len(batch), -1) / np.abs(slides).max(axis=1)[:, None], name)
    found.worse((result["shares"] <= 0).astype(float), "jaws on one side")


def grasp(one: Numeric, batch: Batch, found: Measured) -> None:
    """The object's equilibrium in the base frame, with the jaw frames from where end points move."""
    v, d = batch.values, batch.values["p"].shape[-1]
    result = call(one, batch, "grasp")
    Q = (
        v["Q"]
        if d == 3
        else np.stack(
            [np.cos(v["phi"]), -np.sin(v["phi"]), np.sin(v["phi"]), np.cos(v["phi"])], axis=-1
        ).reshape(-1, 2, 2)
    )
    slides = (
        call(one, batch, "end_points", redundant=v["redundant"] + 1.0)["s"]
        - call(one, batch, "end_points")["s"]
    )
    if d == 3:
        z = np.broadcast_to(Q[:, None, :, 2], slides.shape)
        frames = np.stack([-slides, np.cross(z, -slides), z], axis=-1)
    else:
        across = np.stack([slides[..., 1], -slides[..., 0]], axis=-1)
        frames = np.stack([-slides, across], axis=-1)
    forces = (frames @ result["contact_forces"][..., None])[..., 0]
    arms = (v["contacts"] - v["mass_centre"][:, None]) @ Q.swapaxes(-1, -2)
    size = np.abs(forces).max(axis=(1, 2))[:, None]
    found.worse(np.abs(forces.sum(axis=1) + v["weight"]) / size, "forces")
    moments = np.cross(arms, forces) if d == 3 else _planar_cross(arms, forces)[..., None]
    found.worse(np.abs(moments.sum(axis=1)) / (size * np.abs(arms).max()), "moments")
    found.worse(np.abs(result["wrench"][:, :d] + v["weight"]) / size, "wrench")


def _planar_cross(a: Floats, b: Floats) -> Floats:
    return np.asarray(a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0])


RUNNERS: dict[str, Runner] = {
    "virtual work of actuators": runner(virtual_work),
    "non-redundant view": runner(non_redundant),
    "statics there and back": runner(there_and_back),
    "opening": runner(opening),
    "grasp": runner(grasp),
    "singular statics": runner(singular_configurations),
}
