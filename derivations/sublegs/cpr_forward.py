"""Forward kinematics of the 3-CPR sub-leg: every assembly mode, from the real roots of an octic.

|p_1| = rho_1 puts s on a cylinder about axis 1: s = g_1 + rho_1 (cos(t) a + sin(t) b) + x e_1.  The other
two chains are then quadratic in x, A_k x^2 + B_k x + C_k = 0, with A_k constant, B_k linear and C_k
quadratic in (cos(t), sin(t)).  Both have a common root x where

    F^2 = G H,  F = A_2 C_3 - A_3 C_2,  G = A_2 B_3 - A_3 B_2,  H = B_2 C_3 - B_3 C_2,

of degree eight in T = tan(t / 2), and it is x = -F / G.  Where two assembly modes share t, G is zero there:
T is a double root, and both modes are in doubt.  That is so for all of them if the axes are normal to one
another and meet in one point; Newton steps from a point nearby find each.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import sympy as sp

from krhpr.codegen.kernel import Frame, Kernel, Layout, Port, Unit
from krhpr.codegen.writer import KernelWriter
from krhpr.derivations.polynomials import linear, product
from krhpr.derivations.roots import cosine_and_sine, miss_port, root_port, write_miss
from krhpr.derivations.sublegs.chains import row
from krhpr.derivations.sublegs.forward import ForwardRoots
from krhpr.derivations.sublegs.kernels import SubLegKernels
from krhpr.derivations.vectors import determinant3, dot

if TYPE_CHECKING:
    from krhpr.derivations.sublegs.cpr import CPR3

DEGREE = 8
OCTIC = Port(
    "octic",
    (DEGREE + 1,),
    Unit.MIXED,
    Frame.NONE,
    "coefficients in T = tan(t / 2), the constant one first",
    Layout.STACKED,
)
ROOT = root_port("octic")
VOLUME = Port(
    "volume",
    (),
    Unit.MIXED,
    Frame.NONE,
    "p_1^T (p_2 x p_3), whose sign tells assembly modes apart",
    Layout.STACKED,
)
MISS = miss_port("the distances rho_k")
STEPS = 2
"""Newton steps behind each root."""


def forward_roots(leg: CPR3) -> ForwardRoots:
    """The octic, the end point at one of its roots, and what is collected."""
    s = leg.ports().s_all
    return ForwardRoots(
        polynomial=_octic(leg),
        at_root=_at_root(leg),
        degree=DEGREE,
        order=VOLUME.name,
        outputs=(replace(s, doc=f"{s.doc}, NaN behind the last"), replace(VOLUME, shape=(DEGREE,))),
        equations="2.4.3",
        doc="the real roots of an octic, up to eight, in the order of p_1^T (p_2 x p_3).  Where two all but "
        "coincide, or share the angle about axis 1, they are left out and said to be in doubt.",
    )


def _frame(k: KernelWriter) -> tuple[sp.Matrix, sp.Matrix, sp.Matrix]:
    """a, b and axis 1, orthonormal."""
    return row(k.g.n, 0), row(k.g.n, 1), row(k.g.e, 0)


def _across(vector: sp.Matrix, axis: sp.Matrix) -> sp.Matrix:
    return vector - dot(vector, axis) * axis


def _quadratics(k: KernelWriter, theta: sp.Matrix) -> list[tuple[Any, list[Any], list[Any]]]:
    """A_k, B_k and C_k of chains 2 and 3; B_k times 1 + T^2 and C_k times its square, in powers of T."""
    a, b, axis = _frame(k)
    whole = product([1, 0, 1], [1, 0, 1])
    found = []
    for n in (2, 3):
        e = row(k.g.e, n - 1)
        start = k.let(f"o_{n}", _across(row(k.g.g, 0) - row(k.g.g, n - 1), e), "g_1 seen along axis k")
        turning = [k.let(f"{name}_{n}", theta[0] * _across(v, e)) for name, v in (("a", a), ("b", b))]
        along = k.let(f"e_{n}", _across(axis, e))
        parts = [linear(start[i], turning[0][i], turning[1][i]) for i in range(3)]
        p = [[k.let(f"p_{n}{i}_{j}", value) for j, value in enumerate(part)] for i, part in enumerate(parts)]
        square = [
            sum(column, -(theta[n - 1] ** 2) * one)
            for *column, one in zip(*(product(q, q) for q in p), whole, strict=True)
        ]
        slope = [2 * sum(along[i] * p[i][j] for i in range(3)) for j in range(3)]
        found.append(
            (
                k.let(f"A_{n}", dot(along, along)),
                [k.let(f"B_{n}_{j}", value) for j, value in enumerate(slope)],
                [k.let(f"C_{n}_{j}", value) for j, value in enumerate(square)],
            )
        )
    return found


def _eliminated(k: KernelWriter, theta: sp.Matrix) -> tuple[list[Any], list[Any], list[Any]]:
    """F, G and H in powers of T."""
    (a_2, b_2, c_2), (a_3, b_3, c_3) = _quadratics(k, theta)

    def named(name: str, values: Sequence[Any]) -> list[Any]:
        return [k.let(f"{name}_{j}", value) for j, value in enumerate(values)]

    first = named("F", [a_2 * x - a_3 * y for x, y in zip(c_3, c_2, strict=True)])
    second = named("G", [a_2 * x - a_3 * y for x, y in zip(b_3, b_2, strict=True)])
    third = named("H", [x - y for x, y in zip(product(b_2, c_3), product(b_3, c_2), strict=True)])
    return first, second, third


def _octic(leg: CPR3) -> Kernel:
    k = KernelWriter(
        "octic", f"The octic of the {leg.notation} sub-leg's assembly modes.", "2.4.3", leg.geometry()
    )
    F, G, H = _eliminated(k, k.add_input(leg.ports().theta))
    k.add_output(OCTIC, [x - y for x, y in zip(product(F, F), product(G, H), strict=True)])
    return k.kernel()


def _at_root(leg: CPR3) -> Kernel:
    k = KernelWriter(
        "at_root", f"End point of the {leg.notation} sub-leg at a root of its octic.", "2.4.3", leg.geometry()
    )
    root = k.add_input(ROOT)
    theta = k.add_input(leg.ports().theta)
    a, b, axis = _frame(k)
    cosine, sine = cosine_and_sine(k, root, "_t")
    foot = k.let("foot", row(k.g.g, 0) + theta[0] * (cosine * a + sine * b), "on the cylinder, x = 0")
    level = []  # A x^2 + B x + C of chains 2 and 3
    for n in (2, 3):
        e = row(k.g.e, n - 1)
        p, along = k.let(f"p_{n}", _across(foot - row(k.g.g, n - 1), e)), k.let(f"e_{n}", _across(axis, e))
        level.append(
            (
                k.let(f"A_{n}", dot(along, along)),
                k.let(f"B_{n}", 2 * dot(along, p)),
                dot(p, p) - theta[n - 1] ** 2,
            )
        )
    (a_2, b_2, c_2), (a_3, b_3, c_3) = level
    s = k.let("s_0", foot - (a_2 * c_3 - a_3 * c_2) / (a_2 * b_3 - a_3 * b_2) * axis)
    step = SubLegKernels(leg).forward_step()
    for _ in range(STEPS):
        s = k.call(step, theta=theta, s=s).s_next
    k.add_output(leg.ports().s, s)
    normals = [k.let(f"w_{n}", chain.w) for n, chain in enumerate(leg.chains(k, s, theta), 1)]
    k.add_output(VOLUME, determinant3(sp.Matrix([list(w) for w in normals])))
    misses = [dot(w, w) - rho**2 for w, rho in zip(normals, theta, strict=True)]
    write_miss(k, MISS, misses, sum(rho**2 for rho in theta))
    return k.kernel()
