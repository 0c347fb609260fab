"""What the thesis says, and whether it came out."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Claim:
    """A sentence of the thesis, and whether it came out."""

    text: str
    holds: bool
