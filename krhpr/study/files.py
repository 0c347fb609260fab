"""Figures of studies as files."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any


def save_figures(figures: Mapping[str, Any], folder: Path, ending: str = ".png") -> list[Path]:
    """Write figures to `<folder>/<name><ending>`; no date gets into them."""
    import matplotlib
    from matplotlib import pyplot

    matplotlib.use("Agg")
    folder.mkdir(parents=True, exist_ok=True)
    metadata: dict[str, Any] = {"Software": None} if ending == ".png" else {"Date": None, "Creator": None}
    paths = []
    for name, figure in figures.items():
        path = folder / f"{name}{ending}"
        try:
            figure.savefig(path, dpi=150, metadata=metadata)
        finally:
            pyplot.close(figure)
        paths.append(path)
    return paths
