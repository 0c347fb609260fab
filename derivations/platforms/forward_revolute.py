"""Forward kinematics of arrangement (a), in space and in the plane: the sextic of Section 3.2.1.

With a_i from S_i to B_i in the platform's plane, a_k = a_1 + z_k and z_k = R(phi) d_k - r_k, where
d_k = b_k - b_1 and r_k = s_k - s_1.  Subtracting |a_1| = l_1 from |a_k| = l_k leaves 2 z_k . a_1 = e_k,
linear in a_1, with e_k = l_k^2 - l_1^2 - |z_k|^2.  Hence 2 D a_1 = e_3 E z_2 - e_2 E z_3 with
D = z_2 x z_3, and

    |e_2 z_3 - e_3 z_2|^2 = 4 l_1^2 D^2.

|z_k|^2, z_2 . z_3 and D are linear in cos(phi) and sin(phi), so that this is a sextic in T = tan(phi / 2),
for any platform and any lengths.  Where D is zero at a root, e_2 z_3 = e_3 z_2 too, and both sides have a
double zero there.  So every simple root is a solution, and what the elimination adds are multiple roots.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import radians
from typing import TYPE_CHECKING, Any

import sympy as sp

from krhpr.codegen.kernel import Frame, Kernel, Port, Unit
from krhpr.codegen.writer import KernelWriter
from krhpr.derivations.platforms.forward import (
    BOX,
    TURNED,
    Mode,
    Plane,
    forward_ports,
    plane_of,
    stacked,
    write_modes,
)
from krhpr.derivations.platforms.kernels import all_legs
from krhpr.derivations.polynomials import linear, product
from krhpr.derivations.roots import cosine_and_sine, miss_port, root_port, write_miss
from krhpr.derivations.terms import Space
from krhpr.derivations.vectors import E, concurrence, cross2, dependence, dot, lines_meet, turned

if TYPE_CHECKING:
    from krhpr.derivations.platforms.base import Platform

EQUATIONS = "3.2.1, (3.1) to (3.4)"

DEGREE = 6
ANCHOR = stacked("anchor", (2,), Unit.METRE, "b_i, the joint on the platform")
LENGTH = stacked("length", (), Unit.METRE, "l_i, the redundant link")
SEXTIC = Port(
    "sextic",
    (DEGREE + 1,),
    Unit.MIXED,
    Frame.NONE,
    "coefficients in T = tan(phi / 2), the constant one first",
)
POINTS = Port("points", (3, 2), Unit.METRE, Frame.NONE, "S_i in the intermediate frame, from S_1")
AXES = Port("axes", (3, 3), Unit.NONE, Frame.BASE, "intermediate frame [x_1, y_1, z_1]")
ROOT = root_port("sextic")
MISS = miss_port("the links' lengths")
CERTIFICATE = Port(
    "certificate", (14,), Unit.MIXED, Frame.NONE, "at least zero where a box holds one solution"
)
ALIKE = sp.Rational(1, 10**9)
"""Lengths that differ by less, relatively, are equal: manufacturing is coarser by far."""
LEAST, LARGEST = (sp.Rational(repr(radians(degrees))) for degrees in (30, 150))
"""The box in which the theorem holds."""
STEPS = 2
"""Newton steps behind each root: one takes away what the elimination loses, one is for safety."""


def forward_kernels(plate: Platform) -> tuple[Kernel, ...]:
    """Kernels of the forward kinematics: what a leg contributes, the sextic, the pose at one of its roots."""
    return _tie(plate), _sextic(plate), _assembly(plate), _uniqueness()


def _tie(plate: Platform) -> Kernel:
    k = KernelWriter(
        "tie", "How the leg holds the platform, for the forward kinematics.", "", plate.geometry()
    )
    k.add_output(ANCHOR, k.g.b)
    k.add_output(LENGTH, k.g.l_r)
    return k.kernel()


def _sextic(plate: Platform) -> Kernel:
    k = KernelWriter("sextic", "The sextic in tan(phi / 2) that holds the three end points.", EQUATIONS)
    s, anchors, lengths = all_legs(k, plate.ports().s), all_legs(k, ANCHOR), all_legs(k, LENGTH)
    family = k.add_input(TURNED) if plate.space is Space.SPATIAL else sp.Integer(1)
    d = [k.let(f"d_{i + 1}", anchors[i] - anchors[0]) for i in (1, 2)]
    plane = plane_of(k, plate.space, s, cross2(*d), family)
    r = plane.points[1:]
    k.add_output(POINTS, [entry for point in plane.points for entry in point])
    if plane.axes is not None:
        k.add_output(AXES, plane.axes)
    along = [[k.let(f"c_{i}{j}", dot(d[i - 2], r[j - 2])) for j in (2, 3)] for i in (2, 3)]
    across = [[k.let(f"s_{i}{j}", cross2(d[i - 2], r[j - 2])) for j in (2, 3)] for i in (2, 3)]

    def name(text: str, form: list[Any]) -> list[Any]:
        return [k.let(f"{text}_{j}", value) for j, value in enumerate(form)]

    # r . R d = (d . r) cos + (d x r) sin,  (R d) x r = (d x r) cos - (d . r) sin
    squares = [
        name(
            f"z{i + 2}",
            linear(dot(d[i], d[i]) + dot(r[i], r[i]), -2 * along[i][i], -2 * across[i][i]),
        )
        for i in (0, 1)
    ]
    one = [sp.Integer(1), sp.Integer(0), sp.Integer(1)]
    gaps = [
        name(
            f"e{i + 2}",
            [(lengths[i + 1] ** 2 - lengths[0] ** 2) * n - z for n, z in zip(one, squares[i], strict=True)],
        )
        for i in (0, 1)
    ]
    inner = name(
        "w",
        linear(dot(d[0], d[1]) + dot(r[0], r[1]), -along[0][1] - along[1][0], -across[0][1] - across[1][0]),
    )
    outer = name(
        "D",
        linear(
            cross2(d[0], d[1]) + cross2(r[0], r[1]), across[1][0] - across[0][1], along[0][1] - along[1][0]
        ),
    )
    e22, e33 = name("e22", product(gaps[0], gaps[0])), name("e33", product(gaps[1], gaps[1]))
    e23, dd = name("e23", product(gaps[0], gaps[1])), name("DD", product(outer, outer))
    terms = (product(e22, squares[1]), product(e33, squares[0]), product(e23, inner), product(dd, one))
    k.add_output(SEXTIC, [a + b - 2 * c - 4 * lengths[0] ** 2 * e for a, b, c, e in zip(*terms, strict=True)])
    return k.kernel()


def _assembly(plate: Platform) -> Kernel:
    k = KernelWriter("assembly", "The pose at one root of the sextic.", EQUATIONS)
    root = k.add_input(ROOT)
    s, anchors, lengths = all_legs(k, plate.ports().s), all_legs(k, ANCHOR), all_legs(k, LENGTH)
    whole = k.add_input(POINTS)
    points = tuple(whole.row(i).T for i in range(3))
    axes = k.add_input(AXES) if plate.space is Space.SPATIAL else None
    plane = Plane(plate.space, s[0], axes, points)
    d = [k.let(f"d_{i + 1}", anchors[i] - anchors[0]) for i in range(3)]
    cosine, sine = cosine_and_sine(k, root, "_0")
    z = [k.let(f"z_{i + 1}", turned(cosine, sine, d[i]) - points[i]) for i in (1, 2)]
    e = [k.let(f"e_{i + 2}", lengths[i + 1] ** 2 - lengths[0] ** 2 - dot(z[i], z[i])) for i in (0, 1)]
    a_1 = k.let("a_1_0", (e[1] * (E * z[0]) - e[0] * (E * z[1])) / (2 * cross2(z[0], z[1])))
    for step in range(1, STEPS + 1):
        cosine, sine, _, move = newton_step(k, f"_{step}", cosine, sine, a_1, d, points, lengths)
        a_1 = k.let(f"a_1_{step}_on", a_1 + move)
    mode = mode_at(k, plate.space, cosine, sine, a_1, anchors, points)
    joint = plate.ports().redundant
    write_modes(k, plane, [mode], joint, several=False)
    k.add_output(forward_ports(plate.space, joint, 0).det_J, mode.det_J)
    misses = [dot(v, v) - length**2 for v, length in zip(mode.links, lengths, strict=True)]
    write_miss(k, MISS, misses, sum(length**2 for length in lengths))
    return k.kernel()


@dataclass(frozen=True)
class RevoluteMode(Mode):
    """A mode with its redundant links."""

    links: tuple[sp.Matrix, ...]
    """a_i, from S_i to B_i in the plane."""


def mode_at(
    k: KernelWriter,
    space: Space,
    cosine: Any,
    sine: Any,
    a_1: sp.Matrix,
    anchors: Sequence[sp.Matrix],
    points: Sequence[sp.Matrix],
) -> RevoluteMode:
    """What follows from phi and a_1 = B_1 - S_1."""
    rotated = [
        k.let(f"Rd_{i + 1}", turned(cosine, sine, anchor - anchors[0])) for i, anchor in enumerate(anchors)
    ]
    a = [k.let(f"a_{i + 1}", a_1 + rotated[i] - points[i], "S_i to B_i") for i in range(3)]
    position = k.let("p_l", a_1 - turned(cosine, sine, anchors[0]))
    local = [k.let(f"u_{i + 1}", turned(cosine, -sine, a[i]), "in the platform frame") for i in range(3)]
    beta = [
        k.atan2(u[0] * b[1] - u[1] * b[0], u[0] * b[0] + u[1] * b[1])
        for u, b in zip(local, anchors, strict=True)
    ]
    det_j = concurrence(dependence(local), local, anchors)
    if space is Space.SPATIAL:
        det_j = det_j * cross2(points[1], points[2])
    return RevoluteMode(cosine, sine, position, tuple(beta), det_j, tuple(a))


def _uniqueness() -> Kernel:
    """Where the theorem of errata 4 holds: |S_i S_j|^2 as functions of the redundant angles have a Jacobian
    whose principal minors are positive in the open box (30, 150) deg, so that they are one to one
    (Gale-Nikaido); the end points are congruent for no two poses with their angles in it.
    """
    k = KernelWriter(
        "uniqueness",
        "Where a box holds one solution: margins that are all at least zero there.",
        "errata 4, (1.35)",
    )
    anchors, lengths = all_legs(k, ANCHOR), all_legs(k, LENGTH)
    bounds = all_legs(k, BOX)
    radii = [k.let(f"R_{i + 1}", dot(b, b)) for i, b in enumerate(anchors)]
    sides = [anchors[1] - anchors[0], anchors[2] - anchors[1], anchors[0] - anchors[2]]
    squares = [k.let(f"side_{i + 1}", dot(side, side)) for i, side in enumerate(sides)]
    alike = [
        (radii[1], radii[0]),
        (radii[2], radii[0]),
        (squares[1], squares[0]),
        (squares[2], squares[0]),
        (lengths[1], lengths[0]),
        (lengths[2], lengths[0]),
    ]
    margins = [ALIKE**2 - (a / b - 1) ** 2 for a, b in alike]
    margins.append(cross2(sides[0], sides[1]))  # the legs go round counterclockwise
    margins.append(sp.Rational(9, 16) * radii[0] * (1 - ALIKE) - lengths[0] ** 2)  # l < 3 R / 4
    for bound in bounds:
        margins += [bound[0] - LEAST, LARGEST - bound[1]]
    k.add_output(CERTIFICATE, margins)
    return k.kernel()


def newton_step(
    k: KernelWriter,
    at: str,
    cosine: Any,
    sine: Any,
    a_1: sp.Matrix,
    d: Sequence[sp.Matrix],
    points: Sequence[sp.Matrix],
    lengths: Sequence[Any],
) -> tuple[Any, Any, Any, sp.Matrix]:
    """One Newton step of |a_i| = l_i in phi and a_1: cosine and sine after it, and by how much phi and a_1
    change.  With sum lambda_i a_i = 0 the equations lose a_1.  `at` ends the names of what is computed.
    """
    rotated = [turned(cosine, sine, v) for v in d]
    a = [k.let(f"a_{i + 1}{at}", a_1 + rotated[i] - points[i]) for i in range(3)]
    f = [
        k.let(f"f_{i + 1}{at}", (dot(v, v) - length**2) / 2)
        for i, (v, length) in enumerate(zip(a, lengths, strict=True))
    ]
    slope = [k.let(f"g_{i + 1}{at}", cross2(rotated[i], a[i])) for i in range(3)]
    weights = [k.let(f"lambda_{i + 1}{at}", w) for i, w in enumerate(dependence(a))]
    turn = k.let(
        f"turn{at}",
        -sum(w * v for w, v in zip(weights, f, strict=True))
        / sum(w * v for w, v in zip(weights, slope, strict=True)),
    )
    right = [-v - turn * g for v, g in zip(f, slope, strict=True)]
    move = k.let(f"move{at}", lines_meet(a, right, weights))
    norm = k.inverse_root(f"norm{at}", 1 + turn**2)
    return (
        k.let(f"cos{at}", (cosine - sine * turn) * norm),
        k.let(f"sin{at}", (sine + cosine * turn) * norm),
        turn,
        move,
    )
