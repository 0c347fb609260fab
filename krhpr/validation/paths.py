"""Paths along which joints cross +-pi: `inverse_near` must go on without a jump, and come back where it
began.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from krhpr.codegen.kernel import LEGS
from krhpr.validation.check import Check
from krhpr.validation.differences import arc
from krhpr.validation.numeric import Floats, Numeric, target
from krhpr.validation.outcome import Measured
from krhpr.validation.rules.known import FIRST_PRINCIPLES
from krhpr.validation.sampling import Batch, draw, rotations
from krhpr.validation.subject import Subject

STEPS = 121


def nearest_modes(subject: Subject, check: Check, count: int) -> Measured:
    """Closed paths about random configurations, the base turned so that some joint crosses the cut."""
    found = Measured(check)
    one = target(subject, check.target)
    crossings = 0
    for index in range(count):
        batch = draw(subject, check.seed + index, 1)
        path = _closed_path(batch, np.random.default_rng(check.seed + index))
        modes = np.flatnonzero(batch.values["fit"][0].all(axis=0)).tolist()
        if not modes:
            continue
        crossings += _follow(one, path, modes, found)
        found.samples += 1
        _turns(one, path, modes, found, np.random.default_rng(check.seed + index))
        for mode in modes if subject.planar else ():
            # a joint that is measured from the base's x axis is brought to the cut by turning the robot
            turn = float(np.pi - _inverse(one, path, [mode])[0, 0, 0, 0])
            crossings += _follow(one, _turned(path, turn), [mode], found)
    # joints of a slide's linkage may be far from the cut everywhere; those of a first axis, or of the plane,
    # are not
    if subject.code.subleg.name in FIRST_PRINCIPLES:
        found.worse(0.0 if crossings else 1.0, "no path crosses +-pi")
    return found


def _turns(one: Numeric, path: Batch, modes: list[int], found: Measured, rng: np.random.Generator) -> None:
    """Near joints that are full turns away, the same joints come out, that many turns away."""
    code = one.subject.code
    plain = _inverse(one, path, modes)[:, :1]
    wanted = plain + 2 * np.pi * rng.integers(-3, 4, plain.shape) * np.array(code.angular)
    values: dict[str, Any] = {name: array[:1] for name, array in path.values.items()}
    values["theta_near"] = wanted
    function = code.function("inverse_near")
    got = one.call("inverse_near", {port.name: values[port.name] for port in function.inputs}, path.geometry)
    found.worse(np.abs(got["theta"] - wanted), "full turns")


def _closed_path(batch: Batch, rng: np.random.Generator) -> Batch:
    """A closed curve in pose and redundant coordinates through the batch's one configuration."""
    time = np.linspace(0, 2 * np.pi, STEPS)[:, None]
    v = batch.values
    p = v["p"] + 0.05 * np.hstack([np.sin((k + 1) * time) for k in range(v["p"].shape[-1])])
    swing = np.sin(time) * rng.uniform(-0.3, 0.3, (1, LEGS))
    values: dict[str, Floats] = {"p": p, "swivel": np.broadcast_to(v["swivel"], (STEPS, LEGS))}
    if batch.subject.planar:
        values["phi"] = v["phi"] + 0.3 * np.sin(time[:, 0])
    else:
        values["Q"] = rotations(0.3 * np.sin(time) * rng.normal(size=(1, 3))) @ v["Q"]
    angular = batch.subject.platform.redundant_joint.kind == "revolute"
    values["redundant"] = v["redundant"] + (swing if angular else 0.05 * swing)
    return Batch(batch.subject, batch.geometry, values)


def _inverse(one: Numeric, path: Batch, modes: list[int]) -> Floats:
    """inverse along the path in some modes: (modes, steps, 3, n)."""
    signs = np.array(one.subject.code.mode_signs, dtype=float)[modes]
    values: dict[str, Any] = dict(path.values)
    values["mode"] = np.broadcast_to(signs[:, None, None], (len(modes), len(path), LEGS, signs.shape[-1]))
    function = one.subject.code.function("inverse")
    arguments = {port.name: values[port.name] for port in function.inputs}
    theta = one.call("inverse", arguments, path.geometry)["theta"]
    return theta if "mode" in arguments else theta[None]


def _turned(path: Batch, angle: float) -> Batch:
    """The same path with the whole planar robot turned."""
    if angle == 0.0:
        return path
    c, s = np.cos(angle), np.sin(angle)
    R = np.array([[c, -s], [s, c]])
    values = {**path.values, "p": path.values["p"] @ R.T, "phi": path.values["phi"] + angle}
    first, second, third = (x + angle for x in path.geometry["azimuth"])
    return Batch(path.subject, {**path.geometry, "azimuth": (first, second, third)}, values)


def _follow(one: Numeric, path: Batch, modes: list[int], found: Measured) -> int:
    """Follow the path by inverse_near in several modes at once; returns how often inverse itself jumps."""
    code = one.subject.code
    plain = _inverse(one, path, modes)
    plain = plain[np.isfinite(plain).all(axis=(1, 2, 3))]  # the path may leave the reach of a mode
    if not len(plain):
        return 0
    theta = plain[:, 0]
    followed = [theta]
    function = code.function("inverse_near")
    for index in range(1, len(path)):
        values: dict[str, Any] = {name: array[index] for name, array in path.values.items()}
        values["theta_near"] = theta
        arguments = {port.name: values[port.name] for port in function.inputs}
        theta = one.call("inverse_near", arguments, path.geometry)["theta"]
        followed.append(theta)
    whole = np.stack(followed, axis=1)
    smooth = np.abs(arc(plain[:, 1:], plain[:, :-1], code.angular))
    found.worse(np.abs(arc(whole, plain, code.angular)), "another mode than the one followed")
    found.worse(np.abs(np.abs(np.diff(whole, axis=1)) - smooth), "a jump")
    found.worse(np.abs(whole[:, -1] - whole[:, 0]), "not back at the start")
    return int((np.abs(np.diff(plain, axis=1)) > np.pi).sum())
