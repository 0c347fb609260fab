"""Pictures of docs/workspace.md: those of the study, and what redundant coordinates add."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache, partial
from typing import Any

import numpy as np
from matplotlib import pyplot
from matplotlib.figure import Figure

from krhpr import workspace
from krhpr.study.workspace import WorkspaceStudy, workspace_study
from krhpr.study.workspace_pictures import PICTURES as OF_THE_STUDY

COARSER = 2
"""Steps of 2 mm and 2 degrees: at this size pictures look as with 1."""
CONSTANT = {60: "#4477aa", 97: "#228833", 140: "#cc7711"}
FREE = np.radians(np.arange(35, 146, 5))


@cache
def study() -> WorkspaceStudy:
    return workspace_study(coarser=COARSER)


def of_the_study(name: str) -> Any:
    return OF_THE_STUDY[name](study())


def redundancy() -> Figure:
    """The section without torsion and a layer, for constant angles and for the best ones."""
    robot = study().robot
    figure = pyplot.figure(figsize=(9.6, 4.6), layout="constrained")
    tilt: Any = figure.add_subplot(1, 2, 1, projection="polar")
    layer = figure.add_subplot(1, 2, 2)
    chosen: dict[str, tuple[Any, str]] = {
        f"{beta}°": (workspace.constant(np.radians(beta)), colour) for beta, colour in CONSTANT.items()
    }
    chosen["any"] = (workspace.free(FREE, alike=True, best="first"), "#222222")
    for name, (angles, colour) in chosen.items():
        turned = workspace.orientational(robot, redundancy=angles, torsions=[0.0], rays=180)
        theta = np.append(turned.axis("theta_c"), 2 * np.pi)
        r = np.degrees(turned["boundary"][0])
        tilt.plot(theta, np.append(r, r[0]), color=colour, linewidth=1.5, label=name)
        moved = workspace.translational(robot, [0.35], redundancy=angles, rays=180, farthest=0.8, step=0.002)
        r = 1e3 * moved["boundary"][0]
        layer.plot(
            np.append(r, r[0]) * np.cos(theta),
            np.append(r, r[0]) * np.sin(theta),
            color=colour,
            linewidth=1.5,
        )
    tilt.set_rticks([45, 90, 135, 180], ["45°", "90°", "135°", "180°"], fontsize=8)
    tilt.set_title("tilt without torsion", fontsize=10)
    tilt.legend(
        title=r"$\beta_i$", frameon=False, fontsize=8, loc="lower left", bbox_to_anchor=(-0.16, -0.12)
    )
    layer.set(aspect="equal", xlabel="x (mm)", ylabel="y (mm)")
    layer.set_title("layer z = 350 mm", fontsize=10)
    layer.spines[["top", "right"]].set_visible(False)
    return figure


PICTURES: dict[str, Callable[[], Any]] = {
    **{name: partial(of_the_study, name) for name in OF_THE_STUDY},
    "workspace_redundancy": redundancy,
}
