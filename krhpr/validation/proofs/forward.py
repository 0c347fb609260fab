"""Proofs about the forward kinematics of the platform, in ball arithmetic: its formulas have roots."""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from math import degrees, prod, radians
from typing import Any

import numpy as np

from krhpr.validation.arithmetic import BALLS
from krhpr.validation.check import Check
from krhpr.validation.configurations import Configuration, configuration_in_balls
from krhpr.validation.draw import Draw
from krhpr.validation.linear import dot
from krhpr.validation.numbers import Ball, ball_precision, same
from krhpr.validation.outcome import Measured, Runner
from krhpr.validation.proofs.misfits import squared_misfits
from krhpr.validation.sampling import draw_geometry
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
                found.equal([value(result["sextic"], T, Ball(1))], [wanted], "the sextic at any T")
            cosine, sine = _turn(here, result)
            root = [sine, cosine + Ball(1)]  # tan(phi / 2) = sin / (1 + cos)
            found.equal([value(result["sextic"], *root)], [Ball(0)], "the pose is a root")
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
            # far from it they lead anywhere, and `miss` says so
            inputs["root"] = [sine + Ball(Fraction(1, 5)), cosine + Ball(1)]
            astray = subject.kernel("platform", "assembly", inputs, here.geometry, 0, BALLS)
            gaps_2, size = squared_misfits(here, astray), dot(inputs["length"], inputs["length"])
            found.equal(astray["miss"], [dot(gaps_2, gaps_2) / (size * size)], "miss beside the root")
            found.equal(pose["det_J"], [_det_J(here, pose["redundant"])], "det J at the root")
            found.samples += 1
    return found


def unique_in_the_box(subject: Subject, check: Check, count: int) -> Measured:
    """What the theorem of errata 4 rests on, and that the kernel looks at each of its conditions."""
    found = Measured(check)
    source = Draw(check.seed)
    with ball_precision():
        for _ in range(count):
            drawn = draw_geometry(subject, np.random.default_rng(source.random.randrange(1 << 30)), 0.2)
            general = {name: [Ball(x) for x in values] for name, values in drawn.items()}
            angles = [source.random.uniform(-3, 3) for _ in range(3)]
            diagonal, next_to_it, det_J = _distances(subject, general, angles)
            found.equal([prod(diagonal) + prod(next_to_it)], [det_J * Ball(-8)], "determinant")
            radius = source.random.uniform(0.1, 0.3)
            first = source.random.uniform(-180, 180)
            length = radius * source.random.uniform(0.1, 0.7499)
            equal = {**general, **_equilateral(radius, length), **_azimuths(first, first + 120, first + 240)}
            angles = [source.random.uniform(LOW, HIGH) for _ in range(3)]
            diagonal, _, det_J = _distances(subject, equal, angles)
            positive = [x.to_float() > 0 for x in (*diagonal, -det_J)]
            found.equal([Ball(int(all(positive)))], [Ball(1)], "the minors are positive in the box")
            for name, sizes, box, holds in _conditions(source, radius, first, equal):
                ties = subject.ties({**equal, **sizes}, BALLS)
                inputs = {**ties, "box": [Ball(x) for x in box]}
                margins = subject.kernel("platform", "uniqueness", inputs, equal, 0, BALLS)["certificate"]
                said = all(margin.to_float() >= 0 for margin in margins)
                found.equal([Ball(int(said))], [Ball(int(holds))], name)
            found.samples += 1
    return found


LOW, HIGH = radians(30), radians(150)


def _equilateral(radius: float, length: float) -> dict[str, list[Any]]:
    return {
        "R_p": [Ball(radius)] * 3,
        "l_r": [Ball(length)] * 3,
    }


def _azimuths(*degrees_: float) -> dict[str, list[Any]]:
    return {"platform_azimuth": [Ball(radians(angle)) for angle in degrees_]}


Box = list[float]


def _conditions(
    source: Draw, radius: float, first: float, sizes: dict[str, list[Any]]
) -> Iterator[tuple[str, dict[str, list[Any]], Box, bool]]:
    """Each condition of the theorem violated by itself, and none."""
    whole = [LOW + 1e-12, HIGH - 1e-12] * 3
    off = source.random.uniform(1e-6, 0.1)
    narrow = [LOW + off if place % 2 == 0 else HIGH - off for place in range(6)]
    yield "the theorem holds", {}, whole, True
    yield "in a smaller box too", {}, narrow, True
    for leg in range(3):
        longer = [x * Ball(1 + off) if i == leg else x for i, x in enumerate(sizes["l_r"])]
        yield f"the link of leg {leg + 1} differs", {"l_r": longer}, whole, False
        yield (
            f"the triangle is off, along leg {leg + 1}",
            _beside_centre(radius, first, leg, off),
            whole,
            False,
        )
        # two sides of the triangle are alike, the third is not
        apart = [first + 120 * i + (degrees(off) if i == (leg + 1) % 3 else 0) for i in range(3)]
        apart[(leg + 2) % 3] -= degrees(off)
        yield f"the side opposite to leg {leg + 1} differs", _azimuths(*apart), whole, False
    yield "links too long", {"l_r": [Ball(0.75 * radius * (1 + off))] * 3}, whole, False
    yield "legs in the other order", _azimuths(first, first - 120, first - 240), whole, False
    for place in range(6):
        by = off if place % 2 else -off
        wider = [bound + by if index == place else bound for index, bound in enumerate(whole)]
        yield "a wider box", {}, wider, False


def _beside_centre(radius: float, first: float, leg: int, off: float) -> dict[str, list[Any]]:
    """An equilateral triangle moved along one of its legs: the other two remain alike."""
    points = [radius * np.exp(1j * radians(first + 120 * i)) for i in range(3)]
    moved = [point + off * points[leg] for point in points]
    return {
        "platform_azimuth": [Ball(float(np.angle(point))) for point in moved],
        "R_p": [Ball(float(abs(point))) for point in moved],
    }


def _distances(
    subject: Subject, geometry: dict[str, list[Any]], angles: list[float]
) -> tuple[list[Any], list[Any], Any]:
    """Derivatives of |S_i S_i+1|^2 with respect to beta_i and to beta_i+1, and det J."""

    def ends(by: float) -> list[list[Any]]:
        turn = Ball.pi() * Ball(by)
        values = {"redundant": [Ball(angle) + turn for angle in angles], "p": [Ball(0)] * 3}
        values["Q"] = [Ball(int(i == j)) for i in range(3) for j in range(3)]
        if subject.planar:
            values |= {"p": [Ball(0)] * 2, "phi": [Ball(0)]}
        s = subject.call("end_points", values, geometry, BALLS)["s"]
        size = len(s) // 3
        return [s[size * leg : size * (leg + 1)] for leg in range(3)]

    here, quarter, opposite = ends(0), ends(0.5), ends(1)
    half = Ball(Fraction(1, 2))
    # each link turns about the middle between S_i and its opposite
    slopes = [
        [q - (a + b) * half for q, a, b in zip(quarter[i], here[i], opposite[i], strict=True)]
        for i in range(3)
    ]
    first, second = [], []
    for i in range(3):
        j = (i + 1) % 3
        gap = [a - b for a, b in zip(here[i], here[j], strict=True)]
        first.append(Ball(2) * dot(gap, slopes[i]))
        second.append(Ball(-2) * dot(gap, slopes[j]))
    values = {"redundant": [Ball(angle) for angle in angles]}
    factors = subject.call("type_2_of_redundant", values, geometry, BALLS)["type_2"]
    det_J = prod(factors, start=Ball(1))
    if subject.planar:  # only the factor in the plane
        (a, b, c) = here
        det_J = det_J * ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]))
    return first, second, det_J


def _det_J(here: Configuration, redundant: list[Any]) -> Any:
    """det J from its factors, which depend on the redundant coordinates alone."""
    factors = here.call("type_2_of_redundant", redundant=redundant)["type_2"]
    return prod(factors, start=Ball(1))


def value(coefficients: list[Any], x: Any, y: Any) -> Any:
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
    "unique in the box": unique_in_the_box,
    "sextic": sextic,
}
