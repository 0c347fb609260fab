"""Small linear algebra that joins sub-legs and platforms: products whose sizes depend on the space alone."""

from __future__ import annotations

from typing import Any

import sympy as sp

from krhpr.codegen.kernel import Frame, Kernel, Port, Unit
from krhpr.codegen.writer import KernelWriter
from krhpr.derivations.platforms.statics import whole_wrench
from krhpr.derivations.spectra import bound_of_bounds, eigenvalue_bound, largest_eigenvalue
from krhpr.derivations.terms import Space
from krhpr.derivations.vectors import NO_LENGTH, cross2, determinant3, dot


def kernels(space: Space) -> tuple[Kernel, ...]:
    """The kernels of one space."""
    common = (_rate(space), _rate_with_bias(space), _sum(space), _difference(space))
    own = (_rotation(),) if space is Space.PLANAR else (_rotation_error(), _segment_distance())
    return (
        *common,
        _wrist(space),
        *own,
        _spread(space),
        _spread_bound(space),
        _norms(space),
        _norm_bounds(space),
        whole_wrench(space),
    )


def _rate(space: Space) -> Kernel:
    rows, d = space.rows_per_leg, space.dimension
    k = KernelWriter("rate", "r = N s_dot, the rate along the leg's lines.", "(1.30)")
    k.output("rate", k.input("N", (rows, d)) * k.input("s_dot", (d,)))
    return k.kernel()


def _rate_with_bias(space: Space) -> Kernel:
    rows, d = space.rows_per_leg, space.dimension
    k = KernelWriter("rate_with_bias", "N s_ddot + bias, the right-hand side of (1.30) differentiated.")
    N, s_ddot, bias = k.input("N", (rows, d)), k.input("s_ddot", (d,)), k.input("bias", (rows,))
    k.output("rate", N * s_ddot + bias)
    return k.kernel()


def _sum(space: Space) -> Kernel:
    k = KernelWriter("sum", "s_ddot = M theta_ddot + bias.")
    k.output("s_ddot", k.input("along", (space.dimension,)) + k.input("bias", (space.dimension,)))
    return k.kernel()


def _difference(space: Space) -> Kernel:
    k = KernelWriter("difference", "M theta_ddot = s_ddot - bias.")
    k.output("along", k.input("s_ddot", (space.dimension,)) - k.input("bias", (space.dimension,)))
    return k.kernel()


def _wrist(space: Space) -> Kernel:
    """The joint at S_i: a rotation in space, an angle in the plane."""
    if space is Space.SPATIAL:
        k = KernelWriter(
            "wrist",
            "Rotation of the spherical joint: orientation of the redundant link seen from the "
            "sub-leg's last link.",
        )
        link, redundant = k.input("link", (3, 3)), k.input("redundant_link", (3, 3))
        k.output("spherical", link.T * redundant)
        return k.kernel()
    k = KernelWriter(
        "wrist", "Angle of the passive joint at r_i: redundant link relative to the sub-leg's last link."
    )
    link, redundant = k.input("link", (2,)), k.input("redundant_link", (2,))
    k.output("wrist", k.atan2(cross2(link, redundant), dot(link, redundant)), Unit.RADIAN)
    return k.kernel()


def _rotation_error() -> Kernel:
    """How far a matrix is from a rotation: elements of Q^T Q - I, and 1 - det Q for reflections."""
    k = KernelWriter("rotation_error", "Largest element of |Q^T Q - I|; at least 1 - det Q.")
    Q = k.input("Q", (3, 3), Unit.NONE, Frame.BASE, "orientation, base from platform")
    columns = [Q.col(j) for j in range(3)]
    products = [dot(columns[i], columns[j]) - (1 if i == j else 0) for i in range(3) for j in range(i, 3)]
    worst = k.maximum(*(k.absolute(product) for product in products))
    k.output("error", k.maximum(worst, 1 - determinant3(Q)))
    return k.kernel()


PARALLEL = sp.Rational(1, 10**15)
"""Sine squared below which links count as parallel: the numbers that tell more are rounding."""


def _segment_distance() -> Kernel:
    """The nearest points of two segments: of the lines, then held to one segment and to the other.

    The square is convex in (x, y) and two steps, each exact, end at its least value over the unit square.
    Of parallel segments any point of the first will do to begin with.
    """
    k = KernelWriter("segment_distance", "Shortest distance between two straight segments.", "1.7.1")
    names = ("a_0", "a_1", "b_0", "b_1")
    docs = ("start of the first", "its end", "start of the second", "its end")
    a_0, a_1, b_0, b_1 = (
        k.add_input(Port(name, (3,), Unit.METRE, Frame.BASE, doc))
        for name, doc in zip(names, docs, strict=True)
    )
    u, v, w = k.let("u", a_1 - a_0), k.let("v", b_1 - b_0), k.let("w", a_0 - b_0)
    uu, vv, uv = (
        k.let("uu", dot(u, u) + NO_LENGTH),
        k.let("vv", dot(v, v) + NO_LENGTH),
        k.let("uv", dot(u, v)),
    )
    uw, vw = k.let("uw", dot(u, w)), k.let("vw", dot(v, w))
    both = k.let("both", uu * vv)
    area = k.maximum(both - uv**2, PARALLEL * both)
    first = k.let("x", _held(k, (uv * vw - vv * uw) / area), "on the first, nearest to the second's line")
    y = k.let("y", _held(k, (uv * first + vw) / vv), "on the second, nearest to that")
    x = k.let("x_2", _held(k, (uv * y - uw) / uu), "on the first, nearest to that")
    gap = k.let("gap", w + x * u - y * v)
    # links in one plane that cross have no distance; what is added keeps slopes finite
    k.output("distance", sp.sqrt(dot(gap, gap) + NO_LENGTH), Unit.METRE, doc="between the nearest points")
    return k.kernel()


def _held(k: KernelWriter, value: Any) -> Any:
    """Held between 0 and 1."""
    return k.minimum(k.maximum(value, sp.Integer(0)), sp.Integer(1))


def _rotation() -> Kernel:
    k = KernelWriter("rotation", "Q from phi.", "(2.5)")
    phi = k.add_input(Port("phi", (), Unit.RADIAN, Frame.BASE, "orientation of the platform"))
    k.output("Q", sp.Matrix([[sp.cos(phi), -sp.sin(phi)], [sp.sin(phi), sp.cos(phi)]]), Unit.NONE, Frame.BASE)
    return k.kernel()


# -- the indices of Sections 1.8 and 4.2.2 -------------------------------------------------------------------


def _spread(space: Space) -> Kernel:
    k = KernelWriter("spread", "Largest and smallest singular value of M, squared.", "1.8")
    gram, minors, square = _squares(k, space)
    # by the inverse: near a singularity the difference of squares would leave no digits
    _ends(k, largest_eigenvalue(k, "g", gram), square / largest_eigenvalue(k, "h", minors))
    return k.kernel()


def _spread_bound(space: Space) -> Kernel:
    k = KernelWriter(
        "spread_bound", "Smooth bounds of the squares of M's largest and smallest singular value.", "1.8"
    )
    gram, minors, square = _squares(k, space)
    _ends(k, eigenvalue_bound(k, "g", gram), square / eigenvalue_bound(k, "h", minors))
    return k.kernel()


def _ends(k: KernelWriter, largest: Any, smallest: Any) -> None:
    high, low = k.let("high", largest), k.let("low", smallest)
    k.output("largest", high, Unit.MIXED)
    k.output("smallest", low, Unit.MIXED)
    k.output("evenness", [low / high], doc="smallest over largest: zero where M has no inverse")


def _squares(k: KernelWriter, space: Space) -> tuple[sp.Matrix, sp.Matrix, sp.Expr]:
    d = space.dimension
    return (
        k.input("gram", (d, d), Unit.MIXED),
        k.input("cofactors", (d, d), Unit.MIXED),
        k.input("square", ()),
    )


def _norms(space: Space) -> Kernel:
    k = KernelWriter(
        "norms", "The indices: 2-norms of both parts of U = J^-1 K, condition number of J_1.", "1.8, 4.2.2"
    )
    position, rotation, largest, smallest = _parts(k, space)
    k.output("eta_1", sp.sqrt(largest_eigenvalue(k, "p", position)), Unit.METRE)
    k.output("eta_2", sp.sqrt(largest_eigenvalue(k, "r", rotation)))
    k.output("eta_3", sp.sqrt(k.maximum(*largest) / k.minimum(*smallest)))
    ratios = [sp.sqrt(high / low) for high, low in zip(largest, smallest, strict=True)]
    k.output("condition", sp.Matrix(ratios), doc="condition numbers of M_1, M_2, M_3")
    return k.kernel()


def _norm_bounds(space: Space) -> Kernel:
    k = KernelWriter("norm_bounds", "Smooth bounds of the indices: Schatten norms of order 16.", "1.8, 4.2.2")
    position, rotation, largest, smallest = _parts(k, space)
    k.output("eta_1", sp.sqrt(eigenvalue_bound(k, "p", position)), Unit.METRE)
    k.output("eta_2", sp.sqrt(rotation[0] if rotation.rows == 1 else eigenvalue_bound(k, "r", rotation)))
    high = bound_of_bounds(k, "l", largest)
    low = bound_of_bounds(k, "s", [k.let("inv_s", 1 / value) for value in smallest])
    k.output("eta_3", sp.sqrt(high * low))
    return k.kernel()


def _parts(k: KernelWriter, space: Space) -> tuple[sp.Matrix, sp.Matrix, list[sp.Expr], list[sp.Expr]]:
    d, turns = space.dimension, 3 if space is Space.SPATIAL else 1
    return (
        k.input("position_gram", (d, d), Unit.MIXED),
        k.input("rotation_gram", (turns, turns), Unit.MIXED),
        list(k.input("largest", (3,), Unit.MIXED)),
        list(k.input("smallest", (3,), Unit.MIXED)),
    )
