"""From contenders to one shared library: the same compiler flags for all, one relocatable object for each.

Every contender is linked into an object of its own; unreachable sections are dropped and all but its entry
points made local. The object's ``.text`` is then the size of the function with everything that it calls,
without libm.
"""

from __future__ import annotations

import subprocess
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from benchmarks.contender import Contender
from benchmarks.harness import harness_source
from benchmarks.workloads import Workload

NATIVE = "-march=native"
SPEED_FLAGS = (
    "-O3",
    NATIVE,
    "-ffp-contract=fast",
    "-fno-math-errno",
    "-fno-tree-slp-vectorize",
)
PLUMBING_FLAGS = ("-fPIC", "-ffunction-sections", "-fdata-sections")  # no effect on the code of a function
CXX_PLUMBING_FLAGS = ("-fno-gnu-unique",)  # names that all libraries share could not be made local
HARNESS_FLAGS = ("-O2", "-fno-tree-vectorize", "-march=native", "-fPIC", "-Wall", "-Wextra", "-Werror")


class BuildError(RuntimeError):
    """A command failed; the message holds its first line of complaint."""


@dataclass(frozen=True)
class Tools:
    """Compilers in use, and the processor that they compile for."""

    cc: str = "gcc"
    cxx: str = "g++"
    processor: str = "native"

    @property
    def speed_flags(self) -> list[str]:
        """`SPEED_FLAGS` for that processor."""
        return [f"-march={self.processor}" if flag == NATIVE else flag for flag in SPEED_FLAGS]


@dataclass(frozen=True)
class Built:
    """A contender's object, the names of its entry points in the library, and its size in bytes."""

    contender: Contender
    objects: Path
    single_symbol: str | None
    batch_symbol: str | None
    text_bytes: int
    rodata_bytes: int


def run(command: Sequence[str]) -> str:
    """Standard output of a command; ``BuildError`` with its first complaint if it fails."""
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        lines = (
            [line for line in done.stderr.splitlines() if "error" in line] or done.stderr.splitlines() or [""]
        )
        raise BuildError(f"{command[0]}: {lines[0].strip()}")
    return done.stdout


def compile_one(source: Path, target: Path, contender: Contender, tools: Tools) -> Path:
    """One translation unit with the shared flags."""
    is_c = source.suffix == ".c"
    compiler = tools.cc if is_c else tools.cxx
    includes = [f"-I{folder}" for folder in contender.include_dirs]
    plumbing = PLUMBING_FLAGS if is_c else (*PLUMBING_FLAGS, *CXX_PLUMBING_FLAGS)
    flags = [*tools.speed_flags, *contender.extra_flags, *plumbing]
    run([compiler, *flags, *includes, "-c", str(source), "-o", str(target)])
    return target


def section_sizes(relocatable: Path) -> tuple[int, int]:
    """Bytes of code and of constants."""
    text = rodata = 0
    for line in run(["size", "-A", str(relocatable)]).splitlines():
        words = line.split()
        if len(words) == 3 and words[0].startswith(".text"):
            text += int(words[1])
        elif len(words) == 3 and words[0].startswith((".rodata", ".data.rel.ro")):
            rodata += int(words[1])
    return text, rodata


def build_contender(contender: Contender, workload: Workload, index: int, out: Path, tools: Tools) -> Built:
    """Compiles and isolates one contender."""
    stem = f"{workload.key}_{index}"
    glue = out / f"glue_{stem}{'.c' if contender.glue_language == 'c' else '.cc'}"
    glue.write_text(contender.glue)
    units = [glue, *map(Path, contender.sources)]
    objects = [
        compile_one(unit, out / f"{stem}_{number}.o", contender, tools) for number, unit in enumerate(units)
    ]
    entries = {workload.symbol: f"single_{stem}"} if contender.single else {}
    if contender.batch_layout:
        entries[f"{workload.symbol}_batch"] = f"batch_{stem}"
    linked, isolated = out / f"{stem}.linked.o", out / f"{stem}.o"
    roots = [f"-u{symbol}" for symbol in entries]
    # C++ templates lie in groups, of which a library keeps one each: every contender is to have its own.
    run(
        [
            "ld",
            "-r",
            "--gc-sections",
            "--force-group-allocation",
            *roots,
            "-o",
            str(linked),
            *map(str, objects),
        ]
    )
    keep = [f"--keep-global-symbol={symbol}" for symbol in entries]
    rename = [f"--redefine-sym={old}={new}" for old, new in entries.items()]
    run(["objcopy", *keep, str(linked), str(isolated)])
    run(["objcopy", *rename, str(isolated)])
    text, rodata = section_sizes(isolated)
    return Built(
        contender,
        isolated,
        entries.get(workload.symbol),
        entries.get(f"{workload.symbol}_batch"),
        text,
        rodata,
    )


def build_library(workload: Workload, built: Sequence[Built], out: Path, tools: Tools) -> Path:
    """The measuring loops and all contenders of one workload in one shared library."""
    source, harness = out / f"harness_{workload.key}.c", out / f"harness_{workload.key}.o"
    source.write_text(harness_source(workload))
    run([tools.cc, *HARNESS_FLAGS, "-c", str(source), "-o", str(harness)])
    library = out / f"contenders_{workload.key}.so"
    extra = sorted({item for b in built for item in b.contender.libraries})
    objects = [str(b.objects) for b in built]
    run([tools.cxx, "-shared", "-o", str(library), str(harness), *objects, *extra, "-lm"])
    return library
