"""Random configurations: exact ones close without rounding, those in doubles are reachable and well
conditioned.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from krhpr.codegen.kernel import LEGS, Frame, Layout, Port, Unit
from krhpr.validation import configurations
from krhpr.validation.configurations import LEGS_BY_NAME, configuration
from krhpr.validation.draw import Draw
from krhpr.validation.evaluation import evaluate
from krhpr.validation.numbers import Angle, Ball, Exact, ball_precision
from krhpr.validation.sampling import draw, rotations
from krhpr.validation.scale import difference, relative, scale, worst_of
from tests.validation.support import IDENTIFIERS, subject

ROBOTS = pytest.mark.parametrize("identifier", IDENTIFIERS)


@ROBOTS
def test_exact_configurations_close(identifier: str) -> None:
    if subject(identifier).code.subleg.name not in LEGS_BY_NAME:
        with ball_precision():  # closed in balls, as the next test checks
            assert all(isinstance(x, Ball) for x in configuration(subject(identifier), Draw(5)).values["s"])
        return
    here = configuration(subject(identifier), Draw(5))
    assert all(isinstance(x, Exact) for x in here.values["s"])
    assert here.call("constraints")["residual"] == [0] * len(here.call("constraints")["residual"])
    for leg in range(LEGS):
        residual = here.kernel("subleg", "closure", leg)["residual"]
        assert residual == [0] * len(residual)
    fields = [value for values in here.geometry.values() for value in values]
    assert all(isinstance(value, Exact | Angle) for value in fields)
    legs = [tuple(str(values[leg]) for values in here.geometry.values()) for leg in range(LEGS)]
    assert len(set(legs)) == LEGS


@ROBOTS
def test_a_sub_leg_that_is_not_known_closes_in_balls(
    identifier: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(configurations, "LEGS_BY_NAME", {})
    with ball_precision():
        here = configuration(subject(identifier), Draw(5))
        for leg in range(LEGS):
            residual = here.kernel("subleg", "closure", leg)["residual"]
            assert all(isinstance(x, Ball) and x.close(0) for x in residual)


@ROBOTS
def test_doubles_are_consistent_and_drawn_again_alike(identifier: str) -> None:
    here = subject(identifier)
    batch, again = draw(here, 11, 20), draw(here, 11, 20)
    assert all(np.array_equal(batch.values[name], again.values[name]) for name in batch.values)
    assert batch.geometry == again.geometry and len(batch) == 20
    assert len({values[leg] for values in batch.geometry.values() for leg in range(LEGS)}) > LEGS
    ends = evaluate(here, "subleg_forward", batch.values, batch.geometry)["s"]
    assert np.abs(ends - batch.values["s"]).max() < 1e-12
    residual = evaluate(here, "constraints", batch.values, batch.geometry)["residual"]
    assert np.abs(residual).max() < 1e-14
    assert np.abs(evaluate(here, "singularity", batch.values, batch.geometry)["factors"]).min() > 0.1


def test_rotations() -> None:
    vectors = np.array([[0.0, 0.0, 0.0], [0.0, 0.0, np.pi / 2], [1.0, -2.0, 0.5], [1e-9, 0.0, 0.0]])
    q = rotations(vectors)
    assert np.allclose(q @ q.swapaxes(-1, -2), np.eye(3), atol=1e-15)
    assert np.allclose(np.linalg.det(q), 1.0) and np.array_equal(q[0], np.eye(3))
    assert np.allclose(q[1], [[0, -1, 0], [1, 0, 0], [0, 0, 1]], atol=1e-15)
    assert np.allclose(np.einsum("kij,kj->ki", q, vectors), vectors)


def test_random_exact_numbers() -> None:
    source, again = Draw(3), Draw(3)
    assert [source.rational() for _ in range(5)] == [again.rational() for _ in range(5)]
    q = source.rotation()
    rows = [q[0:3], q[3:6], q[6:9]]
    for i, a in enumerate(rows):
        for j, b in enumerate(rows):
            assert sum(x * y for x, y in zip(a, b, strict=True)) == int(i == j)
    angle = source.angle()
    assert angle.cos() * angle.cos() + angle.sin() * angle.sin() == 1 and abs(angle) == 0
    assert source.length() > 0 and source.nonzero() != 0 and source.sign() in (1, -1)


def port(unit: Unit, shape: tuple[int, ...], layout: Layout = Layout.SHARED) -> Port:
    return Port("x", shape, unit, Frame.NONE, "", layout)


def test_errors_are_relative_to_the_scale_of_the_output() -> None:
    length = port(Unit.METRE, (3,), Layout.STACKED)
    wanted = np.zeros((2, 3, 3))
    wanted[0, 1, 2], wanted[1, 0, 0] = 10.0, 0.1
    assert scale(length, wanted).ravel().tolist() == [10.0, 0.1]
    error, index = worst_of(relative(length, wanted + 0.01, wanted))
    assert (round(error, 12), index) == (0.1, 1)
    factors = replace(port(Unit.MIXED, (2,)), labels=("det J_a", "det J_n"))  # of two kinds
    assert scale(factors, [[2.0, 1e-3]]).tolist() == [[2.0, 1e-3]]


def test_angles_differ_by_the_smaller_arc() -> None:
    angle = port(Unit.RADIAN, ())
    assert difference(angle, [np.pi - 0.1], [-np.pi + 0.1]) == pytest.approx(0.2)
    assert relative(angle, [2 * np.pi], [0.0]) == pytest.approx(0.0, abs=1e-15)
    assert relative(angle, [2 * np.pi], [0.0], arcs=False) == pytest.approx(2 * np.pi)


def test_not_a_number_is_no_difference_only_on_both_sides() -> None:
    length = port(Unit.METRE, ())
    assert relative(length, [np.nan], [np.nan]) == [0.0]
    assert worst_of(relative(length, [np.nan, 1.0], [1.0, 1.0])) == (np.inf, 0)
