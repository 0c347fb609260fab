"""The linear programmes of a grip: contact forces within friction and the actuators' limits that balance
loads.

Friction cones are exact in the plane.  In space each is a pyramid inside the cone, so that what is found
holds for the cone, with up to 1 - cos(pi / facets) of the friction given away.

Forces are counted in a force of the problem's own size and rows are scaled to length one, so that the
solver's tolerances, 1e-10, are relative.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from krhpr.capability.answer import Extreme, Limit, LimitKind
from krhpr.capability.grip import Grip
from krhpr.errors import KrhprError

Floats = NDArray[np.float64]

TOLERANCE = 1e-10
"""The solver's, the closest that HiGHS takes."""
NOTHING = 1e-7
"""Multipliers below this share of the largest are roundings."""
FAR = 1e3
"""Actuators so much stronger than the loads do not set the problem's size."""

OPTIMAL, INFEASIBLE, UNBOUNDED, DIFFICULT = 0, 2, 3, 4
"""Results of scipy.optimize.linprog."""


@dataclass(frozen=True)
class Bounds:
    """What limits a grip."""

    actuators: Floats
    """(legs, n), N or N m; infinite where an actuator has no limit."""
    friction: Floats
    """(contacts,)"""
    facets: int


class Programme:
    """The grip of one pose with its limits and loads."""

    def __init__(self, grip: Grip, bounds: Bounds, load: Floats) -> None:
        self.grip, self.load = grip, load
        self.size = grip.balance.shape[-1]
        rows, right, self.limits = _friction(grip, bounds)
        strong, most, names = _actuators(grip, bounds)
        self.unit = _unit(most, load[: grip.dimension], load[grip.dimension :], self.length)
        self.rows = np.vstack([rows, strong])
        self.right = np.concatenate([right, most / self.unit])
        self.limits += names

    @cached_property
    def length(self) -> float:
        """The longest arm of a contact, by which moments are divided."""
        found = float(np.abs(self.grip.balance[self.grip.dimension :]).max())
        return found if found > 0 else 1.0

    @property
    def normals(self) -> range:
        """The places of the normal forces."""
        return range(0, self.size, self.grip.dimension)

    def shortage(self) -> tuple[float, tuple[Limit, ...]]:
        """By how much every limit would have to be wider for loads that are not held, and limits that
        contradict one another; infinite and none where no forces balance the loads.
        """
        widened = np.full(len(self.rows), -1.0)
        objective = np.append(np.zeros(self.size), 1.0)
        found = self._solve(objective, widened, least=0.0)
        if found.status != OPTIMAL:
            return float("inf"), ()
        return self.unit * float(found.x[-1]), self._active(found)

    def least_grasp(self) -> Extreme | None:
        """Where the smallest normal force is least; None where nothing holds the loads."""
        best = None
        for place in self.normals:
            objective = np.zeros(self.size + 1)
            objective[place] = 1.0
            found = self._solve(objective, np.zeros(len(self.rows)), least=0.0, most=0.0)
            if found.status == INFEASIBLE:
                return None
            if best is None or found.fun < best.fun:
                best = found
        assert best is not None
        return self._extreme(best, self.unit * float(best.fun))

    def most_grasp(self) -> Extreme | None:
        """Where the smallest normal force is largest."""
        objective = np.append(np.zeros(self.size), -1.0)
        below = np.zeros((self.grip.contacts, self.size + 1))
        below[range(len(below)), self.normals] = -1.0
        below[:, -1] = 1.0
        found = self._solve(objective, np.zeros(len(self.rows)), more=below)
        if found.status == INFEASIBLE:
            return None
        if found.status == UNBOUNDED:
            return self._without_end()
        return self._extreme(found, -self.unit * float(found.fun))

    def scale(self, disturbance: Floats, sign: float) -> Extreme | None:
        """The largest (sign 1) or least (sign -1) factor of the disturbance that is resisted; None where none
        is."""
        force, moment = disturbance[: self.grip.dimension], disturbance[self.grip.dimension :]
        size = max(np.linalg.norm(force), np.linalg.norm(moment) / self.length)
        objective = np.append(np.zeros(self.size), -sign)
        found = self._solve(objective, np.zeros(len(self.rows)), scaled=disturbance * (self.unit / size))
        if found.status == INFEASIBLE:
            return None
        if found.status == UNBOUNDED:
            return self._without_end(sign)
        return self._extreme(found, float(found.x[-1]) * self.unit / float(size) + 0.0)

    # -- solving --------------------------------------------------------------------------------------------

    def _solve(
        self,
        objective: Floats,
        column: Floats,
        *,
        scaled: Floats | None = None,
        more: Floats | None = None,
        least: float | None = None,
        most: float | None = None,
    ) -> Any:
        """Minimise over the contact forces and one more variable, which stands in the limits with `column`
        and in the balance with the disturbance `scaled`.
        """
        from scipy.optimize import linprog

        d = self.grip.dimension
        per_row = np.append(np.ones(d), np.full(len(self.load) - d, 1.0 / self.length))
        balance = self.grip.balance * per_row[:, None]
        extra = np.zeros(len(self.load)) if scaled is None else scaled * per_row / self.unit
        load = self.load * per_row / self.unit
        above, right = np.column_stack([self.rows, column]), self.right
        if more is not None:
            above, right = np.vstack([above, more]), np.append(right, np.zeros(len(more)))
        bounds = [(None, None)] * self.size + [(least, most)]
        for presolve in (True, False):  # presolving does not tell infeasible from unbounded
            found = linprog(
                objective,
                above,
                right,
                np.column_stack([balance, extra]),
                -load,
                bounds,
                method="highs",
                options={
                    "presolve": presolve,
                    "primal_feasibility_tolerance": TOLERANCE,
                    "dual_feasibility_tolerance": TOLERANCE,
                },
            )
            if found.status in (OPTIMAL, INFEASIBLE, UNBOUNDED):
                return found
        raise KrhprError(f"the linear programme of the grasp was not solved: {found.message}")

    def _active(self, found: Any) -> tuple[Limit, ...]:
        """The limits with multipliers."""
        weights = np.abs(found.ineqlin.marginals[: len(self.limits)])
        if not weights.size or weights.max() == 0:
            return ()
        places = np.flatnonzero(weights > NOTHING * weights.max())
        return tuple(sorted({self.limits[place] for place in places}))

    def _extreme(self, found: Any, value: float) -> Extreme:
        forces = self.unit * found.x[: self.size]
        return Extreme(
            value,
            forces.reshape(self.grip.contacts, self.grip.dimension),
            self.grip.actuators @ forces,
            self._active(found),
        )

    def _without_end(self, sign: float = 1.0) -> Extreme:
        nowhere = np.full((self.grip.contacts, self.grip.dimension), np.nan)
        return Extreme(sign * float("inf"), nowhere, np.full(self.grip.actuators.shape[:-1], np.nan), ())


def _friction(grip: Grip, bounds: Bounds) -> tuple[Floats, Floats, list[Limit]]:
    """Rows of contacts that slip, and of jaws that would pull."""
    d, rows, limits = grip.dimension, [], []
    if d == 2:
        sides, inside = np.array([[1.0], [-1.0]]), 1.0
    else:
        around = 2 * np.pi * (np.arange(bounds.facets) + 0.5) / bounds.facets
        sides, inside = np.column_stack([np.cos(around), np.sin(around)]), np.cos(np.pi / bounds.facets)
    for contact, friction in enumerate(bounds.friction):
        first = d * contact
        for side in sides:
            row = np.zeros(grip.balance.shape[-1])
            row[first] = -friction * inside
            row[first + 1 : first + d] = side
            rows.append(row / np.linalg.norm(row))
            limits.append(Limit(LimitKind.FRICTION, (contact,)))
        row = np.zeros(grip.balance.shape[-1])
        row[first] = -1.0
        rows.append(row)
        limits.append(Limit(LimitKind.CONTACT, (contact,)))
    return np.array(rows), np.zeros(len(rows)), limits


def _actuators(grip: Grip, bounds: Bounds) -> tuple[Floats, Floats, list[Limit]]:
    """Rows of actuators, both ways; those that do nothing for the contacts cannot be in the way."""
    rows, right, limits = [], [], []
    largest = np.abs(grip.actuators).max()
    for index in np.ndindex(bounds.actuators.shape):
        row, most = grip.actuators[index], bounds.actuators[index]
        norm = np.linalg.norm(row)
        if np.isinf(most) or norm <= 1e-12 * largest:
            continue
        for side in (1.0, -1.0):
            rows.append(side * row / norm)
            right.append(most / norm)
            limits.append(Limit(LimitKind.ACTUATOR, index))
    return np.array(rows).reshape(-1, grip.balance.shape[-1]), np.array(right), limits


def _unit(limits: Floats, force: Floats, moment: Floats, length: float) -> float:
    """A force of the problem's size."""
    some = limits[limits > 0]
    strength = float(some.min()) if some.size else 0.0
    load = max(float(np.linalg.norm(force)), float(np.linalg.norm(moment)) / length)
    if strength > 0 and load > 0:
        return min(strength, FAR * load)
    return strength or load or 1.0
