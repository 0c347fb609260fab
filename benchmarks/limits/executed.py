"""What every contender executes for a pose, instruction by instruction, whatever the processor knows.

The program is executed in single steps (`tracer.c`); Capstone says what the instructions are. It takes Linux
on x86-64.
"""

from __future__ import annotations

import platform
from collections.abc import Iterator, Sequence
from pathlib import Path

from benchmarks.build import Tools, run
from benchmarks.limits.mix import Mix, mix_of
from benchmarks.limits.program import EMPTY, Job, Program

SYSTEM = "Linux x86_64"
Region = list[tuple[bytes, int]]
TRACER = Path(__file__).resolve().parent / "tracer.c"


class CannotCount(RuntimeError):
    """This machine or environment lacks what counting takes; the message says what."""


def system() -> str:
    """Operating system and processor of this machine."""
    return f"{platform.system()} {platform.machine()}"


def why_not() -> str | None:
    """What is missing here to count, if anything."""
    if system() != SYSTEM:
        return f"single steps are there for {SYSTEM}, this is {system()}"
    try:
        import capstone  # noqa: F401
    except ImportError:
        return "package 'capstone' is not in this environment"
    return None


def executed(program: Program, jobs: Sequence[Job], out: Path, tools: Tools) -> list[Mix]:
    """Per pose, for every job."""
    empty = [Job(EMPTY, mode) for mode in ("throughput", "batch")]
    regions = [mix_of(_decoded(region)) for region in traced(program, [*empty, *jobs], out, tools)]
    idle = dict(zip(("throughput", "batch"), regions[: len(empty)], strict=True))
    return [
        region.less(idle[job.mode]).scaled(1 / program.poses(job))
        for job, region in zip(jobs, regions[len(empty) :], strict=True)
    ]


def traced(program: Program, jobs: Sequence[Job], out: Path, tools: Tools) -> list[Region]:
    """What was executed for every job: the bytes of instructions, and how often."""
    tracer, counts = out / "tracer", out / f"{program.path.name}.counts"
    run([tools.cc, "-O2", "-Wall", "-Wextra", "-Werror", str(TRACER), "-o", str(tracer)])
    run([str(tracer), str(counts), *program.command(jobs)])
    regions = _regions(counts.read_text())
    if len(regions) != len(jobs):
        raise CannotCount(f"{len(regions)} regions were traced, {len(jobs)} are there")
    return regions


def _regions(text: str) -> list[Region]:
    """(bytes, times) of every instruction, region by region."""
    found = []
    for block in text.split("\n\n")[:-1]:
        words = (line.split() for line in block.splitlines() if line)
        found.append([(bytes.fromhex(code), int(times)) for code, times in words])
    return found


def _decoded(region: Region) -> Iterator[tuple[str, str, float]]:
    import capstone

    decoder = capstone.Cs(capstone.CS_ARCH_X86, capstone.CS_MODE_64)
    for code, times in region:
        for _, _, mnemonic, operands in decoder.disasm_lite(code, 0, 1):
            yield mnemonic, operands, times
            break
        else:
            yield f"unknown {code.hex()}", "", times
