"""A run is skipped where nothing changed, and never where something did."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

import krhpr.templates
from krhpr.codegen import stamp

ROWS = [{"robot": "spatial_rrr_a", "seconds": 0.5}]


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder with a file that was generated, and the run that did it remembered."""
    monkeypatch.setenv("KRHPR_CACHE", str(tmp_path / "cache"))
    templates = tmp_path / "templates"
    templates.mkdir()
    (templates / "a.j2").write_text("text\n")
    monkeypatch.setattr(krhpr.templates, "__path__", [str(templates)])
    folder = tmp_path / "generated"
    folder.mkdir()
    (folder / "a.c").write_text("text\n")
    stamp.remember(folder, stamp.inputs_digest(folder), ROWS)
    return folder


def test_nothing_changed(folder: Path) -> None:
    assert stamp.recall(folder) == ROWS


def test_what_is_cached_beside_sources_does_not_count(folder: Path) -> None:
    for place in (folder, folder.parent / "templates"):
        (place / "__pycache__").mkdir()
        (place / "__pycache__" / "a.py").write_text("x")
    assert stamp.recall(folder) == ROWS


@pytest.mark.parametrize("change", ["changed", "new", "renamed", "gone"])
@pytest.mark.parametrize("place", ["templates/a.j2", "generated/a.c"])
def test_a_change_on_either_side_is_seen(folder: Path, place: str, change: str) -> None:
    path = folder.parent / place
    match change:
        case "changed":
            path.write_text("other\n")
        case "new":
            path.with_stem("b").write_text("text\n")
        case "renamed":
            path.rename(path.with_stem("b"))
        case "gone":
            path.unlink()
    assert stamp.recall(folder) is None


def test_another_version_of_what_it_runs_on_is_seen(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(stamp, "version", lambda name: "0")
    assert stamp.recall(folder) is None


@pytest.mark.parametrize("text", ["", "[]", "{}", "null", '{"inputs": 1}', "\0"])
def test_a_damaged_memory_is_none(folder: Path, text: str) -> None:
    (place,) = (folder.parent / "cache").iterdir()
    place.write_text(text)
    assert stamp.recall(folder) is None


def test_a_folder_that_cannot_be_written_only_costs_time(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("KRHPR_CACHE", str(folder / "a.c"))
    stamp.remember(folder, "digest", ROWS)
    assert stamp.recall(folder) is None


def test_memories_of_two_folders_do_not_mix(folder: Path, tmp_path: Path) -> None:
    assert stamp.recall(tmp_path / "cache") is None
    (place,) = (tmp_path / "cache").iterdir()
    assert json.loads(place.read_text())["rows"] == ROWS
