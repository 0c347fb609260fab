"""The project as it is installed: one import name over four folders, data files, NumPy alone to use it."""

from __future__ import annotations

import ast
import glob
import os
import re
import runpy
import subprocess
import sys
import tomllib
import zipfile
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parent.parent
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
FOLDERS: dict[str, str] = PROJECT["tool"]["setuptools"]["package-dir"]
DATA: dict[str, list[str]] = PROJECT["tool"]["setuptools"]["package-data"]

# Installed under krhpr, and never to be imported by these names.
BARE = {folder for package, folder in FOLDERS.items() if package != folder}

# What deriving, generating, proving and drawing take, and using the generated functions does not.
HEAVY = ("casadi", "flint", "jinja2", "matplotlib", "mpmath", "pycparser", "rich", "scipy", "sympy", "yaml")

USE_WITH_NUMPY_ALONE = f"""
import sys

class Blocked:
    def find_spec(self, name, path=None, target=None):
        if name.partition(".")[0] in {HEAVY!r}:
            raise ImportError(f"{{name}} is not for users of generated functions")

sys.meta_path.insert(0, Blocked())

import krhpr
from krhpr.generated import spatial_rrr_a

print(krhpr.__file__)
"""


@cache
def project_files() -> tuple[Path, ...]:
    """The files below the root: what git has or would add; without git, all but hidden and built ones."""
    listing = subprocess.run(
        ["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=False,
    )
    if listing.returncode == 0:
        files = {Path(name) for name in listing.stdout.split("\0") if name}
        return tuple(sorted(file for file in files if (ROOT / file).is_file()))
    left_out = {"__pycache__", "build", "dist"}
    found = []
    for folder, below, names in os.walk(ROOT):
        below[:] = [
            n for n in below if n not in left_out and not n.startswith(".") and not n.endswith(".egg-info")
        ]
        found += [Path(folder, name).relative_to(ROOT) for name in names]
    return tuple(sorted(found))


def files_of(package: str) -> Iterator[Path]:
    """The files below a root package, relative to its folder."""
    folder = Path(FOLDERS[package])
    for file in project_files():
        if folder in file.parents:
            yield file.relative_to(folder)


def imported(tree: ast.AST) -> Iterator[tuple[int, str]]:
    """Line and full name of each module that a syntax tree imports, calls of import_module included."""
    for node in ast.walk(tree):
        match node:
            case ast.Import(names=names):
                yield from ((node.lineno, alias.name) for alias in names)
            case ast.ImportFrom(module=str(module), level=0):
                yield node.lineno, module
            case ast.Call(
                func=ast.Name(id="import_module" | "__import__") | ast.Attribute(attr="import_module"),
                args=[ast.Constant(value=str(module)), *_],
            ):
                yield node.lineno, module


def test_nothing_imports_the_folders_by_their_bare_names() -> None:
    # parsing takes long: not where no line could be such an import
    names = "|".join(sorted(BARE))
    suspect = re.compile(rf"^\s*(from|import)\b.*\b({names})\b|__?import|import_module", re.MULTILINE)
    found = [
        f"{file}:{line}: {module}"
        for file in project_files()
        if file.suffix == ".py" and suspect.search(text := (ROOT / file).read_text(encoding="utf-8"))
        for line, module in imported(ast.parse(text, str(file)))
        if module.partition(".")[0] in BARE
    ]
    assert not found, "import these from krhpr"


def test_no_template_imports_the_folders_by_their_bare_names() -> None:
    statement = re.compile(rf"^\s*(from|import)\s+({'|'.join(sorted(BARE))})\b", re.MULTILINE)
    found = [
        f"{file}: {match[0].strip()}"
        for file in project_files()
        if file.suffix == ".j2"
        for match in statement.finditer((ROOT / file).read_text(encoding="utf-8"))
    ]
    assert not found, "import these from krhpr"


def test_every_folder_of_python_files_is_a_package() -> None:
    listed = set(runpy.run_path(str(ROOT / "setup.py"), run_name="setup")["packages"]())
    missing = set()
    for root, top in FOLDERS.items():
        for file in files_of(root):
            if file.suffix == ".py":
                for folder in (file.parent, *file.parent.parents):
                    package = ".".join((root, *folder.parts))
                    if package not in listed or not (ROOT / top / folder / "__init__.py").is_file():
                        missing.add(package)
    assert not missing, "these need an __init__.py in every folder from the root on"


@pytest.mark.parametrize("package", FOLDERS)
def test_every_other_file_is_package_data(package: str) -> None:
    folder = ROOT / FOLDERS[package]
    covered = {
        Path(found)
        for pattern in DATA.get(package, [])
        for found in glob.glob(pattern, root_dir=folder, recursive=True)
    }
    written = set(files_of(package))
    # Notes for readers of the sources may stay behind.
    left_behind = {file for file in written - covered if file.suffix not in {".py", ".md"}}
    assert not left_behind, f"extend [tool.setuptools.package-data] of {package}"


def test_generated_functions_take_numpy_alone(tmp_path: Path) -> None:
    run = subprocess.run(
        [sys.executable, "-c", USE_WITH_NUMPY_ALONE],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        check=False,
    )
    assert run.returncode == 0, run.stderr


@pytest.mark.full
def test_a_wheel_holds_every_file_and_works_where_it_is_unpacked(tmp_path: Path) -> None:
    source, site = tmp_path / "source", tmp_path / "site"
    for file in project_files():
        (source / file).parent.mkdir(parents=True, exist_ok=True)
        (source / file).write_bytes((ROOT / file).read_bytes())
    build = [sys.executable, "-m", "pip", "wheel", "--quiet", "--no-deps", "--no-build-isolation", "-w"]
    subprocess.run([*build, str(tmp_path), str(source)], check=True)
    (wheel,) = tmp_path.glob("krhpr-*.whl")
    with zipfile.ZipFile(wheel) as archive:
        archive.extractall(site)
        packed = {name for name in archive.namelist() if ".dist-info/" not in name}
    expected = {
        "/".join((*package.split("."), *file.parts))
        for package in FOLDERS
        for file in files_of(package)
        if file.suffix != ".md" or package == "krhpr.generated"
    }
    assert packed == expected

    run = subprocess.run(
        [sys.executable, "-c", f"import sys; sys.path.insert(0, {str(site)!r})\n{USE_WITH_NUMPY_ALONE}"],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        check=False,
    )
    assert run.returncode == 0, run.stderr
    assert site in Path(run.stdout.strip()).parents


def canonical(requirement: str) -> str:
    """The normalised name of the distribution that a requirement asks for."""
    match = re.match(r"[A-Za-z0-9._-]+", requirement)
    assert match, requirement
    return re.sub(r"[-_.]+", "-", match[0]).lower()


def lock(name: str) -> dict[str, str]:
    """Name and version of everything in a lock; each must have hashes, and come from an index."""
    text = (ROOT / "requirements" / f"{name}.txt").read_text(encoding="utf-8").replace("\\\n", " ")
    pins = {}
    for line in text.splitlines():
        if line.strip() and not line.lstrip().startswith("#"):
            match = re.fullmatch(
                r"([a-z0-9-]+)==(\S+)( ; [^\\]+?)?((?:\s+--hash=sha256:[0-9a-f]{64})+)\s*", line
            )
            assert match, f"requirements/{name}.txt: {line[:80]}"
            assert match[1] not in pins, f"requirements/{name}.txt: {match[1]} in two versions"
            pins[match[1]] = match[2]
    return pins


@pytest.mark.parametrize(("smaller", "larger"), [("generate", "test"), ("test", "bench")])
def test_each_lock_holds_the_one_before_it(smaller: str, larger: str) -> None:
    assert lock(smaller).items() <= lock(larger).items(), "run `make lock`"


@pytest.mark.parametrize(
    ("name", "extras"),
    [
        ("generate", ("generate", "casadi")),
        ("test", ("generate", "casadi", "validate", "plot", "test", "lint")),
        ("bench", ("bench",)),
    ],
)
def test_each_lock_holds_what_the_project_asks_for(name: str, extras: tuple[str, ...]) -> None:
    optional = PROJECT["project"]["optional-dependencies"]
    asked = {canonical(r) for r in PROJECT["project"]["dependencies"]}
    asked |= {canonical(r) for extra in extras for r in optional[extra]} - {"krhpr"}
    assert asked <= lock(name).keys(), f"add to requirements/{name}.in and run `make lock`"
