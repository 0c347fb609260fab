"""Proofs about all assembly modes of a sub-leg: each closes, and those of an octic are its roots."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

from krhpr.validation.configurations import Configuration
from krhpr.validation.linear import cross, determinant, dot, matrix, minus, plus, scaled
from krhpr.validation.numbers import Ball, Exact, same
from krhpr.validation.outcome import Measured, Runner
from krhpr.validation.proofs.forward import value
from krhpr.validation.proofs.sublegs import proof
from krhpr.validation.subject import Subject


def every_assembly(subject: Subject, here: Configuration, leg: int, found: Measured) -> None:
    """`forward_all` has what `forward` gives in each assembly mode; all close, and no two are alike."""
    kernel = subject.derived("subleg", "forward_all")
    modes, d = kernel.output_port("s").shape
    points = matrix(here.kernel("subleg", "forward_all", leg)["s"], d)
    for number, s in enumerate(points):
        residual = here.kernel("subleg", "closure", leg, s=s)["residual"]
        found.equal(residual, [Exact(0)] * len(residual), f"closure of mode {number + 1}")
        given: dict[str, Any] = {"s_near": s}
        if not subject.subleg.forward_near:
            given = {"assembly": [Exact(sign) for sign in subject.code.assembly_signs[number]]}
        found.equal(here.kernel("subleg", "forward", leg, **given)["s"], s, f"mode {number + 1}")
    there = [all(same(a, b) for a, b in zip(s, here.leg("s", leg), strict=True)) for s in points]
    found.equal([Exact(sum(there))], [Exact(1)], f"modes of {modes} that are the end point")


def octic(subject: Subject, here: Configuration, leg: int, found: Measured) -> None:
    """The octic by its definition at any T; the end point is at its root, and Newton steps lead there."""
    coefficients = here.kernel("subleg", "octic", leg)["octic"]
    centre, a, b, axis = _cylinder(here, leg)
    products = [dot(x, y) for x, y in ((a, a), (b, b), (a, b), (a, axis), (b, axis))]
    found.equal(products, [Ball(x) for x in (1, 1, 0, 0, 0)], "orthonormal")
    rho = here.leg("theta", leg)[0]
    for T in (Fraction(3, 7), Fraction(-11, 5), Fraction(40, 3)):
        square = T * T
        cosine, sine = Ball((1 - square) / (1 + square)), Ball(2 * T / (1 + square))
        foot = plus(centre, scaled(rho, plus(scaled(cosine, a), scaled(sine, b))))
        wanted = _resultant(here, leg, foot, axis) * Ball((1 + square) ** 4)
        found.equal([value(coefficients, Ball(T), Ball(1))], [wanted], f"the octic at T = {T}")
    arm = minus(here.leg("s", leg), centre)
    root = [dot(arm, b), dot(arm, a) + rho]  # tan(t / 2) = sin(t) / (1 + cos(t))
    found.equal([value(coefficients, *root)], [Ball(0)], "the end point is a root")
    result = here.kernel("subleg", "at_root", leg, root=root)
    found.equal(result["s"], here.leg("s", leg), "s at the root")
    found.equal(result["miss"], [Ball(0)], "miss at the root")
    normals = matrix(here.kernel("subleg", "posture", leg)["w"], 3)
    found.equal(result["volume"], [dot(normals[0], cross(normals[1], normals[2]))], "volume")
    beside = [root[0] + rho * Ball(Fraction(1, 10**7)), root[1]]
    moved = here.kernel("subleg", "at_root", leg, root=beside)["s"]
    gaps = [abs(x.to_float()) for x in minus(moved, here.leg("s", leg))]
    found.equal([Ball(int(max(gaps) < 1e-20))], [Ball(1)], "beside the root")


def _cylinder(here: Configuration, leg: int) -> tuple[list[Any], list[Any], list[Any], list[Any]]:
    """g_1, and the directions a, b and axis of the cylinder about axis 1."""
    prepared = here.subject.prepare(here.geometry, here.arithmetic)["subleg"][leg]
    a, b = matrix(prepared["n"], 3)
    return matrix(prepared["g"], 3)[0], a, b, matrix(prepared["e"], 3)[0]


def _resultant(here: Configuration, leg: int, foot: list[Any], axis: list[Any]) -> Any:
    """Sylvester's determinant of the closure of chains 2 and 3 along the line foot + x axis."""
    values = []
    for x in (-1, 0, 1):
        s = plus(foot, scaled(Ball(x), axis))
        values.append(here.kernel("subleg", "closure", leg, s=s)["residual"])
    rows = []
    for chain in (1, 2):
        before, c, after = (value[chain] for value in values)
        half = Ball(Fraction(1, 2))
        first, second = (before + after) * half - c, (after - before) * half
        rows += [[first, second, c, Ball(0)], [Ball(0), first, second, c]]
    return determinant(rows)


RUNNERS: dict[str, Runner] = {
    "every assembly mode": proof(every_assembly),
    "octic": proof(octic),
}
