"""Statics: against Newton's laws for every body, against the reference, and what users are told."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
import pytest

import krhpr
from krhpr import Robot, Status
from tests.freebody import GROUND, Array, Assembly, Joint
from tests.robot.support import configuration
from tests.support import ROOT

GRASPS = json.loads((ROOT / "tests" / "reference" / "grasp_spatial.json").read_text(encoding="utf-8"))[
    "cases"
]


def unit(v: Array) -> Array:
    return v / np.linalg.norm(v)


def planar_leg(build: Assembly, robot: Robot, leg: int, at: dict[str, Array]) -> None:
    """The bodies of one planar sub-leg, from the base to r_i."""
    turn = build.turning()
    name = robot.identifier

    def revolute(inner: str, outer: str, point: str, *, motor: bool = False) -> None:
        bodies = [body if body == GROUND else f"{body} {leg}" for body in (inner, outer)]
        build.joints.append(Joint(*bodies, at[point], () if motor else (turn,), turn if motor else None))

    if name.startswith("planar_rr_"):
        revolute(GROUND, "proximal", "A", motor=True)
        revolute("proximal", "last", "E", motor=True)
    elif name.startswith("planar_pr_"):
        azimuth = robot.geometry.azimuth[leg] + robot.geometry.slide[leg]
        along = build.sliding(np.array([np.cos(azimuth), np.sin(azimuth)]))
        build.joints.append(Joint(GROUND, f"slider {leg}", at["D"], (), along))
        revolute("slider", "last", "D", motor=True)
    else:  # five-bar: the bars from both cranks meet in r_i
        revolute(GROUND, "proximal", "A", motor=True)
        revolute(GROUND, "crank", "A_2", motor=True)
        revolute("proximal", "last", "E")
        revolute("crank", "rod", "C")
        revolute("last", "rod", "S")


def spatial_leg(build: Assembly, robot: Robot, leg: int, at: dict[str, Array], theta: Array) -> None:
    """The bodies of one spatial sub-leg with a first axis, from the base to S_i."""
    azimuth, alpha = robot.geometry.azimuth[leg], robot.geometry.alpha[leg]
    e_r = np.array([np.cos(azimuth), np.sin(azimuth), 0.0])
    e_t = np.array([-np.sin(azimuth), np.cos(azimuth), 0.0])
    e_1 = -np.cos(alpha) * e_r + np.sin(alpha) * np.array([0.0, 0.0, 1.0])
    e_2 = np.cos(theta[0]) * e_t + np.sin(theta[0]) * np.cross(e_1, e_t)
    first, axis = build.turning(e_1), build.turning(e_2)
    place = f"{{}} {leg}".format
    build.joints.append(Joint(GROUND, place("carrier"), at["c"], (), first))
    if robot.identifier.startswith("spatial_rrr_"):
        build.joints.append(Joint(place("carrier"), place("upper"), at["c"], (), axis))
        build.joints.append(Joint(place("upper"), place("last"), at["E"], (), axis))
        return
    # R(RR-RRR): two cranks on one axis, the rod, and the distal link through P to S_i
    build.joints.append(Joint(place("carrier"), place("upper"), at["c"], (), axis))
    build.joints.append(Joint(place("carrier"), place("crank"), at["c"], (), axis))
    build.joints.append(Joint(place("upper"), place("last"), at["E"], (axis,)))
    build.joints.append(Joint(place("crank"), place("rod"), at["C"], (axis,)))
    build.joints.append(Joint(place("rod"), place("last"), at["P"], (axis,)))


def bodies(robot: Robot, p: Array, Q: Array, s: Array, theta: Array) -> tuple[Assembly, list[Array]]:
    """The robot without loads, and of each redundant joint the wrench that does work on its motion."""
    d, motions = 2 if robot.planar else 3, []
    build = Assembly(d)
    points, attachment = robot.link_points(p, Q, s, theta)
    names = robot.signature("link_points").outputs[0].labels
    frame = np.array([[np.cos(Q), -np.sin(Q)], [np.sin(Q), np.cos(Q)]]) if robot.planar else Q
    revolute = robot.documentation["redundant"][0][0] == "beta"
    for leg in range(3):
        at = dict(zip(names, points[leg], strict=True))
        if robot.planar:
            planar_leg(build, robot, leg, at)
            ball, turn = (build.turning(),), -build.turning()  # beta is clockwise
        else:
            spatial_leg(build, robot, leg, at, theta[leg])
            ball, turn = tuple(build.turning(axis) for axis in np.eye(3)), -build.turning(Q[:, 2])
        build.joints.append(Joint(f"last {leg}", f"redundant {leg}", s[leg], ball))
        azimuth = robot.geometry.platform_azimuth[leg]
        if robot.identifier.endswith("_b") and not robot.planar:
            azimuth += np.pi / 2
        slide = frame[:, :2] @ np.array([np.cos(azimuth), np.sin(azimuth)])
        # the redundant joint moves the redundant link on the platform
        motion = turn if revolute else build.sliding(slide)
        build.joints.append(Joint("platform", f"redundant {leg}", attachment[leg], (motion,)))
        motions.append(motion)
    return build, motions


def free_body(
    robot: Robot, p: Array, Q: Array, s: Array, theta: Array, wrench: Array, forces: Array
) -> Array:
    """Forces of the actuators (3, n) by the equilibrium of every body."""
    build, motions = bodies(robot, p, Q, s, theta)
    _, attachment = robot.link_points(p, Q, s, theta)
    for leg, motion in enumerate(motions):
        # the robot applies `forces` there: what it holds pushes the link and the platform apart
        build.loads.append((f"redundant {leg}", attachment[leg], -forces[leg] * motion))
        build.loads.append(("platform", attachment[leg], forces[leg] * motion))
    build.loads.append(("platform", p, -wrench))
    motors, _ = build.solve()
    return motors.reshape(3, -1)


BODIES = (
    "planar_rr_a",
    "planar_pr_c",
    "planar_fivebar_a",
    "planar_fivebar_b",
    "spatial_rrr_a",
    "spatial_rrr_b",
    "spatial_rrr_c",
    "spatial_r_fivebar_c",
)


@pytest.mark.parametrize("identifier", BODIES)
def test_every_body_is_in_equilibrium(identifier: str) -> None:
    """Unequal legs in a random pose; the wrench, and what the redundant coordinates hold."""
    robot = krhpr.load(identifier, backend="numpy")
    random = np.random.default_rng(len(identifier))
    for seed in range(3):
        if robot.planar:
            _, _, redundant = robot.home
            p, Q = 0.02 * random.normal(size=2), np.float64(0.1 * random.normal())
            redundant = np.array(redundant) * random.uniform(0.9, 1.1, 3)
            s = robot.end_points(p, Q, redundant)
            theta = robot.inverse(p, Q, redundant, check=True)
        else:
            p, Q, s, theta = configuration(robot, seed=seed)
        wrench, forces = random.normal(size=3 if robot.planar else 6), random.normal(size=3)
        wanted = free_body(robot, p, Q, s, theta, wrench, forces)
        got = robot.inverse_statics(p, Q, s, theta, wrench, forces, check=True)
        np.testing.assert_allclose(got, wanted, rtol=0, atol=1e-12 * np.abs(wanted).max())


def in_millimetres(case: dict[str, Any]) -> tuple[Robot, Array, Array, Array]:
    """The 3-[R(RR-RRR)SP] robot of a reference grasp, its pose and slides."""
    robot = krhpr.load("spatial_r_fivebar_c", backend="numpy")
    p, Q, d = (np.array(case[name]) for name in ("p", "Q", "d"))
    azimuth = np.radians(case["az_platform_deg"])
    lengths = {
        name: 1000.0 * np.asarray(value)
        for name, value in robot.geometry.fields.items()
        if dict(robot.documentation["units"])[name] == "m"
    }
    robot = robot.with_geometry(platform_azimuth=azimuth, **lengths)
    return robot, p, Q, d


@pytest.mark.parametrize("case", GRASPS, ids=lambda case: f"d={case['d']}")
def test_the_reference_grasps(case: dict[str, Any]) -> None:
    """Torques (5.44) from the equilibrium of three jaws, platform and legs."""
    robot, p, Q, d = in_millimetres(case)
    s = robot.end_points(p, Q, d)
    np.testing.assert_allclose(s, case["spheres"], rtol=0, atol=1e-9)
    theta = np.reshape(case["theta"], (3, 3))
    applied, torques = np.array(case["F_sn"]), np.reshape(case["tau_Nmm"], (3, 3))
    got = robot.inverse_statics(p, Q, s, theta, applied[:6], applied[6:])
    np.testing.assert_allclose(got, torques, rtol=0, atol=1e-11 * np.abs(torques).max())
    wrench, along = robot.forward_statics(p, Q, s, theta, torques)
    np.testing.assert_allclose([*wrench, *along], applied, rtol=0, atol=1e-10 * np.abs(applied).max())


@pytest.mark.parametrize("case", GRASPS, ids=lambda case: f"d={case['d']}")
def test_the_reference_objects(case: dict[str, Any]) -> None:
    """Forces of the jaws from the object's equilibrium, and the generalised force (5.62) corrected."""
    robot, _, Q, _ = in_millimetres(case)
    contacts, centre = np.array(case["w"]) @ Q, np.array(case["com_rel_O"]) @ Q
    result = robot.grasp(Q, contacts, case["f_x"], case["weight"], centre, friction=1e3, check=True)
    wanted, applied = np.array(case["f_jaw_frame"]), np.array(case["F_sn"])
    np.testing.assert_allclose(result.contact_forces, wanted, rtol=0, atol=1e-12 * np.abs(wanted).max())
    got = [*result.wrench, *result.redundant_forces]
    np.testing.assert_allclose(got, applied, rtol=0, atol=1e-12 * np.abs(applied).max())


@pytest.mark.parametrize("backend", ["numpy", "compiled"])
def test_a_grasp_that_does_not_hold_says_why(backend: str) -> None:
    robot = krhpr.load("spatial_rrr_c", backend=backend)
    slides = robot.end_points(np.zeros(3), np.eye(3), np.ones(3))
    contacts, load = 0.03 * slides, [0.0, 0.0, -3.0]
    held = robot.grasp(np.eye(3), contacts, 5.0, load, friction=0.5, check=True)
    np.testing.assert_allclose(held.contact_forces, [[5.0, 0.0, 1.0]] * 3, rtol=0, atol=1e-14)
    np.testing.assert_allclose(held.friction_margins, 2.5**2 - 1.0, rtol=0, atol=1e-13)
    np.testing.assert_allclose(held.wrench, [0.0, 0.0, 3.0, 0.0, 0.0, 0.0], rtol=0, atol=1e-14)

    def refused(status: Status, forces: Any = 5.0, at: Array = contacts, friction: float = 0.5) -> Any:
        result, code = robot.grasp(np.eye(3), at, forces, load, friction=friction, status=True)
        assert code == status and np.isnan(result.wrench).all()
        with pytest.raises(krhpr.NoGrasp):
            robot.grasp(np.eye(3), at, forces, load, friction=friction, check=True)
        return result

    slipping = refused(Status.SLIPS, friction=0.19)
    np.testing.assert_allclose(slipping.friction_margins, 0.95**2 - 1.0, rtol=0, atol=1e-13)
    refused(Status.NO_GRASP, [5.0, -0.1, 5.0])
    line = np.array([[0.03, 0.01, 0.0], [-0.02, 0.01, 0.0], [0.01, 0.01, 0.0]])
    refused(Status.UNDETERMINED, at=line)
    about = 0.03 * np.stack([slides[:, 1], -slides[:, 0], slides[:, 2]], axis=-1)  # faces through one point
    refused(Status.UNDETERMINED, at=about)
    refused(Status.UNDETERMINED, at=np.zeros((3, 3)))


def test_what_the_redundant_coordinates_hold_is_the_null_space() -> None:
    """(5.25): with the redundant joints blocked, forces along them add nothing to the wrench."""
    robot = krhpr.load("spatial_rrr_c", backend="numpy")
    p, Q, s, theta = configuration(robot)
    J, K = robot.jacobians(p, Q, s, theta)
    C = (s - p) / np.linalg.norm(s - p, axis=1)[:, None]
    M = robot.subleg_jacobian(s, theta)
    J_r = np.vstack([J, np.hstack([C, np.cross(s - p, C)])])
    K_r = np.vstack(
        [
            K,
            [
                np.concatenate([c @ m if k == i else 0 * (c @ m) for k, m in enumerate(M)])
                for i, c in enumerate(C)
            ],
        ]
    )
    U = J_r.T @ np.linalg.inv(K_r).T
    for along in np.eye(3):
        f = robot.inverse_statics(p, Q, s, theta, np.zeros(6), along).ravel()
        assert np.abs(U @ f).max() < 1e-12 * np.abs(f).max()
    f = robot.inverse_statics(p, Q, s, theta, [1.0, 2.0, 3.0, 0.1, 0.2, 0.3], [1.0, -2.0, 3.0]).ravel()
    np.testing.assert_allclose(U @ f, [1.0, 2.0, 3.0, 0.1, 0.2, 0.3], rtol=0, atol=1e-11)


@pytest.mark.parametrize("identifier", ["planar_rr_b", "spatial_rrr_b", "planar_pp_c", "spatial_delta_c"])
def test_jaws_touch_a_round_object(identifier: str) -> None:
    """Distances in the platform frame from where the end points are, and a grip without friction."""
    robot = krhpr.load(identifier, backend="numpy")
    p, Q, _ = robot.home
    centre, jaws = np.array([0.004, -0.003]), np.array([0.01, 0.02, 0.03])
    d = robot.redundant_of_opening(0.12, centre, jaws)
    ends = robot.end_points(p, Q, d) - p
    slides = robot.end_points(p, Q, d + 1.0) - p - ends
    faces = (ends - jaws[:, None] * slides)[:, :2] - centre
    np.testing.assert_allclose(np.sum(faces * slides[:, :2], axis=1), 0.06, rtol=0, atol=1e-15)
    opening, middle, shares = robot.opening(d, jaws)
    assert opening == pytest.approx(0.12, abs=1e-15) and np.allclose(middle, centre, atol=1e-15)
    # every jaw presses with its share of 3 N: the platform bears nothing but what the centre's offset asks
    s, force = robot.end_points(p, Q, d), 3.0 * shares
    theta = robot.inverse(p, Q, d)
    around = sum(f * (centre[0] * -t[1] - centre[1] * -t[0]) for f, t in zip(force, slides, strict=True))
    assert abs(around) < 1e-15
    f = robot.inverse_statics(p, Q, s, theta, np.zeros(3 if robot.planar else 6), -force)
    wrench, along = robot.forward_statics(p, Q, s, theta, f)
    assert np.abs(wrench).max() < 1e-13
    np.testing.assert_allclose(along, -force, rtol=0, atol=1e-13)


def test_jaws_on_one_side_hold_nothing() -> None:
    robot = krhpr.load("planar_rr_c", backend="numpy").with_geometry(platform_azimuth=[0.0, 1.0, 2.0])
    result, status = robot.opening([0.1, 0.1, 0.1], status=True)
    assert status == Status.NO_GRASP and np.isnan(result.opening) and np.isnan(result.centre).all()
    assert result.shares.min() < 0
    with pytest.raises(krhpr.NoGrasp, match="positively span"):
        robot.opening([0.1, 0.1, 0.1], check=True)


def test_singular_configurations_have_a_status() -> None:
    robot = krhpr.load("planar_rr_a", backend="numpy")
    p, phi = np.zeros(2), 0.0
    beta = np.full(3, np.pi)  # links through O'
    s = robot.end_points(p, phi, beta)
    theta = robot.inverse(p, phi, beta)
    forces, status = robot.inverse_statics(p, phi, s, theta, np.ones(3), status=True)
    assert status == Status.SINGULAR_IN_PLANE and np.isnan(forces).all()
    straight = np.array(robot.inverse(*robot.home))
    straight[1, 1] = 0.0
    s = robot.subleg_forward(straight)
    result, status = robot.forward_statics(p, phi, s, straight, np.ones((3, 2)), status=True)
    assert status == Status.SINGULAR_LEG_2
    assert np.isnan(result.wrench).all() and list(np.isnan(result.redundant_forces)) == [False, True, False]
