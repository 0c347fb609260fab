"""The gripper of arrangements (b) and (c): jaws on the three slides (Section 5.3).

Jaw i belongs to the slider with S_i.  Its flat face is normal to t_i, at the distance j_i from S_i against
t_i; so it is the line t_i^T x = delta_i of the platform's plane with delta_i = d_i + t_i^T m_i - j_i, and the
jaw closes as d_i falls.  A round object of radius r with its centre in q touches all faces where

    t_i^T q + r = delta_i, i = 1, 2, 3.

With sum lambda_i t_i = 0 that is r = sum lambda_i delta_i / sum lambda_i: three slides are an opening and the
two coordinates of its centre.  Forces that press without friction on the object in the shares
lambda_i / sum lambda_i are in equilibrium; where one is negative the jaws do not surround anything.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import sympy as sp

from krhpr.codegen.kernel import Frame, Kernel, Layout, Port, Unit
from krhpr.codegen.writer import KernelWriter
from krhpr.derivations.platforms.forward import stacked
from krhpr.derivations.platforms.kernels import PlatformPorts, all_legs
from krhpr.derivations.vectors import dependence, dot, lines_meet

if TYPE_CHECKING:
    from krhpr.derivations.platforms.slides import SlidePlatform

SLIDE = stacked("slide", (2,), Unit.NONE, "t_i, along the slide")
START = stacked("start", (), Unit.METRE, "where d_i = 0, along t_i")
JAWS = Port(
    "jaws",
    (),
    Unit.METRE,
    Frame.JOINT,
    "how far the jaw's face is from S_i, against the slide's direction t_i",
    Layout.STACKED,
)
OPENING = Port(
    "opening",
    (),
    Unit.METRE,
    Frame.PLATFORM,
    "diameter of the round object that touches all three jaws; negative where they overlap",
)
CENTRE = Port("centre", (2,), Unit.METRE, Frame.PLATFORM, "its centre in the platform's plane")
SHARES = Port(
    "shares",
    (3,),
    Unit.NONE,
    Frame.NONE,
    "shares of the legs in forces that press on it in equilibrium; all positive where jaws surround it",
)


def opening_kernels(plate: SlidePlatform) -> tuple[Kernel, ...]:
    """The kernels of the gripper of an arrangement."""
    return _opening(plate), _redundant_of_opening(plate)


def _opening(plate: SlidePlatform) -> Kernel:
    k = KernelWriter("opening", "The opening of the gripper, and where its centre is.", "5.1, 5.3")
    slides = all_legs(k, SLIDE)
    redundant, jaws = all_legs(k, PlatformPorts(plate).redundant), all_legs(k, JAWS)
    starts = all_legs(k, START) if plate.offset else [sp.Integer(0)] * 3
    faces = [
        k.let(f"delta_{i + 1}", redundant[i] + starts[i] - jaws[i], "the jaw's face along t_i")
        for i in range(3)
    ]
    weights = [k.let(f"lambda_{i + 1}", w) for i, w in enumerate(dependence(slides))]
    total = k.let("total", sum(weights, sp.Integer(0)))
    shares = [k.let(f"share_{i + 1}", w / total) for i, w in enumerate(weights)]
    radius = k.let("r", sum(w * face for w, face in zip(shares, faces, strict=True)), "half the opening")
    right = [face - radius for face in faces]
    k.add_output(OPENING, 2 * radius)
    k.add_output(CENTRE, lines_meet(slides, right, weights))
    k.add_output(SHARES, shares)
    return k.kernel()


def _redundant_of_opening(plate: SlidePlatform) -> Kernel:
    k = KernelWriter(
        "redundant_of_opening",
        "The slide at which a jaw touches a round object.",
        "5.1, 5.3",
        plate.geometry(),
    )
    opening, centre, jaw = (k.add_input(port) for port in (OPENING, CENTRE, JAWS))
    face = opening / 2 + dot(k.g.t, centre)
    start = dot(k.g.m, k.g.t) if plate.offset else sp.Integer(0)
    k.add_output(PlatformPorts(plate).redundant, face + jaw - start)
    return k.kernel()
