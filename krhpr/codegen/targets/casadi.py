"""The CasADi target: modules that build casadi.Function from the same kernels."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

from krhpr.codegen.bake import baked_values, scalars
from krhpr.codegen.composition import Call, RobotFunction, Stage, Variable, variables
from krhpr.codegen.part import Part
from krhpr.codegen.printers.python import CASADI
from krhpr.codegen.robot_code import RobotCode
from krhpr.codegen.targets.base import File, broken, render
from krhpr.codegen.targets.python import link_pairs, part_context


class CasadiTarget:
    """Prints CasADi modules."""

    name = "casadi"

    def shared(self) -> Iterable[File]:
        yield File("casadi/runtime.py", render("casadi/runtime.py.j2"))

    def part(self, part: Part) -> Iterable[File]:
        context = part_context(part, CASADI)
        yield File(f"casadi/{part.name}.py", render("python/part.py.j2", library="casadi as ca", **context))

    def robot(self, robot: RobotCode) -> Iterable[File]:
        assert robot.subleg.geometry is not None and robot.platform.geometry is not None
        fields = [field.name for field in (*robot.subleg.geometry.fields, *robot.platform.geometry.fields)]
        text = render(
            "casadi/robot.py.j2",
            robot=robot,
            link_pairs=link_pairs(robot),
            uses_algebra=any(call.part == "algebra" for f in robot.functions for call in f.calls),
            prepared=_prepared(robot) if robot.baked else {},
            functions=[_function(robot, function) for function in robot.functions if not function.procedure],
            default_geometry=[
                ", ".join(repr(robot.default_geometry[name][leg]) for name in fields)
                for leg in range(robot.legs)
            ],
        )
        yield File(f"casadi/{robot.identifier}.py", text)


def _prepared(robot: RobotCode) -> dict[str, list[str]]:
    """A baked geometry as keyword arguments, for each leg."""
    found: dict[str, list[str]] = {}
    for member, legs in baked_values(robot).items():
        single = scalars(robot.parts[member])
        found[member] = [
            ", ".join(
                f"{name}={numbers[0] if name in single else tuple(numbers)!r}"
                for name, numbers in leg.items()
            )
            for leg in legs
        ]
    return found


def _function(robot: RobotCode, function: RobotFunction) -> dict[str, Any]:
    known = variables(function, robot.parts)
    read = function.read(robot.parts, guards=False)
    read_later = {
        name
        for call in function.stage(Stage.PLATFORM)
        for name in call.reads(robot.parts[call.part].kernel(call.kernel))
    }
    collected = [
        variable.name
        for variable in known.values()
        if variable.kind != "input"
        and variable.per_leg
        and (variable.kind == "output" or variable.name in read_later)
    ]
    return {
        "name": function.name,
        "doc": function.doc,
        "inputs": function.inputs,
        "outputs": function.outputs,
        "collected": collected,
        "uses_geometry": function.uses_geometry(robot.parts),
        "shared_calls": [_call(robot, call, known, read) for call in function.stage(Stage.SHARED)],
        "leg_calls": [_call(robot, call, known, read) for call in function.stage(Stage.LEG)],
        "platform_calls": [_call(robot, call, known, read) for call in function.stage(Stage.PLATFORM)],
    }


def _call(robot: RobotCode, call: Call, known: Mapping[str, Variable], read: set[str]) -> str:
    kernel = robot.parts[call.part].kernel(call.kernel)
    if call.pairs is not None:
        (port,) = kernel.outputs
        points = " + ".join(call.pairs.places)
        arguments = [f"{call.part}.{kernel.name}", points, "LINK_PAIRS"]
        return broken(f"{call.variable_out(port.name)} = rt.of_pairs", arguments, indent=8)
    leg = call.stage is Stage.LEG
    prepared = f'_PREPARED["{call.part}"][i]' if robot.baked else f"{call.part}.prepare(fields)"
    arguments = [prepared] if kernel.geometry is not None else []
    for port in kernel.inputs:
        variable = known[call.variable_in(port.name)]
        if variable.kind == "input":
            arguments.append(f'call.leg("{variable.name}", i)' if leg else f'call.whole("{variable.name}")')
        else:
            arguments.append(f"{variable.name}_i" if leg and variable.per_leg else variable.name)
    suffix = "_i" if leg else ""
    names = [call.variable_out(port.name) for port in kernel.outputs]
    names = [f"{name}{suffix}" if name in read else f"_{name}" for name in names]
    return broken(f"{', '.join(names)} = {call.part}.{kernel.name}", arguments, indent=8)
