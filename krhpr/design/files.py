"""Designs as robot files, with the limits under which they were judged."""

from __future__ import annotations

from pathlib import Path

from krhpr.design.evaluation import Evaluation, Problem
from krhpr.design.objectives import Objective
from krhpr.errors import DesignError
from krhpr.limits import Cone, Interval, Limits
from krhpr.robot import Robot
from krhpr.robot_files.facts import PLATFORM
from krhpr.robot_files.writer import write_robot_file
from krhpr.workspace import WorkspaceLimits

ALONG_LINKS = ((1.0, 0.0, 0.0), (1.0, 0.0, 0.0))
"""Socket and stud of the angle between a sub-leg's last link and the redundant link."""


def held(robot: Robot, limits: WorkspaceLimits) -> tuple[Robot, WorkspaceLimits]:
    """A robot whose own limits are those of `limits` and of its file, and what no file can say of them: the
    lowest height, the least margin, and that edges of the platform are no bodies.

    Raises:
        DesignError: spherical joints that both limit.
    """
    both = limits.beside(robot.limits)
    own = robot.limits
    spherical = own.spherical
    if both.cone is not None:
        if spherical is not None:
            raise DesignError(
                f"{robot.name}: its file limits spherical joints, and `cone` does so too; one file cannot "
                "say both: leave `cone` out"
            )
        cone = Cone(both.cone, *ALONG_LINKS)
        spherical = (cone, cone, cone)
    elbow = None if both.elbow is None else Interval(*both.elbow)
    radii = dict(own.link_radii)
    if both.radius is not None:
        names = [*dict.fromkeys(name for name, *_ in robot.links), robot.redundant_link]
        if both.edges and robot.identifier.endswith("_a"):
            names.append(PLATFORM)
        radii = {name: (both.radius,) * 3 for name in names if name} | radii
    made = Limits(own.actuators, own.passive, spherical, radii, both.clearance, both.axis_distance, elbow)
    rest = WorkspaceLimits(edges=both.edges, lowest=both.lowest, margin=both.margin)
    return robot.with_limits(made), rest


def best(found: tuple[Evaluation, ...], objective: Objective) -> Evaluation:
    """The design of a front that is best in one objective; of several the first."""
    sign = -1 if objective.more_is_better else 1
    return min(found, key=lambda one: sign * one.results[objective])


def write_design(folder: Path, problem: Problem, found: Evaluation, name: str) -> Path:
    """Write a design as the robot file `<name>.yaml`; the limits are the robot's own from then on."""
    robot, rest = held(problem.space.robot_of(found.values, name=name), problem.limits)
    told = [f"{one.words}: {found.results[one]:.5g} {one.unit}".removesuffix(" 1") for one in Objective]
    if found.cube is not None and found.cube.side:
        where = ", ".join(f"{1e3 * x:.0f}" for x in found.cube.centre)
        proven = "proven" if found.proven else "checked at the nodes of a grid"
        told.append(f"the cube has its centre at ({where}) mm and is {proven}")
    left = [
        f"{name} = {value:g}"
        for name, value in (("lowest", rest.lowest), ("margin", rest.margin))
        if value is not None
    ]
    if not rest.edges:
        left.append("edges = False")
    remarks = [f"A design of {problem.space.robot.identifier}, found by krhpr.", *told]
    if left:
        remarks.append(f"Judged with WorkspaceLimits({', '.join(left)}) beside the limits below.")
    return write_robot_file(folder / f"{name}.yaml", robot, remarks=remarks)


__all__ = ["best", "held", "write_design"]
