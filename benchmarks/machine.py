"""Where the figures were measured: processor, compilers, versions, and what may disturb them."""

from __future__ import annotations

import os
import platform
import subprocess
from pathlib import Path

from benchmarks.build import SPEED_FLAGS, Tools


def first_line(command: list[str]) -> str:
    """First line that a command prints, or the reason why there is none."""
    try:
        return subprocess.run(command, capture_output=True, text=True, check=True).stdout.splitlines()[0]
    except (OSError, subprocess.CalledProcessError, IndexError) as failure:
        return f"unknown ({type(failure).__name__})"


def cpu_info() -> tuple[str, str, bool]:
    """Model, the widest vector extension, and whether a hypervisor is below."""
    path = Path("/proc/cpuinfo")
    if not path.exists():
        return platform.processor() or platform.machine(), "unknown", False
    fields: dict[str, str] = {}
    for line in path.read_text().splitlines():
        key, _, value = line.partition(":")
        fields.setdefault(key.strip(), value.strip())
    flags = fields.get("flags", fields.get("Features", "")).split()
    widest = next(
        (name for name in ("avx512f", "avx2", "avx", "sse2", "sve", "asimd") if name in flags), "unknown"
    )
    identity = ", ".join(
        f"{key} {fields[name]}"
        for key, name in (("family", "cpu family"), ("model", "model"))
        if fields.get(name)
    )
    return f"{fields.get('model name', platform.machine())} ({identity})", widest, "hypervisor" in flags


def describe(tools: Tools) -> dict[str, str]:
    """All that the tables state about the machine."""
    model, vectors, virtual = cpu_info()
    return {
        "processor": model,
        "vector extension": vectors,
        "cores": str(os.cpu_count()),
        "virtual machine": "yes" if virtual else "no",
        "system": f"{platform.system()} {platform.release()} {platform.machine()}",
        "libc": " ".join(platform.libc_ver()),
        "C compiler": first_line([tools.cc, "--version"]),
        "C++ compiler": first_line([tools.cxx, "--version"]),
        "flags of all": " ".join(SPEED_FLAGS),
        "Python": platform.python_version(),
    }


def pin_to_one_core() -> int | None:
    """Keeps this process on the last core that it may use; None where the system does not offer that."""
    if not hasattr(os, "sched_setaffinity"):
        return None
    core = max(os.sched_getaffinity(0))
    os.sched_setaffinity(0, {core})
    return core


def noise_warnings(load_before: float, virtual: bool, worst_spread: float) -> list[str]:
    """What a reader must know before trusting a small difference."""
    warnings = []
    if virtual:
        warnings.append("virtual machine: other guests share its caches, ports and clock")
    if load_before > 0.5:
        warnings.append(f"load average {load_before:.1f} when measuring began: other processes were running")
    if worst_spread > 0.05:
        warnings.append(
            f"interquartile range up to {100 * worst_spread:.0f} % of the median: "
            "smaller differences mean nothing"
        )
    return warnings
