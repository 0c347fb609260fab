"""Forward kinematics of the platform: from the sub-legs' end points to every pose that holds them.

In space the end points S_1, S_2, S_3 span the platform's plane, so that the problem is planar in the
intermediate frame S_1 x_1 y_1 z_1 of (3.1) to (3.3); the platform turned over (normal opposite to z_1) is the
same problem seen from below.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import sympy as sp

from krhpr.codegen.kernel import Frame, Layout, Port, Unit
from krhpr.codegen.writer import KernelWriter
from krhpr.derivations.terms import Space
from krhpr.derivations.vectors import cross, dot

TURNED = Port(
    "turned",
    (),
    Unit.NONE,
    Frame.NONE,
    "+1 for the platform that sees S_1, S_2, S_3 go round z' in the order of its legs, -1 for the one "
    "turned over",
)
SIDE = Port(
    "side", (), Unit.NONE, Frame.NONE, "+1 for the side of type II where the first margin is positive, or -1"
)
BOX = Port(
    "box",
    (2,),
    Unit.RADIAN,
    Frame.JOINT,
    "the least and the largest redundant angle of the answer; an angle is given with the full turns that "
    "bring it there",
    Layout.STACKED,
)
CERTIFIED = Port(
    "certified",
    (),
    Unit.NONE,
    Frame.NONE,
    "1 where a theorem says that there is no other answer, 0 where it is the only one of `count`",
)
FLATNESS = Port(
    "flatness", (1,), Unit.NONE, Frame.NONE, "squared sine of the angle at S_1 in the triangle S_1 S_2 S_3"
)

SIGN = Port("sign", (1,), Unit.NONE, Frame.NONE, "1 where `side` or `turned` is +1 or -1, 0 where it is 0")


def unit_sign(k: KernelWriter, given: Any) -> Any:
    """The square of a sign that is given, by whose root it is divided; the output `sign` says what it is."""
    square = k.let(f"{given}_2", given**2)  # by itself, or its root would be an absolute value
    k.add_output(SIGN, [1 - (square - 1) ** 2])
    return square


@dataclass(frozen=True)
class Span:
    """What spans the platform's plane: S_2 - S_1 along x_1, and s_n x (S_2 - S_1) along y_1 or against it.

    Directions seen in it wait for no root but their own.
    """

    ahead: sp.Matrix
    across: sp.Matrix
    sense: Any
    root: Any
    """|s_n| |sense|"""

    def direction(self, k: KernelWriter, v: sp.Matrix) -> tuple[Any, Any]:
        """Cosine and sine of the angle from x_1 to a vector's part in the plane."""
        along, aside = k.let("c", dot(self.ahead, v)), k.let("s", self.sense * dot(self.across, v))
        norm = k.inverse_root("norm", along**2 * self.root**2 + aside**2)
        return k.let("cos", along * self.root * norm), k.let("sin", aside * norm)


@dataclass(frozen=True)
class Plane:
    """The end points in the platform's plane, seen from S_1, and the way back."""

    space: Space
    origin: sp.Matrix
    axes: sp.Matrix | None
    """[x_1, y_1, z_1], (3.3); none in the plane, where the base frame serves."""
    points: tuple[sp.Matrix, ...]
    """r_i from S_1."""
    span: Span | None = None
    """What made the axes, where they are made here."""

    def position(self, local: sp.Matrix) -> sp.Matrix:
        """A point of the plane in the base frame."""
        if self.axes is None:
            return self.origin + local
        return self.origin + self.axes[:, :2] * local

    def orientation(self, cosine: Any, sine: Any) -> sp.Matrix:
        """Q of a platform turned by phi in the plane, (3.21)."""
        assert self.axes is not None
        x, y, z = (self.axes.col(j) for j in range(3))
        return sp.Matrix.hstack(cosine * x + sine * y, cosine * y - sine * x, z)


def plane_of(k: KernelWriter, space: Space, s: Sequence[sp.Matrix], order: Any, turned: Any) -> Plane:
    """The intermediate frame at S_1 and the end points in it, (3.1) to (3.3).

    z_1 is along (S_2 - S_1) x (S_3 - S_1) where `order` is positive, the legs going round z', and the other
    way where it is negative.
    """
    s_12, s_13 = k.let("s_12", s[1] - s[0], "S_1 to S_2"), k.let("s_13", s[2] - s[0], "S_1 to S_3")
    zero = sp.zeros(2, 1)
    if space is Space.PLANAR:
        return Plane(space, s[0], None, (zero, s_12, s_13))
    normal = k.let("s_n", cross(s_12, s_13))
    across = k.let("y_n", cross(normal, s_12), "along y_1 or against it")
    square, area = k.let("s_12_2", dot(s_12, s_12)), k.let("s_n_2", dot(normal, normal))
    sense = k.let("sense", order * turned, "positive where the legs go round z_1")
    weight = k.let("sense_2", order**2 * (unit_sign(k, turned) if turned.is_Symbol else turned))
    weighted = k.let("s_n_w", weight * area)
    # not a number where the legs have no order, so that the guard fails
    k.add_output(FLATNESS, [weighted / (weight * (square * dot(s_13, s_13)))])
    edge, root = k.signed_root("v_1", 1, square, "|s_12|"), k.signed_root("v_n", 1, weighted)
    one_edge = k.let("w_1", 1 / edge)
    one_normal = k.let("w_n", sense / root, "1 / |s_n|, negative where the legs go the other way")
    x, z = k.let("x_1", s_12 * one_edge, "(3.1)"), k.let("z_1", normal * one_normal, "(3.2)")
    # factor by factor: where S_1 and S_2 all but coincide, the product of both reciprocals would overflow
    y = k.let("y_1", k.let("y_e", across * one_edge) * one_normal)
    r_3 = k.let("r_3", one_edge * sp.Matrix([dot(s_12, s_13), k.let("h_3", area * one_normal)]))
    points = (zero, sp.Matrix([edge, 0]), r_3)
    return Plane(space, s[0], sp.Matrix.hstack(x, y, z), points, Span(s_12, across, sense, root))


@dataclass(frozen=True)
class Hold:
    """What encoders at the first legs tell of the platform."""

    order: Any
    """Positive where the legs go round z'."""
    ends: tuple[sp.Matrix, ...]
    """d_i of the legs with encoders, from O' in the platform frame."""
    anchors: tuple[sp.Matrix, ...] = ()
    """b_i of all legs, where redundant links turn about them."""
    lengths: tuple[Any, ...] = ()
    """Their lengths."""


@dataclass(frozen=True)
class Mode:
    """One way to assemble the platform: its place in the plane and what follows from it."""

    cosine: Any
    sine: Any
    position: sp.Matrix
    redundant: tuple[Any, ...]
    det_J: Any


def write_modes(k: KernelWriter, plane: Plane, modes: Sequence[Mode], joint: Port, *, several: bool) -> None:
    """The outputs of a kernel that gives assembly modes: one, or several along a first axis."""
    ports = forward_ports(plane.space, joint, len(modes) if several else 0)
    k.add_output(ports.p, [entry for mode in modes for entry in plane.position(mode.position)])
    if plane.axes is None:
        k.add_output(ports.orientation, [k.atan2(mode.sine, mode.cosine) for mode in modes])
    else:
        k.add_output(
            ports.orientation,
            [entry for mode in modes for entry in plane.orientation(mode.cosine, mode.sine)],
        )
    k.add_output(ports.redundant, [entry for mode in modes for entry in mode.redundant])
    if several:
        k.add_output(ports.det_J, [mode.det_J for mode in modes])
        k.add_output(ports.count, sp.Integer(len(modes)))


@dataclass(frozen=True)
class ForwardPorts:
    """Results of the forward kinematics."""

    p: Port
    orientation: Port
    redundant: Port
    det_J: Port
    count: Port


def forward_ports(space: Space, joint: Port, modes: int) -> ForwardPorts:
    """Ports of `modes` solutions along a first axis, or of one without it (0)."""
    first = (modes,) if modes else ()
    each = ", NaN behind the last" if modes else ""
    d = space.dimension
    if space is Space.PLANAR:
        turn = Port("phi", first, Unit.RADIAN, Frame.BASE, f"orientation, base from platform{each}")
    else:
        turn = Port("Q", (*first, 3, 3), Unit.NONE, Frame.BASE, f"orientation, base from platform{each}")
    return ForwardPorts(
        Port("p", (*first, d), Unit.METRE, Frame.BASE, f"position of O'{each}"),
        turn,
        Port("redundant", (*first, 3), joint.unit, Frame.JOINT, f"{joint.doc}{each}"),
        Port("det_J", first, Unit.MIXED, Frame.PLATFORM, "det J of each, whose sign tells them apart"),
        Port("count", (), Unit.NONE, Frame.NONE, "number of solutions"),
    )


def stacked(name: str, shape: tuple[int, ...], unit: Unit, doc: str) -> Port:
    """A leg's value in the platform frame."""
    return Port(name, shape, unit, Frame.PLATFORM, doc, Layout.STACKED)
