"""The preprocessor: comments, conditionals and macros, leaving each line of the text in its place."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import lru_cache

from pycparser import c_parser

from krhpr.validation.c_interpreter import integers
from krhpr.validation.c_interpreter.errors import Unsupported

_COMMENT = re.compile(r"/\*.*?\*/|//[^\n]*|\"(?:\\.|[^\"\\\n])*\"|'(?:\\.|[^'\\\n])*'", re.DOTALL)
_IDENTIFIER = re.compile(r"\.?\b\d[\w.]*|\b[A-Za-z_]\w*|\"(?:\\.|[^\"\\\n])*\"")
_DIRECTIVE = re.compile(r"\s*#\s*(\w*)\s*(.*?)\s*$")


def _strip_comment(match: re.Match[str]) -> str:
    text = match.group()
    return " " + "\n" * text.count("\n") if text.startswith("/") else text


@dataclass(frozen=True)
class _FunctionMacro:
    """A macro with parameters, `#define KRHPR_PADDED(n) ...`; its calls stand on one line."""

    parameters: tuple[str, ...]
    body: str


class Preprocessor:
    """Comments, conditionals and macros; `#include` is dropped, all files being given at once."""

    def __init__(self, builtin: Iterable[str]) -> None:
        self.builtin = frozenset(builtin)
        self.macros: dict[str, str | _FunctionMacro] = {"__restrict": "restrict", "__restrict__": "restrict"}
        self.macros |= {"__inline": "inline", "__inline__": "inline", "__STDC_VERSION__": "199901L"}
        self.macros |= {"_Pragma": _FunctionMacro(("text",), "")}

    def process(self, text: str, name: str) -> str:
        """The text without directives, each line in its place; what it defines is known from now on."""
        found, macros = _processed(text, name, self.builtin, tuple(self.macros.items()))
        self.macros = dict(macros)
        return found

    def read(self, text: str, name: str) -> str:
        """`process`, the text read from the beginning."""
        text = _COMMENT.sub(_strip_comment, text)
        text = re.sub(r"(?:[^\n]*\\\n)+[^\n]*", _join_continued, text)
        output = []
        conditions: list[tuple[bool, bool]] = []  # (this branch is read, some branch was read)
        for number, line in enumerate(text.split("\n"), 1):
            directive = _DIRECTIVE.match(line) if line.lstrip().startswith("#") else None
            active = all(read for read, _ in conditions)
            if directive is None:
                output.append(self.expand(line) if active else "")
                continue
            output.append("")
            self._directive(directive[1], directive[2], conditions, f"{name}:{number}")
        if conditions:
            raise Unsupported(f"{name}: a conditional without #endif")
        return "\n".join(output)

    def expand(self, text: str, hidden: frozenset[str] = frozenset()) -> str:
        """The text with its macros replaced."""
        output, position = [], 0
        while match := _IDENTIFIER.search(text, position):
            output.append(text[position : match.start()])
            position = match.end()
            word = match.group()
            macro = None if word in hidden else self.macros.get(word)
            if isinstance(macro, _FunctionMacro):
                arguments, end = _macro_arguments(text, position)
                if arguments is None:
                    output.append(word)
                    continue
                if len(arguments) != len(macro.parameters):
                    raise Unsupported(f"{word} takes {len(macro.parameters)} arguments: {text.strip()}")
                given = {
                    name: self.expand(argument, hidden)
                    for name, argument in zip(macro.parameters, arguments, strict=True)
                }
                body = _substituted(macro.body, given)
                output.append(self.expand(body, hidden | {word}))
                position = end
            else:
                output.append(word if macro is None else self.expand(macro, hidden | {word}))
        return "".join([*output, text[position:]])

    def _directive(self, name: str, rest: str, conditions: list[tuple[bool, bool]], where: str) -> None:
        active = all(read for read, _ in conditions)
        outer = all(read for read, _ in conditions[:-1])
        if name in ("ifdef", "ifndef"):
            holds = active and self._is_defined(rest) == (name == "ifdef")
            conditions.append((holds, holds))
        elif name == "if":
            holds = active and self._holds(rest, where)
            conditions.append((holds, holds))
        elif name in ("elif", "else", "endif") and not conditions:
            raise Unsupported(f"{where}: #{name} without #if")
        elif name == "elif":
            taken = conditions[-1][1]
            holds = outer and not taken and self._holds(rest, where)
            conditions[-1] = (holds, taken or holds)
        elif name == "else":
            conditions[-1] = (not conditions[-1][1], True)
        elif name == "endif":
            conditions.pop()
        elif active:
            self._simple_directive(name, rest, where)

    def _simple_directive(self, name: str, rest: str, where: str) -> None:
        if name == "define":
            self._define(rest, where)
        elif name == "undef":
            self.macros.pop(rest, None)
        elif name not in ("include", "pragma", ""):
            raise Unsupported(f"{where}: #{name} {rest}")

    def _define(self, definition: str, where: str) -> None:
        match = re.match(r"([A-Za-z_]\w*)(?:\(([\w\s,]*)\))?(.*)", definition)
        if match is None or match[3].startswith("(") or (match[2] is not None and "#" in definition):
            raise Unsupported(f"{where}: the macro {definition!r}")
        name, body = match[1], match[3].strip()
        if name in self.builtin:
            return
        if match[2] is None:
            self.macros[name] = body
        else:
            parameters = tuple(part.strip() for part in match[2].split(",") if part.strip())
            self.macros[name] = _FunctionMacro(parameters, body)

    def _is_defined(self, name: str) -> bool:
        return name in self.macros or name in self.builtin

    def _holds(self, condition: str, where: str) -> bool:
        def defined(match: re.Match[str]) -> str:
            return str(int(self._is_defined(match[1] or match[2])))

        text = re.sub(r"\bdefined\s*(?:\(\s*(\w+)\s*\)|(\w+))", defined, condition)
        text = re.sub(r"\b[A-Za-z_]\w*", "0", self.expand(text))
        try:
            declaration = c_parser.CParser().parse(f"long x = ({text});").ext[0]
        except c_parser.ParseError as error:
            raise Unsupported(f"{where}: #if {condition}") from error
        return integers.constant(declaration.init, {}) != 0


@lru_cache(maxsize=64)
def _processed(
    text: str, name: str, builtin: frozenset[str], macros: tuple[tuple[str, str | _FunctionMacro], ...]
) -> tuple[str, tuple[tuple[str, str | _FunctionMacro], ...]]:
    """A text without directives, and the macros that are defined after it: programs share their headers."""
    reader = Preprocessor(builtin)
    reader.macros = dict(macros)
    return reader.read(text, name), tuple(reader.macros.items())


def _substituted(body: str, given: Mapping[str, str]) -> str:
    """The body of a macro with its parameters replaced."""
    return _IDENTIFIER.sub(lambda found: given.get(found.group(), found.group()), body)


def _macro_arguments(text: str, position: int) -> tuple[list[str] | None, int]:
    """The arguments in parentheses that follow, and where they end; None where there are none."""
    start = re.compile(r"\s*\(").match(text, position)
    if start is None:
        return None, position
    arguments, depth, begin = [], 1, start.end()
    for index in range(begin, len(text)):
        depth += (text[index] == "(") - (text[index] == ")")
        if depth == 0 or (depth == 1 and text[index] == ","):
            arguments.append(text[begin:index].strip())
            begin = index + 1
        if depth == 0:
            return [] if arguments == [""] else arguments, index + 1
    raise Unsupported(f"the arguments of a macro go on beyond the line: {text.strip()}")


def _join_continued(match: re.Match[str]) -> str:
    text = match.group()
    return text.replace("\\\n", " ") + "\n" * text.count("\\\n")
