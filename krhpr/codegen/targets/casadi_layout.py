"""How CasADi lays out arguments, results and Jacobians: matrices column by column, with sparsity patterns."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from math import prod

from krhpr.codegen.kernel import Layout, Port


class Patterns:
    """Sparsity patterns in CasADi's compressed form, each printed once."""

    def __init__(self) -> None:
        self._names: dict[tuple[int, ...], str] = {}

    def dense(self, rows: int, columns: int) -> str:
        return self._name((rows, columns, 1))

    def empty(self, rows: int, columns: int) -> str:
        return self.sparse(rows, columns, [[] for _ in range(columns)])

    def sparse(self, rows: int, columns: int, entries: Sequence[Sequence[int]]) -> str:
        """A pattern from the rows of each column, in order."""
        if rows * columns and all(len(column) == rows for column in entries):
            return self.dense(rows, columns)
        starts = [0]
        for column in entries:
            starts.append(starts[-1] + len(column))
        return self._name((rows, columns, *starts, *(row for column in entries for row in column)))

    def _name(self, pattern: tuple[int, ...]) -> str:
        return self._names.setdefault(pattern, f"P{len(self._names)}")

    def declarations(self) -> list[tuple[str, int, str]]:
        return [(name, len(p), ", ".join(map(str, p))) for p, name in self._names.items()]


@dataclass(frozen=True)
class Slot:
    """An argument or result as CasADi has it: a matrix, or blocks on the diagonal of one."""

    name: str
    port: str
    rows: int
    columns: int
    blocks: int
    offset: int
    """Which of the port's elements comes first."""
    pattern: str = ""
    empty: str = ""

    def with_patterns(self, patterns: Patterns) -> Slot:
        """The same with the names of its sparsity pattern and of the pattern without elements."""
        return replace(
            self,
            pattern=patterns.sparse(self.rows, self.columns, self.entries()),
            empty=patterns.empty(self.rows, self.columns),
        )

    def element(self, row: int, column: int) -> int:
        """Where an element of the matrix stands in the port's array, blocks of a diagonal one by one."""
        high, wide = self.rows // self.blocks, self.columns // self.blocks
        return self.offset + (row // high) * high * wide + (row % high) * wide + column % wide

    def entries(self) -> list[list[int]]:
        """Rows of each column in which an element may differ from zero."""
        high, wide = self.rows // self.blocks, self.columns // self.blocks
        return [
            [row for row in range(self.rows) if row // high == column // wide]
            for column in range(self.columns)
        ]


def slots(ports: Iterable[Port], patterns: Patterns) -> list[Slot]:
    """The matrices of a function's inputs or outputs; a leg-wise array of matrices becomes one for each."""
    found: list[Slot] = []
    for port in ports:
        shape = port.full_shape
        legs = shape[0] if len(shape) > 2 else 1
        rows, columns = (shape[1], prod(shape[2:])) if len(shape) > 2 else (*shape, 1, 1)[:2]
        blocks = port.legs if port.layout is Layout.DIAGONAL else 1
        for leg in range(legs):
            name = f"{port.name}{leg + 1}" if legs > 1 else port.name
            slot = Slot(name, port.name, rows, columns, blocks, leg * rows * columns)
            found.append(slot.with_patterns(patterns))
    return found
