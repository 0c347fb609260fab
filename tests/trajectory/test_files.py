"""Files with paths, and results as files."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest
import yaml

import krhpr
from krhpr import trajectory
from krhpr.trajectory import Method, PathError, ResultError
from krhpr.trajectory.files import read_request
from krhpr.trajectory.plot import save_plot
from krhpr.trajectory.results import LATER, UNITS

ROOT = Path(__file__).resolve().parents[2]

WHOLE = """\
way_points:
  - {time: 0, p: [0, 0, 350 mm], rotation: [0, 0, 0]}
  - {time: 2.5, p: [10 cm, 0, 0.35], rotation: [0, 40 deg, 0]}
  - {time: 3, p: [0, 0, 0.35], rotation: [0, 0, 0.1 rad]}
interpolation: linear
objective: {eta_1: 11.4, eta_2: 0.12}
limits: {redundant: [55 deg, 175 deg], redundant_rate: 60 deg, margins: [0.5, 0], factors: {elbow: 0.2},
  clearance: 2 cm}
method: scan
intervals: 12
horizon: 2
"""


def read(folder: Path, text: str, *, planar: bool = False, slides: bool = False):  # type: ignore[no-untyped-def]
    file = folder / "there.yaml"
    file.write_text(text, encoding="utf-8")
    return read_request(file, planar=planar, slides=slides)


def test_a_whole_file(tmp_path: Path) -> None:
    found = read(tmp_path, WHOLE)
    assert found.path.name == "there" and found.path.times.tolist() == [0, 2.5, 3]
    assert np.allclose(found.path.p[1], [0.1, 0, 0.35]) and found.path.interpolation == "linear"
    assert np.allclose(found.path.Q[1][0, 2], np.sin(np.radians(40)))
    assert (found.objective.eta_1, found.objective.eta_2, found.objective.rates) == (11.4, 0.12, 1e-3)
    assert np.allclose(found.bounds.redundant, np.radians([55, 175]))
    assert np.isclose(found.bounds.redundant_rate, np.radians(60))
    assert found.bounds.factors == {"elbow": 0.2} and found.bounds.clearance == 0.02
    assert found.method is Method.SCAN and (found.intervals, found.horizon) == (12, 2)


def test_the_example_has_the_limits_of_chapter_4(tmp_path: Path) -> None:
    found = read_request(ROOT / "examples" / "translation.yaml", planar=False, slides=False)
    wanted = trajectory.chapter_4()
    assert found.path.name == "T1" and found.method is Method.NLP
    assert found.bounds.factors == pytest.approx(dict(wanted.factors), rel=1e-4)
    assert replace(found.bounds, factors=wanted.factors) == wanted
    assert read(tmp_path, "path: T1\nlimits: chapter-4\n").bounds == wanted


def test_a_planar_file_with_slides(tmp_path: Path) -> None:
    text = (
        "way_points:\n- {time: 0, p: [0, 0], phi: 0}\n- {time: 1, p: [1 cm, 0], phi: 5 deg}\n"
        "limits: {redundant: [20 mm, 0.1], margins: [0.01]}\n"
    )
    found = read(tmp_path, text, planar=True, slides=True)
    assert found.path.planar and np.isclose(found.path.Q[1], np.radians(5))
    assert found.bounds.redundant == (0.02, 0.1) and found.bounds.margins == (0.01,)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (("method: scan", "method: scam"), "line 9: method: found scam; did you mean scan"),
        (("time: 2.5", "time: 0"), "way_points: there: times must increase; way-point 2 is at 0 s"),
        (("eta_2: 0.12", "eta_4: 0.12"), "line 6: objective: no objective is called 'eta_4'"),
        (
            ("[55 deg, 175 deg]", "[55 mm, 175 deg]"),
            "line 7: limits.redundant: found '55 mm', expected an angle",
        ),
        (
            ("redundant_rate", "redundant_rat"),
            "limits.redundant_rat: unknown field; did you mean redundant_rate",
        ),
        (("horizon: 2", "horizon: 0"), "horizon: expected seconds, more than none"),
        (("intervals: 12", "intervals: 1"), "intervals: expected a whole number of two or more"),
        (
            ("rotation: [0, 0, 0]}", "phi: 0}"),
            r"way_points\[1\]: found time, p, phi, expected time, p, rotation",
        ),
        (("way_points:", "path: T1\nway_points:"), "give either path, one of the thesis, or way_points"),
        (("limits: {", "limit: {"), "limits: found nothing, expected chapter-4 or a table"),
    ],
)
def test_mistakes_have_their_line(change: tuple[str, str], message: str, tmp_path: Path) -> None:
    with pytest.raises(PathError, match=message):
        read(tmp_path, WHOLE.replace(*change, 1))


@cache
def scanned() -> trajectory.Trajectory:
    robot = krhpr.load("spatial_rrr_a")
    return trajectory.optimise(
        robot, trajectory.translation(), "eta_1", trajectory.chapter_4(), method="scan", intervals=20
    )


def test_results_come_back(tmp_path: Path) -> None:
    found = scanned()
    paths = trajectory.save(found, tmp_path / "one" / "best")
    assert [path.name for path in paths] == ["best.npz", "best.csv", "best_joints.yaml"]
    again = trajectory.load_result(paths[0])
    assert set(again.arrays) == {*UNITS, *LATER} and not again.feasible
    np.testing.assert_array_equal(again.arrays["theta"], found.theta)
    np.testing.assert_array_equal(again.arrays["eta_1"], found.examined.indices["eta_1"])
    assert again.violations == found.violations
    assert again.about["integrals"] == found.integrals
    assert again.about["robot"] == "spatial_rrr_a" and again.about["limits"]["cone"] == found.bounds.cone
    assert again.about["geometry"]["l_3"] == [0.45] * 3

    comments = [line for line in paths[1].read_text().splitlines() if line.startswith("#")]
    assert "NOT feasible" in comments[0] and len(comments) == 1 + len(found.violations)
    table = np.genfromtxt(paths[1], delimiter=",", skip_header=len(comments) + 1)
    header = paths[1].read_text().splitlines()[len(comments)].split(",")
    assert table.shape == (201, len(header))
    for name, values in (
        ("time [s]", found.times),
        ("redundant_2 [rad]", found.redundant[:, 1]),
        ("leg_3_theta_2_rate [rad/s]", found.examined.theta_rate[:, 2, 1]),
        ("eta_2 [1]", found.examined.indices["eta_2"]),
    ):
        np.testing.assert_allclose(table[:, header.index(name)], values, rtol=1e-10, atol=1e-12)


def test_the_ros_layout(tmp_path: Path) -> None:
    found = scanned()
    message = yaml.safe_load(trajectory.save(found, tmp_path / "best")[2].read_text())
    assert message["joint_names"][:4] == ["leg_1_theta_1", "leg_1_theta_2", "leg_1_theta_3", "leg_2_theta_1"]
    assert len(message["points"]) == 21
    point = message["points"][3]
    np.testing.assert_allclose(point["positions"], found.theta[30].ravel(), atol=1e-11)
    np.testing.assert_allclose(point["velocities"], found.examined.theta_rate[30].ravel(), atol=1e-11)
    np.testing.assert_allclose(
        point["accelerations"], found.examined.theta_acceleration[30].ravel(), atol=1e-11
    )
    assert point["time_from_start"] == {"sec": 0, "nanosec": 900_000_000}


def test_what_is_no_result(tmp_path: Path) -> None:
    np.savez(tmp_path / "other.npz", a=1.0)
    with pytest.raises(ResultError, match=r"other\.npz: no result of `krhpr optimise`"):
        trajectory.load_result(tmp_path / "other.npz")


def test_the_picture(tmp_path: Path) -> None:
    path = save_plot(scanned(), tmp_path / "best.png")
    assert path.read_bytes() == save_plot(scanned(), tmp_path / "again.png").read_bytes()
    assert path.stat().st_size > 20_000
