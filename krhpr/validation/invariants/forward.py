"""Forward kinematics: the pose is found again, and every other solution is one."""

from __future__ import annotations

from math import sqrt
from typing import Any

import numpy as np

from krhpr.derivations.platforms.forward_revolute import MISS_TOLERANCE
from krhpr.validation.conditioning import SURE, condition
from krhpr.validation.differences import arc, call
from krhpr.validation.invariants.batch import runner
from krhpr.validation.invariants.position import every_assembly
from krhpr.validation.numeric import Floats, Numeric
from krhpr.validation.outcome import Measured, Runner
from krhpr.validation.sampling import Batch
from krhpr.validation.scale import relative

PROMISED = sqrt(MISS_TOLERANCE)
"""How well a solution at a root closes the platform, relative to the links' lengths."""


def assembly_modes(one: Numeric, batch: Batch, found: Measured) -> None:
    """Each solution closes the platform; the nearest is the pose."""
    result = call(one, batch, "forward_all")
    modes = result["p"].shape[1]
    pose = batch.pose
    growth = condition(one.subject.code.function("forward_all"), batch, found.check.seed)
    known = np.isfinite(growth)
    # next to a double root a solution keeps what is promised, not more
    allowed = np.minimum(growth, PROMISED / found.check.tolerance)
    rows = np.abs(call(one, batch, "jacobians")["J"]).max(axis=-1)
    errors = []
    closed = one.subject.platform.closed_forward
    for mode in range(modes):
        if (mode >= result["count"]).all():
            break
        here = mode < result["count"]
        there = {name: result[name][:, mode] for name in pose}
        residual = call(one, batch, "constraints", **there)["residual"]
        found.worse((np.abs(residual) / rows / allowed[:, None])[here], f"residual of solution {mode + 1}")
        factors = call(one, batch, "type_2_of_redundant", redundant=result["redundant"][:, mode])
        det_J = factors["type_2"].prod(axis=-1)
        bound = np.linalg.norm(call(one, batch, "jacobians", **there)["J"], axis=-1).prod(axis=-1)
        found.worse((np.abs(result["det_J"][:, mode] - det_J) / bound)[here], "det J")
        if closed:
            first = factors["margins"][:, 0] * (1 if mode == 0 else -1)
            found.worse((first <= 0).astype(float), f"solution {mode + 1} is on the wrong side")
        errors.append(_distance(batch, {**there, "redundant": result["redundant"][:, mode]}))
    nearest = np.min(np.nan_to_num(errors, nan=np.inf), axis=0)
    found.worse((nearest / growth)[known], "the pose is missing")
    found.worse(float(known.mean() < SURE), "too many configurations without a condition")
    there_are = np.isfinite(result["det_J"]).sum(axis=-1)
    found.worse((result["count"] != there_are).astype(float), "count")
    odd = there_are % 2 != 0
    if "doubtful" in result:
        odd &= result["doubtful"] == 0
    found.worse(odd.astype(float), "an odd number of solutions")


def forward_after_inverse(one: Numeric, batch: Batch, found: Measured) -> None:
    """Each leg in the assembly mode that leads to its end point."""
    whole = _known_branch(one, batch)
    result = call(one, whole, "forward")
    found.worse((result["count"] < 1).astype(float), "count")
    if "box" in {port.name for port in one.subject.code.function("forward").inputs}:
        low, high = np.moveaxis(batch.values["box"], -1, 0)
        outside = (result["redundant"] < low) | (result["redundant"] > high)
        found.worse(outside.astype(float), "a redundant angle is outside the box")
    growth = condition(one.subject.code.function("forward"), whole, found.check.seed)
    found.worse(_distance(batch, result) / growth, "pose")


def passive_of_actuated(one: Numeric, batch: Batch, found: Measured) -> None:
    """The passive joints that `passive_joints` gives at the pose."""
    whole = _known_branch(one, batch)
    result, wanted = call(one, whole, "passive_joints_of_theta"), call(one, batch, "passive_joints")
    growth = condition(one.subject.code.function("passive_joints_of_theta"), whole, found.check.seed)
    for port in one.subject.code.function("passive_joints").outputs:
        error = relative(port, result[port.name], wanted[port.name]).reshape(len(batch), -1)
        found.worse(error / growth[:, None], port.name)


def _known_branch(one: Numeric, batch: Batch) -> Batch:
    """The side of type II and the assembly modes that lead back to the pose."""
    side = np.sign(call(one, batch, "type_2_of_redundant")["margins"][:, 0])
    return batch.changed(side=side, **_assembly(one, batch))


def _assembly(one: Numeric, batch: Batch) -> dict[str, Floats]:
    """The argument `assembly`, leg by leg; nothing for open chains."""
    choices = every_assembly(one, len(batch))
    if not choices[0]:
        return {}
    ends = np.stack([call(one, batch, "subleg_forward", **choice)["s"] for choice in choices])
    gaps = np.nan_to_num(np.abs(ends - batch.values["s"]).max(axis=-1), nan=np.inf)
    signs = np.stack([choice["assembly"] for choice in choices])
    best = np.argmin(gaps, axis=0)[None, :, :, None]
    return {"assembly": np.take_along_axis(signs, np.broadcast_to(best, (1, *signs.shape[1:])), axis=0)[0]}


def _distance(batch: Batch, result: dict[str, Floats]) -> Floats:
    """How far a pose with its redundant coordinates is from that of the batch."""
    ports = {port.name: port for port in batch.subject.code.function("redundant_coordinates").inputs}
    ports["redundant"] = batch.subject.code.function("redundant_coordinates").outputs[0]
    total: Any = 0.0
    for name in (*batch.pose, "redundant"):
        got, wanted = result[name], batch.values[name]
        if name == "phi":
            error = np.abs(arc(got, wanted, (True,)))
        else:
            error = relative(ports[name], got, wanted)
        total = np.maximum(total, error.reshape(len(batch), -1).max(axis=-1))
    return np.asarray(total)


RUNNERS: dict[str, Runner] = {
    "assembly modes": runner(assembly_modes),
    "pose after inverse": runner(forward_after_inverse),
    "passive joints of the actuated ones": runner(passive_of_actuated),
}
