"""Section 4.2: what comes out, and the slices against the maps of the workspace."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest

import krhpr
from krhpr import workspace
from krhpr.study.design_pictures import enlargement_figures
from krhpr.study.enlargement import ALL, CASES, FREE, REACH, Enlargement, enlargement, readings_of
from krhpr.study.files import save_figures


@cache
def study() -> Enlargement:
    return enlargement(rays=60)


def test_what_the_thesis_says() -> None:
    assert [claim.text for claim in study().claims() if not claim.holds] == []
    assert len(study().claims()) == 8


def test_numbers_that_were_known_before() -> None:
    """By other programs, from the thesis' model: the way along x by reach alone, eta_1 and eta_3 at its end,
    and the tilt about y' one way and the other."""
    reach = study().found["angles", REACH].along_x
    assert [round(1e3 * reach.at(np.radians(beta))) for beta in (60, 175)] == [546, 625]
    assert 10 * reach.eta[:, 0].min() > 4.7 and 10 * reach.eta[:, 0].max() < 5.5
    assert round(float(reach.eta[:, 2].min())) == 57
    tilt = study().found["angles", ALL].tilt
    assert [round(float(np.degrees(tilt.at(np.radians(beta))))) for beta in (60, 140)] == [92, 159]


def test_slices_are_rays_of_the_maps() -> None:
    """The shown magnitudes are among those of the slices: the same boundaries, by maps that march."""
    robot = krhpr.load("spatial_rrr_a")
    for case in CASES:
        found, limits = study().found[case.name, FREE], readings_of(robot)[FREE]
        value = case.shown[2] * case.unit
        one = case.robot(robot, value)
        if not np.isclose(case.values(), value).any():
            continue
        redundant = one.home.redundant
        layer = workspace.translational(
            one, [0.35], limits=limits, redundancy=redundant, rays=4, farthest=0.9, tracing="march"
        )
        tilts = workspace.orientational(
            one, limits=limits, redundancy=redundant, torsions=[0.0], rays=4, tracing="march"
        )
        assert found.along_x.at(value) == layer["boundary"][0, 0]
        assert found.tilt.at(value) == tilts["boundary"][0, 1]
        shown = found.layers[2]
        assert shown is not None and np.array_equal(shown["boundary"][0, ::15], layer["boundary"][0])


def test_what_a_case_sets() -> None:
    robot = krhpr.load("spatial_rrr_a")
    angles, links, platform = (case.robot(robot, case.shown[-1] * case.unit) for case in CASES)
    assert angles.home.redundant == (np.radians(175),) * 3 and angles.geometry == robot.geometry
    assert links.geometry.l_r[0] == 0.16 and links.geometry.R_p[0] == 0.125
    assert platform.geometry.l_r[0] == 0.1 and platform.geometry.R_p[0] == pytest.approx(0.25)


def test_claims_can_fail() -> None:
    """With all families turned round."""
    turned = {}
    for name, one in study().found.items():
        x, tilt = (
            replace(part, boundary=part.boundary[::-1], eta=part.eta[::-1])
            for part in (one.along_x, one.tilt)
        )
        turned[name] = replace(one, along_x=x, tilt=tilt, layers=one.layers[::-1], tilts=one.tilts[::-1])
    failed = [claim for claim in replace(study(), found=turned).claims() if not claim.holds]
    assert len(failed) == 5  # not those of values at any place, nor the singularity


def test_pictures(tmp_path: Path) -> None:
    paths = save_figures(enlargement_figures(study()), tmp_path)
    assert [path.stem for path in paths] == ["design_families", "design_slices"]
    assert all(path.stat().st_size > 30_000 for path in paths)
