"""What `krhpr study grasp` does: hold the object, print, write."""

from __future__ import annotations

import argparse
import json
from pathlib import Path

import numpy as np

from krhpr.cli.common import Column, Exit, print_table
from krhpr.study.grasp import PROTOTYPE, Along, GraspStudy, grasp_study
from krhpr.study.grasp_picture import save_picture


def run(options: argparse.Namespace) -> int:
    """The grasp study."""
    setup = PROTOTYPE
    if options.file is not None:
        from krhpr.study.grasp_file import read_grasp_file  # takes the extra `files`

        setup = read_grasp_file(options.file)
    found = grasp_study(setup)
    written = _write(found, options.out)
    _print(found)
    claims = found.claims()
    for text, holds in claims:
        print(f"{'holds' if holds else 'DOES NOT HOLD'}: {text}")
    for one in found.along:
        if one.trouble:
            print(f"no answer for {one.motion.name}, {one.weight:g} N: {one.trouble}")
    print(
        f"an angle error of the jaws grasps with k = {1e3 * found.stiffness:.4g} N/rad for each N/mm of "
        "stiffness of the actuators, (5.72)"
    )
    print(", ".join(map(str, written)))
    return Exit.OK if all(holds for _, holds in claims) else Exit.DIFFERENCE


def _print(found: GraspStudy) -> None:
    columns = [Column("trajectory", whole=True)]
    columns += [
        Column(title, numeric=True)
        for title in ("weight (N)", "|f| (N)", "motor torque (mN m)", "links (N)", "pivot (N)", "friction")
    ]
    print_table(columns, [_row(one) for one in found.along])


def _row(one: Along) -> tuple[str, ...]:
    least, most = np.abs(one.forces).min(), np.abs(one.forces).max()
    return (
        one.motion.name,
        f"{one.weight:g}",
        f"{least:.4f} to {most:.4f}",
        f"{1e3 * np.abs(one.torques).max():.4f}",
        f"{np.abs(one.links).max():.3f}",
        f"{one.pin.max():.3f}",
        f"{one.slip.max():.3f}",
    )


def _write(found: GraspStudy, folder: Path) -> list[Path]:
    """The numbers, and their picture where it can be drawn."""
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / "grasp.json"
    rows = [
        {
            "trajectory": one.motion.name,
            "weight_N": one.weight,
            "time_s": one.times.tolist(),
            "rho_m": one.theta.reshape(-1, 4).tolist(),
            "forces_N": one.forces.reshape(-1, 4).tolist(),
            "torques_Nm": one.torques.reshape(-1, 4).tolist(),
        }
        for one in found.along
    ]
    path.write_text(json.dumps({"grasp_N": found.setup.force, "trajectories": rows}) + "\n", "utf-8")
    try:
        return [path, save_picture(found, folder / "grasp.png")]
    except ImportError:
        print('no picture: matplotlib is not installed (pip install "krhpr[plot]")')
        return [path]
