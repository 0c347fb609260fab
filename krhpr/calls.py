"""How the functions of a robot are called, and their answers returned."""

from __future__ import annotations

from collections import namedtuple
from collections.abc import Mapping, Sequence
from functools import cached_property, partial
from types import ModuleType
from typing import Any, ClassVar, TypedDict, Unpack

import numpy as np
from numpy.typing import ArrayLike

from krhpr.backend import Backend, BackendName, make_backend
from krhpr.branches import Branches
from krhpr.casadi_functions import CasadiFunctions
from krhpr.defaults import NUMBERS, SIGNS
from krhpr.errors import (
    Ambiguous,
    InBatch,
    Inconsistent,
    InvalidInput,
    NoConvergence,
    NoGrasp,
    Singular,
    Unassembled,
    Unreachable,
)
from krhpr.generated.python.runtime import Geometry, Port, Signature, Status
from krhpr.limits import Limits
from krhpr.native import Bound
from krhpr.threads import in_threads

ROTATION_TOLERANCE = 1e-6
"""Largest element of |Q^T Q - I| that passes for a rotation matrix."""


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
    threads: int
    """How many threads share a large batch (1 unless given)."""


WITHOUT_ANSWER: Mapping[Status, tuple[type[InBatch], str]] = {
    Status.INVALID_INPUT: (InvalidInput, "an input is NaN or infinite"),
    Status.NO_CONVERGENCE: (
        NoConvergence,
        "Newton's iteration did not converge; start nearer to the solution (near=...)",
    ),
    Status.NO_ASSEMBLY: (
        Unassembled,
        "no platform of this geometry fits the three end points; check the joints and the assembly modes of "
        "the sub-legs",
    ),
    Status.AMBIGUOUS: (
        Ambiguous,
        "several solutions cannot be told apart; give a smaller box=..., or look at all of them with "
        "forward_all",
    ),
    Status.NO_GRASP: (
        NoGrasp,
        "the jaws hold nothing: the directions of the slides must positively span the plane "
        "(platform_azimuth), and normal forces must not be negative",
    ),
    Status.SLIPS: (NoGrasp, "the object slips at a contact; press harder, or look at friction_margins"),
    Status.UNDETERMINED: (
        NoGrasp,
        "the measured forces do not determine the others; the lines through the contacts along the jaws' "
        "faces must not meet in a point, nor the contacts be in line",
    ),
    Status.INCONSISTENT: (
        Inconsistent,
        "the measured redundant coordinates contradict the end points by more than the tolerance; check the "
        "encoders' zeros and the assembly modes, or raise tolerance=...",
    ),
}
"""The error of each status that is neither a leg out of reach nor a singularity, and what to do."""

MEANINGS = {
    Status.SINGULAR_LEG_1: "a factor of det M_1 vanishes",
    Status.SINGULAR_LEG_2: "a factor of det M_2 vanishes",
    Status.SINGULAR_LEG_3: "a factor of det M_3 vanishes",
    Status.SINGULAR_IN_PLANE: (
        "det J_a = 0: the lines in the platform's plane meet in a point or are parallel"
    ),
    Status.SINGULAR_NORMAL: "det J_n = 0: the three end points are collinear",
}


class Calls(Branches):
    """A generated module with a geometry and a backend, and its functions by name."""

    _advice: ClassVar[Mapping[Status, tuple[type[InBatch], str]]] = WITHOUT_ANSWER
    _meanings: ClassVar[Mapping[Status, str]] = MEANINGS

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
        super().__init__(module, geometry, name=name, limits=limits, home=home)
        self._backend_name = backend

    @property
    def backend(self) -> BackendName:
        """Whether calls run on compiled kernels or on NumPy."""
        return self._backend.name

    @cached_property
    def casadi(self) -> CasadiFunctions:
        """The kernels as casadi.Function, with this geometry: `robot.casadi.twist`."""
        return CasadiFunctions(self.identifier, self.geometry)

    def call(self, function: str, *inputs: ArrayLike, **options: Unpack[Options]) -> Any:
        """Any function by name, with its inputs in the order of `signature(function)`."""
        if function not in self.functions:
            raise self._unknown(function)
        return self._answer(function, inputs, options)

    def bind(self, function: str) -> Bound:
        """A function of one pose on arrays of its own, for control loops: nothing is checked or allocated.

            inverse = robot.bind("inverse")
            inverse.inputs.p[:] = 0.0, 0.0, 0.35
            ...
            status = inverse()  # 0, or a Status
            inverse.outputs.theta

        `inputs` and `outputs` are named tuples of arrays in the order of `signature(function)`, numbers as
        arrays without dimensions.  Those that have defaults (modes, sides, boxes, tolerances) begin with
        them, the others as NaN.  Threads that share one must take turns.
        """
        signature = self.signature(function)
        inputs = [np.full(port.shape, np.nan) for port in signature.inputs]
        for port, array in zip(signature.inputs, inputs, strict=True):
            array[...] = self._default_of(port.name)
        outputs = [np.full(port.shape, np.nan) for port in signature.outputs]
        name = "".join(word.capitalize() for word in function.split("_"))
        named = (
            namedtuple(f"{name}Inputs", [port.name for port in signature.inputs])(*inputs),
            namedtuple(f"{name}Outputs", [port.name for port in signature.outputs])(*outputs),
        )
        return self._backend.bind(function, *named)

    def _default_of(self, name: str) -> Any:
        """What an input begins with where it is bound."""
        if name == "mode":
            return self.mode_signs()
        if name == "assembly":
            return self.assembly_signs()
        if name == "box":
            return self._module.DEFAULT_BOX
        if name in NUMBERS:
            numbers = NUMBERS[name]
            return numbers if len(numbers) > 1 else numbers[0]
        return 1.0 if name in SIGNS else 0.0 if name == "swivel" else np.nan

    @cached_property
    def _backend(self) -> Backend:
        return make_backend(self._module, self.geometry, self._backend_name)

    def _answer(self, function: str, inputs: Sequence[Any], options: Options) -> Any:
        signature = self.signature(function)
        arrays = self._arrays(signature, inputs)
        if options.get("check_rotation", True):
            self._check_rotation(signature, arrays)
        outs = self._places(signature, options.get("out"))
        call = partial(self._backend.call, function)
        *results, status = in_threads(call, signature, arrays, outs, options.get("threads", 1))
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
        if code in self._advice:
            error, advice = self._advice[code]
            raise error(f"{where}: {advice}", index)
        raise Singular(f"{where}: singular configuration, {self._meanings[code]}", int(code), index)

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


def _shape_text(port: Port) -> str:
    return "(" + ", ".join(["...", *map(str, port.shape)]) + ")"


def _first(bad: np.ndarray[Any, Any]) -> tuple[int, ...]:
    """The index of the first element that is true."""
    return tuple(int(i) for i in np.unravel_index(np.argmax(bad), np.shape(bad)))


def _at(index: Sequence[Any]) -> str:
    return f"[{', '.join(str(int(i)) for i in index)}]" if len(index) else ""
