"""What the interpreter raises, and the line that it names."""

from __future__ import annotations

from pycparser import c_ast


class CError(Exception):
    """The C text did something wrong, or something that the interpreter does not know."""


class Unsupported(CError):
    """A construct outside the subset."""


class UninitialisedRead(CError):
    """A variable or an element was read before it was written."""


class OutOfBounds(CError):
    """An access outside an object, or through a null pointer."""


def where(node: c_ast.Node) -> str:
    """The file and line of a node."""
    coordinate = getattr(node, "coord", None)
    return f"{coordinate.file}:{coordinate.line}" if coordinate is not None else "unknown line"


def unsupported(node: c_ast.Node, what: str) -> Unsupported:
    """An error that says where something stands that is outside the subset."""
    return Unsupported(f"{where(node)}: {what}")
