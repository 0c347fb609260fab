"""Integers, conditions, and the errors of operations that have no value."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from krhpr.validation.c_interpreter import CError, CProgram
from krhpr.validation.numbers import FLOAT


def test_integer_division_is_not_that_of_doubles() -> None:
    text = "double f(double x) { return 1/2*x + (1/2.0)*x + (x > 0 ? 1 : 0.5)/2; }"
    assert CProgram.from_text(text).call("f", 3) == 2
    # Integers that Python hands over for doubles are doubles.
    text = "double f(const double x[2], double y) { return x[0]/x[1] + y/2; }"
    assert CProgram.from_text(text).call("f", [1, 2], 1) == 1


@given(st.integers(-50, 50), st.integers(-50, 50))
def test_conditions(a: int, b: int) -> None:
    text = """
    int f(double a, double b) {
        if (a < b && b > 0) return 1;
        else if (a == b || !(a > b)) return 2;
        return a >= 0 ? 3 : 4;
    }
    """
    expected = 1 if a < b and b > 0 else 2 if a <= b else 3 if a >= 0 else 4
    assert CProgram.from_text(text).call("f", a, b) == expected


@pytest.mark.parametrize(
    ("body", "message"),
    [
        ("int i = 2147483647; i += 1; return i;", "overflows"),
        ("return 1/(x > 5);", "division by zero"),
        ("return 1 << 40;", "shift"),
        ("if (x > 5) return 1;", "without returning"),
    ],
)
def test_undefined_behaviour_of_integers_is_found(body: str, message: str) -> None:
    with pytest.raises(CError, match=message):
        CProgram.from_text(f"int f(double x) {{ {body} }}").call("f", 1)


def test_division_by_zero_is_located() -> None:
    with pytest.raises(ZeroDivisionError) as raised:
        CProgram.from_text("double f(double x)\n{\n    return 1/x;\n}").call("f", 0)
    assert raised.value.__notes__ == ["at text.c:3"]
    assert CProgram.from_text("double f(double x) { return 1/x; }", FLOAT).call("f", 0) == math.inf


@pytest.mark.parametrize(
    "name", ["unsigned long int", "long unsigned int", "unsigned int long", "int long unsigned"]
)
def test_the_words_of_an_integer_type_come_in_any_order(name: str) -> None:
    assert CProgram.from_text(f"double f(void) {{ {name} x = 0; return x - 1; }}").call("f") == 2**64 - 1
