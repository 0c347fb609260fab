"""Workspaces: where the platform can be, within limits of joints and bodies (Sections 1.7 and 4.2).

    from krhpr import load, workspace

    robot = load("spatial_r_fivebar_a")
    tilt = workspace.orientational(robot, torsions=[0.0])
    tilt["boundary"]  # (1, 360), rad

Stores and clusters take the extra `workspace` (xarray, zarr, Dask).
"""

from krhpr.workspace.axes import Axis, Box, Family, Layers, TiltTorsion, directions, steps, tilt_torsion
from krhpr.workspace.bodies import Bodies
from krhpr.workspace.certified import Certifier, Cube, Proof
from krhpr.workspace.choices import Best, Redundancy, Variant, constant, free
from krhpr.workspace.execute import run
from krhpr.workspace.limits import Stop, WorkspaceLimits, section_1_7
from krhpr.workspace.maps import BoundaryMap, GridMap, Job, Workspace
from krhpr.workspace.margins import Examiner, Margins
from krhpr.workspace.measures import Measure, areas, volume
from krhpr.workspace.sections import Torsion, orientational, torsion, translational
from krhpr.workspace.store import open_store
from krhpr.workspace.trace import Tracing

__all__ = [
    "Axis",
    "Best",
    "Bodies",
    "BoundaryMap",
    "Box",
    "Certifier",
    "Cube",
    "Examiner",
    "Family",
    "GridMap",
    "Job",
    "Layers",
    "Margins",
    "Measure",
    "Proof",
    "Redundancy",
    "Stop",
    "TiltTorsion",
    "Torsion",
    "Tracing",
    "Variant",
    "Workspace",
    "WorkspaceLimits",
    "areas",
    "constant",
    "directions",
    "free",
    "open_store",
    "orientational",
    "run",
    "section_1_7",
    "steps",
    "tilt_torsion",
    "torsion",
    "translational",
    "volume",
]
