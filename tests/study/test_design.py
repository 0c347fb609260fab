"""The design study: what is varied unless told, the best designs, their robot files and the picture."""

from __future__ import annotations

import json
from functools import cache
from pathlib import Path

import numpy as np
import pytest

import krhpr
from krhpr import workspace
from krhpr.design import Effort, Evaluation, Grid, Objective, Variable
from krhpr.errors import DesignError
from krhpr.study.design import (
    OBJECTIVES,
    DesignStudy,
    between,
    default_variables,
    design_study,
    objectives_from,
    problem_of,
    variables_from,
)
from krhpr.study.design_pictures import front_figure
from krhpr.study.files import save_figures
from tests.support import ROOT

QUICK = Effort(samples=12, parts=1, generations=1, population=4)
COARSE = Grid(step=0.08, angle=np.pi / 5, balls=300)


@cache
def study(name: str = "spatial_rrr_a") -> DesignStudy:
    pair = (Objective.VOLUME, Objective.ETA_2)
    return design_study(problem_of(krhpr.load(name), (), pair, COARSE), QUICK)


def test_the_best_are_written_as_robots_that_are_as_good(tmp_path: Path) -> None:
    """Read again, and judged by the limits of the file: the volume and the cube that its remarks say."""
    found = study()
    assert [one.name for one in found.chosen] == ["best_volume", "best_eta_2", "between"]
    for path, one in zip(found.write(tmp_path), found.chosen, strict=True):
        robot = krhpr.load(path)
        assert robot.name == path.stem == one.name
        text = path.read_text("utf-8")
        assert f"# volume of positions: {one.finer.results[Objective.VOLUME]:.5g} m^3\n" in text
        limits = workspace.WorkspaceLimits(lowest=0.0)
        assert "WorkspaceLimits(lowest = 0)" in text
        cube = one.finer.cube
        assert cube is not None and one.finer.proven and cube.side > 0
        examiner = workspace.Examiner(robot, limits)
        assert workspace.Certifier(examiner, robot.home.redundant).proves(cube, 2400).holds
        at = np.linspace(-0.5, 0.5, 9)
        p = np.asarray(cube.centre) + cube.side * np.stack(np.meshgrid(at, at, at), -1).reshape(-1, 3)
        Q, redundant = (
            np.broadcast_to(np.eye(3), (len(p), 3, 3)),
            np.broadcast_to(robot.home.redundant, p.shape),
        )
        assert examiner.examine(p, Q, redundant).free.all()


def test_the_best_are_best() -> None:
    found = study()
    volume, eta_2, middle = (one.design for one in found.chosen)
    working = [one for one in found.found.designs if one.works]
    assert volume.results[Objective.VOLUME] == max(one.results[Objective.VOLUME] for one in working)
    assert eta_2.results[Objective.ETA_2] == min(one.results[Objective.ETA_2] for one in working)
    assert middle in found.found.front
    assert found.own.design.values == tuple(found.problem.space.own.tolist())


def test_what_lies_between() -> None:
    names = (Objective.VOLUME, Objective.ETA_1)
    front = [
        Evaluation((float(k),), 0.0, "", dict(zip(names, pair, strict=True)))
        for k, pair in enumerate([(4.0, 9.0), (3.0, 2.0), (1.0, 1.0)])
    ]
    assert between(front, names) == front[1]
    assert between(front[:1], names) == front[0]


@pytest.mark.parametrize("name", ["spatial_rrr_a", "spatial_r_fivebar_b", "spatial_prr_c"])
def test_what_is_varied_of_a_robot(name: str) -> None:
    robot = krhpr.load(name)
    names = [variable.name for variable in default_variables(robot)]
    assert names[-1] == "height" and ("redundant" in names) == name.endswith("_a")
    assert ("l_2" in names) == name.startswith("spatial_rrr")


def test_lists_as_people_write_them() -> None:
    assert variables_from("l_r=0.03:0.15, redundant = 1:2") == (
        Variable("l_r", 0.03, 0.15),
        Variable("redundant", 1.0, 2.0),
    )
    assert objectives_from("volume, eta_2") == (Objective.VOLUME, Objective.ETA_2)
    for wrong in ("l_r", "l_r=0.1", "l_r=a:b", ""):
        with pytest.raises(DesignError, match="is no variable; expected NAME=LOW:HIGH in metres or radians"):
            variables_from(wrong)
    with pytest.raises(DesignError, match="there is no objective 'volumes'; did you mean volume"):
        objectives_from("volumes")


def test_the_picture(tmp_path: Path) -> None:
    found = study()
    marked = {"own": found.own.design, "between": found.chosen[-1].design}
    (path,) = save_figures(front_figure(found.found.designs, found.problem.objectives, marked), tmp_path)
    assert path.stem == "design_front" and path.stat().st_size > 15_000


def test_what_the_documentation_shows_is_what_the_study_finds() -> None:
    """The robots in examples/designs, judged again on the grids of the study."""
    found = json.loads((ROOT / "docs/pictures/designs.json").read_text("utf-8"))
    robot = krhpr.load("spatial_rrr_a")
    problem = problem_of(robot)
    space = problem.space
    now = json.loads(json.dumps(problem.settings()))
    assert {**found["settings"], "version": now["version"]} == now
    paths = sorted((ROOT / "examples" / "designs").glob("*.yaml"))
    assert {path.stem for path in paths} == set(found["best"]) - {"the robot itself"}
    for path in paths:
        one = krhpr.load(path)
        fields = {**one.geometry.fields, "redundant": one.home.redundant, "height": one.home.p[2:]}
        judged = problem.evaluate([float(fields[name][0]) for name in space.names])
        own = [judged.results[name] for name in OBJECTIVES]
        assert own == pytest.approx(found["best"][path.stem], rel=1e-3)
        assert not judged.cut
    rows = np.array(found["designs"])
    best = rows.max(axis=0)
    for k, name in ((0, "best_volume"), (2, "best_box")):
        assert found["best"][name][k] == best[k]
