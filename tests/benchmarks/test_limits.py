"""What the benchmark says of instructions and limits: what counts as what; two ways to count agree."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest

from benchmarks.build import Tools, build_contender, build_library
from benchmarks.contender import Contender
from benchmarks.limits import callgrind, executed
from benchmarks.limits.bound import bounds
from benchmarks.limits.mix import Mix, mix_of
from benchmarks.limits.peaks import Peaks
from benchmarks.limits.program import EMPTY, Job, build_program
from benchmarks.limits.tables import page, section
from benchmarks.measure import Bench
from benchmarks.peers import ROOT
from benchmarks.workloads import WORKLOADS

PEAKS = Peaks(
    flops=32.0,
    vector={512: 2.0, 256: 3.0, 128: 3.0},
    divides={512: 0.1, 256: 0.2, 128: 0.4},
    roots={512: 0.1, 256: 0.2, 128: 0.4},
    instructions=5.0,
)


@pytest.mark.parametrize(
    ("mnemonic", "operands", "flops", "width"),
    [
        ("vfmadd231pd", "zmm0, zmm1, zmmword ptr [rax]", 16, 512),
        ("vfnmadd132sd", "xmm0, xmm1, xmm2", 2, 128),
        ("vaddpd", "ymm0, ymm1, ymm2", 4, 256),
        ("vmulps", "ymm0, ymm1, ymm2", 8, 256),
        ("subsd", "xmm0, qword ptr [rip]", 1, 128),
        ("vsqrtpd", "zmm0 {k1} {z}, zmm1", 8, 512),
        ("vpxorq", "zmm0, zmm1, zmm2", 0, 512),
        ("vpermpd", "zmm0, zmm1, zmm2", 0, 512),
        ("vcmpltpd", "k1, zmm0, zmm1", 0, 512),
        ("vmovq", "rax, xmm0", 0, None),
        ("vmovapd", "zmm0, zmmword ptr [rsp]", 0, None),
        ("vbroadcastsd", "zmm0, qword ptr [rip + 8]", 0, None),
        ("vbroadcastsd", "zmm0, xmm1", 0, 512),
        ("vmovmskpd", "eax, ymm0", 0, 256),
        ("add", "rax, 8", 0, None),
        ("call", "qword ptr [rip]", 0, None),
    ],
)
def test_what_an_instruction_counts_as(mnemonic: str, operands: str, flops: float, width: int | None) -> None:
    found = mix_of([(mnemonic, operands, 3)])
    assert (found.instructions, found.flops) == (3, 3 * flops)
    assert dict(found.vector) == ({} if width is None else {width: 3})


def test_divisions_and_roots_are_both_vector_and_divider_work() -> None:
    found = mix_of([("vdivpd", "ymm0, ymm1, ymm2", 2), ("sqrtsd", "xmm0, xmm0", 1)])
    assert (dict(found.divides), dict(found.roots), dict(found.vector)) == (
        {256: 2},
        {128: 1},
        {256: 2, 128: 1},
    )
    assert found.flops == 9


def test_a_mix_less_another_per_pose() -> None:
    both = mix_of([("vaddpd", "ymm0, ymm1, ymm2", 20), ("ret", "", 4)])
    loop = mix_of([("ret", "", 2)])
    found = both.less(loop).scaled(0.5)
    assert (found.instructions, found.flops, found.vector[256]) == (11, 40, 10)


@pytest.mark.parametrize(
    ("mix", "least", "busiest"),
    [
        (mix_of([("vaddpd", "zmm0, zmm1, zmm2", 100)]), 50, "vector unit"),
        (mix_of([("vdivpd", "zmm0, zmm1, zmm2", 100)]), 1000, "divider"),
        (mix_of([("vaddpd", "zmm0, zmm1, zmm2", 10), ("lea", "rax, [rax]", 90)]), 20, "front end"),
    ],
)
def test_whoever_is_busy_longest_is_the_limit(mix: Mix, least: float, busiest: str) -> None:
    found = bounds(mix, PEAKS)
    assert (found.ports, found.busiest) == (pytest.approx(least), busiest)
    assert found.operations == mix.flops / PEAKS.flops


def test_single_steps_and_callgrind_count_the_same(tmp_path: Path) -> None:
    """Of code that both know, which calls the C library."""
    lacking = [tool for tool in ("gcc", "g++", "ld", "objcopy", "valgrind") if shutil.which(tool) is None]
    if lacking or executed.system() != executed.SYSTEM:
        pytest.skip(f"takes {executed.SYSTEM} with gcc, g++, binutils and valgrind; not here: {lacking}")
    workload, tools = WORKLOADS["w1"], Tools(processor=callgrind.PROCESSOR)
    arguments = ", ".join(array.name for array in (*workload.inputs, *workload.outputs))
    contender = Contender(
        "hand",
        "w1",
        "",
        f"{workload.prototype('hand_w1')};\n{workload.prototype()} {{ hand_w1({arguments}); }}\n",
        sources=(str(ROOT / "benchmarks" / "peers" / "hand.c"),),
    )
    built = build_contender(contender, workload, 0, tmp_path, tools)
    bench = Bench(workload, build_library(workload, [built], tmp_path, tools))
    program = build_program(workload, bench, bench.path, tmp_path, tools)
    jobs = [Job(EMPTY, "throughput"), Job(str(built.single_symbol), "throughput")]
    try:
        idle, busy = executed.traced(program, jobs, tmp_path, tools)
    except RuntimeError as refused:
        pytest.skip(f"no single steps here: {refused}")
    stepped = (sum(times for _, times in busy) - sum(times for _, times in idle)) / program.poses(jobs[1])
    (simulated,) = callgrind.counts(program, jobs[1:], tmp_path)
    assert stepped == pytest.approx(simulated, rel=0.02)


def test_tables_show_what_was_counted_and_what_could_not_be() -> None:
    row = {
        "workload": "w1",
        "contender": "krhpr",
        "variant": "poses in lanes",
        "mode": "batch",
        "layout": "blocked8",
        "ns": 20.0,
        "instructions": 142.0,
        "flops": 761.0,
        "callgrind": None,
        "least_ns": bounds(mix_of([("vaddpd", "zmm0, zmm1, zmm2", 20)]), PEAKS).as_json(),
        "share_of_ports": 0.5,
        "share_of_operations": 0.25,
    }
    slower = row | {"ns": 30.0, "variant": "slower"}
    limits = {"peaks": PEAKS.as_json(), "rows": [slower, row], "notes": []}
    assert (
        "W1, batch, blocks of eight | krhpr, poses in lanes | 20 | 761 | 142 |  | 50 % | vector unit"
        in section(limits)
    )
    assert "slower" in section(limits)
    assert "slower" not in page({"limits": limits})
    assert "no valgrind" in section({"peaks": None, "rows": [], "notes": ["no valgrind"]})
