"""What `krhpr certify` does."""

from __future__ import annotations

import argparse
import json
import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import krhpr
from krhpr.certificate import Box, Certificate, Finding, Verdict, certify, certify_unique, largest_box
from krhpr.certificate.factors import is_angular
from krhpr.cli.common import Column, Exit, WrongUse, print_table
from krhpr.cli.evaluation import with_geometry
from krhpr.robot import Robot


def run(options: argparse.Namespace) -> int:
    """Certify a box, or find the largest one, and print what is known."""
    robot = with_geometry(krhpr.load(options.robot, backend="numpy"), options.geometry)
    angular = is_angular(robot)
    if options.degrees and not angular:
        raise WrongUse(f"--degrees: the redundant coordinates of {robot.identifier} are slides, in metres")
    _check(options)
    unit = _Unit("deg" if options.degrees else "rad" if angular else "m", options.degrees)
    if not options.largest:
        question = certify_unique if options.unique else certify
        box = question(robot, unit.read(options.low), unit.read(options.high), closed=not options.open)
        if options.json:
            print(json.dumps(_certificate_facts(box, unit), indent=1))
        else:
            _print(robot, box, unit, unique=options.unique)
        return Exit.OK if box.free else Exit.DIFFERENCE
    proportions = _spread(options.proportions or [1.0])
    found = largest_box(robot, unit.read(options.centre), proportions)
    if options.json:
        beyond = None if found.beyond is None else _certificate_facts(found.beyond, unit)
        facts = {"half_width": unit.write(found.half_width), **_certificate_facts(found.certificate, unit)}
        print(json.dumps({**facts, "beyond": beyond}, indent=1))
    else:
        print(f"largest half-width {unit.text(found.half_width)}")
        _print(robot, found.certificate, unit)
        if found.beyond is None:
            print("no larger box was tried")
        else:
            print(f"a box larger by 1e-9 is {_verdict(found.beyond, unit)}")
    return Exit.OK


def _check(options: argparse.Namespace) -> None:
    """Which options go together."""
    given = {name for name in ("low", "high", "centre", "proportions") if getattr(options, name) is not None}
    if options.largest:
        if "centre" not in given or given & {"low", "high"} or options.open or options.unique:
            raise WrongUse(
                "--largest takes --centre (and --proportions), not --low, --high, --open or --unique: its "
                "box is open, and free of type II singularities"
            )
    elif not {"low", "high"} <= given or given & {"centre", "proportions"}:
        raise WrongUse("give a box by --low and --high, or --largest with --centre")


@dataclass(frozen=True)
class _Unit:
    """The unit in which redundant coordinates are read and written."""

    name: str
    degrees: bool

    def read(self, values: Sequence[float]) -> list[float]:
        return [math.radians(value) for value in _spread(values)] if self.degrees else _spread(values)

    def write(self, value: float) -> float:
        return math.degrees(value) if self.degrees else value

    def text(self, value: float) -> str:
        return f"{self.write(value):.10g} {self.name}"

    def point(self, values: Sequence[float]) -> str:
        return "(" + ", ".join(f"{self.write(value):.10g}" for value in values) + f") {self.name}"


def _spread(values: Sequence[float]) -> list[float]:
    if len(values) not in (1, 3):
        raise WrongUse(f"found {len(values)} numbers, expected one for all legs or three")
    return list(values) * 3 if len(values) == 1 else list(values)


# -- as text -------------------------------------------------------------------------------------------------


def _print(robot: Robot, found: Certificate, unit: _Unit, unique: bool = False) -> None:
    if unique:
        said = "one solution of forward at most" if found.free else "perhaps several solutions of forward"
        print(f"{robot.identifier}: the box holds {said}")
    else:
        print(f"{robot.identifier}: the box is {_verdict(found, unit)}")
    name = robot.documentation["redundant"][0][0]
    kind = "closed" if found.box.closed else "open"
    print(f"{kind} box {name}: {unit.point(found.box.low)} to {unit.point(found.box.high)}")
    rows = [
        (finding.factor, str(finding.verdict), str(finding.method), _bound(finding), _remark(finding, unit))
        for finding in found.findings
    ]
    titles = ("factor", "verdict", "test", "|margin| at least", "where")
    print_table([Column(title) for title in titles], rows)


def _verdict(found: Certificate, unit: _Unit) -> str:
    if found.verdict is Verdict.FREE:
        return "free of type II singularities"
    if found.point is not None:
        return f"singular at {unit.point(found.point)}"
    return "undecided"


def _bound(finding: Finding) -> str:
    return f"{finding.bound:.6g}" if finding.verdict is Verdict.FREE else "-"


def _remark(finding: Finding, unit: _Unit) -> str:
    if finding.point is not None:
        return unit.point(finding.point)
    if finding.cell is not None:
        return f"left: {unit.point(finding.cell.low)} to {unit.point(finding.cell.high)}"
    return ""


# -- as data -------------------------------------------------------------------------------------------------


def _certificate_facts(found: Certificate, unit: _Unit) -> dict[str, Any]:
    return {
        "robot": found.robot,
        "unit": unit.name,
        "box": _box_facts(found.box, unit),
        "free": found.free,
        "verdict": found.verdict,
        "point": None if found.point is None else [unit.write(x) for x in found.point],
        "factors": [
            {
                "factor": finding.factor,
                "verdict": finding.verdict,
                "test": finding.method,
                "sign": finding.sign,
                "bound": finding.bound,
                "point": None if finding.point is None else [unit.write(x) for x in finding.point],
                "cell": None if finding.cell is None else _box_facts(finding.cell, unit),
            }
            for finding in found.findings
        ],
    }


def _box_facts(box: Box, unit: _Unit) -> dict[str, Any]:
    return {
        "low": [unit.write(x) for x in box.low],
        "high": [unit.write(x) for x in box.high],
        "closed": box.closed,
    }
