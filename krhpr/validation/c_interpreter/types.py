"""The types of C that the interpreter knows."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TypeAlias

from krhpr.validation.c_interpreter.errors import Unsupported


@dataclass(frozen=True)
class Void:
    """No value."""


@dataclass(frozen=True)
class Real:
    """`double`."""


@dataclass(frozen=True)
class Integer:
    """An integer type of so many bits."""

    bits: int
    signed: bool


@dataclass(frozen=True)
class Pointer:
    """A pointer; `const` if its target may not be written."""

    target: CType
    const: bool = field(default=False, compare=False)


@dataclass(frozen=True)
class Vector:
    """An array of `length` elements (None in a parameter that leaves it open)."""

    element: CType
    length: int | None


@dataclass(eq=False)
class Record:
    """A struct; the same only as itself."""

    name: str
    fields: dict[str, CType] = field(default_factory=dict)
    complete: bool = False


CType: TypeAlias = "Void | Real | Integer | Pointer | Vector | Record"

REAL = Real()
INT = Integer(32, True)
LONG = Integer(64, True)
BOOL = Integer(1, False)
NULL_POINTER = Pointer(Void())


def show(ctype: CType) -> str:
    """The type in words."""
    match ctype:
        case Void():
            return "void"
        case Real():
            return "double"
        case Integer(bits, signed):
            return f"{'' if signed else 'unsigned '}{bits}-bit integer"
        case Pointer(target):
            return f"pointer to {show(target)}"
        case Vector(element, length):
            return f"array of {'' if length is None else length} {show(element)}"
        case Record(name=name):
            return f"struct {name}"


def cells(ctype: CType) -> int:
    """The number of memory cells of an object: one for each scalar or struct of an array, else one."""
    if isinstance(ctype, Vector):
        if ctype.length is None:
            raise Unsupported("an array without a length")
        return ctype.length * cells(ctype.element)
    return 1


def innermost(ctype: CType) -> CType:
    """What an array consists of in the end; other types as they are."""
    while isinstance(ctype, Vector):
        ctype = ctype.element
    return ctype


def decayed(ctype: CType) -> CType:
    """The type of a value of this type: arrays become pointers to their first element."""
    return Pointer(ctype.element) if isinstance(ctype, Vector) else ctype
