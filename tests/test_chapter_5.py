"""Section 5.3 as it is printed: the matrices of the three views of the 3-[R(RR-RRR)SP] robot, written from
the thesis, against the generated functions; and what the errata say of (5.62) to (5.68).

Then: every equation of the chapter has its row in docs/chapter-5.md, with functions and tests that exist.
"""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from functools import cache
from typing import NamedTuple

import numpy as np
import pytest

import krhpr
from krhpr.codegen.build import Parts, build
from krhpr.codegen.robot_code import RobotCode
from krhpr.derivations.catalogue import catalogue
from krhpr.derivations.grasping.catalogue import grasping
from krhpr.robot import Robot
from tests.freebody import Array
from tests.robot.support import configuration
from tests.support import ROOT

ROBOTS = ("spatial_r_fivebar_c", "spatial_rrr_c")


class Printed(NamedTuple):
    """A configuration, and J, K of (5.48), (5.49); (5.56), (5.57); (5.60)."""

    robot: Robot
    p: Array
    Q: Array
    s: Array
    theta: Array
    d: Array
    sk: tuple[Array, Array]
    sr: tuple[Array, Array]
    sn: tuple[Array, Array]


@cache
def printed(identifier: str, seed: int) -> Printed:
    robot = krhpr.load(identifier, backend="numpy")
    p, Q, s, theta = configuration(robot, seed=seed)
    q_z, M = Q[:, 2], robot.subleg_jacobian(s, theta)
    azimuth = robot.geometry.platform_azimuth
    # across the slides, in the moving frame
    n = np.stack([-np.sin(azimuth), np.cos(azimuth), 0 * azimuth], -1)
    left, right = [], []

    def row(leg: int, direction: Array) -> Array:
        """direction^T M_i in the columns of leg i."""
        return np.concatenate([direction @ M[k] if k == leg else np.zeros(3) for k in range(3)])

    for leg in range(3):
        arm = s[leg] - p
        for direction in (Q @ n[leg], q_z):
            left.append(np.concatenate([direction, np.cross(arm, direction)]))
            right.append(row(leg, direction))
    J_sk, K_sk = np.array(left), np.array(right)
    arms = s - p
    J_sr = np.vstack([J_sk, np.hstack([arms, np.zeros((3, 3))])])
    K_sr = np.vstack([K_sk, [row(leg, arms[leg]) for leg in range(3)]])
    d = np.linalg.norm(arms, axis=1)
    J_sn = np.hstack([J_sr, np.vstack([np.zeros((6, 3)), np.diag(d)])])
    return Printed(robot, p, Q, s, theta, d, (J_sk, K_sk), (J_sr, K_sr), (J_sn, K_sr))


def close(a: Array, b: Array, closeness: float = 1e-12) -> None:
    np.testing.assert_allclose(a, b, rtol=0, atol=closeness * max(1.0, np.abs(b).max()))


PLACES = [pytest.param(name, seed, id=f"{name}, {seed}") for name in ROBOTS for seed in range(3)]


@pytest.mark.parametrize(("name", "seed"), PLACES)
def test_kinematically_redundant(name: str, seed: int) -> None:
    """(5.45) to (5.49): the rows of `jacobians`, in some order and with some sign."""
    at = printed(name, seed)
    J, K = at.robot.jacobians(at.p, at.Q, at.s, at.theta)
    given, wanted = np.hstack([J, K]), np.hstack(at.sk)
    for row in wanted:
        assert min(np.abs(given - row).max(axis=1).min(), np.abs(given + row).max(axis=1).min()) < 1e-13
    rates = np.random.default_rng(seed).normal(size=(3, 3))
    twist = at.robot.twist(at.p, at.Q, at.s, at.theta, rates)
    close(at.sk[0] @ twist, at.sk[1] @ rates.ravel())


@pytest.mark.parametrize(("name", "seed"), PLACES)
def test_non_redundant(name: str, seed: int) -> None:
    """(5.50) to (5.54), (5.58) to (5.61): J_sn t_sn = K_sn theta_dot, and each constraint differentiated."""
    at = printed(name, seed)
    rng = np.random.default_rng(seed)
    twist, rates = rng.normal(size=6), rng.normal(size=3)
    theta_dot = at.robot.joint_rates(at.p, at.Q, at.s, at.theta, twist, rates)
    close(at.sn[0] @ [*twist, *rates], at.sn[1] @ theta_dot.ravel())
    # the constraints hold, and s_dot = M theta_dot keeps them to first order
    s_dot = np.einsum("ijk,ik->ij", at.robot.subleg_jacobian(at.s, at.theta), theta_dot)
    arms, spin = at.s - at.p, twist[3:]
    azimuth = at.robot.geometry.platform_azimuth
    normals = np.stack([-np.sin(azimuth), np.cos(azimuth), 0 * azimuth], -1) @ at.Q.T
    for axes in (normals, np.broadcast_to(at.Q[:, 2], (3, 3))):
        close(np.sum(arms * axes, axis=1), np.zeros(3))
        close(np.sum((s_dot - twist[:3]) * axes + arms * np.cross(spin, axes), axis=1), np.zeros(3))
    close(np.sum(arms * (s_dot - twist[:3]), axis=1), at.d * rates)
    # rows leg by leg, with unit vectors along the slides
    found = at.robot.jacobians_n(at.p, at.Q, at.s, at.theta)
    given, wanted = np.hstack([found.J, found.K]), np.hstack(at.sn)
    wanted[6:] /= at.d[:, None]
    for row in wanted:
        assert min(np.abs(given - row).max(axis=1).min(), np.abs(given + row).max(axis=1).min()) < 1e-12
    close(given[2::3], wanted[6:])
    # the actuators' forces from the wrench and what acts along the slides, like (5.44)
    F_sn = rng.normal(size=9)
    wanted = np.linalg.solve(at.sn[0], at.sn[1]).T @ F_sn
    close(at.robot.inverse_statics(at.p, at.Q, at.s, at.theta, F_sn[:6], F_sn[6:]).ravel(), wanted)


@pytest.mark.parametrize(("name", "seed"), PLACES)
def test_redundantly_actuated(name: str, seed: int) -> None:
    """(5.55) to (5.57) with slides blocked; U f = F and the least forces, like (5.24), (5.25)."""
    at = printed(name, seed)
    J_sr, K_sr = at.sr
    rng = np.random.default_rng(seed)
    twist, wrench = rng.normal(size=6), rng.normal(size=6)
    theta_dot = at.robot.joint_rates(at.p, at.Q, at.s, at.theta, twist, np.zeros(3))
    close(J_sr @ twist, K_sr @ theta_dot.ravel())
    found = at.robot.jacobians_n(at.p, at.Q, at.s, at.theta)
    close(found.J[:, :6] @ twist, found.K @ theta_dot.ravel())
    U = np.linalg.solve(K_sr, J_sr).T
    call = (at.p, at.Q, at.s, at.theta)
    null = np.array([at.robot.inverse_statics(*call, np.zeros(6), along).ravel() for along in np.eye(3)])
    close(U @ null.T, np.zeros((6, 3)))
    assert np.linalg.matrix_rank(null) == 3
    some = at.robot.inverse_statics(*call, wrench).ravel()
    least = some - null.T @ np.linalg.lstsq(null.T, some, rcond=None)[0]
    close(least, np.linalg.pinv(U) @ wrench, 1e-11)
    close(at.robot.forward_statics(*call, some.reshape(3, 3)).wrench, wrench)


class Held(NamedTuple):
    """Contacts from O' in the base frame, the jaws' frames, and forces in them."""

    w: Array
    frames: Array
    forces: Array


def held(at: Printed, seed: int) -> Held:
    rng = np.random.default_rng(seed)
    x = -(at.s - at.p) / at.d[:, None]  # from S_i to O'
    z = np.broadcast_to(at.Q[:, 2], (3, 3))
    frames = np.stack([x, np.cross(z, x), z], -1)
    return Held(-0.03 * x + rng.normal(0, 0.004, (3, 3)), frames, rng.normal(size=(3, 3)))


def skew(w: Array) -> Array:
    return np.cross(w, np.eye(3)).T


@pytest.mark.parametrize(("name", "seed"), PLACES)
def test_the_generalised_force(name: str, seed: int) -> None:
    """T_sn of the errata on the forces that `grasp` finds; (5.62) to (5.68) as printed belong to other
    velocities."""
    at = printed(name, seed)
    grip = held(at, seed)
    found = at.robot.grasp(at.Q, grip.w @ at.Q, [2.0, 2.2, 2.4], [0.1, 0.2, -0.5], friction=1e3, check=True)
    f = found.contact_forces.ravel()
    moments = np.hstack([skew(w) @ Q for w, Q in zip(grip.w, grip.frames, strict=True)])
    pressed = np.kron(np.eye(3), [-1.0, 0.0, 0.0])
    F_sn = np.vstack([np.hstack(list(grip.frames)), moments, pressed]) @ f
    close(np.append(found.wrench, found.redundant_forces), F_sn)
    call = (at.p, at.Q, at.s, at.theta)
    right = at.robot.inverse_statics(*call, F_sn[:6], F_sn[6:]).ravel()

    # as printed: T_s of (5.67) with E_s of (5.68), and f_x
    E_s = np.diag([0.0, 1.0, 1.0])
    T_s = np.vstack([np.hstack([Q @ E_s for Q in grip.frames]), moments])
    as_printed = np.append(T_s @ f, found.contact_forces[:, 0])
    wrong = np.linalg.solve(at.sn[0], at.sn[1]).T @ as_printed
    assert np.abs(wrong - right).max() > 0.1 * np.abs(right).max()
    # it is right for sigma_i = x_i^T s_i_dot in place of the slides' velocities
    J = at.sn[0].copy()
    J[6:, :6], J[6:, 6:] = 0.0, -np.diag(at.d)
    close(np.linalg.solve(J, at.sn[1]).T @ as_printed, right, 1e-11)


def test_a_symmetric_grasp_as_printed_opens_the_gripper() -> None:
    """Without weight, the negative of the true torques."""
    robot = krhpr.load("spatial_r_fivebar_c", backend="numpy")
    p, Q, d = (np.array(part) for part in robot.home)
    s = robot.end_points(p, Q, d)
    theta = robot.inverse(p, Q, d)
    right = robot.inverse_statics(p, Q, s, theta, np.zeros(6), [-2.0] * 3)
    printed_force = robot.inverse_statics(p, Q, s, theta, np.zeros(6), [2.0] * 3)
    close(printed_force, -right)
    back = robot.forward_statics(p, Q, s, theta, right)
    close(back.redundant_forces, np.full(3, -2.0))


# -- every equation has a counterpart -----------------------------------------------------------------------

LAST = 76
PAGE = ROOT / "docs" / "chapter-5.md"
NUMBER = re.compile(r"\(5\.(\d+)\)(?: to \(5\.(\d+)\))?")
TEST = re.compile(r"\[(test_\w+)\]\(\.\./(tests/[\w/]+\.py)\)")


def numbers(text: str) -> set[int]:
    """Equations of Chapter 5 that a text names, ranges included."""
    return {n for a, b in NUMBER.findall(text) for n in range(int(a), int(b or a) + 1)}


class Row(NamedTuple):
    equations: set[int]
    counterpart: str
    tests: list[tuple[str, str]]
    text: str


@cache
def rows() -> tuple[Row, ...]:
    found = []
    for line in PAGE.read_text(encoding="utf-8").splitlines():
        cells = [cell.strip() for cell in re.split(r"(?<!\\)\|", line)[1:-1]]
        if len(cells) == 4 and cells[0].startswith("(5."):
            found.append(Row(numbers(cells[0]), cells[2], TEST.findall(cells[3]), line))
    return tuple(found)


@cache
def codes() -> tuple[RobotCode, ...]:
    entries = [*grasping(), *(entry for entry in catalogue() if entry.identifier == "spatial_r_fivebar_c")]
    return tuple(build(entry, Parts()) for entry in entries)  # type: ignore[arg-type]


def test_every_equation_has_a_row() -> None:
    covered = [number for row in rows() for number in row.equations]
    assert sorted(covered) == list(range(1, LAST + 1))


@pytest.mark.parametrize("row", rows(), ids=lambda row: f"5.{min(row.equations)}")
def test_counterparts_exist(row: Row) -> None:
    """Names in code font are functions of a robot of the chapter, or of the package; tests are there."""
    functions = {function.name for code in codes() for function in code.functions}
    names = re.findall(r"`([\w.]+)`", row.counterpart)
    assert names, row.text
    known = functions | {
        field.name
        for code in codes()
        for part in (code.subleg, code.platform)
        for field in (part.geometry.fields if part.geometry else ())
    }
    for name in names:
        assert name in known or in_package(name), name
    assert row.tests, row.text
    for test, path in row.tests:
        tree = ast.parse((ROOT / path).read_text(encoding="utf-8"))
        there = {node.name for node in tree.body if isinstance(node, ast.FunctionDef)}
        assert test in there, f"{path}: {test}"


def in_package(name: str) -> bool:
    parts = name.split(".")
    if parts[0] != "krhpr":
        return False
    found: object = krhpr
    for index, part in enumerate(parts[1:], 2):
        if not hasattr(found, part):
            __import__(".".join(parts[:index]))
        found = getattr(found, part)
    return True


def claims() -> Iterator[tuple[str, int]]:
    for code in codes():
        for function in code.functions:
            yield from ((function.name, number) for number in numbers(function.equations))


def test_what_functions_claim_is_in_the_table() -> None:
    """The equations that the generated documentation states are those of the table."""
    for name, number in sorted(set(claims())):
        (row,) = (row for row in rows() if number in row.equations)
        assert f"`{name}`" in row.counterpart, f"(5.{number}): {name}"
