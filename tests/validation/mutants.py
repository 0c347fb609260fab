"""Mistakes on purpose: in copies of derivations, of kernels' graphs, of templates and of printed texts.

A validation that does not notice them is worth nothing.  Nothing here touches the project's own files.
"""

from __future__ import annotations

import os
import re
import shutil
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from random import Random
from typing import Any

import jinja2
import pytest

from krhpr.codegen.graph import Graph, GraphError, Op
from krhpr.codegen.kernel import Kernel
from krhpr.codegen.output import write
from krhpr.codegen.pipeline import derive, print_all
from krhpr.codegen.targets import base as targets
from krhpr.derivations.catalogue import Entry
from krhpr.derivations.platforms.base import Platform
from krhpr.derivations.robots import Robot
from krhpr.derivations.sublegs.base import SubLeg
from krhpr.printed_package import GENERATED
from krhpr.validation.check import Check, Kind, Target
from krhpr.validation.outcome import State
from krhpr.validation.plan import plan
from krhpr.validation.printed import forget
from krhpr.validation.run import Result, carry_out
from krhpr.validation.subject import Subject

# -- derivations -----------------------------------------------------------------------------------


def with_parts(entry: Entry, subleg: SubLeg | None = None, platform: Platform | None = None) -> Subject:
    """A robot of the catalogue with another sub-leg or arrangement in the place of its own."""
    robot = Robot(subleg or entry.robot.subleg, platform or entry.robot.platform)
    return Subject(replace(entry, robot=robot))


def changed(part: Any, **methods: Any) -> Any:
    """An instance like `part` whose methods are wrapped: each wrapper takes what the method returns."""

    def wrap(name: str, change: Any) -> Any:
        original = getattr(type(part), name)
        return lambda self, *args, **kwargs: change(original(self, *args, **kwargs))

    return type("Changed", (type(part),), {name: wrap(name, change) for name, change in methods.items()})()


def failing(subject: Subject, kind: Kind, names: Iterable[str] | None = None) -> list[Result]:
    """The checks of a kind that fail."""
    checks = [c for c in plan(subject.code) if c.kind is kind and (names is None or c.name in names)]
    results = (carry_out(subject, check, "small") for check in checks)
    return [result for result in results if result.state is State.FAILED]


def first_failure(subject: Subject, kind: Kind, target: Target, part: str = "") -> Result | None:
    """The first check of a kind on a target that fails; those of a part's kernels are tried first."""
    checks = [check for check in plan(subject.code) if check.kind is kind and check.target is target]
    try:
        for check in sorted(checks, key=lambda check: check.shared != part):
            result = carry_out(subject, check, "small")
            if result.state is State.FAILED:
                return result
        return None
    finally:
        if subject.folder != GENERATED:
            forget(subject.folder)


def failed(subject: Subject, check: Check) -> bool:
    """Whether a check fails on small samples."""
    return carry_out(subject, check, "small").state is State.FAILED


# -- graphs ----------------------------------------------------------------------------------------

_SWAPS = {
    Op.ADD: Op.SUB,
    Op.SUB: Op.ADD,
    Op.MUL: Op.DIV,
    Op.DIV: Op.MUL,
    Op.SIN: Op.COS,
    Op.COS: Op.SIN,
    Op.MIN: Op.MAX,
    Op.MAX: Op.MIN,
}


def mutable_nodes(kernel: Kernel, leave_out: Iterable[str] = ()) -> list[int]:
    """Operations that the outputs need (but for some outputs) and that have an opposite."""
    outputs = [
        node for port in kernel.outputs if port.name not in leave_out for node in kernel.results[port.name]
    ]
    needed = kernel.graph.needed(outputs)
    return [
        index for index, node in kernel.graph if needed[index] and (node.op in _SWAPS or node.op is Op.NEG)
    ]


def mutated(kernel: Kernel, where: int) -> Kernel | None:
    """The kernel with one operation exchanged for its opposite; None where that has no meaning."""
    graph = Graph()
    place: list[int] = []
    try:
        for index, node in kernel.graph:
            if index != where:
                place.append(graph.replay(node, place))
            elif node.op is Op.NEG:
                place.append(place[node.args[0]])
            else:
                place.append(graph.apply(_SWAPS[node.op], [place[argument] for argument in node.args]))
    except GraphError:
        return None
    results = {name: tuple(place[node] for node in nodes) for name, nodes in kernel.results.items()}
    return replace(kernel, graph=graph, results=results)


# -- templates and texts ---------------------------------------------------------------------------


@contextmanager
def changed_template(name: str, old: str, new: str) -> Iterator[None]:
    """Within the context templates are rendered with one of them changed, in memory."""
    environment = targets.environment()
    loader = environment.loader
    assert loader is not None
    text, _, _ = loader.get_source(environment, name)
    assert old in text, f"{name} has no {old!r}"
    overlay = environment.overlay(
        loader=jinja2.ChoiceLoader([jinja2.DictLoader({name: text.replace(old, new)}), loader])
    )
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(targets, "environment", lambda: overlay)
        yield


def printed(entries: list[Entry], folder: Path) -> Path:
    """Robots printed to a folder."""
    write(print_all(derive(entries)), folder)
    return folder


def changed_text(folder: Path, path: str, text: str) -> Path:
    """The generated files, by links, with another text in the place of one."""
    shutil.copytree(GENERATED, folder, copy_function=os.symlink, ignore=shutil.ignore_patterns("__pycache__"))
    (folder / path).unlink()
    (folder / path).write_text(text, encoding="utf-8")
    return folder


_OPERATORS = {" + ": " - ", " - ": " + ", " * ": " / ", " / ": " * "}
_SYMBOLS = re.compile(r" [-+*/] |\bsine\b|\bcosine\b|np\.sin|np\.cos|ca\.sin|ca\.cos|= -(?=\w)")
_WORDS = {
    "sine": "cosine",
    "cosine": "sine",
    "np.sin": "np.cos",
    "np.cos": "np.sin",
    "ca.sin": "ca.cos",
    "ca.cos": "ca.sin",
    "= -": "= ",
}


def formula_places(text: str, start: str, stop: str = "") -> list[tuple[int, int, str]]:
    """Where a formula of a printed text can be changed: on lines that compute, outside of comments."""
    places = []
    offset = 0
    for line in text.splitlines(keepends=True):
        code = re.split(r"/\*|  #", line)[0]
        if re.match(start, code) and not (stop and re.search(stop, code)):
            equals = code.index("=") if "=" in code else 0
            for match in _SYMBOLS.finditer(code, max(equals - 1, 0)):
                word = match.group()
                places.append(
                    (offset + match.start(), offset + match.end(), _OPERATORS.get(word) or _WORDS[word])
                )
        offset += len(line)
    return places


def changed_at(text: str, place: tuple[int, int, str]) -> tuple[str, str]:
    """The text with one place changed, and the line that it stands on."""
    begin, end, new = place
    result = text[:begin] + new + text[end:]
    first = result.rfind("\n", 0, begin) + 1
    return result, result[first : result.find("\n", begin)].strip()


def sample(places: list[Any], count: int, seed: int) -> list[Any]:
    """Some of the places, the same on every run."""
    return Random(seed).sample(places, min(count, len(places)))
