"""A planar grasping robot as people use it: two sub-legs, two jaws on a pivot, and what is between them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from enum import StrEnum
from importlib import import_module
from typing import Any, ClassVar, NamedTuple, Unpack

import numpy as np
from numpy.typing import ArrayLike, NDArray

from krhpr.branches import Branch
from krhpr.calls import MEANINGS, WITHOUT_ANSWER, Calls, Options
from krhpr.errors import InBatch, NoGrasp, Unassembled
from krhpr.generated.python.runtime import Geometry, Signature, Status
from krhpr.limits import Limits

__all__ = ["Force", "GraspingRobot", "JawsHome", "measured_force"]


class Force(StrEnum):
    """One of the four forces of the jaws on the object, (5.41)."""

    RIGHT_NORMAL = "ro"
    RIGHT_PARALLEL = "rp"
    LEFT_NORMAL = "lo"
    LEFT_PARALLEL = "lp"


_PLACES = {
    Force.RIGHT_NORMAL: (0, 0),
    Force.RIGHT_PARALLEL: (0, 1),
    Force.LEFT_NORMAL: (1, 0),
    Force.LEFT_PARALLEL: (1, 1),
}
"""Where each stands in the arrays `sensor` and `contact_forces`."""


def measured_force(phi: ArrayLike) -> NDArray[np.str_]:
    """Which normal force (a `Force`) a grasping force is, (5.70): f_lo where -3 pi/4 < phi < pi/4, else f_ro.

    It is the smaller one, that of the jaw from which the weight pulls the object away, for jaws that are at
    right angles and gravity along -y.  `phi` may have any full turns; at both ends of the interval the two
    are equal, and the answer is f_lo.
    """
    angle = np.asarray(phi, dtype=float)
    # zero in the middle of the interval, -pi/4; half its width is pi/2
    left = np.cos(angle + np.pi / 4) > -1e-12
    return np.where(left, Force.LEFT_NORMAL.value, Force.RIGHT_NORMAL.value)


class JawsHome(NamedTuple):
    """A pose: pivot B, and the angles phi and beta of the jaws."""

    pivot: tuple[float, ...]
    angles: tuple[float, ...]


class GraspingRobot(Calls):
    """One grasping robot with its geometry.

    Rows of jaw-wise and leg-wise arrays are the right jaw (P, phi; legs 1 and 2 of the thesis) and the left
    one (S, beta; legs 3 and 4).  `pivot` (..., 2) is B, `angles` (..., 2) are phi and beta, `s` (..., 2, 2)
    P and S.  All forces are those that the robot applies to its environment; an actuator's is positive where
    it does work at a positive rate.  Arrays broadcast as those of the catalogue's robots do.
    """

    _advice: ClassVar[Mapping[Status, tuple[type[InBatch], str]]] = {
        **WITHOUT_ANSWER,
        Status.NO_ASSEMBLY: (
            Unassembled,
            "P and S are too far from one another, or too near, for the jaws to meet in B; check the joints "
            "and the assembly modes",
        ),
        Status.NO_GRASP: (
            NoGrasp,
            "a jaw would have to pull the object, or the jaws overlap; press harder, and look at widths",
        ),
        Status.UNDETERMINED: (
            NoGrasp,
            "the measured force does not determine the others: the object has no width between the contacts, "
            "or, for a parallel force, both contacts lie on a normal of the jaws",
        ),
    }
    _meanings: ClassVar[Mapping[Status, str]] = {
        **MEANINGS,
        Status.SINGULAR_LEG_1: "the chains of the right sub-leg are aligned, or do not move P",
        Status.SINGULAR_LEG_2: "the chains of the left sub-leg are aligned, or do not move S",
        Status.SINGULAR_IN_PLANE: "the jaws are aligned, or P and S coincide",
    }

    def with_geometry(self, **changes: ArrayLike) -> GraspingRobot:
        """The same robot with other lengths or angles; two values where the sub-legs or jaws differ."""
        geometry = self.geometry.replace(**changes)
        return GraspingRobot(
            self._module,
            geometry,
            self._backend_name,
            name=self.name,
            limits=self.limits,
            home=self._own_home,
        )

    def __reduce__(self) -> tuple[Any, ...]:
        own = (self.name, self.limits, self._own_home)
        return _restored, (self._module.__name__, self.geometry, self._backend_name, *own)

    @property
    def home(self) -> JawsHome:  # type: ignore[override]
        """Its home pose: `robot.inverse(*robot.home)`."""
        pivot, angles = self._own_home or (self._module.HOME_P, self._module.HOME_REDUNDANT)
        return JawsHome(tuple(pivot), tuple(angles))

    # -- position -------------------------------------------------------------------------------------------

    def end_points(self, pivot: ArrayLike, angles: ArrayLike, **options: Unpack[Options]) -> Any:
        """s (..., 2, 2): P and S, (5.32), (5.33)."""
        return self._answer("end_points", (pivot, angles), options)

    def subleg_inverse(self, s: ArrayLike, **options: Unpack[Options]) -> Any:
        """theta (..., 2, modes, 2) in every working mode from P and S; NaN where a mode does not exist."""
        return self._answer("subleg_inverse", (s,), options)

    def inverse(
        self, pivot: ArrayLike, angles: ArrayLike, *, mode: Branch | None = None, **options: Unpack[Options]
    ) -> Any:
        """theta (..., 2, 2): the four rho, in one working mode (a label, one for each sub-leg, or signs)."""
        return self._answer("inverse", (pivot, angles, *self._mode_input("inverse", mode)), options)

    def inverse_all(self, pivot: ArrayLike, angles: ArrayLike, **options: Unpack[Options]) -> Any:
        """theta (..., 2, modes, 2): every working mode, NaN where a mode does not exist."""
        return self._answer("inverse_all", (pivot, angles), options)

    def inverse_status(
        self, pivot: ArrayLike, angles: ArrayLike, *, mode: Branch | None = None, **options: Unpack[Options]
    ) -> Any:
        """(status (...), excess (..., 2)): which sub-leg cannot reach its end point, and by what distance."""
        inputs = (pivot, angles, *self._mode_input("inverse_status", mode))
        excess, status = self._answer("inverse_status", inputs, {**options, "status": True})
        return status, excess

    def subleg_forward(
        self, theta: ArrayLike, assembly: Branch | None = None, **options: Unpack[Options]
    ) -> Any:
        """s (..., 2, 2): P and S from the joints, each left or right of the line between its chains' ends."""
        return self._answer("subleg_forward", (theta, self.assembly_signs(assembly)), options)

    def forward(
        self,
        theta: ArrayLike,
        assembly: Branch | None = None,
        *,
        side: ArrayLike = 1.0,
        **options: Unpack[Options],
    ) -> Any:
        """(pivot (..., 2), angles (..., 2)): one of the eight solutions.

        `assembly` chooses P and S, `side` B: left (+1) or right (-1) of the line from P to S.
        """
        return self._answer("forward", (theta, self.assembly_signs(assembly), side), options)

    def forward_all(self, theta: ArrayLike, **options: Unpack[Options]) -> Any:
        """(pivot (..., 8, 2), angles (..., 8, 2)): all solutions, NaN where one does not exist.

        In the order of `assemblies` for P, for S, then B left and right of the line from P to S.
        """
        return self._answer("forward_all", (theta,), options)

    def link_points(self, s: ArrayLike, theta: ArrayLike, **options: Unpack[Options]) -> Any:
        """points (..., 2, points, 2): the sub-legs' joints, named in `robot.signature("link_points")`."""
        return self._answer("link_points", (s, theta), options)

    # -- velocity -------------------------------------------------------------------------------------------

    def subleg_jacobian(self, s: ArrayLike, theta: ArrayLike, **options: Unpack[Options]) -> Any:
        """M (..., 2, 2, 2): Jacobians of the sub-legs, s_dot = M rho_dot."""
        return self._answer("subleg_jacobian", (s, theta), options)

    def jacobians_n(
        self, pivot: ArrayLike, s: ArrayLike, theta: ArrayLike, **options: Unpack[Options]
    ) -> Any:
        """(J_n (..., 4, 4), K_n (..., 4, 4)) of J_n [b_dot, phi_dot, beta_dot] = K_n rho_dot, (5.35)."""
        return self._answer("jacobians_n", (pivot, s, theta), options)

    def jacobians_k(
        self, pivot: ArrayLike, s: ArrayLike, theta: ArrayLike, **options: Unpack[Options]
    ) -> Any:
        """(J_k (..., 3, 3), K_k (..., 3, 4)) of J_k [p_dot, phi_dot] = K_k rho_dot, (5.4), (5.5)."""
        return self._answer("jacobians_k", (pivot, s, theta), options)

    def jacobians_r(self, s: ArrayLike, theta: ArrayLike, **options: Unpack[Options]) -> Any:
        """(J_r (..., 4, 3), K_r (..., 4, 4)) of J_r [p_dot, phi_dot] = K_r rho_dot, (5.21), (5.22)."""
        return self._answer("jacobians_r", (s, theta), options)

    def twist(
        self,
        pivot: ArrayLike,
        s: ArrayLike,
        theta: ArrayLike,
        theta_dot: ArrayLike,
        **options: Unpack[Options],
    ) -> Any:
        """(pivot_rate (..., 2), angle_rates (..., 2), twist (..., 3)): the last one is [p_dot, phi_dot]."""
        return self._answer("twist", (pivot, s, theta, theta_dot), options)

    def joint_rates(
        self,
        pivot: ArrayLike,
        s: ArrayLike,
        theta: ArrayLike,
        pivot_rate: ArrayLike,
        angle_rates: ArrayLike,
        **options: Unpack[Options],
    ) -> Any:
        """theta_dot (..., 2, 2) from the rates of the pivot and of the jaws' angles."""
        return self._answer("joint_rates", (pivot, s, theta, pivot_rate, angle_rates), options)

    def singularity(
        self, pivot: ArrayLike, s: ArrayLike, theta: ArrayLike, **options: Unpack[Options]
    ) -> Any:
        """(type_1 (..., 2, 2), factors, determinants (..., 2), sine (...)): kappa of each chain, the
        dimensionless factors of the sub-legs, det J_k and det J_n, and sin gamma.
        """
        return self._answer("singularity", (pivot, s, theta), options)

    # -- statics --------------------------------------------------------------------------------------------

    def inverse_statics_n(
        self,
        pivot: ArrayLike,
        s: ArrayLike,
        theta: ArrayLike,
        loads: ArrayLike,
        **options: Unpack[Options],
    ) -> Any:
        """actuator_forces (..., 2, 2) for loads F_n (..., 4) = [f_x, f_y, m_r, m_l], (5.44): the force
        of both jaws, and the moments of the right and the left one about B.  Right for every load.
        """
        return self._answer("inverse_statics_n", (pivot, s, theta, loads), options)

    def inverse_statics_k(
        self,
        pivot: ArrayLike,
        s: ArrayLike,
        theta: ArrayLike,
        wrench: ArrayLike,
        **options: Unpack[Options],
    ) -> Any:
        """actuator_forces (..., 2, 2) for a wrench (..., 3) of the right jaw, moment about P, (5.12).

        Wrong where anything loads the left jaw, as an object between the jaws does.
        """
        return self._answer("inverse_statics_k", (pivot, s, theta, wrench), options)

    def inverse_statics_r(
        self,
        s: ArrayLike,
        theta: ArrayLike,
        wrench: ArrayLike,
        internal_force: ArrayLike = 0.0,
        **options: Unpack[Options],
    ) -> Any:
        """(actuator_forces, least_forces, null_space), each (..., 2, 2), for a wrench (..., 3) of both
        jaws as one body, moment about P, (5.25): U^I F + internal_force * null_space.

        The null space is what pulls P and S together with 1 N.  How hard an object is held is not in the
        wrench: `inverse_statics_n` knows it.
        """
        return self._answer("inverse_statics_r", (s, theta, wrench, internal_force), options)

    def forward_statics(
        self,
        pivot: ArrayLike,
        s: ArrayLike,
        theta: ArrayLike,
        actuator_forces: ArrayLike,
        **options: Unpack[Options],
    ) -> Any:
        """(loads (..., 4), wrench (..., 3)) that the robot applies with these forces, (5.36) and (5.24)."""
        return self._answer("forward_statics", (pivot, s, theta, actuator_forces), options)

    # -- the object -----------------------------------------------------------------------------------------

    def grasp(
        self,
        angles: ArrayLike,
        contacts: ArrayLike,
        faces: ArrayLike,
        measured_force: ArrayLike,
        measured: Force | str | ArrayLike = Force.LEFT_NORMAL,
        *,
        weight: ArrayLike = (0.0, 0.0),
        mass_centre: ArrayLike = (0.0, 0.0),
        friction: ArrayLike = 0.5,
        **options: Unpack[Options],
    ) -> Any:
        """(contact_forces (..., 2, 2), loads (..., 4), friction_margins (..., 2), determinant (...),
        widths (..., 2), pulls (..., 2)): what the jaws apply to the object between them, (5.38) to (5.43).

        `contacts` (..., 2, 2) are the contacts from B, each in its jaw's frame (x from P or S to B), `faces`
        (..., 2) the directions of the faces' normals into the object there, `mass_centre` (..., 2) is from B
        in the right jaw's frame, and `weight` (..., 2) is m g in the base frame.  `measured` says which of
        the four forces `measured_force` is: a `Force` (or several, in an array), or weights (..., 2, 2).  Of
        contact_forces rows are jaws, columns f_o along the normal and f_p a quarter turn left of it; loads
        are those of `inverse_statics_n`.  `determinant` is, but for its sign, the object's width where a
        normal force is measured.
        """
        inputs = (
            angles,
            contacts,
            faces,
            mass_centre,
            weight,
            sensor(measured),
            measured_force,
            friction,
        )
        return self._answer("grasp", inputs, options)

    # -- messages -------------------------------------------------------------------------------------------

    def _distance(
        self, signature: Signature, arrays: Sequence[Any], status: Any, index: tuple[int, ...], leg: int
    ) -> float:
        names = [port.name for port in signature.inputs]
        if names[:2] != ["pivot", "angles"]:
            return float("nan")
        picked = [
            np.broadcast_to(array, (*np.shape(status), *port.shape))[index]
            for port, array in zip(signature.inputs, arrays, strict=True)
        ]
        signs = picked[names.index("mode")] if "mode" in names else self.mode_signs()
        taken = [signs] if self._takes("inverse_status", "mode") else []
        excess, _ = self._backend.call("inverse_status", (*picked[:2], *taken), None)
        return float(np.asarray(excess)[leg - 1])


def sensor(measured: Force | str | ArrayLike) -> NDArray[np.float64]:
    """Weights (..., 2, 2) of the four forces in what is measured: rows are jaws, columns f_o and f_p."""
    given = np.asarray(measured)
    if given.dtype.kind not in "OUS":
        return given.astype(float)
    weights = np.zeros((*given.shape, 2, 2))
    for index in np.ndindex(given.shape):
        try:
            place = _PLACES[Force(str(given[index]))]
        except ValueError:
            known = ", ".join(f"{force.value!r}" for force in Force)
            raise ValueError(f"measured is {given[index]!r}; the four forces are {known}") from None
        weights[(*index, *place)] = 1.0
    return weights


def _restored(
    module: str,
    geometry: Geometry,
    backend: str | None,
    name: str,
    limits: Limits,
    home: tuple[Sequence[float], Sequence[float]] | None,
) -> GraspingRobot:
    """A robot out of a pickle."""
    return GraspingRobot(import_module(module), geometry, backend, name=name, limits=limits, home=home)
