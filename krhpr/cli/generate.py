"""`krhpr generate`: derive, print, write or compare, compile, and one table of what it came to."""

from __future__ import annotations

import argparse
import os
import re
import signal
import sys
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from time import perf_counter
from types import FrameType, ModuleType
from typing import TYPE_CHECKING, NoReturn

from krhpr.cli.common import Column, Command, Exit, Step, WrongUse, print_table, progress
from krhpr.cli.plugin_option import add_plugin_option, numpy_modules, plugin_entries
from krhpr.errors import UnknownRobot

if TYPE_CHECKING:
    from krhpr.codegen.output import Change
    from krhpr.codegen.pipeline import AnyEntry, Custom, Derived
    from krhpr.codegen.stamp import Rows
    from krhpr.codegen.targets.base import File
    from krhpr.derivations.catalogue import Entry

EPILOG = """\
examples:
  krhpr generate                          write generated/ and compile every robot
  krhpr generate --check                  write nothing; exit code 3 where a file differs
  krhpr generate spatial_rrr_a --out arm  a Python package, and C with CMake
  krhpr generate arm.yaml --out arm       the same for a robot file, under its name
  krhpr generate arm.yaml --out arm --bake
  krhpr generate --plugin my_leg.py --out legs   robots with a sub-leg of your own

Files are moved into place when all of them are ready; an interrupted run leaves
the old ones whole."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The command's arguments."""
    parser.add_argument(
        "robots",
        metavar="ROBOT",
        nargs="*",
        help="robots to gather with --out, by name or as robot files (default: all of the catalogue)",
    )
    parser.add_argument(
        "--check", action="store_true", help="write nothing: say which files would change, and why"
    )
    parser.add_argument(
        "--out", metavar="DIR", type=Path, help="write a folder that stands alone: nothing in it needs krhpr"
    )
    parser.add_argument(
        "--bake",
        action="store_true",
        help="with --out: make lengths and angles constants of the code, and no argument of its functions",
    )
    add_plugin_option(parser)
    parser.add_argument(
        "--anew", action="store_true", help="derive again even where nothing changed since the last run"
    )
    parser.add_argument(
        "--no-compile", action="store_true", help="do not compile; kernels are compiled when first used"
    )


def run(options: argparse.Namespace) -> int:
    """Generate, or compare."""
    if options.bake and options.out is None:
        raise WrongUse("--bake makes the sizes of a folder's robots constants: add --out DIR")
    if options.plugin and options.out is None:
        raise WrongUse("generated/ holds the catalogue alone: add --out DIR for a sub-leg of your own")
    own = plugin_entries(options.plugin)
    if options.robots and options.out is None:
        _entries(options.robots, own)  # a wrong name is told first
        raise WrongUse(
            "robots share files, so generated/ is written for all of them at once: leave the names out, or "
            "add --out DIR to gather what these robots need into a folder of its own"
        )
    folder = generated_folder() if options.out is None else options.out.absolute()
    if not options.check:
        _refuse_read_only(folder, options.out is None)
    if options.check or options.out is not None:
        return _check_or_gather(options, folder, own)
    return _generate_all(folder, anew=options.anew, compiles=not options.no_compile)


def _check_or_gather(options: argparse.Namespace, folder: Path, own: Sequence[Entry]) -> int:
    """Write nothing, or a folder that stands alone."""
    begin = perf_counter()
    names = options.robots or [entry.identifier for entry in own if options.plugin]
    entries, customs = _orders(names, own, bake=options.bake)
    theirs = [entry for entry in own if entry in entries]
    with progress(_steps(entries) + len({entry.robot.subleg.name for entry in theirs})) as step:
        _prove(theirs, step)
        derived, files = _derive_and_print(entries, customs, options.out, step)
    if options.check:
        return _report_check(files, folder, standalone=options.out is not None)
    changes = _write(files, folder, standalone=True)
    _print_table(_rows(derived, files))
    print(f"\n{len(files)} files in {folder}, {_changed(changes)}; {perf_counter() - begin:.1f} s")
    newton = [entry.robot.subleg.name for entry in theirs if not entry.robot.subleg.has_inverse]
    for name in dict.fromkeys(newton):
        print(
            f"{name} states no `inverse`: that of its robots is a bounded Newton iteration from "
            "`theta_near`, with a status"
        )
    if not folder.name.isidentifier():
        print(f"Python can import the folder as a package under a name like {_identifier(folder.name)} only.")
    return Exit.OK


def _generate_all(folder: Path, *, anew: bool, compiles: bool) -> int:
    """Write the folder of krhpr.generated and compile."""
    from krhpr.codegen import stamp

    begin = perf_counter()
    rows = None if anew else stamp.recall(folder)
    done = "nothing changed since it was generated"
    if rows is None:
        entries = _entries((), ())
        inputs = stamp.inputs_digest(folder)
        with progress(_steps(entries)) as step:
            derived, files = _derive_and_print(entries, (), None, step)
        changes = _write(files, folder, standalone=False)
        rows = _rows(derived, files)
        stamp.remember(folder, inputs, rows)
        done = f"{len(files)} files, {_changed(changes)}"
    done += f"; {perf_counter() - begin:.1f} s"
    identifiers = [row["robot"] for row in rows]
    note = _compile(identifiers) if compiles else ""
    _print_table(rows)
    print(f"\n{folder}: {done}")
    if note:
        print(note)
    return Exit.OK


def generated_folder() -> Path:
    """The folder of krhpr.generated, which may still be empty: it lies beside that of krhpr.derivations."""
    import krhpr.derivations

    return Path(next(iter(krhpr.derivations.__path__))).absolute().with_name("generated")


def _prove(entries: Sequence[Entry], step: Step) -> None:
    """Hold sub-legs of one's own to their closure, before code is made of them."""
    if not entries:
        return
    try:
        from krhpr.plugins import prove
    except ModuleNotFoundError as error:
        raise WrongUse(
            f"a sub-leg of your own is proven before code is made of it, which needs {error.name}: "
            "pip install 'krhpr[generate,validate]'"
        ) from error
    prove(entries, step)


def _entries(names: Sequence[str], own: Sequence[Entry]) -> list[AnyEntry]:
    """The robots with these names, of the catalogue or one's own (without names all of the catalogue); robot
    files apart.
    """
    from krhpr.codegen.pipeline import all_entries
    from krhpr.robot_files import is_robot_file

    known = {entry.identifier: entry for entry in (*all_entries(), *(own if names else ()))}
    for name in names:
        if name not in known and not is_robot_file(name):
            raise UnknownRobot.among(name, list(known))
    return [entry for identifier, entry in known.items() if not names or identifier in names]


def _steps(entries: Sequence[AnyEntry]) -> int:
    from krhpr.codegen.pipeline import TARGETS

    return len(entries) + len(TARGETS) + 1


def _orders(
    names: Sequence[str], own: Sequence[Entry], *, bake: bool
) -> tuple[list[AnyEntry], list[Custom | None]]:
    """The robots to derive, and what their robot files (or --bake) change in them."""
    from krhpr.robot_files import is_robot_file

    known = {entry.identifier: entry for entry in _entries(names, own)}
    if not names:
        return list(known.values()), [_baked(entry) if bake else None for entry in known.values()]
    entries: list[AnyEntry] = []
    customs: list[Custom | None] = []
    seen: dict[str, str] = {}
    everything = {entry.identifier: entry for entry in (*_entries((), ()), *own)}
    modules = numpy_modules(own, None) if any(map(is_robot_file, names)) else {}
    for name in names:
        if is_robot_file(name):
            entry, custom = _custom(Path(name), everything, modules, bake=bake)
        else:
            entry, custom = known[name], _baked(known[name]) if bake else None
        called = custom.name if custom else entry.identifier
        if called in seen:
            raise WrongUse(f"{seen[called]} and {name} are both called {called}; rename one of them")
        seen[called] = name
        entries.append(entry)
        customs.append(custom)
    return entries, customs


def _custom(
    path: Path, known: Mapping[str, AnyEntry], modules: Mapping[str, ModuleType], *, bake: bool
) -> tuple[AnyEntry, Custom | None]:
    """The robot that a file chooses, and what it changes in it."""
    from krhpr.codegen.pipeline import Custom
    from krhpr.loading import checked_file

    file = checked_file(path, modules)
    home = None if file.home is None else (file.home.p, file.home.redundant)
    return known[file.identifier], Custom(file.name, file.sizes, file.limits, bake, home)


def _baked(entry: AnyEntry) -> Custom:
    from krhpr.codegen.pipeline import Custom
    from krhpr.limits import Limits

    return Custom(entry.identifier, entry.sizes, Limits(), baked=True)


def _derive_and_print(
    entries: Sequence[AnyEntry], customs: Sequence[Custom | None], out: Path | None, step: Step
) -> tuple[Derived, list[File]]:
    from krhpr.codegen.pipeline import customised, derive, print_all
    from krhpr.codegen.standalone import standalone_files

    derived = derive(entries, step)
    if customs:
        derived = customised(derived, customs)
    files = print_all(derived, step)
    if out is not None:
        files = standalone_files(derived, files, out.absolute().name)
    return derived, files


# -- comparing and writing -----------------------------------------------------------------------------------


def _report_check(files: Sequence[File], folder: Path, *, standalone: bool) -> int:
    from krhpr.codegen.output import Difference, compare

    changes = compare(files, folder)
    if standalone:
        changes = [change for change in changes if change.difference is not Difference.FOREIGN]
    if not changes:
        print(f"{folder}: {len(files)} files, all as generated")
        return Exit.OK
    for change in changes:
        print(f"{change.difference:8} {change.path}: {change.why}")
    count = f"{len(changes)} file{'s' if len(changes) > 1 else ''}"
    print(f"\n{folder}: {count} not as generated; run `krhpr generate` without --check")
    return Exit.DIFFERENCE


def _write(files: Sequence[File], folder: Path, *, standalone: bool) -> list[Change]:
    from krhpr.codegen.output import Difference, compare, is_generated, write

    if standalone:
        own = [
            file.path
            for file in files
            if (folder / file.path).exists() and not is_generated(folder / file.path)
        ]
        if own:
            raise WrongUse(
                f"{folder} holds files that were not generated and would be lost: {', '.join(own)}"
            )
    try:
        with _one_interrupt():
            found = compare(files, folder)
            write(files, folder, found)
    except PermissionError:
        _stop_read_only(folder, not standalone)
    return [change for change in found if not standalone or change.difference is not Difference.FOREIGN]


def _refuse_read_only(folder: Path, default: bool) -> None:
    """Stop before the work where nothing can be written."""
    existing = next(place for place in (folder, *folder.parents) if place.exists())
    if not existing.is_dir():
        raise WrongUse(f"{existing} is a file, not a folder")
    if not os.access(existing, os.W_OK | os.X_OK):
        _stop_read_only(folder, default)


def _stop_read_only(folder: Path, default: bool) -> NoReturn:
    message = f"{folder} cannot be written"
    if default:
        message += (
            ". Add --out DIR to write elsewhere; to change the robots that `import krhpr` finds, work in a "
            "clone: `make generate`, or `pip install --editable '.[generate]'` and `krhpr generate`"
        )
    raise WrongUse(message)


@contextmanager
def _one_interrupt() -> Iterator[None]:
    """The first interrupt (or termination) ends the writing; later ones do not disturb its being undone."""

    def interrupt(number: int, frame: FrameType | None) -> NoReturn:
        for name in signals:
            signal.signal(name, signal.SIG_IGN)
        raise KeyboardInterrupt

    signals = (signal.SIGINT, signal.SIGTERM)
    before = [signal.signal(name, interrupt) for name in signals]
    try:
        yield
    finally:
        for name, handler in zip(signals, before, strict=True):
            signal.signal(name, handler)


def _identifier(name: str) -> str:
    return re.sub(r"\W", "_", f"_{name}" if name[:1].isdigit() else name)


def _changed(changes: Sequence[Change]) -> str:
    from krhpr.codegen.output import Difference

    words = {
        Difference.NEW: "new",
        Difference.CHANGED: "changed",
        Difference.ORPHAN: "removed",
        Difference.FOREIGN: "not generated and left alone (--check names them)",
    }
    counts = Counter(change.difference for change in changes)
    return (
        ", ".join(f"{counts[kind]} {word}" for kind, word in words.items() if counts[kind]) or "none changed"
    )


# -- compiling -----------------------------------------------------------------------------------------------


def _compile(identifiers: Sequence[str]) -> str:
    """Compile ahead of time; returns what there is to say of it."""
    from krhpr.backend import SLOWER
    from krhpr.cli.compiling import compile_all
    from krhpr.native import NoCompiler, cache_folder

    begin = perf_counter()
    try:
        with progress(len(identifiers) + 1) as step:
            compile_all(identifiers, step)
    except NoCompiler as error:
        return f"Not compiled: {error}.\nRobots run on the pure NumPy modules: {SLOWER}."
    return f"Compiled kernels in {cache_folder()}; {perf_counter() - begin:.1f} s"


# -- the table -----------------------------------------------------------------------------------------------


def _rows(derived: Derived, files: Sequence[File]) -> Rows:
    from krhpr.codegen.report import summary

    rows = summary(derived.robots, files)
    return [{**row, "seconds": derived.seconds[str(row["robot"])]} for row in rows]


def _print_table(rows: Rows) -> None:
    sys.stderr.flush()
    columns = {
        "robot": Column("robot", whole=True),
        "functions": Column("functions", numeric=True),
        "written": Column("operations as written", numeric=True),
        "operations": Column("after optimisation", numeric=True),
        "lines": Column("lines", numeric=True),
        "seconds": Column("seconds", numeric=True),
    }
    print_table(list(columns.values()), [[row[name] for name in columns] for row in rows])


COMMAND = Command(
    "generate",
    "Derive the robots and write their code: C, NumPy and CasADi.  Without --out that is the folder of "
    "krhpr.generated, for all robots, and their kernels are compiled as well.",
    EPILOG,
    add_arguments,
    run,
)
