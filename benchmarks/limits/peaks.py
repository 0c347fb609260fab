"""What this processor does at most, measured: operations, vector instructions, divisions, all instructions.

Straight code in registers, without dependences that matter: nothing is faster, whatever the algorithm.
"""

from __future__ import annotations

import ctypes
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from benchmarks.build import Tools, run
from benchmarks.harness import CLOCK
from benchmarks.limits.mix import WIDTHS

CHAINS = 12
"""Independent chains: more than an addition or a multiplication is long, times two units."""
REPEATED = 4
"""How often a loop has each of them."""
NOTHING = "nopl 0(%%rax)"
"""Of four bytes, like most instructions: shorter ones are too many for the caches of decoded instructions."""
SAMPLES = 200
CALLS = 4000  # turns of a loop in a sample


@dataclass(frozen=True)
class Peaks:
    """Rates per nanosecond, by the width of the registers in bits."""

    flops: float
    """Floating-point operations: fused multiplications and additions in the widest registers."""
    vector: dict[int, float]
    """Vector instructions: half of them fused multiplications, a quarter logic, a quarter shuffles."""
    divides: dict[int, float]
    roots: dict[int, float]
    instructions: float
    """Instructions that nobody has to execute: what the front end delivers and retires."""

    def as_json(self) -> dict[str, Any]:
        """For results.json."""
        return asdict(self)


def registers(vectors: str) -> tuple[str, ...]:
    """The kinds of registers, the widest first, by the processor's widest extension; none below AVX2."""
    return {"avx512f": ("zmm", "ymm", "xmm"), "avx2": ("ymm", "xmm")}.get(vectors, ())


def measure_peaks(vectors: str, out: Path, tools: Tools) -> Peaks | None:
    """None where the processor has no fused operations, of which everything here is made."""
    names = registers(vectors)
    if not names:
        return None
    out.mkdir(parents=True, exist_ok=True)
    source, library = out / "peaks.c", out / "peaks.so"
    source.write_text(_source(names))
    run([tools.cc, "-O2", "-march=native", "-fPIC", "-shared", str(source), "-o", str(library)])
    loops = ctypes.CDLL(str(library))
    for name in (*(f"{kind}_{register}" for kind in _BODIES for register in names), "issue"):
        getattr(loops, name).restype = ctypes.c_double

    def rate(loop: str, each: int) -> float:
        function = getattr(loops, loop)
        return each * CALLS / min(float(function(ctypes.c_long(CALLS))) for _ in range(SAMPLES))

    def rates(kind: str, each: int) -> dict[int, float]:
        return {WIDTHS[name]: rate(f"{kind}_{name}", each) for name in names}

    many = CHAINS * REPEATED
    widest = WIDTHS[names[0]]
    return Peaks(
        flops=2 * (widest // 64) * rate(f"fma_{names[0]}", many),
        vector=rates("vector", many),
        divides=rates("divide", CHAINS),
        roots=rates("root", CHAINS),
        instructions=rate("issue", many),
    )


def _fma(register: str, k: int) -> str:
    return f"vfmadd231pd %%{register}15, %%{register}14, %%{register}{k}"


def _vector(register: str, k: int) -> str:
    """Two fused operations, then logic, then a shuffle: what sines and transposes are made of."""
    if k % 4 < 2:
        return _fma(register, k)
    if k % 4 == 2:
        logic = "vpxorq" if register == "zmm" else "vpxor"
        return f"{logic} %%{register}15, %%{register}{k}, %%{register}{k}"
    return f"vshufpd $0, %%{register}{k}, %%{register}{k}, %%{register}{k}"


def _divide(register: str, k: int) -> str:
    return f"vdivpd %%{register}14, %%{register}15, %%{register}{k}"


def _root(register: str, k: int) -> str:
    return f"vsqrtpd %%{register}14, %%{register}{k}"


_BODIES = {"fma": (_fma, REPEATED), "vector": (_vector, REPEATED), "divide": (_divide, 1), "root": (_root, 1)}


def _source(names: tuple[str, ...]) -> str:
    loops = [
        _loop(f"{kind}_{name}", [body(name, k) for _ in range(times) for k in range(CHAINS)])
        for kind, (body, times) in _BODIES.items()
        for name in names
    ]
    loops.append(_loop("issue", [NOTHING] * (CHAINS * REPEATED)))
    return "\n".join(["#include <time.h>", CLOCK, *loops])


def _loop(name: str, lines: list[str]) -> str:
    """Registers 14 and 15 hold ones: nothing grows, and nothing gets slow for being tiny."""
    body = "\\n\\t".join(lines)
    clobbers = ", ".join(f'"xmm{k}"' for k in range(16))
    ones = "vbroadcastsd %1, %%{0}14\\n\\tvbroadcastsd %1, %%{0}15".format(
        "ymm" if not name.endswith("zmm") else "zmm"
    )
    return f"""double {name}(long turns) {{
    static const double one = 1.0;
    const double start = now_ns();
    __asm__ volatile("{ones}\\n"
        "1:\\n\\t{body}\\n\\tdec %0\\n\\tjnz 1b\\n\\tvzeroupper"
        : "+r"(turns) : "m"(one) : "cc", {clobbers});
    return now_ns() - start;
}}
"""
