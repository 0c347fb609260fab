"""Invariants: what generated functions must satisfy whatever their formulas are.

Closed loops, there-and-back, virtual work, and the symmetries of the problem.  Everything runs on the
functions of one target, at random configurations of a random geometry.
"""

from krhpr.validation.invariants import (
    forward,
    indices,
    jaws,
    passive,
    position,
    singularities,
    statics,
    symmetries,
    velocity,
)
from krhpr.validation.outcome import Runner
from krhpr.validation.paths import nearest_modes

RUNNERS: dict[str, Runner] = {
    **position.RUNNERS,
    **velocity.RUNNERS,
    **statics.RUNNERS,
    **singularities.RUNNERS,
    **indices.RUNNERS,
    **passive.RUNNERS,
    **forward.RUNNERS,
    **symmetries.RUNNERS,
    **jaws.RUNNERS,
    "nearest mode": nearest_modes,
}
"""The code of each check by its name in the plan."""
