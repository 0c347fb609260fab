"""The object between the jaws of a planar grasping robot (Fig. 5.3, (5.38) to (5.43)).

Each jaw applies f_o along the normal n of its face, into the object, and f_p along E n.  The object is in
equilibrium; with c = v_r - v_l from the left contact to the right one and C the mass centre,

    f_r + f_l = -m g,     c x f_r = (v_l - C) x m g.

One of the four forces is measured: h_r . f_r + h_l . f_l = m, where one of h_r, h_l is n or E n and the other
zero.  With h = h_r - h_l, q = (v_l - C) x m g and p = m + h_l . m g,

    f_r = (p c + q E h) / (c . h),

so that |det| = |c . h|: the distance of the right contact from the left jaw's face where a normal force of
the left jaw is measured, and so on.  Nothing but zero width of the object spoils a measured normal force.
"""

from __future__ import annotations

import sympy as sp

from krhpr.codegen.kernel import Frame, Kernel, Layout, Port, Unit
from krhpr.codegen.writer import KernelWriter
from krhpr.derivations.grasping.ports import (
    ANGLE,
    CONTACT,
    CONTACT_FORCES,
    DETERMINANT,
    FACE,
    FRICTION,
    JAWS,
    LOAD,
    MARGINS,
    MASS_CENTRE,
    MEASURED,
    PULLS,
    SENSOR,
    WEIGHT,
    WIDTHS,
    together,
)
from krhpr.derivations.sublegs.carriers import in_plane
from krhpr.derivations.vectors import E, cross2, dot, turned

TOUCH = Port("v", (2,), Unit.METRE, Frame.BASE, "from B to the contact", Layout.STACKED)
NORMAL = Port("n", (2,), Unit.NONE, Frame.BASE, "normal of the jaw's face, into the object", Layout.STACKED)
AXIS = Port("x", (2,), Unit.NONE, Frame.BASE, "the jaw's x axis", Layout.STACKED)


def contact_kernel() -> Kernel:
    """One jaw's contact in the base frame."""
    k = KernelWriter("contact", "Contact and face of a jaw in the base frame.", "(5.42)")
    angle, contact, face = k.add_input(ANGLE), k.add_input(CONTACT), k.add_input(FACE)
    axis = k.let("x", in_plane(angle))
    k.add_output(TOUCH, turned(axis[0], axis[1], contact))
    normal = in_plane(face)
    k.add_output(NORMAL, turned(axis[0], axis[1], normal))
    k.add_output(AXIS, axis)
    return k.kernel()


def object_kernel() -> Kernel:
    """The forces of both jaws from one of the four, and what they are for the robot."""
    k = KernelWriter(
        "held",
        "Forces of the jaws on the object that they hold, one of the four measured, and what they mean "
        "for the robot.",
        "(5.38) to (5.43)",
    )
    touch, normal, axis = (k.add_input(together(port)) for port in (TOUCH, NORMAL, AXIS))
    v = [touch.row(jaw).T for jaw in range(JAWS)]
    n = [normal.row(jaw).T for jaw in range(JAWS)]
    x = axis.row(0).T
    local, weight = k.add_input(MASS_CENTRE), k.add_input(WEIGHT)
    sensor, measured = k.add_input(SENSOR), k.add_input(MEASURED)
    friction = k.add_input(FRICTION)
    centre = k.let("centre", turned(x[0], x[1], local), "from B to the mass centre")
    h = [
        k.let(f"h_{jaw + 1}", sensor[jaw, 0] * n[jaw] + sensor[jaw, 1] * (E * n[jaw]), "what is measured")
        for jaw in range(JAWS)
    ]
    c = k.let("c", v[0] - v[1], "from the left contact to the right one")
    across = k.let("h", h[0] - h[1])
    det = k.let("det", dot(c, across))
    inverse = k.let("inv", 1 / det)
    p = k.let("p", measured + dot(h[1], weight))
    q = k.let("q", cross2(v[1] - centre, weight))
    right = k.let("f_r", (p * c + q * (E * across)) * inverse, "of the right jaw on the object")
    left = k.let("f_l", -weight - right, "of the left jaw on the object")
    forces = [right, left]
    pairs = [[dot(f, m), dot(f, E * m)] for f, m in zip(forces, n, strict=True)]
    pairs = [[k.let(f"f_o{i}", o), k.let(f"f_p{i}", t)] for i, (o, t) in enumerate(pairs, 1)]
    total = right + left
    k.add_output(CONTACT_FORCES, [x for pair in pairs for x in pair])
    k.add_output(LOAD, [*total, *(cross2(a, f) for a, f in zip(v, forces, strict=True))])
    k.add_output(MARGINS, [(friction * o) ** 2 - t**2 for o, t in pairs])
    k.add_output(DETERMINANT, det)
    k.add_output(WIDTHS, [-dot(c, n[0]), dot(c, n[1])])
    k.add_output(PULLS, [dot(weight, m) for m in n])
    size = k.let("size", sum(dot(a, a) for a in v))
    k.output(
        "determined", sp.Matrix([det**2 / size]), doc="squared, scaled determinant: zero where it is not"
    )
    return k.kernel()
