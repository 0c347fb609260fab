"""Forward kinematics of the platforms: references, both families, hostile end points, many poses."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

import krhpr
from krhpr.validation.sampling import rotations
from tests.support import ROOT

CLOSED = [name for name in krhpr.catalogue() if name.endswith(("_b", "_c"))]
CASES = [
    case
    for case in json.loads((ROOT / "tests" / "reference" / "platforms.json").read_text("utf-8"))["forward"]
    if case["arrangement"] in "bc"
]
ANGLES = st.floats(-0.6, 0.6)
SLIDES = st.tuples(*[st.floats(0.03, 0.3)] * 3)


@pytest.mark.parametrize("backend", ["numpy", pytest.param("compiled", marks=pytest.mark.compiler)])
@pytest.mark.parametrize("case", CASES, ids=lambda case: case["arrangement"])
def test_all_solutions_are_those_of_the_reference(case: dict[str, Any], backend: str) -> None:
    robot = krhpr.load(f"spatial_rrr_{case['arrangement']}", backend=backend)
    p, Q, redundant, det_J, count = robot.forward_all(np.array(case["s"]) / 1000)
    assert count == len(case["solutions"]) == 2
    assert det_J[0] * det_J[1] < 0
    gaps = np.array(
        [
            [
                max(
                    np.abs(p[k] - np.array(wanted["p"]) / 1000).max(),
                    np.abs(Q[k] - wanted["Q"]).max(),
                    np.abs(redundant[k] - np.array(wanted["redundant"]) / 1000).max(),
                )
                for wanted in case["solutions"]
            ]
            for k in range(2)
        ]
    )
    assert gaps.min(axis=0).max() < 1e-12
    assert gaps.min(axis=1).max() < 1e-12


def random_poses(
    robot: krhpr.Robot, count: int, seed: int
) -> tuple[np.ndarray[Any, Any], np.ndarray[Any, Any], np.ndarray[Any, Any]]:
    """Poses about home with redundant coordinates on the positive side of type II."""
    rng = np.random.default_rng(seed)
    home = robot.home
    p = np.array(home.p) + rng.uniform(-0.05, 0.05, (count, len(home.p)))
    if robot.planar:
        Q = rng.uniform(-0.5, 0.5, count)
    else:
        Q = rotations(rng.normal(size=(count, 3)) * 0.3)
    redundant = np.array(home.redundant) * rng.uniform(0.6, 1.4, (count, 3))
    return p, Q, redundant


@pytest.mark.compiler
@pytest.mark.parametrize("identifier", CLOSED)
def test_the_joints_give_the_pose_back(identifier: str, full: bool) -> None:
    """No guess and no extra encoder: not one pose is missed, in every working mode."""
    robot = krhpr.load(identifier, backend="compiled")
    if not robot.modes or "inverse_all" not in robot.functions:
        pytest.skip("its sub-legs have no inverse in closed form")
    p, Q, redundant = random_poses(robot, 100_000 if full else 2_000, seed=7)
    s = robot.end_points(p, Q, redundant)
    every = robot.subleg_inverse(s)
    side = np.sign(robot.type_2_of_redundant(redundant).margins[..., 0])
    missed = 0
    for mode in range(len(robot.modes)):
        theta = every[..., mode, :]
        reached = np.isfinite(theta).all(axis=(1, 2))
        choice = _assembly(robot, theta, s)
        if "near" in choice:  # where a sub-leg's own assembly modes all but meet, a point near tells nothing
            led = np.abs(robot.subleg_forward(theta, **choice) - s).max(axis=(1, 2)) < 1e-9
            assert led[reached].mean() > 0.99
            reached &= led
        found = robot.forward(theta, **choice, side=side)
        gap = np.abs(found.p - p).max(axis=-1) + np.abs(found.redundant - redundant).max(axis=-1)
        turn = found[1] - Q
        gap = gap + np.abs(np.sin(turn / 2) if robot.planar else turn).reshape(len(p), -1).max(axis=-1)
        # joints at the edge of reach lose half the digits: the end point is then met to 1e-8 alone
        missed += int((~(gap[reached] < 1e-6)).sum())
        assert np.median(gap[reached]) < 1e-13 if reached.any() else True
    assert missed == 0


def _assembly(robot: krhpr.Robot, theta: Any, s: Any) -> dict[str, Any]:
    """The assembly mode of every leg that leads to its end point: signs, or a point near it."""
    if any(port.name == "s_near" for port in robot.signature("forward").inputs):
        return {"near": s + 1e-4}
    if not robot.assemblies:
        return {}
    signs = np.array([robot.assembly_signs(label) for label in robot.assemblies])
    ends = np.stack([robot.subleg_forward(theta, sign) for sign in signs])
    gap = np.nan_to_num(np.abs(ends - s).max(axis=-1), nan=np.inf)
    best = gap.argmin(axis=0)
    return {"assembly": np.take_along_axis(signs[:, None], best[None, ..., None], axis=0)[0]}


@given(turn=st.tuples(ANGLES, ANGLES, ANGLES), slides=SLIDES)
def test_the_platform_turned_over(turn: tuple[float, ...], slides: tuple[float, ...]) -> None:
    """Arrangement (c) fits any triangle from both sides; their normals are opposite.

    An equilateral triangle is the exception: from below its lines meet in one point for every phi.
    """
    assume(max(slides) - min(slides) > 0.01)
    robot = krhpr.load("spatial_rrr_c", backend="numpy")
    s = robot.end_points(robot.home.p, rotations(np.array([turn]))[0], slides)
    one, other = robot.forward_all(s), robot.forward_all(s, turned=True)
    assert one.count == other.count == 2
    assert np.allclose(one.Q[:, :, 2], -other.Q[:, :, 2], rtol=0, atol=1e-9)
    for found in (one, other):
        assert np.abs(robot.constraints(found.p, found.Q, s)).max() < 1e-9
        factors = robot.type_2_of_redundant(found.redundant).type_2
        assert np.allclose(factors.prod(axis=-1), found.det_J, rtol=0, atol=1e-9)
    # in the standard family the end points go round z' in the legs' order, in the other the other way
    assert (robot.type_2_of_redundant(one.redundant).type_2[:, 1] > 0).all()
    assert (robot.type_2_of_redundant(other.redundant).type_2[:, 1] < 0).all()


@pytest.mark.parametrize("backend", ["numpy", pytest.param("compiled", marks=pytest.mark.compiler)])
@pytest.mark.parametrize("identifier", ["spatial_rrr_b", "spatial_rrr_c", "planar_rr_b", "planar_rr_c"])
def test_hostile_end_points_have_a_status(identifier: str, backend: str) -> None:
    robot = krhpr.load(identifier, backend=backend)
    d = 2 if robot.planar else 3
    good = robot.end_points(*robot.home)
    same, line = np.stack([good[0]] * 3), np.outer([0.0, 1.0, 2.0], np.ones(d))
    small = good.mean(axis=0) + 1e-3 * (good - good.mean(axis=0))
    infinite = np.where(np.arange(d) == 0, np.nan, good)
    (p, *_, count), status = robot.forward_all(np.stack([good, same, line, small, infinite]), status=True)
    names = [krhpr.Status(code).name for code in status]
    assert names[0] == "OK" and count[0] == 2
    assert names[4] == "INVALID_INPUT"
    if robot.planar:
        assert names[1] == "SINGULAR_IN_PLANE"
    else:
        assert names[1] == names[2] == "SINGULAR_NORMAL"
    if identifier.endswith("_b"):
        assert names[3] == "NO_ASSEMBLY"
        with pytest.raises(krhpr.Unassembled, match="no platform of this geometry"):
            robot.forward_all(small, check=True)
    failed = status != 0
    assert np.isnan(p[failed]).all() and np.isfinite(p[~failed]).all()
    assert (count[failed & (status != krhpr.Status.INVALID_INPUT)] == 0).all()
    alone = robot.forward_all(good)
    assert all(np.array_equal(a, b[0]) for a, b in zip((alone.p,), (p,), strict=True))


def test_a_planar_platform_is_not_turned_over() -> None:
    robot = krhpr.load("planar_rr_b", backend="numpy")
    with pytest.raises(krhpr.UnknownBranch, match="cannot be turned over"):
        robot.forward_all(robot.end_points(*robot.home), turned=True)
