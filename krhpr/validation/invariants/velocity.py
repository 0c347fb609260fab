"""Velocity and statics: virtual work, the velocity equation, and rates there and back."""

from __future__ import annotations

import numpy as np

from krhpr.codegen.kernel import LEGS
from krhpr.validation.differences import call
from krhpr.validation.invariants.batch import close, runner
from krhpr.validation.numeric import Numeric
from krhpr.validation.outcome import Measured, Runner
from krhpr.validation.sampling import Batch


def virtual_work(one: Numeric, batch: Batch, found: Measured) -> None:
    """F^T t = tau^T theta_dot with tau = K^T J^-T F."""
    rng = np.random.default_rng(len(batch))
    result = call(one, batch, "jacobians")
    rates = batch.values["theta_dot"].reshape(len(batch), -1)
    wrench = rng.uniform(-1, 1, batch.values["twist"].shape)
    force = np.linalg.solve(result["J"].swapaxes(-1, -2), wrench[..., None])
    torque = (result["K"].swapaxes(-1, -2) @ force)[..., 0]
    twist = call(one, batch, "twist")["twist"]
    scale = np.linalg.norm(torque, axis=-1) * np.linalg.norm(rates, axis=-1)
    gap = (wrench * twist).sum(axis=-1) - (torque * rates).sum(axis=-1)
    found.worse(np.abs(gap) / scale, "power")


def velocity_equation(one: Numeric, batch: Batch, found: Measured) -> None:
    """J t = K theta_dot with rates from joint_rates; K and its blocks."""
    result = call(one, batch, "jacobians")
    rates = call(one, batch, "joint_rates")["theta_dot"].reshape(len(batch), -1)
    left = (result["J"] @ batch.values["twist"][..., None])[..., 0]
    right = (result["K"] @ rates[..., None])[..., 0]
    scale = np.abs(result["K"]).max(axis=(-2, -1)) * np.abs(rates).max(axis=-1)
    found.worse(np.abs(left - right).max(axis=-1) / scale, "J t - K theta_dot")
    blocks = call(one, batch, "jacobian_blocks")["K"]
    rows, n = one.subject.platform.space.rows_per_leg, one.subject.subleg.n
    whole = np.zeros_like(result["K"])
    for leg in range(LEGS):
        block = blocks[:, leg].reshape(len(batch), rows, n)
        whole[:, rows * leg : rows * (leg + 1), n * leg : n * (leg + 1)] = block
    close(found, whole, result["K"], "K", 2)


def rates_and_twist(one: Numeric, batch: Batch, found: Measured) -> None:
    """twist after joint_rates."""
    rates = call(one, batch, "joint_rates")["theta_dot"]
    close(found, call(one, batch, "twist", theta_dot=rates)["twist"], batch.values["twist"], "twist", 1)


def accelerations(one: Numeric, batch: Batch, found: Measured) -> None:
    """platform_acceleration after joint_accelerations."""
    rates = call(one, batch, "joint_rates")["theta_dot"]
    second = call(one, batch, "joint_accelerations", theta_dot=rates)["theta_ddot"]
    got = call(one, batch, "platform_acceleration", theta_dot=rates, theta_ddot=second)["twist_rate"]
    scale = np.abs(second).max(axis=(-2, -1))[:, None]
    found.worse(np.abs(got - batch.values["twist_rate"]) / np.maximum(scale, 1.0), "twist_rate")


RUNNERS: dict[str, Runner] = {
    "virtual work": runner(virtual_work),
    "J t = K theta_dot": runner(velocity_equation),
    "rates and twist": runner(rates_and_twist),
    "accelerations": runner(accelerations),
}
