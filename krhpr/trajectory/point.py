"""What an optimiser sees of the robot at one time: the integrand, and quantities with limits, as CasADi
functions.

Everything is made of the robot's generated CasADi functions, so that derivatives are exact.  Local variables
`z` are the redundant coordinates, their rates, where accelerations are limited their second rates, and a
vector for each pair of links to be kept apart.  Parameters `q` are the pose, the twist, its rate where
needed, and full turns of the actuated joints.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from krhpr.errors import TrajectoryError
from krhpr.robot import Robot
from krhpr.trajectory.clearance import Pair
from krhpr.trajectory.compiled import Evaluation, compiled
from krhpr.trajectory.paths import Motion
from krhpr.trajectory.terms import PLATFORM_JOINT, SMOOTH, Bounds, Objective
from krhpr.trajectory.worth import per_length

Floats = NDArray[np.float64]


class NoClosedForm(TrajectoryError):
    """A robot whose inverse kinematics has no closed form, and thus no CasADi function."""


@dataclass(frozen=True)
class Quantity:
    """Something with limits at each time; in the NLP it is divided by `scale`."""

    name: str
    unit: str
    low: float = -np.inf
    high: float = np.inf
    scale: float = 1.0
    leg: int | None = None
    """The leg that it concerns alone (0 to 2)."""
    order: int = 0
    """Of the highest rate that it depends on: slowed by a factor, it falls by the factor to this power."""
    of_pair: bool = False
    """Whether it keeps two links apart."""
    peak: bool = False
    """Whether it says no more than that a largest value is one."""

    @property
    def inner(self) -> bool:
        """Whether it is for the programme alone, and no limit that has been asked for by itself."""
        return self.of_pair or self.peak

    @property
    def moving(self) -> bool:
        """Whether it depends on rates."""
        return self.order > 0


@dataclass(frozen=True)
class _Here:
    """The robot at one time, as symbols."""

    f: Any
    """Its CasADi functions."""
    at: tuple[Any, Any, Any, Any]
    """p, Q, s, theta."""
    redundant: Any
    theta: Any
    """With full turns."""
    twist: Any
    twist_rate: Any


class PointFunctions:
    """Integrand and quantities of a robot at one time, with an objective and limits."""

    def __init__(
        self,
        robot: Robot,
        objective: Objective,
        bounds: Bounds,
        signs: Floats,
        *,
        mode: Any = None,
        characteristic_length: float = 1.0,
        pairs: tuple[Pair, ...] = (),
        evaluation: Evaluation = Evaluation.SX,
    ) -> None:
        """`signs` (3, factors) are those of the factors of det M_i that are to be kept."""
        if "inverse" not in robot.casadi.names:
            raise NoClosedForm(
                f"{robot.name}: its inverse kinematics has no closed form and no CasADi function; "
                "trajectories of such robots cannot be optimised"
            )
        self.robot, self.objective, self.bounds, self.signs = robot, objective, bounds, signs
        self.mode, self.length, self.pairs = robot.mode_signs(mode), characteristic_length, pairs
        self.evaluation = evaluation
        self.accelerated = bounds.actuator_acceleration is not None
        self.planar = robot.planar
        self.actuators = robot.signature("inverse").outputs[0].labels
        self.order = 3 if self.accelerated else 2
        """Coordinates and how many of their rates are local variables."""
        self.width = 3 if bounds.swivel is None else 6
        """Coordinates that are chosen: redundant ones, and swivels of redundant sub-legs."""

    def with_pairs(self, pairs: tuple[Pair, ...]) -> Self:
        """The same with other pairs of links to keep apart."""
        return type(self)(
            self.robot,
            self.objective,
            self.bounds,
            self.signs,
            mode=self.mode,
            characteristic_length=self.length,
            pairs=pairs,
            evaluation=self.evaluation,
        )

    @property
    def own(self) -> int:
        """Local variables without those of pairs: coordinates and their rates, then largest values."""
        return self.width * self.order + len(self.objective.largest)

    @property
    def size(self) -> int:
        """Local variables."""
        return self.own + 3 * len(self.pairs)

    @cached_property
    def box(self) -> tuple[Floats, Floats]:
        """Least and largest coordinates (width)."""
        sides = [*self.bounds.box()]
        for side, swivel in enumerate(self.bounds.swivel or ()):
            sides[side] = np.concatenate(
                [sides[side], np.broadcast_to(np.asarray(swivel, dtype=float), (3,))]
            )
        return sides[0], sides[1]

    def coordinates(self, redundant: Floats, share: float | None = None) -> Floats:
        """Coordinates (..., width) with redundant ones (..., 3); swivels are at a share of what they may be,
        or as near to zero as they may be."""
        if self.width == 3:
            return redundant
        low, high = (side[3:] for side in self.box)
        swivel = np.clip(0.0, low, high) if share is None else low + share * (high - low)
        return np.concatenate([redundant, np.broadcast_to(swivel, redundant.shape)], axis=-1)

    def inverse(self, p: Floats, Q: Floats, coordinates: Floats) -> Floats:
        """theta (..., 3, n) in the working mode."""
        swivel = coordinates[..., 3:] if self.width == 6 else None
        return np.asarray(
            self.robot.inverse(p, Q, coordinates[..., :3], mode=self.mode, swivel=swivel), dtype=float
        )

    def parameters(self, motion: Motion, turns: Floats) -> Floats:
        """q (count, ...) at the times of a motion; `turns` (count, 3, n) are added to the actuated joints."""
        count = len(motion.times)
        pose = motion.Q[:, None] if self.planar else np.swapaxes(motion.Q, 1, 2).reshape(count, 9)
        parts = [motion.p, pose, motion.twist, turns.reshape(count, -1)]
        return np.column_stack([*parts, motion.twist_rate] if self.accelerated else parts)

    @cached_property
    def quantities(self) -> tuple[Quantity, ...]:
        """What the second output of `function` gives."""
        return tuple(quantity for quantity, _ in self._made[1])

    @cached_property
    def function(self) -> Any:
        """(z, q) -> (integrand, quantities over their scales)."""
        import casadi as ca

        z, q = self._symbols
        integrand, rows = self._made
        scaled = [value / quantity.scale for quantity, value in rows]
        return ca.Function("point", [z, q], [integrand, ca.vertcat(*scaled)], ["z", "q"], ["f", "g"])

    @cached_property
    def functions(self) -> dict[str, Any]:
        """What a programme is made of, each by itself so that nothing is computed in vain:

        `integrand` and `limited` (z, q) -> the outputs of `function`; `gradient` and `jacobian` (z, q) ->
        their dense derivatives by z; `curvature` (z, q, weight, multipliers) -> the dense Hessian of weight
        times the integrand plus multipliers times the quantities.
        """
        import casadi as ca

        z, q = self._symbols
        f, g = self.function(z, q)
        weight, multipliers = ca.SX.sym("weight"), ca.SX.sym("multipliers", g.numel())
        hessian, _ = ca.hessian(weight * f + ca.dot(multipliers, g), z)
        made = {
            "integrand": ca.Function("integrand", [z, q], [f]),
            "limited": ca.Function("limited", [z, q], [g]),
            "gradient": ca.Function("gradient", [z, q], [ca.densify(ca.gradient(f, z))]),
            "jacobian": ca.Function("slopes", [z, q], [ca.densify(ca.jacobian(g, z))]),
            "curvature": ca.Function("curvature", [z, q, weight, multipliers], [ca.densify(hessian)]),
        }
        return compiled(made) if self.evaluation is Evaluation.COMPILED else made

    # -- how they are made ----------------------------------------------------------------------------------

    @cached_property
    def _symbols(self) -> tuple[Any, Any]:
        import casadi as ca

        d, freedom = (2, 3) if self.planar else (3, 6)
        count = d + (1 if self.planar else 9) + freedom + 3 * len(self.actuators)
        return ca.SX.sym("z", self.size), ca.SX.sym("q", count + (freedom if self.accelerated else 0))

    @cached_property
    def _made(self) -> tuple[Any, list[tuple[Quantity, Any]]]:

        z, _ = self._symbols
        here, rates, w = self._here, z[self.width : 2 * self.width], self.width
        theta_dot = here.f.joint_rates(*here.at, here.twist, *self._parts(rates))
        integrand, peaks = self._integrand(here, rates, theta_dot)
        rows = self._of_posture(here)
        if (most := self.bounds.redundant_rate) is not None:
            rows += self._of_redundant(rates, -most, most, most)
        if (most := self.bounds.swivel_rate) is not None and w == 6:
            rows += self._of_swivels(rates[3:], -most, most, most)
        rows += self._of_actuators(theta_dot, "rate", self.bounds.actuator_rate, "/s")
        if self.accelerated:
            bend = self._parts(z[2 * w : 3 * w])
            moving = (here.twist, rates[:3], theta_dot, here.twist_rate, *bend)
            theta_ddot = here.f.joint_accelerations(*here.at, *moving)
            rows += self._of_actuators(
                theta_ddot, "acceleration", self.bounds.actuator_acceleration, "/s^2", 2
            )
        for k, (name, term) in enumerate(peaks.items()):
            what = Quantity(f"{name} above its largest value", "m^2 or 1", high=0.0, peak=True)
            rows.append((what, term - z[w * self.order + k]))
        return integrand, rows + self._of_pairs(here, z)

    @cached_property
    def _here(self) -> _Here:
        """The robot at the symbols' pose and redundant coordinates."""
        import casadi as ca

        z, q = self._symbols
        f, d, freedom = self.robot.casadi, 2 if self.planar else 3, 3 if self.planar else 6
        sizes = [d, 1 if self.planar else 9, freedom, 3 * len(self.actuators)]
        p, pose, twist, turns, twist_rate = ca.vertsplit(q, [0, *np.cumsum(sizes).tolist(), q.numel()])
        Q = pose if self.planar else ca.reshape(pose, 3, 3)
        redundant = z[:3]
        s = f.end_points(p, Q, redundant)
        given = [redundant, *([self.mode] if "mode" in f.inverse.name_in() else [])]
        theta = f.inverse(p, Q, *given, *self._parts(z[: self.width])[1:])
        unwrapped = theta + ca.reshape(turns, len(self.actuators), 3).T
        return _Here(f, (p, Q, s, theta), redundant, unwrapped, twist, twist_rate)

    def _parts(self, coordinates: Any) -> tuple[Any, ...]:
        """Redundant coordinates, and for redundant sub-legs swivels, or rates of both."""
        import casadi as ca

        if not self.robot.redundant_legs:
            return (coordinates,)
        return coordinates[:3], coordinates[3:] if self.width == 6 else ca.DM.zeros(3)

    def _integrand(self, here: _Here, rates: Any, theta_dot: Any) -> tuple[Any, dict[str, Any]]:
        """The objective's integrand, and what is to have a small largest value."""
        import casadi as ca

        objective, total = self.objective, self.objective.rates * ca.sumsqr(rates)
        length = [self.length] if "characteristic_length" in here.f.index_bounds.name_in() else []
        eta_1, eta_2, eta_3 = here.f.index_bounds(*here.at, *length)
        total += objective.value(eta_1, eta_2, eta_3, ca.log)
        scale = ca.repmat(ca.DM(per_length(self.robot, self.length)).T, 3, 1)
        if objective.load is not None:
            swivel = [ca.DM.zeros(3)] if "swivel_forces" in here.f.inverse_statics.name_in() else []
            load = (ca.DM(objective.load.wrench), ca.DM(objective.load.redundant_forces), *swivel)
            total += objective.torques * ca.sumsqr(here.f.inverse_statics(*here.at, *load) / scale)
        if objective.travel:
            total += objective.travel * ca.sum1(ca.vec(ca.sqrt((scale * theta_dot) ** 2 + SMOOTH**2)))
        if objective.joint_rates:
            total += objective.joint_rates * ca.sumsqr(scale * theta_dot)
        return total, objective.peaks(eta_1, eta_2, eta_3, ca.log)

    def _of_posture(self, here: _Here) -> list[tuple[Quantity, Any]]:
        """Quantities that do not depend on rates."""
        rows = self._of_singularity(here.f.singularity(*here.at))
        rows += self._of_joints(here.theta)
        return rows + self._of_passive(here.at) + self._of_grip(here.redundant)

    def _of_grip(self, redundant: Any) -> list[tuple[Quantity, Any]]:
        """Where the object's centre is; that the opening stays is for the programme, as it is linear."""
        import casadi as ca

        grip = self.bounds.grip
        if grip is None or grip.play is None:
            return []
        _, centre, _ = self.robot.casadi.opening(redundant, np.broadcast_to(grip.jaws, 3))
        name = "squared distance of the object's centre from O'"
        most = grip.play**2
        return [(Quantity(name, "m^2", high=most, scale=max(most, 1e-6)), ca.sumsqr(centre))]

    def _of_singularity(self, found: Any) -> list[tuple[Quantity, Any]]:
        _, factors, _, margins = found
        ports = {port.name: port.labels for port in self.robot.signature("singularity").outputs}
        rows = [
            (Quantity(f"margin of {label}", "1", low), margins[k])
            for k, (label, low) in enumerate(zip(ports["margins"], self.bounds.margins, strict=False))
        ]
        for name, low in self.bounds.factors.items():
            k = ports["factors"].index(name)
            for leg in range(3):
                value = float(self.signs[leg, k]) * factors[leg, k]
                rows.append((Quantity(f"factor {name} of leg {leg + 1}", "1", low, leg=leg), value))
        return rows

    def _of_joints(self, theta: Any) -> list[tuple[Quantity, Any]]:
        limits, rows = self.robot.limits, []
        for k, name in enumerate(self.actuators):
            for leg in range(3) if name in limits.actuators else ():
                low, high = limits.actuators[name][leg].low, limits.actuators[name][leg].high
                unit = self._unit(k)
                rows.append((Quantity(f"{name} of leg {leg + 1}", unit, low, high, leg=leg), theta[leg, k]))
        return rows

    def _of_redundant(self, rates: Any, low: float, high: float, scale: float) -> list[tuple[Quantity, Any]]:
        """Rates of redundant coordinates, or their squares."""
        unit = self.robot.signature("end_points").inputs[2].unit
        return [
            (
                Quantity(f"redundant rate of leg {leg + 1}", f"{unit}/s", low, high, scale, leg, 1),
                rates[leg],
            )
            for leg in range(3)
        ]

    def _of_swivels(self, rates: Any, low: float, high: float, scale: float) -> list[tuple[Quantity, Any]]:
        """Rates of swivels, or their squares."""
        return [
            (Quantity(f"rate of the swivel of leg {leg + 1}", "rad/s", low, high, scale, leg, 1), rates[leg])
            for leg in range(3)
        ]

    def _unit(self, actuator: int) -> str:
        return "rad" if self.robot.angular[actuator] else "m"

    def _of_actuators(
        self, value: Any, what: str, most: float | None, unit: str, order: int = 1
    ) -> list[Any]:
        if most is None:
            return []
        return [
            (
                Quantity(
                    f"{what} of {name}, leg {leg + 1}",
                    f"{self._unit(k)}{unit}",
                    -most,
                    most,
                    most,
                    leg,
                    order,
                ),
                value[leg, k],
            )
            for leg in range(3)
            for k, name in enumerate(self.actuators)
        ]

    def _of_passive(self, at: tuple[Any, ...]) -> list[tuple[Quantity, Any]]:
        """Passive joints that the robot's file limits, and spherical ones."""
        import casadi as ca

        limits = self.robot.limits
        named = [name for name in limits.passive if name != PLATFORM_JOINT]
        cones = self._cones()
        if not named and not any(cones):
            return []
        function = self.robot.casadi.passive_joints
        found = dict(zip(function.name_out(), function(*at), strict=True))
        labels = {port.name: port.labels for port in self.robot.signature("passive_joints").outputs}
        kinds = dict(self.robot.documentation["joint kinds"])
        rows = []
        for name in named:
            port = "passive" if name in labels.get("passive", ()) else name
            turns = kinds[name] == "revolute" if port == "passive" else True
            for leg, interval in enumerate(limits.passive[name]):
                value = found[port][leg, labels[port].index(name)] if port == "passive" else found[port][leg]
                low, high = interval.low, interval.high
                if turns and high - low >= 2 * np.pi:
                    continue
                if turns:  # the interval may reach beyond +-pi
                    middle = (low + high) / 2
                    value = middle + ca.atan2(ca.sin(value - middle), ca.cos(value - middle))
                unit = "rad" if turns else "m"
                rows.append((Quantity(f"{name} of leg {leg + 1}", unit, low, high, leg=leg), value))
        for leg, of_leg in enumerate(cones):
            for tilt, socket, stud in of_leg:
                cosine = ca.dot(ca.DM(socket), found[f"spherical{leg + 1}"] @ ca.DM(stud))
                what = f"cosine of the spherical joint's angle, leg {leg + 1}"
                rows.append((Quantity(what, "1", float(np.cos(tilt)), leg=leg), cosine))
        return rows

    def _cones(self) -> list[list[tuple[float, Any, Any]]]:
        """For each leg the limits of its spherical joint: tilt, socket, stud."""
        cones: list[list[tuple[float, Any, Any]]] = [[], [], []]
        if self.bounds.cone is not None:
            for cone in cones:
                cone.append((self.bounds.cone, (1.0, 0.0, 0.0), (1.0, 0.0, 0.0)))
        for leg, limit in enumerate(self.robot.limits.spherical or ()):
            cones[leg].append((limit.tilt, limit.socket, limit.stud))
        return cones

    def _of_pairs(self, here: _Here, z: Any) -> list[Any]:
        """An exact and smooth form: a vector n of length one or less with n (x - y) above the distance."""
        import casadi as ca

        if not self.pairs:
            return []
        points, rows = here.f.link_points(*here.at), []
        for index, pair in enumerate(self.pairs):
            start = self.own + 3 * index
            n = z[start : start + 3]
            rows.append((Quantity(f"separator of {pair.name}", "1", high=1.0, of_pair=True), ca.sumsqr(n)))
            ends = [[link.end_of(points, end) for end in (0, 1)] for link in (pair.first, pair.second)]
            rows += [
                (
                    Quantity(f"distance of {pair.name}", "m", low=pair.least, scale=0.1, of_pair=True),
                    ca.dot(n, x - y),
                )
                for x in ends[0]
                for y in ends[1]
            ]
        return rows
