"""The part that the spatial sub-legs with a first revolute axis share: base joint, first axis and linkage
plane.

Leg frame (e_x, e_1, e_t), right-handed: e_1 = -cos(alpha) e_r + sin(alpha) e_z is the first axis, with alpha
measured from the ray base joint -> O; e_t is tangential; e_x = e_1 x e_t.  Link i1 lies along the axis, c =
R_b e_r + l_1 e_1. Turned by theta_1: x = Rot(e_1, theta_1) e_x, e_2 = Rot(e_1, theta_1) e_t.  A vector of
length L at angle t in the linkage plane is L (x cos t + e_1 sin t), and e_2 x x = e_1, e_2 x e_1 = -x, e_1 x
e_2 = x.
"""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import sympy as sp

from krhpr.codegen.kernel import Frame, GeometryField, GeometryType, Layout, Port, Unit
from krhpr.codegen.writer import KernelWriter
from krhpr.derivations.terms import Factor, Sign
from krhpr.derivations.vectors import cross, dot

AXIS_FIELDS = (
    GeometryField("azimuth", Unit.RADIAN, "azimuth of the leg on the base"),
    GeometryField("R_b", Unit.METRE, "circumradius of the base", positive=True),
    GeometryField(
        "alpha", Unit.RADIAN, "first axis, from the ray base joint -> O; more than pi/2 leans outwards"
    ),
    GeometryField("l_1", Unit.METRE, "link i1, along the first axis"),
)

FRAME_PORTS = (
    Port("x", (3,), Unit.NONE, Frame.BASE, "Rot(e_1, theta_1) e_x", Layout.STACKED),
    Port("e_2", (3,), Unit.NONE, Frame.BASE, "Rot(e_1, theta_1) e_t", Layout.STACKED),
    Port("d", (2,), Unit.METRE, Frame.JOINT, "s - c in the linkage plane (x, e_1)", Layout.STACKED),
)
"""Posture of every sub-leg with a first axis."""

SHOULDER = Sign(
    "shoulder", "front", "back", "side of the first axis on which the linkage plane's x points to S_i"
)


def axis_geometry(name: str, doc: str, lengths: tuple[GeometryField, ...]) -> GeometryType:
    """Geometry of a sub-leg with a first axis: its fields, and c, e_x, e_1, e_t prepared."""
    fields = (*AXIS_FIELDS, *lengths)
    k = KernelWriter("prepare", "Vectors and sub-expressions that depend on the geometry alone.")
    symbols = {field.name: k.input(field.name, (), field.unit, doc=field.doc) for field in fields}
    azimuth, alpha = symbols["azimuth"], symbols["alpha"]
    e_r = k.let("e_r", sp.Matrix([sp.cos(azimuth), sp.sin(azimuth), 0]))
    e_t = k.let("e_t", sp.Matrix([-sp.sin(azimuth), sp.cos(azimuth), 0]))
    e_1 = k.let("e_1", -sp.cos(alpha) * e_r + sp.sin(alpha) * sp.Matrix([0, 0, 1]))
    k.output("c", symbols["R_b"] * e_r + symbols["l_1"] * e_1, Unit.METRE, Frame.BASE, "end of link i1")
    k.output("e_x", cross(e_1, e_t), Unit.NONE, Frame.BASE, "e_1 x e_t")
    k.output("e_1", e_1, Unit.NONE, Frame.BASE, "first axis")
    k.output("e_t", e_t, Unit.NONE, Frame.BASE, "tangential direction, e_2 at theta_1 = 0")
    return GeometryType(name, doc, fields, k.kernel())


def linkage_frame(k: KernelWriter, theta_1: Any) -> tuple[sp.Matrix, sp.Matrix]:
    """x and e_2 at theta_1, in the base frame."""
    cosine, sine = k.let("cos_1", sp.cos(theta_1)), k.let("sin_1", sp.sin(theta_1))
    x = k.let("x", cosine * k.g.e_x - sine * k.g.e_t, "Rot(e_1, theta_1) e_x")
    e_2 = k.let("e_2", cosine * k.g.e_t + sine * k.g.e_x, "Rot(e_1, theta_1) e_t")
    return x, e_2


def plane_coordinates(k: KernelWriter, s: sp.Matrix, x: sp.Matrix) -> sp.Matrix:
    """Coordinates d = (r, y) of S_i in the linkage plane: s - c = r x + y e_1."""
    arm = k.let("arm", s - k.g.c, "s - c")
    return k.let("d", sp.Matrix([dot(arm, x), dot(arm, k.g.e_1)]), "s - c in the plane (x, e_1)")


def in_plane(angle: Any) -> sp.Matrix:
    """The direction at an angle in the linkage plane (x, e_1)."""
    return sp.Matrix([sp.cos(angle), sp.sin(angle)])


def shoulder(k: KernelWriter, s: sp.Matrix, sign: Any) -> tuple[Any, Any, Any]:
    """theta_1 and the coordinates (r, y) of S_i in the linkage plane, r having the sign given.

    On the first axis (r = 0) every theta_1 serves; atan2(0, 0) = 0 is returned, and the leg is singular
    there.
    """
    d = k.let("d", s - k.g.c, "s - c")
    along_x, along_t = k.let("d_x", dot(d, k.g.e_x)), k.let("d_t", dot(d, k.g.e_t))
    y = k.let("y", dot(d, k.g.e_1))
    r = k.let("r", sign * sp.sqrt(along_x**2 + along_t**2))
    theta_1 = k.atan2(-sign * along_t, sign * along_x)
    return theta_1, r, y


def place(k: KernelWriter, x: sp.Matrix, r: Any, y: Any) -> sp.Matrix:
    """The point c + r x + y e_1."""
    return k.g.c + r * x + y * k.g.e_1


def shoulder_points(k: KernelWriter) -> dict[str, sp.Matrix]:
    """Base joint A and the end c of link i1."""
    return {"A": k.g.c - k.g.l_1 * k.g.e_1, "c": k.g.c}


def in_base(k: KernelWriter, at: SimpleNamespace, point: sp.Matrix) -> sp.Matrix:
    """The point with coordinates `point` in the linkage plane (x, e_1), from c, in the base frame."""
    return place(k, at.x, point[0], point[1])


def link_frame(k: KernelWriter, at: SimpleNamespace, direction: sp.Matrix) -> sp.Matrix:
    """Orientation of a link in the linkage plane: along it, e_2 x along, e_2."""
    u = k.let("dir", direction, "direction of the link in (x, e_1)")
    along = k.let("along", u[0] * at.x + u[1] * k.g.e_1)
    across = k.let("across", u[0] * k.g.e_1 - u[1] * at.x, "e_2 x along")
    return sp.Matrix.hstack(along, across, at.e_2)


def shoulder_factor(r: Any, longest: Any) -> Factor:
    """The factor of det M_i that vanishes where S_i meets the first axis."""
    return Factor("shoulder", r / longest, "S_i on the first axis")
