"""The study of Section 1.7: its claims, the table of readings and its pictures."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest

import krhpr
from krhpr.study.convergence import convergence
from krhpr.study.files import save_figures
from krhpr.study.workspace import BETA, WorkspaceStudy, workspace_study
from krhpr.study.workspace_pictures import PICTURES, workspace_figures
from krhpr.workspace import constant, section_1_7


@cache
def study() -> WorkspaceStudy:
    return workspace_study(coarser=10)


def test_what_the_thesis_says() -> None:
    assert [claim.text for claim in study().claims() if not claim.holds] == []
    assert len(study().claims()) == 4


def test_readings_of_the_bodies() -> None:
    found = {
        one.name: tuple(round(float(np.degrees(x))) for x in (one.torsion.span, one.best, one.worst))
        for one in study().readings
    }
    assert found["edges are links, spherical joints within 150 degrees"] == (194, 144, 116)
    assert found["edges are links"][0] == 201
    assert found["neither"][0] == 263
    assert found["edges are links, all 7.5 mm across"] == (216, 172, 140)
    spans = [span for span, _, _ in found.values()]
    assert min(spans) < 220 < max(spans)


def test_volumes_converge() -> None:
    """Wider steps are off by no more than is said of both, and the errors of small ones are small."""
    robot = krhpr.load("spatial_r_fivebar_a")
    found = convergence(robot, section_1_7(robot), constant(BETA), times=(4, 8, 24))
    best = found[0]
    assert [one.times for one in found] == [4, 8, 24]
    for part in ("positions", "orientations"):
        reference = getattr(best, part)
        for one in found[1:]:
            measure = getattr(one, part)
            assert abs(measure.value - reference.value) < measure.error + reference.error
        assert 5 * reference.error < getattr(found[-1], part).error < 0.15 * reference.value


def test_a_claim_can_fail() -> None:
    """With the layers in the other order, and without the tilt."""
    layers = study().layers
    turned = replace(layers, arrays={**layers.arrays, "stops": layers["stops"][::-1]})
    small = tuple(replace(one, best=1.0, worst=0.5) for one in study().readings)
    failed = [
        claim.text for claim in replace(study(), layers=turned, readings=small).claims() if not claim.holds
    ]
    assert len(failed) == 3


def test_other_robots_have_maps_and_no_claims() -> None:
    found = workspace_study(krhpr.load("spatial_rrr_a"), coarser=30)
    assert found.claims() == ()
    assert found.volumes()[0].value > 0.01


def test_maps_are_kept(tmp_path: Path) -> None:
    pytest.importorskip("zarr")
    told: list[tuple[str, int, int]] = []
    for _ in range(2):
        told.clear()
        found = workspace_study(coarser=30, store=tmp_path, progress=lambda *at: told.append(at))
        assert np.array_equal(found.layers["boundary"], workspace_study(coarser=30).layers["boundary"])
    assert told[0][1] == told[0][2]  # the second time everything is there


def test_pictures(tmp_path: Path) -> None:
    paths = save_figures(workspace_figures(study()), tmp_path)
    assert [path.stem for path in paths] == list(PICTURES)
    assert all(path.stat().st_size > 10_000 for path in paths)
    again = save_figures(workspace_figures(study()), tmp_path / "again")
    assert [path.read_bytes() for path in paths] == [path.read_bytes() for path in again]
