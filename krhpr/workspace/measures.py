"""Areas and volumes of maps, with what is known of their errors."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from krhpr.errors import WorkspaceError
from krhpr.workspace.axes import Box, Layers, TiltTorsion
from krhpr.workspace.maps import BoundaryMap, GridMap, Workspace

Floats = NDArray[np.float64]

ALL_ROTATIONS = 8 * np.pi**2
"""The volume of all orientations, by the angles of tilt and torsion."""


@dataclass(frozen=True)
class Measure:
    """An area or a volume."""

    value: float
    error: float
    """About how far it may be off, by what every second row, ray or node gives, and the step along rays."""
    unit: str

    def __str__(self) -> str:
        return f"{self.value:.5g} +- {self.error:.2g} {self.unit}"


def areas(made: Workspace) -> Floats:
    """Of the layers of a boundary (m^2), or of its rows: half the integral of the squared boundary over the
    direction, which for tilt is that of pictures in polar coordinates (rad^2)."""
    r = _boundary(made, 0.5)
    return _around(made, r**2 / 2)


def volume(made: Workspace) -> Measure:
    """Of a translational map in m^3, or of an orientational one as a share of all orientations.

    A boundary lies between its last free node and the next, and counts in the middle.  Orientations are
    measured as rotations are: sin(phi) dpsi dtheta_c dphi.

    Raises:
        WorkspaceError: a map with fewer than two layers, or of a grid with fewer than two nodes in a row.
    """
    if min(map(len, made.job.kept)) < 2:
        raise WorkspaceError("a volume takes two values or more of each coordinate of the map")
    if isinstance(made.job, GridMap):
        return _grid_volume(made)
    if isinstance(made.job.family, Layers):
        whole = [_rows(made, _around(made, _boundary(made, share) ** 2 / 2)) for share in (0.0, 0.5, 1.0)]
        coarse = [
            _rows(made, _around(made, _boundary(made, 0.5) ** 2 / 2, rays), layers)
            for layers, rays in _HALVES
        ]
        unit = "m^3"
    else:
        whole = [_rows(made, _around(made, 1 - np.cos(_boundary(made, share)))) for share in (0.0, 0.5, 1.0)]
        coarse = [
            _rows(made, _around(made, 1 - np.cos(_boundary(made, 0.5)), rays), layers)
            for layers, rays in _HALVES
        ]
        whole, coarse = ([value / ALL_ROTATIONS for value in values] for values in (whole, coarse))
        unit = "of all orientations"
    step = (whole[2] - whole[0]) / 2 / np.sqrt(made["boundary"].size)  # where a boundary lies is random
    return Measure(whole[1], float(step + sum(abs(value - whole[1]) for value in coarse)), unit)


_HALVES = ((2, 1), (1, 2))
"""Every second layer, every second ray."""


def _boundary(made: Workspace, share: float) -> Floats:
    """Where the boundary is: so much of a step beyond the last free node; 0 where there is none."""
    if not isinstance(made.job, BoundaryMap):
        raise WorkspaceError("expected a map of boundaries")
    nodes = made.job.axes[-1].values
    step = nodes[1] - nodes[0] if len(nodes) > 1 else 0.0
    r = made["boundary"]
    inside = np.where(r < nodes[-1], r + share * step, r)
    return np.where(np.isnan(r), 0.0, inside)


def _around(made: Workspace, value: Floats, every: int = 1) -> Floats:
    """The integral over the direction, which goes round: exact to high order for smooth boundaries."""
    taken = value[:, ::every]
    return np.asarray(2 * np.pi * taken.mean(axis=1))


def _rows(made: Workspace, value: Floats, every: int = 1) -> float:
    """The integral over the first coordinate."""
    at = made.job.axes[0].values
    keep = np.unique([*range(0, len(at), every), len(at) - 1])
    return float(np.trapezoid(value[keep], at[keep]))


def _grid_volume(made: Workspace) -> Measure:
    """Each node counts as the cell around it."""
    job = made.job
    axes = [axis.values for axis in job.axes]
    if isinstance(job.family, Layers):
        density: Any = axes[2][None, None, :]
        whole_space, unit = 1.0, "m^3"
    elif isinstance(job.family, Box):
        density, whole_space, unit = 1.0, 1.0, "m^3"
    elif isinstance(job.family, TiltTorsion):
        density, unit = np.sin(axes[2])[None, None, :], "of all orientations"
        whole_space = ALL_ROTATIONS
    else:
        raise WorkspaceError(f"no volume is known of {type(job.family).__name__}")
    free = made.free * density

    def value(every: int) -> float:
        widths = [_cells(axis[::every], axis) for axis in axes]
        some = free[::every, ::every, ::every]
        return float(np.einsum("ijk,i,j,k->", some, *widths)) / whole_space

    whole = value(1)
    # between neighbours of which one is free the boundary is anywhere: an error for each, at random
    crossings = sum(int(np.count_nonzero(np.diff(made.free, axis=axis))) for axis in range(3))
    mean = whole / max(1, int(np.count_nonzero(made.free)))
    return Measure(whole, abs(value(2) - whole) + mean * float(np.sqrt(crossings)), unit)


def _cells(nodes: Floats, every: Floats) -> Floats:
    """The width of the cell around each node; the first and the last cells end at the ends of the range."""
    if len(nodes) == 1:
        return np.array([every[-1] - every[0]])
    middles = (nodes[1:] + nodes[:-1]) / 2
    return np.diff(np.concatenate([[every[0]], middles, [every[-1]]]))
