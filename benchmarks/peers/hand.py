"""The hand-written reference, ``hand.c``: a yardstick beside the generators, never counted as a peer."""

from __future__ import annotations

from pathlib import Path

from benchmarks.contender import HAND, Contender
from benchmarks.peers.driver import main
from benchmarks.workloads import Workload


def generate(workload: Workload, folder: Path) -> list[Contender]:
    """One function per workload, all in ``hand.c``."""
    arguments = ", ".join(array.name for array in (*workload.inputs, *workload.outputs))
    function = f"hand_{workload.key}"
    return [
        Contender(
            name=HAND,
            workload=workload.key,
            variant="loop over legs",
            glue=f"{workload.prototype(function)};\n{workload.prototype()} {{ {function}({arguments}); }}\n",
            sources=(str(Path(__file__).resolve().parent / "hand.c"),),
        )
    ]


if __name__ == "__main__":
    main(generate, ())
