"""Names: what a program declares outside of functions, and what a function declares in its blocks."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

from pycparser import c_ast

from krhpr.validation.c_interpreter.compiled import Expression, Frame, Function, Location
from krhpr.validation.c_interpreter.declarations import Types
from krhpr.validation.c_interpreter.errors import unsupported
from krhpr.validation.c_interpreter.memory import Block
from krhpr.validation.c_interpreter.places import place
from krhpr.validation.c_interpreter.types import INT, NULL_POINTER, REAL, CType
from krhpr.validation.numbers import Arithmetic


@dataclass(frozen=True)
class Environment:
    """What the functions of a program share.

    `constants` make the numbers that stand for NAN, INFINITY and M_PI; `tables` are constant variables;
    `function` finds a function of the program by its name, None where there is none.
    """

    arithmetic: Arithmetic
    types: Types
    constants: Mapping[str, Callable[[], Any]]
    tables: Mapping[str, tuple[CType, Block]]
    function: Callable[[str], Function | None]


class Scope:
    """The names that a place in a function sees; `slots` counts the variables of the function's frame."""

    def __init__(self, environment: Environment) -> None:
        self.environment = environment
        self.slots = 0
        self._blocks: list[dict[str, tuple[int, CType]]] = [{}]

    @contextmanager
    def nested(self) -> Iterator[None]:
        """A block, whose names are forgotten at its end."""
        self._blocks.append({})
        yield
        self._blocks.pop()

    def declare(self, name: str, ctype: CType) -> int:
        """The slot of a new variable."""
        self._blocks[-1][name] = (self.slots, ctype)
        self.slots += 1
        return self.slots - 1

    def variable(self, name: str) -> tuple[int, CType] | None:
        """The slot and the type of the innermost variable of that name."""
        for block in reversed(self._blocks):
            if name in block:
                return block[name]
        return None

    def identifier(self, node: c_ast.ID) -> Expression:
        """What a name means."""
        name: str = node.name
        variable = self.variable(name)
        if variable is not None:
            return _variable(*variable, node)
        found = self.environment
        if name in found.tables:
            ctype, table = found.tables[name]
            location = (table, 0, 0, len(table.cells))
            return place(ctype, lambda frame: location, node)
        if name in found.types.enumerators:
            value = found.types.enumerators[name]
            return Expression(INT, lambda frame: value)
        if name == "NULL":
            return Expression(NULL_POINTER, lambda frame: None)
        if name in ("true", "false"):
            truth = int(name == "true")
            return Expression(INT, lambda frame: truth)
        if name in found.constants:
            constant = found.constants[name]
            return Expression(REAL, lambda frame: constant())
        raise unsupported(node, f"{name} is not declared")


def _variable(slot: int, ctype: CType, node: c_ast.ID) -> Expression:
    def locate(frame: Frame) -> Location:
        block = frame[slot]
        return block, 0, 0, len(block.cells)

    return place(ctype, locate, node)
