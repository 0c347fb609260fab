"""What C does with pointers, within the bounds of the object that they point into; None is the null one."""

from __future__ import annotations

from krhpr.validation.c_interpreter.errors import OutOfBounds
from krhpr.validation.c_interpreter.memory import Array


def moved(pointer: Array | None, cells: int, where: str) -> Array:
    """The pointer so many cells further on, the end of the object at most."""
    if pointer is None:
        raise OutOfBounds(f"{where}: arithmetic on a null pointer")
    start = pointer.start + cells
    if not pointer.low <= start <= pointer.high:
        raise OutOfBounds(f"{where}: a pointer outside {pointer.block.name}")
    return Array.view(pointer.block, start, pointer.low, pointer.high)


def narrowed(pointer: Array, extent: int, what: str) -> Array:
    """The pointer with the bounds that an array parameter promises."""
    left = pointer.high - pointer.start
    if pointer.start < pointer.low or left < extent:
        raise OutOfBounds(f"{what} needs {extent} elements, {pointer.block.name} has {left} left")
    return Array.view(pointer.block, pointer.start, pointer.start, pointer.start + extent)


def same_place(a: Array | None, b: Array | None) -> bool:
    """Whether two pointers are equal."""
    if a is None or b is None:
        return a is b
    return a.block is b.block and a.start == b.start


def distance(a: Array | None, b: Array | None, where: str) -> int:
    """The cells from `b` to `a`, which point into the same object."""
    if a is None or b is None or a.block is not b.block:
        raise OutOfBounds(f"{where}: the difference of pointers into different objects")
    return a.start - b.start
