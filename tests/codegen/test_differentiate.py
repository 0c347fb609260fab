"""Tangents against truncated Taylor series, and against what is known."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from krhpr.codegen.differentiate import tangents
from krhpr.codegen.evaluate import evaluate_kernel
from krhpr.codegen.graph import Graph, GraphError, InputRef
from krhpr.validation.arithmetic import BALLS, RATIONAL
from krhpr.validation.jets import Jet
from krhpr.validation.numbers import Ball, Exact, ball_precision
from tests.codegen.programs import (
    ANGLES,
    NUMBERS,
    SMOOTH,
    Program,
    Step,
    inputs_of,
    kernel,
    points,
    rationals,
    references,
    steps,
)

RATES = NUMBERS + ANGLES


def rate_references() -> list[InputRef]:
    return [InputRef("rate", i) for i in range(RATES)]


def differentiated(
    graph: Graph, outputs: list[int], seeded: list[InputRef]
) -> tuple[Graph, list[int | None]]:
    """A graph with the derivatives of the outputs along the inputs named `rate`."""
    target = Graph()
    place = graph.copy_into(target, {})
    all_rates = dict(zip(references(), rate_references(), strict=True))
    seeds = {ref: target.input(all_rates[ref].port, all_rates[ref].index) for ref in seeded}
    dots = tangents(graph, target, place, seeds, outputs)
    return target, [dots[node] for node in outputs]


def evaluated(graph: Graph, nodes: list[int | None], inputs: dict[str, Any], arithmetic: Any) -> list[Any]:
    """Values of nodes; no node stands for zero."""
    present = [node for node in nodes if node is not None]
    found = iter(evaluate_kernel(kernel(graph, present), inputs, None, arithmetic)["out"])
    return [Exact(0) if node is None else next(found) for node in nodes]


@given(steps(SMOOTH, 15), points(), st.lists(rationals, min_size=RATES, max_size=RATES))
def test_tangents_are_those_of_series(program: list[Step], values: list[Any], rates: list[Fraction]) -> None:
    written = Program()
    written.leaves(references(), values, RATIONAL)
    written.write(program, RATIONAL)
    outputs = [node for node, _ in written.numbers[-5:]]
    target, dots = differentiated(written.graph, outputs, references())
    found = evaluated(target, dots, {**inputs_of(values), "rate": [Exact(rate) for rate in rates]}, RATIONAL)
    jets = [Jet(value, rate) for value, rate in zip(values, rates, strict=True)]
    series = evaluate_kernel(kernel(written.graph, outputs), inputs_of(jets), None, RATIONAL)["out"]
    assert found == [jet.rate if isinstance(jet, Jet) else 0 for jet in series]


def test_roots_and_arctangents() -> None:
    g = Graph()
    x, y = g.input("n", 0), g.input("n", 1)
    outputs = [g.sqrt(g.add(g.mul(x, x), y)), g.atan2(y, g.add(x, y)), g.atan2(y, x)]
    target, dots = differentiated(g, outputs, references())
    with ball_precision():
        values = [Ball("0.7"), Ball("1.3"), *[Ball(1)] * 4]
        rates = [Ball("0.2"), Ball("-0.9"), *[Ball(0)] * 4]
        found = evaluated(target, dots, {**inputs_of(values), "rate": rates}, BALLS)
        jets = [Jet(value, rate) for value, rate in zip(values, rates, strict=True)]
        series = evaluate_kernel(kernel(g, outputs), inputs_of(jets), None, BALLS)["out"]
        for got, jet in zip(found, series, strict=True):
            assert got.close(jet.rate)
        step = Ball("1e-25")
        moved = [value + rate * step for value, rate in zip(values, rates, strict=True)]
        here, there = (
            evaluate_kernel(kernel(g, outputs), inputs_of(v), None, BALLS)["out"] for v in (values, moved)
        )
        for got, before, after in zip(found, here, there, strict=True):
            assert got.close((after - before) / step, "1e-20")


def test_what_does_not_move_has_no_tangent() -> None:
    g = Graph()
    x, y = g.input("n", 0), g.input("n", 1)
    outputs = [g.mul(x, x), g.sin(y), g.constant(3), g.add(x, g.cos(y)), g.div(g.constant(1), x)]
    _, dots = differentiated(g, outputs, [InputRef("n", 1)])
    assert [dot is None for dot in dots] == [True, False, True, False, True]


def test_only_what_outputs_need_is_differentiated() -> None:
    g = Graph()
    x = g.input("n", 0)
    kink, smooth = g.absolute(x), g.mul(x, x)
    _, dots = differentiated(g, [smooth], references())
    assert dots[0] is not None
    for node in (kink, g.minimum(x, g.constant(1)), g.maximum(smooth, x)):
        with pytest.raises(GraphError, match="no derivative everywhere"):
            differentiated(g, [node], references())
