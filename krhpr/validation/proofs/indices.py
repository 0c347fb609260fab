"""Proofs about the performance indices: squares of M and of J^-1 K, and the roots that are taken of them."""

from __future__ import annotations

from math import prod
from typing import Any

from krhpr.codegen.evaluate import evaluate_kernel
from krhpr.codegen.kernel import LEGS
from krhpr.validation.arithmetic import BALLS
from krhpr.validation.configurations import Configuration
from krhpr.validation.linear import Matrix, cross, dot, identity, matrix, scaled, solve, times, transpose
from krhpr.validation.numbers import Ball, Exact
from krhpr.validation.outcome import Measured, Runner
from krhpr.validation.proofs.platforms import rows, whole
from krhpr.validation.proofs.robots import proof as of_robot
from krhpr.validation.proofs.sublegs import jacobian, posture, proof
from krhpr.validation.subject import Subject

NEAR = Ball(10) ** -40
"""The formulas have a little more below their roots, 1e-48 of the squares, to keep slopes finite."""
LENGTH = Exact(3) / 7
"""The characteristic length of slides."""


def _scaled_jacobian(here: Configuration, leg: int) -> Matrix:
    """M with the columns of slides times the length."""
    joints = here.subject.subleg.actuators
    factors = [LENGTH if joint.kind == "prismatic" else Exact(1) for joint in joints]
    return [
        [entry * factor for entry, factor in zip(row, factors, strict=True)] for row in jacobian(here, leg)
    ]


def _gram(a: Matrix) -> Matrix:
    return times(a, transpose(a))


def _determinant(a: Matrix) -> Any:
    """By its rows, without a division: also of singular matrices of balls."""
    if len(a) == 1:
        return a[0][0]
    if len(a) == 2:
        return a[0][0] * a[1][1] - a[0][1] * a[1][0]
    return dot(a[0], cross(a[1], a[2]))


def _upper(a: Matrix) -> list[Any]:
    return [a[i][j] for i in range(len(a)) for j in range(i, len(a))]


def _invariants(a: Matrix) -> list[Any]:
    """The coefficients of the characteristic polynomial, but for the first."""
    found = [sum((a[i][i] for i in range(len(a))), Exact(0)), _determinant(a)]
    if len(a) == 3:
        squares = times(a, a)
        half = found[0] * found[0] - sum((squares[i][i] for i in range(3)), Exact(0))
        found.append(half / 2)
    return found


def _squares(here: Configuration, leg: int, N: Matrix) -> dict[str, list[Any]]:
    flat = [entry for row in N for entry in row]
    return here.kernel("subleg", "gram", leg, **posture(here, leg), N=flat, characteristic_length=[LENGTH])


def squares_of_m(subject: Subject, here: Configuration, leg: int, found: Measured) -> None:
    """gram, cofactors, square and reach against M, turned as it may be."""
    d, M = subject.subleg.space.dimension, _scaled_jacobian(here, leg)
    N = matrix([Exact(k * k + leg + 1) / (k + 2) for k in range(subject.subleg.space.rows_per_leg * d)], d)
    result = _squares(here, leg, N)
    gram, minors = matrix(result["gram"], d), matrix(result["cofactors"], d)
    found.equal(gram, transpose(gram), "gram is symmetric")
    found.equal(_invariants(gram), _invariants(_gram(M)), "characteristic polynomial")
    found.equal(times(gram, minors), [scaled(result["square"][0], row) for row in identity(d)], "inverse")
    found.equal(result["reach"], _upper(_gram(times(N, M))), "reach")


def _parts(
    here: Configuration, J: Matrix, gathered: dict[str, Any], K: list[Matrix]
) -> tuple[Matrix, Matrix]:
    """U_p U_p^T and U_r U_r^T in the platform frame, from J and the legs' blocks of K."""
    d = here.subject.platform.space.dimension
    per_leg = here.subject.platform.space.rows_per_leg
    width = len(K[0][0])
    whole_K = [
        [
            K[leg][row][j - width * leg] if width * leg <= j < width * (leg + 1) else Exact(0)
            for j in range(3 * width)
        ]
        for leg in range(LEGS)
        for row in range(per_leg)
    ]
    U = solve(J, whole_K)
    Q = matrix(here.values["Q"], d)
    position = times(transpose(Q), U[:d])
    rotation = U[d:] if here.subject.planar else times(transpose(Q), U[d:])
    return _gram(position), _gram(rotation)


def sensitivity(subject: Subject, here: Configuration, found: Measured) -> None:
    """The squares of both parts of U, for end points on the constraints or not."""
    consistent = [here.leg("s", leg) for leg in range(LEGS)]
    moved = [[x + Exact(leg + 1) / 9 for x in s] for leg, s in enumerate(consistent)]
    for s in (consistent, moved):
        J, gathered = whole(here, s=s)
        per_leg = subject.platform.space.rows_per_leg
        K = [
            [[Exact(leg + 2 * row - j) / (j + 2) for j in range(2)] for row in range(per_leg)]
            for leg in range(LEGS)
        ]
        reach = [entry for block in K for entry in _upper(_gram(block))]
        inputs = {"line": gathered["line"], "point": gathered["point"], "reach": reach}
        result = evaluate_kernel(subject.derived("platform", "sensitivity"), inputs, None, here.arithmetic)
        position, rotation = _parts(here, J, gathered, K)
        found.equal(result["position_gram"], [x for row in position for x in row], "position")
        found.equal(result["rotation_gram"], [x for row in rotation for x in row], "rotation")
        solved = {**inputs, "Q": here.values["Q"], "rate": [Exact(1)] * (per_leg * LEGS)}
        wanted = evaluate_kernel(subject.derived("platform", "solve"), solved, None, here.arithmetic)
        found.equal(result["regularity"], wanted["regularity"], "regularity")


def _balls(values: Any) -> list[Any]:
    return [value if isinstance(value, Ball) else Ball(Exact(value).fraction) for value in values]


def _is_largest(found: Measured, gram: Matrix, value: Any, where: str) -> None:
    """value I - gram is singular, and not negative: its other invariants are not below zero."""
    n = len(gram)
    rest = [[(value if i == j else Ball(0)) - gram[i][j] for j in range(n)] for i in range(n)]
    trace, last, *middle = _invariants(rest)
    size = prod([value] * n, start=Ball(1))
    found.worse(float(not abs(last) < NEAR * size), f"{where}: no eigenvalue")
    if n > 1:
        signs = [trace, *middle]
        found.worse(float(any(sign < -NEAR * size for sign in signs)), f"{where}: not the largest")


def indices(subject: Subject, here: Configuration, found: Measured) -> None:
    """The roots are the largest and the smallest singular values."""
    d = subject.platform.space.dimension
    spread, norms = subject.derived("algebra", "spread"), subject.derived("algebra", "norms")
    largest, smallest, reach = [], [], []
    for leg in range(LEGS):
        squares = _squares(here, leg, rows(here, leg)[1])
        reach += squares["reach"]
        inputs = {name: _balls(squares[name]) for name in ("gram", "cofactors", "square")}
        result = evaluate_kernel(spread, inputs, None, BALLS)
        gram = matrix(inputs["gram"], d)
        _is_largest(found, gram, result["largest"][0], f"leg {leg + 1}, largest")
        low = result["smallest"][0]
        inverse = [scaled(Ball(1) / inputs["square"][0], row) for row in matrix(inputs["cofactors"], d)]
        _is_largest(found, inverse, Ball(1) / low, f"leg {leg + 1}, smallest")
        found.equal(result["evenness"], [low / result["largest"][0]], f"leg {leg + 1}, evenness")
        largest += result["largest"]
        smallest += result["smallest"]
    _, gathered = whole(here)
    inputs = {"line": gathered["line"], "point": gathered["point"], "reach": reach}
    parts = evaluate_kernel(subject.derived("platform", "sensitivity"), inputs, None, here.arithmetic)
    position, rotation = _balls(parts["position_gram"]), _balls(parts["rotation_gram"])
    result = evaluate_kernel(
        norms,
        {"position_gram": position, "rotation_gram": rotation, "largest": largest, "smallest": smallest},
        None,
        BALLS,
    )
    for leg, condition in enumerate(result["condition"]):
        found.equal([condition * condition], [largest[leg] / smallest[leg]], f"condition of leg {leg + 1}")
    squared = {name: value[0] * value[0] for name, value in result.items()}
    _is_largest(found, matrix(position, d), squared["eta_1"], "eta_1")
    _is_largest(found, matrix(rotation, 1 if subject.planar else 3), squared["eta_2"], "eta_2")
    ratios = [high / low for high in largest for low in smallest]
    found.worse(float(any(ratio > squared["eta_3"] + NEAR for ratio in ratios)), "eta_3")
    nearest = min((abs(ratio - squared["eta_3"]) for ratio in ratios), key=lambda x: float(x.enclosure.mid()))
    found.equal([nearest], [Ball(0)], "eta_3 is no ratio")


RUNNERS: dict[str, Runner] = {
    "squares of M": proof(squares_of_m),
    "sensitivity": of_robot(sensitivity),
    "indices": of_robot(indices),
}
