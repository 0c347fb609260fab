"""Statics against Newton's laws for every body, and what each view is good for."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import krhpr
from krhpr import GraspingRobot, Status
from tests.freebody import GROUND, Array, Assembly, Joint
from tests.grasping.support import ROBOTS, configurations, cross, different, rotation


def balance(
    robot: GraspingRobot, pivot: Array, s: Array, theta: Array, loads: list[tuple[str, Array, Array]]
) -> Array:
    """The motors' forces, (2, 2), by the equilibrium of every slider, link and jaw."""
    build = Assembly(2)
    turn = build.turning()
    g = robot.geometry
    for leg, jaw in enumerate(("right", "left")):
        for n in (1, 2):
            base = np.array([getattr(g, f"x_{n}")[leg], getattr(g, f"y_{n}")[leg]])
            link = f"link {n} {jaw}"
            if "prr" in robot.identifier:
                slide = getattr(g, f"slide_{n}")[leg]
                along = np.array([np.cos(slide), np.sin(slide)])
                at = base + theta[leg, n - 1] * along
                assert abs(np.linalg.norm(s[leg] - at) - getattr(g, f"l_{n}")[leg]) < 1e-12
                build.joints.append(Joint(GROUND, f"slider {link}", at, (), build.sliding(along)))
                build.joints.append(Joint(f"slider {link}", link, at, (turn,)))
            else:
                along = (s[leg] - base) / theta[leg, n - 1]
                assert abs(np.linalg.norm(along) - 1) < 1e-12
                build.joints.append(Joint(GROUND, f"cylinder {link}", base, (turn,)))
                build.joints.append(Joint(f"cylinder {link}", link, base, (), build.sliding(along)))
            build.joints.append(Joint(link, jaw, s[leg], (turn,)))
    build.joints.append(Joint("right", "left", pivot, (turn,)))
    build.loads = loads
    return build.solve()[0].reshape(2, 2)


def force(at: Array, vector: Array) -> tuple[Array, Array]:
    return at, np.array([*vector, 0.0])


@pytest.mark.parametrize("name", ROBOTS)
def test_an_object_between_the_jaws(name: str) -> None:
    """What jaws apply to an object comes back on them; the non-redundant view says what the motors give."""
    robot = different(name)
    rng = np.random.default_rng(5)
    for pivot, angles, s, theta in zip(*configurations(robot, 6), strict=True):
        contacts = np.array([[0.01, -0.03], [0.005, 0.04]]) + rng.uniform(-0.01, 0.01, (2, 2))
        faces = np.array([2.4, -2.3])
        held, status = robot.grasp(
            angles,
            contacts,
            faces,
            2.0,
            "ro",
            weight=rng.uniform(-0.2, 0.2, 2),
            mass_centre=[0.01, -0.05],
            friction=100.0,
            status=True,
        )
        assert status == Status.OK
        loads = []
        for jaw, body in enumerate(("right", "left")):
            turned = rotation(angles[jaw])
            normal = turned @ [np.cos(faces[jaw]), np.sin(faces[jaw])]
            f = held.contact_forces[jaw] @ np.array([normal, [-normal[1], normal[0]]])
            loads.append((body, *force(pivot + turned @ contacts[jaw], -f)))
        found = robot.inverse_statics_n(pivot, s, theta, held.loads)
        wanted = balance(robot, pivot, s, theta, loads)
        assert np.abs(found - wanted).max() < 1e-12 * max(1.0, np.abs(wanted).max())


@pytest.mark.parametrize("name", ROBOTS)
def test_loads_on_each_jaw(name: str) -> None:
    """Any force anywhere on either jaw, and any moment."""
    robot = different(name)
    rng = np.random.default_rng(6)
    for pivot, _, s, theta in zip(*configurations(robot, 6), strict=True):
        at = pivot + rng.uniform(-0.1, 0.1, (2, 2))
        f, m = rng.uniform(-3, 3, (2, 2)), rng.uniform(-0.1, 0.1, 2)
        loads = [(body, at[jaw], -np.array([*f[jaw], m[jaw]])) for jaw, body in enumerate(("right", "left"))]
        given = [*f.sum(axis=0), *(cross(at - pivot, f) + m)]
        found = robot.inverse_statics_n(pivot, s, theta, given)
        wanted = balance(robot, pivot, s, theta, loads)
        assert np.abs(found - wanted).max() < 1e-12 * np.abs(wanted).max()
        back = robot.forward_statics(pivot, s, theta, found)
        assert np.abs(back.loads - given).max() < 1e-12

        # the right jaw alone, with the moment about P
        wrench = [*f[0], cross(at[0] - s[0], f[0]) + m[0]]
        found = robot.inverse_statics_k(pivot, s, theta, wrench)
        wanted = balance(robot, pivot, s, theta, loads[:1])
        assert np.abs(found - wanted).max() < 1e-12 * np.abs(wanted).max()


@pytest.mark.parametrize("name", ROBOTS)
def test_the_kinematically_redundant_view_is_wrong_for_a_loaded_left_jaw(name: str) -> None:
    """A weightless grasp has no wrench at all, so that (5.12) gives nothing; the motors have to hold it."""
    robot = different(name)
    pivot, _, s, theta = (values[0] for values in configurations(robot, 1))
    grip = robot.inverse_statics_n(pivot, s, theta, [0.0, 0.0, 0.1, -0.1])
    assert np.abs(grip).max() > 0.5
    back = robot.forward_statics(pivot, s, theta, grip)
    assert np.abs(back.wrench).max() < 1e-14
    assert np.abs(robot.inverse_statics_k(pivot, s, theta, back.wrench)).max() < 1e-12


@pytest.mark.parametrize("name", ROBOTS)
def test_one_body(name: str) -> None:
    """f = U^I F + lambda k: (5.24) holds for loads on both jaws, and one number fixes the internal force."""
    robot = different(name)
    rng = np.random.default_rng(7)
    for pivot, _, s, theta in zip(*configurations(robot, 6), strict=True):
        J, K = robot.jacobians_r(s, theta)
        U = np.linalg.solve(K, J).T
        forces = rng.uniform(-2, 2, (2, 2))
        wrench = robot.forward_statics(pivot, s, theta, forces).wrench
        assert np.abs(U @ forces.ravel() - wrench).max() < 1e-13
        found = robot.inverse_statics_r(s, theta, wrench)
        assert np.abs(found.least_forces.ravel() - np.linalg.pinv(U) @ wrench).max() < 1e-12
        null = found.null_space.ravel()
        assert np.abs(U @ null).max() < 1e-13
        internal = (forces - found.least_forces).ravel() @ null / (null @ null)
        again = robot.inverse_statics_r(s, theta, wrench, internal)
        assert np.abs(again.actuator_forces - forces).max() < 1e-12
        # the null space is a pair of forces along PS: P and S are pulled together with one newton
        c = (s[1] - s[0]) / np.linalg.norm(s[1] - s[0])
        pair = [*(c - c), cross(s[0] - pivot, c), cross(s[1] - pivot, -c)]
        assert np.abs(robot.inverse_statics_n(pivot, s, theta, pair).ravel() - null).max() < 1e-12


@pytest.mark.parametrize("name", ROBOTS)
@pytest.mark.parametrize("backend", ["numpy", "compiled"])
def test_where_there_is_no_answer(name: str, backend: str) -> None:
    robot = krhpr.load_grasping(name, backend=backend).with_geometry(l_j=(0.04, 0.05))
    pivot, angles = np.array([0.0, 0.09]), np.array([0.6, 0.6])
    s, theta = robot.end_points(pivot, angles), robot.inverse(pivot, angles)
    for views in (
        robot.inverse_statics_n(pivot, s, theta, [1.0, 0.0, 0.0, 0.0], status=True),
        robot.inverse_statics_k(pivot, s, theta, [1.0, 0.0, 0.0], status=True),
        robot.twist(pivot, s, theta, np.ones((2, 2)), status=True),
    ):
        answer, status = views
        assert status == Status.SINGULAR_IN_PLANE
        assert np.isnan(np.concatenate([np.ravel(part) for part in answer])).all()
    # with aligned jaws the pair of forces along PS is still there
    found, status = robot.inverse_statics_r(s, theta, [1.0, -2.0, 0.01], 1.5, status=True)
    assert status == Status.OK
    back = robot.forward_statics(pivot, s, theta, found.actuator_forces)
    assert np.abs(back.wrench - [1.0, -2.0, 0.01]).max() < 1e-12
    assert abs(robot.singularity(pivot, s, theta).sine) < 1e-15

    # P and S in one place
    both = robot.with_geometry(l_j=0.04)
    s = both.end_points(pivot, angles)
    theta = both.inverse(pivot, angles)
    found, status = both.inverse_statics_r(s, theta, [1.0, -2.0, 0.01], status=True)
    assert status == Status.SINGULAR_IN_PLANE
    assert np.isnan(found.least_forces).all()

    # the chains of the left sub-leg in line: it bears nothing across
    aligned = theta.copy()
    s = robot.end_points(pivot, [0.8, 2.3])
    aligned[:] = robot.inverse(pivot, [0.8, 2.3])
    if name.endswith("rpr"):
        robot = robot.with_geometry(
            x_1=(-0.15, s[1, 0] - 0.1), y_1=0.0, x_2=(0.06, s[1, 0] + 0.1), y_2=(0.0, 2 * s[1, 1])
        )
        aligned[:] = robot.inverse(pivot, [0.8, 2.3])
    else:
        aligned[1] = s[1, 0] - np.sqrt(0.12**2 - s[1, 1] ** 2)
    answer, status = robot.inverse_statics_n(pivot, s, aligned, [1.0, 0.0, 0.0, 0.0], status=True)
    assert status == Status.SINGULAR_LEG_2
    assert np.isnan(answer).all()
    (J, K), status = robot.jacobians_k(pivot, s, aligned, status=True)
    assert status == Status.SINGULAR_LEG_2
    assert np.isfinite(J).all() and np.isnan(K).all()
    assert np.isfinite(robot.jacobians_n(pivot, s, aligned)[1]).all()


def test_type_1() -> None:
    """A slider under its joint cannot move it: its force does nothing along the slide."""
    robot = krhpr.load_grasping(backend="compiled")
    s = np.array([[-0.03, 0.12], [0.03, 0.06]])  # P at the end of a vertical link
    theta = np.array([[-0.03, -0.03 + np.sqrt(0.12**2 - 0.12**2)], [-0.0739, 0.1339]])
    theta[0, 1] = theta[0, 0]
    pivot = np.array([0.0, 0.1])
    answer, status = robot.forward_statics(pivot, s, theta, np.ones((2, 2)), status=True)
    assert status == Status.SINGULAR_LEG_1
    assert np.isnan(answer.loads).all()
    assert np.abs(robot.singularity(pivot, s, theta).type_1[0]).max() == 0


def grip(**more: Any) -> Any:
    """The prototype's object, in metres."""
    robot = krhpr.load_grasping(backend=more.pop("backend", "numpy"))
    right, left = rotation(-np.pi / 4), rotation(-3 * np.pi / 4)
    d = more.pop("width", 0.0427)
    contacts = [right @ [d / 2, 0.0425], left @ [-d / 2, 0.0425]]
    given: dict[str, Any] = {
        "weight": [0.0, -0.3],
        "mass_centre": right @ [0.0, 0.0425],
        "friction": 0.5,
        "status": True,
        "measured": "lo",
        "force": 2.0,
    } | more
    measured, value = given.pop("measured"), given.pop("force")
    return robot.grasp(robot.home.angles, contacts, [0.75 * np.pi, -0.75 * np.pi], value, measured, **given)


@pytest.mark.parametrize("backend", ["numpy", "compiled"])
def test_what_does_not_hold_an_object(backend: str) -> None:
    held, status = grip(backend=backend)
    assert status == Status.OK
    assert (held.friction_margins > 0).all()

    held, status = grip(backend=backend, friction=0.05)
    assert status == Status.SLIPS
    assert (held.friction_margins < 0).all() and np.isfinite(held.contact_forces).all()
    assert np.isnan(held.loads).all()

    held, status = grip(backend=backend, force=-2.0)
    assert status == Status.NO_GRASP
    assert (held.contact_forces[:, 0] < 0).all() and np.isnan(held.loads).all()

    for broken in ({"width": 0.0}, {"measured": "lp", "force": 0.1}, {"measured": "rp", "force": 0.1}):
        held, status = grip(backend=backend, **broken)
        assert status == Status.UNDETERMINED
        assert np.isnan(held.contact_forces).all() and np.isnan(held.loads).all()
        assert abs(held.determinant) < 1e-15

    # jaws that close beyond one another: contacts on the wrong sides
    held, status = grip(backend=backend, width=-0.01)
    assert status == Status.NO_GRASP and np.isnan(held.loads).all()
    assert np.abs(held.widths + 0.01).max() < 1e-15
    assert np.abs(grip(backend=backend)[0].widths - 0.0427).max() < 1e-15

    held, status = grip(backend=backend, force=np.nan)
    assert status == Status.INVALID_INPUT
    with pytest.raises(krhpr.NoGrasp, match="no width"):
        grip(backend=backend, width=0.0, check=True)
    with pytest.raises(krhpr.NoGrasp, match="pull"):
        grip(backend=backend, force=-2.0, check=True)
    with pytest.raises(ValueError, match="'ro', 'rp', 'lo', 'lp'"):
        grip(measured="left")


def test_measured_force() -> None:
    """(5.70), with phi wrapped: the jaw from which the weight pulls the object away presses less."""
    full = 2 * np.pi
    phi = np.array([0.0, -2.3, 0.78, 0.79, 1.5, 3.1, -3.1, -2.4, np.pi / 4, -3 * np.pi / 4])
    wanted = ["lo", "lo", "lo", "ro", "ro", "ro", "ro", "ro", "lo", "lo"]
    for turns in (-2, -1, 0, 1, 3):
        assert krhpr.measured_force(phi + turns * full).tolist() == wanted
    robot = krhpr.load_grasping(backend="numpy")
    right, left = rotation(-np.pi / 4), rotation(-3 * np.pi / 4)
    for angle in np.linspace(-3.1, 3.1, 40):
        held = robot.grasp(
            [angle, angle + np.pi / 2],
            [right @ [0.02135, 0.0425], left @ [-0.02135, 0.0425]],
            [0.75 * np.pi, -0.75 * np.pi],
            2.0,
            krhpr.measured_force(angle),
            weight=[0.0, -0.3],
            mass_centre=right @ [0.0, 0.0425],
        )
        chosen = int(krhpr.measured_force(angle) == krhpr.Force.LEFT_NORMAL)
        assert held.contact_forces[chosen, 0] == held.contact_forces[:, 0].min()
        assert held.pulls[chosen] == held.pulls.max()
