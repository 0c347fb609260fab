"""The ports of a planar grasping robot.  Rows of jaw-wise arrays are the right jaw, then the left one."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import sympy as sp

from krhpr.codegen.kernel import Frame, Layout, Port, Unit
from krhpr.codegen.writer import KernelWriter

JAWS = 2
"""How many jaws, and legs, a grasping robot has."""


def of_jaws(port: Port) -> Port:
    """A port of a leg as that of a robot with two of them."""
    return replace(port, legs=JAWS)


def together(port: Port) -> Port:
    """A port of one jaw as a kernel of both reads or writes it."""
    return replace(port, shape=(JAWS, *port.shape), layout=Layout.SHARED)


def both(k: KernelWriter, port: Port) -> list[Any]:
    """An input with both jaws' values, as two scalars, vectors or matrices."""
    whole = k.add_input(together(port))
    if len(port.shape) < 2:
        return [whole.row(jaw).T if port.shape else whole[jaw] for jaw in range(JAWS)]
    flat, size = list(whole), port.size
    return [sp.Matrix(*port.shape, flat[size * jaw : size * (jaw + 1)]) for jaw in range(JAWS)]


_STACKED = Layout.STACKED

PIVOT = Port("pivot", (2,), Unit.METRE, Frame.BASE, "pivot B of the two jaws")
ANGLE = Port(
    "angles",
    (),
    Unit.RADIAN,
    Frame.BASE,
    "directions of the jaws, from P to B (phi) and from S to B (beta), from the x axis of the base",
    _STACKED,
)
END = Port("s", (2,), Unit.METRE, Frame.BASE, "end points of the sub-legs, P and S", _STACKED)
LENGTH = Port("length", (), Unit.METRE, Frame.NONE, "from the jaw's end point to the pivot", _STACKED)

# velocity
PIVOT_RATE = Port("pivot_rate", (2,), Unit.METRE_PER_SECOND, Frame.BASE, "velocity of the pivot B")
ANGLE_RATE = Port(
    "angle_rates", (), Unit.ACTUATOR_RATE, Frame.BASE, "rates of the jaws' angles, phi and beta", _STACKED
)
TWIST = Port("twist", (3,), Unit.TWIST, Frame.BASE, "t of (5.3): velocity of P and rate of phi")
END_RATE = Port("s_dot", (2,), Unit.METRE_PER_SECOND, Frame.BASE, "velocity of the end point", _STACKED)
JACOBIAN = Port("M", (2, 2), Unit.MIXED, Frame.BASE, "Jacobian of the sub-leg", _STACKED)

# forward kinematics
SIDE = Port("side", (), Unit.NONE, Frame.NONE, "+1 where B lies left of the line from P to S, -1 right of it")

# statics
ACTUATORS = Port(
    "actuator_forces",
    (2,),
    Unit.NEWTON,
    Frame.JOINT,
    "forces of the actuators, positive where they do work at positive rates",
    _STACKED,
)
WRENCH = Port(
    "wrench",
    (3,),
    Unit.WRENCH,
    Frame.BASE,
    "F of (5.9): force and moment about P that the right jaw applies to its environment",
)
LOAD = Port(
    "loads",
    (4,),
    Unit.WRENCH,
    Frame.BASE,
    "F_n of (5.36): force on the environment, and moments about B by the right and by the left jaw",
    labels=("f_x", "f_y", "m_r", "m_l"),
)
END_FORCE = Port(
    "end_force", (2,), Unit.NEWTON, Frame.BASE, "force of the sub-leg on its jaw, at P or S", _STACKED
)
INTERNAL = Port(
    "internal_force",
    (),
    Unit.NEWTON,
    Frame.NONE,
    "force with which the sub-legs pull P and S together, which adds to the least forces",
)

# the object
CONTACT = Port(
    "contacts", (2,), Unit.METRE, Frame.JOINT, "from B to the contact, in the jaw's frame", _STACKED
)
FACE = Port(
    "faces",
    (),
    Unit.RADIAN,
    Frame.JOINT,
    "direction of the normal of the jaw's face, into the object, from the jaw's x axis",
    _STACKED,
)
MASS_CENTRE = Port(
    "mass_centre",
    (2,),
    Unit.METRE,
    Frame.JOINT,
    "from B to the object's mass centre, in the right jaw's frame",
)
WEIGHT = Port("weight", (2,), Unit.NEWTON, Frame.BASE, "of the object, m g")
SENSOR = Port(
    "sensor",
    (2, 2),
    Unit.NONE,
    Frame.JOINT,
    "what is measured: 1 for the normal or the parallel force of the right or the left jaw, 0 for the others",
    labels=("right", "left"),
)
MEASURED = Port("measured_force", (), Unit.NEWTON, Frame.JOINT, "the force that the sensor measures")
FRICTION = Port("friction", (), Unit.NONE, Frame.NONE, "coefficient of friction, not negative")
CONTACT_FORCES = Port(
    "contact_forces",
    (2, 2),
    Unit.NEWTON,
    Frame.JOINT,
    "[f_o, f_p] that each jaw applies to the object: along the normal n of its face, and along E n",
    labels=("right", "left"),
)
MARGINS = Port(
    "friction_margins",
    (2,),
    Unit.MIXED,
    Frame.NONE,
    "(mu f_o)^2 - f_p^2 of each contact (N^2): negative where it slips",
    labels=("right", "left"),
)
DETERMINANT = Port(
    "determinant",
    (),
    Unit.METRE,
    Frame.NONE,
    "c . h, the determinant of the equilibrium's equations but for its sign: the object's width, or minus "
    "that, where a normal force is measured",
)
WIDTHS = Port(
    "widths",
    (2,),
    Unit.METRE,
    Frame.NONE,
    "how far the other jaw's contact lies before each jaw's face: negative where the jaws overlap",
    labels=("right", "left"),
)
PULLS = Port(
    "pulls",
    (2,),
    Unit.NEWTON,
    Frame.JOINT,
    "part of the weight along the normal of each jaw's face: positive where it pulls the object away",
    labels=("right", "left"),
)
