"""What every robot has: its description, and how its functions are called and their answers returned."""

from __future__ import annotations

from collections import namedtuple
from collections.abc import Mapping, Sequence
from functools import cached_property, partial
from types import ModuleType
from typing import Any, ClassVar, NamedTuple, TypedDict, Unpack

import numpy as np
from numpy.typing import ArrayLike

from krhpr.backend import Backend, BackendName, make_backend
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
    UnknownBranch,
    Unreachable,
)
from krhpr.generated.python.runtime import LEGS, Geometry, Port, Signature, Status
from krhpr.limits import Limits
from krhpr.native import Bound
from krhpr.threads import in_threads

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


class Calls:
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
    def legs(self) -> int:
        """How many legs it has: three, or the two sub-legs of a grasping robot."""
        return int(getattr(self._module, "LEGS", LEGS))

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
    def link_pairs(self) -> tuple[tuple[int, int, int, int], ...]:
        """The ends of every two links that no joint joins, in the order of `clearances`: points by number,
        those of `link_points` leg by leg, then where redundant links meet the platform; empty for planar
        robots.
        """
        return getattr(self._module, "LINK_PAIRS", ())

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

    @property
    def angular(self) -> tuple[bool, ...]:
        """Whether each actuator of a leg turns; the others slide."""
        return tuple(self._module.ANGULAR)

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

    @property
    def backend(self) -> BackendName:
        """Whether calls run on compiled kernels or on NumPy."""
        return self._backend.name

    @cached_property
    def casadi(self) -> CasadiFunctions:
        """The kernels as casadi.Function, with this geometry: `robot.casadi.twist`."""
        return CasadiFunctions(self.identifier, self.geometry)

    def __repr__(self) -> str:
        own = "" if self.name == self.identifier else f"{self.name}, "
        return f"<Robot {own}{self.identifier} {self.notation}: {self.title}>"

    # -- how a call is made ---------------------------------------------------------------------------------

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

    def _signs(
        self, branch: Branch | None, table: Mapping[str, Sequence[int]], default: str, what: str
    ) -> np.ndarray[Any, Any]:
        """Signs (..., legs, k) of a branch given as a label, a label for each leg, or signs."""
        one = default if branch is None else branch
        labels = [one] * self.legs if isinstance(one, str) else one
        if isinstance(labels, (list, tuple)) and all(isinstance(label, str) for label in labels):
            unknown = [label for label in labels if label not in table]
            if unknown or len(labels) != self.legs:
                raise UnknownBranch(
                    f"{self.identifier}: {branch!r} is not {what}; give one of {', '.join(table)}, or one "
                    f"for each of the {('two', 'three')[self.legs - 2]} legs"
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

    def _per_leg(self, values: ArrayLike) -> Any:
        array = np.asarray(values, dtype=float)
        return np.broadcast_to(array, (self.legs,)) if array.ndim == 0 else array


def _shape_text(port: Port) -> str:
    return "(" + ", ".join(["...", *map(str, port.shape)]) + ")"


def _first(bad: np.ndarray[Any, Any]) -> tuple[int, ...]:
    """The index of the first element that is true."""
    return tuple(int(i) for i in np.unravel_index(np.argmax(bad), np.shape(bad)))


def _at(index: Sequence[Any]) -> str:
    return f"[{', '.join(str(int(i)) for i in index)}]" if len(index) else ""
