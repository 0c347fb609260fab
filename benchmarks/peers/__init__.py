"""The peers, each in a process of its own: they need packages that may live in different environments."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from benchmarks.contender import HAND, Manifest, Missing

ROOT = Path(__file__).resolve().parents[2]
PEER_PYTHON = ROOT / ".venv-bench" / "bin" / "python"


STRAIGHT = ("w1", "w2", "w5")
"""Workloads without iterations: formulas that any generator takes."""


@dataclass(frozen=True)
class Peer:
    """A rival: its name in the tables, the module here that drives it, the package that this module
    imports, and the workloads that it takes part in."""

    name: str
    module: str
    package: str | None
    workloads: tuple[str, ...] = STRAIGHT


PEERS = (
    Peer(HAND, "hand", None),
    Peer("SymPy", "sympy_c", "sympy"),
    Peer("CasADi", "casadi_c", "casadi", (*STRAIGHT, "w4")),
    Peer("SymForce", "symforce_cpp", "symforce"),
    Peer("wrenfold", "wrenfold_cpp", "wrenfold"),
    Peer("GSL", "gsl_c", None, ("w3",)),
    Peer("Pinocchio", "pinocchio_cpp", "pinocchio", ("w1", "w2")),
    Peer("MuJoCo", "mujoco_c", "mujoco", ("w1", "w2")),
)


def interpreter_with(package: str | None, candidates: Sequence[Path]) -> Path | None:
    """The first interpreter that can import ``package``."""
    for python in candidates:
        if package is None:
            return python
        command = [str(python), "-c", f"import {package}"]
        if python.exists() and subprocess.run(command, capture_output=True, check=False).returncode == 0:
            return python
    return None


def generate(peer: Peer, workloads: Sequence[str], out: Path, peer_python: Path) -> Manifest | Missing:
    """Runs one peer's generator; what went wrong is returned, not raised."""
    python = interpreter_with(peer.package, (Path(sys.executable), peer_python))
    if python is None:
        shown = peer_python.relative_to(ROOT) if peer_python.is_relative_to(ROOT) else peer_python
        return Missing(peer.name, f"package {peer.package!r} neither in this environment nor in {shown}")
    folder = out / peer.module
    folder.mkdir(parents=True, exist_ok=True)
    command = [str(python), "-m", f"benchmarks.peers.{peer.module}", str(folder), *workloads]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        lines = done.stderr.strip().splitlines() or ["no message"]
        return Missing(peer.name, f"generator failed: {lines[-1]}")
    return Manifest.read(folder / "manifest.json")
