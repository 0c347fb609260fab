"""`krhpr validate`: the generated code against the derivation."""

from __future__ import annotations

import argparse
from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING

import krhpr
from krhpr.cli.common import Column, Command, Exit, print_table, progress
from krhpr.errors import UnknownRobot

if TYPE_CHECKING:
    from krhpr.validation.run import Result

FOLDER = Path("build/validation")
_SHOWN = 20  # failures

EPILOG = """\
examples:
  krhpr validate
  krhpr validate spatial_rrr_a --full

Exit code 3 where a check fails. Every check, its worst error and its tolerance
stand in report.md and report.json."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The command's arguments."""
    parser.add_argument("robots", metavar="ROBOT", nargs="*", help="robots to validate (default: all)")
    parser.add_argument("--full", action="store_true", help="the large samples of `make test-full`")
    parser.add_argument(
        "--report", metavar="DIR", type=Path, default=FOLDER, help=f"folder of the report (default: {FOLDER})"
    )


def run(options: argparse.Namespace) -> int:
    """Run the checks and print what came of them."""
    known = krhpr.catalogue()
    for name in options.robots:
        if name not in known:
            raise UnknownRobot.among(name, known)
    from krhpr.validation.run import run as validate

    identifiers = [identifier for identifier in known if not options.robots or identifier in options.robots]
    with progress(None) as step:
        report = validate(identifiers, "large" if options.full else "small", step, folder=options.report)
    _print_results(identifiers, report.results)
    for result in report.failed[:_SHOWN]:
        print(f"failed: {result}")
    if len(report.failed) > _SHOWN:
        print(f"... and {len(report.failed) - _SHOWN} more")
    for reason in dict.fromkeys(result.remark for result in report.not_run):
        count = sum(result.remark == reason for result in report.not_run)
        print(f"not run: {count} check{'s' if count > 1 else ''}: {reason}")
    print(f"{report.summary()}; {options.report / 'report.md'}")
    return Exit.OK if report.ok else Exit.DIFFERENCE


def _print_results(identifiers: Iterable[str], results: Iterable[Result]) -> None:
    results = list(results)
    columns = (
        Column("robot", whole=True),
        Column("checks", numeric=True),
        Column("passed", numeric=True),
        Column("failed", numeric=True),
        Column("not run", numeric=True),
        Column("seconds", numeric=True),
    )
    rows = []
    for identifier in identifiers:
        own = [result for result in results if result.check.robot == identifier]
        states = [str(result.state) for result in own]
        counts = [states.count(state) for state in ("passed", "failed", "not run")]
        rows.append((identifier, len(own), *counts, sum(result.seconds for result in own)))
    print_table(columns, rows)


COMMAND = Command(
    "validate",
    "Check the generated code against the derivation.  Exactly, by finite differences, target against "
    "target, by invariants, and against reference values.",
    EPILOG,
    add_arguments,
    run,
)
