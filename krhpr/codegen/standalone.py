"""A folder that stands alone: some robots' code gathered for a project of one's own.

The Python and CasADi modules are those of `generated/`; they import one another by relative names, so that
the folder is a package wherever it lies.  In C each robot becomes three files, its header, its source and
that of its batches, shared headers included.
"""

from __future__ import annotations

import inspect
import re
from collections.abc import Container, Iterable, Iterator, Mapping, Sequence
from pathlib import PurePosixPath

import krhpr.limits
from krhpr.codegen.pipeline import Derived
from krhpr.codegen.report import SCHEMA_FILE
from krhpr.codegen.targets.base import File, render

GENERATED_PACKAGE = "krhpr.generated"
"""What the modules call the package that they lie in, in their documentation."""

_LEFT_OUT = ("README.md", SCHEMA_FILE)
"""What is about the whole catalogue."""

_LIMITS_MARK = "# Written by `krhpr generate`; do not edit.\n"

_INCLUDE = re.compile(r'^#include "([^"]+)"\n', re.MULTILINE)


def standalone_files(derived: Derived, files: Sequence[File], package: str) -> list[File]:
    """What a folder called `package` holds, of the files that `print_all` made for `derived`."""
    identifiers = [robot.identifier for robot in derived.robots]
    gathered = list(_gather(files, identifiers, package))
    gathered.append(File("README.md", render("standalone.md.j2", robots=derived.robots, package=package)))
    if any(robot.limits for robot in derived.robots):
        gathered.append(File("python/limits.py", _LIMITS_MARK + inspect.getsource(krhpr.limits)))
    return sorted(gathered, key=lambda file: file.path)


def _gather(files: Sequence[File], identifiers: Sequence[str], package: str) -> Iterator[File]:
    sources = {PurePosixPath(file.path).name: file.text for file in files if file.path.startswith("c/")}
    own = {name for name in sources if _is_of(name, identifiers)}
    for file in files:
        path = PurePosixPath(file.path)
        if path.name in own:
            yield File(file.path, _written_out(file.text, sources, own))
        elif path.suffix == ".py":
            yield File(file.path, file.text.replace(GENERATED_PACKAGE, package))
        elif path.suffix != ".h" and file.path not in _LEFT_OUT:
            yield file


def _is_of(name: str, identifiers: Iterable[str]) -> bool:
    """Whether a C file is a robot's own: krhpr_<robot>.c, krhpr_<robot>_<something>.h."""
    return any(re.fullmatch(rf"krhpr_{identifier}(_\w+)?\.[ch]", name) for identifier in identifiers)


def _written_out(text: str, sources: Mapping[str, str], own: Container[str]) -> str:
    """A robot's C file with the shared headers that it includes in their place, each once."""
    seen: set[str] = set()

    def insert(match: re.Match[str]) -> str:
        included = PurePosixPath(match[1]).name
        if included in own:  # stays, and brings all that it includes
            seen.update(_included(included, sources))
            return match[0]
        if included in seen:
            return ""
        seen.add(included)
        return _INCLUDE.sub(insert, sources[included])

    return _INCLUDE.sub(insert, text)


def _included(name: str, sources: Mapping[str, str]) -> Iterator[str]:
    for path in _INCLUDE.findall(sources[name]):
        included = PurePosixPath(path).name
        yield included
        yield from _included(included, sources)
