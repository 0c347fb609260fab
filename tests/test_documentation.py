"""The documentation is true: snippets and examples run, links and names exist, excerpts are fresh."""

from __future__ import annotations

import contextlib
import importlib
import importlib.util
import io
import os
import re
import shutil
import struct
import subprocess
import sys
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pytest

import krhpr
from tests.support import lacking, need

ROOT = Path(__file__).resolve().parent.parent
PICTURES = ROOT / "docs" / "pictures"
LARGEST_PICTURE = 120_000
OF_A_RUN = "performance_"
"""Pictures of what a benchmark measured are drawn with it, not from the code alone."""

REGION = re.compile(r"<!-- show: .+? -->.*?<!-- end -->", re.DOTALL)
FENCE = re.compile(r"^```(\w*)\n(.*?)^```$", re.DOTALL | re.MULTILINE)
SPAN = re.compile(r"`([^`\n]+)`")
LINK = re.compile(r"\]\(([^)\s]+)\)")


def load(path: Path) -> ModuleType:
    """A Python file outside the packages, as a module."""
    spec = importlib.util.spec_from_file_location(f"documentation_{path.stem}", path)
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module
    spec.loader.exec_module(module)
    return module


@cache
def refresh() -> ModuleType:
    return load(ROOT / "docs" / "refresh.py")


PAGES = [
    "README.md",
    "templates/README.md",
    "examples/README.md",
    *sorted(path.relative_to(ROOT).as_posix() for path in (ROOT / "docs").glob("*.md")),
]


@cache
def text(page: str) -> str:
    return (ROOT / page).read_text(encoding="utf-8")


def blocks(page: str, language: str) -> list[tuple[int, str]]:
    """First line and text of every fenced block of a language that is not filled in from the code."""
    own = REGION.sub(lambda match: "\n" * match[0].count("\n"), text(page))
    return [
        (own.count("\n", 0, match.start()) + 2, match[2])
        for match in FENCE.finditer(own)
        if match[1] == language
    ]


def prose(page: str) -> str:
    """A page without its fenced blocks."""
    return FENCE.sub("", text(page))


# -- what is shown is what is there -------------------------------------------------------------------------


@pytest.mark.parametrize("page", PAGES)
def test_excerpts_and_tables_are_those_of_the_code(page: str) -> None:
    assert refresh().refreshed(text(page)) == text(page), "run `make docs`"


def test_every_page_is_in_the_table_of_contents() -> None:
    contents = text("docs/README.md")
    missing = [page for page in PAGES if page.startswith("docs/") and Path(page).name not in contents]
    assert not missing


# -- snippets run -------------------------------------------------------------------------------------------


def expected_lines(code: str) -> list[str]:
    """What the comments behind `print(...)`, or below it, say that is printed."""
    found: list[str] = []
    below = False
    for line in code.splitlines():
        stripped = line.strip()
        if below and stripped.startswith("#"):
            found.append(stripped[1:].strip())
            continue
        below = False
        if stripped.startswith("print("):
            head, mark, comment = line.rpartition("  # ")
            if mark and head.rstrip().endswith(")"):
                found.append(comment.strip())
            else:
                below = True
    return found


SAVED = {"c": "arm.c", "cmake": "CMakeLists.txt"}
"""Blocks that commands find as files."""


def commands_of(code: str) -> list[str]:
    """The words by which the lines of a shell block begin."""
    return [line.split()[0] for line in code.replace("\\\n", " ").splitlines() if line.strip()]


def runs(code: str) -> bool:
    """Whether a shell block is run here: not those that would run these tests."""
    return "make" not in commands_of(code)


def rounded(output: str) -> str:
    """Without the last digits, which differ from compiler to compiler."""
    return re.sub(r"-?\d+\.\d+", lambda match: f"{float(match[0]):.9f}", output)


def run_python_block(page: str, first: int, code: str, namespace: dict[str, Any]) -> None:
    printed = io.StringIO()
    with contextlib.redirect_stdout(printed):
        exec(compile("\n" * (first - 1) + code, page, "exec"), namespace)
    assert printed.getvalue().splitlines() == expected_lines(code), f"{page}, block at line {first}"


def _in_haste(folder: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A `cc` that does as it is told without optimising, and builds of CMake without: what a page
    shows does not depend on that.
    """
    monkeypatch.setenv("CMAKE_BUILD_TYPE", "Debug")
    own = folder / "bin"
    own.mkdir()
    compiler = shutil.which("cc")
    if compiler is not None:
        (own / "cc").write_text(f'#!/bin/sh\nexec {compiler} "$@" -O0\n', encoding="utf-8")
        (own / "cc").chmod(0o755)
    return own


@pytest.mark.parametrize("page", [page for page in PAGES if blocks(page, "python") or blocks(page, "sh")])
def test_a_page_runs_and_prints_what_it_says(
    page: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Python and commands, in their order and in a folder of their own; a `text` block right behind commands
    is what they print.  A section ends where a program that it needs is missing.
    """
    monkeypatch.chdir(tmp_path)
    folders = (_in_haste(tmp_path, monkeypatch), Path(sys.executable).parent, os.environ["PATH"])
    monkeypatch.setenv("PATH", os.pathsep.join(map(str, folders)))
    for folder in ("examples", "generated"):
        (tmp_path / folder).symlink_to(ROOT / folder)
    own = REGION.sub(lambda match: "\n" * match[0].count("\n"), text(page))
    namespace: dict[str, Any] = {"__name__": "snippet"}
    skipped: dict[int, str] = {}
    printed, end = "", -1
    for match in FENCE.finditer(own):
        language, code = match[1], match[2]
        first = own.count("\n", 0, match.start()) + 2
        section = own.count("\n## ", 0, match.start())
        if section in skipped:
            continue
        if language in SAVED:
            (tmp_path / SAVED[language]).write_text(code, encoding="utf-8")
        elif language == "python":
            run_python_block(page, first, code, namespace)
        elif language == "sh" and runs(code):
            used = {"cc", "cmake"}.intersection(commands_of(code))
            reasons = [lacking(program) for program in sorted(used | {"cc"} if used else used)]
            if any(reasons):
                skipped[section] = next(filter(None, reasons))
                continue
            done = subprocess.run(["sh", "-euc", code], capture_output=True, text=True, check=False)
            assert done.returncode == 0, f"{page}, block at line {first}\n{done.stdout}{done.stderr}"
            printed, end = done.stdout, match.end()
        elif language == "text" and end >= 0 and not own[end : match.start()].strip():
            assert rounded(printed) == rounded(code), f"{page}, block at line {first}"
    if skipped:
        pytest.skip(f"commands of {page}: {next(iter(skipped.values()))}")


@pytest.mark.parametrize("page", [page for page in PAGES if blocks(page, "c")])
def test_c_of_a_page_compiles_and_runs(page: str, tmp_path: Path) -> None:
    compiler = next((name for name in ("cc", "gcc", "clang") if not lacking(name)), "cc")
    need(compiler)
    for first, code in blocks(page, "c"):
        match = re.search(r'#include "krhpr_(\w+)\.h"', code)
        assert match, f"{page}, block at line {first}"
        source, program = tmp_path / "arm.c", tmp_path / "arm"
        source.write_text(code, encoding="utf-8")
        folder = ROOT / "generated" / "c"
        flags = ["-std=c99", "-pedantic", "-Wall", "-Wextra", "-Werror", "-O0"]
        command = [
            compiler,
            *flags,
            f"-I{folder}",
            source,
            # a controller calls its robot
            *(folder / f"krhpr_{name}.c" for name in {match[1], match[1].removesuffix("_control")}),
            "-lm",
            "-o",
            program,
        ]
        subprocess.run(command, check=True)
        run = subprocess.run([program], capture_output=True, text=True, check=True)
        if page == "README.md":
            beta = np.radians([97.0, 97.0, 97.0])
            theta = krhpr.load(match[1]).inverse([0.0, 0.0, 0.35], np.eye(3), beta)
            assert np.allclose(np.loadtxt(io.StringIO(run.stdout)), theta, atol=1e-6)


def test_every_example_is_described() -> None:
    folder = ROOT / "examples"
    programs = [path for path in folder.rglob("*") if path.suffix in (".py", ".c")]
    assert len(programs) >= 3
    assert all(f"]({path.relative_to(folder).as_posix()})" in text("examples/README.md") for path in programs)


def test_examples_run() -> None:
    printed = {}
    for example in sorted((ROOT / "examples").glob("*.py")):
        run = subprocess.run([sys.executable, example], capture_output=True, text=True, check=False)
        assert run.returncode == 0, run.stderr
        printed[example.name] = run.stdout
    assert "raises Unreachable: leg 1" in printed["first_steps.py"]
    rows = re.findall(
        r"^(?:integral|largest|smallest).*?([\d.]+)\s+([\d.]+)$", printed["casadi_trajectory.py"], re.M
    )
    (effort, better), (fastest, slower), (_, margin) = ((float(a), float(b)) for a, b in rows)
    assert better < 0.6 * effort
    assert slower < fastest
    assert margin >= 0.5


# -- links and names exist ----------------------------------------------------------------------------------


@pytest.mark.parametrize("page", PAGES)
def test_links_lead_somewhere(page: str) -> None:
    folder = (ROOT / page).parent
    targets = [link.partition("#")[0] for link in LINK.findall(prose(page)) if "://" not in link]
    missing = [target for target in targets if target and not (folder / target).exists()]
    assert not missing


@cache
def commands() -> set[str]:
    """Sub-commands of krhpr."""
    usage = subprocess.run(
        [sys.executable, "-m", "krhpr", "--help"], capture_output=True, text=True, check=True
    )
    return set(re.findall(r"^    (\w+)  ", usage.stdout, re.MULTILINE))


@cache
def make_targets() -> set[str]:
    return set(re.findall(r"^([a-z-]+):", (ROOT / "Makefile").read_text(encoding="utf-8"), re.MULTILINE))


@cache
def c_names() -> frozenset[str]:
    headers = (path.read_text(encoding="utf-8") for path in (ROOT / "generated" / "c").glob("*.h"))
    return frozenset(re.findall(r"\bkrhpr_\w+", " ".join(headers)))


def exists(dotted: str) -> bool:
    """Whether a dotted name can be imported or is an attribute of what can."""
    parts = dotted.split(".")
    for length in range(len(parts), 0, -1):
        try:
            found: Any = importlib.import_module(".".join(parts[:length]))
        except ImportError:
            continue
        for name in parts[length:]:
            if not hasattr(found, name):
                return False
            found = getattr(found, name)
        return True
    return False


FOLDERS = "derivations|krhpr|templates|generated|docs|examples|tests|benchmarks"
STATUSES = {*krhpr.Status.__members__, "SINGULAR_LEG", "UNREACHABLE", "UNREACHABLE_LEG"}


def wrong(span: str) -> Iterator[str]:
    """What a span in code font names and does not exist."""
    for name in re.findall(r"\b(?:spatial|planar)_[a-z0-9_]+_[abc]\b", span):
        if name not in krhpr.catalogue():
            yield f"robot {name}"
    for name in re.findall(r"\brobot\.casadi\.(\w+)", span):
        if name not in dir(krhpr.load("spatial_r_fivebar_a").casadi):
            yield f"robot.casadi.{name}"
    for name in re.findall(r"\brobot\.(\w+)", span):
        if not hasattr(krhpr.load("spatial_r_fivebar_a"), name):
            yield f"robot.{name}"
    for name in re.findall(r"(?<![\w/.])krhpr(?:\.[A-Za-z_]\w*)+(?!\w*\()", span):
        if not exists(name) and not name.endswith((".h", ".c")):
            yield name
    for name in re.findall(r"\bkrhpr_[a-z0-9_]+(?<!_)\b(?!<|\.)", span):
        if "<" not in span and "..." not in span and name not in c_names():
            yield name
    for name in re.findall(rf"(?<![\w./-])(?:{FOLDERS})/[\w./-]*", span):
        if not (ROOT / name).exists():
            yield name
    for name in re.findall(r"(?<![\w-])krhpr ([a-z]+)", span):
        if name not in commands():
            yield f"command krhpr {name}"
    for name in re.findall(r"(?<![\w-])make ([a-z-]+)", span):
        if name not in make_targets():
            yield f"make {name}"
    if re.fullmatch(r"(UNREACHABLE|SINGULAR|INVALID|NO|AMBIGUOUS)[A-Z0-9_]*", span) and span not in STATUSES:
        yield f"status {span}"


@pytest.mark.parametrize("page", PAGES)
def test_names_in_code_font_exist(page: str) -> None:
    spans = {
        *SPAN.findall(prose(page)),
        *(line for _, code in blocks(page, "sh") for line in code.splitlines()),
    }
    problems = {span: found for span in sorted(spans) if (found := list(wrong(span)))}
    assert not problems


# -- pictures -----------------------------------------------------------------------------------------------


def size(path: Path) -> tuple[int, int]:
    """Width and height of a PNG."""
    head = path.read_bytes()[:24]
    assert head[:8] == b"\x89PNG\r\n\x1a\n"
    width, height = struct.unpack(">II", head[16:24])
    return width, height


@pytest.mark.full
def test_pictures_can_be_drawn_again(tmp_path: Path) -> None:
    subprocess.run([sys.executable, PICTURES / "make.py", tmp_path], check=True)
    drawn = {path.name: size(path) for path in tmp_path.glob("*.png")}
    kept = {path.name: size(path) for path in PICTURES.glob("*.png") if not path.name.startswith(OF_A_RUN)}
    assert drawn == kept, "run `make docs`"
    assert all(path.stat().st_size < LARGEST_PICTURE for path in PICTURES.glob("*.png"))


def test_every_picture_is_shown() -> None:
    shown = {Path(link).name for page in PAGES for link in LINK.findall(prose(page)) if link.endswith(".png")}
    assert shown == {path.name for path in PICTURES.glob("*.png")}
