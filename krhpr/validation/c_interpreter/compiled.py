"""What C text is compiled to: closures over a frame, which is the list of a call's local blocks."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, TypeAlias

from krhpr.validation.c_interpreter.errors import CError, Unsupported
from krhpr.validation.c_interpreter.memory import Block, Struct, copied
from krhpr.validation.c_interpreter.pointers import narrowed
from krhpr.validation.c_interpreter.types import CType, Void

Frame: TypeAlias = list[Block]
Get: TypeAlias = Callable[[Frame], Any]
Condition: TypeAlias = Callable[[Frame], bool]
Location: TypeAlias = tuple[Block, int, int, int]  # block, cell, and the bounds of the object that it lies in
Locate: TypeAlias = Callable[[Frame], Location]
Run: TypeAlias = Callable[[Frame], Any]  # None, BREAK, CONTINUE or (value,) for return

BREAK = object()
CONTINUE = object()


@dataclass(frozen=True)
class Expression:
    """A typed expression: how to get its value and, if it designates an object, where that lies."""

    ctype: CType
    get: Get
    locate: Locate | None = None


@dataclass
class Function:
    """A compiled function."""

    name: str
    returns: CType
    parameters: list[tuple[str, CType, int | None]]
    slots: int = 0
    body: Run | None = None
    running: bool = False

    def call(self, values: Sequence[Any]) -> Any:
        """Run the function on converted arguments."""
        if self.running:
            raise Unsupported(f"{self.name} is recursive")
        frame = new_frame(self.slots)
        for slot, ((name, ctype, extent), value) in enumerate(zip(self.parameters, values, strict=True)):
            if extent is not None and value is not None:
                value = narrowed(value, extent, f"argument {name} of {self.name}")
            frame[slot] = copied(value, name) if isinstance(value, Struct) else Block([value], ctype, name)
        self.running = True
        try:
            assert self.body is not None
            outcome = self.body(frame)
        finally:
            self.running = False
        if isinstance(outcome, tuple):
            return outcome[0]
        if not isinstance(self.returns, Void):
            raise CError(f"{self.name} ends without returning a value")
        return None


def new_frame(slots: int) -> Frame:
    """A frame for a call; each declaration puts its block there before anything reads it."""
    return [None] * slots  # type: ignore[list-item]
