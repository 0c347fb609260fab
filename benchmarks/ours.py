"""This project's own contenders: the workloads as robot functions, printed by the generator like any other.

W1 starts from joint angles, so it is the composition of the sub-leg's forward kinematics with the rows of J
and K; W2 and W5 are `inverse` and `subleg_jacobian`. Geometry is baked: a constant, prepared structure next
to the glue.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from benchmarks import robot as sizes
from benchmarks.contender import OURS, Contender, Missing
from benchmarks.python_contender import PythonContender
from benchmarks.workloads import Workload
from krhpr.codegen.bake import baked_geometry
from krhpr.codegen.build import Parts, build
from krhpr.codegen.composition import Call, RobotCode, RobotFunction, Stage
from krhpr.codegen.targets.c import CTarget
from krhpr.derivations.catalogue import catalogue

ROBOT = {"w1": "spatial_rrr_a", "w2": "spatial_rrr_a", "w5": "spatial_r_fivebar_a"}
CALL = {
    "w1": "krhpr_{robot}_w1(&geometry, p, Q, theta, J, K)",
    "w2": "krhpr_{robot}_w2(&geometry, p, Q, beta, mode, theta)",
    "w5": "krhpr_{robot}_w5(&geometry, s, theta, M)",
}


def c_contenders(workload: Workload, folder: Path) -> list[Contender] | Missing:
    """Generated scalar C: with the kernels' own sine and cosine, and with the C library's."""
    parts = Parts()
    entry = next(entry for entry in catalogue() if entry.identifier == ROBOT[workload.key])
    robot = build(entry, parts)
    if workload.key == "w5":
        robot = replace(robot, default_geometry={**robot.default_geometry, "l_3": (sizes.HYBRID.l3,) * 3})
    robot = replace(robot, functions=(_function(robot, workload.key),))
    folder = folder / f"ours_{workload.key}"
    folder.mkdir(parents=True, exist_ok=True)
    target = CTarget()
    for file in (*target.shared(), *(f for part in parts for f in target.part(part)), *target.robot(robot)):
        (folder / Path(file.path).name).write_text(file.text)
    name = robot.identifier
    glue = (
        f'#include "krhpr_{name}.c"\n'
        + baked_geometry(robot, "geometry")
        + "static const double mode[6] = {1.0, 1.0, 1.0, 1.0, 1.0, 1.0};\n"
        + f"{workload.prototype()}\n{{\n    {CALL[workload.key].format(robot=name)};\n}}\n"
    )
    glue = (
        glue
        if workload.key == "w2"
        else glue.replace("static const double mode[6]", "extern const double unused_mode[6]; //")
    )
    options = {"scalar": (), "scalar, libm": ("-DKRHPR_LIBM",)}
    return [
        Contender(OURS, workload.key, variant, glue, include_dirs=(str(folder),), extra_flags=flags)
        for variant, flags in options.items()
    ]


def _function(robot: RobotCode, key: str) -> RobotFunction:
    """The workload as a function of the robot."""
    if key == "w2":
        return replace(robot.function("inverse"), name="w2")
    if key == "w5":
        return replace(robot.function("subleg_jacobian"), name="w5")
    blocks = robot.function("jacobian_blocks")
    inputs = tuple(port for port in blocks.inputs if port.name != "s")
    forward = Call(Stage.LEG, "subleg", "forward_posture", {}, {})
    rest = tuple(call for call in blocks.calls if call.kernel != "posture")
    return replace(blocks, name="w1", inputs=inputs, calls=(forward, *rest))


def python_contenders(workload: Workload) -> list[PythonContender] | Missing:
    """The same kernels called from Python."""
    return Missing(OURS, "not plugged in yet (benchmarks/ours.py)")
