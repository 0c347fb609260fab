"""`krhpr compile`: kernels ahead of time."""

from __future__ import annotations

import argparse

import krhpr
from krhpr.cli.common import Column, Command, Exit, print_table, progress
from krhpr.errors import UnknownRobot


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The command's arguments."""
    parser.add_argument("robots", metavar="ROBOT", nargs="*", help="robots to compile (default: all)")


def run(options: argparse.Namespace) -> int:
    """Compile, and say where the libraries are."""
    known = (*krhpr.catalogue(), *krhpr.grasping_robots())
    for name in options.robots:
        if name not in known:
            raise UnknownRobot.among(name, known)
    from krhpr.backend import SLOWER
    from krhpr.cli.compiling import compile_all
    from krhpr.native import NoCompiler

    identifiers = [identifier for identifier in known if not options.robots or identifier in options.robots]
    try:
        with progress(len(identifiers) + 1) as step:
            libraries = compile_all(identifiers, step)
    except NoCompiler as error:
        raise NoCompiler(f"{error}.\nUntil then robots run on the pure NumPy modules: {SLOWER}.") from error
    columns = (Column("robot", whole=True), Column("kB", numeric=True), Column("library"))
    rows = [(identifier, path.stat().st_size // 1000, path) for identifier, path in libraries.items()]
    print_table(columns, rows)
    return Exit.OK


COMMAND = Command(
    "compile",
    "Compile robots' kernels ahead of their first use.  Libraries are kept in $KRHPR_CACHE, else in the "
    "user's cache, for this compiler, its flags and this processor.",
    "examples:\n  krhpr compile\n  krhpr compile spatial_rrr_a planar_rr_a",
    add_arguments,
    run,
)
