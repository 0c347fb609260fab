"""What is outside the subset is refused, and errors say where."""

from __future__ import annotations

from pathlib import Path

import pytest

from krhpr.validation.c_interpreter import CProgram, OutOfBounds, Unsupported


@pytest.mark.parametrize(
    ("body", "message"),
    [
        ("while (x > 0) x -= 1;", "While"),
        ("do x -= 1; while (x > 0);", "DoWhile"),
        ("switch (1) { default: return 1; }", "Switch"),
        ("goto end; end: return 1;", "Goto"),
        ("float y = 1; return y;", "the type float"),
        ("return 1.0f;", r"literal 1\.0f"),
        ("return sizeof(x);", "sizeof"),
        ("return exp(x);", "exp is called but not defined"),
        ("return y;", "y is not declared"),
        ("return 'a';", "the literal 'a'"),
        ("static double y = 1; return y;", "static"),
        ("int n = 3; double y[n]; return 1;", "not an integer constant"),
        ("double y[2] = {1, 2, 3}; return 1;", "3 initialisers for 2"),
        ("double y[2] = {{1}, 2}; return 1;", "braces around a scalar"),
        ("return f(x - 1);", "recursive"),
        ("return sin(x, x);", "sin takes 1 arguments"),
        ("return x % 2;", "% on double"),
        ("double *p = &x; int *q = p; return 1;", "where pointer to 32-bit integer is expected"),
        ("return hidden(x);", "hidden is called but not defined"),
    ],
)
def test_what_is_unsupported_is_said_with_its_line(body: str, message: str) -> None:
    program = CProgram.from_text(f"double hidden(double);\ndouble f(double x)\n{{\n{body}\n}}")
    with pytest.raises(Unsupported, match=message) as raised:
        program.call("f", 1)
    if "recursive" not in message:
        assert "text.c:4" in str(raised.value)


@pytest.mark.parametrize(
    "text",
    [
        "double counter = 0;",
        "#define TEXT(x) #x",
        "#define ALL(...) f(__VA_ARGS__)",
        "#define SQUARE(x) ((x)*(x))\nint n[SQUARE(1, 2)];",
        "#define SQUARE(x) ((x)*(x))\nint n[SQUARE(1",
        "#error no",
        "double f( { }",
        "union u { int i; };",
        "struct s { int i : 3; };",
        "#if 1",
    ],
)
def test_texts_that_are_refused(text: str) -> None:
    with pytest.raises(Unsupported):
        CProgram.from_text(text)


def test_errors_name_the_file_and_the_way_there(tmp_path: Path) -> None:
    header, source = tmp_path / "kernel.h", tmp_path / "robot.c"
    header.write_text("/* two\n lines */\nstatic void kernel(double *x)\n{\n    x[1] = 0;\n}\n")
    source.write_text('#include "kernel.h"\nvoid robot(void)\n{\n    double x;\n    kernel(&x);\n}\n')
    with pytest.raises(OutOfBounds, match=r"kernel\.h:5: index 1 of x, 1 elements") as raised:
        CProgram.from_files([header, source]).call("robot")
    assert raised.value.__notes__ == ["called from robot.c:5"]
