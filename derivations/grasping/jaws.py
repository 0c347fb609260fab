"""Two jaws on a pivot (Figs. 5.1, 5.2): geometry, position, velocity and Jacobians.

A jaw is the link from the sub-leg's end point (P of the right one, S of the left one) to the pivot B, with
its frame at the end point and the x axis towards B:

    s = b - Q v,  v = [l, 0]^T,                                                          (5.26), (5.27)

so that both jaws are alike.  `r` is Q v = b - s.  Everything that depends on velocities reads the pivot and
the end points, not the angles.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import sympy as sp

from krhpr.codegen.kernel import Frame, GeometryField, GeometryType, Kernel, Port, Unit
from krhpr.codegen.writer import KernelWriter
from krhpr.derivations.grasping.equilibrium import contact_kernel, object_kernel
from krhpr.derivations.grasping.ports import (
    ANGLE,
    ANGLE_RATE,
    END,
    END_RATE,
    JAWS,
    LENGTH,
    PIVOT,
    PIVOT_RATE,
    SIDE,
    TWIST,
    both,
    together,
)
from krhpr.derivations.grasping.statics import (
    forward_kernel,
    loads_kernel,
    redundant_kernel,
    right_jaw_kernel,
)
from krhpr.derivations.sublegs.carriers import begin_geometry, in_plane
from krhpr.derivations.sublegs.circles import meet
from krhpr.derivations.terms import Joint, JointKind, Space
from krhpr.derivations.vectors import E, cross2, dot

SOLUTIONS = 8
"""Assembly modes of P, times those of S, times the sides of B: two each."""

ROWS = Port("w", (2, 2), Unit.METRE, Frame.BASE, "u_k of the sub-leg's two chains, rows")
TRANSMISSIONS = Port("b", (2,), Unit.MIXED, Frame.NONE, "kappa_k: u_k^T s_dot = kappa_k rho_k_dot")


GAMMA = Joint("gamma", JointKind.REVOLUTE, "angle between the jaws, beta - phi, at B")


@dataclass(frozen=True)
class Jaws:
    """The platform of a grasping robot."""

    name: str = "jaws"
    space: Space = Space.PLANAR
    doc: str = "Two jaws on a pivot B: links from P (right jaw) and from S (left jaw) to B."
    section: str = "5.2"
    redundant_joint: Joint = GAMMA

    def geometry(self) -> GeometryType:
        """The length of a jaw: b of the right one, l of the left one."""
        fields = (
            GeometryField("l_j", Unit.METRE, "jaw, from P (S) to B: b (l) of the thesis", positive=True),
        )
        k, symbols = begin_geometry(fields)
        k.output("v", sp.Matrix([symbols["l_j"], 0]), Unit.METRE, Frame.JOINT, "v of (5.8), (5.29)")
        return GeometryType(f"platform_planar_{self.name}", self.doc, fields, k.kernel())

    def kernels(self) -> tuple[Kernel, ...]:
        """Every kernel, in the order in which it is printed."""
        return (
            _end_point(self.geometry()),
            _length(self.geometry()),
            _end_velocity(),
            _pivot(),
            _pivots(),
            _solve(),
            _non_redundant(),
            _redundantly_actuated(),
            _kinematically_redundant(),
            _type_2(),
            loads_kernel(),
            right_jaw_kernel(),
            redundant_kernel(),
            forward_kernel(),
            contact_kernel(),
            object_kernel(),
        )


def levers(k: KernelWriter) -> tuple[sp.Matrix, sp.Matrix]:
    """From P and from S to B: Q_phi v_1 and Q_beta v_2."""
    pivot, ends = k.add_input(PIVOT), both(k, END)
    first, second = (k.let(f"r_{i}", pivot - s, "from the end point to B") for i, s in enumerate(ends, 1))
    return first, second


def _end_point(geometry: GeometryType) -> Kernel:
    k = KernelWriter("end_point", "End point of a jaw: s = b - Q v.", "(5.32), (5.33)", geometry)
    pivot, angle = k.add_input(PIVOT), k.add_input(ANGLE)
    k.add_output(END, pivot - k.g.l_j * in_plane(angle))
    return k.kernel()


def _length(geometry: GeometryType) -> Kernel:
    k = KernelWriter("length", "Length of a jaw, for kernels of both.", "", geometry)
    k.add_output(LENGTH, k.g.l_j)
    return k.kernel()


def _end_velocity() -> Kernel:
    k = KernelWriter(
        "end_velocity", "Velocity of a jaw's end point: s_dot = b_dot - rate E Q v.", "(5.30), (5.31)"
    )
    pivot, s = k.add_input(PIVOT), k.add_input(END)
    velocity, rate = k.add_input(PIVOT_RATE), k.add_input(ANGLE_RATE)
    k.add_output(END_RATE, velocity - rate * (E * (pivot - s)))
    return k.kernel()


def _place(k: KernelWriter, ends: list[sp.Matrix], lengths: list[Any], side: Any) -> tuple[Any, Any, Any]:
    """B from P and S: its place, the jaws from P and S, and the radicand that is negative where they do not
    meet.
    """
    first, second = ends
    found = meet(k, k.let("line", second - first, "from P to S"), lengths[0] ** 2, lengths[1] ** 2, side)
    pivot = k.let("pivot", first + found.point)
    return pivot, [pivot - s for s in ends], found.radicand


def _pivot() -> Kernel:
    k = KernelWriter("pivot", "Pivot and angles of the jaws from P and S, on one side of the line PS.", "5.2")
    ends, lengths, side = both(k, END), both(k, LENGTH), k.add_input(SIDE)
    pivot, jaws, radicand = _place(k, ends, lengths, side)
    k.add_output(PIVOT, pivot)
    k.add_output(together(ANGLE), [k.atan2(jaw[1], jaw[0]) for jaw in jaws])
    k.output("radicands", sp.Matrix([radicand]), doc="not negative where the jaws reach each other")
    return k.kernel()


def _pivots() -> Kernel:
    k = KernelWriter(
        "pivots",
        "Pivot and angles of the jaws for every assembly mode of P (slowest), of S, and every side of the "
        "line PS (fastest): eight, NaN where one does not exist.",
        "5.2; errata 2.1",
    )
    points = both(k, replace(END, shape=(2, 2)))
    lengths = both(k, LENGTH)
    places, angles = [], []
    for i in range(2):
        for j in range(2):
            ends = [points[0].row(i).T, points[1].row(j).T]
            for side in (1, -1):
                pivot, jaws, _ = _place(k, ends, lengths, sp.Integer(side))
                places += list(pivot)
                angles += [k.atan2(jaw[1], jaw[0]) for jaw in jaws]
    k.add_output(replace(PIVOT, shape=(SOLUTIONS, 2), doc="pivot B of every solution"), places)
    k.add_output(
        replace(together(ANGLE), shape=(SOLUTIONS, JAWS), doc="phi and beta of every solution"), angles
    )
    return k.kernel()


def regularity(k: KernelWriter, r: tuple[sp.Matrix, sp.Matrix], area: Any) -> sp.Matrix:
    """sin^2 gamma, zero where the jaws are aligned."""
    squares = [dot(entry, entry) for entry in r]
    return sp.Matrix([k.let("sine2", area**2 / (squares[0] * squares[1]), "sin^2 gamma")])


REGULARITY = "sin^2 gamma: zero where the jaws are aligned"


def _solve() -> Kernel:
    k = KernelWriter(
        "solve",
        "Velocities of the pivot, of the jaws' angles and of P, from those of the end points.",
        "(5.3), (5.34)",
    )
    r = levers(k)
    v = both(k, END_RATE)
    pairs = list(zip(r, v, strict=True))
    along = [k.let(f"v_{i}", dot(a, b), "r . s_dot = r . b_dot") for i, (a, b) in enumerate(pairs, 1)]
    area = k.let("area", cross2(*r), "b l sin gamma")
    inverse = k.let("inv", 1 / area)
    pivot = k.let("b_dot", (along[1] * (E * r[0]) - along[0] * (E * r[1])) * inverse)
    rates = [dot(E * a, pivot - b) / dot(a, a) for a, b in pairs]
    rates = [k.let(f"rate_{i}", rate) for i, rate in enumerate(rates, 1)]
    k.add_output(PIVOT_RATE, pivot)
    k.add_output(together(ANGLE_RATE), rates)
    k.add_output(TWIST, [*v[0], rates[0]])
    k.output("aligned", regularity(k, r, area), doc=REGULARITY)
    return k.kernel()


def _chains(k: KernelWriter) -> tuple[list[sp.Matrix], list[Any]]:
    """u_1 to u_4 and kappa_1 to kappa_4 of the thesis."""
    w, b = both(k, ROWS), both(k, TRANSMISSIONS)
    return [entry.row(i).T for entry in w for i in range(2)], [x for entry in b for x in entry]


def _non_redundant() -> Kernel:
    k = KernelWriter(
        "non_redundant", "J_n and K_n of J_n [b_dot, phi_dot, beta_dot] = K_n rho_dot.", "(5.35)"
    )
    r = levers(k)
    u, kappa = _chains(k)
    rows = [
        [*u[i], *(-cross2(r[jaw], u[i]) if i // 2 == jaw else sp.Integer(0) for jaw in range(JAWS))]
        for i in range(4)
    ]
    k.output("J", sp.Matrix(rows), Unit.MIXED, Frame.BASE)
    k.output("K", sp.diag(*kappa), Unit.MIXED, Frame.BASE)
    return k.kernel()


def _redundantly_actuated() -> Kernel:
    k = KernelWriter(
        "redundantly_actuated",
        "J_r and K_r of J_r t = K_r rho_dot, where the angle between the jaws is blocked.",
        "(5.21), (5.22)",
    )
    first, second = both(k, END)
    c = k.let("Qc", second - first, "Q_phi c")
    u, kappa = _chains(k)
    rows = [[*u[i], cross2(c, u[i]) if i > 1 else sp.Integer(0)] for i in range(4)]
    k.output("J", sp.Matrix(rows), Unit.MIXED, Frame.BASE)
    k.output("K", sp.diag(*kappa), Unit.MIXED, Frame.BASE)
    return k.kernel()


def _kinematically_redundant() -> Kernel:
    k = KernelWriter(
        "kinematically_redundant",
        "J_k and K_k of J_k t = K_k rho_dot.  [k33, k34] = (s - b)^T M, M the Jacobian of the left sub-leg.",
        "(5.4), (5.5); errata 2.1",
    )
    r = levers(k)
    u, kappa = _chains(k)
    volume = k.let("volume", cross2(u[2], u[3]), "Delta of k33, k34")
    inverse = k.let("inv", 1 / volume)
    d = -r[1]
    k_33 = kappa[2] * cross2(d, u[3]) * inverse
    k_34 = -kappa[3] * cross2(d, u[2]) * inverse
    zero = sp.Integer(0)
    k.output(
        "J",
        sp.Matrix([[*u[0], zero], [*u[1], zero], [*d, cross2(r[0], d)]]),
        Unit.MIXED,
        Frame.BASE,
    )
    rows = [[kappa[0], zero, zero, zero], [zero, kappa[1], zero, zero], [zero, zero, k_33, k_34]]
    k.output("K", sp.Matrix(rows), Unit.MIXED, Frame.BASE)
    sine2 = volume**2 / (dot(u[2], u[2]) * dot(u[3], u[3]))
    k.output("aligned", sp.Matrix([sine2]), doc="squared sine between the left sub-leg's chains")
    return k.kernel()


def _type_2() -> Kernel:
    k = KernelWriter(
        "type_2",
        "Determinants of J_k and J_n in closed form, and sin gamma.",
        "errata 2.1",
    )
    r = levers(k)
    w, lengths = both(k, ROWS), both(k, LENGTH)
    area = k.let("area", cross2(*r), "b l sin gamma")
    legs = [k.let(f"volume_{i}", cross2(m.row(0).T, m.row(1).T), "u x u") for i, m in enumerate(w, 1)]
    k.output("determinants", sp.Matrix([-legs[0] * area, -legs[0] * legs[1] * area]), Unit.MIXED)
    k.output("sine", area / (lengths[0] * lengths[1]))
    return k.kernel()
