"""Position: loops close, what goes there comes back, modes and statuses mean what they say."""

from __future__ import annotations

import numpy as np

from krhpr.codegen.kernel import LEGS
from krhpr.codegen.status import Status
from krhpr.validation.differences import arc, call
from krhpr.validation.evaluation import CONDITION
from krhpr.validation.invariants.batch import close, runner
from krhpr.validation.numeric import Floats, Numeric
from krhpr.validation.outcome import Measured, Runner
from krhpr.validation.sampling import Batch
from krhpr.validation.scale import relative


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


def every_assembly(one: Numeric, count: int) -> list[dict[str, Floats]]:
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
        for assembly in every_assembly(one, len(batch)):
            ends = call(one, batch, "subleg_forward", theta=every[:, :, mode], **assembly)["s"]
            errors.append(np.abs(ends - s).max(axis=-1) / np.abs(s).max(axis=-1))
        ordered = np.sort(np.nan_to_num(errors, nan=np.inf), axis=0)
        fit = batch.values["fit"][:, :, mode]
        found.worse(np.where(fit, ordered[0], 0.0), f"mode {label}")
        if len(ordered) > 1:
            same = fit & ~(ordered[1] > 1e-6)
            found.worse(same.astype(float), f"two assembly modes are the same in mode {label}")


def inverse_after_forward(one: Numeric, batch: Batch, found: Measured) -> None:
    """The nearest of all working modes."""
    theta = batch.values["theta"]
    for index, assembly in enumerate(every_assembly(one, len(batch))):
        ends = call(one, batch, "subleg_forward", **assembly)["s"]
        every = call(one, batch, "subleg_inverse", s=ends)["theta"]
        gap = np.abs(arc(every, theta[:, :, None], one.subject.code.angular)).max(axis=-1)
        nearest = np.nanmin(np.where(np.isnan(gap), np.inf, gap), axis=-1)
        # the joints are well conditioned in the assembly mode of their end point, but perhaps not in others
        factors = call(one, batch, "singularity", s=ends)["factors"]
        fit = (np.abs(factors) > CONDITION).all(axis=-1)
        found.worse(np.where(fit, nearest, 0.0), f"assembly mode {index}")


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
    needed = [port.name for port in code.function("inverse").inputs if port.name not in ("mode", "swivel")]
    inputs = {name: batch.values[name] for name in needed}
    theta = one.call("inverse", inputs, batch.geometry)["theta"]
    signs = np.array(code.default_mode)
    mode = np.broadcast_to(signs, (len(batch), LEGS, len(signs)))
    wanted = call(one, batch, "inverse", mode=mode, swivel=np.zeros((len(batch), LEGS)))["theta"]
    gap = np.abs(theta - wanted)
    found.worse(np.where(np.isnan(theta) & np.isnan(wanted), 0.0, gap), "inverse")
    forward = {port.name: batch.values[port.name] for port in code.function("subleg_forward").inputs}
    forward.pop("assembly", None)
    here = np.isfinite(theta).all(axis=(1, 2))  # at a swivel of zero a leg may not reach its end point
    forward = {name: value[here] for name, value in (forward | {"theta": theta}).items()}
    ends = one.call("subleg_forward", forward, batch.geometry)["s"]
    found.worse(0.0 if here.any() else 1.0, "no configuration is reached by default")
    close(found, ends, batch.values["s"][here], "subleg_forward", 2)


def status_of_inverse(one: Numeric, batch: Batch, found: Measured) -> None:
    """Near and far poses: NaN, excess and status tell the same."""
    rng = np.random.default_rng(len(batch))
    wide = rng.uniform(-1.0, 1.0, batch.values["p"].shape)
    wide[:LEGS] = _to_the_base(batch)
    values = {"p": batch.values["p"] + wide}
    theta = call(one, batch, "inverse", **values)
    reach = call(one, batch, "inverse_status", **values)
    exists = np.isfinite(theta["theta"]).all(axis=-1)
    clear = np.abs(reach["excess"]) > 1e-9
    found.worse((clear & ((reach["excess"] <= 0) != exists)).astype(float), "excess and NaN")
    partly = np.isfinite(theta["theta"]).any(axis=-1)
    found.worse((partly != exists).astype(float), "a leg is either found whole or not at all")
    wanted = np.where(exists.all(axis=-1), 0, int(Status.UNREACHABLE_LEG_1) + np.argmin(exists, axis=-1))
    sure = clear.all(axis=-1)
    for name, status in (("inverse", theta["status"]), ("inverse_status", reach["status"])):
        found.worse((sure & (status != wanted)).astype(float), f"status of {name}")
    everywhere = one.subject.code.always_reachable
    both = exists.all() if everywhere else exists.any() and not exists.all()
    found.worse(0.0 if both else 1.0, "no poses within, or none out of reach")


def _to_the_base(batch: Batch) -> Floats:
    """By how far p is moved, in the first configurations, so that an end point is close to the base joint."""
    azimuth, radius = (np.array(batch.geometry[name]) for name in ("azimuth", "R_b"))
    d = batch.values["p"].shape[-1]
    base = (radius * np.stack([np.cos(azimuth), np.sin(azimuth), 0 * azimuth])).T[:, :d]
    moved: Floats = base - np.stack([batch.values["s"][leg, leg] for leg in range(LEGS)]) + 1e-3
    return moved


RUNNERS: dict[str, Runner] = {
    "loop closure": runner(loop_closure),
    "redundant coordinates": runner(redundant_coordinates),
    "forward after inverse": runner(forward_after_inverse),
    "inverse after forward": runner(inverse_after_forward),
    "modes": runner(modes),
    "signs of modes": runner(signs_of_modes),
    "defaults": runner(defaults),
    "status of inverse": runner(status_of_inverse),
}
