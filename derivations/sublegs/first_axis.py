"""The part that the spatial sub-legs with a first revolute axis share: base joint, first axis and linkage plane.

Leg frame (e_x, e_1, e_t), right-handed: e_1 = -cos(alpha) e_r + sin(alpha) e_z is the first axis, with alpha measured from
the ray base joint -> O; e_t is tangential; e_x = e_1 x e_t.  Link i1 lies along the axis, c = R_b e_r + l_1 e_1.
Turned by theta_1: x = Rot(e_1, theta_1) e_x, e_2 = Rot(e_1, theta_1) e_t.  A vector of length L at angle t in the linkage
plane is L (x cos t + e_1 sin t), and e_2 x x = e_1, e_2 x e_1 = -x, e_1 x e_2 = x.
"""

from __future__ import annotations

from typing import Any

import sympy as sp

from krhpr.codegen.kernel import Frame, GeometryField, GeometryType, Unit
from krhpr.codegen.writer import KernelWriter
from krhpr.derivations.sublegs.base import Factor, Sign
from krhpr.derivations.vectors import cross, dot

AXIS_FIELDS = (
    GeometryField("azimuth", Unit.RADIAN, "azimuth of the leg on the base"),
    GeometryField("R_b", Unit.METRE, "circumradius of the base", positive=True),
    GeometryField("alpha", Unit.RADIAN, "first axis, from the ray base joint -> O; more than pi/2 leans outwards"),
    GeometryField("l_1", Unit.METRE, "link i1, along the first axis"),
)

SHOULDER = Sign("shoulder", "front", "back", "side of the first axis on which the linkage plane's x points to S_i")


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


def plane_coordinates(k: KernelWriter, s: sp.Matrix, x: sp.Matrix) -> tuple[Any, Any]:
    """Coordinates (r, y) of S_i in the linkage plane: s - c = r x + y e_1."""
    d = k.let("d", s - k.g.c, "s - c")
    return k.let("r", dot(d, x)), k.let("y", dot(d, k.g.e_1))


def shoulder(k: KernelWriter, s: sp.Matrix, sign: Any) -> tuple[Any, Any, Any]:
    """theta_1 and the coordinates (r, y) of S_i in the linkage plane, r having the sign given.

    On the first axis (r = 0) every theta_1 serves; atan2(0, 0) = 0 is returned, and the leg is singular there.
    """
    d = k.let("d", s - k.g.c, "s - c")
    along_x, along_t = k.let("d_x", dot(d, k.g.e_x)), k.let("d_t", dot(d, k.g.e_t))
    y = k.let("y", dot(d, k.g.e_1))
    r = k.let("r", sign * sp.sqrt(along_x**2 + along_t**2))
    theta_1 = k.atan2(-sign * along_t, sign * along_x)
    return theta_1, r, y


def place(k: KernelWriter, theta_1: Any, r: Any, y: Any) -> sp.Matrix:
    """The point c + r x + y e_1."""
    x = k.let("x", sp.cos(theta_1) * k.g.e_x - sp.sin(theta_1) * k.g.e_t, "Rot(e_1, theta_1) e_x")
    return k.g.c + r * x + y * k.g.e_1


def shoulder_factor(r: Any, longest: Any) -> Factor:
    return Factor("shoulder", r / longest, "S_i on the first axis")
