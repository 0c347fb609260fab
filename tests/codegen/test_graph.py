"""Expression graphs: simplifications are exact, nothing stands twice, structure is what it says."""

from __future__ import annotations

import math
from fractions import Fraction
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from krhpr.codegen.evaluate import FLOAT, Arithmetic, evaluate_kernel
from krhpr.codegen.graph import (
    Graph,
    GraphError,
    InputRef,
    Name,
    Node,
    Op,
    OperationCount,
    count_operations,
)
from krhpr.validation.arithmetic import RATIONAL
from tests.codegen.programs import SMOOTH, Program, Step, inputs_of, kernel, points, references, steps


def written(program: list[Step], values: list[Any], arithmetic: Arithmetic = RATIONAL) -> Program:
    result = Program()
    result.leaves(references(), values, arithmetic)
    result.write(program, arithmetic)
    return result


def evaluated(graph: Graph, values: list[Any], arithmetic: Arithmetic = RATIONAL) -> list[Any]:
    """The value of every node."""
    whole = kernel(graph, range(len(graph)))
    return evaluate_kernel(whole, inputs_of(values), None, arithmetic)["out"]


@given(steps(), points())
def test_simplifications_are_exact(program: list[Step], values: list[Any]) -> None:
    result = written(program, values)
    found = evaluated(result.graph, values)
    for node, value in result.numbers:
        assert found[node] == value
    for node, value in result.angles:
        assert value.congruent(found[node])


_FLOATS = st.floats(-8, 8).map(lambda x: round(x * 64) / 64 + 0.1)


@given(steps(), st.lists(_FLOATS, min_size=6, max_size=6))
def test_simplifications_do_not_change_doubles(program: list[Step], values: list[float]) -> None:
    """Bit for bit, but for the sign of zero and for constants, which are folded without rounding."""
    exact = [step for step in program if step[0] is not Op.DIV]
    result = Program()
    for ref, value in zip(references(), values, strict=True):
        pool = result.angles if ref.port == "a" else result.numbers
        pool.append((result.graph.input(ref.port, ref.index), value))
    for constant in (Fraction(0), Fraction(1), Fraction(-1), Fraction(2)):
        result.numbers.append((result.graph.constant(constant), float(constant)))
    result.write(exact, FLOAT)
    found = evaluated(result.graph, values, FLOAT)
    for node, value in result.numbers:
        if math.isfinite(value):
            assert found[node] == value


@given(steps(), points())
def test_nothing_stands_twice_and_operands_come_first(program: list[Step], values: list[Any]) -> None:
    graph = written(program, values).graph
    assert len(set(graph.nodes)) == len(graph)
    for index, node in graph:
        assert all(argument < index for argument in node.args)
        if node.op is Op.NEG:
            assert graph.nodes[node.args[0]].op not in (Op.NEG, Op.SUB, Op.CONST)
        if node.op in (Op.ADD, Op.SUB, Op.MUL, Op.DIV):
            assert not all(graph.nodes[argument].op is Op.CONST for argument in node.args)
    before = len(graph)
    for node in list(graph.nodes):
        graph.replay(node, range(len(graph)))
    assert len(graph) == before


@given(steps(), points())
def test_a_copy_computes_the_same(program: list[Step], values: list[Any]) -> None:
    source = written(program, values)
    target = Graph()
    target.input("something", 7)
    place = source.graph.copy_into(target, {})
    found, again = evaluated(source.graph, values), None
    bound = {ref: target.input(ref.port, ref.index) for ref in references()}
    again = source.graph.copy_into(target, bound)
    assert again == place
    renamed = Graph()
    swapped = {InputRef("n", 0): renamed.input("n", 1), InputRef("n", 1): renamed.input("n", 0)}
    try:
        moved = source.graph.copy_into(renamed, swapped)
        exchanged = [values[1], values[0], *values[2:]]
        there = evaluated(renamed, exchanged)
    except (ZeroDivisionError, GraphError):
        return
    for index in range(len(source.graph)):
        if source.graph.nodes[index].op is not Op.SIN and not hasattr(found[index], "congruent"):
            assert there[moved[index]] == found[index]


@given(steps(SMOOTH), points())
def test_needed_is_what_outputs_depend_on(program: list[Step], values: list[Any]) -> None:
    result = written(program, values)
    graph, output = result.graph, result.numbers[-1][0]
    needed = graph.needed([output])
    assert needed[output]
    reached, waiting = set(), [output]
    while waiting:
        index = waiting.pop()
        if index not in reached:
            reached.add(index)
            waiting += graph.nodes[index].args
    assert reached == {index for index, wanted in enumerate(needed) if wanted}


def test_identities() -> None:
    g = Graph()
    x, y = g.input("n", 0), g.input("n", 1)
    zero, one, two = g.constant(0), g.constant(1), g.constant(2)
    assert g.add(x, zero) == g.add(zero, x) == g.mul(one, x) == g.neg(g.neg(x)) == g.sub(x, zero) == x
    assert g.sub(x, x) == g.mul(zero, x) == g.div(zero, x) == g.sin(zero) == zero
    assert g.add(x, y) == g.add(y, x) and g.mul(x, y) == g.mul(y, x)
    assert g.neg(g.sub(x, y)) == g.sub(y, x)
    assert g.add(x, g.neg(y)) == g.sub(x, y) and g.sub(x, g.neg(y)) == g.add(x, y)
    assert g.mul(g.neg(x), g.neg(y)) == g.mul(x, y) and g.mul(g.neg(x), y) == g.neg(g.mul(x, y))
    assert g.sin(g.neg(x)) == g.neg(g.sin(x)) and g.cos(g.neg(x)) == g.cos(x) and g.cos(zero) == one
    assert g.absolute(g.neg(x)) == g.absolute(x)
    assert g.sqrt(zero) == zero and g.sqrt(one) == one
    assert g.minimum(x, x) == g.maximum(x, x) == x
    assert g.minimum(x, y) != g.minimum(y, x)  # a NaN on the left gives way, one on the right stays
    assert g.div(x, two) == g.mul(g.constant(Fraction(1, 2)), x)
    assert g.power(x, 0) == one and g.power(x, 2) == g.mul(x, x)
    assert g.power(x, 5) == g.mul(x, g.power(x, 4)) and g.power(x, -1) == g.div(one, x)


def test_what_has_no_meaning_is_refused() -> None:
    g = Graph()
    with pytest.raises(GraphError, match="zero"):
        g.div(g.input("n", 0), g.constant(0))


def test_names_stay_and_leaves_take_none() -> None:
    g = Graph()
    x = g.input("n", 0)
    square = g.mul(x, x)
    g.name(square, Name("first"))
    g.name(square, Name("second"))
    g.name(x, Name("leaf"))
    assert g.names == {square: Name("first")}
    target = Graph()
    place = g.copy_into(target, {})
    assert target.names == {place[square]: Name("first")}
    assert not Graph().names and g.copy_into(other := Graph(), {}, keep_names=False) and not other.names


def test_operations_are_counted() -> None:
    g = Graph()
    x, y = g.input("n", 0), g.input("n", 1)
    sine, cosine = g.sin(x), g.cos(x)
    length = g.sqrt(g.add(g.mul(x, x), g.mul(y, y)))
    quotient = g.div(g.neg(sine), length)
    unused = g.atan2(y, x)
    outputs = [g.mul(quotient, cosine), g.maximum(x, y)]
    found = count_operations(g, outputs)
    assert found == OperationCount(add=1, multiply=3, divide=1, square_root=1, sine_cosine=1, select=1)
    assert found.total == 8 and (found + found) == found * 2
    assert count_operations(g, [unused]).arctangent == 1
    assert count_operations(g, [g.sin(y)]).sine_cosine == 1


def test_nodes_are_leaves_or_operations() -> None:
    g = Graph()
    half = g.constant(Fraction(1, 2))
    assert g.value(half) == Fraction(1, 2) and g.value(g.input("n", 0)) is None
    assert g.nodes[half] == Node(Op.CONST, (), Fraction(1, 2))
