"""The three schemes in the closed loop: what the thesis measured, and what closed forms say of it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from krhpr.control.closed_forms import grip_of, line
from krhpr.control.controller import Controller, Wanted
from krhpr.control.parameters import PROTOTYPE as CONTROL
from krhpr.control.parameters import Scheme
from krhpr.control.plant import Plant
from krhpr.control.simulation import Trace, encoded, simulate
from krhpr.errors import ControlError
from krhpr.study.grasp import PROTOTYPE, Setup
from krhpr.study.grasp_control import Along, GraspControl, Loop, along, in_python, step_response
from tests.control.support import STRUTS, ideal, plant, pose, risen, weightless


def run(one: Plant, scheme: Scheme, reference, duration: float) -> Trace:  # type: ignore[no-untyped-def]
    return simulate(one, in_python(one, scheme), reference, duration)


def turned(setup: Setup, angle: float, jaw: int):  # type: ignore[no-untyped-def]
    """The pose, with a jaw told to turn into the object."""
    pivot, angles = pose(setup)
    closing = np.array([1.0, 0.0]) if jaw == 0 else np.array([0.0, -1.0])
    return lambda t: Wanted(pivot, angles + angle * min(t / 0.2, 1.0) * closing, 0.0)


@pytest.mark.parametrize(
    ("setup", "jaw"),
    [(weightless(), 0), (weightless(), 1), (weightless(STRUTS), 0)],
    ids=["prr-right", "prr-left", "rpr-right"],
)
def test_scheme_i_has_the_slope_of_the_closed_form(setup: Setup, jaw: int) -> None:
    """(5.72) in the quasi-static limit without friction, whichever jaw is turned, for small angles."""
    # damping by which all has died away in the end
    calm = replace(ideal(), position=replace(CONTROL.position, stiffness=8000.0, damping=900.0))
    one = Plant(setup, calm)
    stiffness = grip_of(one.robot, setup, calm).stiffness()
    slopes = []
    for angle in (0.001, 0.002):
        trace = run(one, Scheme.POSITION, turned(setup, angle, jaw), 1.0)
        last = trace.seen.grasp_force[-20:]
        assert np.ptp(last) < 1e-5 * last[-1]
        slopes.append(last[-1] / angle)
    assert 2 * slopes[0] - slopes[1] == pytest.approx(stiffness, rel=1e-4)
    assert slopes[1] == pytest.approx(stiffness, rel=0.02)


def test_the_closed_form_is_that_of_the_study() -> None:
    """21.15 N/rad for each N/mm where the object is rigid (errata 2.2)."""
    grip = grip_of(PROTOTYPE.build(), PROTOTYPE, CONTROL)
    assert 1e3 * grip.rigid_stiffness / CONTROL.position.stiffness == pytest.approx(21.15, abs=5e-3)
    assert 1 / grip.stiffness() == pytest.approx(1 / grip.rigid_stiffness + 2 / (150e3 * 0.0425))
    assert grip.drag == -0.5 and grip.stiffness(0.2) > grip.stiffness()


def test_weight_opens_the_jaws_under_scheme_i() -> None:
    one = Plant(PROTOTYPE, ideal())
    grip = grip_of(one.robot, PROTOTYPE, ideal())
    found = [
        run(one, Scheme.POSITION, turned(PROTOTYPE, e, 0), 1.2).seen.grasp_force[-1] for e in (0.01, 0.02)
    ]
    fitted = line(np.array([0.01, 0.02]), np.array(found))
    assert fitted.slope == pytest.approx(grip.stiffness(), rel=0.02)
    assert -fitted.offset / fitted.slope == pytest.approx(grip.sag, rel=0.05)


@pytest.mark.parametrize("wanted", [1.0, 3.0])
def test_scheme_ii_is_on_the_reference_without_friction(wanted: float) -> None:
    """But for what position control takes back because the contacts give."""
    one = Plant(PROTOTYPE, ideal())
    held_back = grip_of(one.robot, PROTOTYPE, ideal()).held_back
    trace = run(one, Scheme.FEEDFORWARD, risen(PROTOTYPE, wanted), 1.4)
    assert trace.seen.grasp_force[-1] == pytest.approx(wanted / (1 + held_back), rel=2e-4)
    assert 0.02 < held_back < 0.05


def test_scheme_ii_is_far_below_because_of_friction() -> None:
    """Below on the way up, above on the way down, and always in the band of friction."""
    one, friction = plant(), CONTROL.friction
    grip, coulomb = grip_of(one.robot, PROTOTYPE, CONTROL), CONTROL.coulomb(PROTOTYPE.drive)
    pivot, angles = pose(PROTOTYPE)
    corners, heights = [0.0, 0.5, 0.9, 1.4, 1.8, 2.3, 2.7], [0.0, 2.0, 2.0, 4.0, 4.0, 2.0, 2.0]
    trace = run(
        one,
        Scheme.FEEDFORWARD,
        lambda t: Wanted(pivot, angles, float(np.interp(t, corners, heights))),
        2.7,
    )
    up, top, down = (float(trace.seen.grasp_force[int(t * CONTROL.rate) - 1]) for t in (0.9, 1.8, 2.7))
    assert up < 0.7 * 2.0 and top < 0.75 * 4.0 and down > 1.1 * up
    for found, wanted in ((up, 2.0), (top, 4.0), (down, 2.0)):
        least, most = grip.band(wanted, coulomb, friction.load_share, friction.stiction)
        assert least < found < most
    assert grip.band(2.0, 0.0, 0.0, 1.0) == pytest.approx((2.0 / (1 + grip.held_back),) * 2)


def test_scheme_iii_steps_fast_and_leaves_no_error() -> None:
    trace = step_response(Loop(plant(), in_python))
    found = GraspControl(PROTOTYPE, CONTROL, None, None, None, None, None, trace, ())  # type: ignore[arg-type]
    assert found.settling < 0.3 and abs(found.step_error) < 0.005 * PROTOTYPE.force
    assert trace.seen.grasp_force.max() < 1.15 * PROTOTYPE.force
    # the noise of the load cell hardly gets through
    last = trace.between(1.2, np.inf)
    assert trace.seen.grasp_force[last].std() < 0.6 * trace.measured_force[last].std()


def test_scheme_iii_needs_no_knowledge_of_friction() -> None:
    """With twice the friction and half the contacts' stiffness: the same steady force."""
    rough = replace(CONTROL.friction, torque=2 * CONTROL.friction.torque)
    other = replace(CONTROL, friction=rough, contact=replace(CONTROL.contact, stiffness=75e3))
    one = Plant(PROTOTYPE, other)
    trace = run(one, Scheme.COMBINED, risen(PROTOTYPE, 2.0, rise=0.01), 2.0)
    assert trace.seen.grasp_force[-300:].mean() == pytest.approx(2.0, rel=0.01)
    assert grip_of(one.robot, PROTOTYPE, other).band(2.0, 1.03, 0.3, 1.2)[0] < 0.5


@pytest.mark.parametrize("number", [0, pytest.param(1, marks=pytest.mark.full), 2])
def test_scheme_iii_holds_along_the_trajectories(number: int) -> None:
    """(5.73) to (5.75), quicker than in the thesis so that every actuator turns round in a short run."""
    motion = PROTOTYPE.motions[number]
    quick = replace(motion, frequency=2.0)
    found: Along = along(Loop(plant(), in_python), quick, duration=1.6)
    assert np.sqrt((found.error**2).mean()) < 0.05 * PROTOTYPE.force
    assert np.abs(found.error).max() < 0.2 * PROTOTYPE.force
    assert found.position_error < 2.5e-3
    seen = found.trace.seen
    assert found.friction_needed < PROTOTYPE.held.friction
    assert (seen.normal_forces[found.moving].min(axis=-1) > 0.7 * PROTOTYPE.force).all()
    # the measured jaw is the one that the weight presses on less, but for the object's inertia
    later = found.trace.between(1.3, np.inf)
    assert np.abs(seen.normal_forces.min(axis=-1) - seen.grasp_force)[later].max() < 5e-3


def test_sensors() -> None:
    trace = run(plant(), Scheme.COMBINED, risen(PROTOTYPE, 2.0), 0.5)
    count = CONTROL.resolution(PROTOTYPE.drive)
    assert np.abs(trace.measured_theta - trace.theta).max() <= count / 2 * (1 + 1e-9)
    turns = trace.measured_theta / count
    assert np.abs(turns - np.round(turns)).max() < 1e-6
    noise = (trace.measured_force - trace.seen.grasp_force).std()
    assert noise == pytest.approx(CONTROL.sensors.force_noise, rel=0.15)
    again = run(plant(), Scheme.COMBINED, risen(PROTOTYPE, 2.0), 0.5)
    assert np.array_equal(trace.states, again.states), "the same seed, the same run"
    other = Plant(PROTOTYPE, replace(CONTROL, seed=1))
    assert not np.array_equal(trace.states, run(other, Scheme.COMBINED, risen(PROTOTYPE, 2.0), 0.5).states)
    assert np.array_equal(encoded(np.array([0.1, -0.2]), 0.0), [0.1, -0.2])


def test_motors_give_no_more_than_they_can() -> None:
    weak = replace(CONTROL, motor=replace(CONTROL.motor, torque_limit=1e-4))
    trace = run(Plant(PROTOTYPE, weak), Scheme.COMBINED, risen(PROTOTYPE, 2.0), 0.6)
    assert np.abs(trace.torques).max() == 1e-4 and trace.seen.grasp_force.max() < 1.5
    # the integral does not wind up beyond its bound: it lets go at once
    assert (trace.seen.normal_forces[100:] >= -1e-3).all()


@pytest.mark.parametrize(
    ("theta", "measured", "force"),
    [(np.nan, 2.0, 2.0), (0.0, np.nan, 2.0), (0.0, 2.0, np.inf)],
)
@pytest.mark.parametrize("scheme", Scheme)
def test_what_is_not_a_number_is_told(scheme: Scheme, theta: float, measured: float, force: float) -> None:
    one = plant()
    controller = Controller(one.robot, PROTOTYPE, CONTROL, scheme, one.branch)
    pivot, angles = pose(PROTOTYPE)
    joints = one.robot.inverse(pivot, angles) + theta
    with pytest.raises(ControlError, match="all must be finite"):
        controller.step(Wanted(pivot, angles, force), joints, measured)
