"""Lengths and angles: exact, strict, and alike for the reader and the schema."""

from __future__ import annotations

import math
import re
from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st

from krhpr.robot_files.quantities import BadQuantity, Kind, parse, pattern
from krhpr.robot_files.tree import Items, Text


def value(text: str, kind: Kind, *, plain: bool = True) -> float:
    return parse(Text(text, plain, 1), kind)


@pytest.mark.parametrize(
    ("text", "kind", "expected"),
    [
        ("0.125", Kind.LENGTH, 0.125),
        ("125 mm", Kind.LENGTH, 0.125),
        ("12.5 cm", Kind.LENGTH, 0.125),
        ("0.125m", Kind.LENGTH, 0.125),
        ("7.5 mm", Kind.LENGTH, 0.0075),
        ("1e-3", Kind.LENGTH, 0.001),
        ("-.5", Kind.LENGTH, -0.5),
        ("+2.", Kind.LENGTH, 2.0),
        ("120 deg", Kind.ANGLE, math.radians(120.0)),
        ("2.5 rad", Kind.ANGLE, 2.5),
        ("-1", Kind.ANGLE, -1.0),
        ("3", Kind.NUMBER, 3.0),
    ],
)
def test_quantities_are_read(text: str, kind: Kind, expected: float) -> None:
    assert value(text, kind) == expected


@pytest.mark.parametrize(
    "text",
    [
        "",
        "x",
        "mm",
        "125 deg",
        "1 2",
        "1 mm mm",
        "125 Mm",
        "125 in",
        "010",
        "1_000",
        "1,5",
        "0x10",
        "1:30",
        ".inf",
        "nan",
        "inf",
        "1e999",
        "1e9999",
        "--1",
        "1 m + 1 m",
        "__import__('os')",
        "1/2",
        "٣",
        "1\u00a0m",
        "1m\n",
        "0." + "1" * 60,
    ],
)
def test_everything_else_is_refused(text: str) -> None:
    with pytest.raises(BadQuantity, match="found"):
        value(text, Kind.LENGTH)


def test_a_number_in_quotes_is_a_text() -> None:
    assert value("125 mm", Kind.LENGTH, plain=False) == 0.125
    with pytest.raises(BadQuantity, match="leave the quotes out"):
        value("0.125", Kind.LENGTH, plain=False)


def test_a_list_is_no_quantity() -> None:
    with pytest.raises(BadQuantity, match=r"found a list of 0, expected an angle in radians \(2.09\), or"):
        parse(Items((), 1), Kind.ANGLE)


@given(st.integers(0, 10**12), st.integers(0, 9), st.sampled_from(["mm", "cm", "m"]))
def test_lengths_are_rounded_once(digits: int, places: int, unit: str) -> None:
    whole = str(digits).rjust(places + 1, "0")
    text = f"{whole[: len(whole) - places]}.{whole[len(whole) - places :]}"
    text = text if re.match(r"0\.|[1-9]", text) else text.lstrip("0")
    exact = Fraction(digits, 10**places) * {"mm": Fraction(1, 1000), "cm": Fraction(1, 100), "m": 1}[unit]
    assert value(f"{text} {unit}", Kind.LENGTH) == float(exact)


@given(st.text(alphabet="0123456789.+-eE mcdegra_x'\n", max_size=12))
def test_reader_and_pattern_agree_about_units(text: str) -> None:
    for kind in (Kind.LENGTH, Kind.ANGLE):
        try:
            found = value(text, kind, plain=False)
        except BadQuantity:
            # the pattern does not know that exponents overflow
            assert not re.fullmatch(pattern(kind)[1:-1], text) or "e" in text.lower()
        else:
            assert re.fullmatch(pattern(kind)[1:-1], text) and math.isfinite(found)
