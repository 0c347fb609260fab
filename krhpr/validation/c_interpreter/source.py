"""A text taken apart: its functions one by one, and what stands between them.

Most of a program is functions that nobody calls, and parsing takes longer than running; so a function is
parsed when it is first asked for, and once for all programs that contain its text.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from functools import lru_cache

from pycparser import c_ast, c_parser

from krhpr.validation.c_interpreter.errors import Unsupported

_PIECE = re.compile(r"\"(?:\\.|[^\"\\\n])*\"|'(?:\\.|[^'\\\n])*'|[{};]")
_WORD = re.compile(r"[A-Za-z_]\w*")
_NAME = re.compile(r"(\w+)\s*\(")


@dataclass(frozen=True)
class Definition:
    """A function as it is written, after a line that says where."""

    name: str
    text: str

    def parsed(self, typedefs: tuple[str, ...]) -> c_ast.FuncDef:
        """Its tree, where these names are types; nothing may change it."""
        words = set(_WORD.findall(self.text))
        return _parsed_function(self.text, tuple(name for name in typedefs if name in words))


@lru_cache(maxsize=64)
def take_apart(text: str, file: str) -> tuple[str, tuple[Definition, ...]]:
    """A preprocessed text without its functions, every line in its place, and the functions."""
    between: list[str] = []
    found: list[Definition] = []
    depth = start = copied = 0  # start: where the declaration begins that is being read
    is_function = False
    for piece in _PIECE.finditer(text):
        match piece.group():
            case "{":
                if depth == 0:
                    is_function = text[start : piece.start()].rstrip().endswith(")")
                depth += 1
            case "}":
                depth -= 1
                if depth == 0 and is_function:
                    whole = text[start : piece.end()]
                    name = _NAME.search(whole)
                    if name is None:
                        raise Unsupported(
                            f"{file}:{text.count(chr(10), 0, start) + 1}: a function without a name"
                        )
                    line = text.count("\n", 0, start) + 1
                    found.append(Definition(name[1], f'# {line} "{file}"\n{whole}'))
                    between += [text[copied:start], "\n" * whole.count("\n")]
                    start = copied = piece.end()
            case ";" if depth == 0:
                start = piece.end()
            case _:
                pass
    return f'# 1 "{file}"\n' + "".join([*between, text[copied:]]), tuple(found)


@lru_cache(maxsize=16)
def parsed(text: str) -> c_ast.FileAST:
    """The tree of a text, which programs of several arithmetics share; nothing may change it."""
    try:
        return c_parser.CParser().parse(text, "prelude")
    except c_parser.ParseError as error:
        raise Unsupported(f"the text does not parse as C99: {error}") from error


@lru_cache(maxsize=4096)
def _parsed_function(text: str, typedefs: tuple[str, ...]) -> c_ast.FuncDef:
    known = "".join(f"typedef int {name};" for name in typedefs)
    node = parsed.__wrapped__(f"{known}\n{text}").ext[-1]
    if not isinstance(node, c_ast.FuncDef):
        raise Unsupported(f"this is no function: {text}")
    return node
