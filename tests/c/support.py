"""What the tests of the generated C share: the robots' signatures, compilers, and running programs."""

from __future__ import annotations

import shutil
import subprocess
from collections.abc import Sequence
from dataclasses import dataclass
from importlib import import_module
from math import prod
from pathlib import Path

import krhpr.generated
from krhpr.backend import c_sources
from krhpr.codegen.composition import OPTIONAL_INPUTS
from krhpr.generated.python.runtime import Port, Status
from tests.support import cover, need

HERE = Path(__file__).parent
SOURCES = c_sources()
ROBOTS: tuple[str, ...] = (*krhpr.generated.ROBOTS, *krhpr.generated.GRASPING)
COMPILERS = ("gcc", "clang")
KINDS = ("", "_batch")
"""A robot's sources: functions of one pose, and batches."""
CONTROLLED: tuple[str, ...] = krhpr.generated.GRASPING
"""Robots with a third source, their controller."""


COVER = cover(ROBOTS)


CONFORMANCE = (
    "-std=c99",
    "-pedantic",
    "-Wall",
    "-Wextra",
    "-Wconversion",
    "-Wdouble-promotion",
    "-Wvla",
    "-Wshadow",
    "-Wstrict-prototypes",
    "-Wmissing-prototypes",
    "-Wcast-qual",
    "-Wundef",
    "-Werror",
)
CPP = {"gcc": "g++", "clang": "clang++"}
CPP_CONFORMANCE = tuple(
    "-std=c++17" if flag == "-std=c99" else flag for flag in CONFORMANCE if not flag.endswith("-prototypes")
)

CHOICES = ("mode", "assembly", "box")
"""Inputs by which nothing is differentiated."""


@dataclass(frozen=True)
class Argument:
    """One argument of a C function: doubles in a row, or one double by value."""

    name: str
    size: int
    scalar: bool
    per_leg: bool


@dataclass(frozen=True)
class Function:
    """A C function of a robot, as its signature states it."""

    name: str
    inputs: tuple[Argument, ...]
    outputs: tuple[Argument, ...]


def functions(identifier: str) -> tuple[Function, ...]:
    """Every function of a robot."""
    signatures = import_module(f"krhpr.generated.python.{identifier}").SIGNATURES

    def arguments(ports: Sequence[Port]) -> tuple[Argument, ...]:
        return tuple(
            Argument(port.name, prod(port.shape), not port.shape, port.layout == "stacked") for port in ports
        )

    return tuple(
        Function(name, arguments(signature.inputs), arguments(signature.outputs))
        for name, signature in signatures.items()
    )


def program(name: str) -> str:
    """The path of a program, or a skipped test that says what is missing."""
    need(name)
    found = shutil.which(name)
    assert found is not None
    return found


def run(command: Sequence[str | Path], *, text: str | None = None, cwd: Path | None = None) -> str:
    """Run a program that must succeed; what it wrote to standard output."""
    done = subprocess.run(
        [str(word) for word in command], input=text, capture_output=True, text=True, check=False, cwd=cwd
    )
    said = "\n".join([" ".join(map(str, command)), done.stdout[-4000:], done.stderr[-4000:]])
    assert done.returncode == 0, said
    return done.stdout


def sections(compiled: Path) -> dict[str, int]:
    """Sections of an object and their sizes."""
    rows = [line.split() for line in run([program("size"), "-A", compiled]).splitlines()]
    return {row[0]: int(row[1]) for row in rows if len(row) == 3 and row[1].isdigit()}


def table(identifier: str) -> str:
    """C text that tells a harness which functions a robot has (harness.h declares the types)."""
    lines = [f'#include "krhpr_{identifier}.h"', f"typedef krhpr_{identifier}_geometry geometry;"]
    lines += ['#include "harness.h"', ""]
    rows = []
    for f in functions(identifier):
        symbol = f"krhpr_{identifier}_{f.name}"
        arguments = [f"*in[{i}]" if a.scalar else f"in[{i}]" for i, a in enumerate(f.inputs)]
        arguments += [f"out[{i}]" for i in range(len(f.outputs))]
        lines += [
            f"static int call_{f.name}(const geometry *g, const double *const in[], double *const out[])",
            f"{{ return {symbol}(g, {', '.join(arguments)}); }}",
        ]
        for kind, ports in (("in", f.inputs), ("out", f.outputs)):
            entries = ", ".join(
                f'{{"{a.name}", {a.size}, {int(a.per_leg)}, {int(a.name in OPTIONAL_INPUTS)}}}' for a in ports
            )
            lines.append(f"static const struct port {kind}_{f.name}[] = {{{entries}}};")
        rows.append(
            f'    {{"{f.name}", {len(f.inputs)}, in_{f.name}, {len(f.outputs)}, out_{f.name}, '
            f"call_{f.name}, {symbol}_batch, {symbol}_soa}},"
        )
    lines += ["", "static const struct function functions[] = {", *rows, "};", ""]
    lines += [
        f"#define DEFAULT_GEOMETRY krhpr_{identifier}_default_geometry",
        f"#define LAST_STATUS {max(Status)}",
        f"#define LEGS {getattr(import_module(f'krhpr.generated.python.{identifier}'), 'LEGS', 3)}",
    ]
    return "\n".join(lines) + "\n"
