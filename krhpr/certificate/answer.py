"""What a certificate says."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

from krhpr.certificate.boxes import Box, Triple


class Verdict(StrEnum):
    """What is known of a box."""

    FREE = "free"
    SINGULAR = "singular"
    UNDECIDED = "undecided"


class Method(StrEnum):
    """How it is known."""

    VERTICES = "vertex test"
    """The factor is a positive combination of its values at the box's eight vertices."""
    CLOSED_FORM = "closed form"
    """(1.35) for any lengths: S_1, S_2, S_3 cannot be collinear, whatever the redundant angles are."""
    INTERVALS = "interval test"
    """Branch and bound with enclosures that hold in spite of rounding."""


@dataclass(frozen=True)
class Finding:
    """What is known of one factor of det J in a box.

    `bound` is proven: the absolute value of the factor's margin (as `singularity` gives it) is nowhere in
    the box below it.  It is zero where the factor vanishes on the box's boundary, or is not bounded
    further. `sign` is the margin's at the centre.  `point` is where the factor vanishes, `cell` the
    smallest box, or the point of its boundary, that could not be decided.
    """

    factor: str
    verdict: Verdict
    method: Method
    sign: int
    bound: float = 0.0
    point: Triple | None = None
    cell: Box | None = None


@dataclass(frozen=True)
class Certificate:
    """What is known of a box of redundant coordinates: of both factors of det J, or of the planar one."""

    robot: str
    box: Box
    findings: tuple[Finding, ...]

    @property
    def verdict(self) -> Verdict:
        """Free if every factor is; singular if one vanishes somewhere."""
        verdicts = {finding.verdict for finding in self.findings}
        if Verdict.SINGULAR in verdicts:
            return Verdict.SINGULAR
        return Verdict.UNDECIDED if Verdict.UNDECIDED in verdicts else Verdict.FREE

    @property
    def free(self) -> bool:
        """Whether no type II singularity lies in the box: proven."""
        return self.verdict is Verdict.FREE

    @property
    def point(self) -> Triple | None:
        """A singular point in the box, where one is known."""
        points = (finding.point for finding in self.findings if finding.verdict is Verdict.SINGULAR)
        return next(points, None)
