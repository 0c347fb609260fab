"""Proofs about statics: forces follow from velocities by virtual work, with any rates."""

from __future__ import annotations

from typing import Any

from krhpr.codegen.evaluate import evaluate_kernel
from krhpr.codegen.kernel import LEGS
from krhpr.validation.configurations import Configuration
from krhpr.validation.linear import (
    Matrix,
    apply,
    cross,
    determinant,
    dot,
    matrix,
    minus,
    plus,
    scaled,
    solve,
    transpose,
)
from krhpr.validation.numbers import Exact
from krhpr.validation.outcome import Measured, Runner
from krhpr.validation.proofs.robots import jacobians, proof
from krhpr.validation.proofs.sublegs import unit
from krhpr.validation.subject import Subject


def _coordinates(subject: Subject) -> dict[str, tuple[str, int]]:
    """The velocities that move the robot in every way: their names, those of the forces that do work on
    them, and how many there are.
    """
    found = {
        "twist": ("wrench", subject.platform.space.degrees_of_freedom),
        "redundant_rates": ("redundant_forces", LEGS),
    }
    return {**found, "swivel_rates": ("swivel_forces", LEGS)} if subject.subleg.redundant else found


def virtual_work(subject: Subject, here: Configuration, found: Measured) -> None:
    """One velocity after the other: the actuators' power is that of the force that does work on it."""
    forces = here.call("inverse_statics")["actuator_forces"]
    coordinates = _coordinates(subject)
    still = {name: [Exact(0)] * count for name, (_, count) in coordinates.items()}
    for name, (force, count) in coordinates.items():
        for index in range(count):
            moving = {**still, name: unit(count, index)}
            theta_dot = here.call("joint_rates", **moving)["theta_dot"]
            found.equal([dot(forces, theta_dot)], [here.values[force][index]], f"{force}[{index}]")


def non_redundant(subject: Subject, here: Configuration, found: Measured) -> None:
    """J_n and K_n against the rates and the forces of the joints; their lines are those of J and K."""
    result = here.call("jacobians_n")
    coordinates = _coordinates(subject)
    size, rows = sum(count for _, count in coordinates.values()), subject.platform.space.rows_per_leg
    J, K = matrix(result["J"], size), matrix(result["K"], LEGS * subject.subleg.n)
    still = {name: [Exact(0)] * count for name, (_, count) in coordinates.items()}
    column = 0
    for name, (_, count) in coordinates.items():
        for index in range(count):
            theta_dot = here.call("joint_rates", **{**still, name: unit(count, index)})["theta_dot"]
            found.equal(apply(K, theta_dot), [row[column] for row in J], f"{name}[{index}]")
            column += 1
    lines = [i for i in range(len(J)) if i % (len(J) // LEGS) < rows]
    of_twist = coordinates["twist"][1]
    wanted = jacobians(here)
    found.equal([x for i in lines for x in J[i][:of_twist]], [x for row in wanted[0] for x in row], "J")
    found.equal([x for i in lines for x in K[i]], [x for row in wanted[1] for x in row], "K")
    acting = [[x] for force, _ in coordinates.values() for x in here.values[force]]
    along = [row[0] for row in solve(transpose(J), acting)]
    found.equal(here.call("inverse_statics")["actuator_forces"], apply(transpose(K), along), "f")


def torques(subject: Subject, here: Configuration, found: Measured) -> None:
    """The kernel multiplies with the transposes of any three blocks."""
    kernel = subject.derived("subleg", "torques")
    given = {
        port.name: [Exact(k * k - leg - 2) / (k + 3) for leg in range(LEGS) for k in range(port.size // LEGS)]
        for port in kernel.inputs
    }
    n, rows = subject.subleg.n, subject.platform.space.rows_per_leg
    wanted: list[Any] = []
    for leg, block in enumerate(matrix(given["K_n"], len(given["K_n"]) // LEGS)):
        forces = given["line_forces"][rows * leg : rows * leg + rows]
        forces += [given[name][leg] for name in ("redundant_forces", "swivel_forces") if name in given]
        wanted += apply(transpose(matrix(block, n)), forces)
    got = evaluate_kernel(kernel, given, None, here.arithmetic)["actuator_forces"]
    found.equal(got, wanted, "f")


def transposed(subject: Subject, here: Configuration, found: Measured) -> None:
    """f = K^T J^-T F where nothing but the wrench acts."""
    J, K = jacobians(here)
    nothing = {
        force: [Exact(0)] * count for force, count in _coordinates(subject).values() if force != "wrench"
    }
    column = [[x] for x in here.values["wrench"]]
    along = [row[0] for row in solve(transpose(J), column)]
    got = here.call("inverse_statics", **nothing)["actuator_forces"]
    found.equal(got, apply(transpose(K), along), "f")


def there_and_back(subject: Subject, here: Configuration, found: Measured) -> None:
    """forward_statics undoes inverse_statics, and where nothing is redundant in the legs the other way
    round.
    """
    forces = here.call("inverse_statics")["actuator_forces"]
    result = here.call("forward_statics", actuator_forces=forces)
    for force, _ in _coordinates(subject).values():
        found.equal(result[force], here.values[force], force)
    result = here.call("forward_statics")
    names: dict[str, Any] = {force: result[force] for force, _ in _coordinates(subject).values()}
    again = here.call("inverse_statics", **names)["actuator_forces"]
    found.equal(again, here.values["actuator_forces"], "actuator_forces")


def opening(subject: Subject, here: Configuration, found: Measured) -> None:
    """Every face is as far from the centre as half the opening, along the slide."""
    result = here.call("opening")
    radius = result["opening"][0] / 2
    balance = [Exact(0), Exact(0)]
    for leg in range(LEGS):
        d, jaw = here.leg("redundant", leg)[0], here.leg("jaws", leg)[0]
        end, further = (
            here.kernel("platform", "line_of_redundant", leg, redundant=value)["point"]
            for value in (d, d + 1)
        )
        slide = minus(further, end)
        face = minus(minus(end, scaled(jaw, slide)), result["centre"])
        found.equal([dot(slide, face)], [radius], f"face {leg + 1}")
        balance = plus(balance, scaled(result["shares"][leg], slide))
    found.equal(balance, [Exact(0), Exact(0)], "balance of the shares")
    found.equal([sum(result["shares"], Exact(0))], [Exact(1)], "sum of the shares")
    again = here.call("redundant_of_opening", opening=result["opening"], centre=result["centre"])
    found.equal(again["redundant"], here.values["redundant"], "redundant")


def grasp(subject: Subject, here: Configuration, found: Measured) -> None:
    """The object's equilibrium, its determinant, and the power of the contacts."""
    d = subject.platform.space.dimension
    result = here.call("grasp")
    Q, v = matrix(here.values["Q"], d), here.values
    contacts, forces = matrix(v["contacts"], d), matrix(result["contact_forces"], d)
    frames = [_jaw_frame(here, leg, Q) for leg in range(LEGS)]
    applied = [apply(transpose(frame), force) for frame, force in zip(frames, forces, strict=True)]
    found.equal([force[0] for force in forces], v["normal_forces"], "f_x")
    arms = [apply(Q, minus(contact, v["mass_centre"])) for contact in contacts]
    nothing = [Exact(0)] * (3 if d == 3 else 1)
    total, moment = list(v["weight"]), nothing
    for arm, force in zip(arms, applied, strict=True):
        total, moment = plus(total, force), plus(moment, _moment(arm, force))
    found.equal(total, [Exact(0)] * d, "forces on the object")
    found.equal(moment, nothing, "moments on the object")
    columns = [
        [*axis, *_moment(arm, axis)] for frame, arm in zip(frames, arms, strict=True) for axis in frame[1:]
    ]
    size = sum((dot(contact[:2], contact[:2]) for contact in contacts), Exact(0))
    squared = determinant(columns) * determinant(columns)
    scale, wanted = (size, 1) if d == 2 else (size * size * size, 2)
    determined = _determined(here)
    assert len(determined) == wanted
    product = determined[0] if d == 2 else determined[0] * determined[1]
    found.equal([product * scale], [squared], "determinant")
    # jaw i moves with the platform and along its slide
    power = Exact(0)
    for leg, (contact, force) in enumerate(zip(contacts, applied, strict=True)):
        arm, twist = apply(Q, contact), v["twist"]
        turned = cross(twist[3:], arm) if d == 3 else scaled(twist[2], [-arm[1], arm[0]])
        along = scaled(-v["redundant_rates"][leg], frames[leg][0])
        power = power + dot(force, plus(plus(twist[:d], turned), along))
    wanted_power = dot(result["wrench"], v["twist"]) + dot(result["redundant_forces"], v["redundant_rates"])
    found.equal([wanted_power], [power], "power at the contacts")
    for leg, force in enumerate(forces):
        held = v["friction"][0] * force[0]
        margin = held * held - dot(force[1:], force[1:])
        found.equal([result["friction_margins"][leg]], [margin], f"margin of contact {leg + 1}")


def _jaw_frame(here: Configuration, leg: int, Q: Matrix) -> Matrix:
    """x_i against where S_i moves with d_i, z_i = z', y_i = z_i x x_i, in the base frame, as rows."""
    d = here.leg("redundant", leg)[0]
    end, further = (
        here.kernel("platform", "line_of_redundant", leg, redundant=value)["point"] for value in (d, d + 1)
    )
    x = minus(end, further)
    across = [-x[1], x[0]]
    if len(Q) == 2:
        return [apply(Q, x), apply(Q, across)]
    nothing, one = Exact(0), Exact(1)
    return [apply(Q, [*x, nothing]), apply(Q, [*across, nothing]), apply(Q, [nothing, nothing, one])]


def _moment(arm: list[Any], force: list[Any]) -> list[Any]:
    return cross(arm, force) if len(arm) == 3 else [arm[0] * force[1] - arm[1] * force[0]]


def _determined(here: Configuration) -> list[Any]:
    """What the function guards beside its outputs."""
    kernel = here.subject.derived("platform", "grasp")
    slides = [x for leg in range(LEGS) for x in here.kernel("platform", "tie", leg)["slide"]]
    inputs = {port.name: here.values.get(port.name, slides) for port in kernel.inputs}
    return evaluate_kernel(kernel, inputs, None, here.arithmetic)["determined"]


RUNNERS: dict[str, Runner] = {
    "non-redundant view": proof(non_redundant),
    "virtual work": proof(virtual_work),
    "transposed blocks": proof(torques),
    "(J^-1 K)^T": proof(transposed),
    "opening": proof(opening),
    "grasp": proof(grasp),
    "statics there and back": proof(there_and_back),
}
