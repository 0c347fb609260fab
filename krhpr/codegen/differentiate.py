"""Differentiation of the graph, in forward mode: the derivative of a program is another program of the same
shape.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from fractions import Fraction

from krhpr.codegen.graph import Graph, GraphError, InputRef, Node, Op


def tangents(
    source: Graph, target: Graph, place: list[int], seeds: Mapping[InputRef, int], outputs: Iterable[int]
) -> list[int | None]:
    """Derivatives of the nodes that `outputs` need along the direction `seeds`, written into `target`.

    `place[i]` is where node i of `source` stands in `target`; `seeds` maps inputs of `source` to the nodes of
    `target` that hold their rates.  None stands for a derivative that is zero.
    """
    dots: list[int | None] = []
    needed = source.needed(outputs)
    for index, node in source:
        args = [place[a] for a in node.args]
        dots.append(_tangent(target, node, args, place[index], seeds, dots) if needed[index] else None)
    return dots


def _tangent(
    g: Graph, node: Node, args: list[int], here: int, seeds: Mapping[InputRef, int], dots: list[int | None]
) -> int | None:
    if isinstance(node.value, InputRef):
        return seeds.get(node.value)
    if isinstance(node.value, Fraction):
        return None
    rates = [dots[a] for a in node.args]
    if all(rate is None for rate in rates):
        return None
    match node.op:
        case Op.ADD:
            return _plus(g, rates[0], rates[1])
        case Op.SUB:
            return _minus(g, rates[0], rates[1])
        case Op.MUL:
            return _plus(g, _times(g, rates[0], args[1]), _times(g, rates[1], args[0]))
        case Op.DIV:
            # (a / b)' = (a' - (a / b) b') / b
            above = _minus(g, rates[0], _times(g, rates[1], here))
            return None if above is None else g.div(above, args[1])
        case Op.NEG:
            return None if rates[0] is None else g.neg(rates[0])
        case Op.SQRT:
            assert rates[0] is not None
            return g.div(g.mul(g.constant(Fraction(1, 2)), rates[0]), here)
        case Op.SIN:
            return _times(g, rates[0], g.cos(args[0]))
        case Op.COS:
            rate = _times(g, rates[0], g.sin(args[0]))
            return None if rate is None else g.neg(rate)
        case Op.ATAN2:
            # d atan2(y, x) = (x y' - y x') / (x^2 + y^2)
            y, x = args
            above = _minus(g, _times(g, rates[0], x), _times(g, rates[1], y))
            return None if above is None else g.div(above, g.add(g.mul(x, x), g.mul(y, y)))
        case _:
            raise GraphError(
                f"{node.op.value} has no derivative everywhere; keep it out of what is differentiated"
            )


def _plus(g: Graph, a: int | None, b: int | None) -> int | None:
    if a is None or b is None:
        return b if a is None else a
    return g.add(a, b)


def _minus(g: Graph, a: int | None, b: int | None) -> int | None:
    if b is None:
        return a
    return g.neg(b) if a is None else g.sub(a, b)


def _times(g: Graph, a: int | None, b: int) -> int | None:
    return None if a is None else g.mul(a, b)
