"""Finite differences: every function that is a derivative against difference quotients of the functions
it derives.

Only generated functions of one target take part, at random configurations of a random
geometry.  Differences of joints are taken along the smaller arc.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from krhpr.validation.check import Check
from krhpr.validation.evaluation import CONDITION
from krhpr.validation.numeric import Floats, Numeric, target
from krhpr.validation.outcome import Measured, Runner
from krhpr.validation.sampling import Batch, draw, rotations
from krhpr.validation.subject import Subject

STEP = 5e-6
"""Metres, radians or seconds.  Truncation is (STEP / distance to a singularity)^6, rounding 1e-16 / STEP."""
SECOND_STEP = 1e-4

Body = Callable[[Numeric, Batch, Measured], None]


def runner(body: Body) -> Runner:
    """A check of one target on a batch."""

    def run(subject: Subject, check: Check, count: int) -> Measured:
        found = Measured(check, samples=count)
        body(target(subject, check.target), draw(subject, check.seed, count), found)
        return found

    return run


def compare(found: Measured, got: Floats, wanted: Floats, where: str, axes: int) -> None:
    """The error relative to the largest element of the last `axes` axes."""
    over = tuple(range(-axes, 0))
    scale = np.abs(wanted).max(axis=over, keepdims=True)
    found.worse(np.abs(got - wanted) / scale, where)


def arc(after: Floats, before: Floats, angular: tuple[bool, ...]) -> Floats:
    """after - before, for angles along the smaller arc."""
    gap = after - before
    turned = np.arctan2(np.sin(gap), np.cos(gap))
    result: Floats = np.where(np.array(angular), turned, gap)
    return result


def call(one: Numeric, batch: Batch, name: str, **values: Any) -> dict[str, Floats]:
    """A function of the target at the batch, some arguments changed."""
    function = one.subject.code.function(name)
    everything: Mapping[str, Any] = {**batch.values, **values}
    return one.call(name, {port.name: everything[port.name] for port in function.inputs}, batch.geometry)


def quotient(
    values: Callable[[float], Floats], gap: Callable[[Floats, Floats], Floats] = np.subtract
) -> Floats:
    """The derivative at zero by central differences of sixth order."""
    first, second, third = (gap(values(k * STEP), values(-k * STEP)) for k in (1, 2, 3))
    result: Floats = (45 * first - 9 * second + third) / (60 * STEP)
    return result


def second_quotient(values: Callable[[float], Floats], gap: Callable[[Floats, Floats], Floats]) -> Floats:
    """The second derivative at zero by central differences of sixth order."""
    h, here = SECOND_STEP, values(0.0)
    first, second, third = (gap(values(k * h), here) - gap(here, values(-k * h)) for k in (1, 2, 3))
    result: Floats = (270 * first - 27 * second + 2 * third) / (180 * h**2)
    return result


# -- motions ---------------------------------------------------------------------------------------


def moved(batch: Batch, twist: Floats, time: float, acceleration: Floats | None = None) -> dict[str, Floats]:
    """The pose after `time` along a motion that starts with this twist and its rate."""
    path = twist * time if acceleration is None else twist * time + 0.5 * acceleration * time**2
    d = batch.subject.platform.space.dimension
    p = batch.values["p"] + path[..., :d]
    if batch.subject.planar:
        return {"p": p, "phi": batch.values["phi"] + path[..., d]}
    return {"p": p, "Q": rotations(path[..., d:]) @ batch.values["Q"]}


def along(one: Numeric, batch: Batch, time: float) -> dict[str, Floats]:
    """Pose, redundant coordinates, end points, joints and rates after `time` along the batch's motion."""
    v = batch.values
    here = moved(batch, v["twist"], time, v["twist_rate"])
    redundant = v["redundant"] + v["redundant_rates"] * time + 0.5 * v["redundant_accelerations"] * time**2
    here |= {
        "redundant": redundant,
        "swivel": v["swivel"] + v["swivel_rates"] * time + 0.5 * v["swivel_accelerations"] * time**2,
        "swivel_rates": v["swivel_rates"] + v["swivel_accelerations"] * time,
        "twist": v["twist"] + v["twist_rate"] * time,
        "redundant_rates": v["redundant_rates"] + v["redundant_accelerations"] * time,
    }
    here["s"] = call(one, batch, "end_points", **here)["s"]
    here["theta"] = call(one, batch, "inverse", **here)["theta"]
    return here


def joint_rates(one: Numeric, batch: Batch, time: float) -> Floats:
    """joint_rates after `time` along the batch's motion."""
    return call(one, batch, "joint_rates", **along(one, batch, time))["theta_dot"]


def joints(one: Numeric, batch: Batch) -> Callable[[float], Floats]:
    """inverse along the batch's motion."""
    return lambda time: along(one, batch, time)["theta"]


def by_arc(one: Numeric) -> Callable[[Floats, Floats], Floats]:
    """Differences of joints, along the smaller arc."""
    return lambda after, before: arc(after, before, one.subject.code.angular)


def differenced_rates(one: Numeric, batch: Batch) -> Floats:
    """Difference quotients of inverse along the motion."""
    return quotient(joints(one, batch), by_arc(one))


def differenced_accelerations(one: Numeric, batch: Batch) -> Floats:
    """Difference quotients of joint_rates along the motion."""
    return quotient(lambda time: joint_rates(one, batch, time))


# -- checks ----------------------------------------------------------------------------------------


def _bumped(values: Floats, index: int, step: float) -> Floats:
    """A leg-wise array with one component of every leg moved."""
    result = values.copy()
    result[..., index] += step
    return result


def m_of_forward(one: Numeric, batch: Batch, found: Measured) -> None:
    """M, column by column, in the assembly mode of each leg."""
    M = call(one, batch, "subleg_jacobian")["M"]
    theta = batch.values["theta"]
    for joint in range(one.subject.subleg.n):

        def end(step: float, joint: int = joint) -> Floats:
            return call(one, batch, "subleg_forward", theta=_bumped(theta, joint, step))["s"]

        scale = np.abs(M).max(axis=(-2, -1))[..., None]
        found.worse(np.abs(quotient(end) - M[..., joint]) / scale, f"column {joint}")


def m_of_inverse(one: Numeric, batch: Batch, found: Measured) -> None:
    """M dtheta/ds = 1 in every working mode."""
    s, n = batch.values["s"], one.subject.subleg.n
    every = call(one, batch, "subleg_inverse")["theta"]
    for mode in range(every.shape[2]):
        M = call(one, batch, "subleg_jacobian", theta=every[:, :, mode])["M"]
        columns = []
        for axis in range(s.shape[-1]):

            def found_joints(step: float, axis: int = axis, mode: int = mode) -> Floats:
                return call(one, batch, "subleg_inverse", s=_bumped(s, axis, step))["theta"][:, :, mode]

            columns.append(quotient(found_joints, by_arc(one)))
        slope = np.stack(columns, axis=-1)
        scale = np.abs(M).max(axis=(-2, -1)) * np.abs(slope).max(axis=(-2, -1)) * n
        gap = np.abs(M @ slope - np.eye(s.shape[-1])).max(axis=(-2, -1))
        fit = batch.values["fit"][:, :, mode]
        found.worse(np.where(fit, gap / scale, 0.0), f"mode {one.subject.code.mode_labels[mode]}")


def _columns_of_j(one: Numeric, batch: Batch) -> Floats:
    freedom = one.subject.platform.space.degrees_of_freedom
    columns = []
    for index in range(freedom):
        twist = np.zeros((len(batch), freedom))
        twist[:, index] = 1.0

        def residual(step: float, twist: Floats = twist) -> Floats:
            return call(one, batch, "constraints", **moved(batch, twist, step))["residual"]

        columns.append(quotient(residual))
    return np.stack(columns, axis=-1)


def _columns_of_k(one: Numeric, batch: Batch) -> Floats:
    """-d(residual)/d(theta), each joint of each leg by itself."""
    theta, columns = batch.values["theta"], []
    for leg in range(theta.shape[1]):
        for joint in range(theta.shape[2]):

            def residual(step: float, leg: int = leg, joint: int = joint) -> Floats:
                bumped = theta.copy()
                bumped[:, leg, joint] += step
                s = call(one, batch, "subleg_forward", theta=bumped)["s"]
                return -call(one, batch, "constraints", s=s)["residual"]

            columns.append(quotient(residual))
    return np.stack(columns, axis=-1)


def j_matrix(one: Numeric, batch: Batch, found: Measured) -> None:
    """J of jacobians."""
    compare(found, _columns_of_j(one, batch), call(one, batch, "jacobians")["J"], "J", 2)


def k_matrix(one: Numeric, batch: Batch, found: Measured) -> None:
    """K of jacobians."""
    compare(found, _columns_of_k(one, batch), call(one, batch, "jacobians")["K"], "K", 2)


def blocks(one: Numeric, batch: Batch, found: Measured) -> None:
    """J and the blocks of K of jacobian_blocks."""
    result = call(one, batch, "jacobian_blocks")
    compare(found, _columns_of_j(one, batch), result["J"], "J", 2)
    K, rows, n = _columns_of_k(one, batch), one.subject.platform.space.rows_per_leg, one.subject.subleg.n
    for leg in range(result["K"].shape[1]):
        block = K[:, rows * leg : rows * (leg + 1), n * leg : n * (leg + 1)]
        compare(found, block, result["K"][:, leg].reshape(block.shape), f"K of leg {leg + 1}", 2)


def rates(one: Numeric, batch: Batch, found: Measured) -> None:
    """joint_rates."""
    compare(
        found, differenced_rates(one, batch), call(one, batch, "joint_rates")["theta_dot"], "theta_dot", 2
    )


def twist(one: Numeric, batch: Batch, found: Measured) -> None:
    """twist, from differences of the inverse."""
    got = call(one, batch, "twist", theta_dot=differenced_rates(one, batch))["twist"]
    compare(found, got, batch.values["twist"], "twist", 1)


def accelerations(one: Numeric, batch: Batch, found: Measured) -> None:
    """joint_accelerations, from differences of joint_rates."""
    wanted = call(one, batch, "joint_accelerations", theta_dot=joint_rates(one, batch, 0.0))["theta_ddot"]
    compare(found, differenced_accelerations(one, batch), wanted, "theta_ddot", 2)


def second_differences(one: Numeric, batch: Batch, found: Measured) -> None:
    """joint_accelerations, from second differences of the inverse, whose steps are longer: in configurations
    three times as far from singularities of the legs, or in the better half where a leg's factors are small.
    (All are differenced once, above.)
    """
    got = second_quotient(joints(one, batch), by_arc(one))
    wanted = call(one, batch, "joint_accelerations", theta_dot=joint_rates(one, batch, 0.0))["theta_ddot"]
    worst = np.abs(call(one, batch, "singularity")["factors"]).min(axis=(1, 2))
    far = worst >= min(3 * CONDITION, float(np.median(worst)))
    compare(found, got[far], wanted[far], "theta_ddot", 2)


def platform_acceleration(one: Numeric, batch: Batch, found: Measured) -> None:
    """platform_acceleration, from differences of joint_rates; relative to its terms, which may cancel."""
    theta_dot, theta_ddot = joint_rates(one, batch, 0.0), differenced_accelerations(one, batch)
    got = call(one, batch, "platform_acceleration", theta_dot=theta_dot, theta_ddot=theta_ddot)["twist_rate"]
    terms = call(one, batch, "twist", theta_dot=theta_ddot)["twist"]
    wanted = batch.values["twist_rate"]
    scale = np.maximum(np.abs(wanted), np.abs(terms)).max(axis=-1, keepdims=True)
    found.worse(np.abs(got - wanted) / scale, "twist_rate")


RUNNERS: dict[str, Runner] = {
    "M of forward": runner(m_of_forward),
    "M of inverse": runner(m_of_inverse),
    "J": runner(j_matrix),
    "K": runner(k_matrix),
    "J and blocks": runner(blocks),
    "rates": runner(rates),
    "twist": runner(twist),
    "accelerations": runner(accelerations),
    "second differences": runner(second_differences),
    "platform acceleration": runner(platform_acceleration),
}
"""The code of each check by its name in the plan."""
