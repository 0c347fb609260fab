"""`krhpr validate`: the generated code against the derivation."""

from __future__ import annotations

import argparse
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import krhpr
from krhpr.cli.common import Column, Command, Exit, print_table, progress
from krhpr.cli.plugin_option import (
    add_plugin_option,
    known_robots,
    plugin_entries,
    printed,
    refuse_unknown,
)

if TYPE_CHECKING:
    from krhpr.derivations.catalogue import Entry
    from krhpr.validation.run import Report, Result

FOLDER = Path("build/validation")
_SHOWN = 20  # failures

EPILOG = """\
examples:
  krhpr validate
  krhpr validate spatial_rrr_a --full
  krhpr validate planar_grasp_prr
  krhpr validate --plugin my_leg.py

Exit code 3 where a check fails. Every check, its worst error and its tolerance
stand in report.md and report.json."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The command's arguments."""
    parser.add_argument("robots", metavar="ROBOT", nargs="*", help="robots to validate (default: all)")
    parser.add_argument("--full", action="store_true", help="the large samples of `make test-full`")
    add_plugin_option(parser)
    parser.add_argument(
        "--report", metavar="DIR", type=Path, default=FOLDER, help=f"folder of the report (default: {FOLDER})"
    )


def run(options: argparse.Namespace) -> int:
    """Run the checks and print what came of them."""
    own = plugin_entries(options.plugin)
    known = (*known_robots(own), *krhpr.grasping_robots())
    refuse_unknown(options.robots, known)
    names = options.robots or [entry.identifier for entry in own if options.plugin]
    identifiers = [identifier for identifier in known if not names or identifier in names]
    report = _validate(identifiers, own, options)
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


def _validate(identifiers: Sequence[str], own: Sequence[Entry], options: argparse.Namespace) -> Report:
    """Robots of the catalogue, then one's own, whose code is printed for that."""
    from krhpr.validation.run import Report
    from krhpr.validation.run import run as validate

    size = "large" if options.full else "small"
    theirs = [entry for entry in own if entry.identifier in identifiers]
    rest = [name for name in identifiers if name not in {entry.identifier for entry in theirs}]
    with progress(None) as step:
        if not theirs:
            return validate(rest, size, step, folder=options.report)
        results = validate(rest, size, step, folder=None).results if rest else ()
        with printed(theirs, None, step) as found:
            more = validate(None, size, step, generated=found.folder, among=theirs, folder=None)
    report = Report(size, (*results, *more.results))
    report.write(options.report)
    return report


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
