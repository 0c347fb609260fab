"""By how much redundant links are longer or shorter than they are, at a pose that a kernel gives."""

from __future__ import annotations

from typing import Any

from krhpr.validation.arithmetic import BALLS
from krhpr.validation.configurations import Configuration
from krhpr.validation.linear import apply, dot, matrix, minus, plus
from krhpr.validation.subject import Outputs


def squared_misfits(here: Configuration, pose: Outputs) -> list[Any]:
    """|p + Q b_i - s_i|^2 - l_i^2, from the end points in the base frame."""
    d = 2 if here.subject.planar else 3
    ties = here.subject.ties(here.geometry, BALLS)
    if here.subject.planar:
        cosine, sine = pose["phi"][0].cos(), pose["phi"][0].sin()
        Q = [[cosine, -sine], [sine, cosine]]
    else:
        Q = matrix(pose["Q"], 3)
    found = []
    for anchor, s, length in zip(
        matrix(ties["anchor"], 2), matrix(here.values["s"], d), ties["length"], strict=True
    ):
        link = minus(plus(pose["p"], apply([row[:2] for row in Q], anchor)), s)
        found.append(dot(link, link) - length * length)
    return found
