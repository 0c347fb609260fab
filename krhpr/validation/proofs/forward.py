"""Proofs about the forward kinematics of the platform, in ball arithmetic: its formulas have roots."""

from __future__ import annotations

from typing import Any

from krhpr.codegen.kernel import LEGS
from krhpr.validation.arithmetic import BALLS
from krhpr.validation.check import Check
from krhpr.validation.configurations import configuration_in_balls
from krhpr.validation.draw import Draw
from krhpr.validation.numbers import Ball, ball_precision, same
from krhpr.validation.outcome import Measured, Runner
from krhpr.validation.subject import Subject


def assembly_modes(subject: Subject, check: Check, count: int) -> Measured:
    """Every solution closes the platform, has the det J of its redundant coordinates, and one is the pose."""
    found = Measured(check)
    source = Draw(check.seed)
    with ball_precision():
        for _ in range(count):
            here = configuration_in_balls(subject, source)
            result = here.call("forward_all", turned=[Ball(1)])
            ports = {port.name: port for port in subject.code.function("forward_all").outputs}
            modes = ports["det_J"].size
            poses = []
            for mode in range(modes):
                one = {
                    name: values[ports[name].size // modes * mode :][: ports[name].size // modes]
                    for name, values in result.items()
                    if name in ports and ports[name].shape
                }
                pose = {name: one[name] for name in ("p", "phi" if subject.planar else "Q")}
                residual = here.call("constraints", **pose)["residual"]
                found.equal(residual, [Ball(0)] * len(residual), f"solution {mode + 1} closes")
                product: Any = Ball(1)
                for factor in here.call("type_2_of_redundant", redundant=one["redundant"])["type_2"]:
                    product = product * factor
                found.equal(one["det_J"], [product], f"det J of solution {mode + 1}")
                again = here.call("redundant_coordinates", **pose)["redundant"]
                found.equal(one["redundant"], again, f"redundant coordinates of solution {mode + 1}")
                poses.append([*one["p"], *one["redundant"]])
            wanted = [*here.values["p"], *here.values["redundant"]]
            there = [all(same(a, b) for a, b in zip(pose, wanted, strict=True)) for pose in poses]
            found.equal([Ball(sum(there))], [Ball(1)], "solutions that are the pose")
            found.samples += 1
    return found


def mode_on_one_side(subject: Subject, check: Check, count: int) -> Measured:
    """The kernel that gives one solution against the one that gives all, on both sides."""
    found = Measured(check)
    source = Draw(check.seed)
    with ball_precision():
        for _ in range(count):
            here = configuration_in_balls(subject, source)
            every = here.call("forward_all", turned=[Ball(1)])
            legs = [here.kernel("platform", "tie", leg) for leg in range(LEGS)]
            ties = {name: [value for leg in legs for value in leg[name]] for name in legs[0]}
            names = ("p", "phi" if subject.planar else "Q", "redundant")
            for place, side in enumerate((1, -1)):
                inputs = {"s": here.values["s"], **ties, "side": [Ball(side)]}
                one = subject.kernel("platform", "assembly_mode", inputs, here.geometry, 0, BALLS)
                for name in names:
                    size = len(one[name])
                    wanted = every[name][size * place : size * (place + 1)]
                    found.equal(one[name], wanted, f"{name} on side {side:+d}")
                margins = here.call("type_2_of_redundant", redundant=one["redundant"])["margins"]
                right = (margins[0] * Ball(side)).to_float() > 0
                found.equal([Ball(int(right))], [Ball(1)], f"side {side:+d}")
            found.samples += 1
    return found


RUNNERS: dict[str, Runner] = {
    "assembly modes close": assembly_modes,
    "the mode on one side": mode_on_one_side,
}
