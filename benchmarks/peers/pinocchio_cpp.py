"""Pinocchio's templates for the closed-loop model, compiled for this processor like everything else."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import pinocchio

from benchmarks.contender import Contender
from benchmarks.peers import closed_loop
from benchmarks.peers.driver import main
from benchmarks.workloads import Workload

PREFIX = next(folder for folder in Path(pinocchio.__file__).parents if folder.name == "cmeel.prefix")
INCLUDE = PREFIX / "include"
FLAGS = ("-std=c++17", "-DNDEBUG")
ONE_BY_ONE = "-DEIGEN_DONT_VECTORIZE"
"""Vectors of three and six numbers fill no register of eight: Eigen may be quicker without."""


@dataclass(frozen=True)
class Variant:
    """A way to compute a workload with the library, and flags of its own."""

    workload: str
    name: str
    file: str
    function: str
    flags: tuple[str, ...] = ()


CHAINS, LOOPS = "pinocchio_chains.cc", "pinocchio_loops.cc"
VARIANTS = (
    Variant("w1", "Jacobians of frames", CHAINS, "pinocchio_chains_w1"),
    Variant("w1", "Jacobians of frames, scalar", CHAINS, "pinocchio_chains_w1", (ONE_BY_ONE,)),
    Variant("w1", "constraints, scalar", LOOPS, "pinocchio_loops_w1", (ONE_BY_ONE,)),
    Variant("w2", "Newton, Jacobians of frames", CHAINS, "pinocchio_w2"),
    Variant("w2", "Newton, Jacobians of frames, scalar", CHAINS, "pinocchio_w2", (ONE_BY_ONE,)),
)
NEEDED = {
    "BOOST_MPL_LIMIT_LIST_SIZE": 30,
    "BOOST_MPL_LIMIT_VECTOR_SIZE": 30,
    "BOOST_MPL_CFG_NO_PREPROCESSED_HEADERS": 1,
    "BOOST_FUSION_INVOKE_MAX_ARITY": 12,
}
"""What Pinocchio's build files define for its users: it has more kinds of joints than Boost's lists take."""


def generate(workload: Workload, folder: Path) -> list[Contender]:
    """The chains' Jacobians, and the constraints of the whole."""
    (folder / "geometry.h").write_text(closed_loop.header())
    arguments = ", ".join(array.name for array in (*workload.inputs, *workload.outputs))
    defines = "".join(f"#define {name} {value}\n" for name, value in NEEDED.items())
    return [
        Contender(
            name="Pinocchio",
            workload=workload.key,
            variant=variant.name,
            glue=f'{defines}#include "{variant.file}"\n'
            f'extern "C" {workload.prototype()} {{ {variant.function}({arguments}); }}\n',
            glue_language="c++",
            include_dirs=tuple(map(str, (INCLUDE, INCLUDE / "eigen3", folder, closed_loop.FOLDER))),
            extra_flags=(*FLAGS, *variant.flags),
        )
        for variant in VARIANTS
        if variant.workload == workload.key
    ]


if __name__ == "__main__":
    main(generate, ("pin", "cmeel-eigen"))
