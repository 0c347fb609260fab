"""The committed folder is what the sources generate, byte for byte, on any run."""

from __future__ import annotations

from pathlib import Path

import pytest

from krhpr.codegen.build import Parts
from krhpr.codegen.output import MARK, compare
from krhpr.codegen.pipeline import TARGETS, Derived, all_entries, derive, print_all
from krhpr.codegen.report import SCHEMA_FILE
from krhpr.codegen.targets.base import File
from krhpr.derivations.catalogue import catalogue
from tests.support import ROOT, contents, run_python

GENERATE = """
import sys
from pathlib import Path
from krhpr.codegen.output import write
from krhpr.codegen.pipeline import all_entries, derive, print_all

write(print_all(derive()), Path(sys.argv[1]))
"""

REMEDY = "generated/ is not what the sources generate: run `make generate` and commit what it changes"


@pytest.mark.full
@pytest.mark.parametrize("seed", ["0", "1"])
def test_generating_again_gives_the_committed_files(seed: str, tmp_path: Path) -> None:
    elsewhere = tmp_path / "another working folder"
    elsewhere.mkdir()
    environment = {"PYTHONHASHSEED": seed, "TMPDIR": str(elsewhere), "LC_ALL": "C", "COLUMNS": "40"}
    run = run_python("-c", GENERATE, str(tmp_path / "again"), env=environment, cwd=elsewhere)
    assert run.returncode == 0, run.stderr
    again, committed = contents(tmp_path / "again"), contents(ROOT / "generated")
    assert again.keys() == committed.keys(), REMEDY
    changed = [path for path in again if again[path] != committed[path]]
    assert not changed, REMEDY


def test_the_committed_folder_compares_equal(printed: list[File]) -> None:
    assert compare(printed, ROOT / "generated") == [], REMEDY


def test_every_file_says_that_it_is_generated(printed: list[File]) -> None:
    assert [file.path for file in printed if MARK not in file.text[:4096]] == []


def test_every_file_ends_with_one_newline_and_has_no_trailing_blanks(printed: list[File]) -> None:
    untidy = [
        file.path
        for file in printed
        if not file.text.endswith("\n")
        or file.text.endswith("\n\n")
        or "\r" in file.text
        or "\t" in file.text
        or any(line != line.rstrip() for line in file.text.split("\n"))
    ]
    assert untidy == []


def test_no_file_names_a_place_on_this_machine(printed: list[File]) -> None:
    places = (str(ROOT), str(Path.home()))
    assert [file.path for file in printed if any(place in file.text for place in places)] == []


def test_parts_are_derived_once_and_shared(derived: Derived) -> None:
    first, *_, third = (robot for robot in derived.robots if robot.subleg.name == "subleg_rrr")
    assert first.subleg is third.subleg
    assert len({part.name for part in derived.parts}) == len(list(derived.parts))


def test_every_robot_has_its_seconds(derived: Derived) -> None:
    assert list(derived.seconds) == [entry.identifier for entry in all_entries()]
    assert all(seconds > 0 for seconds in derived.seconds.values())


def test_progress_names_every_step() -> None:
    steps: list[str] = []
    entry = catalogue()[-1]
    print_all(derive([entry], steps.append), steps.append)
    prints = [f"print {target.name}" for target in TARGETS]
    assert steps == [f"derive {entry.identifier}", *prints, "report"]


def test_a_robot_alone_is_printed_as_it_is_among_others(printed: list[File]) -> None:
    entry = catalogue()[-1]
    together = {file.path: file.text for file in printed}
    common = {"README.md", "__init__.py", "operations.json", "c/CMakeLists.txt", "VALIDATION.md", SCHEMA_FILE}
    alone = [file for file in print_all(derive([entry])) if file.path not in common]
    assert alone and all(together[file.path] == file.text for file in alone)


def test_two_files_of_one_path_are_refused(derived: Derived, monkeypatch: pytest.MonkeyPatch) -> None:
    from krhpr.codegen import pipeline

    monkeypatch.setattr(pipeline, "TARGETS", (*pipeline.TARGETS, pipeline.TARGETS[0]))
    with pytest.raises(ValueError, match=r"two targets write c/"):
        print_all(Derived(derived.robots[:1], Parts(), dict(derived.seconds)))
