"""What the commands share: exit codes, errors of use, tables and progress in a terminal and without one."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from enum import IntEnum
from time import perf_counter
from typing import Any, Literal

from krhpr.errors import KrhprError


class Exit(IntEnum):
    """Exit codes."""

    OK = 0
    FAILED = 1
    WRONG_USE = 2
    DIFFERENCE = 3
    INTERRUPTED = 130


class WrongUse(KrhprError):
    """What was asked for, or given, cannot be used; the message says what is expected."""


@dataclass(frozen=True)
class Command:
    """One command: its name, what it does (the first sentence is its line in `krhpr --help`), how it runs."""

    name: str
    description: str
    epilog: str
    add_arguments: Callable[[argparse.ArgumentParser], None]
    run: Callable[[argparse.Namespace], int]


def first_words(description: str) -> str:
    """The first sentence of a description, without its full stop, as one line."""
    sentence = " ".join(description.split()).partition(". ")[0].rstrip(".")
    return sentence[:1].lower() + sentence[1:]


# -- tables --------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Column:
    """A column of a table."""

    title: str
    numeric: bool = False
    whole: bool = False
    """never broken over two lines"""


def print_table(columns: Sequence[Column], rows: Sequence[Sequence[object]]) -> None:
    """A table: with rich in a terminal, as aligned text elsewhere."""
    texts = [[_cell(value) for value in row] for row in rows]
    rich = _rich() if sys.stdout.isatty() else None
    if rich is None:
        print(_plain_table(columns, texts))
        return
    from rich.table import Table
    from rich.text import Text

    table = Table(box=rich.box.SIMPLE_HEAD, pad_edge=False, header_style="bold")
    for column in columns:
        justify: Literal["left", "right"] = "right" if column.numeric else "left"
        table.add_column(column.title, justify=justify, overflow="fold", no_wrap=column.whole)
    for row in texts:
        table.add_row(*map(Text, row))
    rich.console.Console().print(table)


def _cell(value: object) -> str:
    if isinstance(value, bool):
        return "yes" if value else "no"
    return f"{value:.2f}" if isinstance(value, float) else str(value)


def _plain_table(columns: Sequence[Column], rows: Sequence[Sequence[str]]) -> str:
    widths = [max(len(column.title), *(len(row[n]) for row in rows), 0) for n, column in enumerate(columns)]

    def line(cells: Sequence[str]) -> str:
        parts = [
            cell.rjust(width) if column.numeric else cell.ljust(width)
            for cell, width, column in zip(cells, widths, columns, strict=True)
        ]
        return "  ".join(parts).rstrip()

    head = [line([column.title for column in columns]), line(["-" * width for width in widths])]
    return "\n".join([*head, *(line(row) for row in rows)])


# -- progress ------------------------------------------------------------------------------------------------

Step = Callable[[str], None]
"""Called at the beginning of each step with what it does."""


@contextmanager
def progress(total: int | None) -> Iterator[Step]:
    """How far a long command is, on standard error: a bar in a terminal, a line for each step elsewhere.

    `total` is the number of steps, if known before.
    """
    rich = _rich() if sys.stderr.isatty() else None
    if rich is None:
        begin = perf_counter()
        # one write for each line: steps may begin side by side
        yield lambda step: print(
            f"{perf_counter() - begin:6.1f} s  {step}\n", end="", file=sys.stderr, flush=True
        )
        return
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn

    what = TextColumn("{task.fields[step]}", markup=False)
    columns = (BarColumn(), MofNCompleteColumn(), TimeElapsedColumn(), what)
    with Progress(*columns, console=rich.console.Console(stderr=True), transient=True) as bar:
        task = bar.add_task("", total=total, step="")
        begun = 0

        def advance(step: str) -> None:
            nonlocal begun
            bar.update(task, completed=begun, step=step, refresh=True)  # what begins is not yet done
            begun += 1

        yield advance
        bar.update(task, completed=begun)


def _rich() -> Any:
    """The package rich, or None where it is not installed."""
    try:
        import rich
        import rich.box
        import rich.console
    except ImportError:
        return None
    return rich
