"""The printed texts, run on exact numbers, equal the derivation: C, its form for poses, NumPy, CasADi."""

from __future__ import annotations

from typing import Any

import pytest

from krhpr.codegen.composition import RobotFunction
from krhpr.validation.arithmetic import BALLS, RATIONAL
from krhpr.validation.check import Target
from krhpr.validation.draw import Draw
from krhpr.validation.numbers import BALL, EXACT, Ball, Exact, ball_precision
from krhpr.validation.plan import has_roots
from krhpr.validation.printed import PRINTED
from krhpr.validation.subject import Subject
from tests.grasping.exact import subject
from tests.grasping.support import ROBOTS

TARGETS = (Target.C, Target.NUMPY, Target.CASADI)
FUNCTIONS = [
    pytest.param(name, function.name, id=f"{name}.{function.name}")
    for name in ROBOTS
    for function in subject(name).code.functions
]


def is_rational(one: Subject, function: RobotFunction) -> bool:
    kernels = (one.code.parts[call.part].kernel(call.kernel) for call in function.calls)
    return not any(has_roots(kernel) for kernel in kernels)


def reachable(one: Subject, draw: Draw) -> dict[str, list[Any]]:
    """Links and jaws so long that everything can be assembled."""
    geometry = draw.geometry(*one.geometry_types.values(), legs=2)
    for name in ("x_1", "x_2"):
        side = -1 if name == "x_1" else 1
        geometry[name] = [side * draw.rational(0.5, 1.0) for _ in range(2)]
    for name in ("l_1", "l_2"):
        if name in geometry:
            geometry[name] = [draw.rational(3.0, 3.1) for _ in range(2)]
    geometry["l_j"] = [draw.rational(7.0, 7.1) for _ in range(2)]
    return geometry


def inputs_of(one: Subject, function: RobotFunction, draw: Draw) -> dict[str, list[Any]]:
    found = draw.inputs(one.code, function)
    if (
        "theta" in found
        and function.name.startswith(("forward", "subleg_forward"))
        and "RPR" in one.code.notation
    ):
        found["theta"] = [draw.rational(3.0, 3.1) for _ in range(4)]
    if "side" in found:
        found["side"] = [Exact(draw.sign())]
    if function.name == "grasp":  # so that both jaws press, whatever else they do
        found["weight"] = [x / 1000 for x in found["weight"]]
        found["sensor"] = [Exact(0), Exact(0), Exact(1), Exact(0)]
        found["measured_force"] = [Exact(3)]
    return found


def pressing(one: Subject, function: RobotFunction, draw: Draw) -> tuple[dict[str, Any], dict[str, Any]]:
    """Arguments for which there is an answer."""
    for _ in range(200):
        geometry = reachable(one, draw)
        inputs = inputs_of(one, function, draw)
        if function.name == "inverse_status" or not function.name.startswith(("grasp", "inverse")):
            return geometry, inputs
        if "pivot" in inputs:  # jaws are longer than links: keep P and S within reach
            geometry["l_j"] = [draw.rational(0.2, 0.3) for _ in range(2)]
        if function.name != "grasp":
            return geometry, inputs
        found = one.function(function, inputs, geometry, RATIONAL)
        if min(*found["contact_forces"][::2], *found["widths"]) > 0:
            return geometry, inputs
    raise AssertionError("no draw holds an object")


def as_balls(values: dict[str, list[Any]], draw: Draw) -> dict[str, list[Any]]:
    """Numbers with enclosures; angles become any numbers."""
    return {
        name: [Ball(value if isinstance(value, Exact) else draw.rational(-3.0, 3.0)) for value in row]
        for name, row in values.items()
    }


@pytest.mark.parametrize(("name", "function"), FUNCTIONS)
def test_texts(name: str, function: str) -> None:
    one = subject(name)
    wanted_function = one.code.function(function)
    exact = is_rational(one, wanted_function)
    draw = Draw(7)
    with ball_precision():
        for _ in range(2):
            geometry, inputs = pressing(one, wanted_function, draw)
            if not exact:
                geometry, inputs = as_balls(geometry, draw), as_balls(inputs, draw)
            wanted = one.function(wanted_function, inputs, geometry, RATIONAL if exact else BALLS)
            for target in TARGETS:
                for run in PRINTED[target]:
                    got = run(one, wanted_function, inputs, geometry, EXACT if exact else BALL)
                    if got is None:
                        continue
                    for port in wanted_function.outputs:
                        for a, b in zip(got[port.name], wanted[port.name], strict=True):
                            assert same(a, b), f"{target}: {port.name}: {a!r} is not {b!r}"


def same(a: Any, b: Any) -> bool:
    if isinstance(a, Ball) or isinstance(b, Ball):
        return bool(abs((Ball(a) - Ball(b)).enclosure) < 1e-60)
    return bool(a == b)
