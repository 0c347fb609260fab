"""Grasp capability against Newton's laws and brute force, by its duality, and what users are told.

What contacts and actuators can do is assembled here again, from the equilibrium of every body, and the linear
programmes are solved by looking at every corner, by samples, or with the cones as they are.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from itertools import combinations
from typing import Any

import numpy as np
import pytest
from scipy.linalg import null_space
from scipy.optimize import minimize
from scipy.spatial.transform import Rotation

import krhpr
from krhpr import Status
from krhpr.capability import LimitKind
from tests.freebody import Array
from tests.grasping.support import ROBOTS, configurations, different, rotation
from tests.grasping.test_statics import balance, force
from tests.test_statics import bodies

FACES = np.array([2.4, -2.3])
CONTACTS = np.array([[0.01, -0.03], [0.005, 0.04]])
CENTRE = np.array([0.01, -0.05])
WEIGHT = np.array([0.05, -0.3])


class Case:
    """One grip: arguments, and its limits from Newton's laws: rows @ forces <= right, balance @ forces +
    loads = 0."""

    def __init__(
        self, robot: Any, pose: tuple[Any, ...], columns: list[tuple[Array, Array, Array]], **given: Any
    ):
        self.robot, self.pose, self.given = robot, pose, given
        self.balance = np.column_stack([wrench for _, wrench, _ in columns])
        self.actuators = np.stack([motors for *_, motors in columns], -1)
        self.directions = np.array([direction for direction, *_ in columns])

    def found(self, **more: Any) -> Any:
        return krhpr.grasp_capability(self.robot, self.pose, **{**self.given, **more})


def planar(name: str, seed: int = 0) -> Case:
    """Any forces of both jaws on an object, by the equilibrium of sliders, links, jaws and the object."""
    robot = different(name)
    pivot, angles, s, theta = (values[seed] for values in configurations(robot, 4, seed=3))
    turns = [rotation(angle) for angle in angles]
    columns = []
    for jaw, body in enumerate(("right", "left")):
        normal = turns[jaw] @ [np.cos(FACES[jaw]), np.sin(FACES[jaw])]
        at = pivot + turns[jaw] @ CONTACTS[jaw]
        arm = at - pivot - turns[0] @ CENTRE
        for direction in (normal, np.array([-normal[1], normal[0]])):
            motors = balance(robot, pivot, s, theta, [(body, *force(at, -direction))])
            columns.append(
                (direction, np.array([*direction, arm[0] * direction[1] - arm[1] * direction[0]]), motors)
            )
    given = {"contacts": CONTACTS, "faces": FACES, "mass_centre": CENTRE}
    return Case(
        robot, (pivot, angles), columns, **given, actuator_limits=8.0, friction=[0.4, 0.6], weight=WEIGHT
    )


@cache
def spatial(identifier: str) -> Case:
    """Any forces of three jaws, each on the redundant link that slides."""
    robot = krhpr.load(identifier, backend="numpy")
    plane = robot.planar
    p, _, _ = robot.home
    p = np.array(p) + 0.01
    Q = np.float64(0.1) if plane else Rotation.from_rotvec([0.1, -0.15, 0.2]).as_matrix()
    frame = rotation(float(Q)) if plane else Q
    redundant = np.array([0.09, 0.1, 0.11])
    s, theta = robot.end_points(p, Q, redundant), robot.inverse(p, Q, redundant, check=True)
    slides = robot.end_points(p, Q, redundant + 1.0) - s
    d = 2 if plane else 3
    contacts = 0.03 * slides @ frame + 0.004 * np.arange(3 * d).reshape(3, d) / d - 0.005
    centre = np.full(d, 0.002)
    columns = []
    for leg, slide in enumerate(slides):
        axes = (
            [-slide, np.array([slide[1], -slide[0]])]
            if plane
            else [-slide, np.cross(frame[:, 2], -slide), frame[:, 2]]
        )
        at = p + frame @ contacts[leg]
        for direction in axes:
            build, _ = bodies(robot, p, Q, s, theta)
            build.loads.append((f"redundant {leg}", at, np.append(-direction, np.zeros(1 if plane else 3))))
            motors = build.solve()[0].reshape(3, -1)
            arm = at - p - frame @ centre
            about = [arm[0] * direction[1] - arm[1] * direction[0]] if plane else np.cross(arm, direction)
            columns.append((direction, np.append(direction, about), motors))
    given = {
        "contacts": contacts,
        "mass_centre": centre,
        "weight": [0.3, -0.8] if plane else [0.3, 0.2, -1.0],
    }
    return Case(robot, (p, Q, redundant), columns, **given, actuator_limits=3.0, friction=[0.5, 0.6, 0.7])


def loads_of(case: Case, wrench: Any = None) -> Array:
    weight = np.asarray(case.given["weight"], dtype=float)
    loads = np.zeros(len(case.balance))
    loads[: len(weight)] = weight
    return loads if wrench is None else loads + wrench


def flat_rows(case: Case, limits: Any, friction: Any) -> tuple[Array, Array]:
    """Friction of two jaws and actuators as rows @ forces <= right."""
    rows, right = [], []
    for jaw, mu in enumerate(np.broadcast_to(friction, 2)):
        for row in ([-mu, 1.0], [-mu, -1.0], [-1.0, 0.0]):
            rows.append(np.concatenate([row if k == jaw else [0.0, 0.0] for k in range(2)]))
            right.append(0.0)
    for motor, most in zip(
        case.actuators.reshape(4, 4), np.broadcast_to(limits, (2, 2)).ravel(), strict=True
    ):
        rows += [motor, -motor]
        right += [most, most]
    return np.array(rows), np.array(right)


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("name", ROBOTS)
def test_grasping_forces_of_two_jaws(name: str, seed: int) -> None:
    """Forces that balance the loads are a line; limits cut a piece out of it."""
    case = planar(name, seed)
    rows, right = flat_rows(case, case.given["actuator_limits"], case.given["friction"])
    wrench = np.array([0.1, 0.05, 0.002])
    start = -np.linalg.lstsq(case.balance, loads_of(case, wrench), rcond=None)[0]
    along = null_space(case.balance)[:, 0]
    slope, rest = rows @ along, right - rows @ start
    low, high = (rest / slope)[slope < 0].max(), (rest / slope)[slope > 0].min()
    assert low < high
    ends = [start + place * along for place in (low, high)]
    equal = (start[2] - start[0]) / (along[0] - along[2])  # both jaws press alike there
    if low < equal < high:
        ends.append(start + equal * along)
    smallest = [min(f[0], f[2]) for f in ends]
    found = case.found(wrench=wrench)
    assert found.held and found.conflict == () and found.shortage == 0
    np.testing.assert_allclose(found.grasp_force, [min(smallest), max(smallest)], rtol=1e-8, atol=1e-10)
    for extreme in (found.least, found.most):
        f = extreme.contact_forces.ravel()
        assert min(f[0], f[2]) == pytest.approx(extreme.value, rel=1e-9)
        assert (rows @ f <= right + 1e-8).all()
        np.testing.assert_allclose(case.balance @ f, -loads_of(case, wrench), rtol=0, atol=1e-9)
        np.testing.assert_allclose(extreme.actuator_forces, case.actuators @ f, rtol=0, atol=1e-11 * 8)


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("name", ROBOTS)
def test_wrenches_that_two_jaws_resist(name: str, seed: int) -> None:
    """Every corner of the polygon of grips and factors."""
    case = planar(name, seed)
    rows, right = flat_rows(case, case.given["actuator_limits"], case.given["friction"])
    for wrench in (np.array([0.0, 0.0, 0.05]), np.array([0.3, -0.4, -0.01])):
        start = -np.linalg.lstsq(case.balance, loads_of(case), rcond=None)[0]
        along = null_space(case.balance)[:, 0]
        moved = -np.linalg.lstsq(case.balance, wrench, rcond=None)[0]
        plane, rest = np.column_stack([rows @ along, rows @ moved]), right - rows @ start
        corners = [
            corner[1]
            for pair in combinations(range(len(rows)), 2)
            if abs(np.linalg.det(plane[list(pair)])) > 1e-9
            for corner in [np.linalg.solve(plane[list(pair)], rest[list(pair)])]
            if (plane @ corner <= rest + 1e-9).all()
        ]
        found = case.found(disturbance=wrench)
        np.testing.assert_allclose(found.scale, [min(corners), max(corners)], rtol=1e-8)
        # a wrench a little smaller is held, one a little larger is not
        margin = found.scale[1]
        assert case.found(wrench=0.999 * margin * wrench).held
        beyond = case.found(wrench=1.001 * margin * wrench, disturbance=wrench)
        assert not beyond.held and np.isnan(beyond.grasp_force).all() and beyond.shortage > 0
        assert beyond.scale[1] == pytest.approx(-0.001 * margin, rel=1e-4)  # less of it would be held


SPATIAL = ("spatial_rrr_b", "spatial_r_fivebar_c")


def true_cones(case: Case, friction: Any) -> Callable[[Array], Array]:
    """What is left of friction, N: not negative where nothing slips."""
    mu = np.asarray(friction)
    return lambda f: mu * f.reshape(3, -1)[:, 0] - np.linalg.norm(f.reshape(3, -1)[:, 1:], axis=1)


@pytest.mark.parametrize("identifier", [*SPATIAL, "planar_rr_c"])
def test_forces_of_three_jaws_are_in_equilibrium(identifier: str) -> None:
    """Extremes hold the object, within the true cones, with the motors' forces from Newton's laws."""
    case = spatial(identifier)
    wrench = np.zeros(len(case.balance))
    wrench[-1] = 0.01
    found = case.found(wrench=wrench, disturbance=wrench)
    assert found.held and found.scale[0] < -1 < 1 < found.scale[1]
    for extreme, factor in ((found.least, 1.0), (found.most, 1.0), (found.strongest, 1 + found.scale[1])):
        f = extreme.contact_forces.ravel()
        rest = case.balance @ f + loads_of(case, factor * wrench)
        assert np.abs(rest).max() < 1e-8
        assert true_cones(case, case.given["friction"])(f).min() > -1e-8
        wanted = case.actuators @ f
        np.testing.assert_allclose(extreme.actuator_forces, wanted, rtol=0, atol=1e-11 * np.abs(wanted).max())
        assert np.abs(wanted).max() < 3.0 + 1e-8
    assert found.least.value == found.least.contact_forces[:, 0].min()


@pytest.mark.parametrize("identifier", SPATIAL)
def test_pyramids_lie_in_the_cones(identifier: str) -> None:
    """More facets never give less, and the cone itself lies between 64 facets and 64 around it."""
    case = spatial(identifier)
    friction = np.array(case.given["friction"])
    found = [case.found(facets=facets).grasp_force for facets in (4, 8, 16, 32, 64)]
    least, most = np.array(found).T
    assert (np.diff(least) < 1e-8).all() and (np.diff(most) > -1e-8).all()
    around = case.found(facets=64, friction=friction / np.cos(np.pi / 64)).grasp_force
    cones, start = true_cones(case, friction), case.found(facets=64).most.contact_forces.ravel()
    motors = case.actuators.reshape(-1, 9)
    exact = minimize(
        lambda x: -x[-1],
        np.append(0.98 * start, 0.98 * found[-1][1]),
        constraints=[
            {"type": "eq", "fun": lambda x: case.balance @ x[:9] + loads_of(case)},
            {"type": "ineq", "fun": lambda x: cones(x[:9])},
            {"type": "ineq", "fun": lambda x: x[:9:3] - x[-1]},
            {"type": "ineq", "fun": lambda x: np.concatenate([3.0 - motors @ x[:9], 3.0 + motors @ x[:9]])},
        ],
        method="SLSQP",
        options={"ftol": 1e-12, "maxiter": 300},
    )
    assert exact.success
    assert most[-1] - 1e-7 <= -exact.fun <= around[1] + 1e-7
    assert around[0] <= least[-1] + 1e-9


@pytest.mark.parametrize("identifier", SPATIAL)
def test_no_sample_beats_the_programme(identifier: str) -> None:
    """Random forces that balance the loads and keep all limits grasp neither harder nor less."""
    case = spatial(identifier)
    found = case.found()
    rng = np.random.default_rng(8)
    start = 0.5 * (found.least.contact_forces + found.most.contact_forces).ravel()
    inner = null_space(case.balance)
    f = start + rng.normal(size=(20000, inner.shape[1])) * rng.uniform(0, 15, (20000, 1)) @ inner.T
    jaws = f.reshape(-1, 3, 3)
    rough = np.array(case.given["friction"]) * np.cos(np.pi / 32)  # a cone inside the pyramid
    good = (np.linalg.norm(jaws[..., 1:], axis=-1) <= rough * jaws[..., 0]).all(axis=1)
    good &= (np.abs(f @ case.actuators.reshape(-1, 9).T) <= 3.0).all(axis=1)
    smallest = jaws[good, :, 0].min(axis=1)
    assert len(smallest) > 100
    assert found.grasp_force[0] <= smallest.min() and smallest.max() <= found.grasp_force[1]
    assert smallest.max() - smallest.min() > 0.5 * np.diff(found.grasp_force)[0]


CASES = [*((planar, name) for name in ROBOTS), *((spatial, name) for name in SPATIAL)]


@pytest.mark.parametrize(("make", "name"), CASES)
def test_what_stops_a_force(make: Callable[[str], Case], name: str) -> None:
    """Widening the limits that are named moves the extreme; widening all the others does not."""
    case = make(name)
    wrench = np.zeros(len(case.balance))
    wrench[-1] = 0.01
    limits = np.broadcast_to(case.given["actuator_limits"], case.actuators.shape[:2]).astype(float)
    friction = np.array(case.given["friction"])
    found = case.found(wrench=wrench, disturbance=wrench)

    def widened(names: Any, *, but: bool) -> Any:
        grown = limits.copy(), friction.copy()
        for index in np.ndindex(limits.shape):
            named = any(limit.kind is LimitKind.ACTUATOR and limit.index == index for limit in names)
            grown[0][index] *= 1.05 if named is not but else 1.0
        for contact in range(len(friction)):
            named = any(limit.kind is LimitKind.FRICTION and limit.index == (contact,) for limit in names)
            grown[1][contact] *= 1.05 if named is not but else 1.0
        return case.found(wrench=wrench, disturbance=wrench, actuator_limits=grown[0], friction=grown[1])

    for kind in ("least", "most", "strongest"):
        extreme = getattr(found, kind)
        assert extreme.stopped_by
        value = extreme.value
        same = getattr(widened(extreme.stopped_by, but=True), kind).value
        other = getattr(widened(extreme.stopped_by, but=False), kind).value
        assert same == pytest.approx(value, rel=1e-8), kind
        if any(limit.kind is not LimitKind.CONTACT for limit in extreme.stopped_by):
            assert abs(other - value) > 1e-4 * abs(value), kind


@pytest.mark.parametrize(("make", "name"), CASES)
def test_more_is_never_less(make: Callable[[str], Case], name: str) -> None:
    """Stronger actuators and rougher contacts; and all forces and limits scaled alike."""
    case = make(name)
    wrench = np.zeros(len(case.balance))
    wrench[-1] = 0.01
    before = None
    for factor in (0.3, 0.6, 1.0, 2.0, 10.0, np.inf):
        found = case.found(disturbance=wrench, actuator_limits=case.given["actuator_limits"] * factor)
        if before is not None and before.held:
            assert found.grasp_force[0] <= before.grasp_force[0] + 1e-8
            assert found.grasp_force[1] >= before.grasp_force[1] - 1e-8
            assert found.scale[0] <= before.scale[0] + 1e-8 and found.scale[1] >= before.scale[1] - 1e-8
        before = found
    assert found.grasp_force[1] == np.inf and np.isnan(found.most.contact_forces).all()
    one = case.found(disturbance=wrench)
    rougher = case.found(disturbance=wrench, friction=2 * np.array(case.given["friction"]))
    assert rougher.scale[1] >= one.scale[1] and rougher.grasp_force[0] <= one.grasp_force[0] + 1e-9
    for factor in (1e-3, 1e3):  # micronewtons and kilonewtons
        other = case.found(
            disturbance=factor * wrench,
            actuator_limits=factor * case.given["actuator_limits"],
            weight=factor * np.array(case.given["weight"]),
        )
        np.testing.assert_allclose(other.grasp_force, factor * np.array(one.grasp_force), rtol=1e-7)
        np.testing.assert_allclose(other.scale, one.scale, rtol=1e-7)
    # a wrench and its opposite, and a wrench twice as large
    back, twice = case.found(disturbance=-wrench), case.found(disturbance=2 * wrench)
    np.testing.assert_allclose(back.scale, [-one.scale[1], -one.scale[0]], rtol=1e-7)
    np.testing.assert_allclose(twice.scale, np.array(one.scale) / 2, rtol=1e-7)


@pytest.mark.parametrize(("make", "name"), CASES)
def test_what_holds_nothing_says_why(make: Callable[[str], Case], name: str) -> None:
    """Limits in conflict stay in conflict without all the others; wider by the shortage they hold."""
    case = make(name)
    limits = np.full(case.actuators.shape[:2], 0.02)
    found = case.found(actuator_limits=limits)
    assert not found.held and np.isnan(found.grasp_force).all() and found.most is None
    assert 0 < found.shortage < np.inf
    assert any(limit.kind is LimitKind.ACTUATOR for limit in found.conflict)
    alone = np.full_like(limits, np.inf)
    for limit in found.conflict:
        if limit.kind is LimitKind.ACTUATOR:
            alone[limit.index] = 0.02
    assert not case.found(actuator_limits=alone).held
    smooth = case.found(friction=0.0)  # no actuator is to blame
    assert smooth.conflict and LimitKind.ACTUATOR not in {limit.kind for limit in smooth.conflict}
    # without weight nothing has to be held, and without actuators nothing is
    nothing = case.found(weight=None, actuator_limits=0.0)
    assert nothing.held and nothing.grasp_force == pytest.approx((0.0, 0.0), abs=1e-12)


def test_forces_that_nothing_balances() -> None:
    """Three contacts in line leave a moment about their line to nobody."""
    robot = krhpr.load("spatial_rrr_c", backend="numpy")
    line = np.array([[0.03, 0.0, 0.0], [-0.02, 0.0, 0.0], [0.01, 0.0, 0.0]])
    found = krhpr.grasp_capability(
        robot,
        robot.home,
        line,
        actuator_limits=5.0,
        friction=0.5,
        wrench=[0, 0, 0, 0.1, 0, 0],
        disturbance=[0, 0, 0, 1, 0, 0],
    )
    assert not found.held and found.conflict == () and found.shortage == np.inf
    assert found.scale is not None and np.abs(np.array(found.scale) + 0.1).max() < 1e-9


@pytest.mark.parametrize("name", ROBOTS)
def test_the_object_agrees(name: str) -> None:
    """`grasp` finds the extremes' other three forces from one of them."""
    case = planar(name)
    found = case.found()
    for extreme in (found.least, found.most):
        f = extreme.contact_forces
        held, status = case.robot.grasp(
            case.pose[1],
            CONTACTS,
            FACES,
            f[1, 0],
            "lo",
            weight=WEIGHT,
            mass_centre=CENTRE,
            friction=0.7,
            status=True,
        )
        assert status == Status.OK
        np.testing.assert_allclose(held.contact_forces, f, rtol=0, atol=1e-8)
        s, theta = case.robot.end_points(*case.pose), case.robot.inverse(*case.pose)
        motors = case.robot.inverse_statics_n(case.pose[0], s, theta, held.loads)
        np.testing.assert_allclose(motors, extreme.actuator_forces, rtol=0, atol=1e-7)


def test_the_prototype() -> None:
    """Weightless at home: 2 N take 1.41755 N of the actuators, and the rest is in proportion; a moment is
    resisted with what friction there is across the object's width."""
    from krhpr.study.grasp import PROTOTYPE, contacts

    robot = PROTOTYPE.build()
    touch, faces, centre = contacts(PROTOTYPE)
    given: dict[str, Any] = {
        "faces": faces,
        "mass_centre": centre,
        "friction": 0.3,
        "actuator_limits": 1.41755,
    }
    found = krhpr.grasp_capability(robot, robot.home, touch, **given)
    assert found.grasp_force[0] == pytest.approx(0.0, abs=1e-9)
    assert found.grasp_force[1] == pytest.approx(2.0, rel=1e-5)
    assert {limit.kind for limit in found.most.stopped_by} == {LimitKind.ACTUATOR}
    given["actuator_limits"] = 1e4  # friction alone: with 2 N grasped it is 0.3 * 2 N * 42.7 mm
    strong = krhpr.grasp_capability(robot, robot.home, touch, **given, wrench=[0.0, 0.0, 0.3 * 2 * 0.0427])
    assert strong.grasp_force[0] == pytest.approx(2.0, rel=1e-6)


@pytest.mark.parametrize("make", [lambda: planar("planar_grasp_prr"), lambda: spatial("spatial_rrr_b")])
@pytest.mark.parametrize(
    ("wrong", "says"),
    [
        ({"friction": -0.1}, "friction is -0.1"),
        ({"friction": np.nan}, "not negative"),
        ({"friction": np.inf}, "infinite"),
        ({"actuator_limits": -1.0}, "actuator_limits is -1"),
        ({"actuator_limits": np.nan}, "not negative"),
        ({"actuator_limits": np.ones(7)}, "shape"),
        ({"weight": [np.nan] * 2}, "weight"),
        ({"contacts": np.ones((1, 2))}, "contacts has the shape"),
        ({"mass_centre": [0.0]}, "mass_centre has the shape"),
        ({"wrench": [0.0]}, "wrench has the shape"),
        ({"facets": 2}, "facets"),
    ],
)
def test_wrong_arguments(make: Callable[[], Case], wrong: dict[str, Any], says: str) -> None:
    with pytest.raises(krhpr.InvalidInput, match=says):
        make().found(**wrong)


def test_wrong_poses_and_robots() -> None:
    case, other = planar("planar_grasp_prr"), spatial("spatial_rrr_b")
    with pytest.raises(krhpr.InvalidInput, match="disturbance is zero"):
        case.found(disturbance=np.zeros(3))
    with pytest.raises(krhpr.InvalidInput, match="needs faces"):
        case.found(faces=None)
    with pytest.raises(krhpr.InvalidInput, match="normal to their slides"):
        other.found(faces=FACES)
    legs = krhpr.load("planar_rr_a", backend="numpy")
    with pytest.raises(krhpr.InvalidInput, match="has no gripper"):
        krhpr.grasp_capability(legs, legs.home, np.zeros((3, 2)), actuator_limits=1.0, friction=0.5)
    pivot, angles = case.pose
    for pose, error in (
        ((pivot + 1.0, angles), krhpr.Unreachable),
        ((pivot, angles * np.nan), krhpr.InvalidInput),
        ((pivot,), krhpr.InvalidInput),
        ((np.stack([pivot, pivot]), angles), krhpr.InvalidInput),
    ):
        with pytest.raises(error):
            Case(case.robot, pose, [(pivot, pivot, pivot)], **case.given).found()
    with pytest.raises(krhpr.NoGrasp, match="overlap"):
        case.found(contacts=CONTACTS[::-1])
    jaws = different("planar_grasp_prr").with_geometry(l_j=(0.04, 0.05))
    with pytest.raises(krhpr.Singular):
        krhpr.grasp_capability(
            jaws,
            ([0.0, 0.09], [0.6, 0.6]),
            [[0.0, 0.02], [0.0, -0.02]],
            faces=[-np.pi / 2, np.pi / 2],
            actuator_limits=1.0,
            friction=0.5,
        )


def test_a_map() -> None:
    """As pose by pose; poses out of reach have a status and no numbers."""
    case = planar("planar_grasp_prr")
    pivot, angles = case.pose
    places = pivot + np.array([[[0.0, 0.0], [0.01, 0.0]], [[0.0, 0.01], [0.0, 2.0]]])
    given = {**case.given, "disturbance": [0.0, 0.0, 0.01]}
    made = krhpr.grasp_capability_map(case.robot, (places, angles), **given)
    assert made.most.shape == (2, 2) and made.status[1, 1] != Status.OK
    assert (
        np.isnan([made.least[1, 1], made.most[1, 1], *made.scale[1, 1]]).all() and made.stopped_by[1, 1] == ()
    )
    for index in ((0, 0), (0, 1), (1, 0)):
        one = krhpr.grasp_capability(case.robot, (places[index], angles), **given)
        assert (made.least[index], made.most[index]) == pytest.approx(one.grasp_force, rel=1e-12)
        assert tuple(made.scale[index]) == pytest.approx(one.scale, rel=1e-12)
        assert made.stopped_by[index] == one.most.stopped_by
        assert made.scale_stopped_by[index] == one.strongest.stopped_by


def test_joints_in_another_working_mode() -> None:
    """Sliders on the other side of their joints bear other forces."""
    case = planar("planar_grasp_prr")
    one = case.found()
    modes = case.robot.inverse_all(*case.pose)
    chosen = modes[:, case.robot.modes.index(case.robot.default_mode)]
    assert case.found(theta=chosen).grasp_force == one.grasp_force
    other = next(modes[:, n] for n in range(len(case.robot.modes)) if not np.allclose(modes[:, n], chosen))
    found = case.found(theta=other)
    s = case.robot.end_points(*case.pose)
    for extreme in (found.least, found.most):
        f = extreme.contact_forces.ravel()
        turned = np.diag(case.directions[:2] @ case.directions[:2].T)  # unit vectors
        np.testing.assert_allclose(turned, 1.0)
        loads = case.robot.forward_statics(case.pose[0], s, other, extreme.actuator_forces).loads
        np.testing.assert_allclose(loads[:2], f @ case.directions, rtol=0, atol=1e-9)
    with pytest.raises(krhpr.InvalidInput):
        case.found(theta=np.nan * other)
