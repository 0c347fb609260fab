"""The reference values: kinematics, Jacobians, statics, the object, and the prototype's trajectories."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import krhpr
from krhpr import Force, Status
from tests.grasping.support import REFERENCE, cross, of_reference, rotation

BACKENDS = ("numpy", "compiled")


def close(found: Any, wanted: Any) -> None:
    found, wanted = np.ravel(found), np.ravel(np.array(wanted, dtype=float))
    assert found.shape == wanted.shape
    assert np.abs(found - wanted).max() < 1e-12 * max(1.0, np.abs(wanted).max())


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize("case", REFERENCE["grasp_planar"], ids=lambda case: case["kind"])
def test_robots(case: dict[str, Any], backend: str) -> None:
    robot = of_reference(case, backend)
    pivot, angles = np.split(np.array(case["y_Bx_By_phi_beta"]), 2)
    s, theta = robot.end_points(pivot, angles), robot.inverse(pivot, angles)
    close(s, [case["P"], case["S"]])
    close(theta, case["rho"])
    for name, (J, K) in {
        "k": robot.jacobians_k(pivot, s, theta),
        "r": robot.jacobians_r(s, theta),
        "n": robot.jacobians_n(pivot, s, theta),
    }.items():
        close(J, case[f"J_{name}"])
        close(K, case[f"K_{name}"])
    assert K.shape == (4, 4)

    # the eight solutions, of which the case's pose is the default one
    every = robot.forward_all(theta)
    there = np.isfinite(every.angles).all(axis=-1)
    assert there.sum() == case["n_fk"]
    assert (there == np.isfinite(every.pivot).all(axis=-1)).all()
    found = robot.forward(theta)
    close(found.pivot, pivot)
    close(found.angles, angles)
    close(every.pivot[0], pivot)

    close(robot.inverse_statics_n(pivot, s, theta, case["F_n"]), case["f_actuators"])
    loads, wrench = robot.forward_statics(pivot, s, theta, np.reshape(case["f_actuators"], (2, 2)))
    close(loads, case["F_n"])
    close(wrench, case["F_at_P"])
    right = np.array(case["f_right"])
    moment = cross(pivot + case["v_right"] - s[0], right)
    close(robot.inverse_statics_k(pivot, s, theta, [*right, moment]), case["f_actuators_right_only"])
    U = np.array(case["U"])
    body = robot.inverse_statics_r(s, theta, case["F_at_P"], 3.0)
    close(body.least_forces, np.linalg.pinv(U) @ case["F_at_P"])
    unit = body.null_space.ravel() / np.linalg.norm(body.null_space)
    wanted = np.array(case["null_U_unit"])
    close(unit * np.sign(unit @ wanted), wanted)
    close(body.actuator_forces, body.least_forces + 3.0 * body.null_space)


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize("case", REFERENCE["object_equilibrium"], ids=lambda c: f"{c['name']}, {c['known']}")
def test_object(case: dict[str, Any], backend: str) -> None:
    robot = krhpr.load_grasping(backend=backend)
    faces = [np.arctan2(n[1], n[0]) for n in (case["n_r"], case["n_l"])]
    held, status = robot.grasp(
        [0.0, 0.0],  # jaw frames are then the base frame, and B the mass centre
        [case["r_r"], case["r_l"]],
        faces,
        case["value"],
        Force(case["known"]),
        weight=case["weight"],
        friction=1e3,
        status=True,
    )
    assert abs(abs(held.determinant) - abs(case["det"])) < 1e-12
    if case["singular"]:
        assert status == Status.UNDETERMINED
        assert np.isnan(held.contact_forces).all() and np.isnan(held.loads).all()
        return
    wanted = [[case["result"][jaw + kind] for kind in "op"] for jaw in "rl"]
    close(held.contact_forces, wanted)
    pressed = held.contact_forces[:, 0] >= 0
    assert (status == Status.OK) == pressed.all()


@pytest.mark.parametrize(
    "case", REFERENCE["prototype"], ids=lambda c: f"{c['trajectory']}, {c['weight_N']} N"
)
def test_prototype(case: dict[str, Any]) -> None:
    robot = krhpr.load_grasping(backend="numpy").with_geometry(l_1=120, l_2=120, l_j=case["b"])
    y = np.array([sample["y"] for sample in case["samples"]])
    pivot, angles = y[:, :2], y[:, 2:]
    s, theta = robot.end_points(pivot, angles), robot.inverse(pivot, angles)
    close(theta, [sample["rho"] for sample in case["samples"]])
    d, h = case["d"], case["h"]
    # at phi = pi/4 and beta = 3 pi/4 the faces are vertical, and the contacts at the height h over B
    right, left = rotation(-np.pi / 4), rotation(-3 * np.pi / 4)
    contacts = [right @ [d / 2, h], left @ [-d / 2, h]]
    held = robot.grasp(
        angles,
        contacts,
        [3 * np.pi / 4, -3 * np.pi / 4],
        case["grasp_N"],
        [sample["measured"] for sample in case["samples"]],
        weight=[0.0, -case["weight_N"]],
        mass_centre=right @ [0.0, h],
        check=True,
    )
    close(held.contact_forces[:, 0, 0], [sample["f_ro"] for sample in case["samples"]])
    close(held.contact_forces[:, 1, 0], [sample["f_lo"] for sample in case["samples"]])
    close(abs(held.determinant), np.full(len(y), d))
    f = robot.inverse_statics_n(pivot, s, theta, held.loads)
    close(f, [sample["f"] for sample in case["samples"]])
    close(case["r_mm"] / 1e3 / case["N"] * f, [sample["tau_Nm"] for sample in case["samples"]])
