"""A robot as people use it: methods that broadcast, on compiled kernels or on NumPy, and its CasADi
functions.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cached_property
from importlib import import_module
from types import ModuleType
from typing import Any, NamedTuple, TypedDict, Unpack

import numpy as np
from numpy.typing import ArrayLike

from krhpr.backend import Backend, BackendName, make_backend
from krhpr.defaults import NUMBERS
from krhpr.errors import (
    Ambiguous,
    Inconsistent,
    InvalidInput,
    NoConvergence,
    Singular,
    Unassembled,
    UnknownBranch,
    Unreachable,
)
from krhpr.generated.python.runtime import Geometry, Port, Signature, Status
from krhpr.limits import Limits

ROTATION_TOLERANCE = 1e-6
"""Largest element of |Q^T Q - I| that passes for a rotation matrix."""

Branch = str | Sequence[str] | ArrayLike
"""A working or assembly mode: its label, a label for each leg, or signs of shape (..., 3, signs)."""


class Home(NamedTuple):
    """A pose with its redundant coordinates, in the order in which functions take them."""

    p: tuple[float, ...]
    orientation: Any
    """Q, or phi for a planar robot."""
    redundant: tuple[float, float, float]


class Options(TypedDict, total=False):
    """Keyword arguments that every function takes."""

    out: Any
    """An array (a tuple of arrays where there are several results) to write to."""
    status: bool
    """Return (result, status) instead of the result."""
    check: bool
    """Raise Unreachable, Singular or InvalidInput for the first element without an answer."""
    check_rotation: bool
    """Check that Q is a rotation matrix within ROTATION_TOLERANCE (on unless switched off)."""


class Robot:
    """One robot with its geometry.

    Arrays have the shapes that `robot.signature(name)` and each method's documentation state, after any batch
    dimensions, and broadcast as generalized ufuncs do.  A planar robot takes `phi` (...) in place of `Q`
    (..., 3, 3). Where there is no answer the result is NaN, and `status=True` says why.
    """

    def __init__(
        self,
        module: ModuleType,
        geometry: Geometry | None = None,
        backend: str | None = None,
        *,
        name: str | None = None,
        limits: Limits | None = None,
        home: tuple[Sequence[float], Sequence[float]] | None = None,
    ) -> None:
        self._module = module
        self._backend_name = backend
        self.name: str = self.identifier if name is None else name
        """What it is called: the name in its robot file, else the catalogue's identifier."""
        self.limits: Limits = Limits() if limits is None else limits
        """Limits of joints and links that its robot file gives; nothing is held to them by itself."""
        self._own_home = home
        self.geometry: Geometry = module.DEFAULT_GEOMETRY if geometry is None else geometry

    # -- what it is -----------------------------------------------------------------------------------------

    @property
    def identifier(self) -> str:
        """The catalogue's name, `spatial_rrr_a`."""
        return str(self._module.IDENTIFIER)

    @property
    def notation(self) -> str:
        """The thesis' notation, `3-RRRSR`."""
        return str(self._module.NOTATION)

    @property
    def title(self) -> str:
        """What it is, in a few words."""
        return str(self._module.TITLE)

    @property
    def planar(self) -> bool:
        """Whether it moves in the plane (p, phi) or in space (p, Q)."""
        return self.identifier.startswith("planar")

    @property
    def home(self) -> Home:
        """Its home pose: `robot.inverse(*robot.home)`.

        That of its robot file, else the catalogue's, which is chosen for the default sizes.
        """
        p, redundant = self._own_home or (self._module.HOME_P, self._module.HOME_REDUNDANT)
        first, second, third = redundant
        return Home(tuple(p), 0.0 if self.planar else np.eye(3), (first, second, third))

    @property
    def degrees_of_freedom(self) -> tuple[int, int]:
        """Those of the platform, and the redundant ones: (6, 3)."""
        freedom = dict(self.documentation["freedom"])
        return int(freedom["platform"]), int(freedom["redundancy"])

    @property
    def modes(self) -> tuple[str, ...]:
        """Labels of the working modes, in the order of `inverse_all`."""
        return tuple(self._module.MODES)

    @property
    def default_mode(self) -> str:
        """The working mode that `inverse` uses unless another is given."""
        return str(self._module.DEFAULT_MODE)

    @property
    def assemblies(self) -> tuple[str, ...]:
        """Labels of the sub-legs' assembly modes (empty for serial sub-legs)."""
        return tuple(self._module.ASSEMBLIES)

    @property
    def links(self) -> tuple[tuple[str, str, str, str], ...]:
        """The straight links of a leg: name, kind, and the two points of `link_points` that each joins."""
        return self._module.LINKS  # type: ignore[no-any-return]

    @property
    def redundant_link(self) -> str:
        """The field with the length of the redundant link from S_i to its attachment; empty where they
        coincide.
        """
        return str(self._module.REDUNDANT_LINK)

    @property
    def functions(self) -> tuple[str, ...]:
        """Names of all functions."""
        return tuple(self._module.SIGNATURES)

    @property
    def documentation(self) -> Mapping[str, tuple[tuple[str, str], ...]]:
        """Geometry, joints, modes, singular factors, margins, sections of the thesis: names with their
        meanings.
        """
        return self._module.DOCUMENTATION  # type: ignore[no-any-return]

    def signature(self, function: str) -> Signature:
        """Arguments and results of a function: names, shapes, units, frames, meanings."""
        if function not in self._module.SIGNATURES:
            raise self._unknown(function)
        return self._module.SIGNATURES[function]  # type: ignore[no-any-return]

    @property
    def redundant_legs(self) -> bool:
        """Whether its sub-legs have a swivel: one more actuator than their end point has coordinates."""
        return "swivel" in self.functions

    def mode_signs(self, mode: Branch | None = None) -> np.ndarray[Any, Any]:
        """Signs (..., 3, signs) of a working mode given as `inverse` takes it; the default one unless
        given.
        """
        return self._signs(mode, self._module.MODES, self._module.DEFAULT_MODE, "a working mode")

    def assembly_signs(self, assembly: Branch | None = None) -> np.ndarray[Any, Any]:
        """Signs (..., 3, signs) of an assembly mode given as `subleg_forward` takes it; the default one
        unless given.
        """
        if not self.assemblies:
            raise UnknownBranch(
                f"{self.identifier}: no assembly modes of its sub-legs are told apart by signs"
            )
        return self._signs(
            assembly, self._module.ASSEMBLIES, self._module.DEFAULT_ASSEMBLY, "an assembly mode"
        )

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

    @property
    def backend(self) -> BackendName:
        """Whether calls run on compiled kernels or on NumPy."""
        return self._backend.name

    @cached_property
    def casadi(self) -> CasadiFunctions:
        """The kernels as casadi.Function, with this geometry: `robot.casadi.twist`."""
        return CasadiFunctions(self.identifier, self.geometry)

    def __reduce__(self) -> tuple[Any, ...]:
        own = (self.name, self.limits, self._own_home)
        return _restored, (self._module.__name__, self.geometry, self._backend_name, *own)

    def __repr__(self) -> str:
        own = "" if self.name == self.identifier else f"{self.name}, "
        return f"<Robot {own}{self.identifier} {self.notation}: {self.title}>"

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

    # -- forward kinematics ---------------------------------------------------------------------------------

    def forward_all(self, s: ArrayLike, *, turned: bool = False, **options: Unpack[Options]) -> Any:
        """(p, Q, redundant, det_J, count): every pose that holds the end points s (..., 3, 3), along a first
        core axis; `turned` gives those of the platform turned over in place of the others.  Arrangement (a)
        adds `doubtful`, 1 where two solutions all but coincide and are left out.
        """
        return self._answer("forward_all", (s, *self._family("forward_all", turned)), options)

    def _family(self, function: str, turned: bool) -> tuple[float, ...]:
        """The argument `turned`, where there is one."""
        if self._takes(function, "turned"):
            return (-1.0 if turned else 1.0,)
        if turned:
            raise UnknownBranch(f"{self.identifier}.{function}: a planar platform cannot be turned over")
        return ()

    @property
    def box(self) -> np.ndarray[Any, Any]:
        """Where `forward` looks for redundant angles unless told (3, 2), rad; empty for slides."""
        return np.array(getattr(self._module, "DEFAULT_BOX", ()))

    def forward(
        self,
        theta: ArrayLike,
        assembly: Branch | None = None,
        *,
        near: ArrayLike | None = None,
        side: ArrayLike | None = None,
        box: ArrayLike | None = None,
        turned: bool = False,
        **options: Unpack[Options],
    ) -> Any:
        """(p, Q, redundant, count, certified) from the actuated joints theta (..., 3, n) alone.

        Arrangement (a): the only pose with its redundant angles in `box` (..., 3, 2), low and high for each
        leg, in radians; from 30 to 150 degrees, or within the limits of the robot's file, unless given.
        `certified` is 1 where a theorem says that there is no other, and 0 where it is the only one among
        the `count` found; the status is AMBIGUOUS where several lie in the box, NO_ASSEMBLY where none does.
        `turned` looks for the platform turned over.

        Arrangements (b) and (c): the one pose on a `side` of type II, +1 (where the first margin of
        `singularity` is positive, and unless given) or -1: always certain.

        `assembly` and `near` choose the sub-legs' assembly modes as in `subleg_forward`.
        """
        choice = self._assembly_choice("forward", assembly, near)
        pose = self._pose_choice("forward", side, box, turned)
        return self._answer("forward", (theta, *choice, *pose), options)

    def passive_joints_of_theta(
        self,
        theta: ArrayLike,
        assembly: Branch | None = None,
        *,
        near: ArrayLike | None = None,
        side: ArrayLike | None = None,
        box: ArrayLike | None = None,
        turned: bool = False,
        **options: Unpack[Options],
    ) -> Any:
        """Every passive joint from the actuated ones alone, as `passive_joints` gives them, then the pose
        (p, Q, redundant); the arguments are those of `forward`, and so is the status.
        """
        choice = self._assembly_choice("passive_joints_of_theta", assembly, near)
        pose = self._pose_choice("passive_joints_of_theta", side, box, turned)
        return self._answer("passive_joints_of_theta", (theta, *choice, *pose), options)

    def _pose_choice(
        self, function: str, side: ArrayLike | None, box: ArrayLike | None, turned: bool
    ) -> tuple[Any, ...]:
        """The arguments that choose among poses: a side of type II, or a box and a family."""
        if self._takes(function, "side"):
            if box is not None or turned:
                raise UnknownBranch(f"{self.identifier}.{function}: side=+1 or -1 chooses the pose, no box")
            return (1.0 if side is None else side,)
        if side is not None:
            raise UnknownBranch(f"{self.identifier}.{function}: box=... chooses the pose, no side")
        return (self.box if box is None else box, *self._family(function, turned))

    def forward_newton(
        self, s: ArrayLike, p_near: ArrayLike, Q_near: ArrayLike, **options: Unpack[Options]
    ) -> Any:
        """(p, Q, redundant, kantorovich) by Newton steps from a pose nearby, the previous one on a path:
        approach two, for arrangement (a).  `kantorovich` is at most 1 where the steps are certain to
        converge, to the only solution around.  `Q_near` is phi_near for a planar robot.
        """
        return self._answer("forward_newton", (s, p_near, Q_near), options)

    def forward_encoders(
        self,
        s: ArrayLike,
        measured: ArrayLike,
        *,
        tolerance: ArrayLike | None = None,
        **options: Unpack[Options],
    ) -> Any:
        """The pose with encoders at the redundant joints of the first one, two or three legs: approaches
        three to five, as many as `measured` (..., 1 to 3) has; arrangements (b) and (c) need two.

        One encoder gives (p, Q, mismatch) of two solutions, along a first core axis: first the one that fits
        better.  Two or three give (p, Q, raw, mismatch), with `raw` the orientation before it is made a
        rotation.  `mismatch` says by how much lengths disagree; the status is INCONSISTENT where that is more
        than `tolerance`, in metres.
        """
        function = f"forward_encoders_{self._count(measured)}"
        given = NUMBERS["tolerance"][0] if tolerance is None else tolerance
        return self._answer(function, (s, measured, given), options)

    def forward_gauss_newton(
        self,
        s: ArrayLike,
        measured: ArrayLike,
        *,
        weights: ArrayLike | None = None,
        tolerance: ArrayLike | None = None,
        **options: Unpack[Options],
    ) -> Any:
        """(p, Q, raw, mismatch) by Gauss-Newton with two or three encoders: approaches six and seven.

        `weights` (..., 3) multiply the residuals of s_i = p + Q d_i (1/m), of the third link's length (1/m),
        and of Q^T Q = 1: the result depends on them, and they are 1000 each unless given.
        """
        function = f"forward_gauss_newton_{self._count(measured)}"
        given = NUMBERS["tolerance"][0] if tolerance is None else tolerance
        chosen = NUMBERS["weights"] if weights is None else weights
        return self._answer(function, (s, measured, given, chosen), options)

    @staticmethod
    def _count(measured: ArrayLike) -> int:
        """How many encoders there are."""
        shape = np.shape(measured)
        return shape[-1] if shape else 1

    # -- how a call is made ---------------------------------------------------------------------------------

    def call(self, function: str, *inputs: ArrayLike, **options: Unpack[Options]) -> Any:
        """Any function by name, with its inputs in the order of `signature(function)`."""
        if function not in self.functions:
            raise self._unknown(function)
        return self._answer(function, inputs, options)

    def _unknown(self, function: str) -> AttributeError:
        return AttributeError(
            f"{self.identifier} has no function {function!r}; it has {', '.join(self.functions)}"
        )

    @cached_property
    def _backend(self) -> Backend:
        return make_backend(self._module, self.geometry, self._backend_name)

    def _answer(self, function: str, inputs: Sequence[Any], options: Options) -> Any:
        signature = self.signature(function)
        arrays = self._arrays(signature, inputs)
        if options.get("check_rotation", True):
            self._check_rotation(signature, arrays)
        outs = self._places(signature, options.get("out"))
        *results, status = self._backend.call(function, arrays, outs)
        if options.get("check", False):
            self._raise_first(signature, arrays, np.asarray(status))
        answer = results[0] if len(results) == 1 else self._tuple(function)(*results)
        return (answer, status) if options.get("status", False) else answer

    def _places(self, signature: Signature, out: Any) -> tuple[Any, ...] | None:
        """Where the results go: an array for each, or None."""
        names = [port.name for port in signature.outputs]
        if out is None or len(names) == 1:
            return None if out is None else (out,)
        if not isinstance(out, (tuple, list)) or len(out) != len(names):
            raise ValueError(
                f"{self.identifier}.{signature.name} gives {', '.join(names)}: out takes a tuple of "
                f"{len(names)} arrays (or None in a place)"
            )
        return tuple(out)

    def _tuple(self, function: str) -> Any:
        return getattr(self._module, "".join(word.capitalize() for word in function.split("_")))

    def _arrays(self, signature: Signature, inputs: Sequence[Any]) -> list[np.ndarray[Any, Any]]:
        """The arguments as arrays, with shapes that fit."""
        where = f"{self.identifier}.{signature.name}"
        if len(inputs) != len(signature.inputs):
            names = ", ".join(port.name for port in signature.inputs)
            raise TypeError(f"{where} takes {len(signature.inputs)} arrays ({names}), got {len(inputs)}")
        arrays, batches = [], []
        for port, value in zip(signature.inputs, inputs, strict=True):
            try:
                array = np.asarray(value, dtype=float)
            except (TypeError, ValueError) as error:
                raise type(error)(f"{where}: {port.name!r} is no array of numbers: {error}") from None
            core = len(port.shape)
            if array.ndim < core or array.shape[array.ndim - core :] != port.shape:
                raise ValueError(
                    f"{where}: {port.name!r} has shape {array.shape}, expected {_shape_text(port)}: "
                    f"{port.doc}"
                )
            arrays.append(array)
            batches.append(array.shape[: array.ndim - core])
        try:
            np.broadcast_shapes(*batches)
        except ValueError:
            given = ", ".join(
                f"{port.name} {batch}" for port, batch in zip(signature.inputs, batches, strict=True)
            )
            raise ValueError(f"{where}: batch dimensions do not broadcast: {given}") from None
        return arrays

    def _check_rotation(self, signature: Signature, arrays: Sequence[Any]) -> None:
        for port, array in zip(signature.inputs, arrays, strict=True):
            if port.name != "Q" or array.size == 0:
                continue
            error = np.asarray(self._backend.call("rotation_error", (array,), None)[0])
            # NaN passes here and gets the status INVALID_INPUT
            bad = error > ROTATION_TOLERANCE
            if bad.any():
                index = _first(bad)
                Q = array[index]
                raise InvalidInput(
                    f"{self.identifier}.{signature.name}: Q{_at(index)} is not a rotation matrix: "
                    f"|Q^T Q - I| is {np.abs(Q.T @ Q - np.eye(3)).max():.3g} (tolerance "
                    f"{ROTATION_TOLERANCE:g}), det Q is {np.linalg.det(Q):.3g}; make it orthonormal, or pass "
                    "check_rotation=False",
                    index,
                )

    def _raise_first(self, signature: Signature, arrays: Sequence[Any], status: Any) -> None:
        if not np.any(status):
            return
        index = _first(status != 0)
        code = Status(int(status[index]))
        where = f"{self.identifier}.{signature.name}{_at(index)}"
        if code is Status.INVALID_INPUT:
            raise InvalidInput(f"{where}: an input is NaN or infinite", index)
        if code in (Status.UNREACHABLE_LEG_1, Status.UNREACHABLE_LEG_2, Status.UNREACHABLE_LEG_3):
            leg, distance = int(code), self._distance(signature, arrays, status, index, int(code))
            by = "" if np.isnan(distance) else f"; it is {distance:.6g} out of reach"
            raise Unreachable(
                f"{where}: leg {leg} cannot reach its end point{by}. Change the pose, the redundant "
                "coordinate of that leg, or the working mode",
                leg,
                distance,
                index,
            )
        if code is Status.NO_CONVERGENCE:
            raise NoConvergence(
                f"{where}: Newton's iteration did not converge; start nearer to the solution (near=...)",
                index,
            )
        if code is Status.NO_ASSEMBLY:
            raise Unassembled(
                f"{where}: no platform of this geometry fits the three end points; check the joints and the "
                "assembly modes of the sub-legs",
                index,
            )
        if code is Status.AMBIGUOUS:
            raise Ambiguous(
                f"{where}: several solutions cannot be told apart; give a smaller box=..., or look at all of "
                "them with forward_all",
                index,
            )
        if code is Status.INCONSISTENT:
            raise Inconsistent(
                f"{where}: the measured redundant coordinates contradict the end points by more than the "
                "tolerance; check the encoders' zeros and the assembly modes, or raise tolerance=...",
                index,
            )
        raise Singular(f"{where}: singular configuration, {_MEANING[code]}", int(code), index)

    def _distance(
        self, signature: Signature, arrays: Sequence[Any], status: Any, index: tuple[int, ...], leg: int
    ) -> float:
        """By how much a leg misses its end point, where the function's inputs tell."""
        names = [port.name for port in signature.inputs]
        if "redundant" not in names:
            return float("nan")
        picked = []
        for port, array in zip(signature.inputs, arrays, strict=True):
            full = np.broadcast_to(array, (*np.shape(status), *port.shape))
            picked.append(full[index])
        by_name = dict(zip(names, picked, strict=True))
        if "inverse_status" not in self.functions:
            return float("nan")
        signs = [by_name["mode"]] if "mode" in by_name else self._mode_input("inverse_status", None)
        swivels = self._swivels("inverse_status", by_name.get("swivel"))
        inputs = (picked[0], picked[1], by_name["redundant"], *signs, *swivels)
        excess, _ = self._backend.call("inverse_status", inputs, None)
        return float(np.asarray(excess)[leg - 1])

    def _signs(
        self, branch: Branch | None, table: Mapping[str, Sequence[int]], default: str, what: str
    ) -> np.ndarray[Any, Any]:
        """Signs (..., 3, k) of a branch given as a label, three labels, or signs."""
        labels = [default] * 3 if branch is None else [branch] * 3 if isinstance(branch, str) else branch
        if isinstance(labels, (list, tuple)) and all(isinstance(label, str) for label in labels):
            unknown = [label for label in labels if label not in table]
            if unknown or len(labels) != 3:
                raise UnknownBranch(
                    f"{self.identifier}: {branch!r} is not {what}; give one of {', '.join(table)}, or one "
                    "for each of the three legs"
                )
            return np.array([table[str(label)] for label in labels], dtype=float)
        signs = np.asarray(branch, dtype=float)
        others = np.unique(signs[~np.isin(signs, (-1.0, 1.0))])
        if others.size:
            got = ", ".join(f"{value:g}" for value in others[:3])
            raise UnknownBranch(f"{self.identifier}: the signs of {what} are +1 or -1, got {got}")
        return signs

    def _takes(self, function: str, argument: str) -> bool:
        return any(port.name == argument for port in self.signature(function).inputs)

    def _assembly_choice(
        self, function: str, assembly: Branch | None, near: ArrayLike | None
    ) -> tuple[Any, ...]:
        """The argument that chooses the sub-legs' assembly modes, where they have several."""
        if self._takes(function, "s_near"):
            if near is None or assembly is not None:
                raise UnknownBranch(
                    f"{self.identifier}.{function}: the assembly mode of its sub-legs is chosen "
                    "by a point near "
                    "each end point: near=... of shape (..., 3, 3)"
                )
            return (near,)
        if near is not None:
            raise UnknownBranch(f"{self.identifier}.{function} takes no point near the end points")
        if self.assemblies or assembly is not None:
            return (self.assembly_signs(assembly),)
        return ()

    def _mode_input(self, function: str, mode: Branch | None) -> list[Any]:
        """The signs of a working mode, where the robot's sub-legs have more than one."""
        signs = self.mode_signs(mode)
        return [signs] if self._takes(function, "mode") else []

    def _swivels(self, function: str, given: ArrayLike | None, name: str = "swivel") -> list[Any]:
        """An argument that redundant sub-legs alone take; zero unless given."""
        if self._takes(function, name):
            return [self._per_leg(0.0 if given is None else given)]
        if given is not None:
            raise UnknownBranch(
                f"{self.identifier}.{function}: its sub-legs are not redundant and take no {name}"
            )
        return []

    @staticmethod
    def _per_leg(values: ArrayLike) -> Any:
        array = np.asarray(values, dtype=float)
        return np.broadcast_to(array, (3,)) if array.ndim == 0 else array


class CasadiFunctions:
    """A robot's kernels as casadi.Function, made on first use: `robot.casadi.inverse`."""

    def __init__(self, identifier: str, geometry: Geometry) -> None:
        try:
            self._module = import_module(f"krhpr.generated.casadi.{identifier}")
        except ModuleNotFoundError as error:
            if error.name != "casadi":
                raise
            raise ModuleNotFoundError(
                "CasADi is not installed: pip install 'krhpr[casadi]'", name="casadi"
            ) from None
        self._geometry = geometry
        self._made: dict[tuple[str, bool], Any] = {}

    @property
    def names(self) -> tuple[str, ...]:
        """The functions that exist in CasADi: kernels, not procedures."""
        return tuple(self._module.FUNCTIONS)

    def symbolic(self, name: str) -> Any:
        """A function with the geometry as its last input, a flat vector in the order of `Geometry.flat()`."""
        import casadi

        if (name, True) not in self._made:
            symbol = casadi.SX.sym("geometry", 3 * len(self._module.FIELDS))
            self._made[name, True] = self._builder(name)(symbol)
        return self._made[name, True]

    def __getattr__(self, name: str) -> Any:
        if name.startswith("_"):
            raise AttributeError(name)
        if (name, False) not in self._made:
            self._made[name, False] = self._builder(name)(tuple(self._geometry.flat()))
        return self._made[name, False]

    def __dir__(self) -> list[str]:
        return [*super().__dir__(), *self.names]

    def _builder(self, name: str) -> Any:
        try:
            return self._module.FUNCTIONS[name]
        except KeyError:
            raise AttributeError(f"no CasADi function {name!r}; there are {', '.join(self.names)}") from None


_MEANING = {
    Status.SINGULAR_LEG_1: "a factor of det M_1 vanishes",
    Status.SINGULAR_LEG_2: "a factor of det M_2 vanishes",
    Status.SINGULAR_LEG_3: "a factor of det M_3 vanishes",
    Status.SINGULAR_IN_PLANE: (
        "det J_a = 0: the lines in the platform's plane meet in a point or are parallel"
    ),
    Status.SINGULAR_NORMAL: "det J_n = 0: the three end points are collinear",
    Status.AMBIGUOUS: "several answers cannot be told apart",
}


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


def _shape_text(port: Port) -> str:
    return "(" + ", ".join(["...", *map(str, port.shape)]) + ")"


def _first(bad: np.ndarray[Any, Any]) -> tuple[int, ...]:
    """The index of the first element that is true."""
    return tuple(int(i) for i in np.unravel_index(np.argmax(bad), np.shape(bad)))


def _at(index: Sequence[Any]) -> str:
    return f"[{', '.join(str(int(i)) for i in index)}]" if len(index) else ""
