"""Drawn links end where the functions say, and are as long as the geometry says."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest

import krhpr
from krhpr import drawing
from krhpr.drawing import draw, skeleton
from tests.support import THOROUGH, with_cover

ROBOTS = krhpr.catalogue()


def rotation(vector: Any) -> Any:
    """The rotation about a vector by its length."""
    angle = np.linalg.norm(vector)
    x, y, z = vector / angle
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross


def configurations(robot: krhpr.Robot, count: int) -> Iterator[tuple[Any, Any, Any, str]]:
    """Poses in reach near home, each with a working mode."""
    rng = np.random.default_rng(7)
    home = robot.home
    modes = [mode for mode in robot.modes if not np.isnan(robot.inverse(*home, mode=mode)).any()]
    slides = robot.signature("passive_joints").outputs[-1].unit == "m"
    made = 0
    while made < count:
        if robot.planar:
            p, orientation = rng.uniform(-0.02, 0.02, 2), rng.uniform(-0.3, 0.3)
        else:
            p, orientation = (
                np.array([0, 0, 0.35]) + rng.uniform(-0.04, 0.04, 3),
                rotation(rng.uniform(-0.3, 0.3, 3)),
            )
        redundant = home.redundant + (rng.uniform(-0.03, 0.03, 3) if slides else rng.uniform(-0.9, 0.7, 3))
        mode = modes[made % len(modes)]
        if not np.isnan(robot.inverse(p, orientation, redundant, mode=mode)).any():
            yield p, orientation, redundant, mode
            made += 1


@pytest.mark.parametrize("identifier", with_cover(ROBOTS))
def test_links_end_at_the_end_points_and_have_the_geometrys_lengths(identifier: str) -> None:
    robot = krhpr.load(identifier, backend="numpy")
    for p, orientation, redundant, mode in configurations(robot, 16):
        bones = skeleton(robot, p, orientation, redundant, mode)
        s = robot.end_points(p, orientation, redundant)
        assert np.array_equal(bones.points["S"], s)
        assert np.array_equal(bones.theta, robot.inverse(p, orientation, redundant, mode=mode))
        for leg in (1, 2, 3):
            chain = bones.of_leg(leg)
            assert any(np.allclose(link.end, s[leg - 1], atol=1e-12) for link in chain)
            for link in chain:
                if link.name in robot.geometry.fields:  # slides and struts are named as their joints
                    assert link.length == pytest.approx(
                        float(robot.geometry.fields[link.name][leg - 1]), abs=1e-12
                    )


def test_the_five_bar_is_drawn_as_it_closes() -> None:
    robot = krhpr.load("spatial_r_fivebar_a")
    for p, orientation, redundant, mode in configurations(robot, 16):
        points = skeleton(robot, p, orientation, redundant, mode).points
        for i in range(3):
            crank, rod = points["E"][i] - points["c"][i], points["P"][i] - points["E"][i]
            along = points["S"][i] - points["E"][i]
            assert np.linalg.norm(crank) == pytest.approx(0.3)
            assert np.linalg.norm(np.cross(rod, along)) == pytest.approx(0.0, abs=1e-12)
        joints = robot.subleg_forward(robot.inverse(p, orientation, redundant, mode=mode), "left")
        others = robot.subleg_forward(robot.inverse(p, orientation, redundant, mode=mode), "right")
        for i in range(3):
            assert min(np.abs(found[i] - points["S"][i]).max() for found in (joints, others)) < 1e-9


def test_a_pose_out_of_reach_is_an_error() -> None:
    with pytest.raises(krhpr.Unreachable):
        skeleton(krhpr.load("spatial_rrr_a"), [0.0, 0.0, 2.0], np.eye(3), [1.7, 1.7, 1.7])


@pytest.mark.parametrize("identifier", with_cover(ROBOTS, THOROUGH))
def test_a_robot_can_be_drawn_without_a_display(identifier: str) -> None:
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot

    robot = krhpr.load(identifier)
    p, orientation, redundant, mode = next(configurations(robot, 1))
    ax = draw(robot, p, orientation, redundant, mode)
    bones = skeleton(robot, p, orientation, redundant, mode)
    drawn = [
        np.array(line.get_data_3d() if ax.name == "3d" else line.get_data()).T
        for line in ax.lines
        if line.get_color() in drawing.COLOURS.values() and len(np.atleast_1d(line.get_xdata())) == 2
    ]
    assert len(drawn) == len(bones.links)
    for link, line in zip(bones.links, drawn, strict=True):
        assert np.allclose(line, [link.start, link.end])
    assert {f"$S_{i}$" for i in (1, 2, 3)} <= {text.get_text() for text in ax.texts}
    ax.figure.canvas.draw()
    pyplot.close(ax.figure)


def test_the_module_needs_no_matplotlib() -> None:
    code = (
        "import sys; sys.modules['matplotlib'] = None\n"
        "import krhpr, numpy as np; from krhpr.drawing import skeleton\n"
        "skeleton(krhpr.load('planar_rr_a', backend='numpy'), [0, 0], 0.0, [1.7, 1.7, 1.7])"
    )
    subprocess.run([sys.executable, "-c", code], check=True)
