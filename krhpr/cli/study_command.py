"""`krhpr study NAME`: its arguments and help; a module for each study does the work."""

from __future__ import annotations

import argparse
from pathlib import Path

from krhpr.cli.common import Command, WrongUse

FOLDER = Path("build/study")

STUDIES = ("forward-accuracy", "dexterity", "trajectory")
OF_ACCURACY = ("seed", "errors", "bound", "repeat")
"""Options of forward-accuracy alone."""

EPILOG = """\
studies:
  forward-accuracy   Section 3.4: random errors on every encoder of the 3-RRRSR
                     robot along the example trajectory, and what the seven
                     approaches to the forward kinematics make of them
  dexterity          Section 1.8: motion ranges of the nine actuators of the
                     3-[R(RR-RRR)SR] robot along the example trajectory, condition
                     numbers and kinematic sensitivity
  trajectory         Section 4.3: the best redundant angles of the 3-RRRSR robot at
                     every pose, the two minima of eta_1, filtered angles, and all
                     methods against the nonlinear programme

A table is printed, and with it what the thesis says and whether it came out. The
numbers are written to --out as JSON, and the thesis' figures as pictures (where
matplotlib is installed).

exit codes: 0 every claim holds; 3 one does not; 2 wrong use

examples:
  krhpr study dexterity
  krhpr study trajectory --out chapter_4
  krhpr study forward-accuracy --seed 7 --repeat 20
  krhpr study forward-accuracy --errors normal --out normal"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The command's arguments."""
    parser.add_argument("study", metavar="NAME", choices=STUDIES, help=", ".join(STUDIES))
    parser.add_argument(
        "--out", metavar="DIR", type=Path, default=FOLDER, help=f"folder of the results (default: {FOLDER})"
    )
    accuracy = parser.add_argument_group("of forward-accuracy")
    accuracy.add_argument("--seed", metavar="N", type=int, help="of the random errors (default: 0)")
    accuracy.add_argument(
        "--errors",
        choices=("uniform", "normal"),
        help="uniform within the bound, which is the default, or normal",
    )
    accuracy.add_argument(
        "--bound",
        metavar="RAD",
        type=float,
        help="largest error, or three standard deviations (default: 0.005)",
    )
    accuracy.add_argument(
        "--repeat", metavar="N", type=int, help="run the trajectory N times (default: once)"
    )


def run(options: argparse.Namespace) -> int:
    """Run the study, print what came of it and write the pictures."""
    if options.study == "forward-accuracy":
        from krhpr.cli import study_accuracy  # takes NumPy

        return study_accuracy.run(options)
    given = [f"--{name}" for name in OF_ACCURACY if getattr(options, name) is not None]
    if given:
        raise WrongUse(f"{', '.join(given)} belongs to forward-accuracy; {options.study} has no such option")
    if options.study == "dexterity":
        from krhpr.cli import study_dexterity

        return study_dexterity.run(options)
    from krhpr.cli import study_trajectory

    return study_trajectory.run(options)


COMMAND = Command(
    "study",
    "Run a study of the thesis again.  With a table, pictures, and a check of what the thesis says.",
    EPILOG,
    add_arguments,
    run,
)
