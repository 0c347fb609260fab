"""The redundant angles of Section 4.3: which are best at each pose, and along trajectories.

For the 3-RRRSR robot and the thesis' two motions, a translation along x and a tilt about y': the equal angle
in whole degrees with the least index at every pose (Fig. 4.3), the two minima of eta_1 between which the
global one changes (Fig. 4.4a), what methods one and two make of that (Fig. 4.4b), and how all methods compare
with the nonlinear programme, whose angles need not be equal.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

import krhpr
from krhpr.study.claims import Claim
from krhpr.trajectory import Lines, Method, Path, Trajectory, chapter_4, optimise, tilt, translation
from krhpr.trajectory.baselines import REDUCED, smoothed

Floats = NDArray[np.float64]

ROBOT = "spatial_rrr_a"
DEGREES = np.arange(55, 176)
"""The angles that the thesis tries."""
INDICES = ("eta_1", "eta_2", "eta_3")
SHOWN = (0.22, 0.24, 0.26, 0.28, 0.294, 0.3)
"""Places x (m) at which eta_1 is shown over beta, as in Fig. 4.4a."""
FACTORS = (0.05, 0.1, 0.2, 0.5)
"""Smoothing factors alpha of method two."""
OBJECTIVES = ("eta_1", "eta_2")
METHODS = (Method.CONSTANT, Method.SCAN, Method.ONE, Method.TWO, Method.NLP)
FALL = 10.0
"""A change of the best angle (degrees) from a pose to the next that counts as a rapid one."""


@dataclass(frozen=True)
class Sweep:
    """Indices over equal angles along one of the two motions."""

    place: Floats
    """x (m), or the tilt (rad) (n)."""
    indices: dict[str, Floats]
    """By name, over `DEGREES` (n, 121); eta_1 in metres."""

    def best(self, index: str) -> Floats:
        """The angle with the least index at each place (n), degrees."""
        return np.asarray(DEGREES[self.indices[index].argmin(axis=1)], dtype=float)

    def minima(self, index: str, place: float) -> list[int]:
        """Angles (degrees) of all local minima at the place nearest to the one given."""
        row = self.indices[index][int(np.abs(self.place - place).argmin())]
        around = np.concatenate([[np.inf], row, [np.inf]])
        return [int(x) for x in DEGREES[(row <= around[:-2]) & (row < around[2:])]]


@dataclass(frozen=True)
class Redundancy:
    """What the study found."""

    translation: Sweep
    """x from 0 to 300 mm in steps of 1 mm."""
    tilt: Sweep
    """From 0 to 80 degrees in steps of half a degree."""
    compared: dict[tuple[str, str], dict[Method, Trajectory]]
    """By trajectory (T1, T2) and objective: what each method makes of it, limits of Chapter 4."""

    @cached_property
    def filtered(self) -> dict[str, Floats]:
        """The best angle for eta_1 along x (degrees), and what the thesis' methods make of it."""
        found, sweep = {"least eta_1": self.translation.best("eta_1")}, self.translation
        low, high = np.degrees(REDUCED)
        inside = (low <= DEGREES) & (high >= DEGREES)
        reduced = np.where(inside, sweep.indices["eta_1"], np.inf)
        found["method one"] = np.asarray(DEGREES[reduced.argmin(axis=1)], dtype=float)
        best = np.repeat(found["least eta_1"][:, None], 3, axis=1)
        for factor in FACTORS:
            values = smoothed(Lines(sweep.place, best), factor).values[:, 0]
            found[f"method two, alpha {factor:g}"] = values
        return found

    def fall(self) -> tuple[float, float, float]:
        """Where along x (m) the best angle for eta_1 falls the most, and from which to which (degrees)."""
        best = self.translation.best("eta_1")
        k = int(np.argmin(np.diff(best)))
        return float(self.translation.place[k + 1]), float(best[k]), float(best[k + 1])

    def claims(self) -> tuple[Claim, ...]:
        """What Section 4.3 says, as far as it can be told, and what the programme is for."""
        sweep = self.translation
        place, above, below = self.fall()
        one, two = sweep.minima("eta_1", 0.23), sweep.minima("eta_1", 0.24)
        steps = {name: np.abs(np.diff(values)).max() for name, values in self.filtered.items()}
        after = sweep.place >= place
        reduced = np.abs(np.diff(self.filtered["method one"][after])).max(initial=0.0)
        slow = [steps[f"method two, alpha {factor:g}"] for factor in FACTORS]
        grows = self.tilt.indices["eta_2"][0]
        worse = [
            f"{path} {objective} {method}"
            for (path, objective), found in self.compared.items()
            for method, other in found.items()
            if other.feasible
            and found[Method.NLP].integrals[f"{objective}^2"] > other.integrals[f"{objective}^2"] * (1 + 1e-6)
        ]
        return (
            Claim(
                f"eta_1 has a second minimum once the first is at 146 degrees (x = 230 mm: {_of(one)}; "
                f"240 mm: {_of(two)})",
                len(one) == 1 and len(two) == 2 and two[1] == 146,
            ),
            Claim(
                f"the angle of the least eta_1 then falls rapidly (from {above:g} to {below:g} degrees at "
                f"x = {1000 * place:g} mm)",
                above - below > FALL,
            ),
            Claim("method one does not follow the fall", bool(reduced <= FALL)),
            Claim("method two is the smoother the smaller alpha is", slow == sorted(slow)),
            Claim("eta_2 grows rapidly as beta nears 180 degrees", bool(grows[-1] > 5 * grows.min())),
            Claim(
                "the programme with unequal angles meets all limits",
                all(found[Method.NLP].feasible for found in self.compared.values()),
            ),
            Claim(
                f"and is better than every method that does{f' (not: {worse})' if worse else ''}", not worse
            ),
        )


def _of(angles: list[int]) -> str:
    return " and ".join(str(angle) for angle in angles)


def redundancy(progress: Callable[[str], None] = lambda step: None) -> Redundancy:
    """Run the study; the programmes take a few seconds."""
    robot = krhpr.load(ROBOT)
    paths = {"T1": translation(), "T2": tilt()}
    progress("indices over equal angles")
    sweeps = {
        "T1": _sweep(robot, paths["T1"], np.linspace(0, 0.3, 301)),
        "T2": _sweep(robot, paths["T2"], np.radians(np.linspace(0, 80, 161))),
    }
    compared: dict[tuple[str, str], dict[Method, Trajectory]] = {}
    for name, path in paths.items():
        for objective in OBJECTIVES:
            progress(f"{name}, {objective}")
            compared[name, objective] = {
                method: optimise(robot, path, objective, chapter_4(), method=method) for method in METHODS
            }
    return Redundancy(sweeps["T1"], sweeps["T2"], compared)


def _sweep(robot: krhpr.Robot, path: Path, place: Floats) -> Sweep:
    """Indices at places that are equally spaced along a path, for equal angles."""
    motion = path.at(np.linspace(path.times[0], path.times[-1], len(place)))
    p, Q = motion.p[:, None], motion.Q[:, None]
    equal = np.radians(np.repeat(DEGREES[:, None], 3, axis=1))
    theta = robot.inverse(p, Q, equal)
    found = robot.indices(p, Q, robot.end_points(p, Q, equal), theta)
    return Sweep(place, {name: np.asarray(getattr(found, name)) for name in INDICES})
