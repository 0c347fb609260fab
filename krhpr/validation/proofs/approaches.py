"""Proofs about Newton steps and encoders: at the pose they stay, beside it errors are squared."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

from krhpr.validation.arithmetic import BALLS
from krhpr.validation.check import Check
from krhpr.validation.configurations import Configuration, configuration_in_balls
from krhpr.validation.draw import Draw
from krhpr.validation.numbers import Ball, ball_precision
from krhpr.validation.outcome import Measured, Runner
from krhpr.validation.subject import Outputs, Subject


def newton(subject: Subject, check: Check, count: int) -> Measured:
    """From the pose itself nothing moves; from beside it one step squares the distance."""
    found = Measured(check)
    source = Draw(check.seed)
    with ball_precision():
        for _ in range(count):
            here = configuration_in_balls(subject, source)
            start, state = _beside(here)
            after = _platform(here, "newton_step", state=state, **start)
            found.equal(after["change"], [Ball(0)], "change at the pose")
            found.equal(after["state_next"], state, "the state at the pose")
            pose = _platform(here, "newton_pose", state=state, **start)
            for name in ("p", "phi" if subject.planar else "Q", "redundant"):
                found.equal(pose[name], here.values[name], f"{name} where steps end")
            small = Ball(Fraction(1, 10**15))
            for index in range(3):
                moved = [x + (small if i == index else Ball(0)) for i, x in enumerate(state)]
                end = _platform(here, "newton_step", state=moved, **start)["state_next"]
                gaps = [abs((a - b).to_float()) for a, b in zip(end, state, strict=True)]
                found.equal([Ball(int(max(gaps) < 1e-25))], [Ball(1)], f"a step from beside it, {index}")
            found.samples += 1
    return found


def encoders(subject: Subject, check: Check, count: int) -> Measured:
    """With what encoders would measure, every approach gives the pose, and its orientation as it is."""
    found = Measured(check)
    source = Draw(check.seed)
    turn = "phi" if subject.planar else "Q"
    with ball_precision():
        for _ in range(count):
            here = configuration_in_balls(subject, source)
            for function in subject.code.functions:
                if not function.name.startswith(("forward_encoders", "forward_gauss_newton")):
                    continue
                (port,) = (port for port in function.inputs if port.name == "measured")
                measured = here.values["redundant"][: port.size]
                weights = [Ball(x) for x in (1000, 700, 1500)]
                given = {"measured": measured, "tolerance": [Ball(Fraction(1, 100))], "weights": weights}
                result = here.call(function.name, **given)
                for name in ("p", turn):
                    result[name] = result[name][: len(here.values[name])]  # the first of two
                    found.equal(result[name], here.values[name], f"{function.name}: {name}")
                if "raw" in result:
                    found.equal(result["raw"], here.values["Q"], f"{function.name}: raw")
                size = 1 if function.name.endswith("_1") else len(result["mismatch"])  # of two solutions
                zero = [Ball(0)] * size
                found.equal(result["mismatch"][:size], zero, f"{function.name}: mismatch")
            found.samples += 1
    return found


def _beside(here: Configuration) -> tuple[Outputs, list[Any]]:
    """Where steps start with O' a known way beside the pose, along x_1, and the state of the pose itself."""
    Q, p = here.values["Q"], here.values["p"]
    first = _platform(here, "newton_start", p_near=[x + Ball(1) for x in p], Q_near=Q)
    along = [first["axes"][3 * i] for i in range(3)] if "axes" in first else [Ball(1), Ball(0)]
    way = Ball(Fraction(1, 1000))
    start = _platform(
        here, "newton_start", p_near=[x + way * a for x, a in zip(p, along, strict=True)], Q_near=Q
    )
    state = list(start["start"])
    state[1] = state[1] - way
    return start, state


def _platform(here: Configuration, kernel: str, **inputs: Any) -> Outputs:
    """A kernel of the platform; end points and ties are those of the configuration."""
    given = {"s": here.values["s"], **here.subject.ties(here.geometry, BALLS), **inputs}
    return here.subject.kernel("platform", kernel, given, here.geometry, 0, BALLS)


RUNNERS: dict[str, Runner] = {"Newton steps of the platform": newton, "encoders": encoders}
