"""The C99 target: one header per part with its kernels, one header and source per robot."""

from __future__ import annotations

from collections.abc import Iterable

from krhpr.codegen.bake import baked_geometry
from krhpr.codegen.kernel import PLACES
from krhpr.codegen.part import Part
from krhpr.codegen.robot_code import RobotCode
from krhpr.codegen.status import STATUS_DOC, Status
from krhpr.codegen.targets.base import File, render
from krhpr.codegen.targets.c_batch import PARAMETERS, SOA_PARAMETERS, batch_view, goes_side_by_side
from krhpr.codegen.targets.c_defaults import default_constants
from krhpr.codegen.targets.c_functions import function_view, prototype
from krhpr.codegen.targets.c_kernels import (
    default_rows,
    field_count,
    field_names,
    geometry_view,
    kernel_view,
    positive_fields,
    prepare_view,
)
from krhpr.codegen.targets.c_limits import limits_view
from krhpr.codegen.targets.c_numbers import LANES, NUMBER
from krhpr.codegen.targets.c_sequence import sequence_view


class CTarget:
    """Prints C99."""

    name = "c"

    def shared(self) -> Iterable[File]:
        statuses = [(status.name, status.value, STATUS_DOC[status]) for status in Status]
        yield File("c/krhpr_lanes.h", render("c/krhpr_lanes.h.j2"))
        yield File("c/krhpr_poses.h", render("c/krhpr_poses.h.j2"))
        yield File("c/krhpr_elementary.h", render("c/krhpr_elementary.h.j2", number=NUMBER, lanes=LANES))
        yield File("c/krhpr_roots.h", render("c/krhpr_roots.h.j2"))
        yield File("c/krhpr.h", render("c/krhpr.h.j2", statuses=statuses))

    def part(self, part: Part) -> Iterable[File]:
        printed = [
            phase
            for kernel in part.kernels
            for phase in (part.phases[kernel.name].angles, part.phases[kernel.name].body)
            if phase is not None
        ]
        prepare = None
        if part.geometry is not None:
            prepare = prepare_view(part.name, part.geometry.prepare)
        yield File(
            f"c/krhpr_{part.name}.h",
            render(
                "c/part.h.j2",
                part=part,
                kernels=[kernel_view(part.name, kernel) for kernel in printed],
                prepare=prepare,
                geometry=geometry_view(part.geometry),
            ),
        )
        lanes = [kernel_view(part.name, kernel, LANES) for kernel in printed]
        yield File(f"c/krhpr_{part.name}_lanes.h", render("c/lanes.h.j2", part=part, kernels=lanes))

    def robot(self, robot: RobotCode) -> Iterable[File]:
        functions = [function_view(robot, function) for function in robot.functions if function.calls]
        near = next((function for function in robot.functions if function.name == "inverse_near"), None)
        context = {
            "robot": robot,
            "functions": functions,
            "near": near,
            "sequences": [sequence_view(robot, function) for function in robot.functions if function.steps],
            "batches": [batch_view(robot, function) for function in robot.functions],
            "subleg_fields": field_names(robot.subleg),
            "platform_fields": field_names(robot.platform),
            "positive": positive_fields(robot),
            "default_geometry": default_rows(robot),
            "prototypes": [prototype(robot, function) for function in robot.functions],
            "legs": robot.legs,
            "spare": range(PLACES - robot.legs, 0, -1),
            "geometry": [] if robot.baked else [f"const krhpr_{robot.identifier}_geometry *g"],
            "baked": baked_geometry(robot, "geometry") if robot.baked else "",
            "limits": limits_view(robot.limits) if robot.limits else None,
            "set_geometry": [
                f"krhpr_{robot.identifier}_geometry *g",
                f"const double fields[{field_count(robot)}]",
            ],
            "batch_parameters": PARAMETERS,
            "soa_parameters": SOA_PARAMETERS,
            "defaults": default_constants(robot, [f for f in robot.functions if not f.steps]),
            "batch_defaults": default_constants(robot, filter(goes_side_by_side, robot.functions)),
        }
        yield File(f"c/krhpr_{robot.identifier}.h", render("c/robot.h.j2", **context))
        yield File(f"c/krhpr_{robot.identifier}.c", render("c/robot.c.j2", **context))
        yield File(f"c/krhpr_{robot.identifier}_batch.c", render("c/robot_batch.c.j2", **context))
