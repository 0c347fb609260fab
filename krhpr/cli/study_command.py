"""`krhpr study NAME`: its arguments and help; `studying.py` does the work."""

from __future__ import annotations

import argparse
from pathlib import Path

from krhpr.cli.common import Command

FOLDER = Path("build/study")

STUDIES = ("forward-accuracy", "grasp")

EPILOG = """\
studies:
  forward-accuracy   Section 3.4: random errors on every encoder of the 3-RRRSR
                     robot along the example trajectory, and what the seven
                     approaches to the forward kinematics make of them
  grasp              Section 5.5: actuator forces and motor torques with which the
                     prototype holds an object along (5.73) to (5.75), or what a
                     --file says instead (examples/grasping_prototype.yaml)

forward-accuracy: the histograms of Figs. 3.8 to 3.11 are written to --out as pictures (where
matplotlib is installed) and as accuracy.json; the table is printed, and with it
what the thesis says of the order of the approaches.  grasp: a table, a picture
and grasp.json.

exit codes: 0 every claim holds; 3 one does not; 2 wrong use

examples:
  krhpr study forward-accuracy
  krhpr study forward-accuracy --seed 7 --repeat 20
  krhpr study forward-accuracy --errors normal --out normal
  krhpr study grasp
  krhpr study grasp --file my_gripper.yaml --out build/gripper"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The command's arguments."""
    parser.add_argument("study", metavar="NAME", choices=STUDIES, help=" or ".join(STUDIES))
    parser.add_argument("--seed", metavar="N", type=int, default=0, help="of the random errors (default: 0)")
    parser.add_argument(
        "--errors",
        choices=("uniform", "normal"),
        default="uniform",
        help="uniform within the bound, or normal",
    )
    parser.add_argument(
        "--bound",
        metavar="RAD",
        type=float,
        default=0.005,
        help="largest error, or three standard deviations (default: 0.005)",
    )
    parser.add_argument(
        "--repeat", metavar="N", type=int, default=1, help="run the trajectory N times (default: once)"
    )
    parser.add_argument(
        "--file", metavar="FILE", type=Path, help="of grasp: robot, object and trajectories (YAML)"
    )
    parser.add_argument(
        "--out", metavar="DIR", type=Path, default=FOLDER, help=f"folder of the results (default: {FOLDER})"
    )


def run(options: argparse.Namespace) -> int:
    """Run the study, print what came of it and write the pictures."""
    from krhpr.cli.common import WrongUse

    if options.file is not None and options.study != "grasp":
        raise WrongUse(f"--file is for the study grasp, not for {options.study}")
    if options.study == "grasp":
        from krhpr.cli import grasping  # takes NumPy

        return grasping.run(options)
    from krhpr.cli import studying

    return studying.run(options)


COMMAND = Command(
    "study",
    "Run a study of the thesis again.  With a seed, a table, pictures, and a check of what the thesis says.",
    EPILOG,
    add_arguments,
    run,
)
