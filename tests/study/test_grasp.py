"""The grasp study: the numbers of the errata, the stiffness of (5.72) from energy, and files."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from krhpr.robot_files.problems import RobotFileError, RobotFileWarning
from krhpr.study.grasp import PROTOTYPE, Drive, Held, Motion, grasp_study
from krhpr.study.grasp_file import read_grasp_file
from tests.support import ROOT

EXAMPLE = ROOT / "examples" / "grasping_prototype.yaml"

# of errata-planar-statics, 2.4: |f| (N), largest |tau| (mN m) without weight; largest of both with 0.3 N
EXPECTED = {
    "(5.73) along x": ((1.41755, 1.41755), 0.21996, 1.6758, 0.2600),
    "(5.74) along y": ((1.41755, 1.41755), 0.21996, 1.7580, 0.2728),
    "(5.75) about B": ((0.9216, 1.8704), 0.29024, 2.2605, 0.3508),
}


def test_the_prototype() -> None:
    found = grasp_study()
    assert all(holds for _, holds in found.claims()) and len(found.claims()) == 2
    assert np.abs(found.span - 0.20782).max() < 5e-6
    for light, heavy in zip(found.along[::2], found.along[1::2], strict=True):
        assert (light.weight, heavy.weight) == (0.0, 0.3)
        (least, most), torque, heavy_most, heavy_torque = EXPECTED[light.motion.name]
        f = np.abs(light.forces)
        assert abs(f.min() - least) < 6e-5 and abs(f.max() - most) < 6e-5
        assert abs(1e3 * np.abs(light.torques).max() - torque) < 6e-6
        assert abs(np.abs(heavy.forces).max() - heavy_most) < 6e-5
        assert abs(1e3 * np.abs(heavy.torques).max() - heavy_torque) < 6e-5
        assert np.abs(heavy.torques / heavy.forces - 0.0045 / 29).max() < 1e-12
    first = found.along[0]
    # f_g h / (2 b sin phi), signs (+, +, -, -)
    closed = 2 * 0.0425 / (2 * 0.0424 * np.sin(np.pi / 4))
    assert np.abs(first.forces - closed * np.array([[1, 1], [-1, -1]])).max() < 1e-12
    assert abs(first.pin[0] - 4.835) < 5e-4
    assert abs(max(np.abs(one.links).max() for one in found.along) - 2.55) < 5e-3
    assert abs(1e3 * found.stiffness - 21.15) < 5e-3
    # the measured force is the smaller one, always 2 N
    for one in found.along:
        assert np.abs(one.contact_forces[..., 0].min(axis=-1) - 2.0).max() < 1e-12


@pytest.mark.parametrize("turned", [0, 1])
def test_stiffness_from_energy(turned: int) -> None:
    """Actuators of stiffness k_p are told to turn one jaw into a rigid object that does not let it."""
    setup = replace(PROTOTYPE, motions=PROTOTYPE.motions[:1], duration=0.1)
    robot = setup.build()
    y = np.array([*setup.pivot, setup.phi, setup.beta])
    told = y.copy()
    error = 1e-6
    told[2 + turned] += (-1) ** turned * error  # phi up or beta down closes

    def rho(z: np.ndarray) -> np.ndarray:
        return robot.inverse(z[:2], z[2:]).ravel()

    h = 1e-6
    A = np.column_stack([(rho(y + h * e) - rho(y - h * e)) / (2 * h) for e in np.eye(4)])
    # least energy |rho_told - rho|^2 / 2 of the poses that leave gamma as it is
    free = np.array([[1, 0, 0], [0, 1, 0], [0, 0, 1], [0, 0, 1]], dtype=float)
    gap = rho(told) - rho(y)
    moved, *_ = np.linalg.lstsq(A @ free, gap, rcond=None)
    loads = A.T @ (gap - A @ free @ moved)  # for k_p = 1: what the jaws do to the object
    assert np.abs(loads[:2]).max() < 1e-6 * np.abs(loads).max()
    assert loads[2] == pytest.approx(-loads[3], rel=1e-6)
    force = loads[2] / setup.held.height
    assert force / error == pytest.approx(grasp_study(setup).stiffness, rel=1e-5)


def test_an_object_that_is_not_held() -> None:
    slipping = replace(PROTOTYPE, held=replace(PROTOTYPE.held, friction=0.05))
    found = grasp_study(slipping)
    assert found.unreachable == tuple(motion.name for motion in PROTOTYPE.motions)
    assert not found.claims()[0][1]
    # the weightless object needs no friction
    assert [one.trouble for one in found.along] == ["", "SLIPS at 0 s"] * 3
    far = grasp_study(replace(PROTOTYPE, motions=(Motion("far", 1.0, y=0.1),)))
    assert far.unreachable == ("far", "far")
    assert far.along[0].trouble.startswith("UNREACHABLE_LEG_1 at 0.")
    overlapping = replace(PROTOTYPE, held=replace(PROTOTYPE.held, width=-0.01))
    assert grasp_study(overlapping).along[0].trouble == "NO_GRASP at 0 s"


def test_the_example_is_the_prototype() -> None:
    assert read_grasp_file(EXAMPLE) == PROTOTYPE


def changed(tmp_path: Path, old: str, new: str) -> Path:
    text = EXAMPLE.read_text(encoding="utf-8")
    assert old in text
    path = tmp_path / "gripper.yaml"
    path.write_text(text.replace(old, new), encoding="utf-8")
    return path


def test_another_gripper(tmp_path: Path) -> None:
    path = changed(tmp_path, "l_j: 42.4 mm", "l_j: [40 mm, 45 mm], slide_1: [1 deg, 0]")
    found = read_grasp_file(path)
    assert found.geometry["l_j"] == (0.04, 0.045)
    assert found.geometry["slide_1"] == (np.radians(1), 0.0)
    assert (found.held, found.drive) == (Held(0.0427, 0.0425, 0.3, 0.5), Drive(0.0045, 29.0))


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("robot: planar_grasp_prr", "robot: planar_rr_a", "line 5: robot: found"),
        ("l_j: 42.4 mm", "l_j: -1 mm", "geometry.l_j: a length must be positive"),
        ("l_j: 42.4 mm", "l_4: 42.4 mm", "geometry.l_4: unknown field"),
        ("l_j: 42.4 mm", "l_j: [1 mm, 2 mm, 3 mm]", "expected a list of 2"),
        ("width: 42.7 mm", "width: 0", "object.width: it must be positive"),
        ("weight: 0.3", "weight: -0.3", "object.weight: it must not be negative"),
        ("weight: 0.3, ", "", "object: found width, height, friction"),
        ("phi: 45 deg", "phi: 45 mm", "pose.phi: found '45 mm', expected an angle"),
        ("grasp_force: 2 ", "grasp_force: 0 ", "grasp_force: it must be positive"),
        ("duration: 20 ", "length: 20 ", "length: unknown field"),
        ("{y: 20 mm, frequency: 1}", "{y: 20 mm}", "along y: expected frequency"),
        ("{y: 20 mm, frequency: 1}", "{z: 20 mm, frequency: 1}", "along y.z: unknown field"),
        ("ratio: 29", "ratio: 29, friction: 1", "drive: found radius, ratio, friction"),
    ],
)
def test_mistakes_are_told_with_their_line(tmp_path: Path, old: str, new: str, said: str) -> None:
    with pytest.raises(RobotFileError) as told:
        read_grasp_file(changed(tmp_path, old, new))
    assert said in str(told.value)
    assert "gripper.yaml" in str(told.value)


def test_millimetres_without_their_unit_are_noticed(tmp_path: Path) -> None:
    with pytest.warns(RobotFileWarning, match="with millimetres in mind write `120 mm`"):
        read_grasp_file(changed(tmp_path, "l_1: 120 mm", "l_1: 120"))


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("l_1: 120 mm", "l_1: 0.00012", "geometry.l_1: 0.00012 m is very short; with 0.00012 km in mind"),
        ("height: 42.5 mm", "height: 42.5", "object.height: 42.5 m is very long; with millimetres in mind"),
        ("radius: 4.5 mm", "radius: 4.5e-6", "drive.radius: 4.5e-06 m is very short"),
        ("phi: 45 deg", "phi: 45", "pose.phi: 45 rad is more than a turn"),
        ("weight: 0.3", "weight: 3000", "object.weight: it is 3000 N, and usual is 0.0001 to 1000"),
        ("grasp_force: 2 ", "grasp_force: 2e-6 ", "grasp_force: it is 2e-06 N, and usual is"),
        (
            "width: 42.7 mm",
            "width: 90 mm",
            "0.09 m is wider than the jaws are open: their lines are 0.085 m apart",
        ),
        ("friction: 0.5", "friction: 50", "object.friction: it is 50, and usual is 0.01 to 3"),
    ],
)
def test_units_that_are_hardly_meant(tmp_path: Path, old: str, new: str, said: str) -> None:
    with pytest.warns(RobotFileWarning) as told:
        read_grasp_file(changed(tmp_path, old, new))
    assert len(told) == 1 and said in str(told[0].message)


@pytest.mark.filterwarnings("error")
def test_small_motions_and_weightless_objects_are_meant(tmp_path: Path) -> None:
    read_grasp_file(changed(tmp_path, "y: 20 mm", "y: 0.1 mm"))
    read_grasp_file(changed(tmp_path, "weight: 0.3", "weight: 0"))
