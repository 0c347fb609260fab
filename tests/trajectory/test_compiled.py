"""Functions of the programme as compiled C: the same numbers, the same answers, and no compiler."""

from __future__ import annotations

import numpy as np
import pytest

import krhpr
from krhpr import trajectory
from krhpr.native import NoCompiler
from krhpr.trajectory import Evaluation
from krhpr.trajectory.point import PointFunctions
from krhpr.trajectory.reach import signs_at_start
from krhpr.trajectory.terms import Objective

LIMITS = trajectory.chapter_4()


def point(evaluation: Evaluation) -> PointFunctions:
    robot, path = krhpr.load("spatial_rrr_a", backend="numpy"), trajectory.translation()
    signs = signs_at_start(robot, path, LIMITS, None)
    return PointFunctions(robot, Objective.of("eta_1"), LIMITS, signs, evaluation=evaluation)


@pytest.mark.compiler
def test_values_and_derivatives() -> None:
    one, other = point(Evaluation.SX), point(Evaluation.COMPILED)
    source = np.random.default_rng(2)
    motion = trajectory.tilt().at(np.linspace(0, 4, 7))
    q = one.parameters(motion, np.zeros((7, 3, 3))).T
    z = np.vstack([source.uniform(1.5, 1.9, (3, 7)), source.normal(size=(one.size - 3, 7))])
    rows = len(one.quantities)
    weights = (source.uniform(0.5, 1, (1, 7)), source.normal(size=(rows, 7)))
    for name, function in one.functions.items():
        given = (z, q, *(weights if name == "curvature" else ()))
        wanted = function.map(7)(*given).full()
        found = other.functions[name].map(7)(*given).full()
        np.testing.assert_allclose(found, wanted, atol=1e-12 * np.abs(wanted).max(), err_msg=name)


@pytest.mark.compiler
def test_the_answer_is_the_same() -> None:
    robot = krhpr.load("spatial_rrr_a", backend="numpy")
    found = [
        trajectory.optimise(robot, trajectory.translation(), "eta_1", LIMITS, evaluation=evaluation)
        for evaluation in Evaluation
    ]
    assert found[0].iterations == found[1].iterations
    np.testing.assert_allclose(found[0].redundant, found[1].redundant, atol=1e-9)


def test_without_a_compiler(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("KRHPR_CC", "none")
    robot = krhpr.load("spatial_rrr_a", backend="numpy")
    with pytest.raises(NoCompiler, match="compilers are disabled"):
        trajectory.optimise(robot, trajectory.tilt(), "eta_2", LIMITS, evaluation="compiled")
    planner = trajectory.RecedingHorizon(robot, trajectory.tilt(), "eta_2", LIMITS, horizon=1.0)
    assert planner.point.evaluation is Evaluation.SX
