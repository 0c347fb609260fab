"""Forward kinematics of the platforms: references, both families, hostile end points, many poses."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

import krhpr
from krhpr.generated.python.runtime import at_roots
from krhpr.validation.sampling import rotations
from tests.support import ROOT, with_cover

REFERENCE = ROOT / "tests" / "reference"
CASES = json.loads((REFERENCE / "platforms.json").read_text("utf-8"))["forward"]
PLANAR = json.loads((REFERENCE / "planar_fk.json").read_text("utf-8"))["cases"]
BACKENDS = ["numpy", pytest.param("compiled", marks=pytest.mark.compiler)]
ANGLES = st.floats(-0.6, 0.6)
SLIDES = st.tuples(*[st.floats(0.03, 0.3)] * 3)


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize("case", CASES, ids=lambda case: case["arrangement"])
def test_all_solutions_are_those_of_the_reference(case: dict[str, Any], backend: str) -> None:
    robot = krhpr.load(f"spatial_rrr_{case['arrangement']}", backend=backend)
    found = robot.forward_all(np.array(case["s"]) / 1000)
    assert found.count == len(case["solutions"])
    lengths = case["arrangement"] != "a"
    gaps = np.array(
        [
            [
                max(
                    np.abs(found.p[k] - np.array(wanted["p"]) / 1000).max(),
                    np.abs(found.Q[k] - wanted["Q"]).max(),
                    _apart(
                        found.redundant[k], np.array(wanted["redundant"]) / (1000 if lengths else 1), lengths
                    ),
                )
                for wanted in case["solutions"]
            ]
            for k in range(int(found.count))
        ]
    )
    assert gaps.min(axis=0).max() < 1e-10
    assert gaps.min(axis=1).max() < 1e-10
    assert np.isnan(found.p[int(found.count) :]).all()


def _apart(redundant: Any, wanted: Any, lengths: bool) -> float:
    gap = redundant - wanted
    return float(np.abs(gap if lengths else np.exp(1j * gap) - 1).max())


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize("case", PLANAR, ids=lambda case: case["name"])
def test_all_solutions_of_general_planar_platforms(case: dict[str, Any], backend: str) -> None:
    """Any triangle and any lengths: two, four and six poses."""
    b = np.array(case["b"])
    robot = krhpr.load("planar_rr_a", backend=backend).with_geometry(
        platform_azimuth=np.arctan2(b[:, 1], b[:, 0]), R_p=np.hypot(*b.T), l_r=case["l"]
    )
    found, poses = robot.forward_all(case["r"]), np.array(case["poses"])
    assert (found.count, found.doubtful) == (len(poses), 0)
    assert (np.diff(found.det_J[: len(poses)]) > 0).all()
    for pose, beta in zip(poses, case["beta"], strict=True):
        gap = np.abs(found.p - pose[:2]).max(axis=-1) + np.abs(np.exp(1j * (found.phi - pose[2])) - 1)
        best = int(np.nanargmin(gap))
        assert gap[best] < 1e-9
        assert _apart(found.redundant[best], np.array(beta), False) < 1e-10


@pytest.mark.compiler
@pytest.mark.parametrize("identifier", ["spatial_rrr_a", "planar_rr_a"])
def test_the_pose_is_among_the_roots(identifier: str, full: bool) -> None:
    """Not one pose is missed inside the box of unique solutions, where no other solution is."""
    robot = krhpr.load(identifier, backend="compiled")
    count = 100_000 if full else 5_000
    p, Q, redundant = random_poses(robot, count, seed=3)
    s = robot.end_points(p, Q, redundant)
    found, status = robot.forward_all(s, status=True)
    assert (status == 0).all()
    inside = ((found.redundant > np.radians(30)) & (found.redundant < np.radians(150))).all(axis=-1)
    assert (inside.sum(axis=-1) == 1).all()
    k = np.argmax(inside, axis=-1)
    rows = np.arange(count)
    assert (
        np.abs(found.redundant[rows, k] - redundant).max() < 1e-7
    )  # near the edges of the box det J is small
    assert np.abs(found.p[rows, k] - p).max() < 1e-7
    assert np.median(np.abs(found.redundant[rows, k] - redundant)) < 1e-14
    # counts are even, and every solution closes the platform
    sure = found.doubtful == 0
    assert sure.mean() > 0.995
    assert (found.count[sure] % 2 == 0).all()
    kept = np.isfinite(found.det_J)
    place = np.nonzero(kept)
    residual = robot.constraints(found.p[kept], found[1][kept], s[place[0]])
    assert np.abs(residual).max() < 1e-10


@pytest.mark.parametrize("backend", BACKENDS)
def test_two_poses_with_one_orientation(backend: str) -> None:
    """Where z_2 and z_3 are parallel, so that D = 0, a pose and its mirror image share phi: a double root.

    Beside it the elimination loses most digits of a_1.  What is returned closes the platform all the same,
    and what could not be found is in doubt.
    """
    rng = np.random.default_rng(12)
    misses = 0
    for _ in range(60):
        b = 0.12 * (np.array([[1, 0], [-0.5, 0.8], [-0.5, -0.9]]) + 0.2 * rng.normal(size=(3, 2)))
        phi, along = rng.uniform(-3, 3), rng.normal(size=2)
        R = np.array([[np.cos(phi), -np.sin(phi)], [np.sin(phi), np.cos(phi)]])
        a = np.array([0.05, 0.02]) + 0.01 * rng.normal(size=2)
        z = np.outer([0.0, *rng.uniform(0.02, 0.06, 2)], along / np.linalg.norm(along))
        robot = krhpr.load("planar_rr_a", backend=backend).with_geometry(
            platform_azimuth=np.arctan2(b[:, 1], b[:, 0]),
            R_p=np.hypot(*b.T),
            l_r=np.linalg.norm(a + z, axis=1),
        )
        s = (b - b[0]) @ R.T - z
        assert robot.forward_all(s).doubtful
        beside = s + 10.0 ** rng.uniform(-10, -3, (40, 1, 1)) * rng.normal(size=(40, 3, 2))
        found, status = robot.forward_all(beside, status=True)
        assert np.isin(status, (0, krhpr.Status.NO_ASSEMBLY)).all()
        kept = np.isfinite(found.det_J)
        residual = robot.constraints(found.p[kept], found.phi[kept], beside[np.nonzero(kept)[0]])
        assert np.abs(residual).max(initial=0.0) < 1e-10
        assert (found.count == kept.sum(axis=-1)).all()
        assert ((found.count % 2 == 0) | (found.doubtful == 1)).all()
        misses += int((found.doubtful == 1).sum())
    assert misses > 0


@pytest.mark.parametrize(("wrong", "left"), [((), 3), ((0.5,), 2), ((-1.0, 0.5, 2.0), 0)])
def test_a_root_that_misses_is_left_out_and_in_doubt(wrong: tuple[float, ...], left: int) -> None:
    """The roots -1, 1/2 and 2, in the order of -T; another polynomial in the batch has none of them."""

    def step(root: tuple[Any, Any]) -> tuple[tuple[Any, ...], ...]:
        T = root[0] / root[1]
        miss = np.where(np.isclose(T[..., None], wrong).any(axis=-1), 1.0, 0.0)
        return (T, 10 * T), (-T,), (miss,)

    c = np.array([np.convolve([1.0, 1.0], np.convolve([-0.5, 1.0], [-2.0, 1.0])), [5.0, 1.0, 0.0, 0.0]])
    rows, _, (count,), (doubtful,), (found,) = at_roots(step, tuple(c.T), 0.0, 0.5, 1)
    T, tenfold = np.array(rows)[0::2, 0], np.array(rows)[1::2, 0]
    expected = [value for value in (2.0, 0.5, -1.0) if value not in wrong]
    assert T[:left] == pytest.approx(expected) and np.isnan(T[left:]).all()
    assert tenfold[:left] == pytest.approx(10 * T[:left])
    assert (count[0], doubtful[0], found[0]) == (left, bool(wrong), left + bool(wrong))


@pytest.mark.parametrize("backend", BACKENDS)
def test_links_that_may_turn_freely_are_in_doubt(backend: str) -> None:
    """Where the end points repeat the platform's own triangle the links may turn side by side."""
    robot = krhpr.load("planar_rr_a", backend=backend)
    radius, length = float(robot.geometry.R_p[0]), float(robot.geometry.l_r[0])
    beta = np.arccos(length / (2 * radius))
    s = robot.end_points((0.0, 0.0), 0.0, (beta, beta, beta))
    found = robot.forward_all(s)
    assert found.count == 2 and found.doubtful > 0
    assert np.nanmin(np.abs(found.redundant - beta).max(axis=-1)) < 1e-12


def random_poses(
    robot: krhpr.Robot, count: int, seed: int
) -> tuple[np.ndarray[Any, Any], np.ndarray[Any, Any], np.ndarray[Any, Any]]:
    """Poses about home; redundant angles in almost all of the box, slides on the positive side of type II."""
    rng = np.random.default_rng(seed)
    home = robot.home
    p = np.array(home.p) + rng.uniform(-0.05, 0.05, (count, len(home.p)))
    if robot.planar:
        Q = rng.uniform(-0.5, 0.5, count)
    else:
        Q = rotations(rng.normal(size=(count, 3)) * 0.3)
    if len(robot.box):
        return p, Q, rng.uniform(np.radians(31), np.radians(149), (count, 3))
    return p, Q, np.array(home.redundant) * rng.uniform(0.6, 1.4, (count, 3))


@pytest.mark.compiler
@pytest.mark.parametrize("identifier", with_cover(krhpr.catalogue()))
def test_the_joints_give_the_pose_back(identifier: str, full: bool) -> None:
    """No guess and no extra encoder: not one pose is missed, in every working mode."""
    robot = krhpr.load(identifier, backend="compiled")
    p, Q, redundant = random_poses(robot, 100_000 if full else 2_000, seed=7)
    s = robot.end_points(p, Q, redundant)
    every = robot.subleg_inverse(s)
    known = {} if len(robot.box) else {"side": np.sign(robot.type_2_of_redundant(redundant).margins[..., 0])}
    missed = 0
    for mode in range(len(robot.modes)):
        theta = every[..., mode, :]
        reached = np.isfinite(theta).all(axis=(1, 2))
        choice = _assembly(robot, theta, s)
        if "near" in choice:  # where a sub-leg's own assembly modes all but meet, a point near tells nothing
            led = np.abs(robot.subleg_forward(theta, **choice) - s).max(axis=(1, 2)) < 1e-9
            assert led[reached].mean() > 0.99
            reached &= led
        found = robot.forward(theta, **choice, **known)
        assert (found.certified[reached] == 1).all()
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


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize("identifier", [f"{leg}_{a}" for leg in ("spatial_rrr", "planar_rr") for a in "abc"])
def test_hostile_end_points_have_a_status(identifier: str, backend: str) -> None:
    robot = krhpr.load(identifier, backend=backend)
    d = 2 if robot.planar else 3
    good = robot.end_points(*robot.home)
    same, line = np.stack([good[0]] * 3), np.outer([0.0, 1.0, 2.0], np.ones(d))
    small = good.mean(axis=0) + 1e-3 * (good - good.mean(axis=0))
    infinite = np.where(np.arange(d) == 0, np.nan, good)
    found, status = robot.forward_all(np.stack([good, same, line, small, infinite]), status=True)
    p, count = found.p, found.count
    names = [krhpr.Status(code).name for code in status]
    assert names[0] == "OK" and count[0] >= 2
    assert names[4] == "INVALID_INPUT"
    if robot.planar:
        assert names[1] == ("NO_ASSEMBLY" if identifier.endswith("_a") else "SINGULAR_IN_PLANE")
    else:
        assert names[1] == names[2] == "SINGULAR_NORMAL"
    if not identifier.endswith("_c"):
        assert names[3] == "NO_ASSEMBLY"
        with pytest.raises(krhpr.Unassembled, match="no platform of this geometry"):
            robot.forward_all(small, check=True)
    failed = status != 0
    assert np.isnan(p[failed]).all() and np.isfinite(p[~failed][:, 0]).all()
    assert (count[failed & (status != krhpr.Status.INVALID_INPUT)] == 0).all()
    assert np.array_equal(robot.forward_all(good).p, p[0], equal_nan=True)


def test_a_planar_platform_is_not_turned_over() -> None:
    robot = krhpr.load("planar_rr_b", backend="numpy")
    with pytest.raises(krhpr.UnknownBranch, match="cannot be turned over"):
        robot.forward_all(robot.end_points(*robot.home), turned=True)
