"""The NumPy target: modules of components that need nothing but NumPy."""

from __future__ import annotations

import textwrap
from collections.abc import Iterable, Mapping
from typing import Any

from krhpr.codegen.bake import baked_values, scalars
from krhpr.codegen.composition import (
    Call,
    EachPair,
    EachRoot,
    Guard,
    Relation,
    Repeat,
    RobotFunction,
    Stage,
    Variable,
    variables,
)
from krhpr.codegen.graph import InputRef, Op
from krhpr.codegen.kernel import LEGS, Kernel, Port
from krhpr.codegen.part import Part
from krhpr.codegen.printers.infix import Body, Line
from krhpr.codegen.printers.python import NUMPY, component, print_kernel
from krhpr.codegen.robot_code import RobotCode
from krhpr.codegen.status import LEG_STATUSES, STATUS_DOC, Status
from krhpr.codegen.targets.base import File, broken, kernel_comment, port_text, render
from krhpr.codegen.targets.python_limits import python_limits
from krhpr.defaults import NUMBERS, SIGNS


class PythonTarget:
    """Prints NumPy modules."""

    name = "python"

    def shared(self) -> Iterable[File]:
        statuses = [(status.name, status.value, STATUS_DOC[status]) for status in Status]
        yield File("python/roots.py", render("python/roots.py.j2"))
        yield File("python/runtime.py", render("python/runtime.py.j2", statuses=statuses))

    def part(self, part: Part) -> Iterable[File]:
        context = part_context(part, NUMPY)
        yield File(f"python/{part.name}.py", render("python/part.py.j2", library="numpy as np", **context))

    def robot(self, robot: RobotCode) -> Iterable[File]:
        functions = [_function(robot, function) for function in robot.functions]
        default_mode = label_of(robot.default_mode, robot.mode_signs, robot.mode_labels)
        default_assembly = label_of(robot.default_assembly, robot.assembly_signs, robot.assembly_labels)
        text = render(
            "python/robot.py.j2",
            robot=robot,
            usual=robot.legs == LEGS,
            imports=_imports(robot),
            functions=functions,
            exported=sorted([*_constants(robot), "Geometry", "Status", *(f["name"] for f in functions)]),
            prepared=_prepared(robot) if robot.baked else {},
            link_pairs=link_pairs(robot),
            limits=python_limits(robot.limits) if robot.limits else "",
            default_mode=default_mode,
            default_assembly=default_assembly,
        )
        yield File(f"python/{robot.identifier}.py", text)


def _imports(robot: RobotCode) -> set[str]:
    """Which of NumPy and the algebra a robot's module needs."""
    algebra = any(call.part == "algebra" for function in robot.functions for call in function.calls)
    numpy = robot.baked or any(not function.calls for function in robot.functions)
    return {name for name, needed in (("algebra", algebra), ("numpy", numpy)) if needed}


def _constants(robot: RobotCode) -> list[str]:
    """Names of the module's constants that users read."""
    return ["GEOMETRY" if robot.baked else "DEFAULT_GEOMETRY", *(["LIMITS"] if robot.limits else [])]


def link_pairs(robot: RobotCode) -> list[str]:
    """The ends of every pair of links that a function is called for, in lines."""
    for function in robot.functions:
        for call in function.calls:
            if call.pairs is not None:
                return textwrap.wrap(
                    ", ".join(f"({', '.join(map(str, ends))})" for ends in call.pairs.ends), 100
                )
    return []


def _prepared(robot: RobotCode) -> dict[str, list[tuple[str, str]]]:
    """A baked geometry as literals: for each value, or component of a vector, those of the three legs."""
    found = {}
    for member, legs in baked_values(robot).items():
        single = scalars(robot.parts[member])
        rows = []
        for name in legs[0]:
            components = [repr(values) for values in zip(*(leg[name] for leg in legs), strict=True)]
            text = (
                components[0] if name in single else "(" + "".join(f"{text}, " for text in components) + ")"
            )
            rows.append((name, text))
        found[member] = rows
    return found


def label_of(signs: tuple[float, ...], all_signs: Iterable[tuple[int, ...]], labels: Iterable[str]) -> str:
    """The label of a branch."""
    return next(label for label, entry in zip(labels, all_signs, strict=True) if tuple(entry) == tuple(signs))


def part_context(part: Part, functions: Mapping[Op, str]) -> dict[str, Any]:
    """A part as the template `part.py.j2` sees it."""
    prepare = None
    if part.geometry is not None:
        body = print_kernel(part.geometry.prepare, functions)
        prepare = {
            "inputs_used": sorted({ref.port for ref in body.inputs_used}),
            "lines": _lines(body),
            "results": list(body.results.items()),
        }
    return {
        "part": part,
        "prepare": prepare,
        "kernels": [_kernel(kernel, functions) for kernel in part.kernels],
    }


def _lines(body: Body) -> list[tuple[str, str, str]]:
    """Assignments with their remarks; these dialects have no pairs."""
    return [(line.name, line.expression, line.note) for line in body.lines if isinstance(line, Line)]


def _kernel(kernel: Kernel, functions: Mapping[Op, str]) -> dict[str, Any]:
    body = print_kernel(kernel, functions)
    parameters = ["g: Any"] if kernel.geometry is not None else []
    unpack = []
    for port in kernel.inputs:
        parameters.append(f"{port.name}: Any")
        used = [InputRef(port.name, index) in body.inputs_used for index in range(port.size)]
        if any(used):
            names = [component(port.name, index, port.shape) for index in range(port.size)]
            names = [name if read else f"_{name}" for name, read in zip(names, used, strict=True)]
            unpack.append((", ".join(names) + ("," if len(names) == 1 else ""), port.name))
    return {
        "name": kernel.name,
        "comment": kernel_comment(kernel),
        "parameters": parameters,
        "unpack": unpack,
        "lines": _lines(body),
        "results": list(body.results.items()),
    }


def _function(robot: RobotCode, function: RobotFunction) -> dict[str, Any]:
    known = variables(function, robot.parts) if function.calls else {}
    read = function.read(robot.parts, guards=True)
    per_leg = {"mode": "MODES[DEFAULT_MODE]", "assembly": "ASSEMBLIES[DEFAULT_ASSEMBLY]", "swivel": "0.0"}
    optional = {name: f"({value},) * {robot.legs}" for name, value in per_leg.items()} | {
        "box": "DEFAULT_BOX"
    }
    optional |= dict.fromkeys(SIGNS, "1.0")
    optional |= {name: repr(value[0] if len(value) == 1 else value) for name, value in NUMBERS.items()}
    present = [port.name for port in function.inputs if port.name in optional]
    return {
        "name": function.name,
        "class_name": "".join(word.capitalize() for word in function.name.split("_")),
        "doc": function.doc,
        "equations": function.equations,
        "inputs": function.inputs,
        "outputs": function.outputs,
        "gufunc": function.signature,
        "parameters": [
            f"{port.name}: Any" + (" = None" if port.name in optional else "") for port in function.inputs
        ],
        "names": [port.name for port in function.inputs],
        "names_of_all": [port.name for port in function.inputs if port.name != "theta_near"],
        "optional": [(name, optional[name]) for name in present],
        "nearest": function.chooses,
        "steps": _steps(robot, function),
        "uses_geometry": function.uses_geometry(robot.parts),
        "input_docs": [python_port(port) + _default_remark(port.name, optional) for port in function.inputs],
        "output_docs": [python_port(port) for port in function.outputs],
        "calls": [_call(robot, call, known, read) for call in function.calls],
        "guards": [_guard(guard, known, function) for guard in function.guards],
    }


def _steps(robot: RobotCode, function: RobotFunction) -> list[str]:
    """Calls of other functions, each with its results and its status."""
    wanted = {port.name for port in function.outputs}
    wanted |= {
        step.variable_in(port.name)
        for step in function.steps
        for port in robot.function(step.function).inputs
    }
    calls = []
    for step in function.steps:
        called = robot.function(step.function)
        names = [port.name if port.name in wanted else f"_{port.name}" for port in called.outputs]
        results = f"({', '.join(names)})" if len(names) > 1 else names[0]
        arguments = [step.variable_in(port.name) for port in called.inputs]
        arguments += ([] if robot.baked else ["geometry=geometry"]) + ["status=True"]
        calls.append(broken(f"{results}, here = {called.name}", arguments, indent=4))
    return calls


def _default_remark(name: str, optional: Mapping[str, str]) -> str:
    """What an argument is where it is not given."""
    if name in SIGNS:
        return "; +1 unless given"
    if name in NUMBERS:
        return f"; {optional[name]} unless given"
    return ", the default unless given" if name in optional else ""


def python_port(port: Port) -> str:
    """`theta (..., 3, 3) [rad]: actuated joints`."""
    text = port_text(port, full=True)
    head, _, tail = text.partition(": ")
    name = head.split(" ")[0]
    shape = ", ".join(["...", *map(str, port.full_shape)])
    unit = f" [{port.unit}]" if port.unit != "1" else ""
    frame = f" in the {port.frame} frame" if port.frame in ("base", "platform") else ""
    return f"{name} ({shape}){unit}{frame}: {tail}"


def _call(robot: RobotCode, call: Call, known: Mapping[str, Variable], read: set[str]) -> str:
    kernel = robot.parts[call.part].kernel(call.kernel)
    if call.pairs is not None:
        return _of_pairs(call, call.pairs, kernel, known, robot.legs)
    arguments = [f"g.{call.part}"] if kernel.geometry is not None else []
    for port in kernel.inputs:
        if call.each is not None and port.name == call.each.root:
            arguments.append("root")
        else:
            arguments.append(_argument(known[call.variable_in(port.name)], call.stage, robot.legs))
    names = [call.variable_out(port.name) for port in kernel.outputs]
    names = [name if name in read else f"_{name}" for name in names]
    if call.each is not None:
        return _at_roots(call, call.each, kernel, arguments, names)
    if call.repeat is not None:
        return _iteration(call, call.repeat, kernel, arguments, names)
    return broken(f"{', '.join(names)} = {call.part}.{kernel.name}", arguments, indent=8)


def _iteration(call: Call, repeat: Repeat, kernel: Kernel, arguments: list[str], names: list[str]) -> str:
    """A bounded iteration: the runtime's loop around the kernel."""
    ports = [port.name for port in kernel.outputs]
    if ports != [repeat.after, repeat.change]:
        raise ValueError(f"{call.part}.{kernel.name} gives {ports}, not {[repeat.after, repeat.change]}")
    place = [port.name for port in kernel.inputs].index(repeat.before) + (kernel.geometry is not None)
    start, inside = arguments[place], [*arguments[:place], "at", *arguments[place + 1 :]]
    step = f"lambda at: {call.part}.{kernel.name}({', '.join(inside)})"
    return broken(
        f"{', '.join(names)} = rt.repeat", [step, start, repr(repeat.tolerance), str(repeat.limit)], indent=8
    )


def _of_pairs(call: Call, pairs: EachPair, kernel: Kernel, known: Mapping[str, Variable], legs: int) -> str:
    """The kernel for every pair of links, by the runtime."""
    (port,) = kernel.outputs
    points = " + ".join(_argument(known[name], Stage.PLATFORM, legs) for name in pairs.places)
    return broken(
        f"{call.variable_out(port.name)} = rt.of_pairs",
        [f"{call.part}.{kernel.name}", points, "LINK_PAIRS", "arguments.batch"],
        indent=8,
    )


def _at_roots(call: Call, each: EachRoot, kernel: Kernel, arguments: list[str], names: list[str]) -> str:
    """The kernel at every root of a polynomial, by the runtime."""
    ports = [port.name for port in kernel.outputs]
    if ports[-1] != each.miss:
        raise ValueError(f"{call.part}.{kernel.name}: its last output is {ports[-1]}, not {each.miss}")
    names = [*names[:-1], *each.numbers, *(name for name, _ in each.locals)]
    step = f"lambda root: {call.part}.{kernel.name}({', '.join(arguments)})"
    rest = [each.polynomial, repr(each.error), repr(each.tolerance)]
    if each.only is None:
        return broken(
            f"{', '.join(names)} = rt.at_roots", [step, *rest, str(ports.index(each.order))], indent=8
        )
    only = each.only
    rest += [str(ports.index(only.angles)), f'arguments.whole("{only.box}")', only.certificate]
    return broken(f"{', '.join(names)} = rt.only_root", [step, *rest], indent=8)


def _argument(variable: Variable, stage: Stage, legs: int) -> str:
    if variable.kind == "input":
        return f'arguments.{"leg" if stage is Stage.LEG else "whole"}("{variable.name}")'
    if stage is Stage.PLATFORM and variable.per_leg:
        return f"rt.legs({variable.name})" if legs == LEGS else f"rt.legs({variable.name}, {legs})"
    return variable.name


def _guard(guard: Guard, known: Mapping[str, Variable], function: RobotFunction) -> str:
    at_least = guard.relation is Relation.AT_LEAST
    per_leg = known[guard.variable].per_leg and guard.status in LEG_STATUSES
    value, status = f"{guard.variable}[{guard.index}]", f"Status.{guard.status.name}"
    spoilt = "(" + "".join(f'"{port.name}", ' for port in guard.spoilt(function.outputs)) + ")"
    empties = "(" + "".join(f'"{name}", ' for name in guard.empties) + ")"
    texts = [value, str(at_least), repr(guard.limit), status, str(per_leg), spoilt]
    return ", ".join([*texts, *([empties] if guard.empties else [])])
