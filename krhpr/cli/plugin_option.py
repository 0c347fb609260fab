"""The option --plugin, which commands that look robots up share."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

import krhpr
from krhpr.cli.common import Step, WrongUse
from krhpr.errors import UnknownRobot

if TYPE_CHECKING:
    from collections.abc import Iterator
    from types import ModuleType

    from krhpr.derivations.catalogue import Entry
    from krhpr.plugins import Printed
    from krhpr.robot import Robot


def add_plugin_option(parser: argparse.ArgumentParser) -> None:
    """--plugin FILE, which may be given several times."""
    parser.add_argument(
        "--plugin",
        metavar="FILE",
        type=Path,
        action="append",
        default=[],
        help="a Python file that states a sub-leg of your own (it is run); robots with it are known too",
    )


def plugin_entries(files: Sequence[Path]) -> list[Entry]:
    """Robots with the sub-legs of these files, and of installed packages."""
    if not files and not _installed():
        return []
    _need_sympy()
    from krhpr.plugins import load_plugins

    return [entry for plugin in load_plugins(files) for entry in plugin.entries()]


def _installed() -> bool:
    """Whether an installed package offers a sub-leg, without loading it."""
    from importlib.metadata import entry_points

    return bool(entry_points(group="krhpr.sublegs"))


def _need_sympy() -> None:
    try:
        import sympy  # noqa: F401
    except ModuleNotFoundError as error:
        raise WrongUse("a sub-leg of your own is derived first: pip install 'krhpr[generate]'") from error


def known_robots(entries: Sequence[Entry]) -> tuple[str, ...]:
    """The catalogue's robots, and these."""
    return (*krhpr.catalogue(), *(entry.identifier for entry in entries))


@contextmanager
def printed(
    entries: Sequence[Entry], wanted: Sequence[str] | None, step: Step = lambda what: None
) -> Iterator[Printed]:
    """Robots of one's own (those wanted, or all), printed to a folder that is gone afterwards."""
    from krhpr.plugins import Printed

    with Printed(_chosen(entries, wanted), step) as found:
        yield found


def numpy_modules(entries: Sequence[Entry], wanted: Sequence[str] | None) -> dict[str, ModuleType]:
    """The NumPy modules of one's own robots (those wanted, or all); nothing else is printed."""
    chosen = _chosen(entries, wanted)
    if not chosen:
        return {}
    from krhpr.codegen.pipeline import NUMPY
    from krhpr.plugins import Printed

    with Printed(chosen, targets=[NUMPY]) as found:
        return {identifier: found.module(identifier) for identifier in found.identifiers}


def own_robots(entries: Sequence[Entry], wanted: Sequence[str]) -> list[Robot]:
    """Those of one's own robots that are wanted, on NumPy."""
    from krhpr.robot import Robot  # it needs what is generated, which need not be there yet

    return [Robot(module, backend="numpy") for module in numpy_modules(entries, wanted).values()]


def _chosen(entries: Sequence[Entry], wanted: Sequence[str] | None) -> list[Entry]:
    return [entry for entry in entries if wanted is None or entry.identifier in wanted]


def refuse_unknown(names: Sequence[str], known: Sequence[str]) -> None:
    """Tell which robot is not known, with the nearest names."""
    for name in names:
        if name not in known:
            raise UnknownRobot.among(name, known)
