"""Proofs about what encoders measure, right or wrong: mismatches, and where they tell no orientation."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

from krhpr.validation.arithmetic import BALLS
from krhpr.validation.check import Check
from krhpr.validation.configurations import Configuration, configuration_in_balls
from krhpr.validation.draw import Draw
from krhpr.validation.linear import dot, matrix, minus
from krhpr.validation.numbers import Ball, ball_precision, sqrt
from krhpr.validation.outcome import Measured, Runner
from krhpr.validation.proofs.misfits import placed, squared_lengths
from krhpr.validation.subject import Outputs, Subject

TOLERANCE = Fraction(1, 30)


def mismatches(subject: Subject, check: Check, count: int) -> Measured:
    """With encoders that are wrong: what the kernels compare with zero and with tolerances, from the end
    points in the base frame and from where encoders have them in the platform.
    """
    found = Measured(check)
    source = Draw(check.seed)
    with ball_precision():
        for _ in range(count):
            here = configuration_in_balls(subject, source)
            measured = [x + Ball(source.nonzero(-0.01, 0.01)) for x in here.values["redundant"]]
            s = matrix(here.values["s"], 2 if subject.planar else 3)
            ends = _ends(here, measured)
            for encoders in (2, 3):
                result = _with_encoders(here, measured[:encoders])
                what = f"{encoders} encoders"
                found.equal(result["spread"], [_spread(s, ends[:encoders])], f"{what}: spread")
                if not subject.planar:
                    found.equal(result["flatness"], [_sine_2(s)], f"{what}: flatness")
                pairs = [(i, j) for i in range(encoders) for j in range(i + 1, encoders)]
                gaps = [_apart(s[i], s[j]) - _apart(ends[i], ends[j]) for i, j in pairs]
                found.equal(result["mismatch"], gaps, f"{what}: mismatch")
                worst = max((abs(gap) for gap in gaps), key=Ball.to_float)
                found.equal(result["agreement"], [Ball(TOLERANCE) - worst], f"{what}: agreement")
            found.samples += 1
    return found


def one_encoder(subject: Subject, check: Check, count: int) -> Measured:
    """With one encoder that is wrong: both poses have the end point where it says and the second link as long
    as it is; the third is longer by what the kernel says, and by less in the first.
    """
    found = Measured(check)
    source = Draw(check.seed)
    d = 2 if subject.planar else 3
    with ball_precision():
        for _ in range(count):
            here = configuration_in_balls(subject, source)
            # so little that there are poses still
            measured = here.values["redundant"][0] + Ball(source.nonzero()) / Ball(10**6)
            given = {"measured": [measured], "tolerance": [Ball(TOLERANCE)]}
            result = here.call("forward_encoders_1", **given)
            lengths = subject.ties(here.geometry, BALLS)["length"]
            gaps = []
            for which in range(2):
                p, Q = placed(here, result, which)
                pose = {"p": p, "Q": [x for row in Q for x in row], "redundant": measured}
                if subject.planar:
                    pose["phi"] = result["phi"][which]
                end = here.kernel("platform", "end_point", 0, **pose)["s"]
                found.equal(end, here.values["s"][:d], f"pose {which}: S_1")
                _, second, third = map(sqrt, squared_lengths(here, result, which))
                found.equal([second], [lengths[1]], f"pose {which}: the second link")
                gaps.append(third - lengths[2])
            found.equal(result["mismatch"], gaps, "the third link")
            found.worse(float(abs(gaps[0]) > abs(gaps[1])), "the second pose fits better")
            agreement = _kernel(here, "one_encoder", **given)["agreement"]
            found.equal(agreement, [Ball(TOLERANCE) - abs(gaps[0])], "agreement")
            found.samples += 1
    return found


def _apart(a: list[Any], b: list[Any]) -> Any:
    arm = minus(a, b)
    return sqrt(dot(arm, arm))


def _sine_2(points: list[list[Any]]) -> Any:
    """Of the angle at the first of three points."""
    a, b = (minus(point, points[0]) for point in points[1:])
    return Ball(1) - dot(a, b) * dot(a, b) / (dot(a, a) * dot(b, b))


def _spread(s: list[list[Any]], ends: list[list[Any]]) -> Any:
    """Of three ends: as `_sine_2`.  Of two: their squared distance over that and what it is measured by."""
    if len(ends) == 3:
        return _sine_2(ends)
    side, apart = minus(s[1], s[0]), minus(ends[1], ends[0])
    return dot(apart, apart) / (dot(side, side) + sum((dot(end, end) for end in ends), Ball(0)))


def _ends(here: Configuration, measured: list[Any]) -> list[list[Any]]:
    """The end points in the platform's plane."""
    d = 2 if here.subject.planar else 3
    still: dict[str, Any] = {"p": [Ball(0)] * d, "phi": Ball(0)}
    still["Q"] = [Ball(int(i == j)) for i in range(d) for j in range(d)]
    return [
        here.kernel("platform", "end_point", leg, redundant=value, **still)["s"][:2]
        for leg, value in enumerate(measured)
    ]


def _with_encoders(here: Configuration, measured: list[Any]) -> Outputs:
    return _kernel(here, {2: "two_encoders", 3: "three_encoders"}[len(measured)], measured, [Ball(TOLERANCE)])


def _kernel(here: Configuration, name: str, measured: list[Any], tolerance: list[Any]) -> Outputs:
    """A kernel of encoders: end points and ties are those of the configuration."""
    kernel = here.subject.derived("platform", name)
    known = {
        **here.subject.ties(here.geometry, BALLS),
        "s": here.values["s"],
        "measured": measured,
        "turns": [entry for x in measured for entry in (x.cos(), x.sin())],
        "tolerance": tolerance,
    }
    inputs = {port.name: known[port.name] for port in kernel.inputs}
    return here.subject.kernel("platform", kernel, inputs, here.geometry, 0, BALLS)


RUNNERS: dict[str, Runner] = {
    "encoders that are wrong": mismatches,
    "one encoder that is wrong": one_encoder,
}
