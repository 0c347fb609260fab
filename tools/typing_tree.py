"""Lay out links that show a type checker the project's folders as they are installed.

    python tools/typing_tree.py [FOLDER]

`krhpr.derivations` lives in derivations/, beside krhpr/ and not inside it; no checker knows of package-dir.
In FOLDER (build/typing) each root of pyproject.toml's package-dir becomes what it is after an installation.
Running it again repairs what has changed since.
"""

from __future__ import annotations

import os
import sys
import tomllib
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent


def links(folder: Path) -> dict[Path, Path]:
    """Each link of the tree and the file or folder of the project that it stands for."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    wanted: dict[Path, Path] = {}
    for package, source in sorted(project["tool"]["setuptools"]["package-dir"].items()):
        place = folder.joinpath(*package.split("."))
        if "." in package:
            if place in wanted:
                raise SystemExit(f"{wanted[place]} and {ROOT / source} would both be installed as {package}")
            wanted[place] = ROOT / source
            continue
        for entry in sorted((ROOT / source).iterdir()):
            if entry.name != "__pycache__" and not entry.name.startswith("."):
                wanted[place / entry.name] = entry
    return wanted


def lay_out(folder: Path) -> None:
    wanted = links(folder)
    for parent in sorted({link.parent for link in wanted}):
        parent.mkdir(parents=True, exist_ok=True)
        for old in parent.iterdir():
            if old not in wanted and old.is_symlink():
                old.unlink()
    for link, source in wanted.items():
        target = os.path.relpath(source, link.parent)
        if link.is_symlink() and os.readlink(link) == target:
            continue
        link.unlink(missing_ok=True)
        link.symlink_to(target)


if __name__ == "__main__":
    lay_out(ROOT / (sys.argv[1] if len(sys.argv) > 1 else "build/typing"))
