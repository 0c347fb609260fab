"""MuJoCo's library, as its publishers built it, for the closed-loop model."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import mujoco

from benchmarks.contender import Contender
from benchmarks.peers import closed_loop
from benchmarks.peers.driver import main, stopwatch
from benchmarks.robot import L2, L3, L_REDUNDANT, LEGS
from benchmarks.workloads import Workload

PACKAGE = Path(mujoco.__file__).parent
VARIANTS = {
    "w1": {"Jacobians of sites": "mujoco_chains_w1", "constraints": "mujoco_loops_w1"},
    "w2": {"Newton, Jacobians of sites": "mujoco_w2"},
}
MASS = '<inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/>'
"""Whatever moves must weigh something; nothing that is compared depends on it."""


def model(*, loops: bool) -> str:
    """The chains alone, or all bodies with spherical joints as `connect` constraints, in MuJoCo's format."""
    bodies = "\n".join(_chain(i) for i in range(len(LEGS)))
    constraints = ""
    if loops:
        links = "\n".join(_link(i) for i in range(len(LEGS)))
        bodies += f'\n<body name="platform"><freejoint/>{MASS}\n{links}\n</body>'
        pairs = (f'<connect site1="S{i}" site2="link{i}"/>' for i in range(len(LEGS)))
        constraints = f"<equality>{''.join(pairs)}</equality>"
    return f"""<mujoco>
<option jacobian="dense"/>
<compiler angle="radian"/>
<worldbody>
{bodies}
</worldbody>
{constraints}
</mujoco>
"""


def _chain(i: int) -> str:
    leg = LEGS[i]
    hinge = f'<joint type="hinge" axis="0 0 1"/>{MASS}'
    base = _numbers([*leg.e_x, *(-x for x in leg.e_t)])
    return (
        f'<body pos="{_numbers(leg.c)}" xyaxes="{base}">{hinge}'
        f'<body xyaxes="1 0 0 0 0 1">{hinge}'
        f'<body pos="{_numbers([L2, 0, 0])}">{hinge}'
        f'<site name="S{i}" pos="{_numbers([L3, 0, 0])}"/></body></body></body>'
    )


def _link(i: int) -> str:
    (x, y), (a, b) = closed_loop.corners()[i], closed_loop.starts()[i]
    return (
        f'<body pos="{_numbers([x, y, 0])}" xyaxes="{_numbers([a, b, 0, -b, a, 0])}">'
        f'<joint type="hinge" axis="0 0 1"/>{MASS}'
        f'<site name="link{i}" pos="{_numbers([L_REDUNDANT, 0, 0])}"/></body>'
    )


def _numbers(values: Sequence[float]) -> str:
    return " ".join(repr(float(value)) for value in values)


def generate(workload: Workload, folder: Path) -> list[Contender]:
    """The chains' Jacobians, and the constraints of the whole."""
    (library,) = PACKAGE.glob("libmujoco.so*")
    paths = {name: folder / f"{name}.xml" for name in ("chains", "loops")}
    with stopwatch() as watch:
        for name, path in paths.items():
            path.write_text(model(loops=name == "loops"))
        (folder / "geometry.h").write_text(closed_loop.header())
    arguments = ", ".join(array.name for array in (*workload.inputs, *workload.outputs))
    models = "".join(f'#define MODEL_{name.upper()} "{path}"\n' for name, path in paths.items())
    return [
        Contender(
            name="MuJoCo",
            workload=workload.key,
            variant=variant,
            glue=f'{models}#include "mujoco.c"\n{workload.prototype()} {{ {function}({arguments}); }}\n',
            include_dirs=(str(PACKAGE / "include"), str(folder), str(closed_loop.FOLDER)),
            libraries=(str(library), f"-Wl,-rpath,{library.parent}"),
            self_contained=False,
            generate_seconds=watch.seconds,
        )
        for variant, function in VARIANTS[workload.key].items()
    ]


if __name__ == "__main__":
    main(generate, ("mujoco",))
