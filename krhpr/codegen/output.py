"""Files against a folder: what would change and why, and writing that leaves old files whole when it is
interrupted.

A generated file says of itself that it is one (`MARK`).  Files of a folder that do not are somebody's own:
they are reported, and never removed.
"""

from __future__ import annotations

import difflib
import os
import shutil
import tempfile
from collections.abc import Iterable, Sequence
from contextlib import suppress
from dataclasses import dataclass
from enum import StrEnum
from itertools import zip_longest
from pathlib import Path

from krhpr.codegen.targets.base import File

MARK = "by `krhpr generate`"
"""What every generated file says near its top."""

IGNORED = ("__pycache__",)
STAGE_PREFIX = ".krhpr-stage-"
_MARK_WITHIN = 4096  # bytes from the top


class Difference(StrEnum):
    """How a file of the folder differs from what is generated."""

    NEW = "missing"
    CHANGED = "changed"
    ORPHAN = "orphan"
    FOREIGN = "foreign"


@dataclass(frozen=True)
class Change:
    """One file that would change, and why: the first lines that differ."""

    path: str
    difference: Difference
    why: str


def compare(files: Sequence[File], folder: Path) -> list[Change]:
    """What stands between `folder` and holding exactly `files`."""
    changes = []
    for file in files:
        place = folder / file.path
        if not place.is_file():
            changes.append(Change(file.path, Difference.NEW, "the folder has no such file"))
            continue
        old = place.read_bytes()
        if old != file.text.encode():
            changes.append(Change(file.path, Difference.CHANGED, _first_difference(old, file)))
    wanted = {file.path for file in files}
    for path in _present(folder):
        if path in wanted:
            continue
        if is_generated(folder / path):
            changes.append(Change(path, Difference.ORPHAN, "nothing generates this file any more"))
        else:
            changes.append(
                Change(
                    path,
                    Difference.FOREIGN,
                    "nothing generates this file, and it is left alone: move it elsewhere",
                )
            )
    return changes


def is_generated(path: Path) -> bool:
    """Whether a file says of itself that it was generated."""
    try:
        with path.open("rb") as content:
            return MARK.encode() in content.read(_MARK_WITHIN)
    except OSError:  # a link to nothing
        return False


def write(files: Sequence[File], folder: Path, changes: Iterable[Change] | None = None) -> list[Change]:
    """Make `folder` hold `files` and no other generated ones; returns what changed.

    Everything is first written to a folder inside (the same file system), then moved into place file by file;
    where that is interrupted by an exception, the files moved so far are put back.
    """
    found = compare(files, folder) if changes is None else changes
    todo = [change for change in found if change.difference is not Difference.FOREIGN]
    if not todo:
        return []
    texts = {file.path: file.text for file in files}
    made = _make_folder(folder)
    try:
        stage = Path(tempfile.mkdtemp(prefix=STAGE_PREFIX, dir=folder))
        try:
            for change in todo:
                if change.difference is not Difference.ORPHAN:
                    place = stage / "new" / change.path
                    place.parent.mkdir(parents=True, exist_ok=True)
                    place.write_bytes(texts[change.path].encode())
            _move(todo, folder, stage)
        finally:
            shutil.rmtree(stage, ignore_errors=True)
    finally:
        _remove_empty((change.path for change in todo), folder)
        _remove_made(made)
    return todo


def _make_folder(folder: Path) -> list[Path]:
    """Make the folder; returns those of its path that were not there, the innermost first."""
    made = [place for place in (folder, *folder.parents) if not place.exists()]
    folder.mkdir(parents=True, exist_ok=True)
    return made


def _remove_made(made: Iterable[Path]) -> None:
    """Where nothing came to be written, folders made for it go again."""
    for folder in made:
        if any(folder.iterdir()):
            break
        folder.rmdir()


def _move(todo: Sequence[Change], folder: Path, stage: Path) -> None:
    done: list[Change] = []
    try:
        for change in todo:
            target, backup = folder / change.path, stage / "old" / change.path
            if target.exists():
                backup.parent.mkdir(parents=True, exist_ok=True)
                shutil.copy2(target, backup)
            done.append(change)
            if change.difference is Difference.ORPHAN:
                target.unlink()
            else:
                target.parent.mkdir(parents=True, exist_ok=True)
                os.replace(stage / "new" / change.path, target)
    except BaseException:
        for change in done:
            backup = stage / "old" / change.path
            if backup.exists():
                os.replace(backup, folder / change.path)
            else:
                (folder / change.path).unlink(missing_ok=True)
        raise


def _present(folder: Path) -> list[str]:
    if not folder.is_dir():
        return []
    found = []
    for place, below, names in os.walk(folder):
        below[:] = [name for name in below if name not in IGNORED and not name.startswith(STAGE_PREFIX)]
        found += [Path(place, name).relative_to(folder).as_posix() for name in names]
    return sorted(found)


def _first_difference(old: bytes, file: File) -> str:
    before, after = old.decode(errors="replace").splitlines(), file.text.splitlines()
    if before == after:
        return "only the ends of its lines, or of the file, differ"
    diff = difflib.unified_diff(before, after, "in the folder", "generated", lineterm="", n=0)
    lines = [line for line in diff if not line.startswith(("---", "+++"))]
    changed = sum(line.startswith(("+", "-")) for line in lines)
    number = next(n for n, (a, b) in enumerate(zip_longest(before, after), 1) if a != b)
    shown = "\n    ".join(line[:140] for line in lines[:5])
    return f"{changed} lines differ, the first is line {number} (- in the folder, + generated):\n    {shown}"


def _remove_empty(paths: Iterable[str], folder: Path) -> None:
    """Remove the folders that held these files, where they are empty now."""
    for path in paths:
        with suppress(OSError):  # not empty, or gone already
            for place in (folder / path).parents:
                if place == folder:
                    break
                place.rmdir()
