"""What `krhpr study grasp-control` does: simulate the three schemes, print, write."""

from __future__ import annotations

import argparse
import csv
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from krhpr.cli.common import Column, WrongUse, print_table
from krhpr.cli.studying import tell, write
from krhpr.errors import ControlError
from krhpr.study.grasp import PROTOTYPE

if TYPE_CHECKING:
    from krhpr.control.simulation import Trace
    from krhpr.study.grasp_control import GraspControl

EVERY = 5
"""Rows of a trace for one in its CSV file."""


def run(options: argparse.Namespace) -> int:
    """The study of grasping force control."""
    try:
        from krhpr.control.parameters import PROTOTYPE as CONTROL
        from krhpr.study.grasp_control import CONTROLLERS, grasp_control
    except ModuleNotFoundError as error:
        if error.name != "casadi":
            raise
        raise ModuleNotFoundError(
            "the simulated robot needs CasADi: pip install 'krhpr[casadi]'", name="casadi"
        ) from None
    setup, control = PROTOTYPE, CONTROL
    if options.file is not None:
        from krhpr.study.grasp_file import read_grasp_file  # takes the extra `files`

        setup = read_grasp_file(options.file)
    if options.control is not None:
        from krhpr.control.parameter_file import read_control_file

        control = read_control_file(options.control)
    try:
        found = grasp_control(setup, control, CONTROLLERS[options.controller])
    except ControlError as error:
        raise WrongUse(str(error)) from error
    from krhpr.study.grasp_control_figures import grasp_control_figures

    traces = _traces(found)
    paths = write(options.out, "grasp_control", _facts(found), lambda: grasp_control_figures(found))
    paths += [
        _write_trace(options.out / f"grasp_control_{name}.csv", trace) for name, trace in traces.items()
    ]
    _print(found)
    code = tell(found.claims())
    print(", ".join(map(str, paths)))
    return code


def _traces(found: GraspControl) -> dict[str, Trace]:
    names = {"i": found.position.trace, "ii": found.feedforward.trace, "iii_step": found.step}
    return names | {f"iii_{number}": one.trace for number, one in enumerate(found.along, start=1)}


def _facts(found: GraspControl) -> dict[str, Any]:
    line = found.position.line
    return {
        "rate_Hz": found.control.rate,
        "mass_of_an_actuator_kg": found.control.mass(found.setup.drive),
        "scheme_i": {
            "angle_error_rad": found.position.inputs.tolist(),
            "grasp_N": found.position.forces.tolist(),
            "grasp_without_friction_N": found.easy_position.forces.tolist(),
            "slope_N_per_rad": line.slope,
            "closed_form_N_per_rad": found.expected_slope,
            "slope_without_friction_N_per_rad": found.easy_position.line.slope,
            "closed_form_without_friction_N_per_rad": found.grip.stiffness(),
        },
        "scheme_ii": {
            "wanted_N": found.feedforward.inputs.tolist(),
            "grasp_N": found.feedforward.forces.tolist(),
            "grasp_without_friction_N": found.easy_feedforward.forces.tolist(),
        },
        "scheme_iii": {
            "settling_s": found.settling,
            "error_after_the_step_N": found.step_error,
            "trajectories": [
                {
                    "name": one.motion.name,
                    "rms_error_N": float(np.sqrt((one.error**2).mean())),
                    "largest_error_N": float(np.abs(one.error).max()),
                    "largest_position_error_m": one.position_error,
                    "friction_needed": one.friction_needed,
                }
                for one in found.along
            ],
        },
    }


def _print(found: GraspControl) -> None:
    aim = found.setup.force
    columns = [Column("run", whole=True)]
    columns += [
        Column(title, numeric=True) for title in ("input", "wanted (N)", "grasp (N)", "without friction (N)")
    ]
    rows = [
        (
            "i: position",
            f"{np.degrees(angle):.3f} deg",
            "-",
            f"{force:.3f}",
            f"{easy:.3f}",
        )
        for angle, force, easy in zip(
            found.position.inputs, found.position.forces, found.easy_position.forces, strict=True
        )
    ]
    rows += [
        ("ii: static model", "-", f"{wanted:.3f}", f"{force:.3f}", f"{easy:.3f}")
        for wanted, force, easy in zip(
            found.feedforward.inputs, found.feedforward.forces, found.easy_feedforward.forces, strict=True
        )
    ]
    rows.append(("iii: step", "-", f"{aim:.3f}", f"{aim + found.step_error:.3f}", "-"))
    for one in found.along:
        force = one.trace.seen.grasp_force[one.moving]
        rows.append(
            (f"iii: {one.motion.name}", "-", f"{aim:.3f}", f"{force.min():.3f} to {force.max():.3f}", "-")
        )
    print_table(columns, rows)
    line = found.position.line
    print(
        f"scheme i: {line.slope:.1f} N/rad, closed form {found.expected_slope:.1f}; without friction "
        f"{found.easy_position.line.slope:.1f}, closed form {found.grip.stiffness():.1f}"
    )
    print(f"scheme iii: the step settles within 5 % after {1e3 * found.settling:.0f} ms")


def _write_trace(path: Path, trace: Trace) -> Path:
    """One row for every few steps of the controller."""
    head = ["time_s", "wanted_N", "measured_N", "grasp_N", "right_N", "left_N"]
    head += [f"rho_{k}_m" for k in range(1, 5)] + [f"torque_{k}_Nm" for k in range(1, 5)]
    table = np.column_stack(
        [
            trace.times,
            trace.wanted_force,
            trace.measured_force,
            trace.seen.grasp_force,
            trace.seen.normal_forces,
            trace.theta,
            trace.torques,
        ]
    )
    with path.open("w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(head)
        writer.writerows([f"{value:.9g}" for value in row] for row in table[::EVERY])
    return path
