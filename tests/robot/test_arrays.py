"""Arrays in and out: shapes, batches, layout in memory, places for results."""

from __future__ import annotations

import copy

import numpy as np
import pytest

from krhpr import Robot
from tests.robot.support import Array, arguments, assert_same, configuration, poses, results


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
