"""Batches in several threads are those of one, whatever their shapes and places."""

from __future__ import annotations

import threading
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import krhpr
from krhpr.threads import in_threads
from tests.support import THOROUGH

SMALLEST = 512


@pytest.fixture(scope="module", autouse=True)
def small_batches_are_large() -> Iterator[None]:
    """Threads are started for less than they are worth."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("krhpr.threads.SMALLEST", SMALLEST)
        yield


@pytest.fixture(scope="module", params=["compiled", "numpy"])
def robot(request: pytest.FixtureRequest) -> krhpr.Robot:
    return krhpr.load(THOROUGH[0], backend=request.param)


def same(got: Any, wanted: Any) -> None:
    np.testing.assert_allclose(got, wanted, rtol=1e-12, atol=1e-12, equal_nan=True)


@settings(max_examples=15, deadline=None)
@given(data=st.data())
def test_any_shape(robot: krhpr.Robot, data: st.DataObject) -> None:
    """Broadcast inputs, several results, poses out of reach, `out=` in strided places."""
    rng = np.random.default_rng(data.draw(st.integers(0, 1000)))
    shape = data.draw(st.sampled_from([(3000,), (2, 1500), (1500, 2), (1, 2000), (4, 1, 300), (7,), ()]))
    threads = data.draw(st.integers(1, 5))
    p, Q, redundant = (np.asarray(x) for x in robot.home)
    p = p + rng.uniform(-0.6, 0.6, (*shape, 3)) * rng.integers(0, 2, (*shape, 1))
    wanted, code = robot.inverse(p, Q, redundant, status=True)
    room = np.full((*shape, 3, 6), 7.0)
    out = room[..., ::2] if data.draw(st.booleans()) else None
    got, status = robot.inverse(p, Q, redundant, status=True, threads=threads, out=out)
    same(got, wanted)
    np.testing.assert_array_equal(status, code)
    assert out is None or (got is out and (room[..., 1::2] == 7.0).all())
    theta = np.where(np.isnan(wanted), 0.5, wanted)
    s = robot.end_points(p, Q, redundant)
    place = np.empty((*shape, 6, 6))
    results = robot.jacobians(p, Q, s, theta, threads=threads, out=(place, None))
    assert results.J is place
    for found, right in zip(results, robot.jacobians(p, Q, s, theta), strict=True):
        same(found, right)


def test_threads_are_used_where_they_are_worth_it() -> None:
    """So many slices, each in a thread of its own, for large batches alone."""
    signature = krhpr.load(THOROUGH[0]).signature("rotation_error")
    seen: list[tuple[int, int]] = []
    together = threading.Barrier(3, timeout=20)

    def call(inputs: Any, out: Any) -> tuple[Any, ...]:
        seen.append((threading.get_ident(), len(inputs[0])))
        if len(inputs[0]) == 1000:
            together.wait()
        return (np.zeros(len(inputs[0])), np.zeros(len(inputs[0]), dtype=np.intc))

    in_threads(call, signature, [np.zeros((3000, 3, 3))], None, 3)
    assert len({ident for ident, _ in seen}) == 3 and [size for _, size in seen] == [1000] * 3
    seen.clear()
    in_threads(call, signature, [np.zeros((SMALLEST, 3, 3))], None, 3)
    assert seen == [(threading.get_ident(), SMALLEST)]


@pytest.mark.parametrize("threads", [0, -1])
def test_there_is_at_least_one(robot: krhpr.Robot, threads: int) -> None:
    with pytest.raises(ValueError, match="expected 1 or more"):
        robot.end_points(*robot.home, threads=threads)


def test_errors_come_through(robot: krhpr.Robot) -> None:
    p = np.zeros((4000, 3))
    p[2345] = 9.0
    with pytest.raises(krhpr.Unreachable) as caught:
        robot.inverse(p + robot.home.p, np.eye(3), robot.home.redundant, threads=4, check=True)
    assert caught.value.index == (2345,)
