"""`krhpr study NAME`: the studies, their arguments and help; a module for each does the work."""

from __future__ import annotations

import argparse
import textwrap
from collections.abc import Callable
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from typing import Any

from krhpr.cli.common import Command, WrongUse

FOLDER = Path("build/study")


@dataclass(frozen=True)
class Option:
    """An option that one study has, or several; `default` is what their modules get where it is not given."""

    flag: str
    metavar: str | None
    help: str
    default: Any = None
    type: Callable[[str], Any] = str
    choices: tuple[str, ...] | None = None

    @property
    def name(self) -> str:
        """The attribute of the parsed options."""
        return self.flag.removeprefix("--")


@dataclass(frozen=True)
class Study:
    """A study: its name, the module in `krhpr.cli` whose `run` does it, what it does, its own options."""

    name: str
    module: str
    about: str
    options: tuple[Option, ...] = ()


ROBOT = Option("--robot", "ROBOT", "identifier or robot file (default: that of the section)")
SEED = Option("--seed", "N", "of the random errors, or of the search (default: 0)", 0, int)


def processes(text: str) -> int | str:
    """A number of processes, or the address of a scheduler."""
    if not text.isdecimal():
        return text
    if int(text) == 0:
        raise argparse.ArgumentTypeError(
            "0 processes; expected 1 or more, or the address of a Dask scheduler"
        )
    return int(text)


COARSER = Option("--coarser", "N", "steps N times as wide (default: 1)", 1, int)
WORKERS = Option(
    "--workers",
    "N",
    "processes that share the work, or the address of a Dask scheduler (default: 1)",
    1,
    processes,
)
STORE = Option("--store", "DIR", "keep what is made there; an interrupted study goes on", type=Path)
SETUP = Option("--file", "FILE", "robot, object and trajectories (YAML)", type=Path)

STUDIES = (
    Study(
        "forward-accuracy",
        "study_accuracy",
        "Section 3.4: random errors on every encoder of the 3-RRRSR robot along the example trajectory, and "
        "what the seven approaches to the forward kinematics make of them; Figs. 3.8 to 3.11",
        (
            SEED,
            Option(
                "--errors",
                None,
                "uniform within the bound, which is the default, or normal",
                "uniform",
                choices=("uniform", "normal"),
            ),
            Option(
                "--bound",
                "RAD",
                "largest error, or three standard deviations (default: 0.005)",
                0.005,
                float,
            ),
            Option("--repeat", "N", "run the trajectory N times (default: once)", 1, int),
        ),
    ),
    Study(
        "dexterity",
        "study_dexterity",
        "Section 1.8: motion ranges of the nine actuators of the 3-[R(RR-RRR)SR] robot along the example "
        "trajectory, condition numbers and kinematic sensitivity",
    ),
    Study(
        "trajectory",
        "study_trajectory",
        "Section 4.3: the best redundant angles of the 3-RRRSR robot at every pose, the two minima of eta_1, "
        "filtered angles, and all methods against the nonlinear programme",
    ),
    Study(
        "grasp",
        "study_grasp",
        "Section 5.5: actuator forces and motor torques with which the prototype holds an object along "
        "(5.73) to (5.75), or what a --file says instead (examples/grasping_prototype.yaml)",
        (SETUP,),
    ),
    Study(
        "grasp-capability",
        "study_grasp_capability",
        "what the prototype, or the robot of a --file, can grasp with over heights of its pivot and turns of "
        "its jaws, and which moments on the object it resists, within friction and what motors give",
        (
            SETUP,
            COARSER,
            Option("--torque", "N_M", "largest of a motor's shaft, N m (default: 0.01)", 0.01, float),
        ),
    ),
    Study(
        "grasp-control",
        "study_grasp_control",
        "Section 5.5: the grasping force under the control schemes i, ii and iii, as closed-loop simulations "
        "of the prototype with gear friction, contacts that give, encoders and a load cell; Figs. 5.7, 5.9 "
        "to 5.11",
        (
            SETUP,
            Option(
                "--control",
                "FILE",
                "motors, friction, contacts, sensors and gains (YAML; examples/grasping_control.yaml)",
                type=Path,
            ),
            Option(
                "--controller",
                None,
                "the controller's step in Python, which is the default, or the generated one in C",
                "python",
                choices=("python", "c"),
            ),
        ),
    ),
    Study(
        "workspace",
        "study_workspace",
        "Section 1.7: layers of the translational workspace, and the orientational one by torsion and tilt, "
        "with limits of joints and interference; Figs. 1.6 to 1.9",
        (
            ROBOT,
            COARSER,
            WORKERS,
            STORE,
        ),
    ),
    Study(
        "design",
        "study_design",
        "Section 4.2: the workspaces of the 3-RRRSR robot by its redundant angles, redundant links and "
        "platform, Figs. 4.1 and 4.2; and then the front of designs that are judged by the whole workspace, "
        "and the best of them as robot files",
        (
            ROBOT,
            COARSER,
            STORE,
            SEED,
            Option(
                "--vary",
                "LIST",
                "NAME=LOW:HIGH of each variable, in metres and radians: fields of the geometry, redundant, "
                "height (default: of platform, base and legs)",
            ),
            Option(
                "--objectives",
                "LIST",
                "of volume, orientations, box, eta_1, eta_2, eta_3, length (default: volume,eta_2,box)",
            ),
            Option("--generations", "N", "of the search in each direction (default: 8)", 8, int),
            WORKERS,
        ),
    ),
)

EXAMPLES = """\
exit codes: 0 every claim holds; 3 one does not; 2 wrong use

examples:
  krhpr study dexterity
  krhpr study trajectory --out chapter_4
  krhpr study forward-accuracy --seed 7 --repeat 20
  krhpr study grasp --file my_gripper.yaml --out build/gripper
  krhpr study grasp-control --control my_gains.yaml --controller c
  krhpr study workspace --coarser 4 --robot spatial_rrr_a
  krhpr study workspace --workers tcp://127.0.0.1:8786 --store build/maps
  krhpr study design --workers 4 --store build/designs
  krhpr study design --robot my_robot.yaml --vary "R_p=0.08:0.15,redundant=1:2" \\
      --objectives orientations,eta_1"""


def _epilog() -> str:
    width = 2 + max(len(study.name) for study in STUDIES) + 3
    lines = ["studies:"]
    for study in STUDIES:
        about = textwrap.wrap(study.about, 80 - width)
        lines.append(f"  {study.name:<{width - 2}}{about[0]}")
        lines += [" " * width + line for line in about[1:]]
    told = (
        "A table is printed, and with it what the thesis says and whether it came out. The numbers are "
        "written to --out as JSON, and the thesis' figures as pictures (where matplotlib is installed)."
    )
    return "\n".join([*lines, "", *textwrap.wrap(told, 80), "", EXAMPLES])


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The command's arguments."""
    names = [study.name for study in STUDIES]
    parser.add_argument("study", metavar="NAME", choices=names, help=", ".join(names))
    parser.add_argument(
        "--out", metavar="DIR", type=Path, default=FOLDER, help=f"folder of the results (default: {FOLDER})"
    )
    for owners, options in _grouped():
        group = parser.add_argument_group(f"of {', '.join(owners)}")
        for option in options:
            group.add_argument(
                option.flag,
                metavar=option.metavar,
                type=option.type,
                choices=option.choices,
                help=option.help,
            )


def _grouped() -> list[tuple[tuple[str, ...], list[Option]]]:
    """Options by the studies that have them; some are of several."""
    owners: dict[Option, tuple[str, ...]] = {}
    for study in STUDIES:
        for option in study.options:
            owners[option] = (*owners.get(option, ()), study.name)
    groups: dict[tuple[str, ...], list[Option]] = {}
    for option, names in owners.items():
        groups.setdefault(names, []).append(option)
    return list(groups.items())


def run(options: argparse.Namespace) -> int:
    """Run the study, print what came of it and write the pictures."""
    (chosen,) = (study for study in STUDIES if study.name == options.study)
    for owners, its in _grouped():
        given = [option.flag for option in its if getattr(options, option.name) is not None]
        if given and chosen.name not in owners:
            raise WrongUse(
                f"{', '.join(given)} belongs to {', '.join(owners)}; {chosen.name} has no such option"
            )
    for option in chosen.options:
        if getattr(options, option.name) is None:
            setattr(options, option.name, option.default)
    code: int = import_module(f"krhpr.cli.{chosen.module}").run(options)  # it takes NumPy
    return code


COMMAND = Command(
    "study",
    "Run a study of the thesis again.  With a table, pictures, and a check of what the thesis says.",
    _epilog(),
    add_arguments,
    run,
)
