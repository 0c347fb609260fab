"""A folder that stands alone: some robots' code gathered for a project of one's own.

The Python and CasADi modules are those of `generated/`; they import one another by relative names, so that
the folder is a package wherever it lies.  In C each robot becomes one pair of files, shared headers included.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Sequence
from pathlib import PurePosixPath

from krhpr.codegen.pipeline import Derived
from krhpr.codegen.targets.base import File, render

GENERATED_PACKAGE = "krhpr.generated"
"""What the modules call the package that they lie in, in their documentation."""

_INCLUDE = re.compile(r'^#include "([^"]+)"\n', re.MULTILINE)


def standalone_files(derived: Derived, files: Sequence[File], package: str) -> list[File]:
    """What a folder called `package` holds, of the files that `print_all` made for `derived`."""
    identifiers = [robot.identifier for robot in derived.robots]
    return sorted(_gather(files, identifiers, package), key=lambda file: file.path)


def _gather(files: Sequence[File], identifiers: Sequence[str], package: str) -> Iterator[File]:
    headers = {PurePosixPath(file.path).name: file.text for file in files if file.path.endswith(".h")}
    own = {f"krhpr_{identifier}.{ending}" for identifier in identifiers for ending in ("h", "c")}
    for file in files:
        path = PurePosixPath(file.path)
        if path.name in own:
            yield File(file.path, _written_out(path.name, file.text, headers, own))
        elif path.suffix == ".py":
            yield File(file.path, file.text.replace(GENERATED_PACKAGE, package))
        elif path.suffix != ".h" and file.path != "README.md":
            yield file
    yield File("README.md", render("standalone.md.j2", identifiers=identifiers, package=package))


def _written_out(name: str, text: str, headers: dict[str, str], own: Iterable[str]) -> str:
    """A source or header with the shared headers that it includes in their place, each once."""
    # a robot's source includes its header, and with that whatever the header holds
    header = name.removesuffix(".c") + ".h"
    seen = set(_included(header, headers)) if name.endswith(".c") else set()

    def insert(match: re.Match[str]) -> str:
        included = match[1]
        if included in own:
            return match[0]
        if included in seen:
            return ""
        seen.add(included)
        return _INCLUDE.sub(insert, headers[included])

    return _INCLUDE.sub(insert, text)


def _included(name: str, headers: dict[str, str]) -> Iterator[str]:
    for included in _INCLUDE.findall(headers[name]):
        yield included
        yield from _included(included, headers)
