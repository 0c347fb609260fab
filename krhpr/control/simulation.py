"""The closed loop: sensors, a controller at its rate, and the plant between its steps."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from krhpr.control.controller import Steps, Wanted
from krhpr.control.plant import ACTUATORS, Observation, Plant

Floats = NDArray[np.float64]
Reference = Callable[[float], Wanted]


@dataclass(frozen=True)
class Trace:
    """A run; the first axis is time, one row for each step of the controller."""

    times: Floats
    wanted_force: Floats
    wanted_pivot: Floats
    wanted_angles: Floats
    states: Floats
    """(n, 12), of the plant where the controller's step begins."""
    measured_theta: Floats
    measured_force: Floats
    torques: Floats
    """(n, 4), of the motors, from that step on."""
    seen: Observation
    """The plant's true forces and pose in those states."""

    @property
    def theta(self) -> Floats:
        """(n, 4): the actuated joints."""
        return self.states[:, :ACTUATORS]

    def between(self, first: float, last: float) -> slice:
        """The rows of an interval of time."""
        begin, end = np.searchsorted(self.times, [first, last])
        return slice(int(begin), int(end))


def simulate(
    plant: Plant, controller: Steps, reference: Reference, duration: float, state: Floats | None = None
) -> Trace:
    """Run the closed loop from a state (rest at the reference's first pose, unless given).

    Raises:
        ControlError: the plant cannot be integrated.
        Unreachable, Singular, NoGrasp: the controller has no answer.
    """
    control, drive = plant.control, plant.setup.drive
    period, resolution = control.period, control.resolution(drive)
    noise = np.random.default_rng(control.seed)
    count = max(1, round(duration / period))
    first = reference(0.0)
    x = plant.at_rest(first.pivot, first.angles) if state is None else np.array(state)
    u = np.zeros(ACTUATORS)
    grasp = plant.grasp_force(x, u)
    controller.reset()
    times: Floats = period * np.arange(count, dtype=float)
    states, inputs = np.empty((count, len(x))), np.empty((count, ACTUATORS))
    theta, torques, force = np.empty((count, ACTUATORS)), np.empty((count, ACTUATORS)), np.empty(count)
    told = []
    for k, t in enumerate(times):
        wanted = reference(float(t))
        states[k], inputs[k] = x, u
        theta[k] = encoded(x[:ACTUATORS], resolution)
        force[k] = grasp + control.sensors.force_noise * noise.standard_normal()
        torques[k] = np.ravel(controller.step(wanted, theta[k].reshape(2, 2), float(force[k])))
        u = torques[k] * drive.ratio / drive.radius
        x, grasp = plant.advance(x, u)
        told.append(wanted)
    return Trace(
        times,
        np.array([one.grasp_force for one in told]),
        np.array([one.pivot for one in told]),
        np.array([one.angles for one in told]),
        states,
        theta,
        force,
        torques,
        plant.observe_all(states, inputs),
    )


def encoded(theta: Floats, resolution: float) -> Floats:
    """Joints as encoders count them; as they are where the resolution is zero."""
    if resolution == 0:
        return theta.copy()
    counted: Floats = resolution * np.round(theta / resolution)
    return counted
