"""Pictures of docs/design.md: Section 4.2, and the front that `krhpr study design` found.

    python docs/pictures/designs.py build/study

keeps what a run of the study found: its designs beside this file, the best in examples/designs.
"""

from __future__ import annotations

import json
import shutil
import sys
from collections.abc import Callable
from functools import cache, partial
from pathlib import Path
from types import MappingProxyType
from typing import Any

from krhpr.design import Evaluation, Objective
from krhpr.study.design_pictures import enlargement_figures, front_figure
from krhpr.study.enlargement import enlargement

FOUND = Path(__file__).with_suffix(".json")
FILES = Path(__file__).resolve().parents[2] / "examples" / "designs"
RAYS = 120
DIGITS = 5
KEPT = (Objective.VOLUME, Objective.ETA_2, Objective.BOX)


@cache
def of_the_section() -> dict[str, Any]:
    return enlargement_figures(enlargement(rays=RAYS))


def section(name: str) -> Any:
    return of_the_section()[name]


def front() -> Any:
    """What the search found, from the file."""
    found = json.loads(FOUND.read_text("utf-8"))
    designs = [_design(row) for row in found["designs"]]
    marked = {name: _design(row) for name, row in found["best"].items()}
    return front_figure(designs, KEPT, marked)["design_front"]


def _design(row: list[float]) -> Evaluation:
    return Evaluation((), 0.0, "", MappingProxyType(dict(zip(KEPT, row, strict=True))))


def keep(folder: Path) -> None:
    """Keep the results of a run of the study."""
    found = json.loads((folder / "design.json").read_text("utf-8"))

    def row(results: dict[str, float]) -> list[float]:
        return [float(f"{results[name]:.{DIGITS}g}") for name in KEPT]

    best = {"the robot itself" if name == "own" else name: one for name, one in found["best"].items()}
    made = {
        "settings": found["settings"],
        "best": {name: row(one["design"]["results"]) for name, one in best.items()},
        "designs": [row(one) for one in found["designs"]],
    }
    text = json.dumps(made).replace("], [", "],\n[").replace('"designs": [[', '"designs": [\n[')
    FOUND.write_text(text + "\n", "utf-8")
    FILES.mkdir(exist_ok=True)
    for path in sorted((folder / "designs").glob("*.yaml")):
        shutil.copy(path, FILES / path.name)


PICTURES: dict[str, Callable[[], Any]] = {
    "design_families": partial(section, "design_families"),
    "design_slices": partial(section, "design_slices"),
    "design_front": front,
}

if __name__ == "__main__":
    keep(Path(sys.argv[1]))
