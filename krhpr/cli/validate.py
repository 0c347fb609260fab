"""`krhpr validate`: the generated code against the derivation."""

from __future__ import annotations

import argparse

import krhpr
from krhpr.cli.common import Command, Exit
from krhpr.errors import UnknownRobot


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The command's arguments."""
    parser.add_argument("robots", metavar="ROBOT", nargs="*", help="robots to validate (default: all)")
    parser.add_argument("--full", action="store_true", help="the large samples of `make test-full`")


def run(options: argparse.Namespace) -> int:
    """Run the checks."""
    known = krhpr.catalogue()
    for name in options.robots:
        if name not in known:
            raise UnknownRobot.among(name, known)
    return Exit.OK


COMMAND = Command(
    "validate",
    "Check generated code against the derivation: exactly, by finite differences, and target against target.",
    "examples:\n  krhpr validate spatial_rrr_a\n  krhpr validate --full",
    add_arguments,
    run,
)
