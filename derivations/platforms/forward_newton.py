"""Newton-Raphson for arrangement (a), Section 3.2.2, with (3.5) and (3.6) solved beforehand.

Where S_1, S_2, S_3 span the platform's plane, its normal and the distance of O' from it are known.  What is
left of the nine equations (3.7) are the three lengths (3.4) in phi and a_1 = B_1 - S_1.  The state has phi
less that of the pose nearby, a_1, and cosine and sine of phi (they are those of the angle before the last
step, turned by it: right where the steps have converged).

The theorem of Newton and Kantorovich says when the steps from a pose nearby are certain to converge.  With
the slope F' at the start, b >= |F'^-1|, the first step's length n, and K >= |F''| as far as 2 n around it,
2 b K n <= 1 suffices; the solution is then the only one in that neighbourhood.  phi counts times the
platform's size, so that all unknowns are lengths.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import sympy as sp

from krhpr.codegen.kernel import Frame, Kernel, Port, Unit
from krhpr.codegen.writer import KernelWriter
from krhpr.derivations.platforms.forward import Plane, plane_of, write_modes
from krhpr.derivations.platforms.forward_revolute import (
    ANCHOR,
    AXES,
    LENGTH,
    POINTS,
    mode_at,
    newton_step,
)
from krhpr.derivations.platforms.kernels import all_legs
from krhpr.derivations.terms import Space
from krhpr.derivations.vectors import cross2, dependence, dot, turned

if TYPE_CHECKING:
    from krhpr.derivations.platforms.base import Platform

EQUATIONS = "3.2.2, (3.4) to (3.9)"

STATE = Port("state", (5,), Unit.MIXED, Frame.NONE, "phi - phi_0, a_1, cos(phi) and sin(phi)")
START = replace(STATE, name="start", doc=f"{STATE.doc} at the pose nearby")
CENTRE = Port("centre", (2,), Unit.NONE, Frame.NONE, "cosine and sine of phi_0, that of the pose nearby")
CHANGE = Port("change", (1,), Unit.NONE, Frame.NONE, "squared step, relative to the platform's size")
MISFIT = Port(
    "misfit",
    (1,),
    Unit.NONE,
    Frame.NONE,
    "squared misfit of the links' squared lengths, relative to those of the platform and the links",
)
KANTOROVICH = Port(
    "kantorovich",
    (),
    Unit.NONE,
    Frame.NONE,
    "2 b K n at the pose nearby: at most 1 where the steps are certain to converge",
)


def near_ports(space: Space) -> tuple[Port, Port]:
    """The pose that steps begin at: position, and orientation as Q."""
    d = space.dimension
    return (
        Port("p_near", (d,), Unit.METRE, Frame.BASE, "position of O' nearby, the previous one on a path"),
        Port("Q_near", (d, d), Unit.NONE, Frame.BASE, "orientation nearby, the previous one on a path"),
    )


def newton_kernels(plate: Platform) -> tuple[Kernel, ...]:
    """Where steps begin, one step, and the pose where they end."""
    return _start(plate), _step(), _pose(plate)


def _start(plate: Platform) -> Kernel:
    k = KernelWriter(
        "newton_start",
        "The pose nearby in the platform's plane, and whether steps from it are certain to converge.",
        EQUATIONS,
    )
    s, anchors, lengths = all_legs(k, plate.ports().s), all_legs(k, ANCHOR), all_legs(k, LENGTH)
    p_near, Q_near = near_ports(plate.space)
    p, Q = k.add_input(p_near), k.add_input(Q_near)
    d = [k.let(f"d_{i + 1}", anchors[i] - anchors[0]) for i in range(3)]
    plane = plane_of(k, plate.space, s, cross2(d[1], d[2]), sp.Integer(1))
    k.add_output(POINTS, [entry for point in plane.points for entry in point])
    if plane.axes is None or plane.span is None:
        cosine, sine = Q[0, 0], Q[1, 0]
        a_1 = k.let("a_1", p + Q * anchors[0] - s[0])
    else:
        k.add_output(AXES, plane.axes)
        x, y = plane.axes.col(0), plane.axes.col(1)
        cosine, sine = plane.span.direction(k, Q.col(0))
        arm = k.let("arm", p + Q[:, :2] * anchors[0] - s[0], "S_1 to B_1")
        a_1 = k.let("a_1", sp.Matrix([dot(x, arm), dot(y, arm)]))
    k.add_output(CENTRE, [cosine, sine])
    k.add_output(START, [sp.Integer(0), *a_1, cosine, sine])
    k.add_output(KANTOROVICH, _kantorovich(k, cosine, sine, a_1, d, plane.points, lengths))
    return k.kernel()


def _kantorovich(
    k: KernelWriter,
    cosine: Any,
    sine: Any,
    a_1: sp.Matrix,
    d: Sequence[sp.Matrix],
    points: Sequence[sp.Matrix],
    lengths: Sequence[Any],
) -> Any:
    """2 b K n, with Frobenius norms for b and K.

    F_i = (|a_i|^2 - l_i^2) / 2 has the slope (g_i, a_i) in (phi, a_1) and the second derivatives
    -(a_i - R d_i)^T R d_i in phi, E R d_i, and 1.
    """
    rotated = [k.let(f"Rd_{i + 1}", turned(cosine, sine, v)) for i, v in enumerate(d)]
    a = [k.let(f"b_{i + 1}", a_1 + rotated[i] - points[i], "S_i to B_i") for i in range(3)]
    size2 = k.let("L_2", (dot(d[1], d[1]) + dot(d[2], d[2])) / 2, "the platform's size, squared")
    size = k.let("L", sp.sqrt(size2))
    F = [k.let(f"F_{i + 1}", (dot(v, v) - l**2) / 2) for i, (v, l) in enumerate(zip(a, lengths, strict=True))]
    g = [k.let(f"G_{i + 1}", cross2(rotated[i], v) / size) for i, v in enumerate(a)]
    weights = [k.let(f"mu_{i + 1}", w) for i, w in enumerate(dependence(a))]
    determinant = k.let("det", sum(w * x for w, x in zip(weights, g, strict=True)))
    # the inverse of the rows (g_i, a_i), column by column, times the determinant
    columns = []
    for i in range(3):
        m, n = (i + 1) % 3, (i + 2) % 3
        columns.append(
            k.let(
                f"inv_{i + 1}",
                sp.Matrix(
                    [
                        weights[i],
                        g[n] * a[m][1] - g[m] * a[n][1],
                        g[m] * a[n][0] - g[n] * a[m][0],
                    ]
                ),
            )
        )
    inverse = k.let("b_2", sum(dot(column, column) for column in columns) / determinant**2, "b squared")
    step = sum((columns[i] * F[i] for i in range(3)), sp.zeros(3, 1))
    length = k.let("step", sp.sqrt(dot(step, step) / determinant**2), "n")
    curvature = sp.Integer(0)
    for i in range(3):
        reach = k.let(f"q_{i + 1}", sp.sqrt(dot(d[i], d[i])), "|d_i|")
        # |a_i - R d_i| grows by no more than 2 n in the neighbourhood
        arm = k.let(f"o_{i + 1}", a[i] - rotated[i])
        bent = k.let(f"bent_{i + 1}", (sp.sqrt(dot(arm, arm)) + 2 * length) * reach / size2)
        curvature += bent**2 + 2 * reach**2 / size2 + 2
    return 2 * sp.sqrt(inverse * curvature) * length


def _step() -> Kernel:
    k = KernelWriter("newton_step", "One Newton step of the links' lengths.", EQUATIONS)
    state, centre = k.add_input(STATE), k.add_input(CENTRE)
    anchors, lengths = all_legs(k, ANCHOR), all_legs(k, LENGTH)
    points = _points(k)
    d = [k.let(f"d_{i + 1}", anchors[i] - anchors[0]) for i in range(3)]
    cosine, sine = turned(sp.cos(state[0]), sp.sin(state[0]), centre)
    cosine, sine, a_1 = k.let("cos", cosine), k.let("sin", sine), state[1:3, 0]
    cosine, sine, turn, move = newton_step(k, "_on", cosine, sine, a_1, d, points, lengths)
    k.add_output(STATE.one_step_on(), [state[0] + turn, *(a_1 + move), cosine, sine])
    size = k.let("size", dot(d[1], d[1]) + dot(d[2], d[2]))
    k.add_output(CHANGE, [turn**2 + dot(move, move) / size])
    return k.kernel()


def _points(k: KernelWriter) -> tuple[sp.Matrix, ...]:
    whole = k.add_input(POINTS)
    return tuple(whole.row(i).T for i in range(3))


def _pose(plate: Platform) -> Kernel:
    k = KernelWriter("newton_pose", "The pose where the steps end.", EQUATIONS)
    s = all_legs(k, plate.ports().s)
    state, anchors, lengths = k.add_input(STATE), all_legs(k, ANCHOR), all_legs(k, LENGTH)
    points = _points(k)
    axes = k.add_input(AXES) if plate.space is Space.SPATIAL else None
    plane = Plane(plate.space, s[0], axes, points)
    mode = mode_at(k, plate.space, state[3], state[4], state[1:3, 0], anchors, points)
    write_modes(k, plane, [mode], plate.ports().redundant, several=False)
    # steps from far away end where rounding takes the slope away, short as they are: not a pose
    d = [k.let(f"d_{i + 1}", anchors[i] - anchors[0]) for i in (1, 2)]
    misfits = [
        k.let(f"f_{i + 1}", dot(v, v) - l**2)
        for i, (v, l) in enumerate(zip(mode.links, lengths, strict=True))
    ]
    size2 = k.let("size2", sum(dot(v, v) for v in d) + sum(l**2 for l in lengths))
    k.add_output(MISFIT, [sum(f**2 for f in misfits) / size2**2])
    return k.kernel()
