"""Initialisers: values, and lists in braces for arrays and structs."""

from __future__ import annotations

import re
from collections.abc import Callable
from typing import TypeAlias

from pycparser import c_ast

from krhpr.validation.c_interpreter.compiled import Frame
from krhpr.validation.c_interpreter.errors import unsupported
from krhpr.validation.c_interpreter.expressions import Expressions
from krhpr.validation.c_interpreter.memory import Block, clear, member, put
from krhpr.validation.c_interpreter.types import CType, Record, Vector, cells

Fill: TypeAlias = Callable[[Frame, Block, int], None]
"""Writes an object from some cell of a block on."""


def initialiser(ctype: CType, node: c_ast.Node, expressions: Expressions) -> Fill:
    """How to write an object of type `ctype`."""
    if not isinstance(node, c_ast.InitList):
        if isinstance(ctype, Vector):
            raise unsupported(node, "an array initialised without braces")
        get = expressions.value(node, ctype)
        return lambda frame, block, cell: put(block, cell, get(frame))
    if isinstance(ctype, Vector):
        return _of_vector(ctype, node, expressions)
    if isinstance(ctype, Record):
        return _of_record(ctype, node, expressions)
    raise unsupported(node, "braces around a scalar")


def _of_vector(ctype: Vector, node: c_ast.InitList, expressions: Expressions) -> Fill:
    assert ctype.length is not None
    size, arithmetic = cells(ctype.element), expressions.arithmetic
    items = [] if _is_zero_list(node) else node.exprs
    if len(items) > ctype.length:
        raise unsupported(node, f"{len(items)} initialisers for {ctype.length} elements")
    parts = [initialiser(ctype.element, item, expressions) for item in items]

    def fill(frame: Frame, block: Block, cell: int) -> None:
        for index in range(cell + len(parts) * size, cell + cells(ctype)):
            clear(block, index, arithmetic)
        for number, part in enumerate(parts):
            part(frame, block, cell + number * size)

    return fill


def _of_record(ctype: Record, node: c_ast.InitList, expressions: Expressions) -> Fill:
    arithmetic, names = expressions.arithmetic, list(ctype.fields)
    parts: dict[str, Fill] = {}
    for position, item in enumerate(() if _is_zero_list(node) else node.exprs):
        if isinstance(item, c_ast.NamedInitializer):
            if len(item.name) != 1 or not isinstance(item.name[0], c_ast.ID):
                raise unsupported(item, "this designator")
            name, value = item.name[0].name, item.expr
        elif len(parts) != position or position >= len(names):
            raise unsupported(item, f"this initialiser of struct {ctype.name}")
        else:
            name, value = names[position], item
        if name not in ctype.fields:
            raise unsupported(item, f"struct {ctype.name} has no field {name}")
        parts[name] = initialiser(ctype.fields[name], value, expressions)

    def fill(frame: Frame, block: Block, cell: int) -> None:
        clear(block, cell, arithmetic)
        for name, part in parts.items():
            part(frame, member(block.cells[cell], name), 0)

    return fill


def _is_zero_list(node: c_ast.InitList) -> bool:
    """Whether the initialiser is `{0}` (or `{0.0}`), which clears an object of any type."""
    if len(node.exprs) != 1 or not isinstance(node.exprs[0], c_ast.Constant):
        return False
    return re.fullmatch(r"0|0\.0?|\.0", node.exprs[0].value) is not None
