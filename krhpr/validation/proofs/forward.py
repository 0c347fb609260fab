"""Proofs about the forward kinematics of the platform, in ball arithmetic: its formulas have roots."""

from __future__ import annotations

from fractions import Fraction
from math import prod
from typing import Any

from krhpr.validation.arithmetic import BALLS
from krhpr.validation.check import Check
from krhpr.validation.configurations import Configuration, configuration_in_balls
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
                found.equal(one["det_J"], [_det_J(here, one["redundant"])], f"det J of solution {mode + 1}")
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
            ties = subject.ties(here.geometry, BALLS)
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


def sextic(subject: Subject, check: Check, count: int) -> Measured:
    """The sextic by its definition at any T, its root at the pose, and the pose at its root."""
    found = Measured(check)
    source = Draw(check.seed)
    with ball_precision():
        for _ in range(count):
            here = configuration_in_balls(subject, source)
            inputs: dict[str, list[Any]] = {"s": here.values["s"], "turned": [Ball(1)]}
            inputs |= subject.ties(here.geometry, BALLS)
            result = subject.kernel("platform", "sextic", inputs, here.geometry, 0, BALLS)
            for _ in range(3):
                T = Ball(source.nonzero())
                wanted = _by_definition(inputs["anchor"], inputs["length"], result["points"], T)
                found.equal([_value(result["sextic"], T, Ball(1))], [wanted], "the sextic at any T")
            cosine, sine = _turn(here, result)
            root = [sine, cosine + Ball(1)]  # tan(phi / 2) = sin / (1 + cos)
            found.equal([_value(result["sextic"], *root)], [Ball(0)], "the pose is a root")
            inputs["root"] = root
            inputs |= {name: result[name] for name in ("points", "axes") if name in result}
            pose = subject.kernel("platform", "assembly", inputs, here.geometry, 0, BALLS)
            for name in ("p", "phi" if subject.planar else "Q", "redundant"):
                found.equal(pose[name], here.values[name], f"{name} at the root")
            found.equal(pose["miss"], [Ball(0)], "miss at the root")
            # beside the root the Newton steps lead back to it, squaring the distance each time
            inputs["root"] = [sine + Ball(Fraction(1, 10**7)), cosine + Ball(1)]
            beside = subject.kernel("platform", "assembly", inputs, here.geometry, 0, BALLS)
            gaps = [(a - b).to_float() for a, b in zip(beside["p"], here.values["p"], strict=True)]
            found.equal([Ball(int(max(map(abs, gaps)) < 1e-20))], [Ball(1)], "beside the root")
            found.equal(pose["det_J"], [_det_J(here, pose["redundant"])], "det J at the root")
            found.samples += 1
    return found


def _det_J(here: Configuration, redundant: list[Any]) -> Any:
    """det J from its factors, which depend on the redundant coordinates alone."""
    factors = here.call("type_2_of_redundant", redundant=redundant)["type_2"]
    return prod(factors, start=Ball(1))


def _value(coefficients: list[Any], x: Any, y: Any) -> Any:
    """A polynomial in T = x / y, times a power of y."""
    total: Any = Ball(0)
    for power, coefficient in enumerate(coefficients):
        term = coefficient
        for _ in range(power):
            term = term * x
        for _ in range(len(coefficients) - 1 - power):
            term = term * y
        total = total + term
    return total


def _turn(here: Configuration, result: dict[str, list[Any]]) -> tuple[Any, Any]:
    """Cosine and sine of the platform's angle in the intermediate frame."""
    if here.subject.planar:
        phi = here.values["phi"][0]
        return phi.cos(), phi.sin()
    Q, axes = here.values["Q"], result["axes"]
    first, second = (sum((axes[3 * i + j] * Q[3 * i] for i in range(3)), Ball(0)) for j in (0, 1))
    return first, second


def _by_definition(anchors: list[Any], lengths: list[Any], points: list[Any], T: Any) -> Any:
    """(1 + T^2)^3 (|e_2 z_3 - e_3 z_2|^2 - 4 l_1^2 D^2) with the links' vectors at the angle 2 arctan(T)."""
    norm = Ball(1) + T * T
    c, s = (Ball(1) - T * T) / norm, (T + T) / norm
    z, e = [], []
    for k in (1, 2):
        x, y = anchors[2 * k] - anchors[0], anchors[2 * k + 1] - anchors[1]
        z_k = (
            c * x - s * y - (points[2 * k] - points[0]),
            s * x + c * y - (points[2 * k + 1] - points[1]),
        )
        z.append(z_k)
        e.append(lengths[k] * lengths[k] - lengths[0] * lengths[0] - z_k[0] * z_k[0] - z_k[1] * z_k[1])
    u, v = (e[0] * z[1][j] - e[1] * z[0][j] for j in (0, 1))
    D = z[0][0] * z[1][1] - z[0][1] * z[1][0]
    return norm * norm * norm * (u * u + v * v - Ball(4) * lengths[0] * lengths[0] * D * D)


RUNNERS: dict[str, Runner] = {
    "assembly modes close": assembly_modes,
    "the mode on one side": mode_on_one_side,
    "sextic": sextic,
}
