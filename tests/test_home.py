"""Home poses, pictures of them, and what is special about the parallel slides."""

from __future__ import annotations

import pickle

import matplotlib
import numpy as np
import pytest

import krhpr
from krhpr.drawing import COLOURS, Kind, skeleton
from krhpr.picture import picture, symbol
from tests.support import with_cover

ROBOTS = krhpr.catalogue()


@pytest.mark.parametrize("identifier", ROBOTS)
def test_every_robot_is_far_from_singularities_at_home(identifier: str) -> None:
    robot = krhpr.load(identifier, backend="numpy")
    p, orientation, redundant = robot.home
    theta = robot.inverse(*robot.home, check=True)
    s = robot.end_points(*robot.home)
    found = robot.singularity(p, orientation, s, theta)
    scale = {"volume": 0.1, "constraint": 0.5}  # powers of a length that is not the legs' own
    names = [name for name, _ in robot.documentation["singular factors"]]
    least = np.array([scale.get(name, 0.25) for name in names])
    assert (np.abs(found.factors) >= least).all()
    assert (found.margins > 0.02).all()
    assert np.allclose(robot.redundant_coordinates(p, orientation, s), redundant)


@pytest.mark.parametrize("identifier", ROBOTS)
def test_actuators_are_where_the_documentation_says(identifier: str) -> None:
    robot = krhpr.load(identifier, backend="numpy")
    places = dict(robot.documentation["actuated at"])
    assert list(places) == [name for name, _ in robot.documentation["actuators"]]
    points = robot.signature("link_points").outputs[0].labels
    links = {name: kind for name, kind, _, _ in robot.links}
    kinds = dict(robot.documentation["joint kinds"])
    for name, place in places.items():
        assert place in points or place in links
        assert (kinds[name] == "prismatic") == (links.get(place) in ("slide", "strut"))


@pytest.mark.parametrize("identifier", with_cover(ROBOTS))
def test_every_robot_has_a_labelled_picture(identifier: str) -> None:
    matplotlib.use("Agg")
    from matplotlib import pyplot

    robot = krhpr.load(identifier, backend="numpy")
    figure = picture(robot)
    (ax,) = figure.axes
    written = [text.get_text() for text in ax.texts]
    assert {f"$S_{{{i}}}$" for i in (1, 2, 3)} <= set(written)
    assert {symbol(name) for name, _ in robot.documentation["actuators"]} <= set(written)
    for link in skeleton(robot, *robot.home).of_leg(1):
        assert link.length < 1e-9 or symbol(link.name) in written
    canvas = figure.get_window_extent()
    for text in ax.texts:
        box = text.get_window_extent()
        assert canvas.x0 <= box.x0 and box.x1 <= canvas.x1 and canvas.y0 <= box.y0 and box.y1 <= canvas.y1
    pyplot.close(figure)


def test_every_kind_of_link_has_a_colour() -> None:
    kinds = {kind for name in ROBOTS for _, kind, _, _ in krhpr.load(name, backend="numpy").links}
    assert kinds | {"redundant"} == {str(kind) for kind in Kind} == {str(kind) for kind in COLOURS}


def test_a_home_pose_stays_with_a_robot() -> None:
    robot = krhpr.load("examples/my_robot.yaml", backend="numpy")
    assert robot.home.p == (0.0, 0.0, 0.28)
    again = pickle.loads(pickle.dumps(robot.with_geometry(l_r=0.035)))
    assert again.home.p == robot.home.p and again.home.redundant == robot.home.redundant


@pytest.mark.parametrize("arrangement", "abc")
@pytest.mark.parametrize("direction", [0.0, 0.7])
def test_travel_along_parallel_slides_is_unlimited(arrangement: str, direction: float) -> None:
    robot = krhpr.load(f"spatial_prr_parallel_{arrangement}").with_geometry(slide_azimuth=direction)
    along = np.array([np.cos(direction), np.sin(direction), 0.0])
    p, Q, redundant = robot.home
    start = robot.inverse(p, Q, redundant, check=True)
    travel = np.array([-1e3, -7.0, 0.4, 25.0, 1e3])
    moved = np.asarray(p) + travel[:, np.newaxis] * along
    theta = robot.inverse(moved, Q, redundant, check=True)
    assert np.allclose(theta[..., 1:], start[..., 1:], rtol=0, atol=1e-9)
    assert np.allclose(theta[..., 0] - start[..., 0], travel[:, np.newaxis], rtol=0, atol=1e-9)
    # neither rates nor distances from singularities change on the way
    s = robot.end_points(moved, Q, redundant)
    twist = np.concatenate([along, np.zeros(3)])
    rates = robot.joint_rates(moved, Q, s, theta, twist)
    assert np.allclose(rates, [1.0, 0.0, 0.0], rtol=0, atol=1e-9)
    factors = robot.singularity(moved, Q, s, theta).factors
    assert np.allclose(factors, factors[0], rtol=0, atol=1e-9)
