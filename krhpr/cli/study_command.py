"""`krhpr study NAME`: its arguments and help; a module for each study does the work."""

from __future__ import annotations

import argparse
from pathlib import Path

from krhpr.cli.common import Command

FOLDER = Path("build/study")
STUDIES = ("forward-accuracy", "workspace")

EPILOG = """\
studies:
  forward-accuracy   Section 3.4: random errors on every encoder of the 3-RRRSR
                     robot along the example trajectory, and what the seven
                     approaches to the forward kinematics make of them
  workspace          Section 1.7: layers of the translational workspace, and the
                     orientational one by torsion and tilt, with limits of joints
                     and interference; Figs. 1.6 to 1.9

Pictures (where matplotlib is installed) and a file of numbers are written to
--out; the table is printed, and with it what the thesis says.

exit codes: 0 every claim holds; 3 one does not; 2 wrong use

examples:
  krhpr study forward-accuracy
  krhpr study forward-accuracy --seed 7 --repeat 20
  krhpr study forward-accuracy --errors normal --out normal
  krhpr study workspace
  krhpr study workspace --coarser 4 --robot spatial_rrr_a
  krhpr study workspace --cluster tcp://127.0.0.1:8786 --store build/maps"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The command's arguments."""
    parser.add_argument("study", metavar="NAME", choices=STUDIES, help=" or ".join(STUDIES))
    parser.add_argument(
        "--out", metavar="DIR", type=Path, default=FOLDER, help=f"folder of the results (default: {FOLDER})"
    )
    accuracy = parser.add_argument_group("forward-accuracy")
    accuracy.add_argument(
        "--seed", metavar="N", type=int, default=0, help="of the random errors (default: 0)"
    )
    accuracy.add_argument(
        "--errors",
        choices=("uniform", "normal"),
        default="uniform",
        help="uniform within the bound, or normal",
    )
    accuracy.add_argument(
        "--bound",
        metavar="RAD",
        type=float,
        default=0.005,
        help="largest error, or three standard deviations (default: 0.005)",
    )
    accuracy.add_argument(
        "--repeat", metavar="N", type=int, default=1, help="run the trajectory N times (default: once)"
    )
    workspace = parser.add_argument_group("workspace")
    workspace.add_argument(
        "--robot",
        metavar="ROBOT",
        default="spatial_r_fivebar_a",
        help="identifier or robot file (default: spatial_r_fivebar_a)",
    )
    workspace.add_argument(
        "--coarser", metavar="N", type=int, default=1, help="steps of N mm and N degrees (default: 1)"
    )
    workspace.add_argument(
        "--cluster", metavar="ADDRESS", help="a Dask scheduler, or a number of processes (default: this one)"
    )
    workspace.add_argument(
        "--store", metavar="DIR", type=Path, help="keep the maps there; an interrupted study goes on"
    )


def run(options: argparse.Namespace) -> int:
    """Run the study, print what came of it and write the pictures."""
    if options.study == "workspace":
        from krhpr.cli import workspaces  # takes NumPy

        return workspaces.run(options)
    from krhpr.cli import studying

    return studying.run(options)


COMMAND = Command(
    "study",
    "Run a study of the thesis again.  With a table, pictures, and a check of what the thesis says.",
    EPILOG,
    add_arguments,
    run,
)
