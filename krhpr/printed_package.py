"""A folder of generated files, imported as a package under a name of its own."""

from __future__ import annotations

import importlib
import importlib.util
import sys
from functools import cache
from itertools import count
from pathlib import Path
from types import ModuleType

import krhpr.generated

GENERATED = Path(krhpr.generated.__path__[0])
"""The folder of krhpr.generated."""

_numbers = count()


@cache
def _package(folder: Path) -> str:
    if folder == GENERATED:
        return "krhpr.generated"
    name = f"krhpr_printed_{next(_numbers)}"
    spec = importlib.util.spec_from_file_location(
        name, folder / "__init__.py", submodule_search_locations=[str(folder)]
    )
    assert spec is not None and spec.loader is not None
    package = importlib.util.module_from_spec(spec)
    sys.modules[name] = package
    spec.loader.exec_module(package)
    return name


def submodule(folder: Path, name: str) -> ModuleType:
    """A module of the folder, such as `python.spatial_rrr_a`."""
    return importlib.import_module(f"{_package(folder)}.{name}")
