"""What readers of files with tables of quantities share: unknown fields, numbers with units, suspicions."""

from __future__ import annotations

import warnings
from pathlib import Path

from krhpr.errors import nearest
from krhpr.robot_files.geometry import SMALL, suspicion
from krhpr.robot_files.problems import Problems, RobotFileWarning, described
from krhpr.robot_files.quantities import BadQuantity, Kind, parse
from krhpr.robot_files.tree import Items, Node, Table, read_tree
from krhpr.robot_files.tree import described as described_node


class FieldReader:
    """A file of tables; mistakes and suspicions are collected, so that all of them are told at once."""

    def __init__(self, path: Path) -> None:
        self.problems, self.root = Problems(str(path)), read_tree(path)

    def known(self, table: Table, before: str, known: tuple[str, ...]) -> None:
        """Tell of fields that do not exist."""
        for field, line in table.lines.items():
            if field not in known:
                self.problems.wrong(line, f"{before}{field}", f"unknown field; {nearest(field, known)}")

    def need(self, known: tuple[str, ...]) -> None:
        """Stop where fields at the top are unknown, or one is missing."""
        self.known(self.root, "", known)
        missing = [name for name in known if name not in self.root.entries]
        if missing:
            self.problems.wrong(self.root.line, "", f"missing: {', '.join(missing)}")
        self.problems.stop_if_any()

    def numbers(self, node: Node, field: str, kind: Kind, count: int | None) -> list[float]:
        """A list of so many quantities, or one; zeros where it is wrong, which is then told."""
        if count is not None and (not isinstance(node, Items) or len(node.items) != count):
            self.problems.wrong(node.line, field, f"found {described_node(node)}, expected a list of {count}")
            return [0.0] * count
        found = []
        for item in node.items if count is not None and isinstance(node, Items) else (node,):
            try:
                value = parse(item, kind)
            except BadQuantity as error:
                self.problems.wrong(item.line, field, str(error))
                value = 0.0
            if kind in (Kind.LENGTH, Kind.ANGLE):
                told = suspicion(item, value, kind, SMALL if self.is_size(field) else 0.0)
                if told:
                    self.problems.suspicious(item.line, field, told)
            found.append(value)
        return found

    def is_size(self, field: str) -> bool:
        """Whether a field is the length of something, and no small distance."""
        return False

    def plausible(self, line: int, field: str, value: float, low: float, high: float, unit: str = "") -> None:
        """Tell of a value beyond what is usual; zero is usual."""
        if value > high or 0 < value < low:
            self.problems.suspicious(
                line,
                field,
                f"it is {value:g}{unit}, and usual is {low:g} to {high:g}; is the unit missing, or wrong by "
                "a thousand?",
            )

    def finish(self) -> None:
        """Stop where something is wrong (RobotFileError), and warn of what is suspicious."""
        self.problems.stop_if_any()
        for problem in self.problems.suspicions:
            warnings.warn(described(self.problems.path, problem), RobotFileWarning, stacklevel=4)
