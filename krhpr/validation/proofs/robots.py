"""Proofs about whole robots: the functions that join sub-legs and platform, along motions and as linear
maps.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from krhpr.codegen.kernel import LEGS
from krhpr.validation.check import Check
from krhpr.validation.configurations import Configuration, configuration
from krhpr.validation.draw import Draw
from krhpr.validation.jets import coefficients, straight
from krhpr.validation.linear import Matrix, apply, determinant, matrix, times, transpose
from krhpr.validation.numbers import Exact
from krhpr.validation.outcome import Measured, Runner
from krhpr.validation.proofs.platforms import moving, moving_end_point, rows
from krhpr.validation.subject import Subject


def proof(body: Callable[[Subject, Configuration, Measured], None]) -> Runner:
    """A runner that makes one statement about random configurations of the robot."""

    def run(subject: Subject, check: Check, count: int) -> Measured:
        found = Measured(check)
        source = Draw(check.seed)
        for _ in range(count):
            body(subject, configuration(subject, source), found)
            found.samples += 1
        return found

    return run


def joint_motion(subject: Subject, here: Configuration, found: Measured) -> None:
    """Joints with the rates and accelerations found keep every loop closed to second order."""
    theta_dot = here.call("joint_rates")["theta_dot"]
    theta_ddot = here.call("joint_accelerations", theta_dot=theta_dot)["theta_ddot"]
    theta = straight(here.values["theta"], theta_dot, theta_ddot)
    n = subject.subleg.n
    s = []
    for leg in range(LEGS):
        end = moving_end_point(here, leg)
        residual = here.kernel("subleg", "closure", leg, s=end, theta=theta[n * leg : n * (leg + 1)])[
            "residual"
        ]
        for order in range(3):
            found.equal(
                coefficients(residual, order), [Exact(0)] * len(residual), f"leg {leg + 1}, order {order}"
            )
        s += end
    motions = moving(here)
    pose = {name: motions[name] for name in ("p", "phi" if subject.planar else "Q")}
    residual = here.call("constraints", s=s, **pose)["residual"]
    for order in range(3):
        found.equal(coefficients(residual, order), [Exact(0)] * len(residual), f"platform, order {order}")


def inverse_maps(subject: Subject, here: Configuration, found: Measured) -> None:
    """twist after joint_rates, and the same one order up."""
    theta_dot = here.call("joint_rates")["theta_dot"]
    found.equal(here.call("twist", theta_dot=theta_dot)["twist"], here.values["twist"], "twist")
    theta_ddot = here.call("joint_accelerations", theta_dot=theta_dot)["theta_ddot"]
    result = here.call("platform_acceleration", theta_dot=theta_dot, theta_ddot=theta_ddot)
    found.equal(result["twist_rate"], here.values["twist_rate"], "twist_rate")


def jacobians(here: Configuration) -> tuple[Matrix, Matrix]:
    """J and K of the robot."""
    result = here.call("jacobians")
    freedom, n = here.subject.platform.space.degrees_of_freedom, here.subject.subleg.n
    return matrix(result["J"], freedom), matrix(result["K"], LEGS * n)


def _sublegs(here: Configuration) -> list[Matrix]:
    n, d = here.subject.subleg.n, here.subject.subleg.space.dimension
    values = here.call("subleg_jacobian")["M"]
    return [matrix(values[n * d * leg : n * d * (leg + 1)], n) for leg in range(LEGS)]


def velocity_equation(subject: Subject, here: Configuration, found: Measured) -> None:
    """J t = K theta_dot; K is made of its blocks, and they are N M."""
    J, K = jacobians(here)
    theta_dot = here.values["theta_dot"]
    found.equal(apply(J, here.call("twist")["twist"]), apply(K, theta_dot), "J t")
    n, per_leg = subject.subleg.n, subject.platform.space.rows_per_leg
    blocks = matrix(here.call("jacobian_blocks")["K"], n)
    found.equal(here.call("jacobian_blocks")["J"], [x for row in J for x in row], "J beside the blocks")
    M = _sublegs(here)
    for leg in range(LEGS):
        block = blocks[per_leg * leg : per_leg * (leg + 1)]
        found.equal(times(rows(here, leg)[1], M[leg]), block, f"N M of leg {leg + 1}")
        for row in range(per_leg):
            zero = [Exact(0)] * n
            whole = [x for other in range(LEGS) for x in (block[row] if other == leg else zero)]
            found.equal(K[per_leg * leg + row], whole, f"K, row {per_leg * leg + row}")


def determinants(subject: Subject, here: Configuration, found: Measured) -> None:
    """det J and det M from the factors that `singularity` gives."""
    result = here.call("singularity")
    product: Any = Exact(1)
    for factor in result["type_2"]:
        product = product * factor
    found.equal([determinant(jacobians(here)[0])], [product], "det J")
    if subject.subleg.redundant:
        squares = [determinant(times(M, transpose(M))) for M in _sublegs(here)]
        found.equal([value * value for value in result["type_1"]], squares, "det(M M^T)")
    else:
        found.equal([determinant(M) for M in _sublegs(here)], result["type_1"], "det M")


def type_2_of_redundant(subject: Subject, here: Configuration, found: Measured) -> None:
    """Factors and margins without a pose are those with one."""
    result, wanted = here.call("type_2_of_redundant"), here.call("singularity")
    for name in ("type_2", "margins"):
        found.equal(result[name], wanted[name], name)


RUNNERS: dict[str, Runner] = {
    "joint motion": proof(joint_motion),
    "inverse maps": proof(inverse_maps),
    "velocity equation": proof(velocity_equation),
    "det J": proof(determinants),
    "type II of the redundant coordinates": proof(type_2_of_redundant),
}
