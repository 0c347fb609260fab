from __future__ import annotations

import tomllib
from pathlib import Path

from setuptools import find_packages, setup

ROOT = Path(__file__).resolve().parent


def packages() -> list[str]:
    """The roots named in pyproject.toml's package-dir, and every package below each of them."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    folders: dict[str, str] = project["tool"]["setuptools"]["package-dir"]
    return sorted(
        name
        for root, folder in folders.items()
        for name in (root, *(f"{root}.{below}" for below in find_packages(str(ROOT / folder))))
    )


if __name__ == "__main__":
    setup(packages=packages())
