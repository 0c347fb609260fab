"""Results as files: NPZ with all arrays and settings, CSV for people and spreadsheets, and ROS joint
trajectories.

`save` writes them, `load_result` reads the NPZ without pickle; everything is SI.
"""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass
from pathlib import Path as File
from typing import Any

import numpy as np
from numpy.typing import NDArray

from krhpr import __version__
from krhpr.errors import KrhprError
from krhpr.trajectory.examine import Violation
from krhpr.trajectory.optimise import Trajectory

Floats = NDArray[np.float64]

FORMAT = 1
"""Of the NPZ files; a change that old readers would misread raises it."""
UNITS = {
    "times": "s",
    "p": "m",
    "Q": "1, or rad for phi in the plane",
    "twist": "m/s, rad/s",
    "redundant": "rad or m",
    "redundant_rate": "rad/s or m/s",
    "theta": "rad or m",
    "theta_rate": "rad/s or m/s",
    "eta_1": "m",
    "eta_2": "1",
    "eta_3": "1",
}
"""Arrays of a result and their units; the first axis is time."""
OF_GRIP = {"opening": "m", "centre": "m"}
"""Arrays that are there as well where the gripper keeps an opening: it, and the object's centre (n, 2) from
O' in the platform's plane.
"""
OF_SWIVELS = {"swivel": "rad"}
"""Arrays that are there as well where swivels of redundant sub-legs were chosen."""
LATER = {"theta_acceleration": "rad/s^2 or m/s^2"}
"""Arrays that the first files of this format did not have."""


class ResultError(KrhprError, ValueError):
    """A file that holds no result, or one of another version."""


@dataclass(frozen=True)
class Result:
    """A result out of a file."""

    arrays: dict[str, Floats]
    """By name, with the units that `about["units"]` has."""
    about: dict[str, Any]
    """Robot, path, method, objective, limits, integrals, whether all limits are met, violations, settings."""

    @property
    def feasible(self) -> bool:
        """Whether all limits are met."""
        return bool(self.about["feasible"])

    @property
    def violations(self) -> tuple[Violation, ...]:
        """Limits that are not met, the worst first."""
        return tuple(Violation(**one) for one in self.about["violations"])


def arrays_of(found: Trajectory) -> dict[str, Floats]:
    """The arrays of a trajectory by name."""
    examined, motion = found.examined, found.examined.motion
    return {
        "times": motion.times,
        "p": motion.p,
        "Q": motion.Q,
        "twist": motion.twist,
        "redundant": examined.redundant,
        "redundant_rate": examined.redundant_rate,
        "theta": examined.theta,
        "theta_rate": examined.theta_rate,
        "theta_acceleration": examined.theta_acceleration,
        **examined.indices,
        **({} if examined.swivel is None else {"swivel": examined.swivel}),
        **_of_grip(found),
    }


def _of_grip(found: Trajectory) -> dict[str, Floats]:
    """The opening that is kept, and where the object is."""
    if (grip := found.bounds.grip) is None:
        return {}
    held = found.robot.opening(found.redundant, grip.jaws)
    return {"opening": np.asarray(held.opening), "centre": np.asarray(held.centre)}


def about(found: Trajectory) -> dict[str, Any]:
    """What was asked for and what came of it, as values that JSON can hold."""
    bounds = {name: value for name, value in vars(found.bounds).items() if value is not None}
    bounds["redundant"] = [side.tolist() for side in found.bounds.box()]
    bounds["factors"] = dict(found.bounds.factors)
    if found.bounds.swivel is not None:
        bounds["swivel"] = [np.broadcast_to(side, (3,)).tolist() for side in found.bounds.swivel]
    if (grip := found.bounds.grip) is not None:
        bounds["grip"] = {**asdict(grip), "jaws": np.broadcast_to(grip.jaws, 3).tolist()}
    return {
        "format": FORMAT,
        "krhpr": __version__,
        "robot": found.robot.name,
        "identifier": found.robot.identifier,
        "geometry": {
            name: np.asarray(getattr(found.robot.geometry, name)).tolist() for name in _fields(found)
        },
        "path": found.path.name,
        "method": str(found.method),
        "objective": asdict(found.objective),
        "limits": bounds,
        "feasible": found.feasible,
        "violations": [asdict(one) for one in found.violations],
        "integrals": found.integrals,
        "maxima": found.maxima,
        "objective_value": found.examined.objective,
        "seconds": found.seconds,
        "iterations": found.iterations,
        "rounds": found.rounds,
        "message": found.message,
        "units": {**UNITS, **LATER, **OF_SWIVELS, **OF_GRIP},
    }


def _fields(found: Trajectory) -> list[str]:
    return [name for name, _ in found.robot.documentation["geometry"]]


def save(found: Trajectory, stem: File) -> list[File]:
    """Write `<stem>.npz`, `<stem>.csv` and `<stem>_joints.yaml`; returns the files."""
    stem.parent.mkdir(parents=True, exist_ok=True)
    paths = [stem.with_name(stem.name + ending) for ending in (".npz", ".csv", "_joints.yaml")]
    text = np.array(json.dumps(about(found), sort_keys=True))
    np.savez_compressed(paths[0], about=text, **arrays_of(found))  # type: ignore[arg-type]
    paths[1].write_text(csv_text(found), encoding="utf-8")
    paths[2].write_text(ros_text(found), encoding="utf-8")
    return paths


def load_result(file: File | str) -> Result:
    """Read an NPZ file that `save` has written; nothing in it can run.

    Raises:
        ResultError: it is none, or of a later version.
    """
    try:
        with np.load(file, allow_pickle=False) as held:
            facts = json.loads(str(held["about"]))
            found = {
                name: held[name] for name in (*UNITS, *LATER, *OF_SWIVELS, *OF_GRIP) if name in held.files
            }
    except (ValueError, KeyError, EOFError) as error:
        raise ResultError(f"{file}: no result of `krhpr optimise`: {error}") from None
    if facts.get("format") != FORMAT:
        raise ResultError(f"{file}: format {facts.get('format')!r}; this version of krhpr reads {FORMAT}")
    missing = [name for name in UNITS if name not in found]
    if missing:
        raise ResultError(f"{file}: no {', '.join(missing)}")
    return Result(found, facts)


def csv_text(found: Trajectory) -> str:
    """A row for each time, a column for each number, its unit in brackets; comments say what it is."""
    examined, motion = found.examined, found.examined.motion
    angular = found.robot.signature("end_points").inputs[2].unit == "rad"
    columns: dict[str, Floats] = {"time [s]": motion.times}
    columns |= {f"p_{axis} [m]": motion.p[:, k] for k, axis in enumerate("xyz"[: motion.p.shape[1]])}
    if motion.Q.ndim == 1:
        columns["phi [rad]"] = motion.Q
    else:
        columns |= {f"Q_{i + 1}{j + 1} [1]": motion.Q[:, i, j] for i in range(3) for j in range(3)}
    unit = "rad" if angular else "m"
    for leg in range(3):
        columns[f"redundant_{leg + 1} [{unit}]"] = examined.redundant[:, leg]
        columns[f"redundant_rate_{leg + 1} [{unit}/s]"] = examined.redundant_rate[:, leg]
        if examined.swivel is not None:
            columns[f"swivel_{leg + 1} [rad]"] = examined.swivel[:, leg]
    for k, (name, actuator_unit) in enumerate(_joints(found)):
        for ending, per, values in (
            ("", "", examined.theta),
            ("_rate", "/s", examined.theta_rate),
            ("_acceleration", "/s^2", examined.theta_acceleration),
        ):
            columns[f"{name}{ending} [{actuator_unit}{per}]"] = values.reshape(len(motion.times), -1)[:, k]
    columns |= {f"{name} [{UNITS[name]}]": values for name, values in examined.indices.items()}
    if of_grip := _of_grip(found):
        columns["opening [m]"] = of_grip["opening"]
        columns |= {f"centre_{axis} [m]": of_grip["centre"][:, k] for k, axis in enumerate("xy")}
    lines = [f"# {line}" for line in found.report().splitlines()]
    lines.append(",".join(columns))
    lines += [",".join(f"{x:.12g}" for x in row) for row in np.column_stack(list(columns.values()))]
    return "\n".join(lines) + "\n"


def ros_text(found: Trajectory) -> str:
    """The joints as YAML in the layout of ROS' `trajectory_msgs/JointTrajectory`, at the ends of
    intervals."""
    examined, times = found.examined, found.examined.motion.times - found.examined.motion.times[0]
    lines = ["header:", "  stamp: {sec: 0, nanosec: 0}", '  frame_id: ""', "joint_names:"]
    lines += [f"- {name}" for name, _ in _joints(found)]
    lines.append("points:")
    for k in range(0, len(times), 10):
        nanoseconds = round(float(times[k]) * 1e9)
        lines.append(f"- positions: {_list(examined.theta[k])}")
        lines.append(f"  velocities: {_list(examined.theta_rate[k])}")
        lines.append(f"  accelerations: {_list(examined.theta_acceleration[k])}")
        lines.append("  effort: []")
        seconds, rest = divmod(nanoseconds, 10**9)
        lines.append(f"  time_from_start: {{sec: {seconds}, nanosec: {rest}}}")
    return "\n".join(lines) + "\n"


def _list(values: Any) -> str:
    return "[" + ", ".join(f"{x:.12f}" for x in np.ravel(values)) + "]"


def _joints(found: Trajectory) -> list[tuple[str, str]]:
    """Names of the actuated joints, leg by leg, and their units."""
    robot = found.robot
    labels = robot.signature("inverse").outputs[0].labels
    return [
        (f"leg_{leg + 1}_{name}", "rad" if turns else "m")
        for leg in range(3)
        for name, turns in zip(labels, robot.angular, strict=True)
    ]
