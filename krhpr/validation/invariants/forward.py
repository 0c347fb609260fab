"""Forward kinematics: the pose is found again, and every other solution is one."""

from __future__ import annotations

from math import sqrt
from typing import Any

import numpy as np

from krhpr.codegen.status import Status
from krhpr.derivations.roots import MISS_TOLERANCE
from krhpr.validation.conditioning import SURE, condition
from krhpr.validation.differences import arc, call
from krhpr.validation.invariants.batch import runner
from krhpr.validation.invariants.position import every_assembly
from krhpr.validation.numeric import Floats, Numeric
from krhpr.validation.outcome import Measured, Runner
from krhpr.validation.sampling import Batch, closure_error
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


def assembly_modes_of_the_leg(one: Numeric, batch: Batch, found: Measured) -> None:
    """Each end point closes its leg; the nearest is that of the pose."""
    s = call(one, batch, "subleg_forward_all")["s"]
    theta = batch.values["theta"]
    growth = condition(one.subject.code.function("subleg_forward_all"), batch, found.check.seed)
    known = np.isfinite(growth)
    size = np.abs(batch.values["s"]).max() ** 2
    for mode in range(s.shape[2]):
        error = closure_error(one.subject, s[:, :, mode], theta, batch.geometry) / size
        there = np.isfinite(s[:, :, mode]).all(axis=-1)
        allowed = np.minimum(growth, PROMISED / found.check.tolerance)[:, None]
        found.worse((error / allowed)[there], f"closure of mode {mode + 1}")
    gap = np.abs(s - batch.values["s"][:, :, None]).max(axis=-1)
    nearest = np.min(np.nan_to_num(gap, nan=np.inf), axis=-1) / np.sqrt(size)
    found.worse((nearest / growth[:, None])[known], "the end point is missing")
    found.worse(float(known.mean() < SURE), "too many configurations without a condition")


def forward_after_inverse(one: Numeric, batch: Batch, found: Measured) -> None:
    """Each leg in the assembly mode that leads to its end point."""
    whole = _known_branch(one, batch)
    result = call(one, whole, "forward")
    told = result["status"] != Status.AMBIGUOUS  # no theorem covers unequal sizes
    found.worse(float(told.mean() < SURE), "too many poses that cannot be told from others")
    found.worse((result["count"] < 1)[told].astype(float), "count")
    if "box" in {port.name for port in one.subject.code.function("forward").inputs}:
        low, high = np.moveaxis(batch.values["box"], -1, 0)
        outside = (result["redundant"] < low) | (result["redundant"] > high)
        found.worse(outside[told].astype(float), "a redundant angle is outside the box")
    growth = condition(one.subject.code.function("forward"), whole, found.check.seed)
    found.worse((_distance(batch, result) / growth)[told], "pose")


def passive_of_actuated(one: Numeric, batch: Batch, found: Measured) -> None:
    """The passive joints that `passive_joints` gives at the pose."""
    whole = _known_branch(one, batch)
    result, wanted = call(one, whole, "passive_joints_of_theta"), call(one, batch, "passive_joints")
    growth = condition(one.subject.code.function("passive_joints_of_theta"), whole, found.check.seed)
    for port in one.subject.code.function("passive_joints").outputs:
        error = relative(port, result[port.name], wanted[port.name]).reshape(len(batch), -1)
        found.worse((error / growth[:, None])[result["status"] != Status.AMBIGUOUS], port.name)


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
    "assembly modes of the sub-leg": runner(assembly_modes_of_the_leg),
    "assembly modes": runner(assembly_modes),
    "pose after inverse": runner(forward_after_inverse),
    "passive joints of the actuated ones": runner(passive_of_actuated),
}
