"""The derivation is derived, not copied: closed forms against constraint equations, differentiated
independently.

Proofs are made at random points with exact coordinates.  An identity of rational functions that holds at
one random rational point holds everywhere, but for a chance that the next points make vanish.
"""

from krhpr.validation.outcome import Runner
from krhpr.validation.proofs import (
    approaches,
    assemblies,
    encoders,
    forward,
    indices,
    links,
    platforms,
    robots,
    singularities,
    statics,
    sublegs,
)

RUNNERS: dict[str, Runner] = {
    **sublegs.RUNNERS,
    **assemblies.RUNNERS,
    **platforms.RUNNERS,
    **singularities.RUNNERS,
    **robots.RUNNERS,
    **statics.RUNNERS,
    **forward.RUNNERS,
    **approaches.RUNNERS,
    **encoders.RUNNERS,
    **indices.RUNNERS,
    **links.RUNNERS,
}
"""The code of each proof by its name in the plan."""
