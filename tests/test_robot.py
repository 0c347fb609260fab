"""Robots as people use them: broadcasting, branches, statuses and errors, on both backends."""

from __future__ import annotations

import copy
import math
import os
import pickle
import warnings
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np
import pytest

import krhpr
from krhpr import GeneratedMismatch, InvalidInput, Robot, Singular, Status, UnknownBranch, Unreachable
from krhpr import backend as backend_module
from krhpr.defaults import SIGNS
from tests.support import run_python

ROBOTS = ("spatial_rrr_a", "spatial_r_fivebar_a", "spatial_rrr_c", "planar_rr_a")
"""One of each kind: open and closed legs, redundant links and slides, space and plane."""
BACKENDS = ("numpy", "compiled")
Array = np.ndarray[Any, Any]


@dataclass(frozen=True)
class Pose:
    """A pose inside the working box, with the redundant coordinates."""

    p: Array
    orientation: Array
    redundant: Array

    def __iter__(self) -> Iterator[Array]:
        return iter((self.p, self.orientation, self.redundant))


def rotation(angles: Array) -> Array:
    """Rotations (..., 3, 3) by the angles (..., 3) about z, y and x."""
    cosines, sines = np.moveaxis(np.cos(angles), -1, 0), np.moveaxis(np.sin(angles), -1, 0)
    zero, one = np.zeros_like(sines[0]), np.ones_like(sines[0])
    (cz, cy, cx), (sz, sy, sx) = cosines, sines
    z = np.stack([cz, -sz, zero, sz, cz, zero, zero, zero, one], -1)
    y = np.stack([cy, zero, sy, zero, one, zero, -sy, zero, cy], -1)
    x = np.stack([one, zero, zero, zero, cx, -sx, zero, sx, cx], -1)
    Z, Y, X = (part.reshape((*part.shape[:-1], 3, 3)) for part in (z, y, x))
    return Z @ Y @ X


def poses(robot: Robot, *batch: int, seed: int = 0) -> Pose:
    """Random poses near the middle of the workspace."""
    random = np.random.default_rng(seed)
    slides = robot.documentation["redundant"][0][0] == "d"
    middle, spread = (0.12, 0.03) if slides else (1.5, 0.3)
    redundant = middle + spread * random.uniform(-1, 1, (*batch, 3))
    if robot.planar:
        return Pose(0.03 * random.normal(size=(*batch, 2)), 0.1 * random.normal(size=batch), redundant)
    p = np.array([0, 0, 0.45]) + 0.02 * random.normal(size=(*batch, 3))
    return Pose(p, rotation(0.1 * random.normal(size=(*batch, 3))), redundant)


def configuration(robot: Robot, *batch: int, seed: int = 0) -> tuple[Array, Array, Array, Array]:
    """(p, Q, s, theta) of random poses."""
    pose = poses(robot, *batch, seed=seed)
    return pose.p, pose.orientation, robot.end_points(*pose), robot.inverse(*pose)


def results(answer: Any) -> tuple[Array, ...]:
    return answer if isinstance(answer, tuple) else (answer,)


def assert_same(first: Any, second: Any, tolerance: float = 0.0) -> None:
    for one, other in zip(results(first), results(second), strict=True):
        scale = max(1.0, np.abs(one[np.isfinite(one)]).max(initial=0))
        np.testing.assert_allclose(one, other, rtol=0, atol=tolerance * scale)


@cache
def load(identifier: str, backend: str) -> Robot:
    return krhpr.load(identifier, backend=backend)


@pytest.fixture(params=BACKENDS)
def backend(request: pytest.FixtureRequest) -> str:
    return str(request.param)


@pytest.fixture(params=ROBOTS)
def robot(request: pytest.FixtureRequest, backend: str) -> Robot:
    return load(request.param, backend)


@pytest.fixture
def spatial(backend: str) -> Robot:
    return load("spatial_rrr_a", backend)


@pytest.fixture
def planar(backend: str) -> Robot:
    return load("planar_rr_a", backend)


@pytest.fixture
def fivebar(backend: str) -> Robot:
    return load("spatial_r_fivebar_a", backend)


def arguments(robot: Robot, function: str, *batch: int, seed: int = 0) -> tuple[Array, ...]:
    """Sensible arguments of any function, each with the same batch dimensions."""
    random = np.random.default_rng(seed)
    p, Q, s, theta = configuration(robot, *batch, seed=seed)
    redundant = poses(robot, *batch, seed=seed).redundant
    signs = np.broadcast_to(robot.mode_signs(), (*batch, *robot.mode_signs().shape))
    known = {"p": p, "Q": Q, "phi": Q, "s": s, "theta": theta, "redundant": redundant, "mode": signs}
    known["theta_near"] = theta + 0.1
    known |= dict.fromkeys(SIGNS, np.ones(batch))
    known |= {"p_near": p, "Q_near": Q, "phi_near": Q, "tolerance": np.full(batch, 0.01)}
    known["characteristic_length"] = np.full(batch, 0.3)
    known["box"] = np.broadcast_to(np.radians([30.0, 150.0]), (*batch, 3, 2))
    known |= {"normal_forces": np.ones((*batch, 3)), "friction": np.full(batch, 1e6)}
    known["weights"] = np.broadcast_to([1000.0, 1000.0, 1000.0], (*batch, 3))
    if robot.assemblies:
        shape = robot.assembly_signs().shape
        known["assembly"] = np.broadcast_to(robot.assembly_signs(), (*batch, *shape))
    known |= {f"measured of {count}": redundant[..., :count] for count in (1, 2, 3)}
    return tuple(
        known[f"measured of {port.shape[0]}"]
        if port.name == "measured"
        else known[port.name]
        if port.name in known
        else random.normal(size=(*batch, *port.shape))
        for port in robot.signature(function).inputs
    )


CASES = [(identifier, name) for identifier in ROBOTS for name in krhpr.load(identifier).functions]


@pytest.fixture(params=CASES, ids=".".join)
def case(request: pytest.FixtureRequest, backend: str) -> tuple[Robot, str]:
    """Every function of every robot."""
    identifier, function = request.param
    return load(identifier, backend), function


# -- arrays --------------------------------------------------------------------------------------------------


def test_shapes_are_those_of_the_signature(case: tuple[Robot, str]) -> None:
    robot, function = case
    for batch in ((), (1,), (4,), (2, 3), (0,), (3, 0)):
        answer, status = robot.call(function, *arguments(robot, function, *batch), status=True)
        for port, result in zip(robot.signature(function).outputs, results(answer), strict=True):
            assert result.shape == (*batch, *port.shape)
            assert result.dtype == np.float64
        assert np.shape(status) == batch
        assert not np.any(status)


def test_a_batch_is_its_elements(case: tuple[Robot, str]) -> None:
    robot, function = case
    given = arguments(robot, function, 2, 3)
    together = results(robot.call(function, *given))
    for index in np.ndindex(2, 3):
        alone = results(robot.call(function, *(array[index] for array in given)))
        assert_same(tuple(result[index] for result in together), alone, 1e-12)


def test_batch_dimensions_broadcast(case: tuple[Robot, str]) -> None:
    robot, function = case
    given = arguments(robot, function, 5)
    wide = [array[:, None] if n % 2 else array[None] for n, array in enumerate(given)]
    answer = results(robot.call(function, *wide, check_rotation=False))
    full = np.broadcast_shapes(*(array.shape[:2] for array in wide))
    spread = [np.broadcast_to(array, (*full, *array.shape[2:])) for array in wide]
    assert_same(answer, results(robot.call(function, *map(np.copy, spread))), 1e-13)
    alike = tuple(result[tuple(np.diag_indices(5))] for result in answer) if full == (5, 5) else None
    if alike is not None:
        assert_same(alike, robot.call(function, *given), 1e-13)


def test_layout_in_memory_does_not_matter(case: tuple[Robot, str]) -> None:
    robot, function = case
    given = arguments(robot, function, 4)
    plain = robot.call(function, *given)
    fortran = [np.asfortranarray(array) for array in given]
    strided = [
        np.repeat(np.repeat(array, 2, 0), 3, -1)[::2, ..., ::3] if array.ndim > 1 else array
        for array in given
    ]
    backwards = [array[::-1].copy()[::-1] for array in given]
    swapped = [array.astype(">f8") for array in given]
    unaligned = [_unaligned(array) for array in given]
    lists = [array.tolist() for array in given]
    for variant in (fortran, strided, backwards, swapped, unaligned, lists):
        assert_same(robot.call(function, *variant), plain)


def _unaligned(array: Array) -> Array:
    buffer = np.empty(array.nbytes + 1, dtype=np.uint8)
    view = buffer[1:].view(np.float64).reshape(array.shape)
    view[...] = array
    return view


def test_arguments_are_not_changed(case: tuple[Robot, str]) -> None:
    robot, function = case
    given = arguments(robot, function, 3)
    for array in given:
        array.setflags(write=False)
    before = copy.deepcopy(given)
    robot.call(function, *given)
    assert all(np.array_equal(a, b) for a, b in zip(given, before, strict=True))


def test_results_go_where_they_are_asked_to(case: tuple[Robot, str]) -> None:
    robot, function = case
    given = arguments(robot, function, 3)
    plain = results(robot.call(function, *given))
    out = tuple(np.full_like(result, 7.0) for result in plain)
    answer = robot.call(function, *given, out=out if len(out) > 1 else out[0])
    assert all(result is place for result, place in zip(results(answer), out, strict=True))
    assert_same(out, plain)
    strided = tuple(np.full((6, *result.shape[1:]), 7.0)[::2] for result in plain)
    robot.call(function, *given, out=strided if len(strided) > 1 else strided[0])
    assert_same(strided, plain)


def test_some_of_several_results_can_be_given_a_place(spatial: Robot) -> None:
    given = configuration(spatial, 3)
    J, K = spatial.jacobians(*given)
    place = np.empty_like(K)
    answer = spatial.jacobians(*given, out=(None, place))
    assert answer.K is place
    assert_same(answer, (J, K))


def test_a_place_of_another_shape_is_refused(spatial: Robot) -> None:
    with pytest.raises(ValueError, match=r"shape|dimension"):
        spatial.end_points(*poses(spatial, 3), out=np.empty((2, 3, 3)))
    for out in (np.empty((2, 6, 6)), (np.empty((6, 6)),)):
        with pytest.raises(ValueError, match="jacobians gives J, K: out takes a tuple of 2 arrays"):
            spatial.jacobians(*configuration(spatial), out=out)


def test_whole_and_single_precision_numbers_are_taken(planar: Robot) -> None:
    wanted = planar.inverse([0.0, 0.0], 0.0, [1.0, 1.0, 1.0])
    assert_same(planar.inverse([0, 0], 0, np.ones(3, dtype=np.float32)), wanted)


# -- what is wrong with arguments ----------------------------------------------------------------------------


def test_a_wrong_shape_names_argument_and_shapes(spatial: Robot) -> None:
    p, Q, redundant = poses(spatial)
    with pytest.raises(
        ValueError, match=r"spatial_rrr_a\.inverse: 'p' has shape \(2,\), expected \(\.\.\., 3\): position"
    ):
        spatial.inverse(p[:2], Q, redundant)
    with pytest.raises(ValueError, match=r"'Q' has shape \(3,\), expected \(\.\.\., 3, 3\)"):
        spatial.inverse(p, Q[0], redundant)
    with pytest.raises(ValueError, match=r"'mode' has shape \(2,\), expected \(\.\.\., 3, 2\)"):
        spatial.inverse(p, Q, redundant, mode=[1, -1])


def test_batches_that_do_not_fit_are_named(spatial: Robot) -> None:
    p, Q, redundant = poses(spatial, 4)
    with pytest.raises(
        ValueError, match=r"batch dimensions do not broadcast: p \(4,\), Q \(4,\), redundant \(3,\)"
    ):
        spatial.end_points(p, Q, redundant[:3])


@pytest.mark.parametrize("value", [[[0, 0], [0]], "ab", ["a", 0], {"x": 1}])
def test_what_is_no_array_of_numbers_is_named(planar: Robot, value: Any) -> None:
    with pytest.raises((TypeError, ValueError), match=r"planar_rr_a\.end_points: 'p' is no array of numbers"):
        planar.end_points(value, 0, [1, 1, 1])


def test_unknown_functions_and_too_few_arguments(planar: Robot) -> None:
    with pytest.raises(AttributeError, match="planar_rr_a has no function 'invert'; it has end_points, "):
        load("planar_rr_a", "numpy").signature("invert")
    with pytest.raises(AttributeError, match="planar_rr_a has no function 'invert'; it has end_points, "):
        planar.call("invert")
    with pytest.raises(TypeError, match=r"end_points takes 3 arrays \(p, phi, redundant\), got 1"):
        planar.call("end_points", [0, 0])


# -- rotations -----------------------------------------------------------------------------------------------


def test_a_matrix_that_is_no_rotation_is_refused(spatial: Robot) -> None:
    p, Q, redundant = poses(spatial, 2, 3)
    Q[1, 2] *= 1.001
    with pytest.raises(InvalidInput, match=r"Q\[1, 2\] is not a rotation matrix: .* is 0\.002") as caught:
        spatial.inverse(p, Q, redundant)
    assert caught.value.index == (1, 2)
    assert "det Q is 1" in str(caught.value)
    spatial.inverse(p, Q, redundant, check_rotation=False)


def test_a_reflection_is_no_rotation(spatial: Robot) -> None:
    p, Q, redundant = poses(spatial)
    with pytest.raises(InvalidInput, match=r"Q is not a rotation matrix: .* det Q is -1"):
        spatial.inverse(p, -Q, redundant)


def test_a_rotation_within_rounding_passes(spatial: Robot) -> None:
    p, Q, redundant = poses(spatial)
    spatial.inverse(p, Q + 1e-7, redundant)


def test_no_rotations_need_no_check(spatial: Robot) -> None:
    assert spatial.inverse(*poses(spatial, 0)).shape == (0, 3, 3)


# -- statuses ------------------------------------------------------------------------------------------------


def test_out_of_reach_is_nan_a_status_or_an_error(robot: Robot) -> None:
    p, Q, redundant = poses(robot, 4)
    far = p.copy()
    far[2] += 9.0
    theta, status = robot.inverse(far, Q, redundant, status=True)
    assert [Status(code) for code in status] == [Status.OK, Status.OK, Status.UNREACHABLE_LEG_1, Status.OK]
    assert np.isnan(theta[2]).all() and np.isfinite(theta[[0, 1, 3]]).all()
    assert_same(robot.inverse(far, Q, redundant), theta)

    with pytest.raises(Unreachable, match=r"inverse\[2\]: leg 1 cannot reach its end point; it is") as caught:
        robot.inverse(far, Q, redundant, check=True)
    error = caught.value
    codes, excess = robot.inverse_status(far, Q, redundant)
    assert (error.leg, error.index) == (1, (2,))
    assert error.distance == pytest.approx(excess[2, 0]) and error.distance > 1
    assert np.array_equal(codes, status)
    assert isinstance(error, ValueError) and isinstance(error, krhpr.KrhprError)
    again = pickle.loads(pickle.dumps(error))
    assert (str(again), again.leg, again.distance, again.index) == (str(error), 1, error.distance, (2,))


def test_one_leg_out_of_reach_leaves_the_others(robot: Robot) -> None:
    pose = poses(robot)
    alone = robot.with_geometry(l_2=[*robot.geometry.l_2[:2], 5.0])
    theta, status = alone.inverse(*pose, status=True)
    assert Status(int(status)) is Status.UNREACHABLE_LEG_3
    assert np.isnan(theta[2]).all()
    assert_same(theta[:2], robot.inverse(*pose)[:2], 1e-13)
    with pytest.raises(Unreachable) as caught:
        alone.inverse_all(*pose, check=True)
    assert (caught.value.leg, caught.value.index) == (3, ())
    assert caught.value.distance == pytest.approx(alone.inverse_status(*pose)[1][2])
    assert np.all(alone.inverse_status(*pose)[1][:2] < 0)


def test_where_the_distance_cannot_be_told_none_is_claimed(robot: Robot) -> None:
    s = robot.end_points(*poses(robot)) + 9.0
    with pytest.raises(Unreachable, match=r"leg 1 cannot reach its end point\. Change") as caught:
        robot.subleg_inverse(s, check=True)
    assert math.isnan(caught.value.distance)


def test_inside_reach_nothing_is_raised(robot: Robot) -> None:
    robot.inverse(*poses(robot, 5), check=True)
    status, excess = robot.inverse_status(*poses(robot, 5))
    assert not np.any(status) and np.all(excess <= 0)


def test_a_singular_leg_says_so(spatial: Robot, planar: Robot) -> None:
    stretched = {"spatial_rrr_a": 2, "planar_rr_a": 1}
    for robot in (spatial, planar):
        p, Q, s, theta = configuration(robot)
        theta[1, stretched[robot.identifier]] = 0.0
        s = robot.subleg_forward(theta)
        rates = np.zeros(3 if robot.planar else 6)
        with pytest.raises(
            Singular, match=r"joint_rates: singular configuration, a factor of det M_2"
        ) as caught:
            robot.joint_rates(p, Q, s, theta, rates, check=True)
        assert (caught.value.status, caught.value.index) == (Status.SINGULAR_LEG_2, ())
        answer, status = robot.joint_rates(p, Q, s, theta, rates, status=True)
        assert status == Status.SINGULAR_LEG_2
        assert np.isnan(answer[1]).all() and np.isfinite(answer[[0, 2]]).all()


def test_a_singular_platform_says_which_determinant(spatial: Robot, planar: Robot) -> None:
    p, Q, s, theta = configuration(spatial, 2)
    s[1] = [[0.1, 0, 0.4], [0.2, 0, 0.4], [0.3, 0, 0.4]]  # on one line
    rates = np.zeros_like(theta)
    with pytest.raises(Singular, match=r"twist\[1\]: singular configuration, det J_") as caught:
        spatial.twist(p, Q, s, theta, rates, check=True)
    assert caught.value.status in (Status.SINGULAR_IN_PLANE, Status.SINGULAR_NORMAL)
    assert caught.value.index == (1,)

    p, phi, redundant = poses(planar)
    redundant = np.zeros(3)  # the redundant links' lines meet in O'
    s, theta = planar.end_points(p, phi, redundant), planar.inverse(p, phi, redundant)
    with pytest.raises(Singular, match=r"det J_a = 0") as caught:
        planar.twist(p, phi, s, theta, np.zeros((3, 2)), check=True)
    assert caught.value.status == Status.SINGULAR_IN_PLANE
    twist, status = planar.twist(p, phi, s, theta, np.zeros((3, 2)), status=True)
    assert np.isnan(twist).all() and status == Status.SINGULAR_IN_PLANE


@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf])
def test_nan_and_infinity_are_invalid_input(case: tuple[Robot, str], value: float) -> None:
    robot, function = case
    given = list(arguments(robot, function, 3))
    for n in range(len(given)):
        spoiled = [array.copy() for array in given]
        spoiled[n][1] = value
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            answer, status = robot.call(function, *spoiled, status=True)
        assert [Status(int(code)) for code in status] == [Status.OK, Status.INVALID_INPUT, Status.OK]
        assert all(np.isnan(result[1]).all() for result in results(answer))
        with pytest.raises(InvalidInput, match=r"\[1\]: an input is NaN or infinite") as caught:
            robot.call(function, *spoiled, check=True)
        assert caught.value.index == (1,)


# -- branches ------------------------------------------------------------------------------------------------


def test_every_mode_by_label_labels_or_signs(robot: Robot) -> None:
    pose = poses(robot, 2)
    everything = robot.inverse_all(*pose)
    assert everything.shape[-2] == len(robot.modes)
    for n, mode in enumerate(robot.modes):
        theta = robot.inverse(*pose, mode=mode)
        assert_same(theta, everything[..., n, :], 1e-13)
        assert_same(robot.inverse(*pose, mode=[mode] * 3), theta)
        assert_same(robot.inverse(*pose, mode=robot.mode_signs(mode)), theta)
        assert_same(robot.inverse(*pose, mode=robot.mode_signs(mode).astype(int).tolist()), theta)
    assert_same(robot.inverse(*pose), robot.inverse(*pose, mode=robot.default_mode))


def test_each_leg_and_each_element_may_have_its_own_mode(robot: Robot) -> None:
    pose = poses(robot)
    everything = robot.inverse_all(*pose)
    choice = [0, len(robot.modes) - 1, 1]
    labels = tuple(robot.modes[n] for n in choice)
    assert_same(robot.inverse(*pose, mode=labels), everything[range(3), choice], 1e-13)
    signs = np.stack([robot.mode_signs(mode) for mode in robot.modes])
    assert_same(np.moveaxis(robot.inverse(*pose, mode=signs), 0, 1), everything, 1e-13)


@pytest.mark.parametrize("mode", ["upwards", ["elbow+", "elbow+"], ["elbow+"] * 2 + ["down"], "", []])
def test_an_unknown_mode_names_those_there_are(planar: Robot, mode: Any) -> None:
    with pytest.raises(ValueError, match=r"give one of elbow\+, elbow-, or one for each|has shape"):
        planar.inverse(*poses(planar), mode=mode)


@pytest.mark.parametrize("wrong", [0, 0.5, np.nan])
def test_signs_are_plus_or_minus_one(planar: Robot, wrong: float) -> None:
    with pytest.raises(UnknownBranch, match=r"the signs of a working mode are \+1 or -1, got"):
        planar.inverse(*poses(planar), mode=[[1], [wrong], [-1]])


def test_assembly_modes(fivebar: Robot, planar: Robot) -> None:
    theta = fivebar.inverse(*poses(fivebar))
    found = {label: fivebar.subleg_forward(theta, label) for label in fivebar.assemblies}
    s = fivebar.end_points(*poses(fivebar))
    assert any(np.allclose(answer, s, rtol=0, atol=1e-12) for answer in found.values())
    left, right = fivebar.assemblies
    mixed = fivebar.subleg_forward(theta, [left, right, left])
    assert_same(mixed, np.stack([found[left][0], found[right][1], found[left][2]]), 1e-13)
    with pytest.raises(UnknownBranch, match="'up' is not an assembly mode; give one of left, right"):
        fivebar.subleg_forward(theta, "up")
    with pytest.raises(UnknownBranch, match="no assembly modes of its sub-legs are told apart by signs"):
        planar.subleg_forward(planar.inverse(*poses(planar)), "left")


def test_near_chooses_the_mode_and_continues_beyond_a_half_turn(robot: Robot) -> None:
    pose = poses(robot)
    angles = np.array(robot._module.ANGULAR)
    for mode in robot.modes:
        theta = robot.inverse(*pose, mode=mode)
        for turns in (-2, 0, 1):
            shifted = theta + 2 * np.pi * turns * angles
            near = shifted + 0.01
            assert_same(robot.inverse(*pose, near=near), shifted, 1e-13)
    with pytest.raises(UnknownBranch, match="either a mode or joints to stay near, not both"):
        robot.inverse(*pose, near=theta, mode=robot.default_mode)


def test_a_path_followed_near_its_last_joints_is_continuous(robot: Robot) -> None:
    start, end = poses(robot, seed=1), poses(robot, seed=2)
    theta = robot.inverse(*start)
    for share in np.linspace(0, 1, 60):
        p, redundant = (a + share * (b - a) for a, b in ((start.p, end.p), (start.redundant, end.redundant)))
        following = robot.inverse(p, start.orientation, redundant, near=theta)
        assert np.abs(following - theta).max() < 0.2
        theta = following


# -- geometry ------------------------------------------------------------------------------------------------


def test_geometry_is_changed_in_a_copy(robot: Robot) -> None:
    longer = robot.with_geometry(l_2=1.1 * robot.geometry.l_2)
    assert longer.geometry != robot.geometry
    assert longer.backend == robot.backend
    pose = poses(robot)
    assert not np.allclose(longer.inverse(*pose), robot.inverse(*pose))
    same = longer.with_geometry(l_2=robot.geometry.l_2)
    assert same.geometry == robot.geometry and hash(same.geometry) == hash(robot.geometry)
    assert_same(same.inverse(*pose), robot.inverse(*pose))


def test_legs_may_differ(robot: Robot) -> None:
    lengths = robot.geometry.l_2 * [1.0, 1.02, 0.99]
    unequal = robot.with_geometry(l_2=lengths)
    p, Q, s, theta = configuration(unequal, 4)
    for leg in range(3):
        alike = robot.with_geometry(l_2=lengths[leg])
        assert_same(theta[:, leg], alike.inverse(*poses(robot, 4))[:, leg], 1e-13)
    assert_same(unequal.constraints(p, Q, s), np.zeros(unequal.constraints(p, Q, s).shape), 1e-14)
    assembly = [None, *robot.assemblies]
    found = [unequal.subleg_forward(theta, label) for label in (robot.assemblies or (None,))]
    assert len(assembly) > 0 and any(np.allclose(answer, s, rtol=0, atol=1e-12) for answer in found)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"l_99": 1}, "geometry: unknown field l_99; the fields are"),
        ({"l_1": "long"}, "'l_1' is 'long'; expected a number, or one for each leg"),
        ({"l_2": 0.0}, "must be positive"),
        ({"l_2": -1.0}, "must be positive"),
        ({"l_2": np.nan}, "must be finite"),
        ({"l_2": [1.0, 2.0]}, r"has shape \(2,\)"),
        ({"l_2": "long"}, "long"),
    ],
)
def test_a_geometry_that_makes_no_sense_is_refused(
    planar: Robot, change: dict[str, Any], message: str
) -> None:
    with pytest.raises(ValueError, match=message):
        planar.with_geometry(**change)


def test_geometry_cannot_be_changed_by_accident(planar: Robot) -> None:
    with pytest.raises(ValueError, match="read-only"):
        planar.geometry.l_2[0] = 1.0


# -- backends ------------------------------------------------------------------------------------------------


def found_in_doubt(robot: Robot, name: str) -> bool:
    """Whether solutions may be in doubt behind a function: it says so, or it counts those in a box."""
    signature = robot.signature(name)
    inputs, outputs = ({port.name for port in ports} for ports in (signature.inputs, signature.outputs))
    return "doubtful" in outputs or {"box", "count"} <= inputs | outputs


def doubtful(robot: Robot, name: str, given: tuple[Array, ...], found: Any) -> Array:
    """How many places may hold further solutions, for each call of a function with `found_in_doubt`."""
    if "doubtful" in found._fields:
        return found.doubtful
    known = dict(zip((port.name for port in robot.signature(name).inputs), given, strict=True))
    for before in ("subleg_forward", "forward_all"):
        inputs = [known[port.name] for port in robot.signature(before).inputs]
        found = robot.call(before, *inputs)
        known["s"] = known.get("s", results(found)[0])
    return found.doubtful


@pytest.mark.compiler
@pytest.mark.parametrize(("identifier", "name"), CASES, ids=map(".".join, CASES))
def test_backends_agree(identifier: str, name: str, full: bool) -> None:
    robots = [load(identifier, backend) for backend in BACKENDS]
    given = arguments(robots[0], name, 20_000 if full else 200)
    numpy, compiled = (robot.call(name, *given, status=True) for robot in robots)
    assert np.array_equal(numpy[1], compiled[1])
    sure = np.full(np.shape(numpy[1]), True)
    if found_in_doubt(robots[0], name):  # what is in doubt may be found by one alone
        doubts = [
            doubtful(robot, name, given, found)
            for robot, (found, _) in zip(robots, (numpy, compiled), strict=True)
        ]
        assert np.array_equal(*doubts)
        sure = doubts[0] == 0
        assert sure.mean() > 0.95
    one, other = ([values[sure] for values in results(found)] for found in (numpy[0], compiled[0]))
    assert_same(tuple(one), tuple(other), 1e-9)


@pytest.mark.compiler
def test_backends_agree_where_there_is_no_answer() -> None:
    robots = [load("spatial_r_fivebar_a", name) for name in BACKENDS]
    p, Q, redundant = poses(robots[0], 300)
    p = p * np.random.default_rng(3).uniform(0, 3, (300, 1))
    for name in ("inverse", "inverse_all", "inverse_status"):
        inputs = (p, Q, redundant, robots[0].mode_signs())[: len(robots[0].signature(name).inputs)]
        numpy, compiled = (robot.call(name, *inputs, status=True) for robot in robots)
        assert np.array_equal(numpy[1], compiled[1])
        assert 0 < np.count_nonzero(numpy[1]) < 300
        assert np.array_equal(np.isnan(numpy[0]), np.isnan(compiled[0]))
        assert_same(numpy[0], compiled[0], 1e-9)


def test_the_backend_is_chosen_by_name_or_environment(monkeypatch: pytest.MonkeyPatch) -> None:
    assert krhpr.load("planar_rr_a", backend="numpy").backend == "numpy"
    monkeypatch.setenv("KRHPR_BACKEND", "numpy")
    assert krhpr.load("planar_rr_a").backend == "numpy"
    assert krhpr.load("planar_rr_a").with_geometry(l_1=0.2).backend == "numpy"
    monkeypatch.setenv("KRHPR_BACKEND", "fortran")
    with pytest.raises(ValueError, match=r"'fortran' \(KRHPR_BACKEND\); there are auto, compiled, numpy"):
        krhpr.load("planar_rr_a")
    with pytest.raises(ValueError, match="no backend is called 'C'; there are"):
        krhpr.load("planar_rr_a", backend="C")


@pytest.mark.compiler
def test_compiled_kernels_are_chosen_by_name_or_environment(monkeypatch: pytest.MonkeyPatch) -> None:
    assert krhpr.load("planar_rr_a", backend="compiled").backend == "compiled"
    monkeypatch.setenv("KRHPR_BACKEND", "numpy")
    assert krhpr.load("planar_rr_a", backend="compiled").backend == "compiled"
    monkeypatch.setenv("KRHPR_BACKEND", "compiled")
    assert krhpr.load("planar_rr_a").backend == "compiled"


@pytest.fixture
def no_compiler(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """No compiler, and nothing compiled before."""
    memories: tuple[Callable[[], None], ...] = (
        backend_module._library.cache_clear,
        backend_module._extension.cache_clear,
        backend_module._warn_slow.cache_clear,
    )
    for forget in memories:
        forget()
    monkeypatch.setenv("KRHPR_CC", "none")
    monkeypatch.delenv("KRHPR_BACKEND", raising=False)
    yield
    for forget in memories:
        forget()


@pytest.mark.usefixtures("no_compiler")
def test_without_a_compiler_it_warns_once_and_works() -> None:
    with pytest.warns(
        RuntimeWarning, match="KRHPR_CC is set to none.* pure NumPy modules are used"
    ) as caught:
        robot = krhpr.load("planar_rr_a")
        theta = robot.inverse(*poses(robot))
        krhpr.load("spatial_rrr_a").end_points(*poses(krhpr.load("spatial_rrr_a")))
        robot.with_geometry(l_1=0.2).inverse(*poses(robot))
    assert len(caught) == 1
    assert caught[0].filename == __file__
    assert robot.backend == "numpy"
    assert_same(theta, load("planar_rr_a", "numpy").inverse(*poses(robot)))


@pytest.mark.usefixtures("no_compiler")
def test_without_a_compiler_compiled_kernels_cannot_be_had() -> None:
    with pytest.raises(krhpr.backend.NoCompiler, match="KRHPR_CC is set to none"):
        _ = krhpr.load("planar_rr_a", backend="compiled").backend


def test_without_the_headers_of_python_it_falls_back_too(monkeypatch: pytest.MonkeyPatch) -> None:
    from krhpr.native import NoCompiler

    def missing() -> None:
        raise NoCompiler("Python's C headers are missing")

    backend_module._extension.cache_clear()
    backend_module._warn_slow.cache_clear()
    monkeypatch.setattr(backend_module, "extension_paths", missing)
    with pytest.warns(RuntimeWarning, match="headers are missing"):
        assert krhpr.load("planar_rr_a").backend == "numpy"


def test_robots_can_be_sent_to_other_processes(robot: Robot) -> None:
    changed = robot.with_geometry(l_2=robot.geometry.l_2 * 1.1)
    pose = poses(robot)
    wanted = changed.inverse(*pose)
    for again in (pickle.loads(pickle.dumps(changed)), copy.deepcopy(changed), copy.copy(changed)):
        assert again.geometry == changed.geometry and again.backend == changed.backend
        assert_same(again.inverse(*pose), wanted)


# -- the catalogue -------------------------------------------------------------------------------------------


def test_robots_describe_themselves(robot: Robot) -> None:
    assert repr(robot) == f"<Robot {robot.identifier} {robot.notation}: {robot.title}>"
    assert robot.planar == robot.identifier.startswith("planar")
    assert robot.default_mode in robot.modes
    assert set(robot.functions) >= {"inverse", "inverse_all", "end_points", "twist", "singularity"}
    assert set(robot.documentation["geometry"]) and [
        name for name, _ in robot.documentation["geometry"]
    ] == list(robot.geometry.order)
    assert {unit for _, unit in robot.documentation["units"]} <= {"m", "rad"}


def test_an_unknown_robot_gives_the_nearest_names() -> None:
    with pytest.raises(
        krhpr.UnknownRobot, match=r"no robot is called 'spatial_rr_a'; did you mean spatial_rrr_a"
    ):
        krhpr.load("spatial_rr_a")
    with pytest.raises(KeyError, match="there are spatial_rrr_a, "):
        krhpr.load("zzz")


def test_robots_written_by_another_version_are_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    import krhpr.generated

    monkeypatch.setattr(krhpr.generated, "VERSION", "0.0.1")
    with pytest.raises(
        GeneratedMismatch, match=r"written by krhpr 0\.0\.1, this is krhpr .*run `krhpr generate`"
    ):
        krhpr.load("planar_rr_a")
    monkeypatch.delattr(krhpr.generated, "VERSION")
    with pytest.raises(GeneratedMismatch, match="of an unknown version"):
        krhpr.catalogue()


USE = """
import sys

class Blocked:
    def find_spec(self, name, path=None, target=None):
        if name.partition(".")[0] not in {"krhpr", "numpy", *sys.stdlib_module_names}:
            raise ImportError(f"{name} is not needed")

sys.meta_path.insert(0, Blocked())
from krhpr.generated import planar_rr_a as robot

theta, status = robot.inverse([0.01, -0.02], 0.1, [1.5, 1.4, 1.6], status=True)
print(theta.ravel().tolist(), int(status), robot.Status(0).name)
print(sorted(name for name in sys.modules if name.startswith("krhpr")))
"""


def test_a_generated_module_takes_numpy_alone() -> None:
    run = run_python("-c", USE, env={"KRHPR_CC": "none"})
    assert run.returncode == 0, run.stderr
    numbers, modules = run.stdout.splitlines()
    theta = load("planar_rr_a", "numpy").inverse([0.01, -0.02], 0.1, [1.5, 1.4, 1.6])
    assert numbers == f"{theta.ravel().tolist()} 0 OK"
    assert "krhpr.robot" not in modules and "krhpr.backend" not in modules
    assert os.path.basename(krhpr.generated.__path__[0]) == "generated"
