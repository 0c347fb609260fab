"""Plants and setups of the tests of control: the prototype, and variants of it."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from math import inf, radians

import numpy as np
from numpy.typing import NDArray

from krhpr.control.controller import Wanted
from krhpr.control.parameters import PROTOTYPE as CONTROL
from krhpr.control.parameters import ControlSetup
from krhpr.control.plant import Plant
from krhpr.control.simulation import Reference
from krhpr.study.grasp import PROTOTYPE, Held, Setup

Floats = NDArray[np.float64]

STRUTS = replace(
    PROTOTYPE,
    robot="planar_grasp_rpr",
    geometry={"l_j": (0.05, 0.045)},
    pivot=(0.01, 0.12),
    phi=radians(40),
    beta=radians(135),
)
"""The other robot, with jaws of two lengths and an angle that is not right between them."""


def ideal(control: ControlSetup = CONTROL) -> ControlSetup:
    """Gears without friction, exact encoders, and no noise."""
    return replace(
        control,
        friction=replace(control.friction, torque=0.0, load_share=0.0, viscous=0.0),
        sensors=replace(control.sensors, encoder_counts=inf, force_noise=0.0),
    )


def weightless(setup: Setup = PROTOTYPE) -> Setup:
    """An object without weight."""
    return replace(setup, held=replace(setup.held, weight=0.0))


@cache
def plant() -> Plant:
    """The prototype's, made once."""
    return Plant(PROTOTYPE, CONTROL)


def heavy(weight: float) -> Held:
    """The prototype's object with another weight."""
    return replace(PROTOTYPE.held, weight=weight)


def pose(setup: Setup) -> tuple[Floats, Floats]:
    """Pivot and angles."""
    return np.array(setup.pivot), np.array([setup.phi, setup.beta])


def risen(setup: Setup, force: float, *, begin: float = 0.1, rise: float = 0.3) -> Reference:
    """At the pose, with a grasping force that rises from zero."""
    pivot, angles = pose(setup)
    return lambda t: Wanted(pivot, angles, force * float(np.clip((t - begin) / rise, 0.0, 1.0)))
