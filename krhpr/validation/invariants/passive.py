"""Passive joints: the chain of links, laid end to end from the base, leads to the platform."""

from __future__ import annotations

import numpy as np

from krhpr.codegen.kernel import LEGS
from krhpr.validation.differences import call
from krhpr.validation.invariants.batch import close, runner
from krhpr.validation.numeric import Floats, Numeric
from krhpr.validation.outcome import Measured, Runner
from krhpr.validation.sampling import Batch, rotations
from krhpr.validation.scale import relative
from krhpr.validation.subject import Subject


def passive_joints(one: Numeric, batch: Batch, found: Measured) -> None:
    """From the base along the links, through the joint at S_i, to the platform."""
    result = call(one, batch, "passive_joints")
    port = next(p for p in one.subject.code.function("passive_joints").outputs if p.name == "platform_joint")
    found.worse(relative(port, result["platform_joint"], batch.values["redundant"]), "platform joint")
    v, g = batch.values, {name: np.array(values) for name, values in batch.geometry.items()}
    link = _last_link(one.subject, g, v["theta"], result)
    if one.subject.planar:
        wrist = result["wrist"]
        cosine, sine = np.cos(wrist)[..., None], np.sin(wrist)[..., None]
        along = cosine * link + sine * np.stack([-link[..., 1], link[..., 0]], axis=-1)
        Q = _plane(v["phi"])
    else:
        redundant = link @ result["spherical"]
        along, Q = redundant[..., 0], v["Q"]
        close(found, redundant[..., 2], np.broadcast_to(Q[:, None, :, 2], redundant[..., 2].shape), "q_z", 1)
    if one.subject.platform.redundant_link:
        joint = call(one, batch, "link_points")["attachment"]
        length = g[one.subject.platform.redundant_link][:, None]
        close(found, v["s"] + length * along, joint, "joint or slider on the platform", 1)
    else:
        azimuth = g["platform_azimuth"]
        radial = np.stack([np.cos(azimuth), np.sin(azimuth), np.zeros(LEGS)], axis=-1)[:, : Q.shape[-1]]
        close(found, along, np.einsum("kij,lj->kli", Q, radial), "slide", 1)


def _plane(angle: Floats) -> Floats:
    return np.stack([np.cos(angle), -np.sin(angle), np.sin(angle), np.cos(angle)], axis=-1).reshape(-1, 2, 2)


def _last_link(subject: Subject, g: dict[str, Floats], theta: Floats, result: dict[str, Floats]) -> Floats:
    """Frame (in the plane: direction) of the link that ends in S_i, from the base and the angles alone."""
    if subject.planar:
        angle = theta.sum(axis=-1)
        return np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    last = theta[..., 1] + (result["passive"][..., 0] if "passive" in result else theta[..., 2])
    azimuth, alpha, zero = g["azimuth"], g["alpha"], np.zeros(LEGS)
    e_r = np.stack([np.cos(azimuth), np.sin(azimuth), zero], axis=-1)
    e_t = np.stack([-np.sin(azimuth), np.cos(azimuth), zero], axis=-1)
    e_1 = -np.cos(alpha)[:, None] * e_r + np.sin(alpha)[:, None] * np.array([0.0, 0.0, 1.0])
    turn = rotations(theta[..., :1] * e_1)
    e_2 = np.einsum("klij,lj->kli", turn, e_t)
    x = np.cross(np.broadcast_to(e_1, e_2.shape), e_2)
    along = np.cos(last)[..., None] * x + np.sin(last)[..., None] * e_1
    return np.stack([along, np.cross(e_2, along), e_2], axis=-1)


RUNNERS: dict[str, Runner] = {
    "passive joints": runner(passive_joints),
}
