"""What a call costs: so much a call and so much a pose, by threads; and by the number of a leg's joints.

A call for n poses takes a + b n, fitted to all the batches that `scaling` measured, with equal weights: from
ten poses, where a is all, to ten million, where only b is left. The worst deviation tells what caches change.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np

Found = Mapping[str, Any]

SERIAL = re.compile(r"(?P<kind>planar|spatial)_(?P<joints>r+)_[abc]")
"""Robots whose legs are chains of revolute joints: they differ in the number of these."""
COLUMNS = ("w1 single", "w1 batch", "w2 single", "w2 batch")


@dataclass(frozen=True)
class Line:
    """a + b n for one number of threads."""

    threads: int
    call: float
    """a, nanoseconds."""
    pose: float
    """b, nanoseconds."""
    worst: float
    """The largest relative deviation of a measured batch."""

    def per_pose(self, poses: int) -> float:
        """What the model says of a batch, nanoseconds per pose."""
        return self.call / poses + self.pose


@dataclass(frozen=True)
class Legs:
    """Robots with the same legs: means over the arrangements."""

    kind: str  # planar or spatial
    joints: int  # of one leg
    nanoseconds: Mapping[str, float]  # by column


def lines(points: Sequence[Found]) -> list[Line]:
    """One line for each number of threads, from the points that `scaling` measured."""
    found = []
    for threads in sorted({point["threads"] for point in points}):
        own = [point for point in points if point["threads"] == threads]
        poses = np.array([point["poses"] for point in own], dtype=float)
        each = np.array([point["undisturbed"] for point in own])
        # divided by what was measured: relative deviations
        rows = np.column_stack([1 / (poses * each), 1 / each])
        call, pose = np.linalg.lstsq(rows, np.ones(len(own)), rcond=None)[0]
        worst = np.abs(rows @ [call, pose] - 1).max()
        found.append(Line(threads, float(call), float(pose), float(worst)))
    return found


def legs(robots: Sequence[Found]) -> list[Legs]:
    """Serial legs by kind and number of joints, from what `every_robot` measured."""
    groups: dict[tuple[str, int], list[Found]] = {}
    for robot in robots:
        match = SERIAL.fullmatch(robot["robot"])
        if match:
            groups.setdefault((match["kind"], len(match["joints"])), []).append(robot["undisturbed"])
    return [
        Legs(kind, joints, {column: float(np.mean([one[column] for one in group])) for column in COLUMNS})
        for (kind, joints), group in sorted(groups.items())
    ]


def text(results: Found) -> str:
    """The model in words, and a table of legs."""
    parts = []
    if results["scaling"]:
        parts += [_in_words(line) for line in lines(results["scaling"])]
    found = legs(results["every robot"])
    if found:
        parts += [_a_joint_more(few, many) for few, many in pairwise(found) if few.kind == many.kind]
        head = ["legs", "W1", "W1, batch", "W2", "W2, batch"]
        rule = ["---", *["---:"] * len(COLUMNS)]
        rows = [
            [f"{one.kind}, {one.joints} joints", *(f"{one.nanoseconds[column]:.0f}" for column in COLUMNS)]
            for one in found
        ]
        parts.append("\n" + "\n".join(f"| {' | '.join(row)} |" for row in (head, rule, *rows)))
    return "\n".join(parts) + "\n"


def _a_joint_more(few: Legs, many: Legs) -> str:
    ratios = [f"{many.nanoseconds[column] / few.nanoseconds[column]:.2f}" for column in COLUMNS]
    return (
        f"* {many.joints} joints in {few.kind} legs where there were {few.joints}: {ratios[0]} times as long "
        f"in W1 ({ratios[1]} in batches), {ratios[2]} in W2 ({ratios[3]})."
    )


def _in_words(line: Line) -> str:
    threads = "one thread" if line.threads == 1 else f"{line.threads} threads"
    return (
        f"* W2 on {threads}: {line.call / 1000:.1f} µs a call and {line.pose:.0f} ns a pose; "
        f"the measured batches are within {100 * line.worst:.0f} % of that."
    )
