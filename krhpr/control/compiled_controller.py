"""The generated controller in C, compiled and called step by step: what a robot's own computer would run."""

from __future__ import annotations

import ctypes
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from krhpr.backend import c_sources
from krhpr.control.controller import Wanted
from krhpr.control.parameters import ControlSetup, Scheme
from krhpr.control.plant import Branch
from krhpr.errors import ControlError
from krhpr.generated.python.runtime import Status
from krhpr.grasping import GraspingRobot
from krhpr.native import SPEED_FLAGS, compile_library
from krhpr.study.grasp import Setup, contacts

Floats = NDArray[np.float64]

_NUMBERS = ctypes.POINTER(ctypes.c_double)


class _Settings(ctypes.Structure):
    """krhpr_control_settings."""

    _fields_ = (
        ("scheme", ctypes.c_int),
        *(
            (name, ctypes.c_double)
            for name in (
                "period",
                "transmission",
                "torque_limit",
                "position_stiffness",
                "position_damping",
                "position_filter_time",
                "force_proportional",
                "force_integral",
                "force_derivative",
                "force_filter_time",
                "force_least",
                "force_most",
            )
        ),
        ("contacts", ctypes.c_double * 4),
        ("faces", ctypes.c_double * 2),
        ("mass_centre", ctypes.c_double * 2),
        ("weight", ctypes.c_double * 2),
        ("assembly", ctypes.c_double * 2),
        ("side", ctypes.c_double),
    )


class _State(ctypes.Structure):
    """krhpr_control_state."""

    _fields_ = (
        ("started", ctypes.c_int),
        ("error", ctypes.c_double * 4),
        ("error_rate", ctypes.c_double * 4),
        ("force", ctypes.c_double),
        ("integral", ctypes.c_double),
    )


_NUMBER_OF = {Scheme.POSITION: 1, Scheme.FEEDFORWARD: 2, Scheme.COMBINED: 3}
"""krhpr_control_scheme."""


class CompiledController:
    """The schemes in generated C; takes the place of `Controller`, and is equal to it but for rounding."""

    def __init__(
        self,
        robot: GraspingRobot,
        setup: Setup,
        control: ControlSetup,
        scheme: Scheme,
        branch: Branch,
        flags: Sequence[str] = SPEED_FLAGS,
    ) -> None:
        """Compile, or find what was compiled.

        Raises:
            NoCompiler: there is no C compiler.
        """
        library = ctypes.CDLL(str(_compiled(robot.identifier, flags)))
        prefix = f"krhpr_{robot.identifier}"
        self._geometry = ctypes.create_string_buffer(_size(library, prefix))
        fields = np.ascontiguousarray(robot.geometry.flat(), dtype=float)
        setter = getattr(library, f"{prefix}_set_geometry")
        if setter(self._geometry, fields.ctypes.data_as(_NUMBERS)) != Status.OK:
            raise ControlError(f"the C of {robot.identifier} does not take the geometry {robot.geometry}")
        self._settings = _settings(setup, control, Scheme(scheme), branch)
        self._step = getattr(library, f"{prefix}_control_step")
        self._step.argtypes = [
            ctypes.c_void_p,
            ctypes.c_void_p,
            ctypes.c_void_p,
            _NUMBERS,
            _NUMBERS,
            ctypes.c_double,
            _NUMBERS,
            ctypes.c_double,
            _NUMBERS,
        ]
        self.reset()

    def reset(self) -> None:
        """Forget all that was."""
        self._state = _State()

    def step(self, wanted: Wanted, theta: Floats, measured_force: float) -> Floats:
        """Torques (2, 2) of the motors.

        Raises:
            ControlError: no answer; nothing is kept of this step.
        """
        torques = np.empty((2, 2))
        arrays = [np.ascontiguousarray(array, dtype=float) for array in (wanted.pivot, wanted.angles, theta)]
        pivot, angles, joints, result = (array.ctypes.data_as(_NUMBERS) for array in (*arrays, torques))
        status = self._step(
            self._geometry,
            ctypes.byref(self._settings),
            ctypes.byref(self._state),
            pivot,
            angles,
            wanted.grasp_force,
            joints,
            measured_force,
            result,
        )
        if status != Status.OK:
            raise ControlError(
                f"the controller has no answer ({Status(status).name}) for pivot {wanted.pivot}, "
                f"angles {wanted.angles}, {wanted.grasp_force:g} N, joints {np.ravel(theta)}, "
                f"measured {measured_force:g} N"
            )
        return torques


def _compiled(identifier: str, flags: Sequence[str]) -> object:
    sources = [c_sources() / f"krhpr_{identifier}{ending}.c" for ending in ("", "_control")]
    return compile_library(f"krhpr_{identifier}_control", sources, include_dirs=[c_sources()], flags=flags)


def _size(library: ctypes.CDLL, prefix: str) -> int:
    function = getattr(library, f"{prefix}_geometry_size")
    function.restype = ctypes.c_size_t
    return int(function())


def _settings(setup: Setup, control: ControlSetup, scheme: Scheme, branch: Branch) -> _Settings:
    touch, faces, mass_centre = contacts(setup)
    position, force = control.position, control.force
    return _Settings(
        _NUMBER_OF[scheme],
        control.period,
        setup.drive.radius / setup.drive.ratio,
        control.motor.torque_limit,
        position.stiffness,
        position.damping,
        position.filter_time,
        force.proportional,
        force.integral,
        force.derivative,
        force.filter_time,
        force.least,
        force.most,
        tuple(touch.ravel()),
        tuple(faces),
        tuple(mass_centre),
        (0.0, -setup.held.weight),
        branch.assembly,
        branch.side,
    )
