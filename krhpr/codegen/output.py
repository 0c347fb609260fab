"""Files against a folder: what would change and why, and writing that leaves old files whole when it is interrupted."""

from __future__ import annotations

import difflib
import os
import shutil
import tempfile
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path

from krhpr.codegen.targets.base import File

IGNORED = ("__pycache__",)


class Difference(StrEnum):
    """How a file of the folder differs from what is generated."""

    NEW = "missing"
    CHANGED = "changed"
    ORPHAN = "orphan"


@dataclass(frozen=True)
class Change:
    """One file that would change, and the first lines that differ."""

    path: str
    difference: Difference
    why: str


def compare(files: Sequence[File], folder: Path) -> list[Change]:
    """What writing `files` to `folder` would change."""
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
        if path not in wanted:
            changes.append(Change(path, Difference.ORPHAN, "nothing generates this file"))
    return changes


def write(files: Sequence[File], folder: Path, changes: Iterable[Change] | None = None) -> list[Change]:
    """Make `folder` hold exactly `files`; returns what changed.

    Everything is first written beside the folder, then moved into place file by file; where that is interrupted by an
    exception, the files moved so far are put back.
    """
    todo = list(compare(files, folder) if changes is None else changes)
    if not todo:
        return []
    folder.mkdir(parents=True, exist_ok=True)
    texts = {file.path: file.text for file in files}
    stage = Path(tempfile.mkdtemp(prefix=f".{folder.name}-", dir=folder.parent))
    try:
        for change in todo:
            if change.difference is not Difference.ORPHAN:
                place = stage / "new" / change.path
                place.parent.mkdir(parents=True, exist_ok=True)
                place.write_bytes(texts[change.path].encode())
        _move(todo, folder, stage)
    finally:
        shutil.rmtree(stage, ignore_errors=True)
    _remove_empty(folder)
    return todo


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
    return sorted(
        path.relative_to(folder).as_posix()
        for path in folder.rglob("*")
        if path.is_file() and not any(part in IGNORED for part in path.relative_to(folder).parts)
    )


def _first_difference(old: bytes, file: File) -> str:
    before = old.decode(errors="replace").splitlines()
    lines = [
        line
        for line in difflib.unified_diff(before, file.text.splitlines(), "in the folder", "generated", lineterm="", n=0)
        if not line.startswith(("---", "+++"))
    ]
    changed = sum(line.startswith(("+", "-")) for line in lines)
    shown = "\n    ".join(line[:140] for line in lines[:5]) or "only the end of the file"
    return f"{changed} lines differ, first:\n    {shown}"


def _remove_empty(folder: Path) -> None:
    for path in sorted(folder.rglob("*"), reverse=True):
        if path.is_dir() and path.name not in IGNORED and not any(path.iterdir()):
            path.rmdir()
