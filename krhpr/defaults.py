"""What functions take for inputs that are numbers or signs of the method, where a language has defaults."""

from __future__ import annotations

from collections.abc import Mapping

NUMBERS: Mapping[str, tuple[float, ...]] = {
    "tolerance": (0.02,),
    "weights": (1000.0, 1000.0, 1000.0),
    "characteristic_length": (1.0,),
}
"""By how much encoders may contradict end points (m); least squares in which a millimetre counts as much
as a thousandth of the orientation's orthonormality; and what a slide moves that counts as much as a radian.
"""

SIGNS = ("side", "turned")
"""Inputs that are +1 or -1, and +1 unless given."""
