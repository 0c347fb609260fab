"""The parser of the command line, and what becomes of errors: short messages and exit codes."""

from __future__ import annotations

import argparse
import os
import sys
import textwrap
import traceback
import warnings
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import Any

from krhpr import __version__
from krhpr.cli import (
    certify_command,
    compile_command,
    eval_command,
    generate,
    info,
    list_command,
    optimise_command,
    schema_command,
    study_command,
    validate,
)
from krhpr.cli.common import Command, Exit, WrongUse, first_words
from krhpr.errors import (
    DesignError,
    InvalidInput,
    KrhprError,
    PluginError,
    TrajectoryError,
    UnknownBranch,
    UnknownRobot,
    WorkspaceError,
)
from krhpr.robot_files.problems import RobotFileError

COMMANDS: tuple[Command, ...] = (
    list_command.COMMAND,
    info.COMMAND,
    eval_command.COMMAND,
    certify_command.COMMAND,
    generate.COMMAND,
    compile_command.COMMAND,
    validate.COMMAND,
    study_command.COMMAND,
    optimise_command.COMMAND,
    schema_command.COMMAND,
)

DESCRIPTION = """\
Kinematics of kinematically redundant parallel robots: look robots up, compute with
them, and generate their code (C, NumPy, CasADi) from the derivation."""

EPILOG = """\
examples:
  krhpr list                                    the robots and their working modes
  krhpr info spatial_rrr_a                      joints, geometry and functions of one
  krhpr info spatial_rrr_a --function inverse   arguments and results of one function
  krhpr eval spatial_rrr_a inverse --input poses.json
  krhpr certify spatial_rrr_a --low 30 --high 150 --degrees --open
  krhpr optimise examples/translation.yaml spatial_rrr_a --out build/best --plot
  krhpr generate --check                        what `krhpr generate` would change, and why
  krhpr generate spatial_rrr_a --out arm        one robot's code in a folder that stands alone
  krhpr generate arm.yaml --out arm             the same for a robot file, with sizes of your own

exit codes:
  0    success
  1    failure: the message says of what; --debug shows where
  2    wrong use: an unknown robot, function or option, or input that cannot be read
  3    a difference found (generate --check), a check failed (validate), a box that
       is not free of singularities (certify), or limits that are not met (optimise)
  130  interrupted; files are as they were

environment:
  KRHPR_BACKEND  compiled, numpy, or auto (the default: compiled kernels where there is a compiler)
  KRHPR_CC       the C compiler to use, or `none`
  KRHPR_CACHE    the folder of compiled kernels"""


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command; returns the exit code."""
    parser = _parser()
    options = parser.parse_args(arguments)
    debug = "debug" in options
    if options.command is None:
        parser.print_help(sys.stderr)
        return Exit.WRONG_USE
    with _short_warnings():
        try:
            code = int(options.command.run(options))
            sys.stdout.flush()
            return code
        except KeyboardInterrupt:
            _say("interrupted")
            return Exit.INTERRUPTED
        except BrokenPipeError:
            # who reads the output has enough of it; nothing more can be written, not even on leaving
            os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
            return Exit.FAILED
        except Exception as error:
            if debug:
                traceback.print_exc()
            if explained := _explain(error):
                _say(explained[0])
                return explained[1]
            _say(f"{type(error).__name__}: {error}" + ("" if debug else "\nkrhpr: --debug shows where"))
            return Exit.FAILED


_WRONG_USE = (
    WrongUse,
    UnknownRobot,
    UnknownBranch,
    InvalidInput,
    RobotFileError,
    PluginError,
    TrajectoryError,
    WorkspaceError,
    DesignError,
)


def _explain(error: Exception) -> tuple[str, Exit] | None:
    """The message and the exit code for an error; None where it is one that nobody expects."""
    from krhpr.native import CompilationError, NoCompiler

    if isinstance(error, _WRONG_USE):
        return str(error), Exit.WRONG_USE
    if isinstance(error, (KrhprError, NoCompiler, CompilationError)):
        return str(error), Exit.FAILED
    if isinstance(error, ModuleNotFoundError) and error.name:
        package = error.name.partition(".")[0]
        extra = next((extra for extra, names in _EXTRAS.items() if package in names), None)
        if extra:
            return f"{package} is not installed: pip install 'krhpr[{extra}]'", Exit.FAILED
    if isinstance(error, OSError) and error.strerror:
        place = f"{error.filename}: " if error.filename is not None else ""
        return f"{place}{error.strerror}", Exit.FAILED
    return None


_EXTRAS = {
    "files": ("yaml",),
    "trajectory": ("scipy",),
    "generate": ("sympy", "jinja2", "rich"),
    "validate": ("flint", "pycparser", "mpmath", "casadi"),
}


def _parser() -> argparse.ArgumentParser:
    # --debug is understood before and after the command
    debug = argparse.ArgumentParser(add_help=False)
    debug.add_argument(
        "--debug", action="store_true", default=argparse.SUPPRESS, help="show the traceback of a failure"
    )
    parser = argparse.ArgumentParser(
        prog="krhpr",
        description=DESCRIPTION,
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
        parents=[debug],
        allow_abbrev=False,
    )
    parser.set_defaults(command=None)
    parser.add_argument("--version", action="version", version=f"krhpr {__version__}")
    commands = parser.add_subparsers(title="commands", metavar="COMMAND")
    for command in COMMANDS:
        below = commands.add_parser(
            command.name,
            help=first_words(command.description),
            description=textwrap.fill(command.description, 80),
            epilog=command.epilog,
            formatter_class=argparse.RawDescriptionHelpFormatter,
            parents=[debug],
            allow_abbrev=False,
        )
        command.add_arguments(below)
        below.set_defaults(command=command)
    return parser


def _say(message: str) -> None:
    print(f"krhpr: {message}", file=sys.stderr)


@contextmanager
def _short_warnings() -> Iterator[None]:
    """Warnings as one line, without the place in the source."""

    def show(message: Warning | str, *_: Any, **__: Any) -> None:
        _say(f"warning: {message}")

    with warnings.catch_warnings():
        warnings.showwarning = show
        yield
