"""How the derivation is evaluated on each kind of number."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from krhpr.codegen.evaluate import METHODS, Arithmetic
from krhpr.codegen.graph import Op
from krhpr.validation.numbers import Ball, Exact, fmax, fmin

_METHODS: Mapping[Op, Callable[..., Any]] = {**METHODS.functions, Op.MIN: fmin, Op.MAX: fmax}

RATIONAL = Arithmetic(Exact, _METHODS)
"""Rational numbers and angles, without rounding; Taylor series of them too."""

BALLS = Arithmetic(Ball, _METHODS)
"""Enclosures, at the precision in force."""

ARRAYS = Arithmetic(
    float,
    {
        Op.SQRT: np.sqrt,
        Op.SIN: np.sin,
        Op.COS: np.cos,
        Op.ATAN2: np.arctan2,
        Op.ABS: np.abs,
        Op.MIN: np.fmin,
        Op.MAX: np.fmax,
    },
)
"""Arrays of doubles: a whole batch at once."""
