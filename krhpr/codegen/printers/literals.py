"""Decimal literals that show a number exactly."""

from __future__ import annotations

import re
from fractions import Fraction

LONGEST = 1024
"""Beyond this denominator a quotient is easier to read than its digits."""

_TENTH_POWER = re.compile(r"1(0+)")


def decimal(value: Fraction) -> str | None:
    """A short decimal literal that is the number exactly when read as text: 0.375, 1e-48.  None where there
    is none.
    """
    if value.denominator <= LONGEST:
        return repr(float(value)) if Fraction(float(value)) == value else None
    power = _TENTH_POWER.fullmatch(str(value.denominator))
    return None if power is None or value.numerator not in (1, -1) else f"{value.numerator}e-{len(power[1])}"
