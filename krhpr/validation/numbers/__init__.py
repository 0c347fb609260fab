"""Numbers for running printed code without rounding: rationals, rational angles and 300-bit balls.

A printed kernel equals its derivation if both give the same numbers, and only arithmetic without rounding can
say "the same".  Three types behave like floats through the ordinary operators and through the methods that
NumPy calls on the elements of object arrays (`x.sqrt()`, `x.sin()`, `y.arctan2(x)`, ...):

`Exact`   a rational number; roots exist only where they are rational.
`Angle`   an angle known by its rational cosine and sine; sums, differences and integer multiples are exact.
`Ball`    a real number enclosed by an interval, for roots, arctangents and decimal constants.

None of them converts to `float` by itself (there is no `__float__`), so that a float array, `math.sqrt` or
`float(...)` in the code under test raises instead of rounding silently.  Not-a-number does not exist: what
has no value raises.  `Arithmetic` bundles what an evaluator needs to know about a type; the functions
(`sqrt`, `divide`, ...) apply to these types and, with the semantics of C, to floats.
"""

from krhpr.validation.numbers.arithmetic import BALL, EXACT, FLOAT, Arithmetic
from krhpr.validation.numbers.ball import Ball, ball_precision
from krhpr.validation.numbers.errors import ExactError, NotRational, Undecidable, Undefined
from krhpr.validation.numbers.functions import (
    arctan2,
    cos,
    divide,
    fabs,
    floor,
    fmax,
    fmin,
    hypot,
    isfinite,
    isnan,
    same,
    sin,
    sqrt,
)
from krhpr.validation.numbers.rational import Angle, Exact

__all__ = [
    "BALL",
    "EXACT",
    "FLOAT",
    "Angle",
    "Arithmetic",
    "Ball",
    "Exact",
    "ExactError",
    "NotRational",
    "Undecidable",
    "Undefined",
    "arctan2",
    "ball_precision",
    "cos",
    "divide",
    "fabs",
    "floor",
    "fmax",
    "fmin",
    "hypot",
    "isfinite",
    "isnan",
    "same",
    "sin",
    "sqrt",
]
