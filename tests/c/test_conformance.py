"""The generated C compiles without a warning, needs next to nothing, keeps no state and does not recurse."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from tests.c.support import (
    CONFORMANCE,
    CONTROLLED,
    CPP,
    CPP_CONFORMANCE,
    KINDS,
    ROBOTS,
    SOURCES,
    program,
    run,
    sections,
)
from tests.support import SOME

HEADERS = sorted(path.name for path in SOURCES.glob("krhpr*.h"))
LARGEST_FRAME = {"": 8192, "_batch": 65536}
"""Bytes of stack that one function may take; a batch has as many poses on its stack as there are lanes."""

SPEED = ("-O3", "-ffp-contract=fast", "-fno-math-errno")

# What a robot may ask of the system: functions of math.h (sincos is how gcc calls sin and cos of one angle;
# copysign is a call only without optimisation), and what compilers put in for loops that copy or clear.
ALLOWED = {"sin", "cos", "sincos", "atan2", "sqrt", "floor", "copysign", "memset", "memcpy", "memmove"}
POSITION_INDEPENDENCE = {"_GLOBAL_OFFSET_TABLE_"}

# Loops count upwards to a constant, or to a count that the caller gives; iterations may end before.
LOOP = re.compile(
    r"for \((?:int|ptrdiff_t) (\w+) = \w+(?: - 1| > 0 \? n : 0)?; "
    r"(?:\1 <=? (?:\d+|KRHPR_(?:LANES|LINE|PLACES|ROOTS_INTERVALS|PADDED\(\d+\))"
    r"|n|n - pass|whole|rest|size|blocks|together|roots|\(ptrdiff_t\)count)"
    r"(?: && !\(change\[[i0]\] <= [\de.-]+\)| && krhpr_any\(moving\)| && size > 0)?; "
    r"(?:\+\+\1|\1 \+= (?:2|4|KRHPR_LANES))"
    r"|\1 >= (?:0|1|pass); --\1)\)"
)
FORBIDDEN = re.compile(
    r"\b(while|goto|setjmp|longjmp|alloca|malloc|calloc|realloc|free|pow|volatile|extern(?! \"C\"))\b"
)


@pytest.fixture(params=KINDS, ids=["single", "batch"])
def kind(request: pytest.FixtureRequest) -> str:
    """Each of a robot's sources."""
    return str(request.param)


def compile_object(compiler: str, robot: str, kind: str, folder: Path, *flags: str) -> Path:
    target = folder / f"{robot}{kind}.o"
    run([compiler, *flags, "-c", SOURCES / f"krhpr_{robot}{kind}.c", "-o", target])
    return target


@pytest.mark.every_robot
@pytest.mark.usefixtures("in_turns")
def test_strict_c99(robot: str, kind: str, compiler: str, tmp_path: Path) -> None:
    """No warning at all; those of the optimiser's analyses are looked for below."""
    compile_object(compiler, robot, kind, tmp_path, *CONFORMANCE, "-fsyntax-only")


@pytest.mark.parametrize("robot", SOME)
@pytest.mark.parametrize("standard", ["c11", "c17", "gnu99", "gnu17"])
def test_later_standards(robot: str, kind: str, compiler: str, standard: str, tmp_path: Path) -> None:
    flags = [f"-std={standard}" if flag.startswith("-std=") else flag for flag in CONFORMANCE]
    compile_object(compiler, robot, kind, tmp_path, *flags, "-fsyntax-only")


@pytest.mark.parametrize("header", HEADERS)
def test_header_stands_alone_in_c(header: str, compiler: str, tmp_path: Path) -> None:
    source = tmp_path / "alone.c"
    source.write_text(f'#include "{header}"\n#include "{header}"\ntypedef int not_empty;\n')
    run([compiler, *CONFORMANCE, "-fsyntax-only", f"-I{SOURCES}", source])


def test_headers_serve_cpp(compiler: str, tmp_path: Path) -> None:
    """All headers together in C++17, in two orders; that of batches comes first, where it is included."""
    cpp = program(CPP[compiler])
    single = [header for header in HEADERS if header != "krhpr_poses.h"]
    for number, headers in enumerate((single, ["krhpr_poses.h", *single[::-1]])):
        source = tmp_path / f"{number}.cpp"
        source.write_text("".join(f'#include "{header}"\n' for header in headers))
        run([cpp, *CPP_CONFORMANCE, "-fsyntax-only", f"-I{SOURCES}", source])


@pytest.mark.usefixtures("in_turns")
def test_a_cpp_program_calls_a_robot(robot: str, compiler: str, tmp_path: Path) -> None:
    """Compiled as C, called from C++."""
    cpp = program(CPP[compiler])
    source = tmp_path / "main.cpp"
    prefix = f"krhpr_{robot}"
    body = f"{{ {prefix}_geometry g; return {prefix}_default_geometry(&g); }}"
    source.write_text(f'#include "{prefix}.h"\nint main() {body}\n')
    library = compile_object(compiler, robot, "", tmp_path, "-O0")
    run([cpp, *CPP_CONFORMANCE, f"-I{SOURCES}", source, library, "-o", tmp_path / "main", "-lm"])
    run([tmp_path / "main"])


@pytest.mark.usefixtures("in_turns")
@pytest.mark.parametrize(
    "flags",
    [("-O0",), pytest.param(("-O2",), marks=pytest.mark.full), SPEED],
    ids=["O0", "O2", "speed"],
)
def test_objects(
    robot: str, kind: str, compiler: str, flags: tuple[str, ...], tmp_path: Path, full: bool
) -> None:
    """No warning; undefined symbols are on a short list (no allocation, no pow), all others are prefixed; and
    there is no state: nothing in .data, .bss or thread-local storage, and no common symbols.
    """
    if flags == SPEED and robot != SOME[0] and not full:
        pytest.skip("what optimisation needs comes from the templates, which all robots share")
    nm = program("nm")
    library = compile_object(
        compiler, robot, kind, tmp_path, *CONFORMANCE, *flags, "-fPIC", "-fno-stack-protector"
    )
    needed, offered = set(), set()
    for line in run([nm, library]).splitlines():
        letter, name = line.split()[-2:]
        if letter == "U":
            needed.add(name)
        elif letter.isupper():
            offered.add((letter, name))
    if kind:  # batches of procedures call them pose by pose
        needed = {name for name in needed if not name.startswith(f"krhpr_{robot}_")}
    assert needed - POSITION_INDEPENDENCE <= ALLOWED
    assert {letter for letter, _ in offered} == {"T"}, "functions alone are exported"
    assert all(name.startswith(f"krhpr_{robot}_") for _, name in offered)
    found = sections(library)
    assert found[".text"] > 0
    kinds = re.compile(r"\.(data|bss|tdata|tbss|ldata|lbss|common)\b")
    writable = {name: length for name, length in found.items() if kinds.match(name) and length}
    assert not writable


def test_stack_and_call_graph(robot: str, kind: str, tmp_path: Path) -> None:
    """Every stack frame is small, its size known at compile time; no function ever calls itself."""
    program("gcc")
    flags = ("-std=c99", "-O2", "-fno-inline", "-fstack-usage", "-fcallgraph-info")
    compile_object("gcc", robot, kind, tmp_path, *flags)
    frames = [line.split("\t") for line in (tmp_path / f"{robot}{kind}.su").read_text().splitlines()]
    # "dynamic,bounded": gcc aligns or pushes within a bound that the size includes; "dynamic" would be a VLA
    assert {known for _, _, known in frames} <= {"static", "dynamic,bounded"}
    assert max(int(size) for _, size, _ in frames) <= LARGEST_FRAME[kind]
    graph: dict[str, set[str]] = {}
    text = (tmp_path / f"{robot}{kind}.ci").read_text()
    edges = re.findall(r'edge: \{ sourcename: "([^"]*)" targetname: "([^"]*)"', text)
    for caller, callee in edges:
        graph.setdefault(caller, set()).add(callee)
    assert not any("indirect" in callee for callees in graph.values() for callee in callees)
    assert not cycle(graph)


def cycle(graph: dict[str, set[str]]) -> list[str]:
    """A chain of callers that comes back to itself, or nothing."""
    finished: set[str] = set()

    def visit(name: str, path: list[str]) -> list[str]:
        if name in path:
            return [*path, name]
        if name in finished:
            return []
        for callee in sorted(graph.get(name, ())):
            if found := visit(callee, [*path, name]):
                return found
        finished.add(name)
        return []

    return next((found for name in sorted(graph) if (found := visit(name, []))), [])


def test_cycles_are_found() -> None:
    assert cycle({"a": {"b"}, "b": {"c"}, "c": {"b"}}) == ["a", "b", "c", "b"]
    assert not cycle({"a": {"b", "c"}, "b": {"c"}})


@pytest.mark.parametrize("path", sorted(SOURCES.glob("krhpr*.[ch]")), ids=lambda path: path.name)
def test_loops_are_bounded(path: Path) -> None:
    """Loops count to a constant, or to a count that the caller gives; no while, no function pointer."""
    code = re.sub(r"/\*.*?\*/", "", path.read_text(), flags=re.DOTALL)
    assert not FORBIDDEN.search(code)
    loops = re.findall(r"\bfor \(.*?\)(?=\s*\{)", code)
    assert len(loops) == len(re.findall(r"\bfor\b", code))
    assert [loop for loop in loops if not LOOP.fullmatch(loop)] == []
    assert not re.search(r"\(\s*\*\s*\w+\s*\)\s*\(", code), "a function pointer"


def test_every_robot_is_here() -> None:
    assert ROBOTS
    expected = {f"krhpr_{robot}{kind}" for robot in ROBOTS for kind in KINDS}
    expected |= {f"krhpr_{robot}_control" for robot in CONTROLLED}
    assert {path.stem for path in SOURCES.glob("krhpr_*.c")} == expected
