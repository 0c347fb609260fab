"""What is computed: names, shapes and forms of the workloads, and the C prototype of every contender."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from typing import Any

from benchmarks import formulas, forward

Form = Callable[..., tuple[list[Any], ...]]
Reference = Callable[[list[Any]], list[Any]]


@dataclass(frozen=True)
class Array:
    """One argument: its name and its shape, row-major in C."""

    name: str
    shape: tuple[int, ...]

    @property
    def size(self) -> int:
        return math.prod(self.shape)


@dataclass(frozen=True)
class Workload:
    """A function that all contenders compute from the same inputs, in any of the given mathematical forms."""

    key: str
    title: str
    inputs: tuple[Array, ...]
    outputs: tuple[Array, ...]
    forms: Mapping[str, Form]
    angles: bool = False  # outputs are compared modulo 2 pi
    reference: Reference | None = None  # where no form says what is right
    tolerance: float = 1e-12

    @property
    def symbol(self) -> str:
        """Name of the C function that a contender's glue defines."""
        return f"contender_{self.key}"

    def prototype(self, name: str | None = None, *, restrict: bool = False) -> str:
        """``void contender_w1(const double *p, ..., double *K)``, without the semicolon."""
        qualifier = "restrict " if restrict else ""
        arguments = [f"const double *{qualifier}{a.name}" for a in self.inputs]
        arguments += [f"double *{qualifier}{a.name}" for a in self.outputs]
        return f"void {name or self.symbol}({', '.join(arguments)})"

    def batch_prototype(self) -> str:
        """The optional batch twin: the number of poses, then arrays in the contender's declared layout."""
        return self.prototype(f"{self.symbol}_batch", restrict=True).replace("(", "(long n, ", 1)


P, Q = Array("p", (3,)), Array("Q", (3, 3))
THETA, S = Array("theta", (3, 3)), Array("s", (3, 3))

WORKLOADS: dict[str, Workload] = {
    workload.key: workload
    for workload in (
        Workload(
            "w1",
            "J and K from pose and joint angles (3-RRRSR)",
            (P, Q, THETA),
            (Array("J", (6, 6)), Array("K", (3, 2, 3))),
            {
                "plane": partial(formulas.jacobians, in_plane=True),
                "vector": partial(formulas.jacobians, in_plane=False),
            },
        ),
        Workload(
            "w2",
            "inverse kinematics, one working mode (3-RRRSR)",
            (P, Q, Array("beta", (3,))),
            (THETA,),
            {
                "atan2": partial(formulas.inverse, use_acos=False),
                "acos": partial(formulas.inverse, use_acos=True),
            },
            angles=True,
        ),
        Workload(
            "w3",
            "every real solution of the forward kinematics from the end points",
            (S,),
            (
                Array("count", (1,)),
                Array("p_all", (6, 3)),
                Array("Q_all", (6, 3, 3)),
                Array("beta_all", (6, 3)),
            ),
            {},
            reference=forward.every_solution,
            tolerance=1e-5,  # numpy.roots, next to double roots
        ),
        Workload(
            "w4",
            "one Newton step of the forward kinematics from a pose nearby",
            (S, P, Q),
            (Array("p_next", (3,)), Array("Q_next", (3, 3))),
            {"planar": forward.planar_step, "nine": forward.nine_step},
            tolerance=1e-4,
        ),
        Workload(
            "w5",
            "M_i of three hybrid legs R(RR-RRR)",
            (S, THETA),
            (Array("M", (3, 3, 3)),),
            {
                "plane": partial(formulas.hybrid_leg_jacobians, in_plane=True),
                "vector": partial(formulas.hybrid_leg_jacobians, in_plane=False),
            },
        ),
    )
}
