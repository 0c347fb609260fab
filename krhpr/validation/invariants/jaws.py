"""Invariants of the grasping robots: positions and velocities there and back, virtual work in the three
views, and the equilibrium of what the jaws hold.
"""

from __future__ import annotations

import numpy as np

from krhpr.validation.differences import call
from krhpr.validation.invariants.batch import close, runner
from krhpr.validation.jaws import turn
from krhpr.validation.numeric import Floats, Numeric
from krhpr.validation.outcome import Measured, Runner
from krhpr.validation.sampling import Batch


def _cross(a: Floats, b: Floats) -> Floats:
    return np.asarray(a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0])


def _flat(values: Floats) -> Floats:
    return values.reshape(len(values), -1)


def pose_of_jaws(one: Numeric, batch: Batch, found: Measured) -> None:
    """forward after inverse, in every working mode; among all solutions it is once."""
    v = batch.values
    theta = call(one, batch, "inverse")["theta"]
    close(found, theta, v["theta"], "theta", 2)
    every = call(one, batch, "inverse_all")["theta"]
    close(found, every, call(one, batch, "subleg_inverse")["theta"], "theta of all modes", 3)
    back = call(one, batch, "forward", theta=theta)
    close(found, back["pivot"], v["pivot"], "pivot", 1)
    apart = turn(back["angles"] - v["angles"], np.array([1.0, 0.0]))
    found.worse(np.hypot(apart[..., 0] - 1, apart[..., 1]), "angles")
    solutions = call(one, batch, "forward_all", theta=theta)
    gap = np.linalg.norm(solutions["pivot"] - v["pivot"][:, None], axis=-1)
    best = np.nanargmin(gap, axis=1), np.arange(len(batch))
    found.worse(gap[best[::-1]] / np.linalg.norm(v["pivot"], axis=-1), "the pose among all solutions")
    apart = turn(solutions["angles"][best[::-1]] - v["angles"], np.array([1.0, 0.0]))
    found.worse(np.hypot(apart[..., 0] - 1, apart[..., 1]), "its angles")


def rates_of_jaws(one: Numeric, batch: Batch, found: Measured) -> None:
    """twist after joint_rates, and J t = K theta_dot in the three views."""
    v = batch.values
    rates = call(one, batch, "joint_rates")["theta_dot"]
    back = call(one, batch, "twist", theta_dot=rates)
    for name in ("pivot_rate", "angle_rates"):
        close(found, back[name], v[name], name, 1)
    velocities = {
        "n": np.concatenate([v["pivot_rate"], v["angle_rates"]], axis=-1),
        "k": back["twist"],
    }
    together = {"angle_rates": np.repeat(v["angle_rates"][:, :1], 2, axis=1)}  # the jaws turn as one body
    blocked = call(one, batch, "joint_rates", **together)["theta_dot"]
    velocities["r"] = call(one, batch, "twist", theta_dot=blocked)["twist"]
    for view, velocity in velocities.items():
        moved = _flat(blocked if view == "r" else rates)
        result = call(one, batch, f"jacobians_{view}")
        left = (result["J"] @ velocity[..., None])[..., 0]
        right = (result["K"] @ moved[..., None])[..., 0]
        scale = np.abs(result["K"]).max(axis=(-2, -1)) * np.abs(moved).max(axis=-1)
        found.worse(np.abs(left - right).max(axis=-1) / scale, f"J_{view} t - K_{view} theta_dot")


def statics_of_jaws(one: Numeric, batch: Batch, found: Measured) -> None:
    """Power of forces, and forces there and back, in the three views."""
    v = batch.values
    rates = call(one, batch, "joint_rates")["theta_dot"]
    velocity = np.concatenate([v["pivot_rate"], v["angle_rates"]], axis=-1)
    twist = call(one, batch, "twist", theta_dot=rates)["twist"]
    for view, given, moved in (("n", v["loads"], velocity), ("k", v["wrench"], twist)):
        forces = call(one, batch, f"inverse_statics_{view}")["actuator_forces"]
        size = np.linalg.norm(_flat(forces), axis=1) * np.linalg.norm(_flat(rates), axis=1)
        gap = (_flat(forces) * _flat(rates)).sum(axis=1) - (given * moved).sum(axis=1)
        found.worse(np.abs(gap) / size, f"power, {view}")
        back = call(one, batch, "forward_statics", actuator_forces=forces)
        most = np.maximum(np.abs(forces).max(axis=(1, 2)), 1.0)[:, None]
        found.worse(np.abs(back["loads" if view == "n" else "wrench"] - given) / most, f"back, {view}")
        if view == "k":
            found.worse(np.abs(back["loads"][:, 3:]) / most, "the left jaw bears nothing")
    result = call(one, batch, "inverse_statics_r")
    forces, least, null = (_flat(result[name]) for name in ("actuator_forces", "least_forces", "null_space"))
    close(found, forces, least + v["internal_force"][:, None] * null, "least forces and null space", 1)
    size = np.linalg.norm(least, axis=1) * np.linalg.norm(null, axis=1)
    found.worse(np.abs((least * null).sum(axis=1)) / size, "least forces are normal to the null space")
    back = call(one, batch, "forward_statics", actuator_forces=result["actuator_forces"])
    most = np.maximum(np.abs(forces).max(axis=1), 1.0)[:, None]
    found.worse(np.abs(back["wrench"] - v["wrench"]) / most, "back, r")


def object_of_jaws(one: Numeric, batch: Batch, found: Measured) -> None:
    """The object's equilibrium in the base frame; what is measured; loads about B."""
    v = batch.values
    result = call(one, batch, "grasp")
    measured = (v["sensor"] * result["contact_forces"]).sum(axis=(1, 2))
    found.worse(np.abs(measured - v["measured_force"]) / v["measured_force"], "the measured force")
    forces = turn(v["angles"] + v["faces"], result["contact_forces"])
    arms = turn(v["angles"], v["contacts"])
    size = np.abs(forces).max(axis=(1, 2))
    found.worse(np.abs(forces.sum(axis=1) + v["weight"]) / size[:, None], "forces")
    centre = turn(v["angles"][:, 0], v["mass_centre"])
    moments = _cross(arms - centre[:, None], forces).sum(axis=1)
    found.worse(np.abs(moments) / (size * np.abs(arms).max(axis=(1, 2))), "moments")
    loads = np.concatenate([forces.sum(axis=1), _cross(arms, forces)], axis=-1)
    found.worse(np.abs(result["loads"] - loads) / size[:, None], "loads")


RUNNERS: dict[str, Runner] = {
    "pose of the jaws": runner(pose_of_jaws),
    "rates of the jaws": runner(rates_of_jaws),
    "statics of the jaws": runner(statics_of_jaws),
    "object between the jaws": runner(object_of_jaws),
}
