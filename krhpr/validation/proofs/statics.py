"""Proofs about statics: forces follow from velocities by virtual work, with any rates."""

from __future__ import annotations

from typing import Any

from krhpr.codegen.kernel import LEGS
from krhpr.validation.configurations import Configuration
from krhpr.validation.linear import apply, dot, minus, plus, scaled, solve, transpose
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


RUNNERS: dict[str, Runner] = {
    "virtual work": proof(virtual_work),
    "(J^-1 K)^T": proof(transposed),
    "opening": proof(opening),
    "statics there and back": proof(there_and_back),
}
