"""The plant by itself: energy, equilibrium against the static model, friction, and the integrator."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from krhpr.control.controller import Controller
from krhpr.control.parameters import PROTOTYPE as CONTROL
from krhpr.control.parameters import Contact, ControlSetup, Scheme
from krhpr.control.plant import ACTUATORS, Plant
from krhpr.errors import ControlError
from krhpr.study.grasp import PROTOTYPE, Setup
from tests.control.support import STRUTS, heavy, ideal, plant, pose, weightless

NOTHING = np.zeros(ACTUATORS)
HIGHEST = 0.1499
"""Of the pivot (m): in reach with the object, and not with jaws that are open by a degree."""
LOSSLESS = replace(ideal(), contact=Contact(stiffness=1.5e5, damping=0.0), rate=1000.0)


def pressed(one: Plant, depth: float) -> np.ndarray:
    """At rest with the jaws closed into the object by an angle."""
    pivot, angles = pose(one.setup)
    return one.at_rest(pivot, angles + depth / 2 * np.array([1.0, -1.0]))


@pytest.mark.parametrize("setup", [replace(PROTOTYPE, held=heavy(50.0)), STRUTS], ids=["prr", "rpr"])
def test_energy_is_kept_without_losses(setup: Setup, monkeypatch: pytest.MonkeyPatch) -> None:
    """Light motors and a heavy object, so that its inertia counts; contact is lost on the way."""
    monkeypatch.setattr("krhpr.control.plant.STEPS_PER_RADIAN", 60.0)
    light = replace(LOSSLESS, motor=replace(LOSSLESS.motor, inertia=3e-8))
    one = Plant(setup, light)
    x = pressed(one, 2e-3)
    x[4:8] = [0.05, -0.03, 0.02, 0.06]
    before = one.observe(x, NOTHING)
    seen = []
    for _ in range(60):
        x, _ = one.advance(x, NOTHING)
        seen.append(one.observe(x, NOTHING))
    energy = np.array([now.energy for now in seen])
    assert max(now.compression for now in seen) > 0 > min(now.compression for now in seen)
    moved = np.abs(x[4:8]).max() ** 2 * one.mass / 2
    assert moved > 1e-4 and np.abs(energy - before.energy).max() < 1e-5 * moved


@settings(max_examples=15)
@given(
    rates=st.lists(st.floats(-0.05, 0.05), min_size=4, max_size=4),
    bend=st.lists(st.floats(-1.0, 1.0), min_size=4, max_size=4),
    force=st.lists(st.floats(-5.0, 5.0), min_size=4, max_size=4),
    depth=st.floats(-2e-3, 1e-3),
)
def test_the_plant_is_passive(
    rates: list[float], bend: list[float], force: list[float], depth: float
) -> None:
    """With all losses: its energy grows by no more than the motors' work."""
    one = plant()
    x = pressed(one, depth)
    x[4:8], x[8:] = rates, np.array(bend) * CONTROL.friction.presliding
    u = np.array(force)
    for _ in range(4):
        after, _ = one.advance(x, u)
        work = u @ (after[:ACTUATORS] - x[:ACTUATORS])
        gained = one.observe(after, u).energy - one.observe(x, u).energy
        assert gained <= work + 1e-9
        x = after


@pytest.mark.parametrize("setup", [PROTOTYPE, STRUTS], ids=["prr", "rpr"])
@pytest.mark.parametrize("turn", [-0.4, 0.0, 0.3])
def test_the_static_model_holds_it_at_rest(setup: Setup, turn: float) -> None:
    """Forces of energies and forces of equilibrium are the same: nothing accelerates."""
    turned = replace(setup, phi=setup.phi + turn, beta=setup.beta + turn)
    one = Plant(turned, ideal())
    x = pressed(one, 1e-4)
    seen = one.observe(x, NOTHING)
    model = Controller(one.robot, turned, ideal(), Scheme.FEEDFORWARD, one.branch)
    at_rest = one.observe(x, np.ravel(model.static_forces(x[:4].reshape(2, 2), float(seen.grasp_force))))
    u = np.ravel(model.static_forces(x[:4].reshape(2, 2), float(at_rest.grasp_force)))
    scale = np.abs(u).max() / one.mass
    assert at_rest.grasp_force > 0.1
    # the faces are parallel but for the depth: what is left is of its order
    assert np.abs(one.rates(x, u)[4:8]).max() < 5e-4 * scale
    assert np.abs(one.rates(x, 1.01 * u)[4:8]).max() > 1e-3 * scale


def test_both_jaws_share_the_weight() -> None:
    """Of an object whose weight is along the line through its contacts, each bears the half."""
    aside = replace(PROTOTYPE, phi=PROTOTYPE.phi + np.pi / 6, beta=PROTOTYPE.beta + np.pi / 6)
    one = Plant(aside, ideal())
    x = pressed(one, 4e-4)
    model = Controller(one.robot, aside, ideal(), Scheme.FEEDFORWARD, one.branch)
    u = np.ravel(model.static_forces(x[:4].reshape(2, 2), one.grasp_force(x, NOTHING)))
    seen = one.observe(x, u)
    right, left = seen.normal_forces
    # phi beyond 45 deg: the weight pulls the object away from the right jaw
    assert right == pytest.approx(float(seen.grasp_force)) and left > right
    assert left - right == pytest.approx(0.3 * np.sin(np.pi / 6), rel=1e-3)


def test_bristles_hold_and_let_go() -> None:
    """Below stiction an actuator stays, but for the bristles' bend; above Coulomb's friction it slides."""
    free = weightless()
    one = Plant(free, CONTROL)
    coulomb, bend = CONTROL.coulomb(free.drive), CONTROL.friction.presliding
    pivot, angles = pose(free)
    begin = one.at_rest(pivot, angles + np.array([-0.02, 0.02]))  # jaws open

    def moved(share: float, periods: int) -> np.ndarray:
        x = begin
        for k in range(periods):
            x, _ = one.advance(x, share * coulomb * min(1.0, k / 50) * np.array([1.0, -1.0, 1.0, -1.0]))
        return np.asarray(x - begin)

    held, slid = moved(0.9, 400), moved(1.5, 400)
    assert np.abs(held[:4]).max() < 10 * bend and np.abs(held[4:8]).max() < 1e-5
    assert (np.abs(slid[:4]) > 200 * bend).all() and (np.sign(slid[:4]) == [1, -1, 1, -1]).all()
    # sliding, the bristles are bent to g: Coulomb's friction and what Stribeck's curve leaves on top
    speed = np.abs(slid[4:8])
    top = 1 + (CONTROL.friction.stiction - 1) * np.exp(-((speed / CONTROL.friction.stribeck_speed) ** 2))
    assert np.abs(np.abs(slid[8:]) / (bend * top) - 1).max() < 1e-3


def test_the_integrator_converges(monkeypatch: pytest.MonkeyPatch) -> None:
    """Four times as many steps give the same motion, through stick, slip and contact."""

    def end(one: Plant) -> np.ndarray:
        x = pressed(one, -5e-5)
        for k in range(60):
            x, _ = one.advance(x, np.array([2.0, 2.0, -2.0, -2.0]) * (k < 30))
        return x

    usual = end(Plant(PROTOTYPE, CONTROL))
    monkeypatch.setattr("krhpr.control.plant.STEPS_PER_RADIAN", 32.0)
    monkeypatch.setattr("krhpr.control.plant.STEPS_PER_BEND", 8.0)
    finer = end(Plant(PROTOTYPE, CONTROL))
    assert np.abs(usual - finer)[:4].max() < 5e-9 and np.abs(usual - finer)[8:].max() < 5e-9


def too_quick() -> ControlSetup:
    return replace(CONTROL, contact=Contact(stiffness=1e16, damping=0.0))


@pytest.mark.parametrize(
    ("setup", "control", "said"),
    [
        (replace(PROTOTYPE, beta=PROTOTYPE.phi + 1e-9), CONTROL, "the jaws are aligned"),
        (replace(PROTOTYPE, pivot=(0.0, 0.9)), CONTROL, "the pose with the object is out of reach: "),
        (
            replace(PROTOTYPE, held=replace(PROTOTYPE.held, width=0.427)),
            CONTROL,
            "wider than the jaws open: 427",
        ),
        (replace(PROTOTYPE, pivot=(0.0, HIGHEST)), CONTROL, "do not open beyond the object: .* cannot reach"),
    ],
)
def test_grasps_that_are_none(setup: Setup, control: ControlSetup, said: str) -> None:
    with pytest.raises(ControlError, match=said):
        Plant(setup, control)


def test_what_is_too_quick_is_told() -> None:
    one = Plant(PROTOTYPE, too_quick())
    with pytest.raises(ControlError, match=r"too quick to be integrated.*stiffness of the contacts"):
        one.advance(pressed(one, 0.0), NOTHING)


def test_leaving_the_reach_is_told() -> None:
    one = plant()
    x = pressed(one, 0.0)
    with pytest.raises(ControlError, match="leaves the robot's reach"):
        for _ in range(2000):
            x, _ = one.advance(x, 60.0 * np.array([-1.0, 1.0, -1.0, 1.0]))
