"""The catalogue of generated robots, and loading one by its name there or by a robot file."""

from __future__ import annotations

import os
from collections.abc import Mapping
from importlib import import_module
from pathlib import Path
from types import ModuleType

import krhpr.generated
from krhpr import __version__
from krhpr.backend import backend_name
from krhpr.errors import GeneratedMismatch, UnknownRobot
from krhpr.generated.python.runtime import Geometry
from krhpr.grasping import GraspingRobot
from krhpr.robot import Robot
from krhpr.robot_files.closing import geometry_of
from krhpr.robot_files.facts import facts_of_module
from krhpr.robot_files.reader import RobotFile, is_robot_file, read_robot_file


def catalogue() -> tuple[str, ...]:
    """Identifiers of all robots."""
    _check_version()
    return tuple(krhpr.generated.ROBOTS)


def grasping_robots() -> tuple[str, ...]:
    """Identifiers of the robots with two jaws and two sub-legs (Figs. 5.1, 5.2)."""
    _check_version()
    return tuple(krhpr.generated.GRASPING)


def load_grasping(robot: str = "planar_grasp_prr", *, backend: str | None = None) -> GraspingRobot:
    """A grasping robot with its default geometry; `backend` as for `load`.

    Raises UnknownRobot.
    """
    if robot not in grasping_robots():
        raise UnknownRobot.among(robot, grasping_robots())
    backend_name(backend)
    return GraspingRobot(_module(robot), backend=backend)


def load(robot: str | os.PathLike[str], *, backend: str | None = None) -> Robot:
    """A robot of the catalogue with its default geometry, or that of a robot file (a path, or a name that
    ends in .yaml or .yml): the catalogue's kernels with the file's name, geometry and limits.

    `backend` is `auto` (compiled kernels where there is a compiler, else NumPy), `compiled` or `numpy`; the
    environment variable KRHPR_BACKEND sets it for all.

    Raises UnknownRobot, or, for a file, RobotFileError and OSError.
    """
    if not isinstance(robot, str) or is_robot_file(robot):
        backend_name(backend)
        return _load_file(Path(robot), backend)
    if robot in grasping_robots():
        raise UnknownRobot(
            f"{robot} is a grasping robot, with functions of its own: krhpr.load_grasping({robot!r})"
        )
    if robot not in catalogue():
        raise UnknownRobot.among(robot, catalogue())
    backend_name(backend)
    return Robot(_module(robot), backend=backend)


def checked_file(path: Path, own: Mapping[str, ModuleType] | None = None) -> RobotFile:
    """A robot file, checked against the robots that are generated, and closing at its home pose.

    `own` are the NumPy modules of further robots by name, which the file may choose too.
    """
    return _checked(path, own or {})[0]


def _checked(path: Path, own: Mapping[str, ModuleType]) -> tuple[RobotFile, ModuleType, Geometry]:
    def module_of(identifier: str) -> ModuleType:
        return own[identifier] if identifier in own else _module(identifier)

    known = (*catalogue(), *own)
    file = read_robot_file(path, known, lambda identifier: facts_of_module(module_of(identifier)))
    module = module_of(file.identifier)
    return file, module, geometry_of(file, module)


def _load_file(path: Path, backend: str | None) -> Robot:
    file, module, geometry = _checked(path, {})
    home = None if file.home is None else (file.home.p, file.home.redundant)
    return Robot(module, geometry, backend, name=file.name, limits=file.limits, home=home)


def _module(identifier: str) -> ModuleType:
    return import_module(f"krhpr.generated.python.{identifier}")


def _check_version() -> None:
    written = getattr(krhpr.generated, "VERSION", None)
    if written != __version__:
        raise GeneratedMismatch(
            f"the generated robots were written by krhpr {written or 'of an unknown version'}, "
            f"this is krhpr {__version__}; "
            "run `krhpr generate` (or `make generate`)"
        )
