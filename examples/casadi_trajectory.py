"""Redundancy resolution by nonlinear programming: small joint rates, away from singularities.

    python examples/casadi_trajectory.py

The platform of the 3-[R(RR-RRR)SR] robot tilts by 80 degrees about y' (the first motion of Section 1.8) in
4 seconds.  The three redundant angles start at 97 degrees and are free to move: IPOPT chooses them so that
the integral of the squared joint rates is smallest, with both type II margins kept above 0.5 and |beta_dot|
below 60 deg/s.  The same motion with constant angles, as in the thesis, is the comparison.  Needs CasADi.
"""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca
import numpy as np

import krhpr

ROBOT = krhpr.load("spatial_r_fivebar_a")
MODE = "front/elbow-/rod-"
SIGNS = ROBOT.mode_signs(MODE)  # CasADi takes a mode as signs

DURATION, KNOTS = 4.0, 31
P = np.array([0.0, 0.0, 0.35])
START = np.radians(97.0)
BOX = np.radians([35.0, 145.0])
FASTEST = np.radians(60.0)
SMALLEST_MARGIN = 0.5


@dataclass(frozen=True)
class Motion:
    """The platform's motion at the knots."""

    time: np.ndarray
    Q: np.ndarray
    twist: np.ndarray


def tilting() -> Motion:
    """A tilt of 80 degrees about y', (1.46), at rest at both ends."""
    time = np.linspace(0.0, DURATION, KNOTS)
    u = time / DURATION
    angle = np.radians(80.0) * (10 * u**3 - 15 * u**4 + 6 * u**5)
    rate = np.radians(80.0) * 30 * u**2 * (1 - u) ** 2 / DURATION
    Q = np.zeros((KNOTS, 3, 3))
    Q[:, 0, 0], Q[:, 0, 2] = np.cos(angle), np.sin(angle)
    Q[:, 2, 0], Q[:, 2, 2] = -np.sin(angle), np.cos(angle)
    Q[:, 1, 1] = 1.0
    twist = np.zeros((KNOTS, 6))
    twist[:, 4] = rate
    return Motion(time, Q, twist)


def optimise(motion: Motion) -> tuple[np.ndarray, np.ndarray, int]:
    """Redundant angles and their rates at the knots, and the iterations that IPOPT took."""
    robot = ROBOT.casadi
    opti = ca.Opti()
    beta, rate = opti.variable(3, KNOTS), opti.variable(3, KNOTS)
    step = DURATION / (KNOTS - 1)
    cost = 0
    for k in range(KNOTS):
        Q = ca.DM(motion.Q[k])
        s = robot.end_points(P, Q, beta[:, k])
        theta = robot.inverse(P, Q, beta[:, k], SIGNS)
        theta_dot = robot.joint_rates(P, Q, s, theta, motion.twist[k], rate[:, k])
        margins = robot.singularity(P, Q, s, theta)[3]
        weight = step * (0.5 if k in (0, KNOTS - 1) else 1.0)
        cost += weight * (ca.sumsqr(theta_dot) + 1e-3 * ca.sumsqr(rate[:, k]))
        opti.subject_to(margins >= SMALLEST_MARGIN)
        if k:
            opti.subject_to(beta[:, k] - beta[:, k - 1] == step / 2 * (rate[:, k] + rate[:, k - 1]))
    opti.subject_to(opti.bounded(BOX[0], ca.vec(beta), BOX[1]))
    opti.subject_to(opti.bounded(-FASTEST, ca.vec(rate), FASTEST))
    opti.subject_to(beta[:, 0] == START)
    opti.subject_to(rate[:, 0] == 0)
    opti.subject_to(rate[:, KNOTS - 1] == 0)
    opti.minimize(cost)
    opti.set_initial(beta, START)
    opti.solver("ipopt", {"print_time": False, "expand": True}, {"print_level": 0, "sb": "yes"})
    solution = opti.solve()  # raises where IPOPT does not converge
    return solution.value(beta).T, solution.value(rate).T, solution.stats()["iter_count"]


@dataclass(frozen=True)
class Measure:
    """What a choice of redundant angles costs: computed by the generated functions, not by the optimiser."""

    effort: float
    fastest: float
    margin: float


def measure(motion: Motion, beta: np.ndarray, rate: np.ndarray) -> Measure:
    """Integral of the squared joint rates, the largest joint rate, and the smallest margin."""
    s = ROBOT.end_points(P, motion.Q, beta)
    theta = ROBOT.inverse(P, motion.Q, beta, mode=MODE, check=True)
    theta_dot = ROBOT.joint_rates(P, motion.Q, s, theta, motion.twist, rate)
    margins = ROBOT.singularity(P, motion.Q, s, theta).margins
    squares = (theta_dot**2).sum(axis=(1, 2))
    effort = (squares[1:] + squares[:-1]).sum() / 2 * DURATION / (KNOTS - 1)
    return Measure(float(effort), float(np.abs(theta_dot).max()), float(margins.min()))


def main() -> None:
    motion = tilting()
    beta, rate, iterations = optimise(motion)
    constant = measure(motion, np.full((KNOTS, 3), START), np.zeros((KNOTS, 3)))
    chosen = measure(motion, beta, rate)
    print(f"IPOPT converged in {iterations} iterations ({6 * KNOTS} variables).\n")
    print("                                   beta = 97 deg   chosen beta")
    print(f"integral of |theta_dot|^2 (rad^2/s)   {constant.effort:9.4f}     {chosen.effort:9.4f}")
    print(f"largest |theta_dot| (rad/s)           {constant.fastest:9.4f}     {chosen.fastest:9.4f}")
    print(f"smallest type II margin               {constant.margin:9.4f}     {chosen.margin:9.4f}\n")
    print("time (s)   beta_1   beta_2   beta_3 (degrees)")
    for k in range(0, KNOTS, 5):
        print(f"{motion.time[k]:8.2f} " + " ".join(f"{value:8.2f}" for value in np.degrees(beta[k])))


if __name__ == "__main__":
    main()
