"""The pipeline, in one place: catalogue -> derivation -> function graph -> passes -> targets -> files.

    robots = derive()            # SymPy formulas, optimised kernels, functions
    files = print_all(robots)    # C, NumPy and CasADi from the same kernels
    changes = compare(files, folder)
    write(files, folder)         # or only say what would change

Every stage can be called alone.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from time import perf_counter

from krhpr.codegen.build import Parts, build
from krhpr.codegen.report import report_files
from krhpr.codegen.robot_code import RobotCode
from krhpr.codegen.targets.base import File, Target
from krhpr.codegen.targets.c import CTarget
from krhpr.codegen.targets.c_casadi import CasadiShimTarget
from krhpr.codegen.targets.c_control import CControlTarget
from krhpr.codegen.targets.casadi import CasadiTarget
from krhpr.codegen.targets.python import PythonTarget
from krhpr.derivations.catalogue import Entry, catalogue
from krhpr.derivations.grasping.catalogue import GraspingEntry, grasping
from krhpr.limits import Limits

NUMPY: Target = PythonTarget()
"""All that it takes to look a robot up, or to call it from Python."""

TARGETS: tuple[Target, ...] = (
    CTarget(),
    CControlTarget(),
    CasadiShimTarget(),
    NUMPY,
    CasadiTarget(),
)

Progress = Callable[[str], None]


@dataclass(frozen=True)
class Derived:
    """Robots that are ready to print, with the parts that they share and the time each took."""

    robots: tuple[RobotCode, ...]
    parts: Parts
    seconds: dict[str, float]


AnyEntry = Entry | GraspingEntry
"""A robot of the catalogue with three legs, or one with two jaws."""


def all_entries() -> tuple[AnyEntry, ...]:
    """Every robot that the project prints: the catalogue's, then the grasping robots."""
    return (*catalogue(), *grasping())


def derive(entries: Sequence[AnyEntry] | None = None, progress: Progress = lambda step: None) -> Derived:
    """Derive and optimise robots (all that the project knows unless given)."""
    parts, robots, seconds = Parts(), [], {}
    for entry in all_entries() if entries is None else entries:
        progress(f"derive {entry.identifier}")
        begin = perf_counter()
        robots.append(build(entry, parts))
        seconds[entry.identifier] = perf_counter() - begin
    return Derived(tuple(robots), parts, seconds)


@dataclass(frozen=True)
class Custom:
    """What somebody's own robot has in place of the catalogue's: its name, sizes, limits and
    home pose (the catalogue's unless given).

    `baked`: the sizes become constants of the code, and no argument of its functions.
    """

    name: str
    sizes: Mapping[str, tuple[float, ...]]
    limits: Limits
    baked: bool = False
    home: tuple[tuple[float, ...], tuple[float, ...]] | None = None
    """Position of the platform and redundant coordinates."""


def customised(derived: Derived, customs: Sequence[Custom | None]) -> Derived:
    """Derived robots with names, sizes and limits of one's own; None leaves one as it is."""
    robots, seconds = [], {}
    for robot, custom in zip(derived.robots, customs, strict=True):
        if custom is not None:
            p, redundant = custom.home or (robot.home_p, robot.home_redundant)
            own = replace(
                robot,
                identifier=custom.name,
                default_geometry={name: custom.sizes[name] for name in robot.default_geometry},
                limits=custom.limits,
                home_p=p,
                home_redundant=redundant,
                default_box=_box(robot, custom.limits),
                baked=custom.baked,
                of=robot.identifier,
            )
        else:
            own = robot
        robots.append(own)
        seconds[own.identifier] = derived.seconds[robot.identifier]
    return Derived(tuple(robots), derived.parts, seconds)


def _box(robot: RobotCode, limits: Limits) -> tuple[tuple[float, float], ...]:
    """Where `forward` looks for redundant angles: within the limits of their joints, if there are any."""
    joints = limits.passive.get("platform_joint")
    if not robot.default_box or joints is None:
        return robot.default_box
    return tuple((joint.low, joint.high) for joint in joints)


def print_all(
    derived: Derived, progress: Progress = lambda step: None, targets: Sequence[Target] | None = None
) -> list[File]:
    """Every file of every target (or of some), sorted by path."""
    files: list[File] = []
    for target in TARGETS if targets is None else targets:
        progress(f"print {target.name}")
        files += target.shared()
        for part in derived.parts:
            files += target.part(part)
        for robot in derived.robots:
            begin = perf_counter()
            files += target.robot(robot)
            derived.seconds[robot.identifier] += perf_counter() - begin
    progress("report")
    files += report_files(derived.robots, derived.parts, files)
    return sorted(_unique(files), key=lambda file: file.path)


def _unique(files: Iterable[File]) -> list[File]:
    found: dict[str, File] = {}
    for file in files:
        if file.path in found:
            raise ValueError(f"two targets write {file.path}")
        found[file.path] = file
    return list(found.values())
