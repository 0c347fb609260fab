"""Proofs about Newton steps and encoders: at the pose they stay, beside it errors are squared."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

from krhpr.derivations.platforms.slides import SlidePlatform
from krhpr.validation.arithmetic import BALLS
from krhpr.validation.check import Check
from krhpr.validation.configurations import Configuration, configuration_in_balls
from krhpr.validation.draw import Draw
from krhpr.validation.linear import cross, dot, matrix, minus, solve
from krhpr.validation.numbers import Ball, ball_precision, sqrt
from krhpr.validation.outcome import Measured, Runner
from krhpr.validation.proofs.misfits import squared_misfits
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
            found.equal(pose["misfit"], [Ball(0)], "misfit where steps end")
            small = Ball(Fraction(1, 10**15))
            for index in range(3):
                moved = [x + (small if i == index else Ball(0)) for i, x in enumerate(state)]
                end = _platform(here, "newton_step", state=moved, **start)["state_next"]
                gaps = [abs((a - b).to_float()) for a, b in zip(end, state, strict=True)]
                found.equal([Ball(int(max(gaps) < 1e-25))], [Ball(1)], f"a step from beside it, {index}")
            _what_ends_steps(here, start, state, found)
            found.samples += 1
    return found


def _what_ends_steps(here: Configuration, start: Outputs, state: list[Any], found: Measured) -> None:
    """How long a step is, and by how much the links misfit where it began, by their definitions."""
    ties = here.subject.ties(here.geometry, BALLS)
    anchors, lengths = matrix(ties["anchor"], 2), ties["length"]
    arms = [minus(anchor, anchors[0]) for anchor in anchors[1:]]
    size = dot(arms[0], arms[0]) + dot(arms[1], arms[1])
    off = [x + Ball(Fraction(1, 50 + i)) if i < 3 else x for i, x in enumerate(state)]
    after = _platform(here, "newton_step", state=off, **start)
    turn, *move = (after["state_next"][i] - off[i] for i in range(3))
    found.equal(after["change"], [turn * turn + dot(move, move) / size], "change")
    pose = _platform(here, "newton_pose", state=off, **start)
    gaps = squared_misfits(here, pose)
    whole = size + dot(lengths, lengths)
    found.equal(pose["misfit"], [dot(gaps, gaps) / (whole * whole)], "misfit")


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


def orthonormalised(subject: Subject, check: Check, count: int) -> Measured:
    """From any U: the orientation as it is, and made a rotation by (3.34) to (3.36) in the base frame."""
    found = Measured(check)
    source = Draw(check.seed)
    with ball_precision():
        for _ in range(count):
            here = configuration_in_balls(subject, source)
            d = 2 if subject.planar else 3
            s = here.values["s"]
            state = [Ball(source.nonzero()) for _ in range(6)]
            axes = [[Ball(1), Ball(0)], [Ball(0), Ball(1)]]
            inputs: dict[str, Any] = {"state": state, "s": s}
            if not subject.planar:
                inputs["axes"] = _axes_of(here)
                axes = [[inputs["axes"][3 * i + j] for i in range(3)] for j in range(3)]
            result = subject.kernel("platform", "encoder_pose", inputs, here.geometry, 0, BALLS)
            columns = [
                [sum((state[2 * j + k] * axes[k][i] for k in range(2)), Ball(0)) for i in range(d)]
                for j in range(2)
            ]
            if not subject.planar:
                columns.append(axes[2])
            found.equal(result["raw"], [column[i] for i in range(d) for column in columns], "raw")
            p = [s[i] + sum((state[4 + k] * axes[k][i] for k in range(2)), Ball(0)) for i in range(d)]
            found.equal(result["p"], p, "p")
            square = dot(columns[0], columns[0])
            found.equal(result["direction"], [square], "direction")
            found.equal(result["direction"], [square], "direction")
            q_x = [x / sqrt(square) for x in columns[0]]
            if subject.planar:
                phi = result["phi"][0]
                found.equal([phi.cos(), phi.sin()], q_x, "phi")
            else:
                q_y = cross(axes[2], q_x)
                wanted = [column[i] for i in range(3) for column in (q_x, q_y, axes[2])]
                found.equal(result["Q"], wanted, "Q")
            found.samples += 1
    return found


def _axes_of(here: Configuration) -> list[Any]:
    """The intermediate frame by (3.1) to (3.3), z_1 along q_z."""
    s = [here.values["s"][3 * i : 3 * i + 3] for i in range(3)]
    x = minus(s[1], s[0])
    x = [value / sqrt(dot(x, x)) for value in x]
    z = [here.values["Q"][3 * i + 2] for i in range(3)]
    y = cross(z, x)
    return [column[i] for i in range(3) for column in (x, y, z)]


def least_squares(subject: Subject, check: Check, count: int) -> Measured:
    """A Gauss-Newton step from anywhere solves the normal equations of the residuals by their definition."""
    found = Measured(check)
    source = Draw(check.seed)
    many = [
        kernel.name[-1] for kernel in subject.platform.kernels() if kernel.name.startswith("gauss_newton")
    ]
    with ball_precision():
        for _ in range(count):
            here = configuration_in_balls(subject, source)
            ties = here.subject.ties(here.geometry, BALLS)
            for encoders_ in map(int, many):
                points, ends = _vectors(source, 3), _vectors(source, encoders_)
                weights = [Ball(source.nonzero(0.5, 2)) for _ in range(3)]
                state = [Ball(source.nonzero()) for _ in range(6)]

                def residual(
                    x: list[Any],
                    n: int = encoders_,
                    r: Any = points,
                    d: Any = ends,
                    w: Any = weights,
                    ties: Any = ties,
                ) -> list[Any]:
                    turn, p = [[x[0], x[2]], [x[1], x[3]]], x[4:]
                    rows = [w[0] * (p[k] + dot(turn[k], d[i]) - r[i][k]) for i in range(n) for k in range(2)]
                    if n == 2:
                        rows.append(w[1] * _tie_residual(subject, ties, turn, p, r[2]))
                    x_axis, y_axis = x[0:2], x[2:4]
                    one = Ball(1)
                    rows += [
                        w[2] * y
                        for y in (dot(x_axis, x_axis) - one, dot(y_axis, y_axis) - one, dot(x_axis, y_axis))
                    ]
                    return rows

                # residuals are of second degree: differences over two are derivatives
                columns = []
                for j in range(6):
                    ahead, behind = ([*state] for _ in range(2))
                    ahead[j], behind[j] = ahead[j] + Ball(1), behind[j] - Ball(1)
                    half = Ball(Fraction(1, 2))
                    columns.append(
                        [(a - b) * half for a, b in zip(residual(ahead), residual(behind), strict=True)]
                    )
                inputs = {
                    **ties,
                    "state": state,
                    "weights": weights,
                    "points": [x for row in points for x in row],
                    "ends": [x for row in ends for x in row],
                }
                name = f"gauss_newton_{encoders_}"
                result = subject.kernel("platform", name, inputs, here.geometry, 0, BALLS)
                step = [a - b for a, b in zip(result["state_next"], state, strict=True)]
                value = residual(state)
                moved = [
                    f + sum((columns[j][i] * step[j] for j in range(6)), Ball(0)) for i, f in enumerate(value)
                ]
                found.equal(
                    [dot(column, moved) for column in columns], [Ball(0)] * 6, f"{name}: normal equations"
                )
                size = sum((dot(end, end) for end in ends), Ball(0))
                length = dot(step[:4], step[:4]) + dot(step[4:], step[4:]) / size
                found.equal(result["change"], [length], f"{name}: change")
                size = sum((dot(end, end) for end in ends), Ball(0))
                change = dot(step[:4], step[:4]) + dot(step[4:], step[4:]) / size
                found.equal(result["change"], [change], f"{name}: change")
            found.samples += 1
    return found


def _tie_residual(
    subject: Subject, ties: dict[str, Any], turn: list[list[Any]], p: list[Any], s: list[Any]
) -> Any:
    """By how much S_3 misses its tie: an error of the link's length, or a distance from the slide."""

    def base(v: list[Any]) -> list[Any]:
        return [dot(turn[k], v) for k in range(2)]

    if "anchor" in ties:
        length = ties["length"][2]
        link = [a + b - c for a, b, c in zip(p, base(ties["anchor"][4:6]), s, strict=True)]
        return (dot(link, link) - length * length) / (Ball(2) * length)
    t = ties["slide"][4:6]
    start = [Ball(0), Ball(0)]
    platform = subject.platform
    if isinstance(platform, SlidePlatform) and platform.offset:
        hand = Ball(platform.handedness)
        n = [-hand * t[1], hand * t[0]]
        start = [ties["distance"][2] * a + ties["start"][2] * b for a, b in zip(n, t, strict=True)]
    w, away = base(t), [a - b - c for a, b, c in zip(s, p, base(start), strict=True)]
    return w[0] * away[1] - w[1] * away[0]


def _vectors(source: Draw, count: int) -> list[list[Any]]:
    return [[Ball(source.nonzero()), Ball(source.nonzero())] for _ in range(count)]


def kantorovich(subject: Subject, check: Check, count: int) -> Measured:
    """2 b K n at a pose nearby, by its definition."""
    found = Measured(check)
    source = Draw(check.seed)
    with ball_precision():
        for _ in range(count):
            here = configuration_in_balls(subject, source)
            ties = here.subject.ties(here.geometry, BALLS)
            b = [ties["anchor"][2 * i : 2 * i + 2] for i in range(3)]
            d = [[x - y for x, y in zip(v, b[0], strict=True)] for v in b]
            start, _ = _beside(here)
            _, x, y, c, s = start["start"]
            found.equal(start["centre"], [c, s], "centre")
            points = [start["points"][2 * i : 2 * i + 2] for i in range(3)]
            turned = [[c * v[0] - s * v[1], s * v[0] + c * v[1]] for v in d]
            arms = [[x - r[0], y - r[1]] for r in points]
            links = [
                [o + t for o, t in zip(arm, turn, strict=True)]
                for arm, turn in zip(arms, turned, strict=True)
            ]
            size2 = (dot(d[1], d[1]) + dot(d[2], d[2])) / Ball(2)
            size = sqrt(size2)
            slope = [
                [(a[1] * t[0] - a[0] * t[1]) / size, a[0], a[1]] for a, t in zip(links, turned, strict=True)
            ]
            half = Ball(Fraction(1, 2))
            F = [
                [(dot(a, a) - length * length) * half]
                for a, length in zip(links, ties["length"], strict=True)
            ]
            unit = [[Ball(int(i == j)) for j in range(3)] for i in range(3)]
            inverse = solve(slope, unit)
            step = [row[0] for row in solve(slope, F)]
            n = sqrt(dot(step, step))
            squares = sum((entry * entry for row in inverse for entry in row), Ball(0))
            bend = Ball(0)
            for arm, v in zip(arms, d, strict=True):
                reach = sqrt(dot(v, v)) if v is not d[0] else Ball(0)
                first = (sqrt(dot(arm, arm)) + Ball(2) * n) * reach / size2
                bend = bend + first * first + Ball(2) * reach * reach / size2 + Ball(2)
            found.equal(start["kantorovich"], [Ball(2) * sqrt(squares * bend) * n], "kantorovich")
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


RUNNERS: dict[str, Runner] = {
    "Newton steps of the platform": newton,
    "Newton and Kantorovich": kantorovich,
    "encoders": encoders,
    "orthonormalised": orthonormalised,
    "least squares": least_squares,
}
