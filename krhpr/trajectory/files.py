"""A path and what is asked for along it, from a YAML file.

    path: T1                       # of the thesis (T1, T2, section-1.8), or way-points:
    way_points:
      - {time: 0, p: [0, 0, 350 mm], rotation: [0, 0, 0]}
      - {time: 2.5, p: [100 mm, 0, 350 mm], rotation: [0, 40 deg, 0]}
    interpolation: spline          # or linear
    objective: eta_1               # or time, or {eta_1: 11.4, eta_2: 0.12, eta_3: 0.67, rates: 0.001}
    limits: chapter-4              # or a table, see `Bounds`, of which `grip` is a table, see `Grip`
    method: nlp
    intervals: 30
    horizon: 2                     # of `method: receding`, s

`rotation` is a rotation vector, axis times angle; a planar robot has an angle `phi` in its place.  Numbers
are SI and may have their unit.  The file is read as robot files are: it cannot run anything.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path as File
from typing import Any, TypeVar

import numpy as np

from krhpr.errors import nearest
from krhpr.robot_files.problems import Problems, RobotFileError
from krhpr.robot_files.quantities import BadQuantity, Kind, parse
from krhpr.robot_files.tree import Items, Node, Table, Text, described, read_tree
from krhpr.trajectory.grip import Grip
from krhpr.trajectory.optimise import INTERVALS, Method
from krhpr.trajectory.paths import BUILT_IN, Interpolation, Path, PathError, way_points
from krhpr.trajectory.refusals import UnknownObjective
from krhpr.trajectory.terms import TERMS, Bounds, Load, Objective, chapter_4

FIELDS = ("path", "way_points", "interpolation", "objective", "limits", "method", "intervals", "horizon")
CHAPTER_4 = "chapter-4"
"""The name of the limits of Chapter 4."""
LIMITS = (
    "redundant",
    "redundant_rate",
    "swivel",
    "swivel_rate",
    "actuator_rate",
    "actuator_acceleration",
    "margins",
    "factors",
    "cone",
    "clearance",
    "grip",
)
GRIP = ("opening", "jaws", "play")

Found = TypeVar("Found")


@dataclass(frozen=True)
class Request:
    """What a file asks for."""

    path: Path
    objective: Objective
    bounds: Bounds
    method: Method
    intervals: int
    horizon: float | None
    """Of `Method.RECEDING`."""


def read_request(file: File, *, planar: bool, slides: bool) -> Request:
    """Read a file for a robot in the plane or in space, with redundant angles or slides.

    Raises:
        PathError: every mistake with its line, what was found and what is expected.
        OSError: the file cannot be read.
    """
    try:
        return _Reader(file, planar, slides).request()
    except RobotFileError as error:
        raise PathError(str(error)) from None


class _Reader:
    def __init__(self, file: File, planar: bool, slides: bool) -> None:
        self.name, self.planar = file.stem, planar
        self.redundant = Kind.LENGTH if slides else Kind.ANGLE
        self.problems, self.root = Problems(str(file)), read_tree(file)

    def request(self) -> Request:
        for field, line in self.root.lines.items():
            if field not in FIELDS:
                self.problems.wrong(line, field, f"unknown field; {nearest(field, FIELDS)}")
        path = self._path()
        objective = self._objective()
        bounds = self._bounds()
        method = self._choice(self.root, "method", tuple(Method), Method.NLP)
        intervals = self._number(self.root, "intervals", Kind.NUMBER, INTERVALS)
        if intervals is not None and (intervals != int(intervals) or intervals < 2):
            self._wrong(self.root, "intervals", "expected a whole number of two or more")
        given = "horizon" in self.root.entries
        horizon = self._number(self.root, "horizon", Kind.NUMBER, 0.0) if given else None
        if horizon is not None and not 0 < horizon < np.inf:
            self._wrong(self.root, "horizon", "expected seconds, more than none")
        self.problems.stop_if_any()
        assert path is not None and objective is not None and bounds is not None and intervals is not None
        return Request(path, objective, bounds, Method(method), int(intervals), horizon)

    # -- fields ---------------------------------------------------------------------------------------------

    def _path(self) -> Path | None:
        chosen = [field for field in ("path", "way_points") if field in self.root.entries]
        if len(chosen) != 1:
            self.problems.wrong(self.root.line, "", "give either path, one of the thesis, or way_points")
            return None
        if chosen == ["path"]:
            name = self._choice(self.root, "path", tuple(BUILT_IN), "")
            return BUILT_IN[name]() if name else None
        node = self.root.entries["way_points"]
        if not isinstance(node, Items):
            self._wrong(self.root, "way_points", f"found {described(node)}, expected a list")
            return None
        rows = [self._way_point(item, index) for index, item in enumerate(node.items)]
        how = self._choice(self.root, "interpolation", tuple(Interpolation), Interpolation.SPLINE)
        if self.problems.mistakes:
            return None
        times, p, turns = zip(*rows, strict=True) if rows else ((), (), ())

        def made() -> Path:
            if self.planar:
                return way_points(times, p, [turn[0] for turn in turns], how, self.name)
            from scipy.spatial.transform import Rotation

            Q = Rotation.from_rotvec(np.reshape(turns, (-1, 3))).as_matrix()
            return way_points(times, np.reshape(p, (-1, 3)), Q, how, self.name)

        return self._tried("way_points", made)

    def _way_point(self, item: Node, index: int) -> tuple[float, list[float], list[float]]:
        turn = "phi" if self.planar else "rotation"
        fields = ("time", "p", turn)
        where = f"way_points[{index + 1}]"
        if not isinstance(item, Table) or set(item.entries) != set(fields):
            found = ", ".join(item.entries) if isinstance(item, Table) else described(item)
            self.problems.wrong(item.line, where, f"found {found}, expected {', '.join(fields)}")
            return 0.0, [], []
        count = 2 if self.planar else 3
        time = self._numbers(item.entries["time"], f"{where}.time", Kind.NUMBER, None)
        p = self._numbers(item.entries["p"], f"{where}.p", Kind.LENGTH, count)
        turns = self._numbers(item.entries[turn], f"{where}.{turn}", Kind.ANGLE, None if self.planar else 3)
        return time[0], p, turns

    def _objective(self) -> Objective | None:
        node = self.root.entries.get("objective", Text("eta_1", True, 0))
        if isinstance(node, Table):
            weights: dict[str, Any] = {
                name: self._numbers(value, f"objective.{name}", Kind.NUMBER, None)[0]
                for name, value in node.entries.items()
                if name != "load"
            }
            if (load := node.entries.get("load")) is not None:
                weights["load"] = self._load(load)
            if self.problems.mistakes:
                return None
            return self._tried("objective", lambda: Objective.of(weights))
        if isinstance(node, Text):
            return self._tried("objective", lambda: Objective.of(node.text))
        self._wrong(
            self.root, "objective", f"found {described(node)}, expected {', '.join(TERMS)} or weights"
        )
        return None

    def _load(self, node: Node) -> Load | None:
        where, counts = "objective.load", {"wrench": 3 if self.planar else 6, "redundant_forces": 3}
        fields = tuple(counts)
        if not isinstance(node, Table) or "wrench" not in node.entries or set(node.entries) - set(fields):
            found = ", ".join(node.entries) if isinstance(node, Table) else described(node)
            expected = f"wrench and, where there are any, {fields[1]}"
            self.problems.wrong(node.line, where, f"found {found}, expected {expected}")
            return None
        values = {
            name: tuple(self._numbers(value, f"{where}.{name}", Kind.NUMBER, counts[name]))
            for name, value in node.entries.items()
        }
        return Load(**values)

    def _bounds(self) -> Bounds | None:
        node = self.root.entries.get("limits")
        if isinstance(node, Text) and node.text == CHAPTER_4:
            return chapter_4()
        if not isinstance(node, Table):
            found = "nothing" if node is None else described(node)
            line = self.root.lines.get("limits", self.root.line)
            expected = f"{CHAPTER_4} or a table with {', '.join(LIMITS)}"
            self.problems.wrong(line, "limits", f"found {found}, expected {expected}")
            return None
        for field, line in node.lines.items():
            if field not in LIMITS:
                self.problems.wrong(line, f"limits.{field}", f"unknown field; {nearest(field, LIMITS)}")
        values: dict[str, Any] = {}
        box = node.entries.get("redundant", Text("", True, node.line))
        low = self._numbers(box, "limits.redundant", self.redundant, 2)
        values["redundant"] = (low[0], low[1])
        for field, kind in (
            ("redundant_rate", self.redundant),
            ("swivel_rate", Kind.ANGLE),
            ("actuator_rate", Kind.NUMBER),
            ("actuator_acceleration", Kind.NUMBER),
            ("cone", Kind.ANGLE),
            ("clearance", Kind.LENGTH),
        ):
            if field in node.entries:
                values[field] = self._numbers(node.entries[field], f"limits.{field}", kind, None)[0]
        if "swivel" in node.entries:
            sides = self._numbers(node.entries["swivel"], "limits.swivel", Kind.ANGLE, 2)
            values["swivel"] = (sides[0], sides[1])
        if "margins" in node.entries:
            values["margins"] = tuple(
                self._numbers(node.entries["margins"], "limits.margins", Kind.NUMBER, 1 if self.planar else 2)
            )
        factors = node.entries.get("factors")
        if isinstance(factors, Table):
            values["factors"] = {
                name: self._numbers(value, f"limits.factors.{name}", Kind.NUMBER, None)[0]
                for name, value in factors.entries.items()
            }
        elif factors is not None:
            self.problems.wrong(
                factors.line, "limits.factors", f"found {described(factors)}, expected a table"
            )
        if "grip" in node.entries:
            values["grip"] = self._grip(node.entries["grip"])
        return Bounds(**values)

    def _grip(self, node: Node) -> Grip | None:
        where = "limits.grip"
        if not isinstance(node, Table) or "opening" not in node.entries:
            expected = f"a table with {', '.join(GRIP)}, of which opening must be there"
            self.problems.wrong(node.line, where, f"found {described(node)}, expected {expected}")
            return None
        for field, line in node.lines.items():
            if field not in GRIP:
                self.problems.wrong(line, f"{where}.{field}", f"unknown field; {nearest(field, GRIP)}")
        values: dict[str, Any] = {}
        for field in GRIP:
            if (given := node.entries.get(field)) is None:
                continue
            each = 3 if field == "jaws" and isinstance(given, Items) else None
            numbers = self._numbers(given, f"{where}.{field}", Kind.LENGTH, each)
            values[field] = numbers[0] if each is None else tuple(numbers)
        return Grip(**values)

    # -- values ---------------------------------------------------------------------------------------------

    def _numbers(self, node: Node, field: str, kind: Kind, count: int | None) -> list[float]:
        """A list of so many quantities, or one; zeros where it is wrong, which is then told."""
        if count is not None and (not isinstance(node, Items) or len(node.items) != count):
            self.problems.wrong(node.line, field, f"found {described(node)}, expected a list of {count}")
            return [0.0] * count
        found = []
        for item in node.items if count is not None and isinstance(node, Items) else (node,):
            try:
                found.append(parse(item, kind))
            except BadQuantity as error:
                self.problems.wrong(item.line, field, str(error))
                found.append(0.0)
        return found

    def _number(self, table: Table, field: str, kind: Kind, default: float) -> float:
        node = table.entries.get(field)
        return default if node is None else self._numbers(node, field, kind, None)[0]

    def _choice(self, table: Table, field: str, known: tuple[str, ...], default: str) -> str:
        node = table.entries.get(field)
        if node is None:
            return default
        if isinstance(node, Text) and node.text in known:
            return node.text
        text = node.text if isinstance(node, Text) else ""
        self._wrong(table, field, f"found {described(node)}; {nearest(text, known)}")
        return default

    def _tried(self, field: str, make: Callable[[], Found]) -> Found | None:
        try:
            return make()
        except (PathError, UnknownObjective) as error:
            self._wrong(self.root, field, str(error))
            return None

    def _wrong(self, table: Table, field: str, message: str) -> None:
        self.problems.wrong(table.lines.get(field, table.line), field, message)
