"""``python -m benchmarks``: generate, compile, check, measure, report."""

from __future__ import annotations

import argparse
import importlib.metadata
import json
import os
import shutil
import sys
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from benchmarks import (
    every_robot,
    from_python,
    machine,
    pictures,
    report,
    scaling,
    summary,
    trajectories,
    workspaces,
)
from benchmarks.build import BuildError, Built, Tools, build_contender, build_library
from benchmarks.contender import Manifest, Missing
from benchmarks.limits import counts, tables
from benchmarks.measure import Bench, Row
from benchmarks.ours import c_contenders
from benchmarks.peers import PEER_PYTHON, PEERS, ROOT, generate
from benchmarks.workloads import WORKLOADS, Workload

PARTS = ("c", "limits", "python", "scaling", "robots", "workspaces", "trajectories")


def arguments(argv: Sequence[str] | None) -> argparse.Namespace:
    """The command line."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks", description=__doc__)
    parser.add_argument("--workloads", nargs="+", choices=list(WORKLOADS), default=list(WORKLOADS))
    parser.add_argument(
        "--only", choices=PARTS, nargs="+", default=PARTS, help="some parts; limits are those of c"
    )
    parser.add_argument("--rounds", type=int, default=3000, help="rounds in C (default %(default)s)")
    parser.add_argument(
        "--python-rounds", type=int, default=60, help="rounds in Python (default %(default)s)"
    )
    parser.add_argument("--out", type=Path, default=ROOT / "build" / "benchmarks")
    parser.add_argument("--page", type=Path, help="a page whose tables to replace, docs/performance.md say")
    parser.add_argument(
        "--robot-rounds", type=int, default=30, help="rounds of every robot (default %(default)s)"
    )
    parser.add_argument("--pictures", type=Path, help="a folder for pictures, docs/pictures say")
    parser.add_argument("--cc", default="gcc")
    parser.add_argument("--cxx", default="g++")
    parser.add_argument(
        "--peer-python", type=Path, default=PEER_PYTHON, help="interpreter with the peers' packages"
    )
    return parser.parse_args(argv)


def gather(keys: Sequence[str], out: Path, peer_python: Path) -> tuple[Manifest, list[Missing]]:
    """All peers' contenders for all workloads."""
    everything, missing = Manifest(), []
    for peer in PEERS:
        theirs = [key for key in keys if key in peer.workloads]
        if not theirs:
            continue
        print(f"generating: {peer.name}", file=sys.stderr)
        found = generate(peer, theirs, out / "generated", peer_python)
        if isinstance(found, Missing):
            missing.append(found)
        else:
            everything.contenders += found.contenders
            everything.versions |= found.versions
    return everything, missing


@dataclass(frozen=True)
class Prepared:
    """One workload's contenders, compiled, and who could not take part."""

    workload: Workload
    built: list[Built]
    missing: list[Missing]


def prepare_c(
    workload: Workload,
    manifest: Manifest,
    absent: list[Missing],
    options: argparse.Namespace,
    tools: Tools,
) -> Prepared:
    """Compiles every contender, on all cores; one that does not compile becomes missing."""
    out = options.out / "objects"
    out.mkdir(parents=True, exist_ok=True)
    contenders = [c for c in manifest.contenders if c.workload == workload.key]
    missing = list(absent)
    ours = c_contenders(workload, options.out / "generated")
    if isinstance(ours, Missing):
        missing.insert(0, ours)
    else:
        contenders = [*ours, *contenders]
    print(f"compiling: {workload.key}, {len(contenders)} contenders", file=sys.stderr)

    def build(index: int) -> Built | Missing:
        contender = contenders[index]
        try:
            return build_contender(contender, workload, index, out, tools)
        except BuildError as failure:
            return Missing(contender.label, f"does not build: {failure}")

    with ThreadPoolExecutor(os.cpu_count()) as pool:
        found = list(pool.map(build, range(len(contenders))))
    missing += [one for one in found if isinstance(one, Missing)]
    return Prepared(workload, [one for one in found if isinstance(one, Built)], missing)


def measure_c(
    prepared: Prepared, limits: counts.Limits, options: argparse.Namespace, tools: Tools
) -> report.Result:
    """One workload from compiled contenders to times, and to what was executed in them."""
    workload, out = prepared.workload, options.out / "objects"
    bench = Bench(workload, build_library(workload, prepared.built, out, tools))
    rows = [Row(b, bench.error(b), workload.tolerance) for b in prepared.built]
    print(f"measuring: {workload.key}", file=sys.stderr)
    overhead = bench.run([row for row in rows if row.correct], options.rounds)
    if limits.peaks is not None:
        print(f"counting: {workload.key}", file=sys.stderr)
        counts.count(limits, workload, bench, rows, out, tools)
    return report.Result(workload, rows, prepared.missing, overhead)


def main(argv: Sequence[str] | None = None) -> int:
    """Exit code 1 if any contender disagrees with the reference, 2 if a tool is missing."""
    options = arguments(argv)
    lacking = [tool for tool in (options.cc, options.cxx, "ld", "objcopy", "size") if not shutil.which(tool)]
    if lacking:
        print(f"benchmarks: not on this machine: {', '.join(lacking)}", file=sys.stderr)
        return 2
    tools = Tools(options.cc, options.cxx)
    options.out.mkdir(parents=True, exist_ok=True)
    facts = machine.describe(tools)
    load = os.getloadavg()[0]
    versions = {name: importlib.metadata.version(name) for name in ("numpy",)}
    workloads = [WORKLOADS[key] for key in options.workloads]
    python: list[from_python.PythonResult] = []
    manifest = Manifest()
    prepared: list[Prepared] = []
    # What takes all cores comes before this process keeps to one.
    if "c" in options.only:
        manifest, absent = gather(options.workloads, options.out, options.peer_python)
        prepared = [prepare_c(workload, manifest, absent, options, tools) for workload in workloads]
    points = []
    if "scaling" in options.only:
        print("scaling", file=sys.stderr)
        points = scaling.measure(options.python_rounds)
    machine.pin_to_one_core()
    limits = counts.Limits()
    if prepared and "limits" in options.only:
        limits.measure(facts["vector extension"], options.out / "objects", tools)
    results = [measure_c(one, limits, options, tools) for one in prepared]
    if "python" in options.only:
        for workload in (w for w in workloads if w.key in from_python.KEYS):
            print(f"from Python: {workload.key}", file=sys.stderr)
            folder = options.out / "generated" / "python"
            python.append(from_python.measure(workload, folder, tools, options.python_rounds))
    robots = []
    if "robots" in options.only:
        print("every robot", file=sys.stderr)
        robots = every_robot.measure(options.out / "objects", tools, options.robot_rounds)
    maps = []
    if "workspaces" in options.only:
        print("workspaces", file=sys.stderr)
        maps = workspaces.measure()
    paths = []
    if "trajectories" in options.only:
        print("trajectories", file=sys.stderr)
        paths = trajectories.measure()
    rows: list[Row | from_python.PythonRow] = [row for result in results for row in result.rows]
    rows += [row for result in python for row in result.rows]
    spreads = [series.spread for row in rows for series in row.series.values()]
    warnings = machine.noise_warnings(load, facts["virtual machine"] == "yes", max(spreads, default=0.0))
    data: dict[str, Any] = {
        "machine": facts,
        "versions": versions | manifest.versions,
        "warnings": warnings,
        "rows": report.as_json(results, python),
        "limits": limits.as_json(),
        "scaling": [point.as_json() for point in points],
        "every robot": [row.as_json() for row in robots],
        "workspaces": [row.as_json() for row in maps],
        "trajectories": [row.as_json() for row in paths],
    }
    sections = [*map(report.c_section, results), *map(report.python_section, python)]
    sections += [tables.section(limits.as_json())] if limits else []
    sections += summary.sections(data)
    sections += [workspaces.section(maps)] if maps else []
    sections += [trajectories.section(paths)] if paths else []
    text = report.document(facts, data["versions"], warnings, sections)
    print(text)
    (options.out / "results.md").write_text(text)
    (options.out / "results.json").write_text(json.dumps(data, indent=1, ensure_ascii=False) + "\n")
    if options.pictures is not None:
        for path in pictures.draw(data, options.pictures):
            print(f"wrote {path}", file=sys.stderr)
    if options.page is not None:
        summary.update(options.page, data)
    return 0 if all(row.correct for row in rows) else 1


if __name__ == "__main__":
    sys.exit(main())
