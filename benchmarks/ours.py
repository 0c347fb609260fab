"""This project's own contenders: the workloads as robot functions, printed by the generator like any other.

W1 starts from joint angles, so it is the composition of the sub-leg's forward kinematics with the rows of J
and K; W2 and W5 are `inverse` and `subleg_jacobian`. Geometry is baked: a constant, prepared structure next
to the glue.
"""

from __future__ import annotations

import atexit
import ctypes
import shutil
import tempfile
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

import krhpr
from benchmarks import robot as sizes
from benchmarks.contender import OURS, Contender, Missing
from benchmarks.forward import without_wrap
from benchmarks.python_contender import Floats, Prepared, PythonContender
from benchmarks.workloads import Workload
from krhpr.backend import compile_robot
from krhpr.codegen.bake import baked_geometry
from krhpr.codegen.build import Parts, build
from krhpr.codegen.composition import Call, RobotFunction, Stage
from krhpr.codegen.robot_code import RobotCode
from krhpr.codegen.targets.c import CTarget
from krhpr.codegen.targets.c_batch import goes_side_by_side
from krhpr.derivations.catalogue import catalogue
from krhpr.native import Bound, bind, function_address, load_library, make_gufunc

ROBOT = dict.fromkeys(("w1", "w2", "w3", "w4"), "spatial_rrr_a") | {"w5": "spatial_r_fivebar_a"}
CALL = {
    "w1": "krhpr_{robot}_w1(&geometry, p, Q, theta, J, K)",
    "w2": "krhpr_{robot}_w2(&geometry, p, Q, beta, mode, theta)",
    "w3": "double det_J[6], doubtful;\n"
    "    krhpr_{robot}_w3(&geometry, s, 1.0, p_all, Q_all, beta_all, det_J, count, &doubtful);\n"
    "    for (int k = (int)count[0]; k < 6; ++k) {{\n"
    "        for (int j = 0; j < 9; ++j) {{\n"
    "            Q_all[9 * k + j] = 0.0;\n"
    "        }}\n"
    "        for (int j = 0; j < 3; ++j) {{\n"
    "            p_all[3 * k + j] = beta_all[3 * k + j] = 0.0;\n"
    "        }}\n"
    "    }}",
    "w4": "krhpr_{robot}_w4(&geometry, s, p, Q, p_next, Q_next)",
    "w5": "krhpr_{robot}_w5(&geometry, s, theta, M)",
}

MODE, MODE_SIGNS = "front/elbow+", (1.0, 1.0)
"""The working mode of all contenders of w2."""


def c_contenders(workload: Workload, folder: Path) -> list[Contender] | Missing:
    """Generated scalar C: with its own sine, cosine and arctangent, and with the C library's."""
    folder = folder / f"ours_{workload.key}"
    robot = write_robot(workload, folder)
    name = robot.identifier
    signs = ", ".join(map(repr, 3 * MODE_SIGNS))
    mode = f"static const double mode[6] = {{{signs}}};\n" if workload.key == "w2" else ""
    glue = (
        f'#include "krhpr_{name}.c"\n'
        + baked(robot)
        + mode
        + f"{workload.prototype()}\n{{\n    {CALL[workload.key].format(robot=name)};\n}}\n"
    )
    options = {
        "legs in lanes": (),
        "legs in lanes, libm": ("-DKRHPR_LIBM",),
        "plain C99": ("-DKRHPR_LANES=1",),
    }
    singles = [
        Contender(OURS, workload.key, variant, glue, include_dirs=(str(folder),), extra_flags=flags)
        for variant, flags in options.items()
    ]
    return singles + _batches(workload, robot, folder)


def _batches(workload: Workload, robot: RobotCode, folder: Path) -> list[Contender]:
    """The batch functions: poses side by side, arrays of structures or structures of arrays."""
    if not goes_side_by_side(robot.functions[0]):
        return []
    mode = ["NULL"] if workload.key == "w2" else []
    inputs, outputs = [a.name for a in workload.inputs], [a.name for a in workload.outputs]
    sizes = {array.name: array.size for array in (*workload.inputs, *workload.outputs)}
    symbol = f"krhpr_{robot.identifier}_{workload.key}"
    calls = {
        "aos": (1, f"{symbol}_batch(&geometry, (size_t)n, in, in_step, out, out_step, NULL, 0)"),
        "blocked8": (8, f"{symbol}_soa(&geometry, (size_t)n, 8, in, in_step, out, out_step, NULL)"),
        "soa": (0, f"{symbol}_soa(&geometry, (size_t)n, 0, in, in_step, out, out_step, NULL)"),
    }
    found = []
    for layout, (step, call) in calls.items():
        in_steps = [str(step * sizes[name]) for name in inputs] + ["0"] * len(mode)
        lines = [
            f'#include "krhpr_{robot.identifier}_batch.c"',
            baked(robot),
            workload.batch_prototype(),
            "{",
            f"    const double *const in[] = {{{', '.join(inputs + mode)}}};",
            f"    double *const out[] = {{{', '.join(outputs)}}};",
            f"    const ptrdiff_t in_step[] = {{{', '.join(in_steps)}}};",
            f"    const ptrdiff_t out_step[] = {{{', '.join(str(step * sizes[name]) for name in outputs)}}};",
            f"    {call};",
            "}",
        ]
        found.append(
            Contender(
                OURS,
                workload.key,
                "poses in lanes",
                "\n".join(lines) + "\n",
                sources=(str(folder / f"krhpr_{robot.identifier}.c"),),
                include_dirs=(str(folder),),
                single=False,
                batch_layout=layout,
            )
        )
    return found


def baked(robot: RobotCode) -> str:
    """The prepared geometry as a constant."""
    return baked_geometry(robot, "geometry")


def write_robot(workload: Workload, folder: Path) -> RobotCode:
    """The C of a robot that offers just the workload's function, in a folder."""
    parts = Parts()
    entry = next(entry for entry in catalogue() if entry.identifier == ROBOT[workload.key])
    robot = build(entry, parts)
    if workload.key == "w5":
        sizes_of_leg = {**robot.default_geometry, "l_3": (sizes.HYBRID.l3,) * 3}
        robot = replace(robot, default_geometry=sizes_of_leg)
    robot = replace(robot, functions=(_function(robot, workload.key),), default_mode=MODE_SIGNS)
    folder.mkdir(parents=True, exist_ok=True)
    target = CTarget()
    for file in (*target.shared(), *(f for part in parts for f in target.part(part)), *target.robot(robot)):
        (folder / Path(file.path).name).write_text(file.text)
    return robot


def _function(robot: RobotCode, key: str) -> RobotFunction:
    """The workload as a function of the robot."""
    if key == "w2":
        return replace(robot.function("inverse"), name="w2")
    if key == "w5":
        return replace(robot.function("subleg_jacobian"), name="w5")
    if key == "w3":
        return replace(robot.function("forward_all"), name="w3")
    if key == "w4":
        return _newton_step(robot.function("forward_newton"))
    blocks = robot.function("jacobian_blocks")
    inputs = tuple(port for port in blocks.inputs if port.name != "s")
    forward = Call(Stage.LEG, "subleg", "forward_posture", {}, {})
    rest = tuple(call for call in blocks.calls if call.kernel != "posture")
    return replace(blocks, name="w1", inputs=inputs, calls=(forward, *rest))


def _newton_step(function: RobotFunction) -> RobotFunction:
    """One step where `forward_newton` iterates, and nothing but the pose."""
    calls = tuple(
        call if call.repeat is None else replace(call, repeat=replace(call.repeat, limit=1))
        for call in function.calls
    )
    return replace(function, name="w4", outputs=function.outputs[:2], calls=calls, guards=())


def python_contenders(workload: Workload) -> list[PythonContender] | Missing:
    """The same functions called from Python: generalized ufuncs, the robot's checked methods, pure NumPy."""
    robot = krhpr.load(ROBOT[workload.key], backend="compiled")
    numpy_robot = krhpr.load(ROBOT[workload.key], backend="numpy")
    if workload.key == "w3":
        return [
            PythonContender(OURS, variant, batch=partial(_every_solution, workload, of))
            for variant, of in (("robot's method, checked", robot), ("pure NumPy module", numpy_robot))
        ]
    compiled = _compiled(workload, robot)
    gufunc = compiled.gufunc()
    extra = [np.array(3 * [MODE_SIGNS])] if workload.key == "w2" else []
    outputs = [array.shape for array in workload.outputs]

    def bound(inputs: list[Floats], *, reuse: bool) -> Prepared:
        batch = inputs[0].shape[: inputs[0].ndim - len(workload.inputs[0].shape)]
        arrays = [x.reshape(*batch, *array.shape) for x, array in zip(inputs, workload.inputs, strict=True)]
        out = (*(np.empty((*batch, *shape)) for shape in outputs), np.empty(batch, dtype=np.int32))
        if reuse:
            return Prepared(lambda: gufunc(*arrays, *extra, out=out), _collect)
        return Prepared(lambda: gufunc(*arrays, *extra), _collect)

    def buffers(inputs: list[Floats]) -> Prepared:
        arrays = [np.ascontiguousarray(x) for x in (*inputs, *extra)]
        out = [np.empty(shape) for shape in outputs]
        call = compiled.bound(arrays, out)
        return Prepared(call, lambda status: _collect_all(out))

    def method(inputs: list[Floats], *, of: krhpr.Robot) -> Prepared:
        batch = inputs[0].shape[: inputs[0].ndim - len(workload.inputs[0].shape)]
        arrays = [x.reshape(*batch, *array.shape) for x, array in zip(inputs, workload.inputs, strict=True)]
        if workload.key == "w2":
            return Prepared(lambda: (of.inverse(*arrays, mode=MODE),), _collect_all)

        def two_calls() -> Any:
            p, Q, theta = arrays
            return of.jacobian_blocks(p, Q, of.subleg_forward(theta), theta)

        return Prepared(two_calls, _collect_all)

    def _collect(results: Any) -> list[Floats]:
        return _collect_all(results[:-1])

    def _collect_all(results: Any) -> list[Floats]:
        return [np.reshape(x, (-1, *shape)) for x, shape in zip(results, outputs, strict=True)]

    reused, fresh = partial(bound, reuse=True), partial(bound, reuse=False)
    checked, pure = partial(method, of=robot), partial(method, of=numpy_robot)
    return [
        PythonContender(OURS, "bound to buffers", single=buffers),
        PythonContender(OURS, "gufunc, out=", single=reused, batch=reused),
        PythonContender(OURS, "gufunc, fresh outputs", single=fresh, batch=fresh),
        PythonContender(OURS, "robot's methods, checked", single=checked, batch=checked),
        PythonContender(OURS, "pure NumPy module", single=pure, batch=pure),
    ]


def _every_solution(workload: Workload, robot: krhpr.Robot, inputs: list[Floats]) -> Prepared:
    (s,) = inputs

    def collect(found: Any) -> list[Floats]:
        arrays = (found.count, found.p, found.Q, without_wrap(found.redundant))
        shapes = [array.shape for array in workload.outputs]
        return [np.nan_to_num(x).reshape(-1, *shape) for x, shape in zip(arrays, shapes, strict=True)]

    return Prepared(lambda: robot.forward_all(s), collect)


@dataclass(frozen=True)
class _Compiled:
    """The workload's function, compiled, with the geometry as a run-time argument."""

    function: RobotFunction
    address: int
    geometry: bytes
    library: ctypes.CDLL

    def gufunc(self) -> np.ufunc:
        """As a generalized ufunc."""
        f = self.function
        counts = len(f.inputs), len(f.outputs)
        return make_gufunc(f.name, f.doc, self.address, self.geometry, f.signature, *counts, self.library)

    def bound(self, inputs: list[Floats], outputs: list[Floats]) -> Bound:
        """On buffers."""
        return bind(self.address, self.geometry, tuple(inputs), tuple(outputs), self.library)


def _compiled(workload: Workload, robot: krhpr.Robot) -> _Compiled:
    folder = Path(tempfile.mkdtemp(prefix="krhpr-bench-"))
    atexit.register(shutil.rmtree, folder, ignore_errors=True)
    code = write_robot(workload, folder)
    function = code.functions[0]
    prefix = f"krhpr_{code.identifier}"
    library = load_library(compile_robot(code.identifier, folder))
    size = getattr(library, f"{prefix}_geometry_size")
    size.restype = ctypes.c_size_t
    geometry = ctypes.create_string_buffer(size())
    fields = np.ascontiguousarray(robot.geometry.flat(), dtype=float)
    getattr(library, f"{prefix}_set_geometry")(geometry, fields.ctypes.data_as(ctypes.c_void_p))
    address = function_address(library, f"{prefix}_{function.name}_batch")
    return _Compiled(function, address, bytes(geometry), library)
