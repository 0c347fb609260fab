"""What is wrong with arguments is named, and rotations are rotations."""

from __future__ import annotations

from typing import Any

import pytest

from krhpr import InvalidInput, Robot
from tests.robot.support import load, poses


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
