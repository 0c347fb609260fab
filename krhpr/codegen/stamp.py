"""What the last run of `krhpr generate` read and wrote, so that the next one sees that nothing changed.

A digest of all that goes into generated files (this package, the derivations, the templates, the versions of
what they run on) and one of all that came out.  Where both still hold, generating again would write what is
there.  `krhpr generate --check` and the tests do not trust it.
"""

from __future__ import annotations

import hashlib
import json
import os
import sys
import tempfile
from collections.abc import Iterable, Mapping, Sequence
from contextlib import suppress
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

import krhpr
import krhpr.derivations
import krhpr.templates
from krhpr.native.cache import cache_folder

RUNS_ON = ("sympy", "mpmath", "jinja2", "markupsafe", "numpy")
_READ = (".py", ".j2", ".json", ".yaml")

Rows = Sequence[Mapping[str, Any]]
"""What the command shows of a run, a row for each robot."""


def recall(folder: Path) -> Rows | None:
    """The rows of the last run, if its inputs and its outputs in `folder` are still the same."""
    try:
        found = json.loads(_place(folder).read_bytes())
        same = found["inputs"] == inputs_digest(folder) and found["outputs"] == outputs_digest(folder)
        return list(found["rows"]) if same else None
    except (OSError, ValueError, KeyError, TypeError):
        return None


def remember(folder: Path, inputs: str, rows: Rows) -> None:
    """Keep what a run read (a digest from before it), what is in `folder` after it, and its rows."""
    text = json.dumps({"inputs": inputs, "outputs": outputs_digest(folder), "rows": list(rows)})
    place = _place(folder)
    with suppress(OSError):  # it saves time, no more
        place.parent.mkdir(mode=0o700, parents=True, exist_ok=True)
        handle, scratch = tempfile.mkstemp(dir=place.parent, prefix="generated-")
        with os.fdopen(handle, "w") as file:
            file.write(text)
        os.replace(scratch, place)


def inputs_digest(folder: Path) -> str:
    """A digest of everything that what is generated into `folder` may depend on."""
    roots = {
        Path(place).resolve()
        for package in (krhpr, krhpr.derivations, krhpr.templates)
        for place in package.__path__
    }
    files = {path for root in roots for path in _files(root, but=folder.resolve()) if path.suffix in _READ}
    return _digest(sorted(files), [sys.version, *map(_version, RUNS_ON)])


def outputs_digest(folder: Path) -> str:
    """A digest of every file in a folder."""
    return _digest(sorted(_files(folder)), [])


def _place(folder: Path) -> Path:
    return cache_folder() / f"generated-{hashlib.sha256(os.fsencode(folder.resolve())).hexdigest()[:32]}.json"


def _files(root: Path, but: Path | None = None) -> Iterable[Path]:
    for place, below, names in os.walk(root):
        below[:] = [name for name in below if name != "__pycache__" and Path(place, name) != but]
        yield from (Path(place, name) for name in names)


def _digest(files: Iterable[Path], more: Iterable[str]) -> str:
    found = hashlib.sha256()
    for path in files:
        for part in (os.fsencode(path), path.read_bytes()):
            found.update(len(part).to_bytes(8, "big"))
            found.update(part)
    found.update(json.dumps(list(more)).encode())
    return found.hexdigest()


def _version(distribution: str) -> str:
    try:
        return version(distribution)
    except PackageNotFoundError:
        return "none"
