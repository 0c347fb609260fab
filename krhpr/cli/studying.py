"""What every study of `krhpr study` does with its findings: files, and claims with an exit code."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import Any

from krhpr.cli.common import Exit
from krhpr.study.claims import Claim
from krhpr.study.files import save_figures


def write(
    folder: Path, name: str, facts: Mapping[str, Any], figures: Callable[[], Mapping[str, Any]]
) -> list[Path]:
    """The numbers as `<name>.json`, and the figures where they can be drawn."""
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / f"{name}.json"
    path.write_text(json.dumps(facts, indent=1) + "\n", encoding="utf-8")
    try:
        return [path, *save_figures(figures(), folder)]
    except ImportError:
        print('no pictures: matplotlib is not installed (pip install "krhpr[plot]")')
        return [path]


def tell(claims: Iterable[Claim]) -> Exit:
    """Print which claims hold; the exit code says whether all do."""
    told = list(claims)
    for claim in told:
        print(f"{'holds' if claim.holds else 'DOES NOT HOLD'}: {claim.text}")
    return Exit.OK if all(claim.holds for claim in told) else Exit.DIFFERENCE
