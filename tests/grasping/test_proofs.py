"""Exact identities: Jacobians are the derivatives of the loop closures, forces do the work that they must."""

from __future__ import annotations

from typing import Any

import pytest

from krhpr.validation.arithmetic import BALLS
from krhpr.validation.jets import Jet
from krhpr.validation.linear import apply, dot, matrix
from krhpr.validation.numbers import Ball, Exact, ball_precision
from tests.grasping.exact import Place, Values, closure, end_point
from tests.grasping.support import ROBOTS

PLACES = [pytest.param(name, seed, id=f"{name}, {seed}") for name in ROBOTS for seed in range(5)]


def jets(values: list[Any], rates: list[Any]) -> list[Jet]:
    return [Jet(value, rate) for value, rate in zip(values, rates, strict=True)]


def minor(rows: list[list[Any]], i: int, j: int) -> list[list[Any]]:
    return [[x for b, x in enumerate(row) if b != j] for a, row in enumerate(rows) if a != i]


def determinant(rows: list[list[Any]]) -> Any:
    """By its first row."""
    if len(rows) == 1:
        return rows[0][0]
    return sum(((-1) ** j * rows[0][j] * determinant(minor(rows, 0, j)) for j in range(len(rows))), Exact(0))


def cross(a: list[Any], b: list[Any]) -> Any:
    return a[0] * b[1] - a[1] * b[0]


@pytest.mark.parametrize(("name", "seed"), PLACES)
def test_non_redundant_jacobians_are_derivatives(name: str, seed: int) -> None:
    place = Place(name, seed)
    velocity, rho_dot = place.draw.vector(4), place.draw.vector(4)
    pivot = jets(place.values["pivot"], velocity[:2])
    angles = jets(place.values["angles"], velocity[2:])
    rho = jets(place.values["theta"], rho_dot)
    found = place.call("jacobians_n")
    left, right = apply(matrix(found["J"], 4), velocity), apply(matrix(found["K"], 4), rho_dot)
    for chain in range(4):
        leg = chain // 2
        moving = closure(place, chain, end_point(place, leg, pivot, angles[leg]), rho[chain])
        assert moving.rate == left[chain] - right[chain]


@pytest.mark.parametrize(("name", "seed"), PLACES)
def test_redundantly_actuated_jacobians_are_derivatives(name: str, seed: int) -> None:
    """Both jaws turn as one body about P."""
    place = Place(name, seed)
    velocity, rho_dot = place.draw.vector(3), place.draw.vector(4)
    rho = jets(place.values["theta"], rho_dot)
    s = place.values["s"]
    turned = Jet(place.draw.angle(), velocity[2])
    # c of (5.14) in the frame that stands at that angle
    c = [s[2] - s[0], s[3] - s[1]]
    cosine, sine = turned.value.cos(), turned.value.sin()
    local = [cosine * c[0] + sine * c[1], -sine * c[0] + cosine * c[1]]
    p = jets(s[:2], velocity[:2])
    far = [
        p[0] + turned.cos() * local[0] - turned.sin() * local[1],
        p[1] + turned.sin() * local[0] + turned.cos() * local[1],
    ]
    found = place.call("jacobians_r")
    left, right = apply(matrix(found["J"], 3), velocity), apply(matrix(found["K"], 4), rho_dot)
    for chain in range(4):
        moving = closure(place, chain, p if chain < 2 else far, rho[chain])
        assert moving.rate == left[chain] - right[chain]


@pytest.mark.parametrize(("name", "seed"), PLACES)
def test_kinematically_redundant_jacobians_are_derivatives(name: str, seed: int) -> None:
    """P by its chains, S by its own, and the length of the left jaw between S and B, (5.4), (5.5)."""
    place = Place(name, seed)
    velocity, rho_dot = place.draw.vector(3), place.draw.vector(4)
    rho = jets(place.values["theta"], rho_dot)
    s, phi = place.values["s"], Jet(place.values["angles"][0], velocity[2])
    p = jets(s[:2], velocity[:2])
    found = place.call("jacobians_k")
    left, right = apply(matrix(found["J"], 3), velocity), apply(matrix(found["K"], 4), rho_dot)
    for chain in range(2):
        assert closure(place, chain, p, rho[chain]).rate == left[chain] - right[chain]

    # the velocity of S for which its chains stay closed, by Cramer's rule on the closures' slopes
    slopes, constants = [], []
    for chain in (2, 3):
        still = closure(place, chain, s[2:], rho[chain]).rate
        along = [
            closure(place, chain, jets(s[2:], [Exact(i == k) for k in range(2)]), rho[chain]).rate - still
            for i in range(2)
        ]
        slopes.append(along)
        constants.append(-still)
    det = cross(*slopes)
    s_dot = [
        (constants[0] * slopes[1][1] - constants[1] * slopes[0][1]) / det,
        (slopes[0][0] * constants[1] - slopes[1][0] * constants[0]) / det,
    ]
    length = place.of("l_j", 0)
    pivot = [p[0] + length * phi.cos(), p[1] + length * phi.sin()]
    jaw = [a - b for a, b in zip(jets(s[2:], s_dot), pivot, strict=True)]
    assert (jaw[0] * jaw[0] + jaw[1] * jaw[1]).rate / 2 == right[2] - left[2]


@pytest.mark.parametrize(("name", "seed"), PLACES)
def test_determinants_are_those_of_the_jacobians(name: str, seed: int) -> None:
    place = Place(name, seed)
    found = place.call("singularity")
    J_k, J_n = (matrix(place.call(f"jacobians_{view}")["J"], size) for view, size in (("k", 3), ("n", 4)))
    assert found["determinants"] == [determinant(J_k), determinant(J_n)]
    phi, beta = place.values["angles"]
    assert found["sine"] == [(beta - phi).sin()]
    K = matrix(place.call("jacobians_n")["K"], 4)
    assert found["type_1"] == [K[i][i] for i in range(4)]


@pytest.mark.parametrize(("name", "seed"), PLACES)
def test_rates_there_and_back(name: str, seed: int) -> None:
    place = Place(name, seed)
    rates = {"pivot_rate": place.draw.vector(2), "angle_rates": place.draw.vector(2)}
    theta_dot = place.call("joint_rates", **rates)["theta_dot"]
    back = place.call("twist", theta_dot=theta_dot)
    assert {name: back[name] for name in rates} == rates
    found = place.call("jacobians_k")
    assert apply(matrix(found["J"], 3), back["twist"]) == apply(matrix(found["K"], 4), theta_dot)
    found = place.call("jacobians_n")
    whole = [*back["pivot_rate"], *back["angle_rates"]]
    assert apply(matrix(found["J"], 4), whole) == apply(matrix(found["K"], 4), theta_dot)


@pytest.mark.parametrize(("name", "seed"), PLACES)
def test_virtual_work(name: str, seed: int) -> None:
    """F_n^T t_n = f^T rho_dot for every motion, and forces there and back."""
    place = Place(name, seed)
    loads = place.draw.vector(4)
    forces = place.call("inverse_statics_n", loads=loads)["actuator_forces"]
    theta_dot = place.draw.vector(4)
    moved = place.call("twist", theta_dot=theta_dot)
    velocity = [*moved["pivot_rate"], *moved["angle_rates"]]
    assert dot(loads, velocity) == dot(forces, theta_dot)
    back = place.call("forward_statics", actuator_forces=forces)
    assert back["loads"] == loads

    # the right jaw alone: power of the wrench at P
    wrench = place.draw.vector(3)
    forces = place.call("inverse_statics_k", wrench=wrench)["actuator_forces"]
    assert dot(wrench, moved["twist"]) == dot(forces, theta_dot)
    # and of the non-redundant view nothing but the moment of the left jaw is zero
    found = place.call("forward_statics", actuator_forces=forces)["loads"]
    assert found[3] == 0
    assert found[:2] == wrench[:2]


@pytest.mark.parametrize(("name", "seed"), PLACES)
def test_both_jaws_as_one_body(name: str, seed: int) -> None:
    """U f = F; the wrench of both as one body is that of the loads, taken to P."""
    place = Place(name, seed)
    forces = place.draw.vector(4)
    found = place.call("forward_statics", actuator_forces=forces)
    force, m_r, m_l = found["loads"][:2], *found["loads"][2:]
    arm = [b - p for b, p in zip(place.values["pivot"], place.values["s"][:2], strict=True)]
    assert found["wrench"] == [*force, m_r + m_l + cross(arm, force)]
    # F = J_r^T K_r^-T f, (5.24)
    jacobians = place.call("jacobians_r")
    J, K = matrix(jacobians["J"], 3), matrix(jacobians["K"], 4)
    scaled = [force / K[i][i] for i, force in enumerate(forces)]
    assert found["wrench"] == [dot([J[i][j] for i in range(4)], scaled) for j in range(3)]


@pytest.mark.parametrize("seed", range(5))
@pytest.mark.parametrize("measured", range(4))
def test_object_is_in_equilibrium(measured: int, seed: int) -> None:
    """Forces add up to the weight, moments about the mass centre vanish, and the sensor is right."""
    place = Place("planar_grasp_prr", seed)
    draw = place.draw
    angles = place.values["angles"]
    contacts, faces = draw.vector(4), [draw.angle(), draw.angle()]
    centre, weight = draw.vector(2), draw.vector(2)
    value = draw.nonzero()
    found = place.call(
        "grasp",
        contacts=contacts,
        faces=faces,
        mass_centre=centre,
        weight=weight,
        sensor=[Exact(i == measured) for i in range(4)],
        measured_force=[value],
        friction=[Exact(1)],
    )

    def turned(angle: Any, v: list[Any]) -> list[Any]:
        c, s = angle.cos(), angle.sin()
        return [c * v[0] - s * v[1], s * v[0] + c * v[1]]

    assert found["contact_forces"][measured] == value
    v = [turned(angle, contacts[2 * i : 2 * i + 2]) for i, angle in enumerate(angles)]
    g = turned(angles[0], centre)
    n = [turned(angle + face, [Exact(1), Exact(0)]) for angle, face in zip(angles, faces, strict=True)]
    pairs = matrix(found["contact_forces"], 2)
    forces = [[o * m[0] - t * m[1], o * m[1] + t * m[0]] for (o, t), m in zip(pairs, n, strict=True)]
    assert [forces[0][k] + forces[1][k] + weight[k] for k in range(2)] == [0, 0]
    assert (
        sum(
            (cross([a - b for a, b in zip(w, g, strict=True)], f) for w, f in zip(v, forces, strict=True)),
            Exact(0),
        )
        == 0
    )
    # T of (5.42)
    assert found["loads"] == [*(-w for w in weight), *(cross(a, f) for a, f in zip(v, forces, strict=True))]
    assert found["friction_margins"] == [o * o - t * t for o, t in pairs]
    assert found["pulls"] == [dot(weight, m) for m in n]
    c = [a - b for a, b in zip(*v, strict=True)]
    assert found["widths"] == [-dot(c, n[0]), dot(c, n[1])]
    # the determinant of the three equations, in the forces that are not measured
    columns = [direction for m in n for direction in (m, [-m[1], m[0]])]
    rows = [[c[0] for c in columns], [c[1] for c in columns]]
    arms = [[a - b for a, b in zip(w, g, strict=True)] for w in v]
    rows.append([cross(arms[i // 2], c) for i, c in enumerate(columns)])
    rest = [[x for i, x in enumerate(row) if i != measured] for row in rows]
    assert abs(found["determinant"][0]) == abs(determinant(rest))


@pytest.mark.parametrize(("name", "seed"), PLACES)
def test_least_forces_and_null_space(name: str, seed: int) -> None:
    """Of (5.25): U f_least = F, U k = 0, f_least . k = 0, and their sum; in balls."""
    place = Place(name, seed)
    wrench, internal = place.draw.vector(3), place.draw.nonzero()
    jacobians = place.call("jacobians_r")
    J, K = matrix(jacobians["J"], 3), matrix(jacobians["K"], 4)
    with ball_precision():
        found = place.subject.call(
            "inverse_statics_r",
            as_balls({**place.values, "wrench": wrench, "internal_force": [internal]}),
            as_balls(place.geometry),
            BALLS,
        )
        least, null, forces = (found[port] for port in ("least_forces", "null_space", "actuator_forces"))

        def wrench_of(f: list[Any]) -> list[Any]:
            return [sum((J[i][j] / K[i][i] * f[i] for i in range(4)), Ball(0)) for j in range(3)]

        assert all(small(a - b) for a, b in zip(wrench_of(least), wrench, strict=True))
        assert all(map(small, wrench_of(null)))
        assert small(sum((a * b for a, b in zip(least, null, strict=True)), Ball(0)))
        assert all(small(f - a - internal * b) for f, a, b in zip(forces, least, null, strict=True))


def as_balls(values: Values) -> Values:
    """Enclosures of exact numbers; angles as they are."""
    return {
        name: [Ball(value) if isinstance(value, Exact) else value for value in row]
        for name, row in values.items()
    }


def small(value: Ball) -> bool:
    return bool(abs(value.enclosure) < 1e-60)
