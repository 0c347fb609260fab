"""Approaches two to seven of Chapter 3, passive joints from actuated ones, and what `forward` says."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import krhpr
from krhpr.validation.sampling import rotations
from tests.test_forward import random_poses

BACKENDS = ["numpy", pytest.param("compiled", marks=pytest.mark.compiler)]
REVOLUTE = ["spatial_rrr_a", "planar_rr_a"]
PLATFORMS = [f"{leg}_{a}" for leg in ("spatial_rrr", "planar_rr") for a in "abc"]


@pytest.fixture(params=BACKENDS)
def backend(request: pytest.FixtureRequest) -> str:
    return str(request.param)


def apart(robot: krhpr.Robot, found: Any, wanted: Any) -> Any:
    """How far orientations are from one another."""
    if robot.planar:
        return np.abs(np.exp(1j * found) - np.exp(1j * wanted))
    return np.abs(found - wanted).max(axis=(-2, -1))


def turned(robot: krhpr.Robot, Q: Any, vector: Any) -> Any:
    """Orientations turned a little."""
    return Q + vector[:, 0] if robot.planar else Q @ rotations(vector)


# -- approach one, with its certificate ---------------------------------------------------------------------


@pytest.mark.parametrize("identifier", REVOLUTE)
def test_what_forward_says(identifier: str, backend: str) -> None:
    robot = krhpr.load(identifier, backend=backend)
    theta = robot.inverse(*robot.home)
    found, status = robot.forward(theta, status=True)
    assert (status, found.certified) == (0, 1) and found.count in (2, 4, 6)
    # the theorem says nothing of unequal links, nor of boxes beyond (30, 150) degrees
    unequal = robot.with_geometry(l_r=robot.geometry.l_r * [1, 1.01, 1])
    one = unequal.forward(unequal.inverse(*robot.home))
    assert one.certified == 0 and np.allclose(one.p, robot.home.p, rtol=0, atol=1e-12)
    wide = np.radians([[20, 160]] * 3)
    assert robot.forward(theta, box=wide).certified == 0
    everywhere, code = robot.forward(theta, box=np.radians([[-180, 180]] * 3), status=True)
    assert code == krhpr.Status.AMBIGUOUS and np.isnan(everywhere.p).all()
    with pytest.raises(krhpr.Ambiguous, match="smaller box"):
        robot.forward(theta, box=np.radians([[-180, 180]] * 3), check=True)
    with pytest.raises(krhpr.Unassembled):
        robot.forward(theta, box=np.radians([[140, 141]] * 3), check=True)
    with pytest.raises(krhpr.UnknownBranch, match="no side"):
        robot.forward(theta, side=1)
    # a box counts in full turns
    shifted = robot.forward(theta, box=robot.box + 4 * np.pi)
    assert np.allclose(shifted.redundant, found.redundant + 4 * np.pi, rtol=0, atol=1e-14)


@pytest.mark.parametrize("identifier", REVOLUTE)
def test_unequal_platforms_are_told_by_looking(identifier: str, backend: str) -> None:
    """Where the theorem does not apply, one solution in the box is the pose; several are said to be."""
    robot = krhpr.load(identifier, backend=backend)
    robot = robot.with_geometry(
        R_p=robot.geometry.R_p * [0.9, 1.05, 1.0],
        l_r=robot.geometry.l_r * [1.0, 1.5, 2.0],
        platform_azimuth=np.add(robot.geometry.platform_azimuth, [0.1, -0.1, 0.2]),
    )
    p, Q, redundant = random_poses(robot, 3000, seed=5)
    theta, reached = robot.inverse(p, Q, redundant, status=True)
    found, status = robot.forward(theta, status=True)
    ok = (status == 0) & (reached == 0)
    assert np.isin(status[reached == 0], (0, krhpr.Status.AMBIGUOUS)).all()
    assert (found.certified[ok] == 0).all() and ok.mean() > 0.8
    assert np.abs(found.p[ok] - p[ok]).max() < 1e-6


# -- approach two -------------------------------------------------------------------------------------------


@pytest.mark.parametrize("identifier", REVOLUTE)
def test_newton_steps_lead_to_the_pose(identifier: str, backend: str, full: bool) -> None:
    robot = krhpr.load(identifier, backend=backend)
    count = 50_000 if full else 2_000
    p, Q, redundant = random_poses(robot, count, seed=1)
    redundant = np.clip(redundant, np.radians(50), np.radians(130))
    s = robot.end_points(p, Q, redundant)
    rng = np.random.default_rng(2)
    size = 10.0 ** rng.uniform(-6, -1, (count, 1))
    p_near = p + 0.1 * size * rng.normal(size=p.shape)
    Q_near = turned(robot, Q, size * rng.normal(size=(count, 3)))
    found, status = robot.forward_newton(s, p_near, Q_near, status=True)
    assert np.isin(status, (0, krhpr.Status.NO_CONVERGENCE)).all()
    certain = found.kantorovich <= 1
    assert 0.2 < certain.mean() < 0.99
    assert (status[certain] == 0).all()  # the certificate is never wrong
    gap = np.abs(found.p - p).max(axis=-1) + apart(robot, found[1], Q)
    assert gap[certain].max() < 1e-9 and np.median(gap[certain]) < 1e-13
    assert np.abs(found.redundant - redundant)[certain].max() < 1e-8
    # and it is not shy: of the steps of a millimetre almost all are certain
    assert certain[size[:, 0] < 1e-3].mean() > 0.9


@pytest.mark.parametrize("identifier", REVOLUTE)
def test_the_certificate_is_that_of_the_theorem(identifier: str) -> None:
    """2 b K n, with the slope by finite differences and second differences below its K."""
    robot = krhpr.load(identifier, backend="numpy")
    p, Q, redundant = random_poses(robot, 20, seed=3)
    s = robot.end_points(p, Q, redundant)
    rng = np.random.default_rng(4)
    b = _anchors(robot)
    size = np.sqrt(((b[1:] - b[0]) ** 2).sum() / 2)
    for k in range(20):
        r, x = _in_plane(robot, s[k]), 1e-3 * rng.normal(size=3)
        near = _pose_of(robot, s[k], p[k], Q[k], x)
        said = robot.forward_newton(s[k], *near).kantorovich
        start = _unknowns(robot, s[k], *near)

        def lengths(v: Any, r: Any = r) -> Any:
            a = v[1:] + (b - b[0]) @ _rotation(v[0] / size).T - r
            return (np.sum(a * a, axis=1) - robot.geometry.l_r**2) / 2

        step = 1e-5
        slope = np.stack(
            [(lengths(start + step * e) - lengths(start - step * e)) / (2 * step) for e in np.eye(3)], 1
        )
        n = np.linalg.norm(np.linalg.solve(slope, lengths(start)))
        beta = np.linalg.norm(np.linalg.inv(slope))
        K = said / (2 * beta * n)
        worst = 0.0
        for _ in range(200):
            at = start + 2 * n * _unit(rng) * rng.random()
            u = _unit(rng)
            h = 1e-4
            second = (lengths(at + h * u) - 2 * lengths(at) + lengths(at - h * u)) / h**2
            worst = max(worst, float(np.linalg.norm(second)))
        assert worst <= K * (1 + 1e-6)
        assert 10 * worst > K  # the bound is not idle


def _unit(rng: Any) -> Any:
    v = rng.normal(size=3)
    return v / np.linalg.norm(v)


def _rotation(angle: float) -> Any:
    return np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])


def _anchors(robot: krhpr.Robot) -> Any:
    g = robot.geometry
    return g.R_p[:, None] * np.stack([np.cos(g.platform_azimuth), np.sin(g.platform_azimuth)], axis=1)


def _axes(s: Any) -> Any:
    x = (s[1] - s[0]) / np.linalg.norm(s[1] - s[0])
    z = np.cross(s[1] - s[0], s[2] - s[0])
    z /= np.linalg.norm(z)
    return np.stack([x, np.cross(z, x), z], axis=1)


def _in_plane(robot: krhpr.Robot, s: Any) -> Any:
    return s - s[0] if robot.planar else ((s - s[0]) @ _axes(s))[:, :2]


def _pose_of(robot: krhpr.Robot, s: Any, p: Any, Q: Any, x: Any) -> tuple[Any, Any]:
    """The pose moved in the platform's plane: turned by x_0 / R, and by (x_1, x_2)."""
    if robot.planar:
        return p + x[1:], Q + 10 * x[0]
    axes = _axes(s)
    turn = np.eye(3)
    turn[:2, :2] = _rotation(10 * x[0])
    return p + axes[:, :2] @ x[1:], axes @ turn @ axes.T @ Q


def _unknowns(robot: krhpr.Robot, s: Any, p: Any, Q: Any) -> Any:
    """phi times the platform's size, and a_1."""
    b = _anchors(robot)
    size = np.sqrt(((b[1:] - b[0]) ** 2).sum() / 2)
    if robot.planar:
        return np.array([Q * size, *(p + _rotation(Q) @ b[0] - s[0])])
    axes = _axes(s)
    phi = np.arctan2(axes[:, 1] @ Q[:, 0], axes[:, 0] @ Q[:, 0])
    return np.array([phi * size, *(axes[:, :2].T @ (p + Q[:, :2] @ b[0] - s[0]))])


def test_steps_that_lead_nowhere_are_said_to(backend: str) -> None:
    robot = krhpr.load("planar_rr_a", backend=backend)
    s = robot.end_points(*robot.home)
    far, status = robot.forward_newton(s * 3, robot.home.p, 0.0, status=True)
    assert status == krhpr.Status.NO_CONVERGENCE and np.isnan(far.p).all()
    with pytest.raises(krhpr.NoConvergence, match="start nearer"):
        robot.forward_newton(s * 3, robot.home.p, 0.0, check=True)


@pytest.mark.parametrize("identifier", REVOLUTE)
def test_short_steps_alone_are_no_pose(identifier: str, backend: str) -> None:
    """From far away rounding takes the slope away, and some step is short by chance."""
    robot = krhpr.load(identifier, backend=backend)
    p, Q, redundant = random_poses(robot, 20_000, seed=8)
    s = robot.end_points(p, Q, redundant)
    rng = np.random.default_rng(9)
    for distance in (1e10, 1e13, 1e16):
        found, status = robot.forward_newton(s, p + distance * rng.normal(size=p.shape), Q, status=True)
        good = status == 0
        assert good.mean() < 1
        assert np.isfinite(found.kantorovich[good]).all()
        gap = np.abs(robot.end_points(found.p, found[1], found.redundant) - s)[good]
        assert gap.max(initial=0) < 1e-6


# -- approaches three to seven ------------------------------------------------------------------------------


@pytest.mark.parametrize("identifier", PLATFORMS)
def test_encoders_give_the_pose(identifier: str, backend: str) -> None:
    robot = krhpr.load(identifier, backend=backend)
    p, Q, redundant = random_poses(robot, 400, seed=8)
    s = robot.end_points(p, Q, redundant)
    for count in (2, 3):
        for approach in (robot.forward_encoders, robot.forward_gauss_newton):
            found = approach(s, redundant[:, :count])
            assert np.abs(found.p - p).max() < 1e-9
            assert apart(robot, found[1], Q).max() < 1e-9
            assert np.abs(found.mismatch).max() < 1e-12
            raw = _rotation(Q[0]) if robot.planar else Q[0]
            assert np.abs(found.raw[0] - raw).max() < 1e-9
    if not len(robot.box):
        with pytest.raises(AttributeError, match="has no function 'forward_encoders_1'"):
            robot.forward_encoders(s, redundant[:, :1])


@pytest.mark.parametrize("identifier", REVOLUTE)
def test_one_encoder(identifier: str, backend: str) -> None:
    """Two solutions, told apart by the third link's length."""
    robot = krhpr.load(identifier, backend=backend)
    p, Q, redundant = random_poses(robot, 3000, seed=9)
    s = robot.end_points(p, Q, redundant)
    found, status = robot.forward_encoders(s, redundant[:, :1], tolerance=1e-4, status=True)
    assert (status == 0).mean() > 0.99 and np.isin(status, (0, krhpr.Status.INCONSISTENT)).all()
    best, other = np.abs(found.mismatch).T
    told = other > 1e-4
    assert told.mean() > 0.95 and (best <= other)[status == 0].all()
    assert np.median(np.abs(found.p[:, 0] - p)[told]) < 1e-15
    assert np.abs(found.p[:, 0] - p)[told].max() < 1e-6
    # so far away that both fit alike
    s[:, 2] *= 1e16
    found, status = robot.forward_encoders(s, redundant[:, :1], tolerance=1e20, status=True)
    alike = found.mismatch[:, 0] == found.mismatch[:, 1]
    assert (status == 0).mean() > 0.99 and alike.any() and np.isfinite(found.p[status == 0]).all()


def test_the_example_of_the_thesis(backend: str) -> None:
    """Section 3.2.3: phi = -21.801 deg with l_34 = 50 mm, and -3.680 deg with 29.669 mm."""
    robot = krhpr.load("planar_rr_a", backend=backend).with_geometry(R_p=0.125, l_r=0.05)
    s = np.array([[0.0, 0.0], [0.2331845, 0.0], [0.1165923, 0.2019437]])
    every = robot.forward_all(s)
    assert every.count == 2
    side = _anchors(robot)[1] - _anchors(robot)[0]
    sides = np.degrees(every.phi[:2] + np.arctan2(side[1], side[0]))
    sides = (sides + 180) % 360 - 180
    assert np.sort(np.abs(np.abs(sides) - 21.8014)).max() < 1e-3
    k = int(np.argmin(every.phi[:2]))
    found = robot.forward_encoders(s, every.redundant[k, :1], tolerance=1e-3)
    assert found.phi[0] == pytest.approx(every.phi[k], abs=1e-9)
    assert np.degrees(found.phi[1] - found.phi[0]) == pytest.approx(21.801 - 3.680, abs=1e-3)
    assert found.mismatch == pytest.approx([0.0, 0.029669 - 0.050], abs=2e-6)


@pytest.mark.parametrize("count", [2, 3])
@pytest.mark.parametrize("arrangement", "abc")
def test_least_squares_are_least(arrangement: str, count: int, backend: str) -> None:
    """The gradient of the sum of squares, in all nine unknowns of (3.7), is zero at the answer."""
    robot = krhpr.load(f"spatial_rrr_{arrangement}", backend=backend)
    p, Q, redundant = random_poses(robot, 40, seed=10)
    s = robot.end_points(p, Q, redundant)
    rng = np.random.default_rng(11)
    measured = redundant[:, :count] + rng.uniform(-0.01, 0.01, (40, count))
    s = s + rng.uniform(-1e-3, 1e-3, s.shape)
    for weights in ((1000.0, 1000.0, 1000.0), (1000.0, 1e5, 1.0), (10.0, 3.0, 400.0)):
        found = robot.forward_gauss_newton(s, measured, weights=weights)
        simple = robot.forward_encoders(s, measured)
        for k in range(40):
            ends = robot.end_points((0, 0, 0), np.eye(3), np.pad(measured[k], (0, 3 - count)))
            q_z = _axes(s[k])[:, 2]
            tie = _tie(robot, s[k, 2], q_z) if count == 2 else None
            wrong = _sum_of_squares(s[k], ends[:count], q_z, weights, tie)
            x = np.concatenate([found.raw[k][:, 0], found.raw[k][:, 1], found.p[k]])
            slope, scale = wrong(x)
            assert np.abs(slope).max() < 1e-8 * scale
            assert np.allclose(found.raw[k][:, 2], q_z, rtol=0, atol=1e-12)
        assert np.abs(found.p - simple.p).max() < 0.02


def _tie(robot: krhpr.Robot, s_3: Any, q_z: Any) -> Any:
    """By how much S_3 misses the end of its link, or the line of its slide."""
    if len(robot.box):
        b, length = _anchors(robot)[2], robot.geometry.l_r[2]

        def link(p: Any, q_x: Any, q_y: Any) -> float:
            a = p + q_x * b[0] + q_y * b[1] - s_3
            return float((a @ a - length**2) / (2 * length))

        return link
    start, end = (robot.end_points((0, 0, 0), np.eye(3), (d, d, d))[2] for d in (0.0, 1.0))

    def slide(p: Any, q_x: Any, q_y: Any) -> float:
        from_start, along = (
            s_3 - p - q_x * start[0] - q_y * start[1],
            q_x * (end - start)[0] + q_y * (end - start)[1],
        )
        return float(q_z @ np.cross(along, from_start))

    return slide


def _sum_of_squares(s: Any, ends: Any, q_z: Any, weights: Any, tie: Any) -> Any:
    def residual(x: Any) -> Any:
        q_x, q_y, p = x[:3], x[3:6], x[6:]
        parts = [weights[0] * (s[i] - p - q_x * d[0] - q_y * d[1]) for i, d in enumerate(ends)]
        if tie is not None:
            parts.append([weights[1] * tie(p, q_x, q_y)])
        parts.append(
            [weights[0] * (s[0] - p) @ q_z, weights[2] * (q_x @ q_x - 1), weights[2] * (q_y @ q_y - 1)]
        )
        parts.append([weights[2] * q_x @ q_y, weights[2] * q_x @ q_z, weights[2] * q_y @ q_z])
        return np.concatenate(parts)

    def slope(x: Any) -> tuple[Any, float]:
        h = 1e-6
        J = np.stack([(residual(x + h * e) - residual(x - h * e)) / (2 * h) for e in np.eye(9)], axis=1)
        f = residual(x)
        return J.T @ f, float(np.linalg.norm(J) * np.linalg.norm(f))

    return slope


@pytest.mark.parametrize("identifier", PLATFORMS)
def test_encoders_that_contradict_the_legs(identifier: str, backend: str) -> None:
    robot = krhpr.load(identifier, backend=backend)
    s = robot.end_points(*robot.home)
    wrong = np.array(robot.home.redundant) + np.array([0.5, -0.3, 0.4]) * (1.0 if len(robot.box) else 0.1)
    for count in (2, 3):
        found, status = robot.forward_encoders(s, wrong[:count], tolerance=1e-3, status=True)
        assert status == krhpr.Status.INCONSISTENT and np.isnan(found.p).all()
    with pytest.raises(krhpr.Inconsistent, match="contradict"):
        robot.forward_gauss_newton(s, wrong, tolerance=1e-3, check=True)
    infinite = robot.forward_encoders(s, np.array([np.nan, 1.0]), status=True)[1]
    assert infinite == krhpr.Status.INVALID_INPUT
    # end points that are one tell no orientation, whatever is tolerated
    for count in (2, 3):
        nowhere = robot.forward_encoders(0 * s, wrong[:count], tolerance=1e9, status=True)[1]
        assert nowhere == (krhpr.Status.SINGULAR_IN_PLANE if robot.planar else krhpr.Status.SINGULAR_NORMAL)
    if identifier.endswith("c"):  # nor do slides that meet where their end points are
        nowhere = robot.forward_encoders(s, (1e-160, 1e-160), tolerance=1e9, status=True)[1]
        assert nowhere == krhpr.Status.SINGULAR_IN_PLANE
    if not robot.planar:
        line = np.outer([0.0, 1.0, 2.0], np.ones(3))
        assert robot.forward_encoders(line, wrong, status=True)[1] == krhpr.Status.SINGULAR_NORMAL


# -- passive joints -----------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "identifier", ["spatial_r_fivebar_a", "spatial_delta_b", "planar_rr_c", "spatial_rrrr_a"]
)
def test_passive_joints_from_actuated_ones(identifier: str, backend: str) -> None:
    robot = krhpr.load(identifier, backend=backend)
    p, Q, redundant = robot.home
    theta, s = robot.inverse(p, Q, redundant), robot.end_points(p, Q, redundant)
    near = {"near": s} if robot.signature("forward").inputs[1].name == "s_near" else {}
    found = robot.passive_joints_of_theta(theta, **near)
    wanted = robot.passive_joints(p, Q, s, theta)
    for name, value in wanted._asdict().items():
        assert np.allclose(getattr(found, name), value, rtol=0, atol=1e-9), name
    assert np.allclose(found.p, p, rtol=0, atol=1e-12)
    assert np.allclose(found.redundant, redundant, rtol=0, atol=1e-12)
    broken, status = robot.passive_joints_of_theta(np.full_like(theta, np.nan), **near, status=True)
    assert status == krhpr.Status.INVALID_INPUT and all(np.isnan(value).all() for value in broken)


@pytest.mark.parametrize("identifier", ["spatial_r_fivebar_a", "planar_rr_a", "spatial_r_fivebar_b"])
def test_passive_joints_say_what_forward_says(identifier: str, backend: str) -> None:
    """The status of a sequence is that of the step that failed, not what the next ones make of its NaN."""
    robot = krhpr.load(identifier, backend=backend)
    theta = np.random.default_rng(15).uniform(-3, 3, (500, *robot.inverse(*robot.home).shape))
    choices: list[dict[str, Any]] = [{"side": 0.0}]  # neither side of type II
    if len(robot.box):
        choices = [{}, {"box": np.radians([[140, 141]] * 3)}, {"box": np.radians([[-180, 180]] * 3)}]
    for choice in choices:
        _, wanted = robot.forward(theta, **choice, status=True)
        found, status = robot.passive_joints_of_theta(theta, **choice, status=True)
        failed = wanted != 0
        assert failed.any() and np.array_equal(status[failed], wanted[failed])
        assert krhpr.Status.INVALID_INPUT not in status
        assert np.isnan(found.p[failed]).all() and np.isnan(found.platform_joint[failed]).all()


# -- sub-legs -----------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "identifier", [f"{leg}_a" for leg in ("spatial_cpr3", "spatial_ups3", "planar_prr2")]
)
def test_every_assembly_mode_of_a_sub_leg(identifier: str, backend: str) -> None:
    robot = krhpr.load(identifier, backend=backend)
    p, Q, redundant = random_poses(robot, 2000, seed=12)
    s = robot.end_points(p, Q, redundant)
    theta, reached = robot.inverse(p, Q, redundant, status=True)
    found, status = robot.subleg_forward_all(theta, status=True)
    ok = reached == 0
    assert (status[ok] == 0).all()
    every = found.s if identifier == "spatial_cpr3_a" else found
    gap = np.abs(every - s[:, :, None]).max(axis=-1)
    assert np.nanmin(gap[ok], axis=-1).max() < 1e-8
    # each one of them has these joints
    modes = every.shape[2]
    for mode in range(modes):
        there = np.isfinite(every[:, :, mode]).all(axis=(1, 2)) & ok
        if not there.any():
            continue
        back = robot.subleg_inverse(every[there, :, mode])
        turn = np.abs(back - theta[there][:, :, None, :])
        assert turn.max(axis=-1).min(axis=-1).max() < 1e-8
    if identifier == "spatial_cpr3_a":
        assert set(np.unique(found.count[ok])) >= {2.0, 4.0} and (found.doubtful[ok] == 0).mean() > 0.999
        lower, upper = found.volume[..., :-1], found.volume[..., 1:]
        assert (lower < upper)[np.isfinite(upper)].all()


@pytest.mark.parametrize("identifier", ["spatial_delta_a", "spatial_ups3_b"])
def test_a_point_between_both_assembly_modes(identifier: str, backend: str) -> None:
    """It chooses neither by its side, and one of them is given all the same."""
    robot = krhpr.load(identifier, backend=backend)
    theta = robot.inverse(*robot.home)
    both = robot.subleg_forward_all(theta)
    shifts = np.random.default_rng(16).uniform(-1, 1, (200, 1, 3)) * (0, 0, 1e-17)
    found, status = robot.subleg_forward(theta, near=both.mean(axis=1) + shifts, status=True)
    assert (status == 0).all()
    assert np.abs(found[..., None, :] - both).max(axis=-1).min(axis=-1).max() < 1e-12


def test_axes_that_meet_leave_assembly_modes_in_doubt(backend: str) -> None:
    """Normal to one another and through one point: two modes each share their angle about axis 1."""
    robot = krhpr.load("spatial_cpr3_a", backend=backend)
    zero = {f"{axis}_{n}": 0.0 for axis in "xyz" for n in (1, 2, 3)}
    robot = robot.with_geometry(**zero)
    s = robot.end_points(*robot.home)
    theta = robot.inverse(*robot.home)
    found, status = robot.subleg_forward_all(theta, status=True)
    assert status in (0, krhpr.Status.UNREACHABLE_LEG_1) and (found.doubtful == 1).all()
    assert np.allclose(robot.subleg_forward(theta, near=s + 1e-3), s, rtol=0, atol=1e-9)


# -- the thesis' nine unknowns ------------------------------------------------------------------------------


def test_the_nine_equations_of_the_thesis(backend: str) -> None:
    """(3.7) to (3.9), written apart from the derivation, converge to the same pose, from as near."""
    from benchmarks.forward import nine_step, planar_step
    from benchmarks.samples import NumpyOps

    robot = krhpr.load("spatial_rrr_a", backend=backend)
    p, Q, redundant = random_poses(robot, 300, seed=13)
    redundant = np.clip(redundant, np.radians(50), np.radians(130))
    s = robot.end_points(p, Q, redundant)
    rng = np.random.default_rng(14)
    p_near, Q_near = p + 1e-3 * rng.normal(size=p.shape), turned(robot, Q, 0.01 * rng.normal(size=(300, 3)))
    found = robot.forward_newton(s, p_near, Q_near)
    for step in (nine_step, planar_step):
        at = [list(x.reshape(300, -1).T) for x in (s, p_near, Q_near)]
        for _ in range(8):
            at[1:] = [list(x) for x in step(NumpyOps, *at)]
        assert np.abs(np.stack(at[1], axis=-1) - found.p).max() < 1e-12
        assert np.abs(np.stack(at[2], axis=-1).reshape(300, 3, 3) - found.Q).max() < 1e-12
