"""YAML as a tree of texts, lists and tables that know their lines; nothing is ever made of it by YAML itself.

The events of PyYAML's safe loader are read, and no node is resolved or constructed: every scalar stays the
text that it is.  Anchors, aliases and tags are refused, and so are files that are very large or deep, so that
neither code nor a small file that unfolds into a large one gets any further.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any, NoReturn

from krhpr.robot_files.problems import Problem, RobotFileError, shown

MOST_BYTES = 100_000
MOST_DEPTH = 8


@dataclass(frozen=True)
class Text:
    """A scalar as it stands in the file; `plain`: without quotes."""

    text: str
    plain: bool
    line: int


@dataclass(frozen=True)
class Items:
    """A list."""

    items: tuple[Node, ...]
    line: int


@dataclass(frozen=True)
class Table:
    """A mapping, in the order of the file; `lines` are those of the keys."""

    entries: dict[str, Node]
    lines: dict[str, int]
    line: int


Node = Text | Items | Table

# what YAML 1.1 or 1.2 may read as something else than a text
_NULLS = frozenset({"", "~", "null", "Null", "NULL"})
_BOOLEANS = frozenset(
    word
    for base in ("yes", "no", "true", "false", "on", "off")
    for word in (base, base.title(), base.upper())
)


def described(node: Node) -> str:
    """What a value is, for a message."""
    if isinstance(node, Table):
        return "a table of fields"
    if isinstance(node, Items):
        return f"a list of {len(node.items)}"
    if is_null(node):
        return "nothing"
    if node.plain and node.text in _BOOLEANS:
        return f"{node.text} (true or false)"
    return shown(node.text) if not node.plain or " " in node.text else _bare(node.text)


def _bare(text: str) -> str:
    return shown(text)[1:-1] if shown(text)[1:-1] == text else shown(text)


def is_null(node: Node) -> bool:
    """Whether a field has no value."""
    return isinstance(node, Text) and node.plain and node.text in _NULLS


def is_text(node: Node) -> bool:
    """Whether a value is a text in every version of YAML."""
    return isinstance(node, Text) and not (node.plain and node.text in _NULLS | _BOOLEANS)


def read_tree(path: Path) -> Table:
    """The table that a file holds.

    Raises OSError where it cannot be read, RobotFileError where it is no table of plain YAML.
    """
    with path.open("rb") as file:
        data = file.read(MOST_BYTES + 1)
    return parse(data, str(path))


def parse(data: bytes, name: str) -> Table:
    """The table in the bytes of a file called `name`."""
    if len(data) > MOST_BYTES:
        _stop(name, 0, f"is larger than {MOST_BYTES} bytes; a robot file has a few dozen lines")
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = data.count(b"\n", 0, error.start) + 1
        _stop(name, line, f"not UTF-8: found the byte 0x{data[error.start]:02x}; save the file as UTF-8")
    yaml = _yaml()
    try:
        root = _Builder(name, yaml).build(yaml.parse(text, Loader=yaml.SafeLoader))
    except yaml.YAMLError as error:
        mark = getattr(error, "problem_mark", None) or getattr(error, "context_mark", None)
        found = getattr(error, "position", None)  # of a character that YAML does not allow
        line = mark.line + 1 if mark else text.count("\n", 0, found) + 1 if found is not None else 0
        what = getattr(error, "problem", None) or getattr(error, "reason", None) or "cannot be read"
        _stop(name, line, f"not YAML: {what}")
    if root is None or is_null(root):
        _stop(name, 0, "is empty; expected a table with space, subleg and arrangement")
    if not isinstance(root, Table):
        _stop(name, root.line, f"found {described(root)} at the top, expected a table of fields")
    return root


def _yaml() -> Any:
    try:
        import yaml
    except ModuleNotFoundError:
        raise ModuleNotFoundError(
            "robot files need PyYAML: pip install 'krhpr[files]'", name="yaml"
        ) from None
    return yaml


def _stop(name: str, line: int, message: str) -> NoReturn:
    raise RobotFileError(name, (Problem(line, "", message),))


class _Open:
    """A list or table that is being read."""

    def __init__(self, line: int, *, table: bool) -> None:
        self.line, self.table = line, table
        self.items: list[Node] = []
        self.entries: dict[str, Node] = {}
        self.lines: dict[str, int] = {}
        self.key: str | None = None

    def closed(self) -> Node:
        if self.table:
            return Table(self.entries, self.lines, self.line)
        return Items(tuple(self.items), self.line)


class _Builder:
    """Makes the tree from the events, with a stack of its own instead of recursion."""

    def __init__(self, name: str, yaml: Any) -> None:
        self.name, self.yaml = name, yaml
        self.open: list[_Open] = []
        self.root: Node | None = None
        self.documents = 0

    def build(self, events: Any) -> Node | None:
        """The tree of the one document."""
        yaml = self.yaml
        for event in events:
            line = event.start_mark.line + 1
            self._refuse(event, line)
            if isinstance(event, yaml.ScalarEvent):
                self._add(Text(event.value, event.style is None, line))
            elif isinstance(event, (yaml.SequenceStartEvent, yaml.MappingStartEvent)):
                if len(self.open) == MOST_DEPTH:
                    _stop(self.name, line, f"nested deeper than {MOST_DEPTH} levels")
                self.open.append(_Open(line, table=isinstance(event, yaml.MappingStartEvent)))
            elif isinstance(event, (yaml.SequenceEndEvent, yaml.MappingEndEvent)):
                self._add(self.open.pop().closed())
        return self.root

    def _refuse(self, event: Any, line: int) -> None:
        yaml = self.yaml
        if isinstance(event, yaml.AliasEvent) or getattr(event, "anchor", None) is not None:
            _stop(
                self.name,
                line,
                f"anchors and aliases are not used here: found {shown(event.anchor)}; "
                "write the value where it belongs",
            )
        if getattr(event, "tag", None) is not None:
            _stop(self.name, line, f"tags are not used here: found {shown(event.tag)}; write the value alone")
        if isinstance(event, yaml.DocumentStartEvent):
            self.documents += 1
            if self.documents > 1:
                _stop(self.name, line, "a second document begins here; expected one robot in a file")

    def _add(self, node: Node) -> None:
        if not self.open:
            self.root = node
            return
        inside = self.open[-1]
        if not inside.table:
            inside.items.append(node)
        elif inside.key is None:
            if not isinstance(node, Text):
                _stop(self.name, node.line, f"found {described(node)} as the name of a field")
            if node.text in inside.entries:
                first = inside.lines[node.text]
                _stop(
                    self.name, node.line, f"the field {shown(node.text)} stands twice, first in line {first}"
                )
            inside.key = node.text
            inside.lines[node.text] = node.line
        else:
            inside.entries[inside.key] = node
            inside.key = None
