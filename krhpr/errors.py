"""Errors that people see.  Each says what was wrong, where, what was expected and what to do."""

from __future__ import annotations


class KrhprError(Exception):
    """Base of the errors that this package raises on purpose."""


class UnknownRobot(KrhprError, KeyError):
    """No robot has this name."""

    def __str__(self) -> str:
        return str(self.args[0])


class UnknownBranch(KrhprError, ValueError):
    """No working mode or assembly mode has this name."""


class Unreachable(KrhprError, ValueError):
    """A pose that a leg cannot reach: `leg` (1 to 3), `distance` in the geometry's unit, `index` in the batch."""

    def __init__(self, message: str, leg: int, distance: float, index: tuple[int, ...]) -> None:
        super().__init__(message)
        self.leg, self.distance, self.index = leg, distance, index


class Singular(KrhprError, ValueError):
    """A configuration in which a determinant vanishes; `status` says which one, `index` where in the batch."""

    def __init__(self, message: str, status: int, index: tuple[int, ...]) -> None:
        super().__init__(message)
        self.status, self.index = status, index


class InvalidInput(KrhprError, ValueError):
    """NaN or infinite input, or a matrix that is not a rotation."""


class GeneratedMismatch(KrhprError, RuntimeError):
    """The generated folder was written by another version of this package."""
