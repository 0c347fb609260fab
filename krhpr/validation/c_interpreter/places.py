"""Expressions that designate objects: variables, elements, fields, and what pointers point to."""

from __future__ import annotations

from typing import Any

from pycparser import c_ast

from krhpr.validation.c_interpreter.compiled import Expression, Frame, Get, Locate, Location
from krhpr.validation.c_interpreter.errors import OutOfBounds, UninitialisedRead, unsupported, where
from krhpr.validation.c_interpreter.memory import UNSET, Array, member
from krhpr.validation.c_interpreter.types import (
    CType,
    Integer,
    Pointer,
    Record,
    Vector,
    Void,
    cells,
    decayed,
    show,
)


def read(location: Location, line: str) -> Any:
    """The value of a cell; raises if it was never written."""
    block, cell = location[0], location[1]
    value = block.cells[cell]
    if value is UNSET:
        raise UninitialisedRead(f"{line}: {block.name_of(cell)} is read before it is written")
    return value


def place(ctype: CType, locate: Locate, node: c_ast.Node) -> Expression:
    """An expression that designates an object; a place that is an array has a pointer as its value."""
    line = where(node)
    if isinstance(ctype, Vector):
        size = cells(ctype)

        def decay(frame: Frame) -> Array:
            block, cell, _, _ = locate(frame)
            return Array.view(block, cell, cell, cell + size)

        return Expression(ctype, decay, locate)
    return Expression(ctype, lambda frame: read(locate(frame), line), locate)


def address(operand: Expression, node: c_ast.Node) -> Expression:
    """A pointer to the object that an expression designates."""
    if operand.locate is None:
        raise unsupported(node, f"& on {show(operand.ctype)}")
    locate = operand.locate
    return Expression(Pointer(operand.ctype), lambda frame: Array.view(*locate(frame)))


def target(pointer: Expression, node: c_ast.Node, what: str) -> Expression:
    """The object that a pointer, or an array, points to; `what` begins the message where it is neither."""
    return _behind(pointer, lambda frame: 0, node, what)


def element(base: Expression, index: Expression, node: c_ast.Node) -> Expression:
    """An element of an array, or of what a pointer points to."""
    if not isinstance(index.ctype, Integer):
        raise unsupported(node, f"a subscript of type {show(index.ctype)}")
    if not isinstance(base.ctype, Vector) or base.locate is None:
        return _behind(base, index.get, node, "a subscript of")
    kind, length, origin = base.ctype.element, base.ctype.length, base.locate
    assert length is not None
    line, get_index, size = where(node), index.get, cells(kind)

    def locate(frame: Frame) -> Location:
        block, cell, low, high = origin(frame)
        number = get_index(frame)
        if not 0 <= number < length:
            raise OutOfBounds(f"{line}: index {number} of {length} elements of {block.name}")
        return block, cell + number * size, low, high

    return place(kind, locate, node)


def _behind(pointer: Expression, index: Get, node: c_ast.Node, what: str) -> Expression:
    """The object that lies `index` objects behind the one that a pointer points to."""
    ctype = decayed(pointer.ctype)
    if not isinstance(ctype, Pointer):
        raise unsupported(node, f"{what} {show(pointer.ctype)}")
    if isinstance(ctype.target, Void):
        raise unsupported(node, "access through a pointer to void")
    get, line, size = pointer.get, where(node), cells(ctype.target)

    def locate(frame: Frame) -> Location:
        base = get(frame)
        if base is None:
            raise OutOfBounds(f"{line}: access through a null pointer")
        offset = index(frame)
        cell = base.start + offset * size
        if cell < base.low or cell + size > base.high:
            raise OutOfBounds(
                f"{line}: index {offset} of {base.block.name}, "
                f"{(base.high - base.start) // size} elements from there on"
            )
        return base.block, cell, base.low, base.high

    return place(ctype.target, locate, node)


def field(base: Expression, name: str, node: c_ast.Node) -> Expression:
    """A field of a struct."""
    record, get_struct = base.ctype, base.get
    if not isinstance(record, Record):
        raise unsupported(node, f".{name} of {show(record)}")
    if name not in record.fields:
        raise unsupported(node, f"struct {record.name} has no field {name}")

    def locate(frame: Frame) -> Location:
        block = member(get_struct(frame), name)
        return block, 0, 0, len(block.cells)

    return place(record.fields[name], locate, node)
