"""Passes: each leaves a kernel equal to what it was, and does what it is for."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import pytest
from hypothesis import assume, given

from krhpr.codegen.evaluate import evaluate_kernel, prepare_geometry
from krhpr.codegen.graph import LEAVES, Graph, GraphError, InputRef, Op
from krhpr.codegen.kernel import GEOMETRY_PREFIX, GeometryType, Kernel
from krhpr.codegen.part import optimise
from krhpr.codegen.passes import (
    fold_prepared_constants,
    hoist_reciprocals,
    pair_sine_cosine,
    precompute_parameters,
    remove_dead_code,
)
from krhpr.validation.arithmetic import RATIONAL
from tests.codegen.programs import (
    Program,
    Step,
    field_references,
    geometry_of,
    inputs_of,
    kernel,
    points,
    references,
    steps,
)

PASSES = (hoist_reciprocals, remove_dead_code, pair_sine_cosine)


def random_kernel(program: list[Step], values: list[Any]) -> Kernel:
    result = Program()
    result.leaves(references(), values, RATIONAL)
    result.write(program, RATIONAL)
    return kernel(result.graph, [node for node, _ in result.numbers[-4:]])


def random_pair(
    prepare: list[Step], program: list[Step], fields: list[Any], values: list[Any]
) -> tuple[GeometryType, Kernel, dict[str, Any]]:
    """A geometry and a kernel that reads its fields and its prepared vector."""
    preparing = Program()
    preparing.leaves(field_references(), fields, RATIONAL)
    preparing.write(prepare, RATIONAL)
    geometry = geometry_of(preparing)
    named = {ref.port: value for ref, value in zip(field_references(), fields, strict=True)}
    prepared = prepare_geometry(geometry, named, RATIONAL)
    result = Program()
    own = [(InputRef(f"{GEOMETRY_PREFIX}{name}", 0), value) for name, value in named.items()]
    own += [(InputRef(f"{GEOMETRY_PREFIX}v", i), prepared["v"][i]) for i in range(3)]
    result.leaves([ref for ref, _ in own], [value for _, value in own], RATIONAL)
    result.leaves(references(), values, RATIONAL)
    result.write(program, RATIONAL)
    return geometry, kernel(result.graph, [node for node, _ in result.numbers[-4:]], geometry), named


def computed(
    k: Kernel, values: list[Any], geometry: GeometryType | None = None, fields: Any = None
) -> list[Any]:
    prepared = prepare_geometry(geometry, fields, RATIONAL) if geometry is not None else None
    return evaluate_kernel(k, inputs_of(values), prepared, RATIONAL)["out"]


@pytest.mark.parametrize("step", PASSES)
@given(steps(), points())
def test_a_pass_leaves_a_kernel_equal(step: Any, program: list[Step], values: list[Any]) -> None:
    before = random_kernel(program, values)
    after = step(before)
    assert computed(after, values) == computed(before, values)
    assert after.operations.divide <= before.operations.divide
    assert after.inputs == before.inputs and after.outputs == before.outputs


@given(steps(longest=12), steps(longest=20), points(), points())
def test_precomputation_leaves_kernels_equal(
    prepare: list[Step], program: list[Step], fields: list[Any], values: list[Any]
) -> None:
    geometry, before, named = random_pair(prepare, program, fields, values)
    folded = fold_prepared_constants(geometry, before)
    assert computed(folded, values, geometry, named) == computed(before, values, geometry, named)
    richer, (after,) = precompute_parameters(geometry, [folded])
    assert computed(after, values, richer, named) == computed(before, values, geometry, named)


@given(steps(longest=12), steps(longest=20), points(), points())
def test_all_passes_together(
    prepare: list[Step], program: list[Step], fields: list[Any], values: list[Any]
) -> None:
    geometry, before, named = random_pair(prepare, program, fields, values)
    try:
        part = optimise("random", "", geometry, [before, replace(before, name="twin")])
    except GraphError:
        # hoisting may divide one by what is found to be constant zero: a kernel that has no value anywhere
        assume(False)
    assert part.geometry is not None and part.written == {"random": 0, "twin": 0}
    for name in ("random", "twin"):
        after = part.kernel(name)
        assert computed(after, values, part.geometry, named) == computed(before, values, geometry, named)
        assert_nothing_is_left_to_prepare(after)
        needed = after.graph.needed(after.result_nodes)
        assert all(needed)


def assert_nothing_is_left_to_prepare(k: Kernel) -> None:
    """No operation but a change of sign has operands that depend on the geometry alone."""
    alone = []
    for _, node in k.graph:
        if isinstance(node.value, InputRef):
            alone.append(node.value.port.startswith(GEOMETRY_PREFIX))
        elif node.op is Op.CONST:
            alone.append(True)
        else:
            alone.append(all(alone[argument] for argument in node.args))
            assert not alone[-1] or node.op is Op.NEG


def test_one_division_for_each_denominator() -> None:
    g = Graph()
    x, y, z = (g.input("n", i) for i in range(3))
    length = g.add(g.mul(x, x), g.constant(1))
    before = kernel(g, [g.div(x, length), g.div(y, length), g.div(g.constant(1), length), g.div(y, z)])
    assert before.operations.divide == 4
    after = hoist_reciprocals(before)
    assert after.operations.divide == 2
    assert [node.op for _, node in after.graph].count(Op.DIV) == 2


def test_a_denominator_of_the_geometry_is_prepared() -> None:
    program = Program()
    program.leaves(field_references(), [None] * 6, RATIONAL)
    geometry = geometry_of(program)
    g = Graph()
    length = g.input(f"{GEOMETRY_PREFIX}n0", 0)
    before = kernel(g, [g.div(g.input("n", 0), length)], geometry)
    part = optimise("p", "", geometry, [before])
    assert part.kernel("random").operations.divide == 0
    assert part.geometry is not None and part.geometry.prepare.operations.divide == 1
    assert [port.name for port in part.geometry.prepare.outputs] == ["v", "k"]
    with pytest.raises(KeyError, match="no kernel 'other'"):
        part.kernel("other")


def test_dead_code_is_removed_and_order_kept() -> None:
    g = Graph()
    x, y = g.input("n", 0), g.input("n", 1)
    g.atan2(x, y)
    wanted = g.mul(g.sin(x), y)
    after = remove_dead_code(kernel(g, [wanted]))
    assert [node.op for _, node in after.graph] == [Op.INPUT, Op.INPUT, Op.SIN, Op.MUL]


def test_sine_and_cosine_stand_side_by_side() -> None:
    g = Graph()
    x, y = g.input("a", 0), g.input("a", 1)
    sine = g.sin(x)
    total = g.add(sine, g.cos(y))
    after = pair_sine_cosine(kernel(g, [g.mul(total, g.cos(x)), g.sin(y)]))
    order = [node.op for _, node in after.graph if node.op not in LEAVES]
    assert order[:2] == [Op.SIN, Op.COS] and {*order[2:4]} == {Op.SIN, Op.COS}


def test_prepared_constants_are_folded() -> None:
    program = Program()
    program.leaves(field_references(), [None] * 6, RATIONAL)
    field, zero = program.graph.input("n0", 0), program.graph.constant(0)
    program.numbers += [(field, None), (zero, None), (program.graph.neg(field), None)]
    geometry = geometry_of(program)
    g = Graph()
    v = [g.input(f"{GEOMETRY_PREFIX}v", i) for i in range(3)]
    x = g.input("n", 0)
    before = kernel(g, [g.add(g.mul(v[1], x), g.mul(v[0], x))], geometry)
    after = fold_prepared_constants(geometry, before)
    assert after.operations.total == 1
