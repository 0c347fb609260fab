"""Random configurations of a robot in doubles: consistent, reachable in every working mode, and well
conditioned in that of each leg; `fit` (count, 3, modes) says in which others they are well conditioned too.

They are drawn with the derivation itself, evaluated on arrays, not with any generated function.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from math import prod, radians
from typing import Any

import numpy as np

from krhpr.codegen.composition import RobotFunction, Stage
from krhpr.codegen.kernel import LEGS, Port, Unit
from krhpr.validation.arithmetic import ARRAYS
from krhpr.validation.evaluation import CONDITION, Floats, Values, assemblies_of, evaluate, stack
from krhpr.validation.jaws import draw_jaws
from krhpr.validation.subject import Subject

NEAR = 0.003
"""How far, in each coordinate, the points that choose an assembly mode are from end points, in metres."""

STARTS = 8
"""How many random joints Newton steps start from."""


@dataclass(frozen=True)
class Batch:
    """A geometry and so many configurations of it: every argument by name, shape (count, *port)."""

    subject: Subject
    geometry: Mapping[str, tuple[float, ...]]
    values: Values

    def __len__(self) -> int:
        return len(next(iter(self.values.values())))

    def of(self, function: RobotFunction) -> Values:
        """The arguments of a function."""
        return {port.name: self.argument(port) for port in function.inputs}

    def argument(self, port: Port) -> Floats:
        """An argument; the first elements, where a function takes fewer (of encoders)."""
        values = self.values[port.name]
        return values[:, : port.shape[0]] if port.name == "measured" else values

    def element(self, function: RobotFunction, index: int) -> dict[str, list[float]]:
        """The arguments of a function for one configuration, flat."""
        return {port.name: self.argument(port)[index].ravel().tolist() for port in function.inputs}

    def changed(self, **values: Any) -> Batch:
        """The same with some arguments changed."""
        return replace(self, values={**self.values, **values})

    @cached_property
    def pose(self) -> tuple[str, str]:
        """The names of the arguments that make the pose."""
        return ("p", "phi" if self.subject.planar else "Q")


def rotations(vector: Floats) -> Floats:
    """Rotation matrices of rotation vectors (..., 3)."""
    angle = np.linalg.norm(vector, axis=-1)[..., None, None]
    x, y, z = np.moveaxis(vector, -1, 0)
    zero = np.zeros_like(x)
    skew = np.stack([zero, -z, y, z, zero, -x, -y, x, zero], axis=-1).reshape((*x.shape, 3, 3))
    half = np.sinc(angle / (2 * np.pi))  # sin(a/2) / (a/2)
    result: Floats = np.eye(3) + np.sinc(angle / np.pi) * skew + 0.5 * half**2 * (skew @ skew)
    return result


def draw_geometry(subject: Subject, rng: np.random.Generator, spread: float) -> dict[str, tuple[float, ...]]:
    """The default sizes, each leg's changed by up to `spread` (relative for lengths, in radians for
    angles).  Lengths that are zero by default become a small share of the others, or nothing that is
    multiplied by them would be checked.
    """
    units = {field.name: field.unit for kind in subject.geometry_types.values() for field in kind.fields}
    found = {}
    sizes = {name: np.array(subject.entry.sizes[name], dtype=float) for name in subject.fields}
    typical = float(np.median([np.abs(sizes[name]) for name in sizes if units[name] is not Unit.RADIAN]))
    for name, values in sizes.items():
        change = rng.uniform(-spread, spread, subject.code.legs)
        if units[name] is Unit.RADIAN:
            values = values + change
        else:
            values = np.where(values == 0, np.abs(change) * typical, values * (1 + change))
        found[name] = tuple(float(value) for value in values)
    return found


def draw(subject: Subject, seed: int, count: int, *, spread: float = 0.05) -> Batch:
    """So many configurations of one geometry near the default sizes; checks with one seed share them."""
    return _drawn(subject, seed, count, spread)


@lru_cache(maxsize=64)
def _drawn(subject: Subject, seed: int, count: int, spread: float) -> Batch:
    rng = np.random.default_rng(seed)
    for _ in range(20):
        geometry = draw_geometry(subject, rng, spread)
        found = (_draw if subject.code.legs == LEGS else draw_jaws)(subject, rng, count, geometry)
        if found is not None:
            for values in found.values():
                values.flags.writeable = False
            return Batch(subject, geometry, found)
    raise RuntimeError(
        f"{subject.identifier}: no geometry near the default sizes has {count} configurations that are "
        "reachable in every working mode"
    )


def _draw(
    subject: Subject, rng: np.random.Generator, count: int, geometry: Mapping[str, Any]
) -> Values | None:
    """Configurations of one geometry; None where they are too rare."""
    found: list[Values] = []
    have = 0
    for attempt in range(200):
        if attempt == 20 and not have:
            return None
        values = _candidates(subject, rng, 2 * count + 20)
        kept = _complete(subject, rng, values, geometry)
        found.append(kept)
        have += len(kept["p"])
        if have >= count:
            whole = {name: np.concatenate([values[name] for values in found])[:count] for name in found[0]}
            return whole | _forces(subject, rng, count) | _objects(subject, rng, count, geometry)
    return None


def _candidates(subject: Subject, rng: np.random.Generator, count: int) -> Values:
    """Poses about the home position, redundant coordinates in the working box, and random rates."""
    values: Values = {}
    middle = np.array(subject.entry.home.p)
    if subject.planar:
        values["p"] = middle + rng.uniform(-0.04, 0.04, (count, 2))
        values["phi"] = rng.uniform(-0.3, 0.3, count)
    else:
        values["p"] = middle + rng.uniform(-0.06, 0.06, (count, 3))
        axis = rng.normal(size=(count, 3))
        axis /= np.linalg.norm(axis, axis=1, keepdims=True)
        values["Q"] = rotations(axis * rng.uniform(0, radians(30), (count, 1)))
    values["redundant"] = redundant_box(subject, rng, count)
    around = rng.uniform(0.05, 0.3, (count, LEGS, 2)) * np.array([-1.0, 1.0])
    turns = 2 * np.pi * rng.integers(-1, 2, (count, LEGS, 1))
    values["box"] = values["redundant"][:, :, None] + around + turns
    freedom = subject.platform.space.degrees_of_freedom
    for name, shape in (
        ("twist", (freedom,)),
        ("twist_rate", (freedom,)),
        ("redundant_rates", (LEGS,)),
        ("redundant_accelerations", (LEGS,)),
        ("swivel", (LEGS,)),
        ("swivel_rates", (LEGS,)),
        ("swivel_accelerations", (LEGS,)),
        ("theta_dot", (LEGS, subject.subleg.n)),
        ("theta_ddot", (LEGS, subject.subleg.n)),
    ):
        values[name] = rng.uniform(-1, 1, (count, *shape))
    values |= _measurements(subject, rng, values)
    values["side"] = np.where(np.arange(count) % 2 == 0, 1.0, -1.0)
    values["turned"] = np.ones(count)  # end points of one platform seldom fit the one turned over
    return values


def _forces(subject: Subject, rng: np.random.Generator, count: int) -> Values:
    """Forces of any size; statics are linear in them."""
    shapes = {
        "wrench": (subject.platform.space.degrees_of_freedom,),
        "redundant_forces": (LEGS,),
        "swivel_forces": (LEGS,),
        "actuator_forces": (LEGS, subject.subleg.n),
    }
    return {name: rng.uniform(-1, 1, (count, *shape)) for name, shape in shapes.items()}


def _objects(subject: Subject, rng: np.random.Generator, count: int, geometry: Mapping[str, Any]) -> Values:
    """Jaws, and objects between them, which weigh less than friction holds."""
    d = subject.platform.space.dimension
    still: Values = {"p": np.zeros((1, d)), "phi": np.zeros(1), "Q": np.eye(3)[None]}
    near, far = (
        evaluate(subject, "end_points", {**still, "redundant": np.full((1, LEGS), value)}, geometry)["s"]
        for value in (0.0, 0.03)
    )
    return {
        "contacts": far - near + rng.uniform(-0.005, 0.005, (count, LEGS, d)),
        "mass_centre": rng.uniform(-0.003, 0.003, (count, d)),
        "weight": rng.uniform(-0.3, 0.3, (count, d)),
        "normal_forces": rng.uniform(1.5, 2.0, (count, LEGS)),
        "friction": rng.uniform(20.0, 30.0, count),
        "jaws": rng.uniform(0.0, 0.03, (count, LEGS)),
        "opening": rng.uniform(0.1, 0.2, count),
        "centre": rng.uniform(-0.01, 0.01, (count, 2)),
    }


def _measurements(subject: Subject, rng: np.random.Generator, values: Values) -> Values:
    """Encoders with errors, a pose nearby, and weights."""
    count = len(values["p"])
    error = 0.0005 if subject.platform.redundant_joint.kind == "revolute" else 0.00005
    found = {"measured": values["redundant"] + rng.uniform(-error, error, (count, LEGS))}
    found["p_near"] = values["p"] + rng.uniform(-NEAR, NEAR, values["p"].shape)
    if subject.planar:
        found["phi_near"] = values["phi"] + rng.uniform(-0.05, 0.05, count)
    else:
        found["Q_near"] = values["Q"] @ rotations(rng.uniform(-0.03, 0.03, (count, 3)))
    found["tolerance"] = np.full(count, 0.05)
    found["characteristic_length"] = rng.uniform(0.1, 2, count)
    found["weights"] = rng.uniform(300, 3000, (count, 3))
    return found


def redundant_box(subject: Subject, rng: np.random.Generator, count: int, wide: bool = False) -> Floats:
    """Redundant coordinates inside the working box: well inside, or almost all of it."""
    if subject.platform.redundant_joint.kind == "revolute":
        low, high = (30.5, 149.5) if wide else (60.0, 130.0)
        return rng.uniform(radians(low), radians(high), (count, LEGS))
    return rng.uniform(_least_slide(subject) if wide else 0.08, 0.15, (count, LEGS))


def _least_slide(subject: Subject) -> float:
    """Beyond it det J_a has one sign: slides of planar (b) count from the foot of b_i on their line."""
    sizes = subject.entry.sizes
    if "b_x" not in sizes:
        return 0.001
    return 0.001 + float(np.hypot(sizes["b_x"], sizes["b_y"]).max())


def _complete(
    subject: Subject, rng: np.random.Generator, values: Values, geometry: Mapping[str, Any]
) -> Values:
    """What follows from pose and redundant coordinates, for those configurations that are fit for checks."""
    values = {**values, **evaluate(subject, "end_points", values, geometry)}
    every = _every_mode(subject, rng, values, geometry)
    count, modes = len(values["p"]), len(subject.code.mode_signs)
    fit = np.stack(
        [_conditioned(subject, {**values, "theta": every[:, :, mode]}, geometry) for mode in range(modes)], -1
    )
    values["fit"] = fit
    good = np.isfinite(every).all(axis=(1, 2, 3)) & fit.any(axis=-1).all(axis=-1)
    regularity = _regularity(subject, {**values, "theta": every[:, :, 0]}, geometry)
    good &= (regularity > (CONDITION / 2) ** 2).all(axis=1)
    # each leg in any of the modes that are fit for checks
    chosen = np.argmax(rng.random((count, LEGS, modes)) * fit, axis=-1)
    rows, legs = np.arange(count)[:, None], np.arange(LEGS)[None, :]
    values["theta"] = every[rows, legs, chosen]
    values["mode"] = np.array(subject.code.mode_signs, dtype=float)[chosen]
    if np.size(subject.code.assembly_signs):
        values["assembly"] = assemblies_of(subject, values, geometry)
    values["s_near"] = values["s"] + rng.uniform(-NEAR, NEAR, values["s"].shape)
    turns = rng.integers(-2, 3, values["theta"].shape) * np.array(subject.code.angular)
    spread = 2.5 if subject.subleg.has_inverse else NEAR  # where it is the start of Newton steps
    near = rng.uniform(-spread, spread, values["theta"].shape)
    values["theta_near"] = values["theta"] + near + 2 * np.pi * turns
    if any(function.name == "forward_encoders_1" for function in subject.code.functions):
        found = evaluate(subject, "forward_encoders_1", values, geometry)
        best, other = np.abs(found["mismatch"]).T
        good &= (best < other / 4) & (other > 0.002)
    return {name: array[good] for name, array in values.items()}


def _every_mode(
    subject: Subject, rng: np.random.Generator, values: Values, geometry: Mapping[str, Any]
) -> Floats:
    """The joints in every working mode, (count, 3, modes, n); where there is no closed form, those to which
    Newton steps from random joints lead, and NaN where none of some starts does.
    """
    if subject.subleg.has_inverse:
        return evaluate(subject, "subleg_inverse", values, geometry)["theta"]
    angular, count = np.array(subject.code.angular), len(values["p"])
    repeated = {
        name: np.concatenate([array] * STARTS) for name, array in values.items()
    }  # all starts at once
    shape = (STARTS * count, LEGS, subject.subleg.n)
    start = np.where(angular, rng.uniform(-np.pi, np.pi, shape), rng.uniform(-0.5, 0.5, shape))
    theta = evaluate(subject, "inverse", {**repeated, "theta_near": start}, geometry)["theta"]
    theta = np.where(angular, theta - 2 * np.pi * np.round(theta / (2 * np.pi)), theta)
    closes = closure_error(subject, repeated["s"], theta, geometry) < 1e-12
    closes, theta = closes.reshape(STARTS, count, LEGS), theta.reshape(STARTS, count, LEGS, -1)
    first = np.argmax(closes, axis=0)  # of each leg
    chosen = np.take_along_axis(theta, first[None, ..., None], axis=0)[0]
    found: Floats = np.where(np.any(closes, axis=0)[..., None], chosen, np.nan)
    return found[:, :, None, :]


def closure_error(subject: Subject, s: Floats, theta: Floats, geometry: Mapping[str, Any]) -> Floats:
    """How far each leg is from closing, (count, 3)."""
    errors = []
    for leg in range(LEGS):
        inputs = {"s": list(s[:, leg].T), "theta": list(theta[:, leg].T)}
        with np.errstate(all="ignore"):
            residual = subject.kernel("subleg", "closure", inputs, geometry, leg, ARRAYS)["residual"]
        errors.append(np.abs(stack(residual, len(s))).max(axis=-1))
    return np.stack(errors, axis=-1)


def _conditioned(subject: Subject, values: Values, geometry: Mapping[str, Any]) -> Any:
    """Whether each leg is far enough from its singularities."""
    found = evaluate(subject, "singularity", values, geometry)
    return (np.abs(found["factors"]) > CONDITION).all(axis=2)


def _regularity(subject: Subject, values: Values, geometry: Mapping[str, Any]) -> Floats:
    """The squared, scaled factors of det J, which the kernel `solve` computes beside the twist."""
    twist = subject.code.function("twist")
    calls = [call for call in twist.calls if call.stage is Stage.PLATFORM]
    (solve,) = [call for call in calls if call.kernel == "solve"]
    name = solve.variable_out("regularity")
    kernel = subject.derived("platform", "solve")
    port = replace(kernel.output_port("regularity"), name=name)
    function = replace(twist, name="regularity", outputs=(port,))
    count = len(values["p"])
    inputs = {port.name: list(values[port.name].reshape(count, -1).T) for port in function.inputs}
    with np.errstate(all="ignore"):
        return stack(subject.function(function, inputs, geometry, ARRAYS)[name], count)


def size_of(port: Port) -> int:
    """Elements of a port in the robot's function."""
    return prod(port.full_shape)
