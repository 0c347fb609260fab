"""Errors that people see.  Each says what was wrong, where, what was expected and what to do."""

from __future__ import annotations

from collections.abc import Sequence
from difflib import get_close_matches


def nearest(name: str, known: Sequence[str]) -> str:
    """For a name that is not among those known: which are nearest, or else which there are."""
    near = get_close_matches(name.lower(), known, n=3, cutoff=0.5)
    if not near:
        return f"there are {', '.join(known)}"
    *others, last = near
    return f"did you mean {', '.join(others)} or {last}?" if others else f"did you mean {last}?"


class KrhprError(Exception):
    """Base of the errors that this package raises on purpose; the first argument is the message."""

    def __str__(self) -> str:
        return str(self.args[0]) if self.args else ""


class UnknownRobot(KrhprError, KeyError):
    """No robot has this name."""

    @classmethod
    def among(cls, identifier: str, known: Sequence[str]) -> UnknownRobot:
        """The error for a name that is not among those known; it says which are nearest."""
        return cls(f"no robot is called {identifier!r}; {nearest(identifier, known)}")


class UnknownBranch(KrhprError, ValueError):
    """No working mode or assembly mode has this name."""


class Unreachable(KrhprError, ValueError):
    """A pose that a leg cannot reach: `leg` (1 to 3), `distance` in the geometry's unit, `index` in the
    batch."""

    def __init__(self, message: str, leg: int, distance: float, index: tuple[int, ...]) -> None:
        super().__init__(message, leg, distance, index)  # all of them, for pickle
        self.leg, self.distance, self.index = leg, distance, index


class Singular(KrhprError, ValueError):
    """A configuration in which a determinant vanishes; `status` says which one, `index` where in the
    batch."""

    def __init__(self, message: str, status: int, index: tuple[int, ...]) -> None:
        super().__init__(message, status, index)
        self.status, self.index = status, index


class InBatch(KrhprError, ValueError):
    """An element without an answer: `index` is its place in the batch."""

    def __init__(self, message: str, index: tuple[int, ...] = ()) -> None:
        super().__init__(message, index)
        self.index = index


class NoConvergence(InBatch):
    """An iteration that ended before it converged; `index` is its place in the batch."""


class NoGrasp(InBatch):
    """Jaws that do not hold an object, or not as is known; `index` is their place in the batch."""


class Unassembled(InBatch):
    """End points that no platform of the geometry fits; `index` is their place in the batch."""


class Ambiguous(InBatch):
    """Several answers that cannot be told apart; `index` is their place in the batch."""


class Inconsistent(InBatch):
    """Encoders that contradict the legs; `index` is their place in the batch."""


class InvalidInput(InBatch):
    """NaN or infinite input, or a matrix that is not a rotation; `index` is its place in the batch."""


class GeneratedMismatch(KrhprError, RuntimeError):
    """The generated folder was written by another version of this package."""


class TrajectoryError(KrhprError, ValueError):
    """A path, an objective or limits of a trajectory that cannot be used."""


class WorkspaceError(KrhprError, ValueError):
    """A workspace that cannot be computed as asked: what is wrong, what is expected."""


class ControlError(KrhprError, ValueError):
    """A plant, gains or a grasp that cannot be simulated: what was found, and what is expected."""


class DesignError(KrhprError, ValueError):
    """A design, or what is to be varied or improved of it, that cannot be used: what is wrong, and what is
    expected."""


class PluginError(KrhprError, ValueError):
    """A sub-leg of one's own that cannot be used: which file, what is wrong, and what is expected."""
