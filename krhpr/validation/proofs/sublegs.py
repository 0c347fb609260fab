"""Proofs about sub-legs: everything follows from the loop closure that the sub-leg's file states."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from types import SimpleNamespace
from typing import Any

import numpy as np

from krhpr.codegen.kernel import LEGS, Kernel
from krhpr.codegen.writer import KernelWriter
from krhpr.derivations.sublegs.base import SubLeg
from krhpr.validation.arithmetic import ARRAYS, BALLS, RATIONAL
from krhpr.validation.check import Check
from krhpr.validation.configurations import Configuration, configuration
from krhpr.validation.draw import Draw
from krhpr.validation.jets import accelerations, coefficients, straight
from krhpr.validation.linear import (
    Matrix,
    apply,
    determinant,
    dot,
    identity,
    matrix,
    minus,
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
from krhpr.validation.proofs.passive import PASSIVE, passive_joints
from krhpr.validation.proofs.places import OTHERS, places
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
    rows = n if subject.subleg.redundant else d
    frame, a, b = matrix(at["F"], d), matrix(at["A"], rows), matrix(at["B"], n)
    found.equal(times(transpose(frame), frame), identity(d), "F^T F")
    of_end = [row[:d] for row in a[:d]]
    found.equal(times(times(of_end, transpose(frame)), implied), b[:d], "A F^T M - B")
    found.equal(jacobian(here, leg), implied, "M")
    if subject.subleg.redundant:
        apart = [*a[d][:d], *(row[d] for row in a[:d])]
        found.equal(apart, [Exact(0)] * len(apart), "the swivel's row and column of A")


def swivel(subject: Subject, here: Configuration, leg: int, found: Measured) -> None:
    """The swivel's row of B is the gradient of the swivel, and its second rate is what the bias leaves."""
    d, n = subject.subleg.space.dimension, subject.subleg.n
    at = here.kernel("subleg", equations_kernel(subject.subleg), leg, **posture(here, leg))
    weight, row = matrix(at["A"], n)[d][d], matrix(at["B"], n)[d]
    found.equal(
        scaled(weight, _swivel_gradient(here, leg, jacobian(here, leg))), row, "the swivel's row of B"
    )
    given = {"swivel_accelerations": [Exact(3)], "swivel_bias": [Exact(1) / 3]}
    along = here.kernel("subleg", "swivel_difference", leg, **given)["swivel_along"]
    found.equal(along, [Exact(8) / 3], "second rate without the bias")


def _swivel_gradient(here: Configuration, leg: int, M: Matrix) -> list[Any]:
    """The derivative of the swivel by each joint, the end point moving along."""
    subleg = here.subject.subleg
    k = KernelWriter("swivel_from_joints", "The swivel.", geometry=subleg.geometry())
    ports = subleg.ports()
    at = subleg.posture(k, k.add_input(ports.s), k.add_input(ports.theta))
    k.add_output(ports.swivel, subleg.swivel_angle(k, SimpleNamespace(**at)))
    rate = tangent_kernel(k.kernel(), "swivel", ("s", "theta"))
    columns = transpose(M)
    return [
        here.kernel("subleg", rate, leg, d_s=columns[j], d_theta=unit(subleg.n, j))["rate"][0]
        for j in range(subleg.n)
    ]


def first_principles(subject: Subject, here: Configuration, leg: int, found: Measured) -> None:
    """The independent closure vanishes, and its Jacobian is M."""
    name = subject.code.subleg.name
    residual, implied = closure_and_jacobian(
        name, fields(here, leg), here.leg("s", leg), here.leg("theta", leg)
    )
    found.equal(residual, [Exact(0)] * len(residual), "closure")
    found.equal(jacobian(here, leg), implied, "M")


def thesis_matrices(subject: Subject, here: Configuration, leg: int, found: Measured) -> None:
    """The printed matrices, row by row; A and B in the combination of rows that the derivation states."""
    name, g = subject.code.subleg.name, fields(here, leg)
    printed = thesis.VELOCITY[name](g, here.leg("s", leg), here.leg("theta", leg))
    found.equal(jacobian(here, leg), printed.M, "M")
    if printed.A is None or printed.B is None:
        return
    n, d = subject.subleg.n, subject.subleg.space.dimension
    at = here.kernel("subleg", equations_kernel(subject.subleg), leg, **posture(here, leg))
    rows = _rows_with_coupler(g) if name in COUPLED else identity(d)
    found.equal(times(matrix(at["A"], d), transpose(matrix(at["F"], d))), times(rows, printed.A), "A")
    found.equal(matrix(at["B"], n), times(rows, printed.B), "B")
    if printed.A_inverse is not None:
        found.equal(times(printed.A, printed.A_inverse), identity(d), "A A^-1")


COUPLED = ("subleg_r_fivebar", "subleg_p_fivebar")
"""Sub-legs whose rod ends beyond the joint of crank and distal link."""


def _rows_with_coupler(g: dict[str, Any]) -> Matrix:
    """The third row over k, less k times the second, where w = k v_1, (A.16)."""
    ratio, zero, one = 1 - g["l_5"] / g["l_6"], Exact(0), Exact(1)
    return [[one, zero, zero], [zero, one, zero], [zero, -ratio, 1 / ratio]]


def products(subject: Subject, here: Configuration, leg: int, found: Measured) -> None:
    """project, velocity and rates are products with M and its inverse; their guards are factors of det M."""
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
    swivel = {}
    if subject.subleg.redundant:
        row = matrix(here.kernel("subleg", equations_kernel(subject.subleg), leg, **at)["B"], n)[d]
        swivel = {"swivel_rates": [dot(row, rates)]}
    result = here.kernel("subleg", "rates", leg, **at, s_dot=s_dot, **swivel)
    found.equal(result["theta_dot"], rates, "rates of M theta_dot")
    inputs = {**at, "N": flat_rows, "along": s_dot, "s_dot": s_dot, **swivel}
    inputs["characteristic_length"] = [Exact(2) / 7]
    _guards(subject, here, leg, inputs, found)


def _guards(subject: Subject, here: Configuration, leg: int, inputs: dict[str, Any], found: Measured) -> None:
    """What kernels compare with a tolerance is the smallest of the factors of det M that they divide by."""
    serial, parallel, _ = factor_counts(subject.subleg)
    factors = [abs(factor) for factor in here.kernel("subleg", "determinant", leg, **inputs)["factors"]]
    of_swivel = factors[serial + parallel :] if subject.subleg.redundant else []
    by_serial, by_parallel = factors[:serial], factors[serial : serial + parallel]
    guarding = {
        "jacobian": by_parallel,
        "project": by_parallel,
        "velocity": by_parallel,
        "bias": by_parallel,
        "gram": by_parallel,
        "rates": by_serial + of_swivel,
        "transmission": by_parallel + of_swivel,
        "end_force": by_serial + of_swivel,
    }
    for name, values in guarding.items():
        result = here.kernel("subleg", name, leg, **inputs)
        assert bool(values) == ("regularity" in result), name
        if values:
            found.equal(result["regularity"], [min(values)], f"regularity of {name}")


# -- determinant -----------------------------------------------------------------------------------


def determinants(subject: Subject, check: Check, count: int) -> Measured:
    """det M in closed form, and the product of its factors up to a constant of the geometry."""
    found = Measured(check)
    for here, leg in cases(subject, check, count, found):
        at = posture(here, leg)
        result = here.kernel("subleg", "determinant", leg, **at)
        M = jacobian(here, leg)
        if subject.subleg.redundant:
            (value,) = result["det_M"]
            found.equal([value * value], [determinant(times(M, transpose(M)))], "det(M M^T)")
            _redundant_factors(subject, here, leg, found)
        else:
            found.equal(result["det_M"], [determinant(M)], "det M")
        formula = OTHERS.get(subject.code.subleg.name)
        if formula is not None:
            expected = formula(fields(here, leg), here.leg("s", leg), here.leg("theta", leg))
            found.equal(result["factors"][-len(expected) :], expected, "other factors")
    source = Draw(check.seed + 1)
    serial, parallel, others = factor_counts(subject.subleg)
    arithmetic = BALLS if others else RATIONAL
    for _ in range(0 if subject.subleg.redundant else count):
        geometry = source.geometry(subject.geometry_types["subleg"])
        constants = []
        for _ in range(2):
            inputs = {port.name: source.port(port, (), full=False) for port in subject.subleg.posture_ports()}
            if others:  # they may have roots, which det M and its factors have not
                inputs = {name: [Ball(x) for x in values] for name, values in inputs.items()}
            result = subject.kernel("subleg", "determinant", inputs, geometry, 0, arithmetic)
            constant = result["det_M"][0]
            for factor in result["factors"][:serial]:
                constant = constant / factor
            for factor in result["factors"][serial : serial + parallel]:
                constant = constant * factor
            constants.append(constant)
        found.equal(constants[0], constants[1], "det M over its factors")
    return found


def _redundant_factors(subject: Subject, here: Configuration, leg: int, found: Measured) -> None:
    """The determinant of the velocity equations, the swivel's among them, over their factors does not depend
    on the joints.
    """
    equations, n = equations_kernel(subject.subleg), subject.subleg.n
    serial, _, _ = factor_counts(subject.subleg)
    constants = []
    for turn in (0, 1):
        theta = [angle + Exact(turn) / (k + 2) for k, angle in enumerate(here.leg("theta", leg))]
        s = here.kernel("subleg", "forward", leg, theta=theta)["s"]
        at = here.kernel("subleg", "posture", leg, theta=theta, s=s)
        constant = determinant(matrix(here.kernel("subleg", equations, leg, **at)["B"], n))
        for factor in here.kernel("subleg", "determinant", leg, **at)["factors"][:serial]:
            constant = constant / factor
        constants.append(constant)
    found.equal([constants[0]], [constants[1]], "det B over its factors")


def factor_counts(subleg: SubLeg) -> tuple[int, int, int]:
    """Numbers of serial, parallel and other factors."""
    k = KernelWriter("factors", "", geometry=subleg.geometry())
    equations = subleg.velocity(
        k, SimpleNamespace(**{port.name: k.add_input(port) for port in subleg.posture_ports()})
    )
    return len(equations.serial), len(equations.parallel), len(equations.others)


# -- motion ----------------------------------------------------------------------------------------


def motion(subject: Subject, here: Configuration, leg: int, found: Measured) -> None:
    """Rates and accelerations of the end point along a motion of the joints."""
    theta = straight(*(here.leg(name, leg) for name in ("theta", "theta_dot", "theta_ddot")))
    at = posture(here, leg)
    bias = here.kernel("subleg", "bias", leg)
    along = here.kernel("subleg", "velocity", leg, **at, theta_dot=here.leg("theta_ddot", leg))["s_dot"]
    s_ddot = plus(along, bias["bias"])
    if subject.subleg.has_forward:
        s = here.kernel("subleg", "forward", leg, theta=theta)["s"]
        found.equal(coefficients(s, 0), here.leg("s", leg), "s")
        found.equal(coefficients(s, 1), bias["s_dot"], "s_dot")
        found.equal(accelerations(s), s_ddot, "s_ddot")
    else:
        s = straight(here.leg("s", leg), bias["s_dot"], s_ddot)
    residual = here.kernel("subleg", "closure", leg, s=s, theta=theta)["residual"]
    for order in range(3):
        found.equal(coefficients(residual, order), [Exact(0)] * len(residual), f"closure, order {order}")
    if subject.subleg.redundant:
        rate = _swivel_rate(here, leg, s, theta)
        wanted = rate[0] + bias["swivel_bias"][0]
        found.equal(rate[1:], [wanted], "second rate of the swivel")


def _swivel_rate(here: Configuration, leg: int, s: list[Any], theta: list[Any]) -> list[Any]:
    """What theta_ddot gives of the swivel's second rate, and that rate itself."""
    d, n = here.subject.subleg.space.dimension, here.subject.subleg.n
    at = here.kernel("subleg", "posture", leg, s=s, theta=theta)
    equations = here.kernel("subleg", equations_kernel(here.subject.subleg), leg, **at)
    weight, row = matrix(equations["A"], n)[d][d], matrix(equations["B"], n)[d]
    gradient = [entry / weight for entry in row]
    rates, second = here.leg("theta_dot", leg), here.leg("theta_ddot", leg)
    still = dot(coefficients(gradient, 0), second)
    return [still, still + dot(coefficients(gradient, 1), rates)]


def newton_step(subject: Subject, here: Configuration, leg: int, found: Measured) -> None:
    """A Newton step leaves a solution where it is, and its derivative there is zero: errors are squared."""
    unknown, name = ("s", "forward_step") if not subject.subleg.has_forward else ("theta", "inverse_step")
    start = here.leg(unknown, leg)
    result = here.kernel("subleg", name, leg)
    found.equal(result[f"{unknown}_next"], start, f"{unknown}, a solution")
    found.equal(result["change"], [Exact(0)], "change at a solution")
    for index in range(len(start)):
        moved = straight(start, unit(len(start), index), [Exact(0)] * len(start))
        after = here.kernel("subleg", name, leg, **{unknown: moved})[f"{unknown}_next"]
        found.equal(coefficients(after, 1), [Exact(0)] * len(start), f"first order in {unknown}[{index}]")
    off = [x + Exact(1) / (50 + index) for index, x in enumerate(start)]
    result = here.kernel("subleg", name, leg, **{unknown: off})
    step = minus(result[f"{unknown}_next"], off)
    found.equal(result["change"], [dot(step, step) / dot(off, off)], "change from beside it")


def links(subject: Subject, here: Configuration, leg: int, found: Measured) -> None:
    """Every link is as long as the geometry or the joint that it is named after; the last point is S_i."""
    names = subject.subleg.points_port().labels
    d = subject.subleg.space.dimension
    rows = matrix(here.kernel("subleg", "points", leg, **posture(here, leg))["points"], d)
    points = dict(zip(names, rows, strict=True))
    lengths = fields(here, leg)
    joints = {j.name: x for j, x in zip(subject.subleg.actuators, here.leg("theta", leg), strict=True)}
    found.equal(points["S"], here.leg("s", leg), "S_i")
    if subject.code.subleg.name in PASSIVE:  # not a sub-leg of one's own, which stands where its author says
        for name, point in places(lengths, here.leg("s", leg), here.leg("theta", leg)).items():
            if name in points:
                found.equal(points[name], point, name)
    for link in subject.subleg.links:
        along = minus(points[link.end], points[link.start])
        length = lengths[link.name] if link.name in lengths else joints[link.name]
        found.equal(
            [dot(along, along)], [length * length], (f"link {link.name} from {link.start} to {link.end}")
        )


# -- position --------------------------------------------------------------------------------------


def forward_closes(subject: Subject, here: Configuration, leg: int, found: Measured) -> None:
    """forward satisfies the closure in every assembly mode, with the posture that belongs to it."""
    for signs in subject.code.assembly_signs:
        given = {"assembly": [Exact(sign) for sign in signs]} if signs else {}
        if subject.subleg.forward_near:
            given = {"s_near": here.leg("s_near", leg)}
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
            swivel: dict[str, Any] = {}
            if subject.subleg.redundant:
                swivel = {"swivel": [Ball(batch.values["swivel"][0][leg])]}

            def kernel(
                name: str, leg: int = leg, geometry: Mapping[str, Any] = geometry, **inputs: Any
            ) -> Any:
                return subject.kernel("subleg", name, inputs, geometry, leg, BALLS)

            every = matrix(kernel("inverse_all", s=s, **swivel)["theta"], n)
            for signs, listed in zip(modes, every, strict=True):
                theta = kernel("inverse", s=s, mode=[Ball(sign) for sign in signs], **swivel)["theta"]
                found.equal(theta, listed, f"inverse_all {signs}")
                residual = kernel("closure", s=s, theta=theta)["residual"]
                found.equal(residual, [Ball(0)] * len(residual), f"closure {signs}")
                if swivel:
                    at = kernel("posture", s=s, theta=theta)
                    found.equal(kernel("swivel", **at)["swivel"], swivel["swivel"], f"swivel {signs}")
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
    # far points, and points at any distance from the base joint
    azimuth, radius = geometry["azimuth"][0], geometry["R_b"][0]
    base = np.array([radius * np.cos(azimuth), radius * np.sin(azimuth), 0.0])[:d, None]
    near = base + rng.normal(size=(d, many)) * 10.0 ** rng.uniform(-4, 0, many)
    s = list(np.where(rng.random(many) < 0.5, rng.uniform(-1.2, 1.2, (d, many)), near))
    seen = [0, 0]
    for signs in subject.code.mode_signs:
        inputs = {"s": s, "mode": [float(sign) for sign in signs], "swivel": [0.3]}
        with np.errstate(all="ignore"):
            excess = subject.kernel("subleg", "reach", inputs, geometry, 0, ARRAYS)["excess"][0]
            inverse = subject.kernel("subleg", "inverse", inputs, geometry, 0, ARRAYS)
        exists = np.isfinite(np.array(inverse["theta"])).all(axis=0) & (inverse["radicand"][0] >= 0)
        excess = np.broadcast_to(excess, exists.shape)
        clear = np.isnan(excess) | (np.abs(excess) > 1e-9)
        found.worse(
            (clear & ((excess <= 0) != exists)).astype(float), f"excess and existence differ in mode {signs}"
        )
        found.samples += many
        seen[0] += int(exists.sum())
        seen[1] += int((~exists).sum())
    if subject.code.always_reachable:
        found.worse(float(seen[1]), "a point is out of reach")
        return found
    found.worse(
        0.0 if min(seen) > 0 else 1.0, f"no points {'within' if seen[1] else 'out of'} reach were drawn"
    )
    return found


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
    "Newton step": proof(newton_step),
    "swivel": proof(swivel),
    "links": proof(links),
    "passive joints": proof(passive_joints),
}
