"""Running the command line inside the tests' process."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass


@dataclass(frozen=True)
class Result:
    """What one command came to."""

    code: int
    out: str
    err: str


Cli = Callable[..., Result]
"""`cli("eval", "planar_rr_a", "inverse", stdin="...")`."""
