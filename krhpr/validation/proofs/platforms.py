"""Proofs about platform arrangements: rows, velocities and accelerations follow from the constraint
equations.
"""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from typing import Any

from krhpr.codegen.evaluate import evaluate_kernel
from krhpr.codegen.kernel import LEGS
from krhpr.derivations.vectors import NO_LENGTH
from krhpr.validation.check import Check
from krhpr.validation.configurations import Configuration, configuration
from krhpr.validation.draw import Draw
from krhpr.validation.jets import Jet, accelerations, coefficients, straight, turning
from krhpr.validation.linear import (
    Matrix,
    apply,
    cross,
    determinant,
    dot,
    identity,
    matrix,
    minus,
    plus,
    scaled,
    times,
    transpose,
)
from krhpr.validation.numbers import Exact
from krhpr.validation.outcome import Measured, Runner
from krhpr.validation.proofs import thesis
from krhpr.validation.proofs.sublegs import fields, proof, tangent_kernel, unit
from krhpr.validation.subject import Subject


def moving(here: Configuration) -> dict[str, list[Any]]:
    """The platform's pose and redundant coordinates as motions with the configuration's rates."""
    d = here.subject.platform.space.dimension
    v = here.values
    twist, rate = v["twist"], v["twist_rate"]
    motions: dict[str, list[Any]] = {"p": straight(v["p"], twist[:d], rate[:d])}
    if here.subject.planar:
        phi = Jet.motion(v["phi"][0], twist[d], rate[d])
        motions |= {"phi": [phi], "Q": [phi.cos(), -phi.sin(), phi.sin(), phi.cos()]}
    else:
        motions["Q"] = turning(v["Q"], twist[d:], rate[d:])
    motions["redundant"] = straight(v["redundant"], v["redundant_rates"], v["redundant_accelerations"])
    return motions


def moving_end_point(here: Configuration, leg: int) -> list[Any]:
    """S_i along the platform's motion."""
    motions = moving(here)
    return here.kernel(
        "platform", "end_point", leg, p=motions["p"], Q=motions["Q"], redundant=[motions["redundant"][leg]]
    )["s"]


def rows(here: Configuration, leg: int, **inputs: Any) -> tuple[Matrix, Matrix]:
    """The leg's rows of J and N."""
    space = here.subject.platform.space
    found = here.kernel("platform", "rows", leg, **inputs)
    return matrix(found["J"], space.degrees_of_freedom), matrix(found["N"], space.dimension)


def pose_rates(here: Configuration, twist: list[Any]) -> tuple[list[Any], list[Any]]:
    """p_dot and Q_dot of a twist."""
    d = here.subject.platform.space.dimension
    Q = matrix(here.values["Q"], d)
    if here.subject.planar:
        columns = [scaled(twist[2], thesis.quarter(column)) for column in transpose(Q)]
    else:
        columns = [cross(twist[3:], column) for column in transpose(Q)]
    return twist[:d], [entry for row in transpose(columns) for entry in row]


def closure(subject: Subject, here: Configuration, leg: int, found: Measured) -> None:
    """The end point closes the constraints and gives the redundant coordinate back."""
    residual = here.kernel("platform", "residual", leg)["residual"]
    found.equal(residual, [Exact(0)] * len(residual), "residual")
    found.equal(
        here.kernel("platform", "redundant", leg)["redundant"], here.leg("redundant", leg), "redundant"
    )


def rows_are_derivatives(subject: Subject, here: Configuration, leg: int, found: Measured) -> None:
    """Each column of J and N against the derivative of the residual, by tangents of its graph."""
    rate = tangent_kernel(subject.derived("platform", "residual"), "residual", ("p", "Q", "s"))
    space = subject.platform.space
    J, N = rows(here, leg)
    still = [Exact(0)] * space.dimension
    for index in range(space.degrees_of_freedom):
        d_p, d_q = pose_rates(here, unit(space.degrees_of_freedom, index))
        got = here.kernel("platform", rate, leg, d_p=d_p, d_Q=d_q, d_s=still)["rate"]
        found.equal(got, [row[index] for row in J], f"J, column {index}")
    nothing = [Exact(0)] * space.dimension**2
    for index in range(space.dimension):
        got = here.kernel("platform", rate, leg, d_p=still, d_Q=nothing, d_s=unit(space.dimension, index))[
            "rate"
        ]
        found.equal(got, [-row[index] for row in N], f"N, column {index}")


def thesis_rows(subject: Subject, here: Configuration, leg: int, found: Measured) -> None:
    """J as printed."""
    name = subject.code.platform.name
    Q = matrix(here.values["Q"], subject.platform.space.dimension)
    printed = thesis.ROWS[name](fields(here, leg, "platform"), here.values["p"], Q, here.leg("s", leg))
    found.equal(rows(here, leg)[0], printed, "J")


def lines(subject: Subject, here: Configuration, leg: int, found: Measured) -> None:
    """Lines and points are rows of J and S_i turned into the platform frame."""
    d = subject.platform.space.dimension
    result = here.kernel("platform", "line", leg)
    J, N = rows(here, leg)
    turned_back = transpose(matrix(here.values["Q"], d))
    direction, moment = J[0][:d], J[0][d:]
    wanted = [*apply(turned_back, direction), *(moment if subject.planar else apply(turned_back, moment))]
    found.equal(result["line"], wanted, "line")
    found.equal(matrix(result["N"], d), N, "N")
    arm = minus(here.leg("s", leg), here.values["p"])
    found.equal(result["point"], apply(turned_back, arm)[:2], "point")
    if not subject.planar:
        q_z = [row[2] for row in matrix(here.values["Q"], d)]
        found.equal(J[1], [*q_z, *cross(arm, q_z)], "normal row")


def line_of_redundant(subject: Subject, here: Configuration, leg: int, found: Measured) -> None:
    """Line and end point without a pose are those with one."""
    result, wanted = (here.kernel("platform", name, leg) for name in ("line_of_redundant", "line"))
    for name in ("line", "point", "scale"):
        found.equal(result[name], wanted[name], name)


def end_motion(subject: Subject, here: Configuration, leg: int, found: Measured) -> None:
    """Velocity and acceleration of the end point against its series."""
    s = moving_end_point(here, leg)
    found.equal(coefficients(s, 0), here.leg("s", leg), "s")
    found.equal(coefficients(s, 1), here.kernel("platform", "end_velocity", leg)["s_dot"], "s_dot")
    result = here.kernel("platform", "end_acceleration", leg)
    found.equal(result["s_dot"], coefficients(s, 1), "s_dot beside s_ddot")
    found.equal(result["s_ddot"], accelerations(s), "s_ddot")
    motions = moving(here)
    residual = here.kernel("platform", "residual", leg, s=s, p=motions["p"], Q=motions["Q"])["residual"]
    for order in range(3):
        found.equal(coefficients(residual, order), [Exact(0)] * len(residual), f"residual, order {order}")


def row_bias(subject: Subject, here: Configuration, leg: int, found: Measured) -> None:
    """(1.30) differentiated, with the end point's acceleration from its series."""
    s = moving_end_point(here, leg)
    J, N = rows(here, leg)
    bias = here.kernel("platform", "row_bias", leg, s_dot=coefficients(s, 1))["bias"]
    found.equal(apply(J, here.values["twist_rate"]), plus(apply(N, accelerations(s)), bias), "J t_dot")


def whole(here: Configuration, **inputs: Any) -> tuple[Matrix, dict[str, list[Any]]]:
    """J of all legs, and the lines, points and scales that kernels of the whole platform read."""
    J: Matrix = []
    gathered: dict[str, list[Any]] = {"line": [], "point": [], "scale": []}
    for leg in range(LEGS):
        of_leg = {name: values[leg] for name, values in inputs.items()}
        J += rows(here, leg, **of_leg)[0]
        result = here.kernel("platform", "line", leg, **of_leg)
        for name, values in gathered.items():
            values += result[name]
    return J, gathered


def _anyhow(here: Configuration, source: Draw) -> Iterator[tuple[Matrix, dict[str, list[Any]]]]:
    """J, lines and points: with end points on the constraints, with any, and with any lines."""
    subject = here.subject
    yield whole(here)
    yield whole(here, s=[source.vector(len(here.leg("s", 0))) for _ in range(LEGS)])
    lines = [source.vector(subject.platform.space.degrees_of_freedom) for _ in range(LEGS)]
    points = [source.vector(2) for _ in range(LEGS)]
    J = []
    for line, (x, y) in zip(lines, points, strict=True):
        J.append(_in_base(here, line))
        if not subject.planar:
            J.append(_in_base(here, [Exact(0), Exact(0), Exact(1), y, -x, Exact(0)]))
    flat = {"line": lines, "point": points}
    yield J, {name: [entry for row in rows_ for entry in row] for name, rows_ in flat.items()}


def solving(subject: Subject, check: Check, count: int) -> Measured:
    """J solve(r) = r for any end points, on the constraints or not, and for any lines."""
    found = Measured(check)
    source = Draw(check.seed)
    for _ in range(count):
        here = configuration(subject, source)
        rates = [
            here.arithmetic.constant(source.nonzero().fraction)
            for _ in range(LEGS * subject.platform.space.rows_per_leg)
        ]
        for J, gathered in _anyhow(here, source):
            inputs = {
                "Q": here.values["Q"],
                "line": gathered["line"],
                "point": gathered["point"],
                "rate": rates,
            }
            result = evaluate_kernel(subject.derived("platform", "solve"), inputs, None, here.arithmetic)
            found.equal(apply(J, result["twist"]), rates, "J t")
            _regularity(subject, gathered, result["regularity"], found)
            found.samples += 1
    return found


def balance(subject: Subject, check: Check, count: int) -> Measured:
    """J^T lambda + C^T phi = F for any end points, any lines, and any lines of the redundant coordinates."""
    found = Measured(check)
    source = Draw(check.seed)
    f = subject.platform.space.degrees_of_freedom
    for _ in range(count):
        here = configuration(subject, source)
        lines = [source.vector(f) for _ in range(LEGS)]
        for J, gathered in _anyhow(here, source):
            inputs = {
                **{name: here.values[name] for name in ("Q", "wrench", "redundant_forces")},
                **{name: gathered[name] for name in ("line", "point")},
                "redundant_line": [entry for line in lines for entry in line],
            }
            result = evaluate_kernel(subject.derived("platform", "balance"), inputs, None, here.arithmetic)
            total = apply(transpose(J), result["line_forces"])
            for line, force in zip(lines, here.values["redundant_forces"], strict=True):
                total = plus(total, scaled(force, _in_base(here, line)))
            found.equal(total, here.values["wrench"], "J^T lambda + C^T phi")
            _regularity(subject, gathered, result["regularity"], found)
            found.samples += 1
        for leg in range(LEGS):
            _redundant_line(here, leg, source.vector(subject.platform.space.dimension), found)
    return found


def _redundant_line(here: Configuration, leg: int, s: list[Any], found: Measured) -> None:
    """The line has the direction that is given in the base frame, and goes through S_i, wherever it is."""
    d = here.subject.platform.space.dimension
    result = here.kernel("platform", "redundant_line", leg, s=s)
    in_platform = transpose(matrix(here.values["Q"], d))
    local = apply(in_platform, result["along"])
    arm = apply(in_platform, minus(s, here.values["p"]))
    moment = cross(arm, local) if d == 3 else [arm[0] * local[1] - arm[1] * local[0]]
    found.equal(result["redundant_line"], [*local, *moment], "line of the redundant force")


def _in_base(here: Configuration, line: list[Any]) -> list[Any]:
    """A line or wrench of the platform frame in the base frame; its moment stays about O'."""
    d = here.subject.platform.space.dimension
    Q = matrix(here.values["Q"], d)
    return [*apply(Q, line[:d]), *(apply(Q, line[d:]) if d == 3 else line[d:])]


def _regularity(
    subject: Subject, gathered: dict[str, list[Any]], regularity: list[Any], found: Measured
) -> None:
    """det J_a^2 and det J_n^2 over the largest values that they could have at these distances."""
    points = matrix(gathered["point"], 2)
    directions = [line[:2] for line in matrix(gathered["line"], 3 if subject.planar else 6)]
    moments = [line[-1] for line in matrix(gathered["line"], 3 if subject.planar else 6)]
    size = sum((dot(point, point) for point in points), Exact(Fraction(NO_LENGTH.p, NO_LENGTH.q)))
    in_plane = determinant([[*line, moment] for line, moment in zip(directions, moments, strict=True)])
    bound = size
    for line in directions:
        bound = bound * dot(line, line)
    wanted = [in_plane * in_plane / bound]
    if not subject.planar:
        normal = determinant([[Exact(1), point[1], -point[0]] for point in points])
        wanted.append(normal * normal / (size * size))
    found.equal(regularity, wanted, "regularity")


# -- determinants ----------------------------------------------------------------------------------


def joint(subject: Subject, here: Configuration, leg: int, found: Measured) -> None:
    """The redundant link's frame, and where it points."""
    d = subject.platform.space.dimension
    g = fields(here, leg, "platform")
    p, s, Q = here.values["p"], here.leg("s", leg), matrix(here.values["Q"], d)
    result = here.kernel("platform", "joint", leg)
    found.equal(result["platform_joint"], here.leg("redundant", leg), "platform joint")
    along = result["redundant_link"]
    if not subject.planar:
        frame = matrix(result["redundant_link"], 3)
        columns = transpose(frame)
        found.equal(times(transpose(frame), frame), identity(3), "R^T R")
        found.equal(cross(columns[0], columns[1]), columns[2], "x cross y")
        found.equal(columns[2], [row[2] for row in Q], "z")
        along = columns[0]
    attachment = here.kernel("platform", "attachment", leg)["attachment"]
    local = thesis.ATTACHMENTS[subject.code.platform.name](g, here.leg("redundant", leg)[0])
    found.equal(attachment, plus(p, apply(Q, local[:d])), "joint or slider on the platform")
    if subject.platform.redundant_link:
        found.equal(plus(s, scaled(g[subject.platform.redundant_link], along)), attachment, "redundant link")
    else:
        found.equal(plus(p, scaled(here.leg("redundant", leg)[0], along)), s, "S_i on the slide")


RUNNERS: dict[str, Runner] = {
    "closure": proof(closure),
    "rows": proof(rows_are_derivatives),
    "thesis rows": proof(thesis_rows),
    "lines": proof(lines),
    "line of the redundant coordinate": proof(line_of_redundant),
    "end velocity and acceleration": proof(end_motion),
    "row bias": proof(row_bias),
    "solve": solving,
    "balance": balance,
    "joint": proof(joint),
}
