"""Instructions per pose by callgrind, a simulator that knows AVX2 and not AVX-512: all is built anew for it.

What it counts is comparable between machines, whatever they are.
"""

from __future__ import annotations

import re
import shutil
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from benchmarks.build import Built, Tools, build_contender, build_library, run
from benchmarks.limits.program import EMPTY, Job, Program, build_program
from benchmarks.measure import Bench
from benchmarks.workloads import Workload

PROCESSOR = "x86-64-v3"
"""AVX2 and fused operations, four numbers wide."""
TOOL = ["valgrind", "--tool=callgrind", "--combine-dumps=yes", "--collect-atstart=no"]
TOOL += ["--toggle-collect=counted", "--dump-after=counted"]


def why_not() -> str | None:
    """What is missing here, if anything."""
    return None if shutil.which("valgrind") else "valgrind is not on this machine"


def simulated(
    workload: Workload, bench: Bench, chosen: Sequence[tuple[Built, Job]], out: Path, tools: Tools
) -> list[float]:
    """Instructions per pose of contenders that are built anew for `PROCESSOR`."""
    out.mkdir(parents=True, exist_ok=True)
    tools = replace(tools, processor=PROCESSOR)
    built = [
        build_contender(one.contender, workload, index, out, tools) for index, (one, _) in enumerate(chosen)
    ]
    library = build_library(workload, built, out, tools)
    program = build_program(workload, bench, library, out, tools)
    jobs = [
        replace(job, symbol=(one.batch_symbol if job.mode == "batch" else one.single_symbol) or "")
        for one, (_, job) in zip(built, chosen, strict=True)
    ]
    return counts(program, jobs, out)


def counts(program: Program, jobs: Sequence[Job], out: Path) -> list[float]:
    """Instructions per pose of functions of a library that callgrind can execute."""
    found = out / f"{program.path.name}.callgrind"
    empty = [Job(EMPTY, mode) for mode in ("throughput", "batch")]
    run([*TOOL, f"--callgrind-out-file={found}", *program.command([*empty, *jobs])])
    totals = [float(total) for total in re.findall(r"^totals: (\d+)", found.read_text(), re.MULTILINE)]
    idle = dict(zip(("throughput", "batch"), totals, strict=False))
    own = totals[len(empty) : len(empty) + len(jobs)]
    return [(total - idle[job.mode]) / program.poses(job) for job, total in zip(jobs, own, strict=True)]
