"""Passive joints of sub-legs: links laid end to end with all angles, actuated and passive, meet in S_i."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from krhpr.validation.configurations import Configuration
from krhpr.validation.linear import (
    cross,
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
from krhpr.validation.outcome import Measured
from krhpr.validation.proofs import thesis
from krhpr.validation.proofs.places import around
from krhpr.validation.proofs.thesis import Vector
from krhpr.validation.subject import Subject


@dataclass(frozen=True)
class Leg:
    """One leg in a configuration, with the results of its kernel `passive`."""

    g: dict[str, Any]
    theta: list[Any]
    s: list[Any]
    passive: list[Any]
    link: list[Any]
    found: Measured

    def meets(self, point: Vector, what: str = "S_i") -> None:
        """A chain of links ends in S_i."""
        self.found.equal(point, self.s, what)


def passive_joints(subject: Subject, here: Configuration, leg: int, found: Measured) -> None:
    """The chains of one leg, where they are known here, and the frame (in the plane: direction) of its last
    link.
    """
    at = here.kernel("subleg", "posture", leg)
    result = here.kernel("subleg", "passive", leg, **at)
    fields = {field.name: here.geometry[field.name][leg] for field in subject.geometry_types["subleg"].fields}
    link = result["link"]
    if not subject.planar:
        frame = matrix(link, 3)
        found.equal(times(transpose(frame), frame), identity(3), "link^T link")
        columns = transpose(frame)
        found.equal(cross(columns[0], columns[1]), columns[2], "link, right-handed")
    else:
        found.equal([dot(link, link)], [Exact(1)], "length of link")
    theta, s = here.leg("theta", leg), here.leg("s", leg)
    chains = PASSIVE.get(subject.code.subleg.name)
    if chains is None:
        return  # a sub-leg of one's own
    chains(Leg(fields, theta, s, result.get("passive", []), link, found))
    folded = FOLDED.get(subject.code.subleg.name)
    assert (folded is None) == ("regularity" not in result)
    if folded is not None:
        found.equal(result["regularity"], [folded(Leg(fields, theta, s, [], link, found))], "regularity")


def _direction(angle: Any, x: Vector, y: Vector) -> Vector:
    return plus(scaled(angle.cos(), x), scaled(angle.sin(), y))


def _flat(angle: Any) -> Vector:
    return [angle.cos(), angle.sin()]


Z: Vector = [Exact(0), Exact(0), Exact(1)]


def _base(leg: Leg) -> thesis.Axes:
    """The leg frame: x, e_1 and e_2 = e_t at rest, and c."""
    return thesis.axes(leg.g, None)


def _keeps_orientation(leg: Leg) -> None:
    """A platform that only translates stands as the leg frame does."""
    at = _base(leg)
    leg.found.equal(transpose(matrix(leg.link, 3)), [at.x, at.e_1, at.e_2], "orientation of the platform")


# -- linkages on carriers ----------------------------------------------------------------------------


def _carried(leg: Leg, slides: bool) -> tuple[thesis.Axes, Vector]:
    """The linkage plane's axes and its origin."""
    if not slides:
        at = thesis.axes(leg.g, leg.theta[0])
        return at, at.c
    at = _base(leg) if "slide_azimuth" not in leg.g else _parallel(leg)
    return at, plus(at.c, scaled(leg.theta[0], at.e_2))


def _parallel(leg: Leg) -> thesis.Axes:
    """The leg frame of a slide at an azimuth of its own; c is at that of the leg."""
    # e_t is at slide_azimuth, so that e_r is a quarter turn behind it
    e_t: Vector = [leg.g["slide_azimuth"].cos(), leg.g["slide_azimuth"].sin(), Exact(0)]
    lean = scaled(-leg.g["alpha"].cos(), cross(e_t, Z))
    e_1 = plus(lean, scaled(leg.g["alpha"].sin(), Z))
    radial = [leg.g["azimuth"].cos(), leg.g["azimuth"].sin(), Exact(0)]
    c = plus(scaled(leg.g["R_b"], radial), scaled(leg.g["l_1"], e_1))
    return thesis.Axes(c, e_1, e_t, cross(e_1, e_t))


def _two_links(leg: Leg, last: Any, lengths: tuple[str, str], slides: bool) -> None:
    at, origin = _carried(leg, slides)
    inner, outer = (_direction(angle, at.x, at.e_1) for angle in (leg.theta[1], last))
    frame = [outer, cross(at.e_2, outer), at.e_2]
    leg.found.equal(transpose(matrix(leg.link, 3)), frame, "link frame")
    leg.meets(plus(origin, plus(scaled(leg.g[lengths[0]], inner), scaled(leg.g[lengths[1]], outer))))


def _serial(slides: bool) -> Callable[[Leg], None]:
    return lambda leg: _two_links(leg, leg.theta[1] + leg.theta[2], ("l_2", "l_3"), slides)


def _five_bar_loop(leg: Leg, first: Any, second: Any, apart: Vector, ratio: Any) -> None:
    """u_1 + k v_1 = o_12 + u_2 + v_2 with the passive angles."""
    crank_1, crank_2, rod = leg.passive
    g, distal, link_2 = leg.g, first + crank_1, second + crank_2
    by_rod = plus(apart, plus(scaled(g["l_2"], _flat(second)), scaled(g["l_3"], _flat(link_2))))
    by_distal = plus(scaled(g["l_4"], _flat(first)), scaled(ratio * g["l_6"], _flat(distal)))
    leg.found.equal(by_rod, by_distal, "P")
    leg.found.equal(_flat(link_2 + rod), _flat(distal), "rod")


def _hybrid(slides: bool) -> Callable[[Leg], None]:
    def check(leg: Leg) -> None:
        _two_links(leg, leg.theta[1] + leg.passive[0], ("l_4", "l_6"), slides)
        ratio = 1 - leg.g["l_5"] / leg.g["l_6"]
        _five_bar_loop(leg, leg.theta[1], leg.theta[2], [Exact(0), Exact(0)], ratio)

    return check


def _rrrr(leg: Leg) -> None:
    at = thesis.axes(leg.g, leg.theta[0])
    inner = thesis.turned(at.e_2, leg.theta[1], at.x)
    e_4 = thesis.turned(inner, leg.theta[2], at.e_2)
    outer = thesis.turned(e_4, leg.theta[3], inner)
    leg.found.equal(transpose(matrix(leg.link, 3)), [outer, cross(e_4, outer), e_4], "link frame")
    leg.meets(plus(at.c, plus(scaled(leg.g["l_2"], inner), scaled(leg.g["l_3"], outer))))


# -- chains in space ---------------------------------------------------------------------------------


def _strut(leg: Leg, k: int, base: Vector, frame: tuple[Vector, Vector, Vector]) -> None:
    """base + rho_k Rot(f_0, tilt) Rot(f_1, lean) f_2 = S_i."""
    (first, second, third), rho = frame, leg.theta[k]
    tilt, lean = leg.passive[2 * k : 2 * k + 2]
    second, third = (thesis.turned(first, tilt, axis) for axis in (second, third))
    leg.meets(plus(base, scaled(rho, thesis.turned(second, lean, third))))


def _ups3(leg: Leg) -> None:
    at = _base(leg)
    for k, out in enumerate(around(leg.g)):
        base = plus(at.c, scaled(leg.g["r_g"], out))
        _strut(leg, k, base, (at.x, at.e_1, at.e_2))
        if k == 0:
            along = [row[0] for row in matrix(leg.link, 3)]
            leg.found.equal(plus(base, scaled(leg.theta[0], along)), leg.s, "frame of strut 1")


def _upu3(leg: Leg) -> None:
    at = _base(leg)
    for k, out in enumerate(around(leg.g)):
        base = plus(at.c, scaled(leg.g["r_g"], out))
        frame = (cross(Z, out), scaled(-1, out), Z)
        _strut(leg, k, base, frame)
    _keeps_orientation(leg)


def _delta(leg: Leg) -> None:
    at, g = _base(leg), leg.g
    for k, out in enumerate(around(leg.g)):
        knee, lean = leg.passive[2 * k : 2 * k + 2]
        arm = plus(scaled(g["r_g"], out), scaled(g["L"], _direction(leg.theta[k], out, Z)))
        rod = _direction(lean, _direction(leg.theta[k] + knee, out, Z), cross(Z, out))
        leg.meets(plus(at.c, plus(arm, scaled(g["R"], rod))))
    _keeps_orientation(leg)


def _cpr3(leg: Leg) -> None:
    at, g = _base(leg), leg.g
    for k in (1, 2, 3):
        e = _direction(g[f"tilt_{k}"], at.x, _direction(g[f"turn_{k}"], at.e_1, at.e_2))
        across = plus(scaled(g[f"y_{k}"], at.e_1), scaled(g[f"z_{k}"], at.e_2))
        offset = plus(scaled(g[f"x_{k}"], at.x), across)
        turn, travel = leg.passive[2 * k - 2 : 2 * k]
        zero = cross(at.e_1, e)
        zero = scaled(1 / dot(zero, zero).sqrt(), zero)
        out = thesis.turned(e, turn, zero)
        axis = plus(plus(at.c, offset), scaled(travel, e))
        leg.meets(plus(axis, scaled(leg.theta[k - 1], out)))
    _keeps_orientation(leg)


def _tripteron(leg: Leg) -> None:
    at, g = _base(leg), leg.g
    axes = (at.x, at.e_1, at.e_2)
    for k in range(3):
        hinge, elbow = leg.passive[2 * k : 2 * k + 2]
        plane = (axes[(k + 1) % 3], axes[(k + 2) % 3])
        first = scaled(g["l_2"], _direction(hinge, *plane))
        second = scaled(g["l_3"], _direction(hinge + elbow, *plane))
        slider = plus(at.c, scaled(leg.theta[k], axes[k]))
        leg.meets(plus(slider, plus(first, second)))
    _keeps_orientation(leg)


def _tripteron_folded(leg: Leg) -> Any:
    """The square of the shortest way from a slider to the end point, over that of stretched links."""
    at, reach = _base(leg), leg.g["l_2"] + leg.g["l_3"]
    axes = (at.x, at.e_1, at.e_2)
    ways = (minus(leg.s, plus(at.c, scaled(leg.theta[k], axes[k]))) for k in range(3))
    return min(dot(way, way) for way in ways) / (reach * reach)


# -- in the plane ------------------------------------------------------------------------------------


def _radial(leg: Leg) -> Vector:
    return _flat(leg.g["azimuth"])


def _foot(leg: Leg, share: Any = None) -> Vector:
    """The base joint; with a share of l_0 along e_t from R_b e_r."""
    radial = _radial(leg)
    foot = scaled(leg.g["R_b"], radial)
    return foot if share is None else plus(foot, scaled(share * leg.g["l_0"], thesis.quarter(radial)))


def _slide(leg: Leg, field: str) -> Vector:
    return _flat(leg.g["azimuth"] + leg.g[field])


def _planar_rr(leg: Leg) -> None:
    leg.found.equal(leg.link, _flat(leg.theta[0] + leg.theta[1]), "link")
    inner = scaled(leg.g["l_1"], _flat(leg.theta[0]))
    leg.meets(plus(_foot(leg), plus(inner, scaled(leg.g["l_2"], leg.link))))


def _planar_pr(leg: Leg) -> None:
    leg.found.equal(leg.link, _flat(leg.theta[1]), "link")
    slider = plus(_foot(leg), scaled(leg.theta[0], _slide(leg, "slide")))
    leg.meets(plus(slider, scaled(leg.g["l_1"], leg.link)))


def _planar_rp(leg: Leg) -> None:
    leg.found.equal(leg.link, _flat(leg.theta[0]), "link")
    offset = scaled(leg.g["h"], thesis.quarter(leg.link))
    leg.meets(plus(_foot(leg), plus(scaled(leg.theta[1], leg.link), offset)))


def _planar_pp(leg: Leg) -> None:
    leg.found.equal(leg.link, _slide(leg, "slide_2"), "link")
    first = scaled(leg.theta[0], _slide(leg, "slide_1"))
    leg.meets(plus(_foot(leg), plus(first, scaled(leg.theta[1], leg.link))))


def _planar_rrr(leg: Leg) -> None:
    angle, point = leg.theta[0], _foot(leg)
    for k in (1, 2, 3):
        point = plus(point, scaled(leg.g[f"l_{k}"], _flat(angle)))
        if k < 3:
            angle = angle + leg.theta[k]
    leg.found.equal(leg.link, _flat(angle), "link")
    leg.meets(point)


def _planar_five_bar(leg: Leg) -> None:
    half = Exact(1) / 2
    distal = _flat(leg.theta[0] + leg.passive[0])
    leg.found.equal(leg.link, distal, "link")
    crank = scaled(leg.g["l_4"], _flat(leg.theta[0]))
    leg.meets(plus(_foot(leg, -half), plus(crank, scaled(leg.g["l_6"], distal))))
    ratio = 1 - leg.g["l_5"] / leg.g["l_6"] if "l_5" in leg.g else Exact(1)
    apart = scaled(leg.g["l_0"], thesis.quarter(_radial(leg)))
    _five_bar_loop(leg, leg.theta[0], leg.theta[1], apart, ratio)


def _pair(leg: Leg, links: list[Vector], meeting: Any) -> None:
    """The first link's direction, and the angle from the first to the second."""
    leg.found.equal(leg.link, links[0], "link")
    turned = plus(scaled(meeting.cos(), links[0]), scaled(meeting.sin(), thesis.quarter(links[0])))
    leg.found.equal(turned, links[1], "meeting")


def _planar_prr2(leg: Leg) -> None:
    links = []
    for k, share in ((1, Exact(-1) / 2), (2, Exact(1) / 2)):
        e, hinge = _slide(leg, f"slide_{k}"), leg.passive[k - 1]
        link = plus(scaled(hinge.cos(), e), scaled(hinge.sin(), thesis.quarter(e)))
        slider = plus(_foot(leg, share), scaled(leg.theta[k - 1], e))
        leg.meets(plus(slider, scaled(leg.g[f"l_{k}"], link)))
        links.append(link)
    _pair(leg, links, leg.passive[2])


def _planar_rpr2(leg: Leg) -> None:
    links = []
    for k, share in ((1, Exact(-1) / 2), (2, Exact(1) / 2)):
        link = _flat(leg.g["azimuth"] + leg.passive[k - 1])
        leg.meets(plus(_foot(leg, share), scaled(leg.theta[k - 1], link)))
        links.append(link)
    _pair(leg, links, leg.passive[2])


PASSIVE: dict[str, Callable[[Leg], None]] = {
    "subleg_rrr": _serial(slides=False),
    "subleg_r_fivebar": _hybrid(slides=False),
    "subleg_prr": _serial(slides=True),
    "subleg_prr_parallel": _serial(slides=True),
    "subleg_rrrr": _rrrr,
    "subleg_p_fivebar": _hybrid(slides=True),
    "subleg_cpr3": _cpr3,
    "subleg_tripteron": _tripteron,
    "subleg_upu3": _upu3,
    "subleg_ups3": _ups3,
    "subleg_delta": _delta,
    "subleg_planar_rr": _planar_rr,
    "subleg_planar_pr": _planar_pr,
    "subleg_planar_rp": _planar_rp,
    "subleg_planar_pp": _planar_pp,
    "subleg_planar_fivebar": _planar_five_bar,
    "subleg_planar_fivebar_coupler": _planar_five_bar,
    "subleg_planar_prr2": _planar_prr2,
    "subleg_planar_rpr2": _planar_rpr2,
    "subleg_planar_rrr": _planar_rrr,
}
"""The chains of each sub-leg, written from its description alone."""

FOLDED: dict[str, Callable[[Leg], Any]] = {"subleg_tripteron": _tripteron_folded}
"""What tells where a passive joint of a sub-leg is undetermined."""
