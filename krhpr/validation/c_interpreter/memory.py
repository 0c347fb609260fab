"""Memory as blocks of cells that know whether they were written, and what Python sees of it.

`Array` is the interpreter's pointer as well, and `Struct` the value of a struct.
"""

from __future__ import annotations

import operator
from collections.abc import Iterable, Iterator
from typing import Any

from krhpr.validation.c_interpreter.errors import UninitialisedRead, Unsupported
from krhpr.validation.c_interpreter.integers import fit
from krhpr.validation.c_interpreter.types import (
    CType,
    Integer,
    Pointer,
    Real,
    Record,
    Vector,
    cells,
    innermost,
    show,
)
from krhpr.validation.numbers import EXACT, Arithmetic


class _Unset:
    def __repr__(self) -> str:
        return "unset"


UNSET = _Unset()


class Block:
    """An object in memory: its cells (numbers, pointers, structs or `UNSET`) and their common type."""

    __slots__ = ("arithmetic", "cells", "ctype", "name")

    def __init__(
        self, cells: list[Any], ctype: CType | None, name: str, arithmetic: Arithmetic | None = None
    ) -> None:
        self.cells = cells
        self.ctype = ctype
        self.name = name
        self.arithmetic = arithmetic

    def name_of(self, index: int) -> str:
        """What to call a cell in a message."""
        name = self.name or "array"
        return name if len(self.cells) == 1 else f"{name}[{index}]"


def _flatten(values: Any) -> Iterator[Any]:
    if hasattr(values, "tolist"):
        values = values.tolist()
    if isinstance(values, Iterable):
        for value in values:
            yield from _flatten(value)
    else:
        yield values


class Array:
    """A pointer into memory; Python hands arrays to C functions, and reads them afterwards, as these.

    `Array([1, 2, 3])` makes new memory with a copy of the values (nested sequences are flattened, row by
    row), `Array.unset(9)` memory that was never written.  Indices count from where the pointer points.
    Messages call it by the `name`, or by that of the parameter to which it is handed first.

    It points to the cell `start` of its `block`; `low` and `high` bound the object that it may be moved in.
    """

    __slots__ = ("block", "high", "low", "start")

    def __init__(self, values: Any, name: str = "") -> None:
        self.block = Block(list(_flatten(values)), None, name)
        self.start, self.low, self.high = 0, 0, len(self.block.cells)

    @classmethod
    def unset(cls, length: int, name: str = "") -> Array:
        """New memory for `length` elements, none of them written."""
        return cls([UNSET] * length, name)

    @classmethod
    def view(cls, block: Block, start: int, low: int, high: int) -> Array:
        """A pointer into memory that exists."""
        self = cls.__new__(cls)
        self.block, self.start, self.low, self.high = block, start, low, high
        return self

    def __len__(self) -> int:
        return self.high - self.start

    def _cell(self, index: int) -> int:
        if not -len(self) <= index < len(self):
            raise IndexError(f"{self.block.name}: index {index} of {len(self)} elements")
        return self.start + index % len(self)

    def __getitem__(self, index: int) -> Any:
        cell = self._cell(index)
        value = self.block.cells[cell]
        if value is UNSET:
            raise UninitialisedRead(f"{self.block.name_of(cell)} was never written")
        return value

    def __setitem__(self, index: int, value: Any) -> None:
        block, cell = self.block, self._cell(index)
        if block.ctype is None:
            block.cells[cell] = value
        else:
            put(block, cell, from_python(value, block.ctype, block.arithmetic or EXACT, block.name))

    def __iter__(self) -> Iterator[Any]:
        return (self[i] for i in range(len(self)))

    def at(self, offset: int) -> Array:
        """The pointer `offset` elements further on, into the same memory (`&a[offset]`)."""
        return Array.view(self.block, self.start + offset, self.low, self.high)

    def is_set(self, index: int) -> bool:
        """Whether the element was written."""
        return self.block.cells[self._cell(index)] is not UNSET

    def __repr__(self) -> str:
        return f"Array({self.block.cells[self.start : self.high]!r}, name={self.block.name!r})"


class Struct:
    """A struct in memory: its fields are attributes (numbers, `Array`s, `Struct`s, `Array`s of `Struct`s).

    Fields take plain numbers, which become numbers of the program's arithmetic; an array field takes a
    sequence of its full length, nested or flat.  Reading a field that was never written raises.
    """

    # All names but these underscored ones belong to the fields of the C text.
    __slots__ = ("_arithmetic", "_blocks", "_name", "_record")
    _record: Record
    _blocks: dict[str, Block]
    _arithmetic: Arithmetic
    _name: str

    def __init__(self, record: Record, arithmetic: Arithmetic, name: str) -> None:
        blocks = {key: new_block(ctype, f"{name}.{key}", arithmetic) for key, ctype in record.fields.items()}
        object.__setattr__(self, "_record", record)
        object.__setattr__(self, "_blocks", blocks)
        object.__setattr__(self, "_arithmetic", arithmetic)
        object.__setattr__(self, "_name", name)

    def __dir__(self) -> list[str]:
        return sorted(self._record.fields)

    def __getattr__(self, name: str) -> Any:
        if name not in self._record.fields:
            raise AttributeError(f"struct {self._record.name} has no field {name}")
        block = self._blocks[name]
        if isinstance(self._record.fields[name], Vector):
            return Array.view(block, 0, 0, len(block.cells))
        if block.cells[0] is UNSET:
            raise UninitialisedRead(f"{block.name} was never written")
        return block.cells[0]

    def __setattr__(self, name: str, value: Any) -> None:
        if name not in self._record.fields:
            raise AttributeError(f"struct {self._record.name} has no field {name}")
        ctype, block = self._record.fields[name], self._blocks[name]
        values = list(_flatten(value)) if isinstance(ctype, Vector) else [value]
        if len(values) != len(block.cells):
            raise ValueError(f"{block.name} takes {len(block.cells)} values, not {len(values)}")
        for index, item in enumerate(values):
            put(block, index, from_python(item, innermost(ctype), self._arithmetic, block.name))

    def __repr__(self) -> str:
        fields = ", ".join(f"{key}={block.cells!r}" for key, block in self._blocks.items())
        return f"<struct {self._record.name} {fields}>"


# -- cells ---------------------------------------------------------------------------------------------------


def new_block(ctype: CType, name: str, arithmetic: Arithmetic) -> Block:
    """Memory for an object, nothing in it written."""
    count, kind = cells(ctype), innermost(ctype)
    if not isinstance(kind, Record):
        return Block([UNSET] * count, kind, name, arithmetic)
    if not kind.complete:
        raise Unsupported(f"{name}: struct {kind.name} is incomplete")
    names = [name] if not isinstance(ctype, Vector) else [f"{name}[{i}]" for i in range(count)]
    return Block([Struct(kind, arithmetic, item) for item in names], kind, name, arithmetic)


def copied(struct: Struct, name: str) -> Block:
    """New memory with a copy of a struct."""
    block = new_block(struct._record, name, struct._arithmetic)
    put(block, 0, struct)
    return block


def member(struct: Struct, name: str) -> Block:
    """Where a field of a struct lies."""
    return struct._blocks[name]


def put(block: Block, index: int, value: Any) -> None:
    """Write a cell; a struct is copied field by field, unwritten fields included."""
    if isinstance(value, Struct):
        target: Struct = block.cells[index]
        for key, source in value._blocks.items():
            for cell, item in enumerate(source.cells):
                put(target._blocks[key], cell, item)
    else:
        block.cells[index] = value


def clear(block: Block, cell: int, arithmetic: Arithmetic) -> None:
    """Write a cell as `{0}` does; a struct is cleared field by field."""
    match block.ctype:
        case Real():
            block.cells[cell] = arithmetic.real(0)
        case Integer():
            block.cells[cell] = 0
        case Pointer():
            block.cells[cell] = None
        case _:
            for part in block.cells[cell]._blocks.values():
                for index in range(len(part.cells)):
                    clear(part, index, arithmetic)


# -- values from Python --------------------------------------------------------------------------------------


def from_python(value: Any, ctype: CType, arithmetic: Arithmetic, name: str) -> Any:
    """A value handed in from Python as one of type `ctype`."""
    match ctype:
        case Real():
            return arithmetic.lift(value)
        case Integer():
            return fit(operator.index(value), ctype, name)
        case Record():
            if not isinstance(value, Struct) or value._record is not ctype:
                raise TypeError(f"{name}: {show(ctype)} expected, {value!r} given")
            return value
        case Pointer(target, const):
            return _pointer_from_python(value, innermost(target), const, arithmetic, name)
        case _:
            raise TypeError(f"{name}: no value of type {show(ctype)} can be handed over")


def _pointer_from_python(
    value: Any, kind: CType, const: bool, arithmetic: Arithmetic, name: str
) -> Array | None:
    if value is None:
        return None
    if isinstance(value, Struct):
        value = Array([value], value._name)
    if not isinstance(value, Array) and not const:
        raise TypeError(f"{name}: an Array is expected for what the function may write")
    pointer = value if isinstance(value, Array) else Array(value, name)
    block = pointer.block
    if block.ctype is None:
        block.cells[:] = [
            item if item is UNSET else from_python(item, kind, arithmetic, name) for item in block.cells
        ]
        block.ctype, block.arithmetic = kind, arithmetic
        block.name = block.name or name
    elif block.ctype != kind:
        raise TypeError(f"{name}: {show(kind)} expected, but {block.name} is of {show(block.ctype)}")
    return pointer
