"""Parameters: what is refused, what is only suspected, and the file with the prototype's."""

from __future__ import annotations

import warnings
from dataclasses import replace
from pathlib import Path

import pytest

from krhpr.control.parameter_file import read_control_file
from krhpr.control.parameters import PROTOTYPE, Contact, ForceGains, Motor, Sensors
from krhpr.errors import ControlError
from krhpr.robot_files.problems import RobotFileError, RobotFileWarning
from krhpr.study.grasp import PROTOTYPE as SETUP
from tests.support import ROOT

EXAMPLE = ROOT / "examples" / "grasping_control.yaml"
TEXT = EXAMPLE.read_text()


def written(folder: Path, *changes: tuple[str, str]) -> Path:
    text = TEXT
    for old, new in changes:
        assert text.count(old) == 1, old
        text = text.replace(old, new)
    path = folder / "control.yaml"
    path.write_text(text)
    return path


def test_the_example_is_the_prototype() -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert read_control_file(EXAMPLE) == PROTOTYPE
    # the motors' inertia outweighs everything: 17 kg at a belt that moves 30 g
    assert PROTOTYPE.mass(SETUP.drive) == pytest.approx(4.2e-7 * (29 / 0.0045) ** 2)
    assert PROTOTYPE.resolution(SETUP.drive) == pytest.approx(0.476e-6, rel=1e-3)
    assert PROTOTYPE.coulomb(SETUP.drive) == pytest.approx(0.08e-3 * 29 / 0.0045)


WRONG = {
    "stiffness: 150 N/mm": (
        "stiffness: -150 N/mm",
        "line 17: contact: stiffness is -150000; it must be positive",
    ),
    "rate: 500 Hz": ("rate: 0 Hz", "line 5: rate: controller: rate is 0; it must be positive and finite"),
    "inertia: 4.2 g cm2": (
        "inertia: 4.2 mN m",
        "motor.inertia: found '4.2 mN m', expected a moment of inertia in kg m2 (4.2e-7), or with its unit "
        "(4.2 g cm2, 4.2e-7 kg m2)",
    ),
    "torque: 0.08 mN m": ("torque: 0.08 mm", "expected a torque in newton metres"),
    "stiction: 1.2": ("stiction: 0.9", "friction: stiction is 0.9; friction at rest is no less: 1 or more"),
    "most: 10 N": ("most: 10 mN", "force: most is 0.01 N, and must be more than least, 0.05 N"),
    "  damping: 20 ": ("  springs: 20 ", "contact: found stiffness, springs, expected stiffness, damping"),
    "encoder_counts: 2048": ("encoder_counts: 0", "sensors: encoder_counts is 0; it must be positive"),
    "seed: 0": ("seed: 0.5", "seed: found 0.5, expected 0, 1, 2, ..."),
    "integral: 30": ("integral: .inf", "force.integral: found .inf, expected a number"),
    "rate: 500": ("raet: 500", "raet: unknown field; did you mean"),
    "  filter_time: 4 ms                 # of the error's rate": (
        "  filter_time: [4 ms]",
        "position.filter_time: found a list of 1, expected a time in seconds",
    ),
}


@pytest.mark.parametrize("old", WRONG)
def test_mistakes_are_told_with_their_line(old: str, tmp_path: Path) -> None:
    new, said = WRONG[old]
    with pytest.raises(RobotFileError) as caught:
        read_control_file(written(tmp_path, (old, new)))
    assert said in str(caught.value) and "control.yaml, line " in str(caught.value)


def test_several_mistakes_are_told_at_once(tmp_path: Path) -> None:
    path = written(tmp_path, ("stiction: 1.2", "stiction: x"), ("integral: 30", "integral: -1"))
    with pytest.raises(RobotFileError) as caught:
        read_control_file(path)
    assert len(caught.value.problems) == 2


SUSPICIOUS = {
    "stiffness: 150 N/mm": "stiffness: 150",
    "stiffness: 5 N/mm": "stiffness: 5",
    "inertia: 4.2 g cm2": "inertia: 4.2",
    "torque_limit: 12 mN m": "torque_limit: 12",
    "torque: 0.08 mN m": "torque: 0.08",
    "stribeck_speed: 1 mm/s": "stribeck_speed: 1",
    "presliding: 0.0015 mm": "presliding: 0.0015",
    "force_noise: 20 mN": "force_noise: 20",
    "derivative: 15 ms": "derivative: 15",
    "rate: 500 Hz": "rate: 0.5",
}


@pytest.mark.parametrize("old", SUSPICIOUS)
def test_units_wrong_by_a_thousand_are_warned_of(old: str, tmp_path: Path) -> None:
    new = SUSPICIOUS[old]
    with pytest.warns(RobotFileWarning, match=f"{new.partition(':')[0]}: it is .*wrong by a thousand"):
        read_control_file(written(tmp_path, (old, new)))


@pytest.mark.parametrize(
    ("make", "said"),
    [
        (lambda: Contact(stiffness=-1.0, damping=0.0), "contact: stiffness is -1; it must be positive"),
        (lambda: replace(PROTOTYPE, rate=0.0), "controller: rate is 0; it must be positive"),
        (lambda: Motor(inertia=float("nan"), torque_limit=1.0), "motor: inertia is nan; it must be"),
        (lambda: Sensors(encoder_counts=-2048, force_noise=0.0), "sensors: encoder_counts is -2048"),
        (lambda: ForceGains(1.0, 1.0, 1.0, 0.0, 0.0, 1.0), "force: least is 0; it must be positive"),
        (lambda: replace(PROTOTYPE.friction, torque=0.0), "friction: load_share needs a torque"),
        (lambda: replace(PROTOTYPE.position, damping=float("inf")), "damping is inf"),
    ],
)
def test_parameters_that_are_none(make, said: str) -> None:  # type: ignore[no-untyped-def]
    with pytest.raises(ControlError, match=said):
        make()
