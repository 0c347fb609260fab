"""Draw the pictures of the documentation from the generated functions.

    python docs/pictures/make.py [FOLDER]      (`make docs` does it, into docs/pictures)

The pictures are a function of the code alone; their bytes depend on the version of Matplotlib.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from io import BytesIO
from pathlib import Path

import conventions
import designs
import grasping
import matplotlib
import modes
import robots
import singularities
import workspaces
from matplotlib import pyplot
from matplotlib.figure import Figure
from PIL import Image

from krhpr.study.dexterity import dexterity
from krhpr.study.figures import dexterity_figures, redundancy_figures
from krhpr.study.forward_accuracy import forward_accuracy
from krhpr.study.grasp_control import grasp_control
from krhpr.study.grasp_control_figures import grasp_control_figures
from krhpr.study.histograms import accuracy_figures
from krhpr.study.redundancy import redundancy

matplotlib.use("Agg")

FOLDER = Path(__file__).resolve().parent
DOTS_PER_INCH = 150
COLOURS_KEPT = 96

STYLE = {
    "font.family": "DejaVu Sans",
    "mathtext.fontset": "dejavusans",
    "font.size": 10,
    "figure.facecolor": "white",
    "savefig.facecolor": "white",
}

STUDIES: dict[str, Callable[[], dict[str, Figure]]] = {
    "accuracy": lambda: accuracy_figures(forward_accuracy()),
    "dexterity": lambda: dexterity_figures(dexterity()),
    "redundancy": lambda: redundancy_figures(redundancy()),
    "grasp_control": lambda: grasp_control_figures(grasp_control()),
}
"""Figures of `krhpr study`, several of each: 3.8 to 3.11, 1.10 to 1.12, 4.3 and 4.4, 5.7 and 5.9 to 5.11."""

PICTURES: dict[str, Callable[[], Figure]] = {
    "flagship": robots.flagship,
    "planar": robots.planar,
    "conventions": conventions.conventions,
    "working_modes": modes.working_modes,
    "assembly_modes": modes.assembly_modes,
    "arrangements": conventions.arrangements,
    "sub-legs": robots.sub_legs,
    "delta": robots.delta,
    "type_2_margin": singularities.type_2_margin,
    "singularity_locus": singularities.singularity_locus,
    "grasping": grasping.grasping,
    "grasping_study": grasping.grasping_study,
    "grasping_capability": grasping.grasping_capability,
    **workspaces.PICTURES,
    **designs.PICTURES,
}


def save(figure: Figure, path: Path) -> None:
    """Write a figure as a small PNG: few colours, no metadata."""
    buffer = BytesIO()
    figure.savefig(buffer, format="png", dpi=DOTS_PER_INCH, metadata={"Software": None})
    pyplot.close(figure)
    image = Image.open(buffer).convert("RGB").quantize(COLOURS_KEPT, dither=Image.Dither.NONE)
    image.save(path, optimize=True)


def main(folder: Path = FOLDER) -> None:
    """Draw every picture."""
    folder.mkdir(parents=True, exist_ok=True)
    with matplotlib.rc_context(STYLE):
        for name, picture in PICTURES.items():
            save(picture(), folder / f"{name}.png")
        for figures in STUDIES.values():
            for name, figure in figures().items():
                save(figure, folder / f"{name}.png")


if __name__ == "__main__":
    main(*map(Path, sys.argv[1:2]))
