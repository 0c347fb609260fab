"""Comparing with a folder and writing it: what would change, and old files whole when interrupted."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path

import pytest

from krhpr.codegen import output
from krhpr.codegen.output import MARK, STAGE_PREFIX, Change, Difference, compare, is_generated, write
from krhpr.codegen.targets.base import File
from tests.support import contents


def file(path: str, *lines: str) -> File:
    return File(path, "\n".join((f"# written {MARK}", *lines)) + "\n")


FILES = [
    file("__init__.py"),
    file("c/a.c", "one", "two"),
    file("c/b.c", "three"),
    file("python/a.py", "four"),
]
NEW = [
    file("__init__.py"),
    file("c/a.c", "one", "2"),
    file("casadi/a.py", "new"),
    file("python/a.py", "4"),
    file("python/b.py", "5"),
]


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A folder that holds FILES."""
    place = tmp_path / "generated"
    write(FILES, place)
    return place


def of(changes: list[Change]) -> dict[str, Difference]:
    return {change.path: change.difference for change in changes}


def test_what_is_written_compares_equal(folder: Path) -> None:
    assert compare(FILES, folder) == []
    assert contents(folder) == {file.path: file.text.encode() for file in FILES}


def test_comparing_names_each_kind_of_difference(folder: Path) -> None:
    (folder / "notes.txt").write_text("mine\n")
    (folder / "__pycache__").mkdir()
    (folder / "__pycache__" / "a.pyc").write_bytes(b"0")
    assert of(compare(NEW, folder)) == {
        "c/a.c": Difference.CHANGED,
        "casadi/a.py": Difference.NEW,
        "python/a.py": Difference.CHANGED,
        "python/b.py": Difference.NEW,
        "c/b.c": Difference.ORPHAN,
        "notes.txt": Difference.FOREIGN,
    }


def test_a_changed_file_is_explained_by_its_first_lines(folder: Path) -> None:
    why = {change.path: change.why for change in compare(NEW, folder)}["c/a.c"]
    assert why.splitlines() == [
        "2 lines differ, the first is line 3 (- in the folder, + generated):",
        "    @@ -3 +3 @@",
        "    -two",
        "    +2",
    ]


def test_line_ends_alone_are_a_difference(folder: Path) -> None:
    (folder / "c/a.c").write_bytes(FILES[1].text.replace("\n", "\r\n").encode())
    (change,) = compare(FILES, folder)
    assert change.why == "only the ends of its lines, or of the file, differ"


def test_a_file_that_is_not_text_is_a_difference(folder: Path) -> None:
    (folder / "c/a.c").write_bytes(b"\xff\x00")
    assert of(compare(FILES, folder)) == {"c/a.c": Difference.CHANGED}


def test_a_folder_that_is_not_there_lacks_every_file(tmp_path: Path) -> None:
    assert of(compare(FILES, tmp_path / "none")) == {file.path: Difference.NEW for file in FILES}


def test_writing_makes_and_removes_files_and_folders(folder: Path) -> None:
    changes = write([file("__init__.py"), file("new/deep/a.py")], folder)
    assert contents(folder).keys() == {"__init__.py", "new/deep/a.py"}
    assert sorted(place.name for place in folder.iterdir()) == ["__init__.py", "new"]
    assert of(changes)["c/a.c"] is Difference.ORPHAN


def test_writing_leaves_what_is_unchanged_untouched(folder: Path) -> None:
    os.utime(folder / "__init__.py", (1, 1))
    write(NEW, folder)
    assert (folder / "__init__.py").stat().st_mtime == 1
    assert write(NEW, folder) == []


def test_files_of_somebody_are_never_removed(folder: Path) -> None:
    (folder / "c" / "notes.txt").write_text("mine\n")
    (folder / "link").symlink_to("nowhere")
    write([file("__init__.py")], folder)
    assert (folder / "c" / "notes.txt").read_text() == "mine\n"
    assert (folder / "link").is_symlink()
    assert not is_generated(folder / "link")


def failing_after(count: int, error: type[BaseException]) -> Callable[..., None]:
    """os.replace that fails after so many files."""
    left = count

    def replace(source: Path, target: Path) -> None:
        nonlocal left
        if left == 0:
            left = -1  # putting the old ones back works again
            raise error("in the middle")
        left -= 1
        os.rename(source, target)

    return replace


@pytest.mark.parametrize("error", [OSError, KeyboardInterrupt, SystemExit])
@pytest.mark.parametrize("moved", range(4))
def test_an_interruption_leaves_the_old_files_whole(
    folder: Path, moved: int, error: type[BaseException], monkeypatch: pytest.MonkeyPatch
) -> None:
    before = contents(folder)
    os.utime(folder / "c/a.c", (1, 1))
    with monkeypatch.context() as patch:
        patch.setattr(output.os, "replace", failing_after(moved, error))
        with pytest.raises(error):
            write(NEW, folder)
    assert contents(folder) == before
    assert (folder / "c/a.c").stat().st_mtime == 1
    assert sorted(place.name for place in folder.iterdir()) == ["__init__.py", "c", "python"]
    write(NEW, folder)
    assert compare(NEW, folder) == []


def test_an_interruption_while_removing_leaves_the_old_files_whole(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    before = contents(folder)
    unlink = Path.unlink

    def failing(path: Path, missing_ok: bool = False) -> None:
        unlink(path, missing_ok)
        if path.name == "b.c":
            raise KeyboardInterrupt

    with monkeypatch.context() as patch:
        patch.setattr(Path, "unlink", failing)
        with pytest.raises(KeyboardInterrupt):
            write(NEW, folder)
    assert contents(folder) == before


def test_an_interruption_while_preparing_touches_nothing(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    before = contents(folder)

    def full(path: Path, data: bytes) -> int:
        raise OSError(28, "No space left on device")

    with monkeypatch.context() as patch:
        patch.setattr(Path, "write_bytes", full)
        with pytest.raises(OSError, match="No space"):
            write(NEW, folder)
    assert contents(folder) == before


def test_an_interruption_in_a_new_folder_leaves_none(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(output.os, "replace", failing_after(2, KeyboardInterrupt))
    with pytest.raises(KeyboardInterrupt):
        write(FILES, tmp_path / "some" / "new")
    assert list(tmp_path.iterdir()) == []


def test_what_a_killed_run_left_behind_is_no_difference(folder: Path) -> None:
    (folder / f"{STAGE_PREFIX}killed" / "new").mkdir(parents=True)
    (folder / f"{STAGE_PREFIX}killed" / "new" / "a.py").write_text("half")
    assert compare(FILES, folder) == []
