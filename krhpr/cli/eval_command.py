"""`krhpr eval ROBOT FUNCTION`: its arguments and help; `evaluation.py` does the work."""

from __future__ import annotations

import argparse

from krhpr.cli.common import Command

EPILOG = """\
input:
  JSON  an object of argument name -> number or nested lists, with any batch
        dimensions before those that `krhpr info ROBOT --function FUNCTION` shows;
        or a list of such objects
  CSV   a header of columns (phi; p_0,p_1,p_2; Q_00,Q_01,...,Q_22) and a row for
        each configuration
  A working or assembly mode may be given by its label: by an option for all, or in
  a field or column `mode`, `assembly`.

output:
  results by name, in the same form; null (JSON) or nan (CSV) where there is no
  answer, --status says why

examples:
  echo '{"p": [0, 0.01], "phi": 0.1, "redundant": [1.57, 1.57, 1.57]}' |
    krhpr eval planar_rr_a inverse --status
  krhpr eval planar_rr_a inverse --input poses.csv --mode elbow- --to json
  krhpr eval planar_rr_a subleg_forward --input joints.json --geometry l_1=0.14
  krhpr eval planar_rr_a inverse --input poses.json --geometry l_2=0.15,0.16,0.17
  krhpr eval my_robot.yaml inverse --input poses.json"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The command's arguments."""
    parser.add_argument(
        "robot", metavar="ROBOT", help="identifier, as `krhpr list` shows it, or a robot file"
    )
    parser.add_argument("function", metavar="FUNCTION", help="name, as `krhpr info ROBOT` shows it")
    parser.add_argument(
        "--input", metavar="FILE", default="-", help="file to read; - (the default) is standard input"
    )
    parser.add_argument(
        "--format",
        choices=("json", "csv"),
        help="format of the input and the output (default: by the file's ending, else its first character)",
    )
    parser.add_argument("--to", choices=("json", "csv"), help="format of the output, if another")
    parser.add_argument(
        "--mode", metavar="LABEL", help="working mode: a label for all legs, or three separated by commas"
    )
    parser.add_argument("--assembly", metavar="LABEL", help="assembly mode of the sub-legs, likewise")
    parser.add_argument(
        "--geometry",
        metavar="FIELD=VALUE",
        nargs="+",
        action="extend",
        default=[],
        help="another length or angle; three values separated by commas where the legs differ",
    )
    parser.add_argument(
        "--no-check-rotation", action="store_true", help="take any matrix for Q, not only rotations"
    )
    parser.add_argument(
        "--status", action="store_true", help="add whether there is an answer, and why where there is none"
    )


def run(options: argparse.Namespace) -> int:
    """Evaluate a function and print its results."""
    from krhpr.cli import evaluation  # takes NumPy

    return evaluation.run(options)


COMMAND = Command(
    "eval",
    "Evaluate a function of a robot.  Numbers come from a file or from standard input, results go to "
    "standard output.",
    EPILOG,
    add_arguments,
    run,
)
