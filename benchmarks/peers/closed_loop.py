"""The closed-loop model that rigid-body libraries are given: W1 and W2 of the 3-RRRSR as they see it.

Three chains of three revolute joints end at S_i. The platform has six freedoms, and a revolute joint with the
link from B_i to S_i for every leg; the ends of chain and link coincide: a spherical joint. What is left to
those who use such a library is in `rigid_body/closed_loop.h`.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path

from benchmarks import formulas
from benchmarks.robot import L2, L3, L_REDUNDANT, LEGS, R_PLATFORM

FOLDER = Path(__file__).resolve().parent / "rigid_body"
"""The C and C++ that call the libraries."""

HOME = ((0.0, 0.0, 0.35), (1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0), 3 * (math.pi / 2,))
"""The pose in the middle of the samples, and its redundant angles: where Newton's method starts from."""


def home_angles() -> list[float]:
    """The nine joint angles there, in the working mode of the benchmark."""
    p, q, beta = (list(x) for x in HOME)
    (theta,) = formulas.inverse(math, p, q, beta, use_acos=False)
    return [float(x) for x in theta]


def corners() -> list[tuple[float, float]]:
    """B_i in the platform's plane."""
    return [(R_PLATFORM * leg.e_r[0], R_PLATFORM * leg.e_r[1]) for leg in LEGS]


def starts() -> list[tuple[float, float]]:
    """Directions from B_i to S_i in the platform at beta = 0."""
    return [(-leg.e_r[0], -leg.e_r[1]) for leg in LEGS]


def header() -> str:
    """The lengths and frames as C constants. Each leg's base has its x along e_x and its z along e_1."""
    base = [[*leg.e_x, *(-t for t in leg.e_t), *leg.e_1] for leg in LEGS]
    return "\n".join(
        [
            "#define L2 " + repr(L2),
            "#define L3 " + repr(L3),
            "#define L_REDUNDANT " + repr(L_REDUNDANT),
            _table("SHOULDER", [leg.c for leg in LEGS]),
            _table("BASE", base),  # columns of the rotation, one after the other
            _table("CORNER", corners()),
            _table("START", starts()),
            f"__attribute__((unused)) static const double HOME[9] = {_braces(home_angles())};",
            "",
        ]
    )


def _table(name: str, rows: Sequence[Sequence[float]]) -> str:
    values = ", ".join(_braces(row) for row in rows)
    return f"__attribute__((unused)) static const double {name}[{len(rows)}][{len(rows[0])}] = {{{values}}};"


def _braces(values: Sequence[float]) -> str:
    return "{" + ", ".join(repr(float(value)) for value in values) + "}"
