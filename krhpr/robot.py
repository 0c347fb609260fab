"""A robot as people use it: methods that broadcast, on compiled kernels or on NumPy, and its CasADi
functions.
"""

from __future__ import annotations

from collections.abc import Sequence
from importlib import import_module
from typing import Any, Unpack

import numpy as np
from numpy.typing import ArrayLike

from krhpr.branches import Branch
from krhpr.calls import Options
from krhpr.defaults import NUMBERS
from krhpr.description import Home
from krhpr.errors import UnknownBranch
from krhpr.forward import ForwardKinematics
from krhpr.generated.python.runtime import Geometry
from krhpr.limits import Limits

__all__ = ["Branch", "Home", "Options", "Robot"]


class Robot(ForwardKinematics):
    """One robot with its geometry.

    Arrays have the shapes that `robot.signature(name)` and each method's documentation state, after any batch
    dimensions, and broadcast as generalized ufuncs do.  A planar robot takes `phi` (...) in place of `Q`
    (..., 3, 3). Where there is no answer the result is NaN, and `status=True` says why.
    """

    def with_geometry(self, **changes: ArrayLike) -> Robot:
        """The same robot with other lengths or angles: `robot.with_geometry(l_2=0.32)`; three values where
        legs differ.
        """
        geometry = self.geometry.replace(**changes)
        return Robot(
            self._module,
            geometry,
            self._backend_name,
            name=self.name,
            limits=self.limits,
            home=self._own_home,
        )

    def with_home(self, p: Sequence[float], redundant: ArrayLike, *, name: str | None = None) -> Robot:
        """The same robot with another home pose, parallel to the base, and another name where one is given;
        one redundant coordinate is for all legs.
        """
        place = tuple(float(x) for x in p)
        a, b, c = np.broadcast_to(np.asarray(redundant, dtype=float), (3,)).tolist()
        return Robot(
            self._module,
            self.geometry,
            self._backend_name,
            name=self.name if name is None else name,
            limits=self.limits,
            home=(place, (a, b, c)),
        )

    def with_limits(self, limits: Limits) -> Robot:
        """The same robot with other limits of joints and links."""
        return Robot(
            self._module,
            self.geometry,
            self._backend_name,
            name=self.name,
            limits=limits,
            home=self._own_home,
        )

    def __reduce__(self) -> tuple[Any, ...]:
        own = (self.name, self.limits, self._own_home)
        return _restored, (self._module.__name__, self.geometry, self._backend_name, *own)

    # -- position -------------------------------------------------------------------------------------------

    def end_points(self, p: ArrayLike, Q: ArrayLike, redundant: ArrayLike, **options: Unpack[Options]) -> Any:
        """s (..., 3, 3): end points of the sub-legs, (1.37)."""
        return self._answer("end_points", (p, Q, redundant), options)

    def redundant_coordinates(
        self, p: ArrayLike, Q: ArrayLike, s: ArrayLike, **options: Unpack[Options]
    ) -> Any:
        """redundant (..., 3): angles beta or slides d from the pose and the end points."""
        return self._answer("redundant_coordinates", (p, Q, s), options)

    def subleg_forward(
        self,
        theta: ArrayLike,
        assembly: Branch | None = None,
        *,
        near: ArrayLike | None = None,
        **options: Unpack[Options],
    ) -> Any:
        """s (..., 3, 3) from the actuated joints theta (..., 3, n).

        Sub-legs with a closed loop take `assembly` (a label, one for each leg, or signs), or a point `near`
        (..., 3, 3) the end points where their assembly modes have no names.
        """
        choice = self._assembly_choice("subleg_forward", assembly, near)
        return self._answer("subleg_forward", (theta, *choice), options)

    def subleg_forward_all(self, theta: ArrayLike, **options: Unpack[Options]) -> Any:
        """End points (..., 3, assembly modes, 3) of closed-loop sub-legs in every assembly mode, in the order
        of `assemblies`.  Those of three spheres (3-UPS, 3-UPU, Delta): first the one towards
        (c_2 - c_1) x (c_3 - c_1).  The 3-CPR gives (s, volume, count, doubtful): up to eight.
        """
        return self._answer("subleg_forward_all", (theta,), options)

    def subleg_inverse(
        self, s: ArrayLike, *, swivel: ArrayLike | None = None, **options: Unpack[Options]
    ) -> Any:
        """theta (..., 3, modes, n): actuated joints in every working mode, NaN where a mode does not
        exist; redundant sub-legs at `swivel` (..., 3), zero unless given.
        """
        return self._answer("subleg_inverse", (s, *self._swivels("subleg_inverse", swivel)), options)

    def swivel(self, s: ArrayLike, theta: ArrayLike, **options: Unpack[Options]) -> Any:
        """swivel (..., 3) of redundant sub-legs, from their end points and joints."""
        return self._answer("swivel", (s, theta), options)

    def constraints(self, p: ArrayLike, Q: ArrayLike, s: ArrayLike, **options: Unpack[Options]) -> Any:
        """Residuals (..., 6) of the constraint equations, zero where the platform closes; rows as (1.31)."""
        return self._answer("constraints", (p, Q, s), options)

    def inverse(
        self,
        p: ArrayLike,
        Q: ArrayLike,
        redundant: ArrayLike,
        *,
        mode: Branch | None = None,
        near: ArrayLike | None = None,
        swivel: ArrayLike | None = None,
        **options: Unpack[Options],
    ) -> Any:
        """theta (..., 3, n): actuated joints for a pose and redundant coordinates.

        In one working mode (`mode`: a label, one for each leg, or signs; the default one otherwise), or, with
        `near` (..., 3, n), in the mode nearest to those joints and continued beyond +-pi.  Redundant sub-legs
        stand at `swivel` (..., 3), zero unless given.  Sub-legs without a closed form take `near` alone.
        """
        if mode is not None and near is not None:
            raise UnknownBranch("inverse takes either a mode or joints to stay near, not both")
        name, choice = "inverse", []
        if self._takes("inverse", "theta_near"):
            if near is None:
                raise UnknownBranch(
                    f"{self.identifier}.inverse: its sub-legs have no inverse in closed form; give "
                    "joints to start "
                    "from: near=... of shape (..., 3, n)"
                )
            choice = [near]
        elif near is not None:
            name, choice = "inverse_near", [near]
        else:
            choice = self._mode_input(name, mode)
        inputs = (p, Q, redundant, *choice, *self._swivels(name, swivel))
        return self._answer(name, inputs, options)

    def inverse_all(
        self,
        p: ArrayLike,
        Q: ArrayLike,
        redundant: ArrayLike,
        *,
        swivel: ArrayLike | None = None,
        **options: Unpack[Options],
    ) -> Any:
        """theta (..., 3, modes, n): every working mode, NaN where a mode does not exist; redundant sub-legs
        at `swivel` (..., 3), zero unless given.
        """
        return self._answer("inverse_all", (p, Q, redundant, *self._swivels("inverse_all", swivel)), options)

    def inverse_status(
        self,
        p: ArrayLike,
        Q: ArrayLike,
        redundant: ArrayLike,
        *,
        mode: Branch | None = None,
        swivel: ArrayLike | None = None,
        **options: Unpack[Options],
    ) -> Any:
        """(status (...), excess (..., 3)): which leg cannot reach its end point, and by what distance."""
        name = "inverse_status"
        inputs = (p, Q, redundant, *self._mode_input(name, mode), *self._swivels(name, swivel))
        excess, status = self._answer("inverse_status", inputs, {**options, "status": True})
        return status, excess

    # -- velocity and acceleration --------------------------------------------------------------------------

    def subleg_jacobian(self, s: ArrayLike, theta: ArrayLike, **options: Unpack[Options]) -> Any:
        """M (..., 3, 3, n): Jacobians of the sub-legs, s_dot_i = M_i theta_dot_i, (1.16), (2.15)."""
        return self._answer("subleg_jacobian", (s, theta), options)

    def jacobians(
        self, p: ArrayLike, Q: ArrayLike, s: ArrayLike, theta: ArrayLike, **options: Unpack[Options]
    ) -> Any:
        """(J (..., 6, 6), K (..., 6, 3n)) of J t = K theta_dot, (1.31), (1.32)."""
        return self._answer("jacobians", (p, Q, s, theta), options)

    def jacobian_blocks(
        self, p: ArrayLike, Q: ArrayLike, s: ArrayLike, theta: ArrayLike, **options: Unpack[Options]
    ) -> Any:
        """(J (..., 6, 6), K (..., 3, 2, n)): K as the legs' blocks, without the zeros."""
        return self._answer("jacobian_blocks", (p, Q, s, theta), options)

    def jacobians_n(
        self, p: ArrayLike, Q: ArrayLike, s: ArrayLike, theta: ArrayLike, **options: Unpack[Options]
    ) -> Any:
        """(J_n (..., 9, 9), K_n (..., 9, 3n)) of J_n [t, redundant rates] = K_n theta_dot, (5.59), (5.60);
        rows leg by leg: its lines, then its redundant coordinate.

        J_n[..., :6] is J_r of (5.56), K_n is K_r.  Redundant sub-legs have a row and a column more, for their
        swivels.
        """
        return self._answer("jacobians_n", (p, Q, s, theta), options)

    def twist(
        self,
        p: ArrayLike,
        Q: ArrayLike,
        s: ArrayLike,
        theta: ArrayLike,
        theta_dot: ArrayLike,
        **options: Unpack[Options],
    ) -> Any:
        """Twist [p_dot, omega] (..., 6) in the base frame from actuated joint rates."""
        return self._answer("twist", (p, Q, s, theta, theta_dot), options)

    def joint_rates(
        self,
        p: ArrayLike,
        Q: ArrayLike,
        s: ArrayLike,
        theta: ArrayLike,
        twist: ArrayLike,
        redundant_rates: ArrayLike = 0.0,
        swivel_rates: ArrayLike | None = None,
        **options: Unpack[Options],
    ) -> Any:
        """theta_dot (..., 3, n) from the twist and the rates of the redundant coordinates and of redundant
        sub-legs' swivels (zero unless given).
        """
        rates = (self._per_leg(redundant_rates), *self._swivels("joint_rates", swivel_rates, "swivel_rates"))
        return self._answer("joint_rates", (p, Q, s, theta, twist, *rates), options)

    def platform_acceleration(
        self,
        p: ArrayLike,
        Q: ArrayLike,
        s: ArrayLike,
        theta: ArrayLike,
        twist: ArrayLike,
        theta_dot: ArrayLike,
        theta_ddot: ArrayLike,
        **options: Unpack[Options],
    ) -> Any:
        """Rate of the twist (..., 6) from actuated joint accelerations; `twist` is the one that theta_dot
        gives.
        """
        return self._answer("platform_acceleration", (p, Q, s, theta, twist, theta_dot, theta_ddot), options)

    def joint_accelerations(
        self,
        p: ArrayLike,
        Q: ArrayLike,
        s: ArrayLike,
        theta: ArrayLike,
        twist: ArrayLike,
        redundant_rates: ArrayLike,
        theta_dot: ArrayLike,
        twist_rate: ArrayLike,
        redundant_accelerations: ArrayLike = 0.0,
        swivel_accelerations: ArrayLike | None = None,
        **options: Unpack[Options],
    ) -> Any:
        """theta_ddot (..., 3, n); `theta_dot` are the rates that the twist and the redundant rates give."""
        name = "joint_accelerations"
        rates, accelerations = self._per_leg(redundant_rates), self._per_leg(redundant_accelerations)
        swivels = self._swivels(name, swivel_accelerations, "swivel_accelerations")
        inputs = (p, Q, s, theta, twist, rates, theta_dot, twist_rate, accelerations, *swivels)
        return self._answer(name, inputs, options)

    # -- statics --------------------------------------------------------------------------------------------

    def inverse_statics(
        self,
        p: ArrayLike,
        Q: ArrayLike,
        s: ArrayLike,
        theta: ArrayLike,
        wrench: ArrayLike,
        redundant_forces: ArrayLike = 0.0,
        swivel_forces: ArrayLike | None = None,
        **options: Unpack[Options],
    ) -> Any:
        """actuator_forces (..., 3, n) with which the robot applies `wrench` (..., 6), force and moment about
        O' in the base frame, to its environment, (5.12); and, (5.44), `redundant_forces` (..., 3) along the
        redundant coordinates and those along redundant sub-legs' swivels (zero unless given).
        """
        forces = self._per_leg(redundant_forces)
        swivels = self._swivels("inverse_statics", swivel_forces, "swivel_forces")
        return self._answer("inverse_statics", (p, Q, s, theta, wrench, forces, *swivels), options)

    def forward_statics(
        self,
        p: ArrayLike,
        Q: ArrayLike,
        s: ArrayLike,
        theta: ArrayLike,
        actuator_forces: ArrayLike,
        **options: Unpack[Options],
    ) -> Any:
        """(wrench (..., 6), redundant_forces (..., 3)) that the robot applies to its environment with given
        forces of the actuators, (5.36); and swivel_forces (..., 3) of redundant sub-legs.
        """
        return self._answer("forward_statics", (p, Q, s, theta, actuator_forces), options)

    # -- gripper of arrangements (b) and (c) ----------------------------------------------------------------

    def opening(self, redundant: ArrayLike, jaws: ArrayLike = 0.0, **options: Unpack[Options]) -> Any:
        """(opening (...), centre (..., 2), shares (..., 3)) of a gripper with a flat jaw on each slide,
        normal to it at the distance `jaws` (..., 3) from S_i towards where slides close: the diameter of the
        round object that touches all three, its centre in the platform's plane, and the shares in which the
        jaws press on it in equilibrium.
        """
        return self._answer("opening", (redundant, self._per_leg(jaws)), options)

    def redundant_of_opening(
        self,
        opening: ArrayLike,
        centre: ArrayLike = (0.0, 0.0),
        jaws: ArrayLike = 0.0,
        **options: Unpack[Options],
    ) -> Any:
        """redundant (..., 3): slides at which the jaws touch a round object of the diameter `opening` with
        its `centre` in the platform's plane, at O' unless given.
        """
        return self._answer("redundant_of_opening", (opening, centre, self._per_leg(jaws)), options)

    def grasp(
        self,
        Q: ArrayLike,
        contacts: ArrayLike,
        normal_forces: ArrayLike,
        weight: ArrayLike | None = None,
        mass_centre: ArrayLike | None = None,
        friction: ArrayLike = 0.5,
        **options: Unpack[Options],
    ) -> Any:
        """(contact_forces (..., 3, 3), wrench (..., 6), redundant_forces (..., 3), friction_margins
        (..., 3)): what the jaws apply to an object by its equilibrium, and what that is for
        `inverse_statics`.

        `contacts` (..., 3, 3) and `mass_centre` (..., 3) are in the platform frame, from O'; `normal_forces`
        (..., 3) are measured; `weight` (..., 3) is m g in the base frame (both zero unless given).
        """
        nothing = np.zeros(2 if self.planar else 3)
        load, centre = (nothing if value is None else value for value in (weight, mass_centre))
        inputs = (Q, contacts, centre, load, self._per_leg(normal_forces), friction)
        return self._answer("grasp", inputs, options)

    # -- passive joints and singularities -------------------------------------------------------------------

    def passive_joints(
        self, p: ArrayLike, Q: ArrayLike, s: ArrayLike, theta: ArrayLike, **options: Unpack[Options]
    ) -> Any:
        """Every passive joint as a named tuple; names and zeros in `robot.signature("passive_joints")`."""
        return self._answer("passive_joints", (p, Q, s, theta), options)

    def link_points(
        self, p: ArrayLike, Q: ArrayLike, s: ArrayLike, theta: ArrayLike, **options: Unpack[Options]
    ) -> Any:
        """(points, attachment): the joints of every leg, named in `robot.signature("link_points")`, and where
        redundant links meet the platform; `robot.links` joins them.
        """
        return self._answer("link_points", (p, Q, s, theta), options)

    def clearances(
        self, p: ArrayLike, Q: ArrayLike, s: ArrayLike, theta: ArrayLike, **options: Unpack[Options]
    ) -> Any:
        """distances (..., pairs) between the axes of links that no joint joins, in the order of
        `krhpr.trajectory.clearance.pairs(robot)`; spatial robots have it, in CasADi too.
        """
        return self._answer("clearances", (p, Q, s, theta), options)

    def singularity(
        self, p: ArrayLike, Q: ArrayLike, s: ArrayLike, theta: ArrayLike, **options: Unpack[Options]
    ) -> Any:
        """(type_1, factors, type_2, margins): det M_i, its factors, the factors of det J, and margins."""
        return self._answer("singularity", (p, Q, s, theta), options)

    def type_2_of_redundant(self, redundant: ArrayLike, **options: Unpack[Options]) -> Any:
        """(type_2, margins): the factors of det J and their margins, which depend on the redundant
        coordinates (..., 3) alone.
        """
        return self._answer("type_2_of_redundant", (redundant,), options)

    # -- indices --------------------------------------------------------------------------------------------

    def indices(
        self,
        p: ArrayLike,
        Q: ArrayLike,
        s: ArrayLike,
        theta: ArrayLike,
        *,
        characteristic_length: ArrayLike | None = None,
        **options: Unpack[Options],
    ) -> Any:
        """(eta_1, eta_2, eta_3, condition (..., 3)): the performance indices of Sections 1.8 and 4.2.2.

        eta_1 (m) and eta_2 are the 2-norms of the position and the rotation part of U = J^-1 K, eta_3 is the
        condition number of J_1 = diag(M_1, M_2, M_3), (1.52), and `condition` has those of the M_i.

        `characteristic_length` (m) is the displacement of an actuator that slides which counts as much as one
        radian of one that turns, 1 m unless given; where all actuators turn it has no effect.
        """
        return self._answer(
            "indices", (p, Q, s, theta, *self._length("indices", characteristic_length)), options
        )

    def index_bounds(
        self,
        p: ArrayLike,
        Q: ArrayLike,
        s: ArrayLike,
        theta: ArrayLike,
        *,
        characteristic_length: ArrayLike | None = None,
        **options: Unpack[Options],
    ) -> Any:
        """(eta_1, eta_2, eta_3): upper bounds of `indices` that have all derivatives, for optimisers.

        Schatten norms of order 16: at most 3^(1/16) = 1.072 times eta_1 and eta_2, and 9^(1/8) = 1.317 times
        eta_3.
        """
        return self._answer(
            "index_bounds", (p, Q, s, theta, *self._length("index_bounds", characteristic_length)), options
        )

    def _length(self, function: str, given: ArrayLike | None) -> tuple[Any, ...]:
        """The characteristic length, where the function takes one."""
        if not self._takes(function, "characteristic_length"):
            return ()
        return (NUMBERS["characteristic_length"][0] if given is None else given,)


def _restored(
    module: str,
    geometry: Geometry,
    backend: str | None,
    name: str,
    limits: Limits,
    home: tuple[Sequence[float], Sequence[float]] | None,
) -> Robot:
    """A robot out of a pickle."""
    return Robot(import_module(module), geometry, backend, name=name, limits=limits, home=home)
