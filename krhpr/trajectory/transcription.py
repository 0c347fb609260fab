"""The nonlinear programme of a trajectory: a cubic B-spline of the redundant coordinates, and IPOPT.

Objective and constraints are sums and stacks of one small function of the redundant coordinates and their
rates at each sample, which depend on few of the spline's coefficients.  Its first and second derivatives are
taken once, in CasADi, evaluated at all samples and put in their places by sparse matrices that do not change.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from krhpr.trajectory.clearance import Pair
from krhpr.trajectory.point import PointFunctions

Floats = NDArray[np.float64]

DEGREE = 3
"""Of the spline: redundant coordinates have continuous accelerations."""

WARM = {
    "warm_start_init_point": "yes",
    "mu_init": 1e-6,
    "warm_start_bound_push": 1e-9,
    "warm_start_bound_frac": 1e-9,
    "warm_start_slack_bound_push": 1e-9,
    "warm_start_slack_bound_frac": 1e-9,
    "warm_start_mult_bound_push": 1e-9,
}
"""Options of IPOPT where it starts next to a solution."""


@dataclass(frozen=True)
class Curve:
    """Redundant coordinates as a cubic B-spline over equal intervals of time."""

    knots: Floats
    """With the ends repeated; seconds."""
    coefficients: Floats
    """(intervals + 3, 3), or 6 columns with swivels."""

    def at(self, times: Floats, order: int = 0) -> Floats:
        """Redundant coordinates (n, 3), or their derivatives of an order, at times (n)."""
        from scipy.interpolate import BSpline

        spline = BSpline(self.knots, self.coefficients, DEGREE)
        values = spline(np.clip(times, self.knots[0], self.knots[-1]), nu=order)
        return np.asarray(values, dtype=float)

    @property
    def intervals(self) -> int:
        """Intervals of time."""
        return len(self.coefficients) - DEGREE

    @property
    def start(self) -> float:
        """Where it begins, s."""
        return float(self.knots[0])

    @classmethod
    def near(cls, start: float, end: float, intervals: int, times: Floats, values: Floats) -> Curve:
        """The spline nearest to values (n, 3) at times (n), joined by straight lines between them."""
        knots = uniform_knots(start, end, intervals)
        dense = np.linspace(start, end, 8 * intervals + 1)
        wanted = np.column_stack([np.interp(dense, times, column) for column in values.T])
        fitted, *_ = np.linalg.lstsq(basis(knots, dense), wanted, rcond=None)
        return cls(knots, fitted)


def uniform_knots(start: float, end: float, intervals: int) -> Floats:
    """Knots of a spline that begins and ends in its outer coefficients."""
    inner = np.linspace(start, end, intervals + 1)
    return np.concatenate([[start] * DEGREE, inner, [end] * DEGREE])


def beginning(step: float, value: Floats, rate: Floats, acceleration: Floats) -> Floats:
    """The first three coefficients (3, 3) of a spline over intervals of `step` seconds that begins with a
    value and its derivatives."""
    second = value + step / 3 * rate
    return np.stack([value, second, second + 2 * step / 3 * (rate + step / 2 * acceleration)])


def basis(knots: Floats, times: Floats, order: int = 0) -> Floats:
    """Derivatives of an order of every basis function (times, coefficients)."""
    from scipy.interpolate import BSpline

    count = len(knots) - DEGREE - 1
    return np.asarray(BSpline(knots, np.eye(count), DEGREE)(times, nu=order), dtype=float)


@dataclass(frozen=True)
class Solved:
    """What the solver found."""

    curve: Curve
    separators: Floats
    """Vectors of pairs of links (samples, pairs, 3)."""
    converged: bool
    message: str
    iterations: int
    state: tuple[Any, Any, Any]
    """Variables and multipliers, from which the next solution starts."""
    pairs: tuple[Pair, ...]
    """Pairs of links that were kept apart."""
    tighter: Floats
    """By how much quantities had to be inside their limits (samples, quantities)."""


class Programme:
    """The NLP of a robot's point functions over samples of a path."""

    def __init__(
        self,
        point: PointFunctions,
        knots: Floats,
        times: Floats,
        options: Mapping[str, Any],
    ) -> None:
        import casadi as ca

        self.point, self.knots, self.times = point, knots, times
        count = len(times)
        coefficients = len(knots) - DEGREE - 1
        self._main = point.width * coefficients
        self._with_pairs = self._main + 3 * len(point.pairs) * count
        size = self._with_pairs + self._further()
        places = self._places(size)
        X, Q, weights = (
            ca.MX.sym("x", size),
            ca.MX.sym("q", point.function.size1_in(1), count),
            ca.MX.sym("w", count),
        )
        p = ca.vertcat(ca.vec(Q), weights)
        Z = ca.reshape(places @ X, point.size, count)
        of = {name: function.map(count) for name, function in point.functions.items()}
        rows, columns = point.functions["limited"].size1_out(0), point.size
        held, self._held_values = self._held(size)
        more, more_slopes, more_curvature = self._more(X)
        value = ca.dot(weights, ca.vec(of["integrand"](Z, Q))) + more
        gradient = places.T @ ca.vec(of["gradient"](Z, Q) @ ca.diag(weights)) + more_slopes
        constraints = ca.vertcat(ca.vec(of["limited"](Z, Q)), held @ X)
        blocks = ca.diagcat(*[ca.Sparsity.dense(rows, columns)] * count)
        slopes = ca.MX(blocks, ca.vec(of["jacobian"](Z, Q)))
        jacobian = ca.vertcat(ca.mtimes(slopes, places), held)
        weight, multipliers = ca.MX.sym("weight"), ca.MX.sym("multipliers", constraints.numel())
        of_points = ca.reshape(multipliers[: rows * count], rows, count)
        bent = of["curvature"](Z, Q, weight * weights.T, of_points)
        squares = ca.diagcat(*[ca.Sparsity.dense(columns, columns)] * count)
        hessian = ca.mtimes([places.T, ca.MX(squares, ca.vec(bent)), places]) + weight * more_curvature
        given = {
            "grad_f": ca.Function("grad_f", [X, p], [value, gradient], ["x", "p"], ["f", "grad:f:x"]),
            "jac_g": ca.Function("jac_g", [X, p], [constraints, jacobian], ["x", "p"], ["g", "jac:g:x"]),
            "hess_lag": ca.Function(
                "hess_lag",
                [X, p, weight, multipliers],
                [ca.triu(hessian)],
                ["x", "p", "lam:f", "lam:g"],
                ["triu:hess:gamma:x:x"],
            ),
        }
        quiet = {"print_level": 0, "sb": "yes", **options}
        self._nlp, self._count = {"x": X, "p": p, "f": value, "g": constraints}, count
        self._options: dict[bool, dict[str, Any]] = {
            next_to: {
                "ipopt": {**quiet, **(WARM if next_to else {})},
                "print_time": False,
                "show_eval_warnings": False,
                "no_nlp_grad": True,
                "calc_lam_p": False,
                **given,
            }
            for next_to in (False, True)
        }
        self._solvers: dict[bool, Any] = {}
        self.peaks = np.zeros(self._further())
        """Where largest values begin."""

    def _further(self) -> int:
        """How many variables there are beside coefficients and vectors of pairs: here, largest values."""
        return len(self.point.objective.largest)

    def _more(self, X: Any) -> tuple[Any, Any, Any]:
        """What the objective has beside the integral, with its gradient and its Hessian."""
        import casadi as ca

        objective = self.point.objective
        weights = ca.DM([getattr(objective, name) for name in objective.largest])
        slopes = ca.vertcat(ca.DM(self._with_pairs, 1), weights) if objective.largest else ca.DM(X.numel(), 1)
        return ca.dot(slopes, X), ca.MX(slopes), ca.MX(X.numel(), X.numel())

    def _entries(self) -> tuple[list[int], list[int], list[float]]:
        """Rows, columns and values of the matrix from the programme's variables to those of every sample."""
        point, count = self.point, len(self.times)
        rows: list[int] = []
        columns: list[int] = []
        values: list[float] = []
        for order in range(point.order):
            table = basis(self.knots, self.times, order)
            for k, j in zip(*np.nonzero(table), strict=True):
                for one in range(point.width):
                    rows.append(int(k) * point.size + point.width * order + one)
                    columns.append(point.width * int(j) + one)
                    values.append(float(table[k, j]))
        extra = 3 * len(point.pairs)
        for k in range(count):
            for i in range(extra):
                rows.append(k * point.size + point.own + i)
                columns.append(self._main + k * extra + i)
                values.append(1.0)
            for i in range(len(point.objective.largest)):
                rows.append(k * point.size + point.width * point.order + i)
                columns.append(self._with_pairs + i)
                values.append(1.0)
        return rows, columns, values

    def _places(self, size: int) -> Any:
        """That matrix."""
        import casadi as ca

        rows, columns, values = self._entries()
        return ca.DM.triplet(rows, columns, ca.DM(values), self.point.size * len(self.times), size)

    def _held(self, size: int) -> tuple[Any, Floats]:
        """Rows of the programme's variables and their values that hold the gripper's opening.

        It is linear in the redundant coordinates: a spline has it at all times where its coefficients have.
        """
        import casadi as ca

        grip = self.point.bounds.grip
        if grip is None:
            return ca.DM(0, size), np.zeros(0)
        row, value = grip.condition(self.point.robot)
        coefficients = self._main // self.point.width
        of_all = np.concatenate([row, np.zeros(self.point.width - 3)])
        rows = ca.kron(ca.DM.eye(coefficients), ca.DM(of_all).T)
        padded = ca.horzcat(rows, ca.DM(coefficients, size - self._main))
        return ca.sparsify(padded), np.full(coefficients, value)

    def fits(self, former: Solved) -> bool:
        """Whether this programme has the variables and quantities of a former solution."""
        sizes = [former.state[0].numel(), former.state[2].numel()]
        return sizes == [self._nlp["x"].numel(), self._nlp["g"].numel()]

    def solve(
        self,
        q: Floats,
        weights: Floats,
        start: Curve,
        separators: Floats,
        tighter: Floats,
        former: Solved | None = None,
        pinned: Floats | None = None,
    ) -> Solved:
        """Solve it.

        Args:
            q: parameters of the point functions (samples, ...).
            weights: of the samples in the integral (samples).
            start: where to begin.
            separators: vectors of pairs to begin with (samples, pairs, 3).
            tighter: by how much quantities must be inside their limits, over their scales (samples,
                quantities).
            former: a solution whose variables and multipliers to start from in place of `start`.
            pinned: coefficients (k, 3) that the spline has to begin with; the first sample, where nothing is
                left to choose, is not limited then.
        """
        low, high = self.limits(tighter)
        box = self.point.box
        further, least, most = self._beginning(start)
        free = np.full(self._with_pairs - self._main, np.inf)
        coefficients = self._main // self.point.width
        arguments = {
            "x0": np.concatenate([start.coefficients.ravel(), separators.ravel(), further]),
            "p": np.concatenate([q.ravel(), weights]),
            "lbx": np.concatenate([np.tile(box[0], coefficients), -free, least]),
            "ubx": np.concatenate([np.tile(box[1], coefficients), free, most]),
            "lbg": np.concatenate([low.ravel(), self._held_values]),
            "ubg": np.concatenate([high.ravel(), self._held_values]),
        }
        if former is not None:
            x, of_x, of_g = former.state
            arguments |= {"x0": np.array(x).ravel(), "lam_x0": of_x, "lam_g0": of_g}
        if pinned is not None:
            for name in ("x0", "lbx", "ubx"):
                arguments[name][: pinned.size] = pinned.ravel()
            held = low.size + np.arange(min(len(pinned), len(self._held_values)))
            for name, side in (("lbg", -np.inf), ("ubg", np.inf)):
                arguments[name][: low.shape[1]] = side
                arguments[name][held] = side
        solver = self._solver(former is not None)
        found = solver(**arguments)
        stats = solver.stats()
        x = found["x"].full().ravel()
        curve = Curve(self.knots, x[: self._main].reshape(-1, self.point.width))
        return Solved(
            curve,
            x[self._main : self._with_pairs].reshape(self._count, -1, 3) if self.point.pairs else separators,
            bool(stats["success"]),
            str(stats["return_status"]),
            int(stats["iter_count"]),
            (found["x"], found["lam_x"], found["lam_g"]),
            self.point.pairs,
            tighter.copy(),
        )

    def _beginning(self, start: Curve) -> tuple[Floats, Floats, Floats]:
        """Where further variables begin, and their bounds."""
        free = np.full(len(self.peaks), np.inf)
        return self.peaks, -free, free

    def _solver(self, warm: bool) -> Any:
        import casadi as ca

        if warm not in self._solvers:
            self._solvers[warm] = ca.nlpsol("trajectory", "ipopt", self._nlp, self._options[warm])
        return self._solvers[warm]

    def limits(self, tighter: Floats) -> tuple[Floats, Floats]:
        """Limits of the quantities at every sample, over their scales."""
        quantities = self.point.quantities
        low, high = (
            np.array([getattr(one, side) / one.scale for one in quantities]) for side in ("low", "high")
        )
        return low + tighter, high - tighter
