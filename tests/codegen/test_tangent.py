"""Tangent twins: their derivatives, to many digits; what they compute once; the structure of Jacobians."""

from __future__ import annotations

from typing import Any

import mpmath
import pytest

from krhpr.codegen.composition import Stage
from krhpr.codegen.evaluate import Arithmetic, evaluate_function, evaluate_kernel, prepare_geometry
from krhpr.codegen.graph import LEAVES, InputRef, Op
from krhpr.codegen.kernel import Kernel, Unit
from krhpr.codegen.part import Part
from krhpr.codegen.pipeline import Derived
from krhpr.codegen.tangent import (
    BRANCHES,
    SUFFIX,
    is_tangent,
    tangent_function,
    tangent_twin,
)
from tests.support import derived_robots

mp = mpmath.MPContext()
mp.dps = 60
STEP = mp.mpf(10) ** -20


class OutOfReach(Exception):
    """A radicand is negative: other numbers have to be tried."""


def root(x: Any) -> Any:
    if x < 0:
        raise OutOfReach
    return mp.sqrt(x)


DIGITS = Arithmetic(
    lambda value: mp.mpf(value.numerator) / value.denominator,
    {
        Op.SQRT: root,
        Op.SIN: mp.sin,
        Op.COS: mp.cos,
        Op.ATAN2: mp.atan2,
        Op.ABS: abs,
        Op.MIN: min,
        Op.MAX: max,
    },
)


@pytest.fixture(scope="module")
def derived() -> Derived:
    return derived_robots()


def pytest_generate_tests(metafunc: pytest.Metafunc) -> None:
    if "name" in metafunc.fixturenames:
        names = [f"{part.name}.{kernel.name}" for part in derived_robots().parts for kernel in part.kernels]
        metafunc.parametrize("name", names)


@pytest.fixture
def part(name: str, derived: Derived) -> Part:
    return next(part for part in derived.parts if name.startswith(f"{part.name}."))


@pytest.fixture
def kernel(name: str, part: Part) -> Kernel:
    return part.kernel(name.split(".")[1])


def numbers(count: int, seed: int) -> list[Any]:
    """Numbers between 0.2 and 0.7 without a pattern."""
    return [mp.mpf("0.2") + mp.frac(mp.sqrt(7 * k + seed)) / 2 for k in range(1, count + 1)]


def geometry_of(part: Part, seed: int = 3) -> dict[str, list[Any]] | None:
    if part.geometry is None:
        return None
    lengths = numbers(len(part.geometry.fields), seed)
    # angles apart from one another, so that points at them are
    fields = {
        field.name: value + (place if field.unit is Unit.RADIAN else 0)
        for place, (field, value) in enumerate(zip(part.geometry.fields, lengths, strict=True))
    }
    return prepare_geometry(part.geometry, fields, DIGITS)


def in_reach(part: Part, kernel: Kernel) -> tuple[dict[str, list[Any]] | None, dict[str, list[Any]]]:
    """A geometry and inputs for which the kernel has real values."""
    for seed in range(2000):
        geometry = geometry_of(part, seed)
        # none of the geometry's numbers: points on one another have no distance that changes
        at = {port.name: numbers(port.size, seed + number) for number, port in enumerate(kernel.inputs, 1)}
        for name in BRANCHES:
            if name in at:
                at[name] = [mp.mpf(1)] * len(at[name])
        try:
            evaluate_kernel(kernel, at, geometry, DIGITS)
        except OutOfReach:
            continue
        return geometry, at
    raise AssertionError(f"{kernel.name} has no real values")


def test_twins_give_values_and_derivatives(part: Part, kernel: Kernel) -> None:
    """Against central differences with 60 digits and a step of 1e-20."""
    twin = tangent_twin(kernel)
    if twin is None:
        assert not kernel.smooth_outputs
        return
    geometry, at = in_reach(part, kernel)
    along = {name: [x - mp.mpf("0.4") for x in numbers(len(values), 50)] for name, values in at.items()}
    for name in BRANCHES:
        if name in at:
            along[name] = [mp.mpf(0)] * len(at[name])
    given = {**at, **{name + SUFFIX: rates for name, rates in along.items() if name not in BRANCHES}}
    found = evaluate_kernel(twin, given, geometry, DIGITS)

    def moved(step: Any) -> dict[str, list[Any]]:
        place = {
            name: [x + step * rate for x, rate in zip(values, along[name], strict=True)]
            for name, values in at.items()
        }
        return evaluate_kernel(kernel, place, geometry, DIGITS)

    here, above, below = moved(0), moved(STEP), moved(-STEP)
    for port in kernel.smooth_outputs:
        for j in range(port.size):
            assert mp.almosteq(found[port.name][j], here[port.name][j], mp.mpf(10) ** -50)
            slope = (above[port.name][j] - below[port.name][j]) / (2 * STEP)
            difference = abs(found[port.name + SUFFIX][j] - slope)
            assert difference <= mp.mpf(10) ** -25 * (1 + abs(slope)), f"{port.name}[{j}]"


def test_values_come_first_and_have_names_where_tangents_read_them(kernel: Kernel) -> None:
    """So that a printed twin has one loop, and in it only what changes from direction to direction."""
    twin = tangent_twin(kernel)
    if twin is None:
        return
    varying: list[bool] = []
    for _, node in twin.graph:
        own = isinstance(node.value, InputRef) and is_tangent(node.value)
        varying.append(own or any(varying[a] for a in node.args))
    assert varying == sorted(varying)
    for index, node in twin.graph:
        if varying[index]:
            assert node.op in LEAVES | {Op.ADD, Op.SUB, Op.MUL, Op.NEG}, "linear, and without divisions"
            assert node.op is not Op.MUL or sum(varying[a] for a in node.args) == 1
            for argument in node.args:
                leaf = twin.graph.nodes[argument].op in LEAVES
                assert varying[argument] or leaf or argument in twin.graph.names


def test_what_only_guards_has_no_derivative(derived: Derived) -> None:
    """A function that gives a largest or an absolute value has no Jacobian; guards of others are left out."""
    for robot in derived.robots:
        for function in robot.functions:
            tangent = tangent_function(function, robot.parts) if not function.procedure else None
            status = function.name == "inverse_status"
            side = any(port.name == "s_near" for port in function.inputs)  # of a plane, by an absolute value
            if function.procedure or robot.subleg.name == "subleg_planar_rp":  # its reach has no kink
                continue
            one_of_two = function.name == "forward_encoders_1"  # the better one, by absolute values
            if status or side or one_of_two or function.name in ("rotation_error", "indices", "clearances"):
                assert tangent is None
            elif tangent is None:  # M is constant
                assert function.name == "subleg_jacobian", (robot.identifier, function.name)
                assert robot.subleg.name in ("subleg_tripteron", "subleg_planar_pp")
            else:
                assert tangent is not None and all(call in function.calls for call in tangent.calls)
    robot = derived.robots[0]
    kernel = robot.subleg.kernel("rates")
    assert [port.name for port in kernel.outputs] != [port.name for port in kernel.smooth_outputs]


def test_structure_holds_every_dependence(derived: Derived) -> None:
    """An input that changes an output is in the structure; a leg's results do not depend on other legs."""
    robot = derived.robots[0]
    parts = robot.parts
    geometries = {
        name: [geometry_of(part, 5 * leg) for leg in range(3)]
        for name, part in parts.items()
        if part.geometry is not None
    }
    for function in robot.functions:
        tangent = tangent_function(function, parts) if not function.procedure else None
        if tangent is None:
            continue

        def evaluate(inputs: dict[str, list[Any]], function: Any = function) -> dict[str, list[Any]]:
            kernel_of = lambda part, name: parts[part].kernel(name)  # noqa: E731
            return evaluate_function(function, kernel_of, geometries, inputs, DIGITS)

        if any(port.name in BRANCHES for port in function.inputs) or "inverse" in function.name:
            continue  # out of reach for most numbers
        at = {p.name: numbers(p.full_size, number) for number, p in enumerate(function.inputs)}
        before = evaluate(at)
        for port in function.inputs:
            for j in range(port.full_size):
                changed = {**at, port.name: [x + STEP * (k == j) for k, x in enumerate(at[port.name])]}
                after = evaluate(changed)
                for output in function.outputs:
                    if output.layout == "block diagonal":
                        continue  # there elements are numbered block by block
                    rows = [
                        row
                        for row, (a, b) in enumerate(
                            zip(before[output.name], after[output.name], strict=True)
                        )
                        if abs(a - b) > STEP * mp.mpf(10) ** -20
                    ]
                    allowed = {
                        row for row, column in tangent.structure[output.name, port.name] if column == j
                    }
                    assert set(rows) <= allowed
        if function.name == "joint_rates":
            assert {(r // 3 == c // 3) for r, c in tangent.structure["theta_dot", "s"]} == {True}
            assert any(call.stage is Stage.LEG for call in tangent.calls)
