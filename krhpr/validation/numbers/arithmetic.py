"""What an evaluator needs to know of a number type."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from krhpr.validation.numbers.ball import Ball
from krhpr.validation.numbers.rational import Angle, Exact


@dataclass(frozen=True)
class Arithmetic:
    """What an evaluator needs to know of a number type.

    `real` makes a number from an int, Fraction or finite float, by its exact value.  `pi` is the value of
    M_PI and np.pi.  `fixed` says that numbers do not depend on a precision in force, so that constants may be
    converted once.
    """

    name: str
    real: Callable[[Any], Any]
    pi: Callable[[], Any]
    fixed: bool = True

    def lift(self, value: Any) -> Any:
        """`value` as a number of this type if it is a plain one; not-a-number and infinities stay floats."""
        if isinstance(value, float) and not math.isfinite(value):
            return float(value)
        if isinstance(value, Exact | Angle | Ball):
            return value
        return self.real(value)


FLOAT = Arithmetic("float", float, lambda: math.pi)
EXACT = Arithmetic("exact", Exact, Angle.half_turn)
BALL = Arithmetic("ball", Ball, Ball.pi, fixed=False)
