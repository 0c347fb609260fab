"""Symmetries of the problem: the base may be turned, the legs exchanged, the lengths scaled."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import combinations, permutations, product
from typing import Any

import numpy as np

from krhpr.codegen.composition import RobotFunction
from krhpr.codegen.kernel import LEGS, Layout, Port, Unit
from krhpr.validation.differences import arc, call
from krhpr.validation.evaluation import evaluate
from krhpr.validation.invariants.batch import runner
from krhpr.validation.numeric import Floats, Numeric
from krhpr.validation.outcome import Measured, Runner
from krhpr.validation.sampling import Batch, closure_error
from krhpr.validation.scale import relative
from krhpr.validation.subject import Subject


def turned_base(one: Numeric, batch: Batch, found: Measured) -> None:
    """All base azimuths turned by one angle."""
    angle = 0.7
    c, s = np.cos(angle), np.sin(angle)
    R = np.array([[c, -s], [s, c]]) if one.subject.planar else np.array([[c, -s, 0], [s, c, 0], [0, 0, 1.0]])
    geometry = _turned(batch.geometry, angle)
    turn = _Turn(R, angle, *_measured_from_x(one.subject, batch, R, angle))
    for function in one.subject.code.functions:
        inputs = batch.of(function)
        there = {port.name: turn(port, inputs[port.name]) for port in function.inputs}
        here = one.call(function.name, inputs, batch.geometry)
        turned = one.call(function.name, there, geometry)
        for port in function.outputs:
            wanted = turn(port, here[port.name])
            error = relative(port, turned[port.name], wanted, _reference(one, batch, port, wanted))
            found.worse(error, f"{function.name}: {port.name}")


def _turned(geometry: Mapping[str, Any], angle: float) -> dict[str, Any]:
    """The geometry with the base's azimuths turned: those of legs, and of slides that do not turn with
    them.
    """
    base = ("azimuth", "slide_azimuth")
    return {
        name: tuple(x + angle for x in values) if name in base else values
        for name, values in geometry.items()
    }


def _measured_from_x(subject: Subject, batch: Batch, R: Floats, angle: float) -> tuple[Any, int]:
    """For each joint 1 if its angle is measured from the base's x axis and turns with the base, else 0; and
    the same for the swivel.
    """
    geometry = _turned(batch.geometry, angle)
    if not subject.subleg.has_inverse:
        return _shares_that_close(subject, batch, batch.values["s"] @ R.T, angle, geometry), 0
    here = evaluate(subject, "subleg_inverse", batch.values, batch.geometry)["theta"]
    for swivel in (0, 1) if subject.subleg.redundant else (0,):
        moved = {"s": batch.values["s"] @ R.T, "swivel": batch.values["swivel"] + swivel * angle}
        there = evaluate(subject, "subleg_inverse", {**batch.values, **moved}, geometry)["theta"]
        gap = arc(there, here, subject.code.angular) / angle
        share = np.round(gap[0, 0, 0])
        if np.allclose(gap, share, atol=1e-9):
            return share, swivel
    raise ArithmeticError(f"{subject.identifier}: joints turn with the base by different shares")


def _shares_that_close(
    subject: Subject, batch: Batch, s: Floats, angle: float, geometry: Mapping[str, Any]
) -> Any:
    """The same for a sub-leg whose inverse has no closed form: shares with which its loops close again."""
    for share in product((0.0, 1.0), repeat=subject.subleg.n):
        theta = batch.values["theta"] + np.array(share) * angle
        if closure_error(subject, s, theta, geometry).max() < 1e-9:
            return np.array(share)
    raise ArithmeticError(f"{subject.identifier}: no joints close the legs after the base has turned")


def _reference(one: Numeric, batch: Batch, port: Port, wanted: Floats) -> Any:
    """What a value is compared with: itself, but for residuals and errors, which cancel."""
    if port.name == "residual":
        return _lengths(one, batch)
    if "mismatch" in port.name:
        return np.abs(batch.values["s"]).max(axis=(1, 2))
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
    swivel: int

    def __call__(self, port: Port, value: Floats) -> Floats:
        """A value as it is after the base has turned."""
        R, d = self.R, len(self.R)
        if port.name in ("phi", "phi_near"):
            return value + self.angle
        if port.name == "swivel":
            return value + self.swivel * self.angle
        if port.name in ("theta", "theta_near"):
            return np.asarray(value + self.share * self.angle)
        if port.name in ("p", "p_near", "s", "s_near", "points", "attachment", "weight"):
            return value @ R.T
        if port.name in ("Q", "Q_near", "raw", "M"):
            return np.asarray(R @ value)
        if port.name in ("twist", "twist_rate", "wrench", "J"):
            end = 2 * d if d == 3 else d  # what is beyond is of the redundant coordinates
            parts = [value[..., first : first + d] @ R.T for first in range(0, end, d)]
            return np.concatenate([*parts, value[..., end:]], axis=-1)
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
            if any(port.name == "measured" and port.size < LEGS for port in function.inputs):
                continue  # the first legs have the encoders
            inputs = batch.of(function)
            there = {
                port.name: _exchanged(port, inputs[port.name], order, parity) for port in function.inputs
            }
            here = one.call(function.name, inputs, batch.geometry)
            exchanged = one.call(function.name, there, geometry)
            for port in function.outputs:
                if port.name == "kantorovich":
                    continue  # its unknowns are those of the first leg
                wanted = _exchanged(port, here[port.name], order, parity)
                if function.name == "clearances":
                    wanted = wanted[..., _pairs_exchanged(one.subject, function, order)]
                if port.name == "det_J" and one.subject.planar:
                    wanted = wanted * parity  # in space both factors change their sign
                if function.name == "jacobians_n" and port.name == "J":
                    wanted = _coordinates_exchanged(one.subject, wanted, order)
                if function.name == "forward_all" and port.shape and parity < 0:
                    wanted = _other_way_round(one.subject, wanted, here["count"])
                reference = _reference(one, batch, port, wanted)
                if port.name == "residual":
                    reference = _exchanged(port, reference, order, parity)
                error = relative(port, exchanged[port.name], wanted, reference)
                found.worse(error, f"{function.name}: {port.name}, legs {order}")


def _coordinates_exchanged(subject: Subject, J: Floats, order: tuple[int, ...]) -> Floats:
    """J_n with rows, and the columns beyond those of the twist, of the legs in another order."""
    freedom = subject.platform.space.degrees_of_freedom
    columns = [*range(freedom)]
    for first in range(freedom, J.shape[-1], LEGS):
        columns += [first + leg for leg in order]
    return _permuted(J[..., columns], J.ndim - 2, order)


def _pairs_exchanged(subject: Subject, function: RobotFunction, order: tuple[int, ...]) -> list[int]:
    """For each pair of links with the legs in another order: its place in the order that there was."""
    (each,) = (call.pairs for call in function.calls if call.pairs is not None)
    rows = len(subject.subleg.points_port().labels)

    def before(end: int) -> int:
        leg, row = divmod(end, rows)
        return LEGS * rows + order[end - LEGS * rows] if leg >= LEGS else order[leg] * rows + row

    def links(ends: tuple[int, ...]) -> frozenset[frozenset[int]]:
        return frozenset((frozenset(ends[:2]), frozenset(ends[2:])))

    place = {links(ends): k for k, ends in enumerate(each.ends)}
    return [place[links(tuple(map(before, ends)))] for ends in each.ends]


def _other_way_round(subject: Subject, wanted: Floats, count: Floats) -> Floats:
    """Solutions in the order in which an odd permutation of the legs gives them."""
    if subject.platform.closed_forward:
        return np.flip(wanted, axis=1)  # the one on the positive side of type II is the first
    if not subject.planar:
        return wanted  # in the order of det J, which stays
    turned = [
        np.concatenate([row[:n][::-1], row[n:]]) for row, n in zip(wanted, count.astype(int), strict=True)
    ]
    return np.stack(turned)


_OF_LEGS = ("redundant", "measured", "shares", "redundant_forces", "friction_margins", "condition")
"""Numbers, one for each leg, that are found for all legs together."""


def _exchanged(port: Port, value: Floats, order: tuple[int, ...], parity: float) -> Floats:
    """A value with the legs in another order: leg-wise ones exchanged, those that an odd permutation turns
    round with the other sign.
    """
    if port.name in ("type_2", "margins", "side"):
        return value * parity
    if port.name in _OF_LEGS and port.layout is Layout.SHARED:
        return value[..., list(order)]
    if port.name in ("actuator_forces", "contact_forces") and port.layout is Layout.SHARED:
        return value[..., list(order), :]
    if port.name == "mismatch":
        pairs = list(combinations(range(LEGS), 2))
        return value[..., [pairs.index((min(order[i], order[j]), max(order[i], order[j]))) for i, j in pairs]]
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
    Unit.NEWTON: 0,
    Unit.NEWTON_METRE: 1,
}
"""Forces stay, and moments have the power of an arm."""
_TWISTS = (Unit.TWIST, Unit.TWIST_RATE)
_JOINTS = (Unit.ACTUATOR, Unit.ACTUATOR_RATE, Unit.ACTUATOR_ACCELERATION)


def power_of_length(subject: Subject, port: Port) -> Any:
    """The power of length that a port's elements have, broadcast over its shape; None where its unit
    leaves it open.
    """
    if port.name == "passive":
        return np.array([int(joint.kind != "revolute") for joint in subject.subleg.passive_joints])
    if port.name == "weights":
        return np.array([-1, -1, 0])
    if port.unit in _POWERS:
        return _POWERS[port.unit]
    if port.unit in _TWISTS:
        d = subject.platform.space.dimension
        return np.array([1] * d + [0] * (port.size - d))
    if port.unit is Unit.WRENCH:
        d = subject.platform.space.dimension
        return np.array([0] * d + [1] * (port.size - d))
    if port.unit is Unit.ACTUATOR_FORCE:
        if port.name == "redundant_forces":
            return int(subject.platform.redundant_joint.kind == "revolute")
        if port.name == "swivel_forces":
            return int(subject.subleg.swivel is not None and subject.subleg.swivel.kind == "revolute")
        return np.array([int(angular) for angular in subject.code.angular])
    if port.unit in _JOINTS:
        if port.name.startswith("redundant"):
            return int(subject.platform.redundant_joint.kind != "revolute")
        if port.name.startswith("swivel"):
            return int(subject.subleg.swivel is not None and subject.subleg.swivel.kind != "revolute")
        return np.array([int(not angular) for angular in subject.code.angular])
    return None


_TOUCHING = 1e-70
"""Above the root of `NO_LENGTH`, far below what rounding leaves of a length."""


def lengths_scaled(one: Numeric, batch: Batch, found: Measured) -> None:
    """Doubling is exact in binary: every result must be a power of two times what it was, bit by bit."""
    subject = one.subject
    fields = {field.name: field.unit for kind in subject.geometry_types.values() for field in kind.fields}
    geometry = {
        name: values if fields[name] is Unit.RADIAN else tuple(2 * x for x in values)
        for name, values in batch.geometry.items()
    }
    mixed = len(set(subject.code.angular)) > 1
    for function in subject.code.functions:
        if function.name == "inverse_near" and mixed:
            continue  # which joints are nearest depends on the unit of slides beside that of angles
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
                same = (b == a * 2.0 ** np.asarray(power)) | (np.isnan(a) & np.isnan(b))
                if port.name == "distances":  # of links that cross: what is no length has no unit
                    same |= (a < _TOUCHING) & (b < _TOUCHING)
                found.worse((~same).astype(float), where)


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
    "turned base": runner(turned_base),
    "legs exchanged": runner(legs_exchanged),
    "lengths scaled": runner(lengths_scaled),
}
