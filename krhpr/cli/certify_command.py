"""`krhpr certify ROBOT`: its arguments and help; `certifying.py` does the work."""

from __future__ import annotations

import argparse

from krhpr.cli.common import Command

EPILOG = """\
The box is given by its bounds, or sought around a centre with --largest. Each of
--low, --high, --centre, --proportions takes one number for all legs or three, in
radians or metres; --degrees takes and prints degrees.

The answer is free, singular (with a point), or undecided (with the smallest cell
left), for each factor of det J, with the test that proves it and a bound that the
factor's margin does not fall below. docs/singularities.md says what is proven.

With --unique the question is whether the forward kinematics has one solution at
most in the box: free then means that it is proven (docs/forward-kinematics.md).

exit codes: 0 free; 3 singular or undecided; 2 wrong use, such as a singular --centre

examples:
  krhpr certify spatial_rrr_a --low 30 --high 150 --degrees --open
  krhpr certify spatial_rrr_a --low 55 --high 175 --degrees --json
  krhpr certify spatial_rrr_a --largest --centre 90 --degrees
  krhpr certify spatial_rrr_a --low 31 --high 149 --degrees --unique
  krhpr certify spatial_rrr_c --low 0 0.02 0.02 --high 0.15
  krhpr certify planar_rr_a --largest --centre 1.5 1.6 1.6 --geometry l_r=0.04,0.05,0.06"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The command's arguments."""
    parser.add_argument("robot", metavar="ROBOT", help="identifier, as `krhpr list` shows it")
    triple = {"metavar": "X", "nargs": "+", "type": float}
    parser.add_argument("--low", help="lower bounds of the redundant coordinates", **triple)  # type: ignore[arg-type]
    parser.add_argument("--high", help="upper bounds", **triple)  # type: ignore[arg-type]
    parser.add_argument("--open", action="store_true", help="leave the box's faces out")
    parser.add_argument(
        "--unique", action="store_true", help="certify that forward has one solution at most in the box"
    )
    parser.add_argument("--largest", action="store_true", help="find the largest open box around --centre")
    parser.add_argument("--centre", help="the centre of the box that --largest finds", **triple)  # type: ignore[arg-type]
    parser.add_argument("--proportions", help="half-widths relative to one another (a cube)", **triple)  # type: ignore[arg-type]
    parser.add_argument("--degrees", action="store_true", help="angles in degrees, not radians")
    parser.add_argument(
        "--geometry",
        metavar="FIELD=VALUE",
        nargs="+",
        action="extend",
        default=[],
        help="another length or angle (rad); three values separated by commas where the legs differ",
    )
    parser.add_argument("--json", action="store_true", help="print an object")


def run(options: argparse.Namespace) -> int:
    """Certify a box, or find the largest one."""
    from krhpr.cli import certifying  # takes NumPy

    return certifying.run(options)


COMMAND = Command(
    "certify",
    "Certify that a box of redundant coordinates is free of type II singularities.  Or find a singular point "
    "in it, or the largest box that is free.",
    EPILOG,
    add_arguments,
    run,
)
