"""Where there is no answer: NaN, a status or an error, and why."""

from __future__ import annotations

import math
import pickle
import warnings

import numpy as np
import pytest

import krhpr
from krhpr import InvalidInput, Robot, Singular, Status, Unreachable
from tests.robot.support import arguments, assert_same, configuration, poses, results


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
