"""Where redundant links are at a pose that a kernel gives, and by how much they are off in length."""

from __future__ import annotations

from typing import Any

from krhpr.validation.arithmetic import BALLS
from krhpr.validation.configurations import Configuration
from krhpr.validation.linear import Matrix, apply, dot, matrix, minus, plus
from krhpr.validation.subject import Outputs


def placed(here: Configuration, pose: Outputs, which: int = 0) -> tuple[list[Any], Matrix]:
    """p and Q of a pose, or of one of several."""
    d = 2 if here.subject.planar else 3
    p = pose["p"][d * which : d * which + d]
    if here.subject.planar:
        phi = pose["phi"][which]
        return p, [[phi.cos(), -phi.sin()], [phi.sin(), phi.cos()]]
    return p, matrix(pose["Q"][9 * which : 9 * which + 9], 3)


def squared_lengths(here: Configuration, pose: Outputs, which: int = 0) -> list[Any]:
    """|p + Q b_i - s_i|^2, from the end points in the base frame."""
    p, Q = placed(here, pose, which)
    anchors = matrix(here.subject.ties(here.geometry, BALLS)["anchor"], 2)
    ends = matrix(here.values["s"], len(p))
    links = [
        minus(plus(p, apply([row[:2] for row in Q], anchor)), s)
        for anchor, s in zip(anchors, ends, strict=True)
    ]
    return [dot(link, link) for link in links]


def squared_misfits(here: Configuration, pose: Outputs) -> list[Any]:
    """These less l_i^2."""
    lengths = here.subject.ties(here.geometry, BALLS)["length"]
    squares = squared_lengths(here, pose)
    return [square - length * length for square, length in zip(squares, lengths, strict=True)]
