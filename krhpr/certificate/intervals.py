"""The interval test, for factors that are a constant plus a sinusoid of each angle.

The arc of the unit circle from low to high, a quarter turn at most, lies in the triangle of its ends and
the point where the tangents at its ends meet.  The factor is affine in (cos, sin) of each angle, so that in
a cell it lies between the least and the largest of its 27 values at such points.  What a value may be off
by rounding is subtracted.  Cells in which that does not settle the sign are halved along their longest
edge.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from krhpr.certificate.answer import Finding, Method, Verdict
from krhpr.certificate.boxes import LEGS, Box, triple
from krhpr.certificate.factors import Factor, Floats
from krhpr.certificate.points import proven_bound, vanishing_point

CELLS = 300_000
"""Cells that are looked at before the test gives up."""

TIGHT = 0.02
"""How far the bound may stay below the smallest value found, relative to it."""

_QUARTER = np.pi / 2


@dataclass(frozen=True)
class _Cells:
    """Many cells: their bounds (n, 3)."""

    low: Floats
    high: Floats

    def __len__(self) -> int:
        return len(self.low)

    def chosen(self, which: Floats) -> _Cells:
        return _Cells(self.low[which], self.high[which])

    def halved(self) -> _Cells:
        """Each cell as two, cut across its longest edge."""
        rows, longest = np.arange(len(self)), np.argmax(self.high - self.low, axis=1)
        middle = (self.low[rows, longest] + self.high[rows, longest]) / 2
        left_high, right_low = self.high.copy(), self.low.copy()
        left_high[rows, longest], right_low[rows, longest] = middle, middle
        return _Cells(np.concatenate([self.low, right_low]), np.concatenate([left_high, self.high]))


def interval_test(factor: Factor, box: Box, sign: int, cells: int = CELLS) -> Finding:
    """What enclosures prove of a factor that has the given sign at the centre (+1 or -1).

    The box is taken as closed: an open box whose boundary alone is singular is undecided.
    """

    def finding(verdict: Verdict, **more: object) -> Finding:
        margin_sign = sign if factor.margin > 0 else -sign
        return Finding(factor.name, verdict, Method.INTERVALS, margin_sign, **more)  # type: ignore[arg-type]

    slack = _slack(factor)
    active = _quartered(box)
    smallest, settled, seen = float(sign * factor.near(np.array(box.centre))), np.inf, 0
    while True:
        values = sign * _hull(factor, active)
        seen += len(active)
        lower = values.min(axis=(1, 2, 3)) - slack
        at_vertices = values[:, ::2, ::2, ::2].reshape(len(active), -1)
        smallest = min(smallest, float(at_vertices.min()))
        if smallest < -slack:
            cell, vertex = divmod(int(at_vertices.argmin()), 2**LEGS)
            ends = (active.low[cell], active.high[cell])
            worst = triple([ends[vertex >> (LEGS - 1 - leg) & 1][leg] for leg in range(LEGS)])
            return finding(Verdict.SINGULAR, point=vanishing_point(factor, box.centre, worst))
        open_cells = lower <= max((1 - TIGHT) * smallest - 2 * slack, 0.0)
        settled = min(settled, float(lower[~open_cells].min(initial=np.inf)))
        if not open_cells.any():
            return finding(Verdict.FREE, bound=proven_bound(factor, settled))
        least = float(lower[open_cells].min())
        active, lower = active.chosen(open_cells), lower[open_cells]
        tiny = float((active.high - active.low).max()) < 1e-9
        if tiny or seen + 2 * len(active) > cells:
            if min(settled, least) > 0:
                return finding(Verdict.FREE, bound=proven_bound(factor, min(settled, least)))
            place = int(lower.argmin())
            cell_left = Box(triple(active.low[place].tolist()), triple(active.high[place].tolist()))
            return finding(Verdict.UNDECIDED, cell=cell_left)
        active = active.halved()


def _slack(factor: Factor) -> float:
    """More than a value of `_hull` can be off.

    Sines and cosines are within 2^-47 of what they stand for: a unit or two of the library's, and NOMINAL
    times two turns.  Basis values are at most sqrt(2) (where the tangents of a quarter turn meet) and
    within 2^-46. Products and sums add some thirty roundings.  Together it is below 2e-13 of the sum of the
    coefficients' absolute values, and 27 sqrt(2)^3 < 80 times what the coefficients themselves are off.
    """
    return 2e-13 * float(np.abs(factor.rounded).sum()) + 80 * factor.rounding


def _quartered(box: Box) -> _Cells:
    """The box as cells of at most a quarter turn."""
    edges = []
    for low, high in zip(box.low, box.high, strict=True):
        cuts = np.linspace(low, high, max(1, int(np.ceil((high - low) / _QUARTER * (1 + 1e-12)))) + 1)
        cuts[0], cuts[-1] = low, high
        edges.append(cuts)
    lows, highs = (_grid([edge[part] for edge in edges]) for part in (slice(None, -1), slice(1, None)))
    return _Cells(lows, highs)


def _grid(edges: list[Floats]) -> Floats:
    """Every combination of three lists' numbers, a row for each."""
    return np.stack(np.meshgrid(*edges, indexing="ij"), axis=-1).reshape(-1, LEGS)


def _hull(factor: Factor, cells: _Cells) -> Floats:
    """Values (n, 3, 3, 3) at the ends of each arc and, in the middle place, where its tangents meet."""
    first, last = factor.bases(cells.low), factor.bases(cells.high)
    meet = (first + last) / (1 + np.cos(cells.high - cells.low))[..., np.newaxis]
    meet[..., 0] = 1.0
    points = np.stack([first, meet, last], axis=2)  # (n, leg, point, basis)
    value: Floats = np.einsum("npa,abc->npbc", points[:, 0], factor.rounded)
    value = np.einsum("nqb,npbc->npqc", points[:, 1], value)
    value = np.einsum("nrc,npqc->npqr", points[:, 2], value)
    return value
