"""Plant, sensors and gains of the grasping force's control, from a YAML file.

    rate: 500 Hz
    motor: {inertia: 4.2 g cm2, torque_limit: 12 mN m}
    friction: {torque: 0.08 mN m, load_share: 0.3, stiction: 1.2, stribeck_speed: 1 mm/s,
               presliding: 0.0015 mm, viscous: 10 N s/m}
    contact: {stiffness: 150 N/mm, damping: 20}
    sensors: {encoder_counts: 2048, force_noise: 20 mN}
    position: {stiffness: 5 N/mm, damping: 600 N s/m, filter_time: 4 ms}
    force: {proportional: 0.8, integral: 30, derivative: 15 ms, filter_time: 4 ms, least: 50 mN, most: 10 N}
    seed: 0

Numbers without a unit are SI.  Robot, object and trajectories are in a file of their own
(`krhpr.study.grasp_file`).  The file is read as robot files are: it cannot run anything.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import inf
from pathlib import Path
from typing import Any

from krhpr.control.parameters import (
    Contact,
    ControlSetup,
    ForceGains,
    GearFriction,
    Motor,
    PositionGains,
    Sensors,
)
from krhpr.errors import ControlError
from krhpr.robot_files.fields import FieldReader
from krhpr.robot_files.quantities import Kind
from krhpr.robot_files.tree import Table
from krhpr.robot_files.tree import described as described_node


@dataclass(frozen=True)
class Plausible:
    """A quantity, and between which values it is believed without a question."""

    kind: Kind
    low: float = 0.0
    high: float = inf


_NUMBER = Plausible(Kind.NUMBER)
_FILTER = Plausible(Kind.TIME, high=1.0)

TABLES: dict[str, tuple[type, dict[str, Plausible]]] = {
    "motor": (
        Motor,
        {
            "inertia": Plausible(Kind.INERTIA, 1e-9, 1e-3),
            "torque_limit": Plausible(Kind.TORQUE, 1e-4, 10.0),
        },
    ),
    "friction": (
        GearFriction,
        {
            "torque": Plausible(Kind.TORQUE, high=0.02),
            "load_share": Plausible(Kind.NUMBER, high=1.0),
            "stiction": Plausible(Kind.NUMBER, high=5.0),
            "stribeck_speed": Plausible(Kind.SPEED, 1e-6, 0.1),
            "presliding": Plausible(Kind.LENGTH, 1e-8, 1e-4),
            "viscous": Plausible(Kind.DAMPING, high=1e4),
        },
    ),
    "contact": (
        Contact,
        {"stiffness": Plausible(Kind.STIFFNESS, 1e3, 1e8), "damping": Plausible(Kind.NUMBER, high=1e4)},
    ),
    "sensors": (
        Sensors,
        {
            "encoder_counts": Plausible(Kind.NUMBER, 16.0, 1e7),
            "force_noise": Plausible(Kind.FORCE, high=1.0),
        },
    ),
    "position": (
        PositionGains,
        {
            "stiffness": Plausible(Kind.STIFFNESS, 100.0, 1e6),
            "damping": Plausible(Kind.DAMPING, high=1e5),
            "filter_time": _FILTER,
        },
    ),
    "force": (
        ForceGains,
        {
            "proportional": _NUMBER,
            "integral": _NUMBER,
            "derivative": Plausible(Kind.TIME, high=1.0),
            "filter_time": _FILTER,
            "least": Plausible(Kind.FORCE, high=10.0),
            "most": Plausible(Kind.FORCE, high=1e3),
        },
    ),
}
_RATE = Plausible(Kind.FREQUENCY, 20.0, 1e5)
FIELDS = ("rate", *TABLES, "seed")


def read_control_file(path: Path) -> ControlSetup:
    """Read a file; what is hardly meant, as a unit that is wrong by a thousand, is warned of
    (RobotFileWarning).

    Raises:
        RobotFileError: every mistake with its line, what was found and what is expected.
        OSError: the file cannot be read.
    """
    return _Reader(path).control()


class _Reader(FieldReader):
    def control(self) -> ControlSetup:
        self.need(FIELDS)
        rate = self._quantity(self.root, "rate", "rate", _RATE)
        seed = self._quantity(self.root, "seed", "seed", _NUMBER)
        if seed != int(seed) or seed < 0:
            self.problems.wrong(self.root.lines["seed"], "seed", f"found {seed:g}, expected 0, 1, 2, ...")
        parts = {name: self._part(name) for name in TABLES}
        self.problems.stop_if_any()
        try:
            found = ControlSetup(rate=rate, seed=int(seed), **parts)
        except ControlError as error:
            self.problems.wrong(self.root.lines["rate"], "rate", str(error))
            self.problems.stop_if_any()
            raise
        self.finish()
        return found

    def _part(self, name: str) -> Any:
        """One of the tables; None where it is wrong, which is then told."""
        node, (kind, fields) = self.root.entries[name], TABLES[name]
        if not isinstance(node, Table) or set(node.entries) != set(fields):
            found = ", ".join(node.entries) if isinstance(node, Table) else described_node(node)
            self.problems.wrong(node.line, name, f"found {found}, expected {', '.join(fields)}")
            return None
        mistakes = len(self.problems.mistakes)
        values = {
            field: self._quantity(node, field, f"{name}.{field}", plausible)
            for field, plausible in fields.items()
        }
        if len(self.problems.mistakes) > mistakes:
            return None
        try:
            return kind(**values)
        except ControlError as error:
            self.problems.wrong(node.line, name, str(error).partition(": ")[2])
            return None

    def _quantity(self, table: Table, name: str, field: str, plausible: Plausible) -> float:
        node = table.entries[name]
        value = self.numbers(node, field, plausible.kind, None)[0]
        unit = "" if plausible.kind is Kind.NUMBER else f" {plausible.kind.value}"
        self.plausible(node.line, field, value, plausible.low, plausible.high, unit)
        return value
