"""Invariants: what generated functions must satisfy whatever their formulas are.

Closed loops, there-and-back, virtual work, and the symmetries of the problem: the base may be turned, the
legs exchanged, the lengths scaled.  Everything runs on the functions of one target, at random
configurations of a random geometry.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import permutations
from typing import Any

import numpy as np

from krhpr.codegen.composition import Status
from krhpr.codegen.kernel import LEGS, Layout, Port, Unit
from krhpr.validation.check import Check
from krhpr.validation.differences import arc, call
from krhpr.validation.numeric import Floats, Numeric, target
from krhpr.validation.outcome import Measured, Runner
from krhpr.validation.paths import nearest_modes
from krhpr.validation.sampling import Batch, draw, evaluate, redundant_box, rotations
from krhpr.validation.scale import relative
from krhpr.validation.subject import Subject

Body = Callable[[Numeric, Batch, Measured], None]


def runner(body: Body) -> Runner:
    """A check of one target on a batch."""

    def run(subject: Subject, check: Check, count: int) -> Measured:
        found = Measured(check, samples=count)
        body(target(subject, check.target), draw(subject, check.seed, count), found)
        return found

    return run


def close(found: Measured, got: Any, wanted: Any, where: str, axes: int) -> None:
    """The error relative to the largest element of the last `axes` axes of what is wanted."""
    over = tuple(range(-axes, 0))
    scale = np.abs(wanted).max(axis=over, keepdims=True) if axes else np.abs(wanted)
    found.worse(np.abs(got - wanted) / scale, where)


# -- position --------------------------------------------------------------------------------------


def loop_closure(one: Numeric, batch: Batch, found: Measured) -> None:
    """Residuals over the rows of J, which say what they measure."""
    s = call(one, batch, "end_points")["s"]
    residual = call(one, batch, "constraints", s=s)["residual"]
    rows = np.abs(call(one, batch, "jacobians")["J"]).max(axis=-1)
    found.worse(np.abs(residual) / rows, "residual")


def redundant_coordinates(one: Numeric, batch: Batch, found: Measured) -> None:
    """There and back."""
    got = call(one, batch, "redundant_coordinates", **call(one, batch, "end_points"))["redundant"]
    (port,) = one.subject.code.function("redundant_coordinates").outputs
    found.worse(relative(port, got, batch.values["redundant"]), "redundant")


def _assemblies(one: Numeric, count: int) -> list[dict[str, Floats]]:
    """The argument `assembly` for every assembly mode; none for open chains."""
    signs = [np.array(entry, dtype=float) for entry in one.subject.code.assembly_signs]
    return [
        {"assembly": np.broadcast_to(entry, (count, LEGS, len(entry)))} if entry.size else {}
        for entry in signs
    ]


def forward_after_inverse(one: Numeric, batch: Batch, found: Measured) -> None:
    """The best of all assembly modes; no two lead to the same point."""
    s = batch.values["s"]
    every = call(one, batch, "subleg_inverse")["theta"]
    for mode, label in enumerate(one.subject.code.mode_labels):
        errors = []
        for assembly in _assemblies(one, len(batch)):
            ends = call(one, batch, "subleg_forward", theta=every[:, :, mode], **assembly)["s"]
            errors.append(np.abs(ends - s).max(axis=-1) / np.abs(s).max(axis=-1))
        ordered = np.sort(np.nan_to_num(errors, nan=np.inf), axis=0)
        found.worse(ordered[0], f"mode {label}")
        if len(ordered) > 1:
            found.worse(
                np.where(ordered[1] > 1e-6, 0.0, 1.0), f"two assembly modes are the same in mode {label}"
            )


def inverse_after_forward(one: Numeric, batch: Batch, found: Measured) -> None:
    """The nearest of all working modes."""
    theta = batch.values["theta"]
    for index, assembly in enumerate(_assemblies(one, len(batch))):
        ends = call(one, batch, "subleg_forward", **assembly)["s"]
        every = call(one, batch, "subleg_inverse", s=ends)["theta"]
        gap = np.abs(arc(every, theta[:, :, None], one.subject.code.angular)).max(axis=-1)
        found.worse(np.nanmin(np.where(np.isnan(gap), np.inf, gap), axis=-1), f"assembly mode {index}")


def modes(one: Numeric, batch: Batch, found: Measured) -> None:
    """inverse in each mode, beside inverse_all and subleg_inverse."""
    every = call(one, batch, "inverse_all")["theta"]
    of_legs = call(one, batch, "subleg_inverse")["theta"]
    found.worse(np.abs(arc(of_legs, every, one.subject.code.angular)), "subleg_inverse")
    for index, signs in enumerate(one.subject.code.mode_signs):
        mode = np.broadcast_to(np.array(signs, dtype=float), (len(batch), LEGS, len(signs)))
        theta = call(one, batch, "inverse", mode=mode)["theta"]
        found.worse(np.abs(arc(theta, every[:, :, index], one.subject.code.angular)), f"mode {index}")


def signs_of_modes(one: Numeric, batch: Batch, found: Measured) -> None:
    """Signs of the leg's first factors, in every mode."""
    every = call(one, batch, "inverse_all")["theta"]
    for index, signs in enumerate(one.subject.code.mode_signs):
        factors = call(one, batch, "singularity", theta=every[:, :, index])["factors"]
        wrong = np.sign(factors[..., : len(signs)]) != np.array(signs)
        found.worse(wrong.astype(float), f"mode {one.subject.code.mode_labels[index]}")


def defaults(one: Numeric, batch: Batch, found: Measured) -> None:
    """Calls without a mode and without an assembly mode."""
    code = one.subject.code
    inputs = {name: batch.values[name] for name in (*batch.pose, "redundant")}
    theta = one.call("inverse", inputs, batch.geometry)["theta"]
    signs = np.array(code.default_mode)
    mode = np.broadcast_to(signs, (len(batch), LEGS, len(signs)))
    found.worse(np.abs(theta - call(one, batch, "inverse", mode=mode)["theta"]), "inverse")
    ends = one.call("subleg_forward", {"theta": theta}, batch.geometry)["s"]
    close(found, ends, batch.values["s"], "subleg_forward", 2)


def status_of_inverse(one: Numeric, batch: Batch, found: Measured) -> None:
    """Near and far poses: NaN, excess and status tell the same."""
    rng = np.random.default_rng(len(batch))
    wide = rng.uniform(-1.0, 1.0, batch.values["p"].shape)
    values = {"p": batch.values["p"] + wide}
    theta = call(one, batch, "inverse", **values)
    reach = call(one, batch, "inverse_status", **values)
    exists = np.isfinite(theta["theta"]).all(axis=-1)
    clear = np.abs(reach["excess"]) > 1e-9
    found.worse((clear & ((reach["excess"] <= 0) != exists)).astype(float), "excess and NaN")
    partly = np.isfinite(theta["theta"]).any(axis=-1)
    found.worse((partly != exists).astype(float), "a leg is either found whole or not at all")
    first = np.where(exists.all(axis=-1), 0, int(Status.UNREACHABLE_LEG_1) + np.argmin(exists, axis=-1))
    sure = clear.all(axis=-1)
    for name, status in (("inverse", theta["status"]), ("inverse_status", reach["status"])):
        found.worse((sure & (status != first)).astype(float), f"status of {name}")
    found.worse(0.0 if exists.any() and not exists.all() else 1.0, "no poses within, or none out of reach")


# -- velocity and statics --------------------------------------------------------------------------


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


# -- singularities ---------------------------------------------------------------------------------


def determinants(one: Numeric, batch: Batch, found: Measured) -> None:
    """Determinants of the matrices, relative to the product of their rows' lengths (Hadamard)."""
    result = call(one, batch, "singularity")
    M = call(one, batch, "subleg_jacobian")["M"]
    J = call(one, batch, "jacobians")["J"]
    for name, matrix, value in (("det M", M, result["type_1"]), ("det J", J, result["type_2"].prod(axis=-1))):
        bound = np.linalg.norm(matrix, axis=-1).prod(axis=-1)
        found.worse(np.abs(np.linalg.det(matrix) - value) / bound, name)


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
    for status, redundant in _singular_platforms(one.subject, batch):
        values = {"redundant": np.broadcast_to(redundant, (len(batch), LEGS))}
        values["s"] = call(one, batch, "end_points", **values)["s"]
        for name in ("twist", "platform_acceleration"):
            result = call(one, batch, name, **values)
            answer = result["twist" if name == "twist" else "twist_rate"]
            wrong = (result["status"] != int(status)) | ~np.isnan(answer).all(axis=-1)
            found.worse(wrong.astype(float), f"{name} where {status.name}")


def _singular_platforms(subject: Subject, batch: Batch) -> list[tuple[Status, Floats]]:
    """Redundant coordinates of type II singularities: links through O'; slides that cancel; two slides at
    O'.
    """
    if subject.platform.redundant_joint.kind == "revolute":
        return [(Status.SINGULAR_IN_PLANE, np.full(LEGS, np.pi))]
    azimuth = np.array(batch.geometry["platform_azimuth"])
    weights = np.sin(np.roll(azimuth, -2) - np.roll(azimuth, -1))
    cancelling = np.array([0.1, -0.03, 0.0])
    cancelling[2] = -(weights[0] * cancelling[0] + weights[1] * cancelling[1]) / weights[2]
    return [
        (Status.SINGULAR_IN_PLANE, cancelling),
        (Status.SINGULAR_NORMAL, np.array([0.1, 0.0, 0.0])),
    ]


# -- passive joints --------------------------------------------------------------------------------


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
    azimuth = g["platform_azimuth"]
    radial = np.stack([np.cos(azimuth), np.sin(azimuth), np.zeros(LEGS)], axis=-1)[:, : Q.shape[-1]]
    if "l_r" in g:
        joint = v["p"][:, None] + np.einsum("kij,lj->kli", Q, g["R_p"][:, None] * radial)
        close(found, v["s"] + g["l_r"][:, None] * along, joint, "B_i", 1)
    else:
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


# -- symmetries ------------------------------------------------------------------------------------


def turned_base(one: Numeric, batch: Batch, found: Measured) -> None:
    """All base azimuths turned by one angle."""
    angle = 0.7
    c, s = np.cos(angle), np.sin(angle)
    R = np.array([[c, -s], [s, c]]) if one.subject.planar else np.array([[c, -s, 0], [s, c, 0], [0, 0, 1.0]])
    geometry = {**batch.geometry, "azimuth": tuple(x + angle for x in batch.geometry["azimuth"])}
    turn = _Turn(R, angle, _measured_from_x(one.subject, batch, R, angle))
    for function in one.subject.code.functions:
        inputs = batch.of(function)
        there = {port.name: turn(port, inputs[port.name]) for port in function.inputs}
        here = one.call(function.name, inputs, batch.geometry)
        turned = one.call(function.name, there, geometry)
        for port in function.outputs:
            wanted = turn(port, here[port.name])
            error = relative(port, turned[port.name], wanted, _reference(one, batch, port, wanted))
            found.worse(error, f"{function.name}: {port.name}")


def _measured_from_x(subject: Subject, batch: Batch, R: Floats, angle: float) -> Any:
    """For each joint 1 if its angle is measured from the base's x axis and turns with the base, else 0."""
    geometry = {**batch.geometry, "azimuth": tuple(x + angle for x in batch.geometry["azimuth"])}
    here = evaluate(subject, "subleg_inverse", batch.values, batch.geometry)["theta"]
    there = evaluate(subject, "subleg_inverse", {**batch.values, "s": batch.values["s"] @ R.T}, geometry)[
        "theta"
    ]
    gap = arc(there, here, subject.code.angular) / angle
    share = np.round(gap[0, 0, 0])
    if not np.allclose(gap, share, atol=1e-9):
        raise ArithmeticError(f"{subject.identifier}: joints turn with the base by different shares")
    return share


def _reference(one: Numeric, batch: Batch, port: Port, wanted: Floats) -> Any:
    """What a value is compared with: itself, but for residuals and errors, which cancel."""
    if port.name == "residual":
        return _lengths(one, batch)
    return np.ones_like(wanted) if port.name == "error" else wanted


def _lengths(one: Numeric, batch: Batch) -> Floats:
    """What residuals, which cancel, are compared with: the largest elements of the rows of J."""
    rows: Floats = np.abs(call(one, batch, "jacobians")["J"]).max(axis=-1)
    return rows


@dataclass(frozen=True)
class _Turn:
    """The base turned: by the matrix R, which is an angle; joints take a share of it."""

    R: Floats
    angle: float
    share: Any

    def __call__(self, port: Port, value: Floats) -> Floats:
        """A value as it is after the base has turned."""
        R, d = self.R, len(self.R)
        if port.name == "phi":
            return value + self.angle
        if port.name in ("theta", "theta_near"):
            return np.asarray(value + self.share * self.angle)
        if port.name in ("p", "s"):
            return value @ R.T
        if port.name in ("Q", "M"):
            return np.asarray(R @ value)
        if port.name in ("twist", "twist_rate", "J"):
            parts = [value[..., :d] @ R.T, value[..., d:] if d == 2 else value[..., d:] @ R.T]
            return np.concatenate(parts, axis=-1)
        return value


def legs_exchanged(one: Numeric, batch: Batch, found: Measured) -> None:
    """Every permutation of unequal legs."""
    for order in permutations(range(LEGS)):
        geometry = {
            name: (values[order[0]], values[order[1]], values[order[2]])
            for name, values in batch.geometry.items()
        }
        parity = np.linalg.det(np.eye(LEGS)[list(order)])
        for function in one.subject.code.functions:
            inputs = batch.of(function)
            there = {port.name: _exchanged(port, inputs[port.name], order) for port in function.inputs}
            here = one.call(function.name, inputs, batch.geometry)
            exchanged = one.call(function.name, there, geometry)
            for port in function.outputs:
                wanted = _exchanged(port, here[port.name], order)
                if port.name in ("type_2", "margins"):
                    wanted = wanted * parity
                reference = _reference(one, batch, port, wanted)
                if port.name == "residual":
                    reference = _exchanged(port, reference, order)
                error = relative(port, exchanged[port.name], wanted, reference)
                found.worse(error, f"{function.name}: {port.name}, legs {order}")


def _exchanged(port: Port, value: Floats, order: tuple[int, ...]) -> Floats:
    """A leg-wise value with the legs in another order."""
    if port.layout is Layout.SHARED:
        return value
    axis = value.ndim - len(port.full_shape)
    result = _permuted(value, axis, order)
    return _permuted(result, axis + 1, order) if port.layout is Layout.DIAGONAL else result


def _permuted(value: Floats, axis: int, order: tuple[int, ...]) -> Floats:
    per_leg = value.shape[axis] // LEGS
    return np.take(value, [per_leg * leg + k for leg in order for k in range(per_leg)], axis=axis)


_POWERS = {
    Unit.NONE: 0,
    Unit.RADIAN: 0,
    Unit.METRE: 1,
    Unit.SQUARE_METRE: 2,
    Unit.CUBIC_METRE: 3,
    Unit.METRE_PER_SECOND: 1,
    Unit.METRE_PER_SECOND_SQUARED: 1,
}
_TWISTS = (Unit.TWIST, Unit.TWIST_RATE)
_JOINTS = (Unit.ACTUATOR, Unit.ACTUATOR_RATE, Unit.ACTUATOR_ACCELERATION)


def power_of_length(subject: Subject, port: Port) -> Any:
    """The power of length that a port's elements have, broadcast over its shape; None where its unit
    leaves it open.
    """
    if port.unit in _POWERS:
        return _POWERS[port.unit]
    if port.unit in _TWISTS:
        d = subject.platform.space.dimension
        return np.array([1] * d + [0] * (port.size - d))
    if port.unit in _JOINTS:
        if port.name.startswith("redundant"):
            return int(subject.platform.redundant_joint.kind != "revolute")
        return np.array([int(not angular) for angular in subject.code.angular])
    return None


def lengths_scaled(one: Numeric, batch: Batch, found: Measured) -> None:
    """Doubling is exact in binary: every result must be a power of two times what it was, bit by bit."""
    subject = one.subject
    fields = {field.name: field.unit for kind in subject.geometry_types.values() for field in kind.fields}
    geometry = {
        name: values if fields[name] is Unit.RADIAN else tuple(2 * x for x in values)
        for name, values in batch.geometry.items()
    }
    for function in subject.code.functions:
        inputs = batch.of(function)
        there = {
            port.name: inputs[port.name] * 2.0 ** np.asarray(power_of_length(subject, port))
            for port in function.inputs
        }
        here = one.call(function.name, inputs, batch.geometry)
        scaled = one.call(function.name, there, geometry)
        for port in function.outputs:
            where = f"{function.name}: {port.name}"
            power = power_of_length(subject, port)
            a, b = here[port.name], scaled[port.name]
            if power is None:
                power = _power_found(a, b)
                found.worse(float(power is None), f"{where} has no power of length")
            if power is not None:
                found.worse((b != a * 2.0 ** np.asarray(power)).astype(float), where)


def _power_found(a: Floats, b: Floats) -> Any:
    """The powers of two between two batches, element by element; None unless each is the same in all
    samples.
    """
    with np.errstate(divide="ignore", invalid="ignore"):
        powers = np.log2(b / a)
    powers = np.where((a == 0) & (b == 0), np.nan, powers)
    used = np.nanmax(np.where(np.isnan(powers), -np.inf, powers), axis=0)
    used = np.where(np.isinf(used) & (used < 0), 0.0, used)
    return used if np.array_equal(used, np.round(used)) else None


RUNNERS: dict[str, Runner] = {
    "loop closure": runner(loop_closure),
    "redundant coordinates": runner(redundant_coordinates),
    "forward after inverse": runner(forward_after_inverse),
    "inverse after forward": runner(inverse_after_forward),
    "modes": runner(modes),
    "signs of modes": runner(signs_of_modes),
    "defaults": runner(defaults),
    "virtual work": runner(virtual_work),
    "J t = K theta_dot": runner(velocity_equation),
    "rates and twist": runner(rates_and_twist),
    "accelerations": runner(accelerations),
    "determinants": runner(determinants),
    "margins": runner(margins),
    "singular configurations": runner(singular_configurations),
    "status of inverse": runner(status_of_inverse),
    "nearest mode": nearest_modes,
    "passive joints": runner(passive_joints),
    "turned base": runner(turned_base),
    "legs exchanged": runner(legs_exchanged),
    "lengths scaled": runner(lengths_scaled),
}
"""The code of each check by its name in the plan."""
