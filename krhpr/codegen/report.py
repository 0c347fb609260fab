"""Files of `generated/` that tell about the others: packages, a README, the operation counts, the CMake
project.
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Sequence
from dataclasses import replace

from krhpr import __version__
from krhpr.codegen.kernel import LEGS
from krhpr.codegen.part import Part
from krhpr.codegen.robot_code import RobotCode
from krhpr.codegen.targets.base import File, render
from krhpr.codegen.targets.c_control import is_controlled
from krhpr.robot_files.facts import facts_of_code
from krhpr.robot_files.schema import schema_text
from krhpr.validation.page import page

SCHEMA_FILE = "robot-file.schema.json"
"""What editors check robot files with."""


def report_files(robots: Sequence[RobotCode], parts: Iterable[Part], printed: Sequence[File]) -> list[File]:
    """Everything that is not printed from a kernel."""
    usual = [robot for robot in robots if robot.legs == LEGS]
    identifiers = [robot.identifier for robot in robots]
    others = [robot.identifier for robot in robots if robot.legs != LEGS]
    rows = summary(robots, printed)
    return [
        File(
            "__init__.py",
            render(
                "python/package.py.j2",
                identifiers=[robot.identifier for robot in usual],
                grasping=others,
                version=__version__,
            ),
        ),
        File("python/__init__.py", render("python/targets_package.py.j2", what="NumPy modules")),
        File("casadi/__init__.py", render("python/targets_package.py.j2", what="CasADi modules")),
        File(
            "c/CMakeLists.txt",
            render(
                "c/CMakeLists.txt.j2",
                identifiers=identifiers,
                controlled=[robot.identifier for robot in robots if is_controlled(robot)],
                version=__version__,
            ),
        ),
        File(SCHEMA_FILE, schema_text([facts_of_code(robot) for robot in usual])),
        File("operations.json", _operations(robots, parts)),
        File("README.md", render("README.md.j2", rows=rows, robots=robots)),
        File("VALIDATION.md", render("VALIDATION.md.j2", grasping=others, **page(_catalogued(usual)))),
    ]


def _catalogued(robots: Sequence[RobotCode]) -> list[RobotCode]:
    """The robots of the catalogue that these are: checks are planned for those."""
    return list(
        {robot.architecture: replace(robot, identifier=robot.architecture) for robot in robots}.values()
    )


def summary(robots: Sequence[RobotCode], printed: Sequence[File]) -> list[dict[str, object]]:
    """One row per robot: functions, operations as written and after the passes, lines of its own files."""
    lines = {file.path: file.text.count("\n") for file in printed}
    rows = []
    for robot in robots:
        functions = [function for function in robot.functions if not function.chooses]
        own = [path for path in lines if path.rsplit("/", 1)[-1].split(".")[0] in _stems(robot)]
        rows.append(
            {
                "robot": robot.identifier,
                "notation": robot.notation,
                "functions": len(robot.functions),
                "written": sum(robot.written(function) for function in functions),
                "operations": sum(robot.operations(function).total for function in functions),
                "lines": sum(lines[path] for path in own),
            }
        )
    return rows


def _stems(robot: RobotCode) -> set[str]:
    return {robot.identifier, f"krhpr_{robot.identifier}"}


def _operations(robots: Sequence[RobotCode], parts: Iterable[Part]) -> str:
    """Operation counts of every kernel and every function, as JSON."""
    kernels = {}
    for part in sorted(parts, key=lambda part: part.name):
        for kernel in part.kernels:
            kernels[f"{part.name}.{kernel.name}"] = {
                "written": part.written[kernel.name],
                "total": kernel.operations.total,
                **kernel.operations.as_dict(),
            }
    functions = {}
    for robot in robots:
        for function in robot.functions:
            if not function.chooses:
                count = robot.operations(function)
                functions[f"{robot.identifier}.{function.name}"] = {
                    "written": robot.written(function),
                    "total": count.total,
                    **count.as_dict(),
                }
    about = "Written by `krhpr generate`; do not edit.  Operations of one call.  "
    about += f"written: in the formulas as derived; leg kernels count {LEGS} times in a function."
    return json.dumps({"about": about, "kernels": kernels, "functions": functions}, indent=1) + "\n"
