"""Parts of grids: what is connected with the home pose, and the largest cube of free nodes."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from krhpr.workspace import Stop, TiltTorsion, Workspace
from krhpr.workspace.certified import Cube

Floats = NDArray[np.float64]
Flags = NDArray[np.bool_]


def connected(made: Workspace, at: ArrayLike) -> Workspace:
    """A grid with the free nodes alone that steps from node to node join to the place `at` (three
    coordinates): to a corner of the cell in which it lies.

    Angles of tilt and torsion go round: nodes of one pose are one node.
    """
    from scipy.ndimage import label

    labels, count = label(made.free)
    same = np.arange(count + 1)  # which labels are one
    if isinstance(made.job.family, TiltTorsion):
        for first, last in ((labels[0], labels[-1]), (labels[:, 0], labels[:, -1])):
            for a, b in np.unique(np.stack([first.ravel(), last.ravel()], axis=-1), axis=0):
                if a and b:
                    same[same == same[b]] = same[a]
    labels = same[labels]
    places = []
    for axis, value in zip(made.job.axes, np.asarray(at, dtype=float), strict=True):
        after = int(np.searchsorted(axis.values, value - 1e-12))
        places.append(sorted({min(max(k, 0), len(axis) - 1) for k in (after - 1, after)}))
        if after < len(axis) and abs(axis.values[after] - value) < 1e-9:
            places[-1] = [after]
    home = np.unique(labels[np.ix_(*places)])
    belongs = np.isin(labels, home[home > 0])
    stops = np.where(made.free & ~belongs, Stop.REACH, made["stops"]).astype(np.int8)
    return Workspace(made.job, {**made.arrays, "stops": stops})


def cut(made: Workspace, lowest: float | None = None) -> bool:
    """Whether free nodes lie on the outermost planes of a grid of positions, so that there may be more
    beyond; below `lowest` there is none."""
    free, step = made.free, np.diff(made.job.axes[2].values[:2]).sum()
    faces = [free.take(at, axis) for axis in range(3) for at in (0, -1)]
    if lowest is not None and made.job.axes[2].values[0] - step < lowest:
        faces.pop(-2)
    return any(bool(face.any()) for face in faces)


def largest_cube(made: Workspace) -> Cube:
    """The largest cube with all its nodes free, of a grid over Cartesian positions with one step.

    It is checked at the nodes and not proven between them.  Of several the one nearest to the z-axis is
    taken, so that it does not depend on the order of nodes.
    """
    from scipy.ndimage import distance_transform_cdt

    free = np.pad(made.free, 1)  # what is beyond the grid is not known to be free
    steps = distance_transform_cdt(free, metric="chessboard")[1:-1, 1:-1, 1:-1]
    x, y, z = (axis.values for axis in made.job.axes)
    if not made.free.any():
        return Cube((0.0, 0.0, 0.0), 0.0)
    off = np.hypot(x[:, None], y[None, :])[:, :, None] + 1e-6 * z[None, None, :]
    best = np.where(steps == steps.max(), off, np.inf)
    i, j, k = np.unravel_index(int(np.argmin(best)), best.shape)
    side = 2 * (int(steps.max()) - 1) * float(x[1] - x[0] if len(x) > 1 else 0.0)
    return Cube((float(x[i]), float(y[j]), float(z[k])), side)
