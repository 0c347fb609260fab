"""A grasping robot with an object in its jaws, from a YAML file.

    robot: planar_grasp_prr
    geometry: {l_1: 120 mm, l_2: 120 mm, l_j: [42.4 mm, 42.4 mm]}    # a value, or one of each jaw
    pose: {pivot: [0, 90 mm], phi: 45 deg, beta: 135 deg}
    object: {width: 42.7 mm, height: 42.5 mm, weight: 0.3, friction: 0.5}
    drive: {radius: 4.5 mm, ratio: 29}
    grasp_force: 2
    trajectories:
      along x: {x: 20 mm, frequency: 1}
      about B: {turn: 10 deg, frequency: 0.3}
    duration: 20

Numbers are SI (newtons, seconds, radians per second) and lengths and angles may have their unit.  The file is
read as robot files are: it cannot run anything.
"""

from __future__ import annotations

import math
from pathlib import Path

from krhpr.errors import nearest
from krhpr.loading import grasping_robots, load_grasping
from krhpr.robot_files.fields import FieldReader
from krhpr.robot_files.quantities import Kind
from krhpr.robot_files.tree import Items, Node, Table, Text
from krhpr.robot_files.tree import described as described_node
from krhpr.study.grasp import Drive, Held, Motion, Setup

USUAL = {
    "object.weight": (1e-4, 1e3, " N"),
    "object.friction": (0.01, 3.0, ""),
    "grasp_force": (1e-3, 1e3, " N"),
    "drive.ratio": (1e-2, 1e4, ""),
}
"""Numbers of what jaws hold, and their unit: beyond these a unit is hardly meant, as grams for newtons."""

_TABLES = {
    "pose": {"pivot": Kind.LENGTH, "phi": Kind.ANGLE, "beta": Kind.ANGLE},
    "object": {
        "width": Kind.LENGTH,
        "height": Kind.LENGTH,
        "weight": Kind.NUMBER,
        "friction": Kind.NUMBER,
    },
    "drive": {"radius": Kind.LENGTH, "ratio": Kind.NUMBER},
}
_MOTION = {"x": Kind.LENGTH, "y": Kind.LENGTH, "turn": Kind.ANGLE, "frequency": Kind.NUMBER}
FIELDS = ("robot", "geometry", *_TABLES, "grasp_force", "trajectories", "duration")


def read_grasp_file(path: Path) -> Setup:
    """Read a file; suspicions are warned of (RobotFileWarning).

    Raises:
        RobotFileError: every mistake with its line, what was found and what is expected.
        OSError: the file cannot be read.
    """
    return _Reader(path).setup()


class _Reader(FieldReader):
    def setup(self) -> Setup:
        self.need(FIELDS)
        robot = self._robot()
        geometry = self._geometry(robot)
        pose, held, drive = (self._table(name) for name in _TABLES)
        force = self._positive("grasp_force")
        duration = self._positive("duration")
        motions = self._motions()
        self._usual({"object": held, "drive": drive}, force)
        self._fits(held, pose["beta"][0] - pose["phi"][0])
        self.finish()
        pivot = pose["pivot"]
        return Setup(
            robot,
            geometry,
            (pivot[0], pivot[1]),
            pose["phi"][0],
            pose["beta"][0],
            Held(*(held[name][0] for name in _TABLES["object"])),
            Drive(*(drive[name][0] for name in _TABLES["drive"])),
            force,
            motions,
            duration,
        )

    def _robot(self) -> str:
        node, known = self.root.entries["robot"], grasping_robots()
        if isinstance(node, Text) and node.text in known:
            return node.text
        text = node.text if isinstance(node, Text) else ""
        self.problems.wrong(node.line, "robot", f"found {described_node(node)}; {nearest(text, known)}")
        return known[0]

    def _geometry(self, robot: str) -> dict[str, tuple[float, float]]:
        node = self.root.entries["geometry"]
        if not isinstance(node, Table):
            self.problems.wrong(node.line, "geometry", f"found {described_node(node)}, expected a table")
            return {}
        loaded = load_grasping(robot, backend="numpy")
        units = dict(loaded.documentation["units"])
        positive = loaded.geometry.positive
        self.known(node, "geometry.", tuple(units))
        found = {}
        for name, value in node.entries.items():
            if name not in units:
                continue
            kind = Kind.ANGLE if units[name] == "rad" else Kind.LENGTH
            field = f"geometry.{name}"
            count = 2 if isinstance(value, Items) else None
            numbers = self.numbers(value, field, kind, count)
            if name in positive and not min(numbers) > 0:
                self.problems.wrong(value.line, field, "a length must be positive")
            found[name] = (numbers[0], numbers[-1])
        return found

    def _table(self, name: str) -> dict[str, list[float]]:
        node, kinds = self.root.entries[name], _TABLES[name]
        if not isinstance(node, Table) or set(node.entries) != set(kinds):
            found = ", ".join(node.entries) if isinstance(node, Table) else described_node(node)
            self.problems.wrong(node.line, name, f"found {found}, expected {', '.join(kinds)}")
            return {field: [0.0, 0.0] for field in kinds}
        values = {
            field: self.numbers(node.entries[field], f"{name}.{field}", kind, 2 if field == "pivot" else None)
            for field, kind in kinds.items()
        }
        for field in ("width", "ratio", "radius"):
            if field in values and not values[field][0] > 0:
                self.problems.wrong(node.entries[field].line, f"{name}.{field}", "it must be positive")
        for field in ("weight", "friction"):
            if field in values and values[field][0] < 0:
                self.problems.wrong(node.entries[field].line, f"{name}.{field}", "it must not be negative")
        return values

    def _motions(self) -> tuple[Motion, ...]:
        node = self.root.entries["trajectories"]
        if not isinstance(node, Table) or not node.entries:
            self.problems.wrong(node.line, "trajectories", f"found {described_node(node)}, expected a table")
            return ()
        return tuple(self._motion(name, entry) for name, entry in node.entries.items())

    def _motion(self, name: str, node: Node) -> Motion:
        field = f"trajectories.{name}"
        if not isinstance(node, Table) or "frequency" not in node.entries:
            self.problems.wrong(node.line, field, f"expected frequency and some of {', '.join(_MOTION)}")
            return Motion(name, 0.0)
        self.known(node, f"{field}.", tuple(_MOTION))
        values = {
            key: self.numbers(node.entries[key], f"{field}.{key}", kind, None)[0]
            for key, kind in _MOTION.items()
            if key in node.entries
        }
        return Motion(name, **values)

    def is_size(self, field: str) -> bool:
        """Poses and motions may be as small as they like."""
        return not field.startswith(("pose.", "trajectories."))

    def _usual(self, tables: dict[str, dict[str, list[float]]], force: float) -> None:
        """Numbers without a unit of their own."""
        for field, (low, high, unit) in USUAL.items():
            table, _, name = field.partition(".")
            value = tables[table][name][0] if name else force
            self.plausible(self.root.entries[table].line, field, value, low, high, unit)

    def _fits(self, held: dict[str, list[float]], gamma: float) -> None:
        """An object that reaches beyond the lines of the jaws' links is hardly between them."""
        width, height = held["width"][0], held["height"][0]
        if height > 0 and 0 < gamma < math.pi and width > (apart := 2 * height * math.tan(gamma / 2)):
            self.problems.suspicious(
                self.root.entries["object"].line,
                "object.width",
                f"{width:g} m is wider than the jaws are open: their lines are {apart:.4g} m apart at its "
                "height",
            )

    # -- values ---------------------------------------------------------------------------------------------

    def _positive(self, field: str) -> float:
        node = self.root.entries[field]
        value = self.numbers(node, field, Kind.NUMBER, None)[0]
        if not value > 0:
            self.problems.wrong(node.line, field, "it must be positive")
        return value
