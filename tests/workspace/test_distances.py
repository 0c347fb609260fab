"""Distances between links against a collision library, against least squares, and where they have kinks."""

from __future__ import annotations

from typing import Any

import casadi as ca
import numpy as np
import pytest
from hypothesis import given, strategies
from scipy.optimize import lsq_linear
from scipy.spatial.transform import Rotation

import krhpr
from krhpr.generated.casadi import algebra_spatial as in_casadi
from krhpr.generated.python import algebra_spatial as in_numpy
from krhpr.trajectory import clearance
from tests.support import with_cover

coal = pytest.importorskip("coal", reason="coal has no wheel for this platform")

SPATIAL = [name for name in krhpr.catalogue() if name.startswith("spatial")]
ROBOTS = ("spatial_r_fivebar_a", "spatial_rrr_b", "spatial_delta_a", "spatial_tripteron_c")
THICK = 1e-3


def poses(robot: krhpr.Robot, count: int, seed: int = 0) -> tuple[Any, ...]:
    """Poses about home that the robot reaches: p, Q, s, theta."""
    rng = np.random.default_rng(seed)
    p = np.array(robot.home.p) + rng.uniform(-0.1, 0.1, (count, 3))
    Q = Rotation.from_rotvec(rng.uniform(-1, 1, (count, 3))).as_matrix()
    s = robot.end_points(p, Q, np.array(robot.home.redundant) * rng.uniform(0.8, 1.2, (count, 3)))
    redundant = robot.redundant_coordinates(p, Q, s)
    theta, status = robot.inverse(p, Q, redundant, status=True)
    kept = status == 0
    assert kept.sum() > count / 5
    return p[kept], Q[kept], s[kept], theta[kept]


def capsule(a: Any, b: Any) -> tuple[Any, Any]:
    """A thin capsule between two points, as coal has it."""
    length = float(np.linalg.norm(b - a))
    along = (b - a) / length
    across = np.cross(along, np.eye(3)[np.argmin(np.abs(along))])
    across /= np.linalg.norm(across)
    turned = np.stack([across, np.cross(along, across), along], axis=1)
    return coal.Capsule(THICK, length), coal.Transform3s(turned, (a + b) / 2)


def by_coal(first: tuple[Any, Any], second: tuple[Any, Any]) -> float:
    a, at_a = capsule(*first)
    b, at_b = capsule(*second)
    return float(coal.distance(a, at_a, b, at_b, coal.DistanceRequest(), coal.DistanceResult())) + 2 * THICK


@pytest.mark.parametrize("identifier", ROBOTS)
@pytest.mark.parametrize("count", [1200, pytest.param(25_000, marks=pytest.mark.full)])
def test_as_a_collision_library_has_them(identifier: str, count: int) -> None:
    """One pair of each pose, so that all pairs have their turn."""
    robot = krhpr.load(identifier)
    at = poses(robot, count)
    distances = robot.clearances(*at)
    points, attachment = robot.link_points(*at)
    pairs = clearance.pairs(robot)
    assert distances.shape[-1] == len(pairs) == len(robot.link_pairs)
    compared = 0
    for k in range(len(distances)):
        pair = pairs[k % len(pairs)]
        ends = [one.ends(points[k], attachment[k]) for one in (pair.first, pair.second)]
        if min(np.linalg.norm(b - a) for a, b in ends) < 1e-6:
            continue  # coal takes no capsule without length
        found = by_coal(*ends)
        if found > 2.1 * THICK:  # capsules that overlap have a depth, by an iteration of its own
            assert distances[k, k % len(pairs)] == pytest.approx(found, abs=1e-9), pair.name
            compared += 1
    assert compared > len(distances) / 2


def components(points: Any) -> list[Any]:
    return [tuple(point) for point in points]


def distance(points: Any) -> float:
    return float(in_numpy.segment_distance(*components(np.asarray(points, dtype=float)))[0])


def by_least_squares(points: Any) -> float:
    a_0, a_1, b_0, b_1 = np.asarray(points, dtype=float)
    found = lsq_linear(np.stack([a_1 - a_0, b_0 - b_1], axis=1), b_0 - a_0, (0, 1), method="bvls", tol=1e-15)
    return float(np.sqrt(2 * found.cost))


numbers = strategies.integers(-4, 4).map(float) | strategies.floats(-2, 2)
point = strategies.tuples(numbers, numbers, numbers)


@given(strategies.tuples(point, point, point, point))
def test_is_the_least_of_all_distances(points: Any) -> None:
    """Parallel, crossing and pointlike segments come too: their numbers are often whole."""
    assert distance(points) == pytest.approx(by_least_squares(points), abs=1e-7)


@given(strategies.tuples(point, point, point, point))
def test_does_not_depend_on_the_order(points: Any) -> None:
    a_0, a_1, b_0, b_1 = points
    found = distance(points)
    for others in ((a_1, a_0, b_0, b_1), (a_0, a_1, b_1, b_0), (b_0, b_1, a_0, a_1)):
        assert distance(others) == pytest.approx(found, abs=1e-7)


@pytest.mark.parametrize(
    ("points", "wanted"),
    [
        (((0, 0, 0), (1, 0, 0), (0.5, -1, 0), (0.5, 1, 0)), 0.0),  # they cross
        (((0, 0, 0), (1, 0, 0), (0, 0.25, 0), (1, 0.25, 0)), 0.25),  # side by side
        (((0, 0, 0), (1, 0, 0), (3, 0, 0), (1.5, 0, 0)), 0.5),  # in one line
        (((0, 0, 0), (0, 0, 0), (1, 1, 0), (1, -1, 0)), 1.0),  # a point
        (((0, 0, 0), (0, 0, 0), (0, 3, 4), (0, 3, 4)), 5.0),  # two points
        (((0, 0, 0), (1, 0, 0), (2, 1, 0), (2, -1, 1e-9)), 1.0),  # an end and an inner point
        (((0, 0, 0), (1, 0, 0), (0, 1, 0), (1, 1, 1e-12)), 1.0),  # nearly parallel
    ],
)
def test_special_positions(points: Any, wanted: float) -> None:
    assert distance(points) == pytest.approx(wanted, abs=1e-12)


def casadi_distance() -> tuple[Any, Any]:
    x = ca.SX.sym("x", 12)
    ends = [[x[3 * k + axis] for axis in range(3)] for k in range(4)]
    value = in_casadi.segment_distance(*ends)[0]
    return ca.Function("d", [x], [value]), ca.Function("slope", [x], [ca.jacobian(value, x)])


def test_slopes_are_those_of_the_distance() -> None:
    value, slope = casadi_distance()
    rng = np.random.default_rng(3)
    for _ in range(40):
        x = rng.normal(size=12)
        there = np.array(slope(x)).ravel()
        h = 1e-6
        steps = [float(value(x + h * e) - value(x - h * e)) / (2 * h) for e in np.eye(12)]
        assert there == pytest.approx(np.array(steps), abs=1e-6)
        assert np.linalg.norm(there[:6].reshape(2, 3).sum(axis=0)) == pytest.approx(1, abs=1e-9)


def test_slopes_of_a_whole_robot() -> None:
    """Of all distances with respect to everything that they depend on, by central differences."""
    robot = krhpr.load("spatial_rrr_a")
    at = [np.ravel(x[0]) for x in poses(robot, 6, seed=11)]
    function = robot.casadi.clearances

    def value(x: Any) -> Any:
        parts = np.split(x, np.cumsum([len(part) for part in at])[:-1])
        shaped = [part if len(part) == 3 else part.reshape(3, 3) for part in parts]
        return function(*shaped).full().ravel()

    x = np.concatenate(at)
    assert value(x) == pytest.approx(robot.clearances(*(x if len(x) == 3 else x.reshape(3, 3) for x in at)))
    symbols = [ca.SX.sym(f"x{k}", *function.size_in(k)) for k in range(4)]
    jacobian = ca.jacobian(function(*symbols), ca.vertcat(*(ca.vec(symbol.T) for symbol in symbols)))
    slopes = np.array(
        ca.Function("slopes", symbols, [ca.densify(jacobian)])(
            *(part if len(part) == 3 else part.reshape(3, 3) for part in at)
        )
    )
    h = 1e-6
    differences = np.stack([(value(x + h * e) - value(x - h * e)) / (2 * h) for e in np.eye(len(x))], axis=1)
    assert slopes == pytest.approx(differences, abs=1e-6)
    assert (np.abs(slopes).max(axis=0) > 1e-3).any()


def test_slopes_are_finite_where_links_touch() -> None:
    _, slope = casadi_distance()
    assert np.isfinite(np.array(slope([0, 0, 0, 1, 0, 0, 0.5, -1, 0, 0.5, 1, 0]))).all()
    assert np.isfinite(np.array(slope([0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0]))).all()


@pytest.mark.parametrize("identifier", with_cover(SPATIAL, ROBOTS))
def test_pairs_are_those_that_no_joint_joins(identifier: str) -> None:
    """In random configurations, links of a pair never have a point in common; those left out always."""
    robot = krhpr.load(identifier)
    at = poses(robot, 40, seed=5)
    points, attachment = robot.link_points(*at)
    links = clearance.segments(robot)
    paired = {frozenset((pair.first, pair.second)) for pair in clearance.pairs(robot)}
    assert len(paired) == len(clearance.pairs(robot))
    for i, first in enumerate(links):
        for second in links[:i]:
            gap = clearance.separation(first.ends(points, attachment), second.ends(points, attachment))
            joined = np.linalg.norm(gap, axis=-1).max() < 1e-9
            if joined:
                assert frozenset((first, second)) not in paired, (first.name, second.name)
            else:
                assert frozenset((first, second)) in paired, (first.name, second.name)


def test_both_backends_agree() -> None:
    at = poses(krhpr.load("spatial_r_fivebar_a"), 50)
    one, other = (krhpr.load("spatial_r_fivebar_a", backend=name).clearances(*at) for name in (None, "numpy"))
    assert one == pytest.approx(other, abs=1e-14)


def test_planar_robots_have_none() -> None:
    robot = krhpr.load("planar_rr_a")
    assert robot.link_pairs == ()
    with pytest.raises(AttributeError, match="no function 'clearances'"):
        robot.call("clearances")
