"""The terms of an objective that concern the joints, as numbers."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from krhpr.robot import Robot
from krhpr.trajectory.terms import Objective

Floats = NDArray[np.float64]


def per_length(robot: Robot, length: float) -> Floats:
    """What displacements of actuators (n) are multiplied by to be comparable: 1 / length where they slide."""
    return np.where(robot.angular, 1.0, 1.0 / length)


def squared_torques(robot: Robot, objective: Objective, at: tuple[Any, ...], length: float) -> Floats:
    """The sum of the actuators' squared torques (...) under the objective's load; (N m)^2."""
    if objective.load is None:
        return np.zeros(np.shape(at[3])[:-2])
    p, Q, s, theta = at
    load = objective.load
    torques = robot.inverse_statics(p, Q, s, theta, load.wrench, load.redundant_forces)
    return np.asarray(((torques / per_length(robot, length)) ** 2).sum(axis=(-1, -2)))


def of_poses(robot: Robot, objective: Objective, found: Any, at: tuple[Any, ...], length: float) -> Floats:
    """What poses add to the integrand (...), from their indices or bounds of these; largest values count as
    if they were integrated, which is what a search that looks at one pose after the other can do."""
    etas = (found.eta_1, found.eta_2, found.eta_3)
    with np.errstate(all="ignore"):
        total = objective.value(*etas)
        for name, term in objective.peaks(*etas).items():
            total = total + getattr(objective, name) * term
        total = total + objective.torques * squared_torques(robot, objective, at, length)
    return np.asarray(total)


def of_steps(robot: Robot, objective: Objective, change: Floats, step: Any, length: float) -> Floats:
    """What steps of actuators (..., n) within a time (...) add to the objective: their travel, and their
    squared rates."""
    if not objective.travel and not objective.joint_rates:
        return np.zeros(np.shape(change)[:-1])
    comparable = change * per_length(robot, length)
    travel, squares = np.abs(comparable).sum(axis=-1), (comparable**2).sum(axis=-1)
    return np.asarray(objective.travel * travel + objective.joint_rates * squares / step)


def short_way(robot: Robot, change: Floats) -> Floats:
    """Changes of actuators (..., n), those of revolute ones the short way round."""
    return np.where(robot.angular, np.arctan2(np.sin(change), np.cos(change)), change)
