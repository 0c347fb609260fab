"""From SymPy to graphs: the same values, the derivation's names, and errors that say what is wrong."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import pytest
import sympy as sp
from hypothesis import given
from hypothesis import strategies as st

from krhpr.codegen.evaluate import evaluate_kernel, prepare_geometry
from krhpr.codegen.graph import GraphError, InputRef, Op
from krhpr.codegen.kernel import Frame, GeometryField, GeometryType, Port, Unit
from krhpr.codegen.writer import RESERVED, KernelWriter
from krhpr.validation.arithmetic import BALLS, RATIONAL
from krhpr.validation.numbers import Angle, Ball, Exact, ball_precision
from tests.codegen.programs import half_tangents, rationals

X = sp.symbols("x:3", real=True)

expressions = st.recursive(
    st.one_of(st.sampled_from(X), st.integers(-3, 3).map(sp.Integer), st.sampled_from([sp.Rational(2, 3)])),
    lambda inner: st.one_of(
        st.tuples(inner, inner).map(lambda p: p[0] + p[1]),
        st.tuples(inner, inner).map(lambda p: p[0] - p[1]),
        st.tuples(inner, inner).map(lambda p: p[0] * p[1]),
        st.tuples(inner, st.integers(2, 4)).map(lambda p: p[0] ** p[1]),
        st.tuples(inner, st.sampled_from(X)).map(lambda p: p[0] / (p[1] ** 2 + 1)),
        inner.map(lambda e: -e),
    ),
    max_leaves=12,
)


@given(st.lists(expressions, min_size=1, max_size=4), st.lists(rationals, min_size=3, max_size=3))
def test_expressions_keep_their_values(written: list[sp.Expr], values: list[Fraction]) -> None:
    k = KernelWriter("random", "")
    x = k.input("x", (3,))
    there = dict(zip(X, x, strict=True))
    for index, expression in enumerate(written):
        here = sp.sympify(expression).xreplace(there)
        k.output(f"plain_{index}", here)
        k.output(f"named_{index}", k.let(f"name_{index}", here) * 1)
    kernel = k.kernel()
    found = evaluate_kernel(kernel, {"x": [Exact(value) for value in values]}, None, RATIONAL)
    numbers = {symbol: sp.Rational(v.numerator, v.denominator) for symbol, v in zip(X, values, strict=True)}
    for index, expression in enumerate(written):
        wanted = sp.sympify(expression).subs(numbers)
        for name in ("plain", "named"):
            assert found[f"{name}_{index}"][0] == Fraction(int(wanted.p), int(wanted.q))


@given(half_tangents, half_tangents)
def test_sines_and_cosines_of_sums(first: Fraction, second: Fraction) -> None:
    k = KernelWriter("angles", "")
    a, b = k.input("a", (2,), Unit.RADIAN)
    k.output("out", sp.Matrix([sp.sin(a + b), sp.cos(a - b), sp.sin(-a) * sp.cos(2 * b), sp.sin(a) ** 2]))
    angles = [Angle.from_half_tangent(first), Angle.from_half_tangent(second)]
    found = evaluate_kernel(k.kernel(), {"a": angles}, None, RATIONAL)["out"]
    one, two = angles
    assert found == [
        (one + two).sin(),
        (one - two).cos(),
        -one.sin() * (two + two).cos(),
        one.sin() * one.sin(),
    ]


def test_roots_quotients_and_absolute_values() -> None:
    k = KernelWriter("roots", "")
    x, y = k.input("x", (2,))
    k.output(
        "out", sp.Matrix([sp.sqrt(x), y / sp.sqrt(x), sp.Abs(y), 1 / (x * y), -x / y**2, x ** sp.Integer(-2)])
    )
    kernel = k.kernel()
    with ball_precision():
        found = evaluate_kernel(kernel, {"x": [Ball(2), Ball(-3)]}, None, BALLS)["out"]
        root = Ball(2).sqrt()
        wanted = [root, -3 / root, Ball(3), Ball(-1) / 6, Ball(-2) / 9, Ball(1) / 4]
        assert all(a.close(b) for a, b in zip(found, wanted, strict=True))
    assert kernel.operations.square_root == 1


def test_terms_with_a_sign_are_subtracted() -> None:
    k = KernelWriter("signs", "")
    x, y = k.input("x", (2,))
    k.output("a", x - y)
    k.output("b", -x - y)
    ops = [node.op for _, node in k.kernel().graph]
    assert Op.MUL not in ops and ops.count(Op.SUB) == 1 and ops.count(Op.NEG) == 1


def test_names_of_the_derivation_are_kept() -> None:
    k = KernelWriter("names", "what it is", "(1.2)")
    x = k.input("x", (2,))
    u = k.let("u_1", sp.Matrix([x[0] * x[1], x[0] + 1]), "(1.14)")
    n = k.let("n", u[0] * u[1])
    again = k.let("other", x[0] * x[1])
    k.output("out", n + again)
    kernel = k.kernel()
    named = {
        kernel.graph.names[node].text + kernel.graph.names[node].component for node in kernel.graph.names
    }
    assert named >= {"u_1_0", "u_1_1", "n", "out"} and "other" not in named
    assert {name.note for name in kernel.graph.names.values()} == {"(1.14)", ""}
    assert (kernel.name, kernel.doc, kernel.equations) == ("names", "what it is", "(1.2)")


def geometry() -> GeometryType:
    fields = (GeometryField("l_1", Unit.METRE, "a length"), GeometryField("alpha", Unit.RADIAN, "an angle"))
    k = KernelWriter("prepare", "")
    length, angle = (k.input(field.name, (), field.unit) for field in fields)
    k.output("e", length * sp.Matrix([sp.cos(angle), sp.sin(angle), 0]))
    return GeometryType("thing", "", fields, k.kernel())


def test_geometry_fields_and_prepared_vectors() -> None:
    shape = geometry()
    k = KernelWriter("uses", "", geometry=shape)
    k.output("out", k.g.e * k.g.l_1)
    angle = Angle("3/5", "4/5")
    prepared = prepare_geometry(shape, {"l_1": Exact(2), "alpha": angle}, RATIONAL)
    assert prepared["e"] == [Fraction(6, 5), Fraction(8, 5), 0] and prepared["alpha"][0] is angle
    found = evaluate_kernel(k.kernel(), {}, prepared, RATIONAL)["out"]
    assert found == [Fraction(12, 5), Fraction(16, 5), 0]
    assert shape.field("alpha").unit is Unit.RADIAN


def squares() -> Any:
    k = KernelWriter("squares", "")
    x, scale = k.input("x", (2,)), k.input("scale", ())
    k.output("y", scale * sp.Matrix([x[0] ** 2, x[0] * x[1]]))
    k.output("z", sp.sin(x[1]))
    return k.kernel()


def test_calls_and_tangents_of_kernels() -> None:
    inner = squares()
    k = KernelWriter("outer", "")
    a = k.input("a", (2,))
    found = k.call(inner, x=2 * a, scale=sp.Integer(3))
    value, rate = k.call_tangent(inner, "y", {"x": 2 * a, "scale": a[0]}, {"x": sp.Matrix([1, a[1]])})
    k.output("called", found.y)
    k.output("value", value)
    k.output("rate", rate)
    result = evaluate_kernel(k.kernel(), {"a": [Exact(5), Exact(7)]}, None, RATIONAL)
    assert result["called"] == [3 * 100, 3 * 140]
    assert result["value"] == [5 * 100, 5 * 140]
    assert result["rate"] == [5 * 2 * 10, 5 * (14 + 10 * 7)]
    still = KernelWriter("still", "")
    b = still.input("b", (2,))
    _, nothing = still.call_tangent(inner, "z", {"x": b, "scale": sp.Integer(1)}, {"x": sp.Matrix([1, 0])})
    assert nothing == 0


def test_choices() -> None:
    k = KernelWriter("choices", "")
    x, y, z = k.input("x", (3,))
    k.output(
        "out", sp.Matrix([k.minimum(x, y, z), k.maximum(x, y, z), k.absolute(x - y), k.sign(y), k.sign(z)])
    )
    values = {"x": [Exact(2), Exact(-5), Exact(3)]}
    assert evaluate_kernel(k.kernel(), values, None, RATIONAL)["out"] == [-5, 3, 7, -1, 1]


def test_an_arctangent_is_one_operation() -> None:
    k = KernelWriter("angle", "")
    x, y = k.input("x", (2,))
    k.output("same", k.atan2(0 * x, sp.Integer(1)))
    k.output("general", k.atan2(y, x))
    assert [node.op for _, node in k.kernel().graph].count(Op.ATAN2) == 2


def test_unread_inputs_are_pruned_where_asked() -> None:
    k = KernelWriter("prune", "")
    x, _ = k.input("x", ()), k.input("y", (2,))
    k.output("out", x + 1)
    assert [port.name for port in k.kernel().inputs] == ["x", "y"]
    assert [port.name for port in k.kernel(prune=["y", "x"]).inputs] == ["x"]
    kernel = k.kernel()
    assert kernel.input_port("y").shape == (2,)
    with pytest.raises(KeyError, match="no port 'q'"):
        kernel.output_port("q")


def test_written_operations_are_those_of_the_formulas() -> None:
    k = KernelWriter("count", "")
    x, y = k.input("x", (2,))
    k.output("a", x * y + x**3 - sp.sin(y) / x)
    kernel = k.kernel()
    assert (
        kernel.written == 1 + 2 + 2 + 2 + 1
    )  # x y, x^3, two sums, sin and quotient as a product and a power
    assert kernel.graph.needed(kernel.result_nodes)


def test_mistakes_are_told() -> None:
    k = KernelWriter("mistakes", "")
    x = k.input("x", (2,))
    with pytest.raises(GraphError, match="q in 'mistakes' is neither an input"):
        k.output("a", sp.Symbol("q") + x[0])
    with pytest.raises(GraphError, match="no operation of the graph stands for exp"):
        k.output("b", sp.exp(x[0]))
    with pytest.raises(GraphError, match="3 elements, not"):
        k.add_output(Port("c", (2,), Unit.NONE, Frame.NONE, ""), [x[0], x[1], x[0]])
    for word in sorted(RESERVED):
        with pytest.raises(GraphError, match="reserved word"):
            k.input(word, ())
    with pytest.raises(GraphError, match="takes"):
        k.call(squares(), x=x)
    with pytest.raises(GraphError, match="has 1 elements"):
        k.call(squares(), x=x[0], scale=x[1])
    assert InputRef("x", 0) in {node.value for _, node in k.kernel().graph}
