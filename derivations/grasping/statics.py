"""Statics of the grasping robots in the three views of Section 5.2, without a matrix inverse.

All forces are those that the robot applies to its environment.  The right sub-leg pushes the right jaw with
g_P at P, the left one the left jaw with g_S at S.  Equilibrium of both jaws, and of each about the pivot B,
where they push one another, is

    g_P + g_S = f_b,   (P - B) x g_P = m_r,   (S - B) x g_S = m_l,

which is (5.36) in the end points' coordinates; the actuators give f = M^T g.  This is the non-redundant view,
right for every load.  The others are special cases:

* kinematically redundant (5.12): nothing loads the left jaw, m_l = 0;
* redundantly actuated (5.25): the jaws are one body, of which only the wrench is known.  What the wrench
  leaves open is a pair of opposite forces along PS, and f = U^I F + lambda k, where k is what a pair of one
  newton takes.  It exists at gamma = 0 and pi too, where the other views are singular.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import sympy as sp

from krhpr.codegen.kernel import Kernel
from krhpr.codegen.writer import KernelWriter
from krhpr.derivations.grasping.ports import (
    ACTUATORS,
    END,
    END_FORCE,
    INTERNAL,
    JACOBIAN,
    LOAD,
    PIVOT,
    WRENCH,
    both,
    together,
)
from krhpr.derivations.vectors import NO_LENGTH, E, cross2, dot

LEAST = replace(
    together(ACTUATORS), name="least_forces", doc="U^I F of (5.25): the least actuator forces of that wrench"
)
NULL_SPACE = replace(
    together(ACTUATORS),
    name="null_space",
    doc="null space of U: actuator forces that pull P and S together with 1 N, and do nothing else",
)


def _actuators(jacobians: Sequence[sp.Matrix], forces: Sequence[sp.Matrix]) -> list[Any]:
    """f = M^T g of both sub-legs."""
    return [x for m, g in zip(jacobians, forces, strict=True) for x in m.T * g]


def _balance(k: KernelWriter, load: Sequence[Any], moments: tuple[Any, Any] | None) -> None:
    """The actuators' forces for a force and the moments about B; those of a right jaw alone, whose `load` is
    a force and a moment about P, where there are none.
    """
    pivot, (first, second) = k.add_input(PIVOT), both(k, END)
    jacobians = both(k, JACOBIAN)
    r = [k.let("d_1", first - pivot, "from B to P"), k.let("d_2", second - pivot, "from B to S")]
    force = sp.Matrix(load[:2])
    if moments is None:
        moments = (k.let("m_r", load[2] + cross2(r[0], force), "moment about B"), sp.Integer(0))
    area = k.let("area", cross2(*r), "b l sin gamma")
    inverse = k.let("inv", 1 / area)
    rest = k.let("rest", cross2(r[1], force) - moments[1], "d_2 x g_P")
    right = k.let("g_1", (moments[0] * r[1] - rest * r[0]) * inverse, "at P")
    left = k.let("g_2", force - right, "at S")
    k.add_output(together(ACTUATORS), _actuators(jacobians, [right, left]))
    sine2 = area**2 / (dot(r[0], r[0]) * dot(r[1], r[1]))
    k.output("aligned", sp.Matrix([sine2]), doc="sin^2 gamma: zero where the jaws are aligned")


def loads_kernel() -> Kernel:
    """The non-redundant view."""
    k = KernelWriter(
        "loads", "Forces of the actuators for loads on both jaws: f = (J_n^-1 K_n)^T F_n.", "(5.44)"
    )
    loads = k.add_input(LOAD)
    _balance(k, list(loads), (loads[2], loads[3]))
    return k.kernel()


def right_jaw_kernel() -> Kernel:
    """The kinematically redundant view."""
    k = KernelWriter(
        "right_jaw",
        "Forces of the actuators for a load on the right jaw alone: f = (J_k^-1 K_k)^T F.",
        "(5.12)",
    )
    _balance(k, list(k.add_input(WRENCH)), None)
    return k.kernel()


def redundant_kernel() -> Kernel:
    """The redundantly actuated view."""
    k = KernelWriter(
        "one_body",
        "Forces of the actuators for a wrench of both jaws as one body: the least ones, the null space, and "
        "their sum.",
        "(5.24), (5.25)",
    )
    first, second = both(k, END)
    jacobians = both(k, JACOBIAN)
    wrench, internal = k.add_input(WRENCH), k.add_input(INTERNAL)
    force = sp.Matrix(wrench[:2])
    c = k.let("Qc", second - first, "Q_phi c, from P to S")
    square = k.let("c2", dot(c, c))
    left = k.let("g_2", wrench[2] / square * (E * c), "at S, some forces that balance the wrench")
    some = k.let("f_0", sp.Matrix(_actuators(jacobians, [force - left, left])))
    pull = k.let("pull", c / sp.sqrt(square), "unit vector from P to S")
    null = k.let("k", sp.Matrix(_actuators(jacobians, [pull, -pull])))
    norm = k.let("k2", dot(null, null))
    least = k.let("f_min", some - dot(some, null) / norm * null, "without its part in the null space")
    k.add_output(together(ACTUATORS), least + internal * null)
    k.add_output(LEAST, least)
    k.add_output(NULL_SPACE, null)
    # M is of rank two: its scale is that of its elements
    scale = sum(x**2 for m in jacobians for x in m)
    reach = dot(first, first) + dot(second, second)
    k.output(
        "apart",
        sp.Matrix([square / (reach + NO_LENGTH), norm / (scale + NO_LENGTH)]),
        doc="zero where P and S coincide, or no actuator gives a force along PS",
    )
    return k.kernel()


def forward_kernel() -> Kernel:
    """What the actuators' forces do, in both sets of coordinates."""
    k = KernelWriter(
        "total",
        "Loads F_n of both jaws, and wrench F of both as one body, from the forces of the sub-legs.",
        "(5.24), (5.36)",
    )
    pivot, (first, second) = k.add_input(PIVOT), both(k, END)
    right, left = both(k, END_FORCE)
    total = k.let("f_b", right + left)
    k.add_output(LOAD, [*total, cross2(first - pivot, right), cross2(second - pivot, left)])
    k.add_output(WRENCH, [*total, cross2(second - first, left)])
    return k.kernel()
