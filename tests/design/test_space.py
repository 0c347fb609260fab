"""What may be varied: bounds, ties, and what is refused."""

from __future__ import annotations

import numpy as np
import pytest

import krhpr
from krhpr.design import DesignSpace, Effort, Grid, Objective, Problem, Tie, Variable, search
from krhpr.errors import DesignError, WorkspaceError
from krhpr.workspace import WorkspaceLimits, section_1_7

ROBOT = krhpr.load("spatial_rrr_a")


def space(*variables: Variable) -> DesignSpace:
    return DesignSpace(ROBOT, variables)


def test_values_set_fields_and_what_is_tied_to_them() -> None:
    found = space(
        Variable("l_2", 0.2, 0.5, (Tie("l_3", -1.0, 0.75),)),
        Variable("redundant", 1.0, 2.5),
        Variable("height", 0.2, 0.5),
    )
    robot = found.robot_of([0.3125, 1.25, 0.25], name="mine")
    assert robot.name == "mine" and robot.home.redundant == (1.25,) * 3 and robot.home.p == (0.0, 0.0, 0.25)
    assert np.array_equal(robot.geometry.l_2, [0.3125] * 3) and np.array_equal(
        robot.geometry.l_3, [0.4375] * 3
    )
    same = [name for name in robot.geometry.fields if name not in ("l_2", "l_3")]
    assert all(np.array_equal(robot.geometry.fields[k], ROBOT.geometry.fields[k]) for k in same)
    assert found.own.tolist() == [0.3, ROBOT.home.redundant[0], 0.35]


def test_places_between_the_bounds() -> None:
    found = space(Variable("alpha", 1.0, 3.0), Variable("l_r", 0.03, 0.0907))
    values = found.values([[0.0, 0.0], [1.0, 1.0], [0.123456789, 0.5]])
    assert values.tolist() == [[1.0, 0.03], [3.0, 0.0907], [1.247, 0.06035]]
    assert np.allclose(found.shares(values), [[0, 0], [1, 1], [0.1235, 0.5]], atol=1e-12)
    # a robot outside the bounds begins at them
    assert space(Variable("l_r", 0.06, 0.09)).own.tolist() == [0.06]


@pytest.mark.parametrize(
    ("variable", "message"),
    [
        (Variable("l_9", 0.1, 0.2), "there is no l_9 to vary; did you mean"),
        (Variable("beta", 0.1, 0.2), "there is no beta to vary; there are azimuth, R_b"),
        (Variable("l_2", 0.3, 0.2), "l_2: the bounds are 0.3 and 0.2; expected the lower one first"),
        (Variable("l_2", 0.3, 0.3), "expected the lower one first, and a greater one"),
        (Variable("l_2", float("nan"), 0.3), "the bounds are nan and 0.3"),
        (Variable("l_2", 0.0, 0.3), "with l_2 = 0 the length l_2 is 0; expected bounds that keep it greater"),
        (Variable("l_2", 0.1, 0.8, (Tie("l_3", -1.0, 0.75),)), "with l_2 = 0.8 the length l_3 is -0.05"),
        (Variable("l_2", 0.1, 0.2, (Tie("l_4", 1.0),)), "there is no l_4 to vary"),
        (Variable("l_2", 0.1, 0.2, (Tie("l_2", 1.0),)), "l_2 is set by l_2 and again by l_2"),
    ],
)
def test_variables_that_cannot_be_used(variable: Variable, message: str) -> None:
    with pytest.raises(DesignError, match=message):
        space(variable)


def test_other_mistakes() -> None:
    with pytest.raises(DesignError, match="no variables; expected one or more of azimuth"):
        space()
    with pytest.raises(DesignError, match="R_p is set by R_p and again by l_r"):
        space(Variable("R_p", 0.1, 0.2), Variable("l_r", 0.03, 0.05, (Tie("R_p", 2.5),)))
    with pytest.raises(DesignError, match="expected a finite one for each of l_2"):
        space(Variable("l_2", 0.1, 0.2)).robot_of([np.nan])
    found = space(Variable("l_r", 0.03, 0.09))
    with pytest.raises(DesignError, match="the objectives are none; expected one or more of volume"):
        Problem(found, (), section_1_7(ROBOT))
    with pytest.raises(DesignError, match="each once"):
        Problem(found, (Objective.VOLUME,) * 2, section_1_7(ROBOT))
    with pytest.raises(ValueError, match="area"):
        Problem(found, ("area",), section_1_7(ROBOT))  # type: ignore[arg-type]
    with pytest.raises(DesignError, match="the grid has steps of 2 m"):
        Grid(step=2.0)


def test_designs_that_cannot_be_at_home_say_why() -> None:
    """In reach, but beyond a limit; out of reach; and sizes against (1.35)."""
    limits = section_1_7(ROBOT)
    varied = space(Variable("l_2", 0.05, 0.5), Variable("l_3", 0.05, 0.5), Variable("l_r", 0.02, 0.2))
    problem = Problem(varied, (Objective.VOLUME,), limits)
    short = problem.evaluate([0.05, 0.1, 0.05])
    assert not short.works and "reach of leg 1" in short.reason and "m too far" in short.reason
    p, redundant = np.array(ROBOT.home.p), np.array(ROBOT.home.redundant)
    robot = varied.robot_of(short.values)
    c = robot.link_points(p, np.eye(3), robot.end_points(p, np.eye(3), redundant), np.zeros((3, 3)))[0][:, 1]
    away = np.linalg.norm(robot.end_points(p, np.eye(3), redundant) - c, axis=-1)
    assert np.isclose(short.shortfall, 1 + (away - 0.15).sum() / 0.1)
    # reach by 0.4 mm: the elbow is nearly straight
    straight = problem.evaluate([away[0] / 2 + 2e-4, away[0] / 2 + 2e-4, 0.05])
    assert "elbow of leg" in straight.reason and 0 < straight.shortfall < 1
    long = problem.evaluate([0.3, 0.45, 0.1])
    assert "collinear" in long.reason and long.shortfall > 9
    assert not long.results and long.cube is None
    near = Problem(space(Variable("redundant", 0.2, 2.0)), (Objective.VOLUME,), limits)
    assert "spherical joint of leg 1, by 0.15" in near.evaluate([0.3]).reason
    thick = Problem(near.space, (Objective.VOLUME,), WorkspaceLimits(radius=0.05))
    assert "interference of " in thick.evaluate([1.7]).reason


def test_an_empty_workspace_is_told_with_its_limit() -> None:
    """Bounds within which no design can be at home."""
    varied = space(Variable("l_2", 0.05, 0.1, (Tie("l_3", 1.0),)))
    problem = Problem(varied, (Objective.VOLUME,), section_1_7(ROBOT))
    found = search(problem, Effort(samples=3, parts=1, generations=1, population=4))
    assert found.front == ()
    with pytest.raises(DesignError, match=r"none of \d designs works; the nearest .*reach of leg 1"):
        found.demand()


def test_limits_that_the_robot_does_not_have() -> None:
    robot = krhpr.load("spatial_prr_a")
    with pytest.raises(WorkspaceError, match="axis_distance is limited"):
        Problem(
            DesignSpace(robot, [Variable("R_p", 0.1, 0.2)]),
            (Objective.VOLUME,),
            WorkspaceLimits(axis_distance=0.02),
        )
