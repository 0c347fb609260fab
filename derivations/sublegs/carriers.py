"""What carries a sub-leg's linkage plane: a first axis about which it turns, or a slide along which it moves.

Leg frame (e_x, e_1, e_t), right-handed: e_1 = -cos(alpha) e_r + sin(alpha) e_z is the first axis, with alpha
measured from the ray base joint -> O; e_t is tangential; e_x = e_1 x e_t.  Link i1 lies along the axis, c =
R_b e_r + l_1 e_1.  The linkage plane is spanned by x and e_1 and has the normal e_2; a vector of length L at
angle t in it is L (x cos t + e_1 sin t), and e_2 x x = e_1, e_2 x e_1 = -x, e_1 x e_2 = x.

* On a first axis, x = Rot(e_1, theta_1) e_x and e_2 = Rot(e_1, theta_1) e_t, and the plane passes through c.
* On a slide, x = e_x and e_2 = e_t are fixed, and the plane passes through c + theta_1 e_t.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from types import SimpleNamespace
from typing import Any

import sympy as sp

from krhpr.codegen.kernel import Frame, GeometryField, GeometryType, Layout, Port, Unit
from krhpr.codegen.writer import KernelWriter
from krhpr.derivations.terms import Factor, Joint, JointKind, Link, LinkKind, Sign
from krhpr.derivations.vectors import cross, dot

E_Z = sp.Matrix([0, 0, 1])

BASE_FIELDS = (
    GeometryField("azimuth", Unit.RADIAN, "azimuth of the leg on the base"),
    GeometryField("R_b", Unit.METRE, "circumradius of the base", positive=True),
    GeometryField(
        "alpha", Unit.RADIAN, "first axis, from the ray base joint -> O; more than pi/2 leans outwards"
    ),
    GeometryField("l_1", Unit.METRE, "link i1, along the first axis"),
)
"""Where a spatial leg stands: what its leg frame and c follow from."""

PLANE_PORT = Port("d", (2,), Unit.METRE, Frame.JOINT, "S_i in the linkage plane (x, e_1)", Layout.STACKED)

SHOULDER = Sign(
    "shoulder", "front", "back", "side of the first axis on which the linkage plane's x points to S_i"
)


def radial(azimuth: Any) -> sp.Matrix:
    """e_r at an azimuth."""
    return sp.Matrix([sp.cos(azimuth), sp.sin(azimuth), 0])


def write_leg_frame(k: KernelWriter, symbols: dict[str, Any], e_r: sp.Matrix, e_t: sp.Matrix) -> None:
    """Outputs c, e_x, e_1, e_t of a geometry's `prepare`: e_1 leans in the plane of e_r and e_z, normal to
    e_t.
    """
    e_1 = k.let("e_1", -sp.cos(symbols["alpha"]) * e_r + sp.sin(symbols["alpha"]) * E_Z)
    base = symbols["R_b"] * k.let("e_b", radial(symbols["azimuth"]))
    k.output("c", base + symbols["l_1"] * e_1, Unit.METRE, Frame.BASE, "end of link i1")
    k.output("e_x", cross(e_1, e_t), Unit.NONE, Frame.BASE, "e_1 x e_t")
    k.output("e_1", e_1, Unit.NONE, Frame.BASE, "first axis")
    k.output("e_t", e_t, Unit.NONE, Frame.BASE, "tangential direction")


def begin_geometry(fields: tuple[GeometryField, ...]) -> tuple[KernelWriter, dict[str, Any]]:
    """The kernel `prepare` of a geometry, with its fields as inputs."""
    k = KernelWriter("prepare", "Vectors and sub-expressions that depend on the geometry alone.")
    return k, {field.name: k.input(field.name, (), field.unit, doc=field.doc) for field in fields}


def leg_frame_geometry(name: str, doc: str, lengths: tuple[GeometryField, ...]) -> GeometryType:
    """The geometry of a leg with a leg frame at its azimuth: its fields, and c, e_x, e_1, e_t prepared."""
    fields = (*BASE_FIELDS, *lengths)
    k, symbols = begin_geometry(fields)
    azimuth = symbols["azimuth"]
    e_t = k.let("e_t", sp.Matrix([-sp.sin(azimuth), sp.cos(azimuth), 0]))
    write_leg_frame(k, symbols, k.let("e_r", radial(azimuth)), e_t)
    return GeometryType(name, doc, fields, k.kernel())


def leg_axes(k: KernelWriter) -> sp.Matrix:
    """The leg frame as a rotation matrix: the orientation of a sub-leg's platform that only translates."""
    return sp.Matrix.hstack(k.g.e_x, k.g.e_1, k.g.e_t)


def in_plane(angle: Any) -> sp.Matrix:
    """The direction at an angle in the linkage plane (x, e_1), or in the base plane of a planar leg."""
    return sp.Matrix([sp.cos(angle), sp.sin(angle)])


def base_points(k: KernelWriter) -> dict[str, sp.Matrix]:
    """Base joint A and the end c of link i1."""
    return {"A": k.g.c - k.g.l_1 * k.g.e_1, "c": k.g.c}


FIRST_LINK = Link("l_1", LinkKind.FIXED, "A", "c")


class Carrier(ABC):
    """What moves the linkage plane with theta_1: a first axis or a slide."""

    joint: Joint
    signs: tuple[Sign, ...] = ()
    links: tuple[Link, ...]
    origin: str
    """The name of the linkage's origin among `points`."""

    def geometry(self, name: str, doc: str, lengths: tuple[GeometryField, ...]) -> GeometryType:
        """Fields and prepared vectors: c and the leg frame."""
        return leg_frame_geometry(name, doc, lengths)

    @abstractmethod
    def posture_ports(self) -> tuple[Port, ...]:
        """The posture's vectors that belong to the carrier."""

    @abstractmethod
    def posture(self, k: KernelWriter, s: sp.Matrix, theta_1: Any) -> dict[str, sp.Matrix]:
        """Their values at a consistent pair (s, theta)."""

    @abstractmethod
    def axes(self, k: KernelWriter, at: SimpleNamespace) -> tuple[sp.Matrix, sp.Matrix]:
        """x and e_2 at a posture."""

    @abstractmethod
    def place(self, k: KernelWriter, theta_1: Any, d: sp.Matrix) -> tuple[sp.Matrix, dict[str, sp.Matrix]]:
        """S_i from theta_1 and its coordinates d in the linkage plane, and the posture."""

    @abstractmethod
    def solve(self, k: KernelWriter, s: sp.Matrix, signs: list[Any]) -> tuple[Any, sp.Matrix]:
        """theta_1 and the coordinates d of S_i in the linkage plane."""

    @abstractmethod
    def lever(self, at: SimpleNamespace) -> Any:
        """b_11 of e_2^T s_dot = b_11 theta_1_dot."""

    def factors(self, at: SimpleNamespace, longest: Any) -> tuple[Factor, ...]:
        """Factors of det M_i that belong to the carrier."""
        return ()

    @abstractmethod
    def points(self, k: KernelWriter, at: SimpleNamespace, s: sp.Matrix) -> dict[str, sp.Matrix]:
        """Its joints, from the base on; the last is the linkage's origin."""


class FirstAxis(Carrier):
    """An actuated revolute joint about e_1."""

    joint = Joint("theta_1", JointKind.REVOLUTE, "about e_1; zero where e_2 is tangential")
    signs = (SHOULDER,)
    links = (FIRST_LINK,)
    origin = "c"

    def posture_ports(self) -> tuple[Port, ...]:
        return (
            Port("x", (3,), Unit.NONE, Frame.BASE, "Rot(e_1, theta_1) e_x", Layout.STACKED),
            Port("e_2", (3,), Unit.NONE, Frame.BASE, "Rot(e_1, theta_1) e_t", Layout.STACKED),
            PLANE_PORT,
        )

    def frame(self, k: KernelWriter, theta_1: Any) -> tuple[sp.Matrix, sp.Matrix]:
        """x and e_2 at theta_1."""
        cosine, sine = k.let("cos_1", sp.cos(theta_1)), k.let("sin_1", sp.sin(theta_1))
        x = k.let("x", cosine * k.g.e_x - sine * k.g.e_t, "Rot(e_1, theta_1) e_x")
        return x, k.let("e_2", cosine * k.g.e_t + sine * k.g.e_x, "Rot(e_1, theta_1) e_t")

    def posture(self, k: KernelWriter, s: sp.Matrix, theta_1: Any) -> dict[str, sp.Matrix]:
        x, e_2 = self.frame(k, theta_1)
        arm = k.let("arm", s - k.g.c, "s - c")
        d = k.let("d", sp.Matrix([dot(arm, x), dot(arm, k.g.e_1)]), "s - c in the plane (x, e_1)")
        return {"x": x, "e_2": e_2, "d": d}

    def axes(self, k: KernelWriter, at: SimpleNamespace) -> tuple[sp.Matrix, sp.Matrix]:
        return at.x, at.e_2

    def place(self, k: KernelWriter, theta_1: Any, d: sp.Matrix) -> tuple[sp.Matrix, dict[str, sp.Matrix]]:
        x, e_2 = self.frame(k, theta_1)
        return k.g.c + d[0] * x + d[1] * k.g.e_1, {"x": x, "e_2": e_2, "d": d}

    def solve(self, k: KernelWriter, s: sp.Matrix, signs: list[Any]) -> tuple[Any, sp.Matrix]:
        """theta_1 and d = (r, y), r having the sign given.

        On the first axis (r = 0) every theta_1 serves; atan2(0, 0) = 0 is returned, and the leg is singular
        there.
        """
        (sign,) = signs
        d = k.let("d", s - k.g.c, "s - c")
        along_x, along_t = k.let("d_x", dot(d, k.g.e_x)), k.let("d_t", dot(d, k.g.e_t))
        y = k.let("y", dot(d, k.g.e_1))
        r = k.signed_root("r", sign, along_x**2 + along_t**2)
        return k.atan2(-sign * along_t, sign * along_x), sp.Matrix([r, y])

    def lever(self, at: SimpleNamespace) -> Any:
        return -at.d[0]

    def factors(self, at: SimpleNamespace, longest: Any) -> tuple[Factor, ...]:
        return (Factor("shoulder", at.d[0] / longest, "S_i on the first axis"),)

    def points(self, k: KernelWriter, at: SimpleNamespace, s: sp.Matrix) -> dict[str, sp.Matrix]:
        return base_points(k)


class Slide(Carrier):
    """An actuated prismatic joint along e_t, normal to the linkage plane."""

    joint = Joint("d", JointKind.PRISMATIC, "slide along e_t, from c")
    links = (FIRST_LINK, Link("d", LinkKind.SLIDE, "c", "D"))
    origin = "D"

    def posture_ports(self) -> tuple[Port, ...]:
        return (PLANE_PORT,)

    def posture(self, k: KernelWriter, s: sp.Matrix, theta_1: Any) -> dict[str, sp.Matrix]:
        arm = k.let("arm", s - k.g.c, "s - c")
        d = sp.Matrix([dot(arm, k.g.e_x), dot(arm, k.g.e_1)])
        return {"d": k.let("d", d, "s - c in the plane (e_x, e_1)")}

    def axes(self, k: KernelWriter, at: SimpleNamespace) -> tuple[sp.Matrix, sp.Matrix]:
        return k.g.e_x, k.g.e_t

    def place(self, k: KernelWriter, theta_1: Any, d: sp.Matrix) -> tuple[sp.Matrix, dict[str, sp.Matrix]]:
        return k.g.c + d[0] * k.g.e_x + d[1] * k.g.e_1 + theta_1 * k.g.e_t, {"d": d}

    def solve(self, k: KernelWriter, s: sp.Matrix, signs: list[Any]) -> tuple[Any, sp.Matrix]:
        arm = k.let("arm", s - k.g.c, "s - c")
        d = k.let("d", sp.Matrix([dot(arm, k.g.e_x), dot(arm, k.g.e_1)]))
        return dot(arm, k.g.e_t), d

    def lever(self, at: SimpleNamespace) -> Any:
        return sp.Integer(1)

    def points(self, k: KernelWriter, at: SimpleNamespace, s: sp.Matrix) -> dict[str, sp.Matrix]:
        origin = k.let("origin", s - at.d[0] * k.g.e_x - at.d[1] * k.g.e_1, "c + theta_1 e_t")
        return {**base_points(k), "D": origin}


class ParallelSlide(Slide):
    """A slide in a direction that all legs may share, whatever their azimuth (Fig. 2.11)."""

    joint = Joint("d", JointKind.PRISMATIC, "slide along e_t, from c; e_t is at slide_azimuth")

    def geometry(self, name: str, doc: str, lengths: tuple[GeometryField, ...]) -> GeometryType:
        direction = GeometryField(
            "slide_azimuth", Unit.RADIAN, "azimuth of the slide, alike for parallel slides"
        )
        fields = (*BASE_FIELDS, direction, *lengths)
        k, symbols = begin_geometry(fields)
        e_t = k.let("e_t", radial(symbols["slide_azimuth"]))
        write_leg_frame(k, symbols, cross(e_t, E_Z), e_t)
        return GeometryType(name, doc, fields, k.kernel())
