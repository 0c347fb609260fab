"""Functions of all number types, and of floats with the semantics of C."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

from krhpr.validation.numbers.ball import DEFAULT_TOLERANCE, Ball
from krhpr.validation.numbers.rational import Angle, Exact


def _call(method: str, operand: Any, *others: Any) -> Any:
    function = getattr(operand, method, None)
    if function is None:
        raise TypeError(f"no {method} of {operand!r} ({type(operand).__name__})")
    return function(*others)


def _matched(a: Any, b: Any) -> tuple[Any, Any]:
    """The operands, a float that meets an exact type being converted to it (raises for infinities)."""
    if isinstance(a, float) and isinstance(b, Exact | Ball):
        return type(b)(a), b
    return a, b


def sqrt(x: Any) -> Any:
    """The square root; for floats as in C."""
    if isinstance(x, float):
        return math.nan if x < 0 else math.sqrt(x)
    return _call("sqrt", x)


def sin(x: Any) -> Any:
    """The sine; for floats as in C."""
    if isinstance(x, float):
        return math.sin(x) if math.isfinite(x) else math.nan
    return _call("sin", x)


def cos(x: Any) -> Any:
    """The cosine; for floats as in C."""
    if isinstance(x, float):
        return math.cos(x) if math.isfinite(x) else math.nan
    return _call("cos", x)


def arctan2(y: Any, x: Any) -> Any:
    """The direction of (x, y); for floats as in C."""
    if isinstance(y, float) and isinstance(x, float):
        return math.atan2(y, x)
    y, x = _matched(y, x)
    return _call("arctan2", y, x)


def hypot(x: Any, y: Any) -> Any:
    """The length of (x, y); for floats as in C, but for the last bit (Python has a hypot of its own)."""
    if isinstance(x, float) and isinstance(y, float):
        return math.hypot(x, y)
    x, y = _matched(x, y)
    return _call("hypot", x, y)


def fabs(x: Any) -> Any:
    """The absolute value."""
    return abs(x)


def floor(x: Any) -> Any:
    """The largest whole number that is not larger; for floats as in C."""
    if isinstance(x, float):
        return float(math.floor(x)) if math.isfinite(x) else x
    return _call("floor", x)


def fmin(x: Any, y: Any) -> Any:
    """The smaller number, ignoring a float that is not a number, as in C."""
    return _extreme("minimum", min, x, y)


def fmax(x: Any, y: Any) -> Any:
    """The larger number, ignoring a float that is not a number, as in C."""
    return _extreme("maximum", max, x, y)


def _extreme(method: str, of_floats: Callable[[float, float], float], x: Any, y: Any) -> Any:
    if isnan(x):
        return y
    if isnan(y):
        return x
    if isinstance(x, float) and isinstance(y, float):
        return of_floats(x, y)
    x, y = _matched(x, y)
    return _call(method, x, y)


def isfinite(x: Any) -> bool:
    """Whether `x` is a finite number: all but two floats are."""
    return not isinstance(x, float) or math.isfinite(x)


def isnan(x: Any) -> bool:
    """Whether `x` is not a number: one float is."""
    return isinstance(x, float) and math.isnan(x)


def divide(x: Any, y: Any) -> Any:
    """The quotient; for floats by IEEE 754, so that x / 0 is infinite or not a number."""
    if isinstance(x, float) and isinstance(y, float) and y == 0:
        if x == 0 or math.isnan(x):
            return math.nan
        return math.copysign(math.inf, x) * math.copysign(1.0, y)
    return x / y


def same(a: Any, b: Any, tolerance: object = DEFAULT_TOLERANCE) -> bool:
    """Whether two results agree: equal rationals, congruent angles, balls certainly within `tolerance`."""
    if isinstance(a, Angle):
        return a.congruent(b)
    if isinstance(b, Angle):
        return b.congruent(a)
    if isinstance(a, Ball):
        return a.close(b, tolerance)
    if isinstance(b, Ball):
        return b.close(a, tolerance)
    if isnan(a) or isnan(b):
        return isnan(a) and isnan(b)
    return bool(a == b)
