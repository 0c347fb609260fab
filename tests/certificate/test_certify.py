"""Certificates: what the thesis and its errata say of boxes, and what must hold of any answer."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from krhpr import InvalidInput
from krhpr.certificate import Box, Certificate, Factor, Form, Method, Verdict, certify
from krhpr.certificate.circles import never_collinear
from krhpr.certificate.exact import Number
from krhpr.certificate.vertices import vertex_test
from tests.certificate.support import ROBOTS, boxes, degrees, inside, load, margins, sizes, unequal

spatial, planar, slides = load("spatial_rrr_a"), load("planar_rr_a"), load("spatial_rrr_c")


def holds(robot: Any, found: Certificate) -> None:
    """What an answer says is so."""
    points = inside(found.box)
    values = margins(robot, points)
    slack = 1e-12 * sizes(robot, points)
    farthest = np.maximum(np.abs(found.box.low), np.abs(found.box.high))
    for place, finding in enumerate(found.findings):
        if finding.verdict is Verdict.FREE:
            assert (finding.sign * values[:, place] >= finding.bound - slack[:, place]).all()
            assert finding.bound >= 0 and finding.point is None and finding.cell is None
        elif finding.verdict is Verdict.SINGULAR:
            assert finding.point is not None
            point = np.array(finding.point)
            assert (point >= np.array(found.box.low) - 1e-15).all()
            assert (point <= np.array(found.box.high) + 1e-15).all()
            assert abs(margins(robot, point)[place]) <= 1e-12 * sizes(robot, farthest)[place]
        else:
            # only a zero that rounding hides: at a vertex, or somewhere on the boundary
            assert finding.cell is not None
            near = 1e-12 if finding.method is Method.VERTICES else 1e-6
            least = np.abs(margins(robot, inside(finding.cell))[:, place]).min()
            assert least <= near * sizes(robot, farthest)[place]
    if found.verdict is Verdict.SINGULAR:
        assert found.point is not None and not found.free


# -- arrangement (a) -----------------------------------------------------------------------------------------


@pytest.mark.parametrize("robot", [spatial, planar, load("spatial_r_fivebar_a")], ids=repr)
def test_the_open_box_of_the_equilateral_platform_is_free(robot: Any) -> None:
    """(1.36); errata, consequence 2."""
    found = certify(robot, np.radians(30), np.radians(150), closed=False)
    assert found.free
    assert found.findings[0].method is Method.VERTICES
    assert found.findings[0].bound == 0.0  # it vanishes on the boundary
    if not robot.planar:
        assert found.findings[1].method is Method.CLOSED_FORM
        assert found.findings[1].bound > 1.2
    holds(robot, found)


def test_its_closed_box_has_singular_edges() -> None:
    found = certify(spatial, np.radians(30), np.radians(150))
    assert found.verdict is Verdict.SINGULAR
    assert {round(x, 9) for x in np.degrees(found.point)} == {30.0, 150.0}
    holds(spatial, found)


@pytest.mark.parametrize("wider", [1e-14, 1e-9, 1e-3, 1.0])
def test_no_larger_centred_box_is_free(wider: float) -> None:
    found = certify(spatial, np.radians(30) - wider, np.radians(150) + wider, closed=False)
    assert found.verdict is Verdict.SINGULAR
    holds(spatial, found)


@pytest.mark.parametrize("narrower", [1e-14, 1e-9, 1e-3, 0.1])
def test_every_smaller_closed_box_is_free(narrower: float) -> None:
    found = certify(spatial, np.radians(30) + narrower, np.radians(150) - narrower)
    assert found.free
    assert 0 < found.findings[0].bound < 3 * narrower
    holds(spatial, found)


def test_the_range_of_chapter_4_holds_for_equal_angles_only() -> None:
    """[55, 175] degrees contain singular points of unequal angles."""
    found = certify(spatial, np.radians(55), np.radians(175))
    assert found.verdict is Verdict.SINGULAR
    holds(spatial, found)
    assert max(found.point) - min(found.point) > 0.1
    equal = np.radians(np.linspace(55, 175, 50))[:, np.newaxis].repeat(3, axis=1)
    assert (margins(spatial, equal) > 0).all()


def test_the_bound_is_the_smallest_margin() -> None:
    found = certify(spatial, np.radians(40), np.radians(140))
    corners = np.radians(np.array(np.meshgrid([40, 140], [40, 140], [40, 140])).reshape(3, -1).T)
    assert found.findings[0].bound == pytest.approx(margins(spatial, corners)[:, 0].min(), rel=1e-12)
    least = margins(spatial, inside(found.box, 20_000))[:, 1].min()
    assert 0.97 * least <= found.findings[1].bound <= least


def test_full_turns_make_no_difference() -> None:
    turned = certify(spatial, degrees(30, 30 - 360, 30), degrees(150, 150 - 360, 150), closed=False)
    assert turned.free and turned.findings[0].bound == 0.0


def test_the_other_side_has_the_other_sign() -> None:
    found = certify(spatial, np.radians(220), np.radians(320))
    assert found.free and found.findings[0].sign == -1 and found.findings[1].sign == 1
    holds(spatial, found)


@pytest.mark.parametrize(("low", "high"), [(0, 180), (0, 181), (10, 200), (-180, 180), (45, 405)])
@pytest.mark.parametrize("closed", [False, True])
def test_half_a_turn_or_more_is_singular(low: float, high: float, closed: bool) -> None:
    found = certify(spatial, np.radians(low), np.radians(high), closed=closed)
    assert found.verdict is Verdict.SINGULAR
    holds(spatial, found)
    one = certify(spatial, degrees(low, 80, 80), degrees(high, 100, 100), closed=closed)
    assert one.verdict is (Verdict.SINGULAR if high - low > 180 or closed else one.verdict)
    holds(spatial, one)


# -- det J_n of arrangement (a) ------------------------------------------------------------------------------


@given(st.floats(0.05, 0.9999))
def test_1_35_excludes_collinear_end_points(share: float) -> None:
    robot = spatial.with_geometry(l_r=0.75 * 0.125 * share)
    assert never_collinear(robot)
    beta = np.random.default_rng(2).uniform(0, 2 * np.pi, (500, 3))
    beta[0] = degrees(0, 300, 60)
    assert (margins(robot, beta)[:, 1] > 0).all()


@pytest.mark.parametrize("share", [1.0, 1.0001, 1.5, 3.0])
def test_1_35_is_sharp(share: float) -> None:
    robot = spatial.with_geometry(l_r=0.75 * 0.125 * share)
    assert not never_collinear(robot)
    if share == 1.0:
        assert abs(margins(robot, degrees(0, 300, 60))[1]) < 1e-15


@given(st.data())
def test_1_35_for_unequal_legs(data: st.DataObject) -> None:
    """Against the definition: a line at l_i or less from each B_i, sought over its directions."""
    lengths = data.draw(st.tuples(*[st.floats(0.01, 0.14)] * 3))
    robot = data.draw(unequal("spatial_rrr_a")).with_geometry(l_r=lengths)
    g = robot.geometry
    joints = g.R_p[:, np.newaxis] * np.stack(
        [np.cos(g.platform_azimuth), np.sin(g.platform_azimuth)], axis=-1
    )
    angle = np.linspace(0, np.pi, 20_001)
    heights = joints @ np.stack([np.cos(angle), np.sin(angle)])
    reach = np.array(lengths)[:, np.newaxis]
    gap = ((heights - reach).max(axis=0) - (heights + reach).min(axis=0)).min()
    if abs(gap) > 1e-4:
        assert never_collinear(robot) == (gap > 0)


def test_with_long_links_enclosures_decide() -> None:
    """Case 2 of Chapter 4 violates (1.35)."""
    robot = spatial.with_geometry(l_r=0.16)
    found = certify(robot, np.radians(40), np.radians(140))
    assert found.free and found.findings[1].method is Method.INTERVALS
    holds(robot, found)
    everything = certify(robot, 0.0, 2 * np.pi)
    assert everything.findings[1].verdict is Verdict.SINGULAR
    holds(robot, everything)


def test_a_zero_without_change_of_sign_is_undecided() -> None:
    """l = 3 R_p / 4: det J_n touches zero at (0, 300, 60) degrees and is positive elsewhere."""
    robot = spatial.with_geometry(l_r=0.75 * 0.125)
    found = certify(robot, degrees(-60, 240, 0), degrees(50, 350, 110))
    finding = found.findings[1]
    assert finding.verdict is Verdict.UNDECIDED and finding.method is Method.INTERVALS
    assert max(finding.cell.widths) < 1e-4
    assert np.allclose(np.degrees(finding.cell.centre), [0, 300, 60], atol=0.1)
    holds(robot, found)


def test_fewer_cells_decide_less() -> None:
    robot = spatial.with_geometry(l_r=0.75 * 0.125)
    low, high = degrees(-60, 240, 0), degrees(50, 350, 110)
    coarse, fine = (certify(robot, low, high, cells=cells).findings[1].cell for cells in (1000, 100_000))
    assert max(coarse.widths) > 10 * max(fine.widths)
    at_zero = certify(robot, degrees(-60, 240, 0), degrees(60, 360, 120)).findings[1]
    assert at_zero.verdict is Verdict.SINGULAR
    assert np.allclose(np.degrees(at_zero.point), [0, 300, 60])


# -- arrangements (b) and (c) --------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("low", "high", "closed", "free"),
    [
        ((0, 0, 0), 0.15, False, True),  # all d_i > 0
        ((0, 0, 0), 0.15, True, False),
        ((0, 0.001, 0.001), 0.15, True, True),  # one may be zero
        ((0, 0, 0.001), 0.15, True, False),  # not two
        ((0, 0, 0.001), 0.15, False, True),
        ((-0.01, 0.05, 0.05), 0.15, True, True),  # mixed signs can do
        ((-0.03, 0.05, 0.05), 0.15, True, False),
        ((-0.15, -0.15, -0.15), -0.01, True, True),
        ((-0.1, -0.1, -0.1), 0.1, False, False),
    ],
)
def test_radial_slides(low: Any, high: float, closed: bool, free: bool) -> None:
    """Arrangement (c): free if all d_i >= 0 and at most one is zero; errata, Section 2.3.2."""
    found = certify(slides, low, high, closed=closed)
    assert found.verdict is (Verdict.FREE if free else Verdict.SINGULAR)
    assert {finding.method for finding in found.findings} == {Method.VERTICES}
    holds(slides, found)


def tangential(h: Fraction) -> tuple[Factor, Factor]:
    """Arrangement (b) by its closed forms: -(sqrt3/2) s1 and (sqrt3/2)(3 h^2 + s2)."""
    half_root = Number(Fraction(0), Fraction(1, 2))
    det_a, det_n = np.empty((2, 2, 2), dtype=object), np.empty((2, 2, 2), dtype=object)
    for index in np.ndindex(2, 2, 2):
        det_a[index] = -half_root * int(sum(index) == 1)
        det_n[index] = half_root * (3 * h * h if sum(index) == 0 else int(sum(index) == 2))
    return Factor("det J_a", Form.AFFINE, det_a, 1.0), Factor("det J_n", Form.AFFINE, det_n, 1.0)


def test_tangential_slides_within_their_bound_have_one_singular_plane() -> None:
    """Arrangement (b): det J_n > 0 while |d_i| < sqrt(3) |b - l|, sharply; det J_a = 0 where s1 = 0."""
    h = 0.0625
    det_a, det_n = tangential(Fraction(h))
    edge = float(np.sqrt(3)) * h
    within = Box((-edge * (1 - 1e-14),) * 3, (edge * (1 - 1e-14),) * 3)
    assert vertex_test(det_n, within, 1).verdict is Verdict.FREE
    beyond = vertex_test(det_n, Box((-edge * (1 + 1e-14),) * 3, (edge * (1 + 1e-14),) * 3), 1)
    assert beyond.verdict is Verdict.SINGULAR
    assert vertex_test(det_a, Box((0.0, -0.01, 0.02), (0.1, 0.1, 0.1)), -1).verdict is Verdict.FREE
    assert vertex_test(det_a, Box((0.0, -0.03, 0.02), (0.1, 0.1, 0.1)), -1).verdict is Verdict.SINGULAR


def test_where_rounding_hides_the_sign_at_the_centre_a_zero_is_found() -> None:
    """With azimuths that are no multiples of 30 degrees a zero at the centre is one but for rounding."""
    robot = slides.with_geometry(platform_azimuth=degrees(10, 131, 252))
    weights = np.sin(degrees(252 - 131, 10 - 252, 131 - 10))
    centre = np.array([0.1, 0.05, -(0.1 * weights[0] + 0.05 * weights[1]) / weights[2]])
    found = certify(robot, centre - 0.01, centre + 0.01)
    assert found.findings[0].verdict is Verdict.SINGULAR
    holds(robot, found)


# -- any robot, any box --------------------------------------------------------------------------------------


@pytest.mark.parametrize("identifier", ROBOTS)
@settings(max_examples=settings.default.max_examples // 2)
@given(st.data(), st.booleans())
def test_answers_hold_for_unequal_legs(identifier: str, data: st.DataObject, closed: bool) -> None:
    robot = data.draw(unequal(identifier))
    low, high = data.draw(boxes(identifier))
    holds(robot, certify(robot, low, high, closed=closed))


@pytest.mark.parametrize("identifier", ROBOTS)
@settings(max_examples=settings.default.max_examples // 2)
@given(st.data())
def test_a_box_in_a_free_box_is_free(identifier: str, data: st.DataObject) -> None:
    robot = data.draw(unequal(identifier))
    outer = certify(robot, *data.draw(boxes(identifier)))
    if outer.free:
        low, high = np.array(outer.box.low), np.array(outer.box.high)
        inner = certify(robot, low + 0.2 * (high - low), high - 0.3 * (high - low))
        assert inner.free
        for a, b in zip(inner.findings, outer.findings, strict=True):
            assert a.sign == b.sign
            assert a.bound >= 0.97 * b.bound


# -- hostile input -------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("low", "high", "message"),
    [
        (np.nan, 1.0, "low is nan; it must be finite"),
        (0.0, [1.0, np.inf, 1.0], "high is .*inf.*; it must be finite"),
        (1.0, 1.0, "leg 1: low is 1 and high is 1; low must be below high"),
        ([0.0, 2.0, 0.0], 1.0, "leg 2: low is 2 and high is 1"),
        ([0.0, 0.0], 1.0, r"low has shape \(2,\); expected a number, or three"),
        (np.zeros((3, 1)), 1.0, r"low has shape \(3, 1\)"),
        ("wide", 1.0, "low is no array of numbers: 'wide'"),
        (None, 1.0, "low is"),
        (0.0, 6.3, "leg 1: from 0 to 6.3 rad is more than a full turn"),
        (1e6, 1e6 + 1, "leg 1: .*subtract full turns"),
        (1j, 1.0, "low is no array of numbers"),
    ],
)
def test_bounds_that_make_no_box(low: Any, high: Any, message: str) -> None:
    with pytest.raises(InvalidInput, match=message):
        certify(spatial, low, high)


def test_slides_are_not_of_astronomical_size() -> None:
    with pytest.raises(InvalidInput, match=r"leg 1: .* is no slide's displacement"):
        certify(slides, 1.0, 1e300)
    assert certify(slides, 1e-3, 1e20).free


def test_a_singular_centre_is_said() -> None:
    found = certify(spatial, np.radians(170), np.radians(190))
    assert found.verdict is Verdict.SINGULAR
    holds(spatial, found)
    found = certify(slides, -0.1, 0.1)
    assert found.point == (0.0, 0.0, 0.0)
