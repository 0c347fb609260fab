"""`krhpr optimise PATH.yaml ROBOT`: its arguments and help; `optimising.py` does the work."""

from __future__ import annotations

import argparse
from pathlib import Path

from krhpr.cli.common import Command

METHODS = ("nlp", "constant", "scan", "one", "two", "receding")

EPILOG = """\
The file says the path, the objective and the limits (docs/trajectories.md):

  path: T1             # T1, T2 or section-1.8 of the thesis, or way_points
  objective: eta_1     # the integral of eta_1^2; eta_2, eta_3, time, or weights
  limits: chapter-4    # or a table of limits

  nlp       each leg's redundant coordinate by itself, by IPOPT (the default)
  constant  the best constant value      scan  the best equal value at each time
  one, two  the thesis' methods one (reduced range) and two (smoothing)
  receding  the programme over the next seconds alone, planned anew at every interval,
            as `RecedingHorizon` does it; --horizon says how many seconds

--out NAME writes NAME.npz (all arrays and settings), NAME.csv and NAME_joints.yaml
(ROS JointTrajectory), and with --plot NAME.png.

exit codes: 0 all limits are met; 3 they are not, and what is written is the least
infeasible trajectory found; 2 wrong use, such as a path that leaves the workspace

examples:
  krhpr optimise examples/translation.yaml spatial_rrr_a
  krhpr optimise examples/translation.yaml spatial_rrr_a --out build/best --plot
  krhpr optimise examples/translation.yaml spatial_rrr_a --method scan"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The command's arguments."""
    parser.add_argument("path", metavar="PATH.yaml", type=Path, help="the file with path, objective, limits")
    parser.add_argument(
        "robot", metavar="ROBOT", help="identifier, as `krhpr list` shows it, or a robot file"
    )
    parser.add_argument(
        "-o", "--out", metavar="NAME", type=Path, help="write results to NAME.npz, NAME.csv ..."
    )
    parser.add_argument("--method", choices=METHODS, help="how to choose; that of the file unless given")
    parser.add_argument(
        "--horizon", metavar="SECONDS", type=float, help="of --method receding (default: a third of the path)"
    )
    parser.add_argument("--mode", metavar="LABEL", help="working mode (default: the robot's)")
    parser.add_argument(
        "--compile",
        action="store_true",
        help="make C of the programme's functions: seconds once, then several times faster",
    )
    parser.add_argument("--plot", action="store_true", help="draw NAME.png too (takes --out)")
    parser.add_argument("--json", action="store_true", help="print an object in place of words")


def run(options: argparse.Namespace) -> int:
    """Choose redundant coordinates along a path."""
    from krhpr.cli import optimising  # takes NumPy

    return optimising.run(options)


COMMAND = Command(
    "optimise",
    "Choose the redundant coordinates of a robot along a path.  An index is made least and limits are "
    "kept, by a nonlinear programme or by the thesis' methods.",
    EPILOG,
    add_arguments,
    run,
)
