"""What every target does: turn parts and robots into files.  A target is one module here and one folder of
templates.
"""

from __future__ import annotations

import json
import textwrap
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cache, lru_cache
from typing import Any, Protocol

import jinja2

import krhpr.templates
from krhpr.codegen.kernel import Kernel, Port
from krhpr.codegen.part import Part
from krhpr.codegen.robot_code import RobotCode


@dataclass(frozen=True)
class File:
    """A file to write, with its path relative to the output folder."""

    path: str
    text: str


class Target(Protocol):
    """One output language."""

    name: str

    def shared(self) -> Iterable[File]:
        """Files that do not depend on a robot."""

    def part(self, part: Part) -> Iterable[File]:
        """The files of one sub-leg, platform arrangement or algebra."""

    def robot(self, robot: RobotCode) -> Iterable[File]:
        """The files of one robot."""


@cache
def environment() -> jinja2.Environment:
    """The template environment: undefined names are errors, nothing is escaped, blocks leave no blank
    lines.
    """
    env = jinja2.Environment(
        loader=jinja2.FileSystemLoader(list(krhpr.templates.__path__)),
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
        autoescape=False,  # the output is source code
    )
    env.filters["wrap"] = wrap
    env.filters["literal"] = literal
    env.filters["port_literal"] = port_literal
    env.globals["zip"] = zip
    env.globals["broken"] = broken
    return env


def render(template: str, **context: Any) -> str:
    """Render one template; trailing blanks are removed and the text ends with one newline."""
    text = environment().get_template(template).render(**context)
    return "\n".join(line.rstrip() for line in text.splitlines()).rstrip("\n") + "\n"


@lru_cache(maxsize=8192)
def _lines(text: str, width: int) -> tuple[str, ...]:
    """A paragraph broken between words; robots say much in the same words."""
    return tuple(textwrap.wrap(text, width, break_long_words=False, break_on_hyphens=False))


def wrap(text: str, width: int = 100, prefix: str = "", first: str | None = None) -> str:
    """Break a paragraph into lines that start with `prefix` (the first with `first`)."""
    lines = _lines(text, width - len(prefix))
    start = prefix if first is None else first
    return "\n".join((start if i == 0 else prefix) + line for i, line in enumerate(lines or ("",)))


def broken(head: str, items: Sequence[str], tail: str = "", indent: int = 0, width: int = 110) -> str:
    """`head(items)tail`, on several lines where one would be too long; the first line is not indented."""
    whole = f"{head}({', '.join(items)}){tail}"
    if indent + len(whole) <= width:
        return whole
    margin = " " * (indent + 4)
    lines = _lines(", ".join(item.replace(" ", "\0") for item in items), width - len(margin) - len(tail) - 1)
    return f"{head}(\n" + "\n".join(margin + line.replace("\0", " ") for line in lines) + f"){tail}"


def literal(value: object) -> str:
    """A Python literal, with strings in double quotes."""
    return json.dumps(value, ensure_ascii=False) if isinstance(value, str) else repr(value)


def port_literal(port: Port) -> str:
    """The arguments that make a port again in a generated module (`rt.Port(...)`)."""
    labels = "(" + "".join(f"{literal(label)}, " for label in port.labels) + ")"
    texts = (port.name, str(port.unit), str(port.frame), port.doc, str(port.layout))
    name, unit, frame, doc, layout = (literal(text) for text in texts)
    return f"{name}, {port.full_shape!r}, {unit}, {frame}, {doc}, {layout}, {labels}"


def shape_text(shape: Sequence[int]) -> str:
    """A shape in words: `3 x 3`, or `scalar`."""
    return " x ".join(str(length) for length in shape) if shape else "scalar"


def port_text(port: Port, *, full: bool) -> str:
    """`Q (3 x 3, base frame): orientation`: what a person needs to know of an argument."""
    facts = [shape_text(port.full_shape if full else port.shape)]
    if port.unit != "1":
        facts.append(port.unit)
    if port.frame != "-":
        facts.append(f"{port.frame} frame")
    text = f"{port.name} ({', '.join(facts)}): {port.doc or port.name}"
    if port.labels:
        text += f" [{', '.join(port.labels)}]"
    return text


def kernel_comment(kernel: Kernel) -> str:
    """What a kernel computes, with the thesis' equations and the operations of one call."""
    text = kernel.doc
    if kernel.equations:
        text += f"  Thesis: {kernel.equations}."
    operations = kernel.operations.as_dict()
    counts = ", ".join(f"{count} {name.replace('_', ' ')}" for name, count in operations.items() if count)
    return f"{text}  ({counts or 'no operations'})"
