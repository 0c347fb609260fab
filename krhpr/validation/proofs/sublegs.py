"""Proofs about sub-legs: everything follows from the loop closure that the sub-leg's file states."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from types import SimpleNamespace
from typing import Any

import numpy as np

from krhpr.codegen.kernel import LEGS, Kernel
from krhpr.codegen.writer import KernelWriter
from krhpr.derivations.sublegs.base import SubLeg
from krhpr.validation.arithmetic import ARRAYS, BALLS
from krhpr.validation.check import Check
from krhpr.validation.configurations import Configuration, configuration
from krhpr.validation.draw import Draw
from krhpr.validation.jets import accelerations, coefficients, straight
from krhpr.validation.linear import (
    Matrix,
    apply,
    cross,
    determinant,
    identity,
    matrix,
    plus,
    scaled,
    solve,
    times,
    transpose,
)
from krhpr.validation.numbers import Ball, Exact
from krhpr.validation.outcome import Measured, Runner
from krhpr.validation.proofs import thesis
from krhpr.validation.proofs.first_principles import closure_and_jacobian
from krhpr.validation.sampling import draw
from krhpr.validation.subject import Subject


def cases(subject: Subject, check: Check, count: int, found: Measured) -> Iterator[tuple[Configuration, int]]:
    """Random consistent configurations and each of their legs."""
    source = Draw(check.seed)
    for _ in range(count):
        here = configuration(subject, source)
        for leg in range(LEGS):
            found.samples += 1
            yield here, leg


def proof(body: Callable[[Subject, Configuration, int, Measured], None]) -> Runner:
    """A runner that makes one statement about every leg of random configurations."""

    def run(subject: Subject, check: Check, count: int) -> Measured:
        found = Measured(check)
        for here, leg in cases(subject, check, count, found):
            body(subject, here, leg, found)
        return found

    return run


def posture(here: Configuration, leg: int) -> dict[str, list[Any]]:
    """The leg's posture."""
    return here.kernel("subleg", "posture", leg)


def jacobian(here: Configuration, leg: int) -> Matrix:
    """M by the derivation."""
    return matrix(here.kernel("subleg", "jacobian", leg, **posture(here, leg))["M"], here.subject.subleg.n)


def fields(here: Configuration, leg: int, part: str = "subleg") -> dict[str, Any]:
    """One leg's geometry fields."""
    return {field.name: here.geometry[field.name][leg] for field in here.subject.geometry_types[part].fields}


# -- velocity --------------------------------------------------------------------------------------


def equations_kernel(subleg: SubLeg) -> Kernel:
    """F, A and B of the velocity equations at a posture."""
    k = KernelWriter("equations", "The velocity equations.", geometry=subleg.geometry())
    at = SimpleNamespace(**{port.name: k.add_input(port) for port in subleg.posture_ports()})
    found = subleg.velocity(k, at)
    for name in ("F", "A", "B"):
        k.output(name, getattr(found, name))
    return k.kernel()


def tangent_kernel(kernel: Kernel, output: str, moving: tuple[str, ...]) -> Kernel:
    """The derivative of an output along directions of some inputs (`d_<input>`), differentiated on the
    graph.
    """
    k = KernelWriter(f"{kernel.name}_rate", "A derivative.", geometry=kernel.geometry)
    arguments = {port.name: k.add_input(port) for port in kernel.inputs}
    directions = {name: k.input(f"d_{name}", kernel.input_port(name).shape) for name in moving}
    _, rate = k.call_tangent(kernel, output, arguments, directions)
    k.output("rate", rate)
    return k.kernel()


def unit(size: int, index: int) -> list[Any]:
    """A unit vector."""
    return [Exact(int(i == index)) for i in range(size)]


def _implicit(here: Configuration, leg: int) -> Matrix:
    """M = -(df/ds)^-1 df/dtheta from the closure's graph."""
    closure = here.subject.derived("subleg", "closure")
    rate = tangent_kernel(closure, "residual", ("s", "theta"))
    d, n = here.subject.subleg.space.dimension, here.subject.subleg.n

    def column(d_s: list[Any], d_theta: list[Any]) -> list[Any]:
        return here.kernel("subleg", rate, leg, d_s=d_s, d_theta=d_theta)["rate"]

    still_s, still_theta = unit(d, -1), unit(n, -1)
    by_s = transpose([column(unit(d, i), still_theta) for i in range(d)])
    by_theta = transpose([column(still_s, unit(n, j)) for j in range(n)])
    return solve(by_s, [scaled(-1, row) for row in by_theta])


def velocity_equations(subject: Subject, here: Configuration, leg: int, found: Measured) -> None:
    """A F^T M = B for the M that the closure implies, and M is that of the kernel."""
    implied = _implicit(here, leg)
    n, d = subject.subleg.n, subject.subleg.space.dimension
    at = here.kernel("subleg", equations_kernel(subject.subleg), leg, **posture(here, leg))
    frame, a, b = matrix(at["F"], d), matrix(at["A"], d), matrix(at["B"], n)
    found.equal(times(transpose(frame), frame), identity(d), "F^T F")
    found.equal(times(times(a, transpose(frame)), implied), b, "A F^T M - B")
    found.equal(jacobian(here, leg), implied, "M")


def first_principles(subject: Subject, here: Configuration, leg: int, found: Measured) -> None:
    """The independent closure vanishes, and its Jacobian is M."""
    name = subject.code.subleg.name
    residual, implied = closure_and_jacobian(
        name, fields(here, leg), here.leg("s", leg), here.leg("theta", leg)
    )
    found.equal(residual, [Exact(0)] * len(residual), "closure")
    found.equal(jacobian(here, leg), implied, "M")


def thesis_matrices(subject: Subject, here: Configuration, leg: int, found: Measured) -> None:
    """The printed matrices, row by row."""
    printed = thesis.VELOCITY[subject.code.subleg.name](
        fields(here, leg), here.leg("s", leg), here.leg("theta", leg)
    )
    found.equal(jacobian(here, leg), printed.M, "M")
    if printed.A is None or printed.B is None or printed.A_inverse is None:
        return
    n, d = subject.subleg.n, subject.subleg.space.dimension
    at = here.kernel("subleg", equations_kernel(subject.subleg), leg, **posture(here, leg))
    found.equal(times(matrix(at["A"], d), transpose(matrix(at["F"], d))), printed.A, "A")
    found.equal(matrix(at["B"], n), printed.B, "B")
    found.equal(times(printed.A, printed.A_inverse), identity(d), "A A^-1")


def products(subject: Subject, here: Configuration, leg: int, found: Measured) -> None:
    """project, velocity and rates are products with M and its inverse."""
    M, at = jacobian(here, leg), posture(here, leg)
    n, d = subject.subleg.n, subject.subleg.space.dimension
    rows = matrix([Exact(k * k + leg + 1) / (k + 2) for k in range(subject.subleg.space.rows_per_leg * d)], d)
    flat_rows = [entry for row in rows for entry in row]
    found.equal(
        matrix(here.kernel("subleg", "project", leg, **at, N=flat_rows)["K"], n), times(rows, M), "N M"
    )
    rates = here.leg("theta_dot", leg)
    s_dot = apply(M, rates)
    found.equal(here.kernel("subleg", "velocity", leg, **at)["s_dot"], s_dot, "M theta_dot")
    result = here.kernel("subleg", "rates", leg, **at, s_dot=s_dot)
    found.equal(apply(M, result["theta_dot"]), s_dot, "M rates")
    serial, _ = _factor_counts(subject.subleg)
    factors = [abs(factor) for factor in here.kernel("subleg", "determinant", leg, **at)["factors"]]
    found.equal(result["regularity"], [min(factors[:serial])], "regularity of rates")
    for name in ("jacobian", "project", "velocity"):
        kernel = here.kernel("subleg", name, leg, **at, N=flat_rows)
        if "regularity" in kernel:
            found.equal(kernel["regularity"], [min(factors[serial:])], f"regularity of {name}")


# -- determinant -----------------------------------------------------------------------------------


def determinants(subject: Subject, check: Check, count: int) -> Measured:
    """det M in closed form, and the product of its factors up to a constant of the geometry."""
    found = Measured(check)
    for here, leg in cases(subject, check, count, found):
        at = posture(here, leg)
        result = here.kernel("subleg", "determinant", leg, **at)
        found.equal(result["det_M"], [determinant(jacobian(here, leg))], "det M")
    source = Draw(check.seed + 1)
    serial, parallel = _factor_counts(subject.subleg)
    for _ in range(count):
        geometry = source.geometry(subject.geometry_types["subleg"])
        constants = []
        for _ in range(2):
            inputs = {port.name: source.port(port, (), full=False) for port in subject.subleg.posture_ports()}
            result = subject.kernel("subleg", "determinant", inputs, geometry, 0, here.arithmetic)
            constant = result["det_M"][0]
            for factor in result["factors"][:serial]:
                constant = constant / factor
            for factor in result["factors"][serial : serial + parallel]:
                constant = constant * factor
            constants.append(constant)
        found.equal(constants[0], constants[1], "det M over its factors")
    return found


def _factor_counts(subleg: SubLeg) -> tuple[int, int]:
    k = KernelWriter("factors", "", geometry=subleg.geometry())
    equations = subleg.velocity(
        k, SimpleNamespace(**{port.name: k.add_input(port) for port in subleg.posture_ports()})
    )
    return len(equations.serial), len(equations.parallel)


# -- motion ----------------------------------------------------------------------------------------


def motion(subject: Subject, here: Configuration, leg: int, found: Measured) -> None:
    """Rates and accelerations of the end point along a motion of the joints."""
    theta = straight(*(here.leg(name, leg) for name in ("theta", "theta_dot", "theta_ddot")))
    s = here.kernel("subleg", "forward", leg, theta=theta)["s"]
    at = posture(here, leg)
    bias = here.kernel("subleg", "bias", leg)
    found.equal(coefficients(s, 0), here.leg("s", leg), "s")
    found.equal(coefficients(s, 1), bias["s_dot"], "s_dot")
    along = here.kernel("subleg", "velocity", leg, **at, theta_dot=here.leg("theta_ddot", leg))["s_dot"]
    found.equal(accelerations(s), plus(along, bias["bias"]), "s_ddot")
    residual = here.kernel("subleg", "closure", leg, s=s, theta=theta)["residual"]
    for order in range(3):
        found.equal(coefficients(residual, order), [Exact(0)] * len(residual), f"closure, order {order}")


# -- position --------------------------------------------------------------------------------------


def forward_closes(subject: Subject, here: Configuration, leg: int, found: Measured) -> None:
    """forward satisfies the closure in every assembly mode, with the posture that belongs to it."""
    for signs in subject.code.assembly_signs:
        given = {"assembly": [Exact(sign) for sign in signs]} if signs else {}
        result = here.kernel("subleg", "forward_posture", leg, **given)
        s = result["s"]
        found.equal(here.kernel("subleg", "forward", leg, **given)["s"], s, "s")
        residual = here.kernel("subleg", "closure", leg, s=s)["residual"]
        found.equal(residual, [Exact(0)] * len(residual), f"closure {signs}")
        at = here.kernel("subleg", "posture", leg, s=s)
        for name, value in at.items():
            found.equal(result[name], value, f"{name} {signs}")


def inverse_closes(subject: Subject, check: Check, count: int) -> Measured:
    """Every working mode satisfies the closure, and no two are alike."""
    found = Measured(check)
    n, modes = subject.subleg.n, subject.code.mode_signs
    for index in range(count):
        batch = draw(subject, check.seed + index, 1, spread=0.1)
        geometry = {name: [Ball(x) for x in values] for name, values in batch.geometry.items()}
        for leg in range(LEGS):
            s = [Ball(x) for x in batch.values["s"][0][leg].tolist()]

            def kernel(
                name: str, leg: int = leg, geometry: Mapping[str, Any] = geometry, **inputs: Any
            ) -> Any:
                return subject.kernel("subleg", name, inputs, geometry, leg, BALLS)

            every = matrix(kernel("inverse_all", s=s)["theta"], n)
            for signs, listed in zip(modes, every, strict=True):
                theta = kernel("inverse", s=s, mode=[Ball(sign) for sign in signs])["theta"]
                found.equal(theta, listed, f"inverse_all {signs}")
                residual = kernel("closure", s=s, theta=theta)["residual"]
                found.equal(residual, [Ball(0)] * len(residual), f"closure {signs}")
                found.samples += 1
            for i, one in enumerate(every):
                for other in every[:i]:
                    apart = max(abs(a.to_float() - b.to_float()) for a, b in zip(one, other, strict=True))
                    found.worse(0.0 if apart > 1e-3 else 1.0, "two working modes are the same")
    return found


def reach(subject: Subject, check: Check, count: int) -> Measured:
    """The excess is positive just where the mode does not exist."""
    found = Measured(check)
    rng = np.random.default_rng(check.seed)
    many = 50 * count
    geometry: dict[str, Any] = {name: list(values) for name, values in subject.entry.sizes.items()}
    d = subject.subleg.space.dimension
    s = list(rng.uniform(-1.2, 1.2, (d, many)))
    seen = [0, 0]
    for signs in subject.code.mode_signs:
        inputs = {"s": s, "mode": [float(sign) for sign in signs]}
        with np.errstate(all="ignore"):
            excess = subject.kernel("subleg", "reach", inputs, geometry, 0, ARRAYS)["excess"][0]
            inverse = subject.kernel("subleg", "inverse", inputs, geometry, 0, ARRAYS)
        exists = np.isfinite(np.array(inverse["theta"])).all(axis=0) & (inverse["radicand"][0] >= 0)
        clear = np.isnan(excess) | (np.abs(excess) > 1e-9)
        found.worse(
            (clear & ((excess <= 0) != exists)).astype(float), f"excess and existence differ in mode {signs}"
        )
        found.samples += many
        seen[0] += int(exists.sum())
        seen[1] += int((~exists).sum())
    found.worse(
        0.0 if min(seen) > 0 else 1.0, f"no points {'within' if seen[1] else 'out of'} reach were drawn"
    )
    return found


# -- passive joints --------------------------------------------------------------------------------


def _in_plane(angle: Any) -> list[Any]:
    return [angle.cos(), angle.sin()]


def passive_joints(subject: Subject, here: Configuration, leg: int, found: Measured) -> None:
    """Links laid end to end with all angles meet in S_i."""
    g, theta, s = fields(here, leg), here.leg("theta", leg), here.leg("s", leg)
    result = here.kernel("subleg", "passive", leg, **posture(here, leg))
    PASSIVE[subject.code.subleg.name](g, s, theta, result, found)


def _first_axis_chain(
    g: dict[str, Any], theta: list[Any], last: Any, lengths: tuple[str, str], link: Matrix, found: Measured
) -> list[Any]:
    """The end of two links at theta_2 and `last` in the linkage plane; the last one's frame is checked on
    the way.
    """
    at = thesis.axes(g, theta[0])
    inner = plus(scaled(theta[1].cos(), at.x), scaled(theta[1].sin(), at.e_1))
    along = plus(scaled(last.cos(), at.x), scaled(last.sin(), at.e_1))
    found.equal(transpose(link), [along, cross(at.e_2, along), at.e_2], "link frame")
    return plus(at.c, plus(scaled(g[lengths[0]], inner), scaled(g[lengths[1]], along)))


def _passive_rrr(
    g: dict[str, Any], s: list[Any], theta: list[Any], result: dict[str, Any], found: Measured
) -> None:
    link = matrix(result["link"], 3)
    found.equal(_first_axis_chain(g, theta, theta[1] + theta[2], ("l_2", "l_3"), link, found), s, "S_i")


def _passive_r_fivebar(
    g: dict[str, Any], s: list[Any], theta: list[Any], result: dict[str, Any], found: Measured
) -> None:
    crank_1, crank_2, rod = result["passive"]
    distal, link_2 = theta[1] + crank_1, theta[2] + crank_2
    found.equal(
        _first_axis_chain(g, theta, distal, ("l_4", "l_6"), matrix(result["link"], 3), found), s, "S_i"
    )
    by_rod = plus(scaled(g["l_2"], _in_plane(theta[2])), scaled(g["l_3"], _in_plane(link_2)))
    by_distal = plus(scaled(g["l_4"], _in_plane(theta[1])), scaled(g["l_6"] - g["l_5"], _in_plane(distal)))
    found.equal(by_rod, by_distal, "P")
    found.equal(_in_plane(link_2 + rod), _in_plane(distal), "rod")


def _passive_planar_rr(
    g: dict[str, Any], s: list[Any], theta: list[Any], result: dict[str, Any], found: Measured
) -> None:
    o = scaled(g["R_b"], _in_plane(g["azimuth"]))
    found.equal(
        plus(plus(o, scaled(g["l_1"], _in_plane(theta[0]))), scaled(g["l_2"], result["link"])), s, "r_i"
    )
    found.equal(result["link"], _in_plane(theta[0] + theta[1]), "link")


PASSIVE: dict[str, Callable[..., None]] = {
    "subleg_rrr": _passive_rrr,
    "subleg_r_fivebar": _passive_r_fivebar,
    "subleg_planar_rr": _passive_planar_rr,
}

RUNNERS: dict[str, Runner] = {
    "velocity equations": proof(velocity_equations),
    "first principles": proof(first_principles),
    "thesis matrices": proof(thesis_matrices),
    "products of M": proof(products),
    "determinant of M": determinants,
    "accelerations": proof(motion),
    "forward closes": proof(forward_closes),
    "inverse closes": inverse_closes,
    "reach": reach,
    "passive joints": proof(passive_joints),
}
