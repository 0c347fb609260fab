"""What is wrong with a robot file, and where; or what is only suspicious."""

from __future__ import annotations

from dataclasses import dataclass

from krhpr.errors import KrhprError

_SHOWN = 60  # characters of a value


@dataclass(frozen=True)
class Problem:
    """One mistake: its line (from 1; 0 where it is the whole file's), the field, and what is expected."""

    line: int
    field: str
    message: str


class RobotFileError(KrhprError, ValueError):
    """A robot file that cannot be used: `path` and every mistake that was found, in `problems`."""

    def __init__(self, path: str, problems: tuple[Problem, ...]) -> None:
        super().__init__(_text(path, problems), path, problems)  # all of them, for pickle
        self.path, self.problems = path, problems

    def __reduce__(self) -> tuple[type[RobotFileError], tuple[str, tuple[Problem, ...]]]:
        return RobotFileError, (self.path, self.problems)


class RobotFileWarning(UserWarning):
    """Something in a robot file that can be used and is hardly meant."""


def _text(path: str, problems: tuple[Problem, ...]) -> str:
    return "\n".join(described(path, problem) for problem in problems)


def described(path: str, problem: Problem) -> str:
    """`arm.yaml, line 7: geometry.l_2: found ..., expected ...`."""
    where = f"{path}, line {problem.line}" if problem.line else path
    return f"{where}: {problem.field}: {problem.message}" if problem.field else f"{where}: {problem.message}"


class Problems:
    """Collects mistakes and suspicions while a file is read, so that all of them are told at once."""

    def __init__(self, path: str) -> None:
        self.path = path
        self.mistakes: list[Problem] = []
        self.suspicions: list[Problem] = []

    def wrong(self, line: int, field: str, message: str) -> None:
        """Something that makes the file unusable."""
        self.mistakes.append(Problem(line, field, message))

    def suspicious(self, line: int, field: str, message: str) -> None:
        """Something that is hardly meant."""
        self.suspicions.append(Problem(line, field, message))

    def stop_if_any(self) -> None:
        """Raise RobotFileError where something is wrong; suspicions are told along, for they may be why."""
        if self.mistakes:
            found = sorted([*self.mistakes, *self.suspicions], key=lambda problem: problem.line)
            raise RobotFileError(self.path, tuple(found))


def shown(text: str) -> str:
    """A value of a file as a message shows it: on one line, escaped, and not too long."""
    whole = ascii(text)
    return whole if len(whole) <= _SHOWN else whole[: _SHOWN - 4] + "..." + whole[0]
