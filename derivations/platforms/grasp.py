"""What the jaws of arrangements (b) and (c) do to the object that they hold (Section 5.3).

The jaw frame of (5.4): x_i = -t_i, from S_i towards where the jaw closes, z_i = z', y_i = z_i x x_i.  Jaw i
applies f_i = [f_xi, f_yi, f_zi] to the object, at its contact.  The f_xi are measured; the object's
equilibrium gives the rest, first the f_yi, which are in the platform's plane, then the f_zi.  The equations
of the forces f_yi are those of three lines, and those of f_zi of three points: |det| is twice the area of the
contacts' triangle times what vanishes where the lines through the contacts along y_i meet in a point.

The forces and moments that are conjugate to the twist and to d_i are

    [sum Q_i f_i; sum w_i x (Q_i f_i); -f_x1, -f_x2, -f_x3]

with w_i from O' to the contacts; (5.62) to (5.68) as printed are not.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import sympy as sp

from krhpr.codegen.kernel import Frame, Kernel, Layout, Port, Unit
from krhpr.codegen.writer import KernelWriter
from krhpr.derivations.platforms.kernels import all_legs
from krhpr.derivations.platforms.opening import SLIDE
from krhpr.derivations.platforms.statics import StaticsPorts
from krhpr.derivations.vectors import E, cross, cross2, dot, solve3

if TYPE_CHECKING:
    from krhpr.derivations.platforms.base import Platform
    from krhpr.derivations.platforms.slides import SlidePlatform


class GraspPorts:
    """The ports of a grasp."""

    def __init__(self, platform: Platform) -> None:
        d = platform.space.dimension
        frame = "[f_x, f_y, f_z]" if d == 3 else "[f_x, f_y]"
        statics = StaticsPorts(platform)
        self.contacts = Port(
            "contacts", (d,), Unit.METRE, Frame.PLATFORM, "w_i, from O' to the jaw's contact", Layout.STACKED
        )
        self.mass_centre = Port(
            "mass_centre", (d,), Unit.METRE, Frame.PLATFORM, "from O' to the object's mass centre"
        )
        self.weight = Port("weight", (d,), Unit.NEWTON, Frame.BASE, "of the object, m g")
        self.normal_forces = Port(
            "normal_forces",
            (),
            Unit.NEWTON,
            Frame.JOINT,
            "f_xi, measured: what jaw i presses on the object with",
            Layout.STACKED,
        )
        self.friction = Port("friction", (), Unit.NONE, Frame.NONE, "coefficient of friction, not negative")
        self.contact_forces = Port(
            "contact_forces",
            (3, d),
            Unit.NEWTON,
            Frame.JOINT,
            f"{frame} that each jaw applies to the object, in the jaw's frame",
        )
        self.wrench = statics.wrench
        redundant = statics.redundant_forces
        self.redundant_forces = Port(
            redundant.name, (3,), redundant.unit, redundant.frame, f"{redundant.doc}: -f_xi"
        )
        self.friction_margins = Port(
            "friction_margins",
            (3,),
            Unit.MIXED,
            Frame.NONE,
            "(mu f_xi)^2 less the square of the tangential force (N^2): negative where the contact slips",
        )


def grasp_kernel(plate: SlidePlatform) -> Kernel:
    """The equilibrium of the object, and what the robot applies to it."""
    k = KernelWriter(
        "grasp",
        "Forces of the jaws on the object that they hold, from the measured ones, and what they mean for the "
        "robot.",
        "(5.38), (5.39), (5.62) to (5.68) corrected",
    )
    ports, d = GraspPorts(plate), plate.space.dimension
    Q = k.add_input(Port("Q", (d, d), Unit.NONE, Frame.BASE, "orientation, base from platform"))
    slides, contacts = all_legs(k, SLIDE), all_legs(k, ports.contacts)
    centre, weight = k.add_input(ports.mass_centre), k.add_input(ports.weight)
    normal, friction = all_legs(k, ports.normal_forces), k.add_input(ports.friction)
    load = k.let("w_l", Q.T * weight, "weight in the platform frame")

    # in the plane: x_i = -t_i, y_i = z' x x_i = -E t_i
    y = [-(E * t) for t in slides]
    arms = [
        k.let(f"r_{i + 1}", contact - centre, "from the mass centre") for i, contact in enumerate(contacts)
    ]
    pressed = k.let("f_n", -sum((f * t for f, t in zip(normal, slides, strict=True)), sp.zeros(2, 1)))
    turned = -sum(f * cross2(arm, t) for f, arm, t in zip(normal, arms, slides, strict=True))
    system = sp.Matrix.hstack(
        *(sp.Matrix([*axis, cross2(arm, axis)]) for axis, arm in zip(y, arms, strict=True))
    )
    scaled, det_a = solve3(
        system, k.let("b_a", -sp.Matrix([pressed[0] + load[0], pressed[1] + load[1], turned]))
    )
    inverse_a = k.let("inv_a", 1 / k.let("det_a", det_a, "zero where the lines along y_i meet"))
    f_y = k.let("f_y", scaled * inverse_a)
    local = [
        k.let(f"f_{i + 1}", f_y[i] * y[i] - normal[i] * slides[i], "in the platform's plane")
        for i in range(3)
    ]
    size = k.let("size", sum(dot(c[:2, 0], c[:2, 0]) for c in contacts))
    regularity = [det_a**2 / size]
    f_z = None
    if d == 3:
        # along z': sum f_z and the moments about x' and y', to which the forces in the plane add by heights
        points = sp.Matrix.hstack(*(sp.Matrix([1, arm[1], -arm[0]]) for arm in arms))
        right = [
            -load[2],
            sum(arm[2] * f[1] for arm, f in zip(arms, local, strict=True)),
            -sum(arm[2] * f[0] for arm, f in zip(arms, local, strict=True)),
        ]
        scaled, det_n = solve3(points, k.let("b_n", sp.Matrix(right)))
        inverse_n = k.let("inv_n", 1 / k.let("det_n", det_n, "zero where the contacts are in line"))
        f_z = k.let("f_z", scaled * inverse_n)
        local = [sp.Matrix([*f, z]) for f, z in zip(local, f_z, strict=True)]
        regularity.append(det_n**2 / size**2)

    k.add_output(
        ports.contact_forces, [[normal[i], f_y[i], *([] if f_z is None else [f_z[i]])] for i in range(3)]
    )
    total = Q * k.let("F_l", sum(local, sp.zeros(d, 1)))
    if d == 3:
        moment = list(
            Q * k.let("m_l", sum((cross(c, f) for c, f in zip(contacts, local, strict=True)), sp.zeros(3, 1)))
        )
    else:
        moment = [sum(cross2(c, f) for c, f in zip(contacts, local, strict=True))]
    k.add_output(ports.wrench, [*total, *moment])
    k.add_output(ports.redundant_forces, [-f for f in normal])
    tangential = [f_y[i] ** 2 + (0 if f_z is None else f_z[i] ** 2) for i in range(3)]
    k.add_output(ports.friction_margins, [(friction * normal[i]) ** 2 - tangential[i] for i in range(3)])
    k.output("determined", sp.Matrix(regularity), doc="squared, scaled determinants: zero where it is not")
    return k.kernel()
