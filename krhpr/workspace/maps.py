"""Maps of the workspace: boundaries along rays and whole grids, as jobs of independent chunks."""

from __future__ import annotations

import hashlib
import json
from abc import ABC, abstractmethod
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from math import ceil, prod
from typing import Any

import numpy as np
from numpy.typing import NDArray

from krhpr.branches import Branch
from krhpr.errors import WorkspaceError
from krhpr.robot import Robot
from krhpr.workspace.axes import Axis, Family
from krhpr.workspace.choices import (
    Answer,
    Redundancy,
    Variant,
    choose,
    indices,
    over_orientations,
)
from krhpr.workspace.limits import Stop, WorkspaceLimits
from krhpr.workspace.margins import Examiner
from krhpr.workspace.trace import BATCH, Tracing, trace

Floats = NDArray[np.float64]
Arrays = dict[str, NDArray[Any]]

CHUNK = 1 << 16
"""About how many nodes make a chunk, unless told."""
FORMAT = 1
"""Of settings and stores; another number is another meaning."""


@dataclass(frozen=True)
class Variable:
    """What a map has at each of its places."""

    name: str
    dtype: str
    unit: str
    doc: str
    extra: tuple[str, ...] = ()
    """Dimensions behind those of the map."""

    @property
    def shape(self) -> tuple[int, ...]:
        """Of the extra dimensions."""
        return (3,) * len(self.extra)


_STOPS = Variable("stops", "int8", "1", "what stops the pose, or the next one on the ray; 0: nothing")
_WHICH = Variable("which", "int16", "1", "which leg, joint or pair of bodies stops it")
_REDUNDANT = Variable("redundant", "float64", "rad or m", "redundant coordinates that were chosen", ("leg",))
_INDICES = Variable("eta", "float64", "m, 1, 1", "eta_1, eta_2, eta_3", ("index",))


@dataclass(frozen=True)
class Job(ABC):
    """A map to be made: of which robot, within which limits, over which coordinates.

    Chunks lie along the first axis and can be made in any order, anywhere.
    """

    robot: Robot
    limits: WorkspaceLimits
    redundancy: Redundancy
    family: Family
    axes: tuple[Axis, ...]
    mode: Branch | None = None
    with_indices: bool = False
    """Whether the performance indices are computed, at the boundary or at every free node."""
    chunk: int = CHUNK
    """About how many nodes make a chunk."""

    @cached_property
    def examiner(self) -> Examiner:
        """What says of poses whether they belong to the workspace."""
        return Examiner(self.robot, self.limits, mode=self.mode)

    @property
    @abstractmethod
    def kept(self) -> tuple[Axis, ...]:
        """The axes that the map has as dimensions."""

    @property
    @abstractmethod
    def variables(self) -> tuple[Variable, ...]:
        """What the map has at each place."""

    @abstractmethod
    def make(self, number: int) -> Arrays:
        """One chunk, a function of the job alone."""

    @property
    @abstractmethod
    def nodes(self) -> int:
        """The most nodes that have to be looked at."""

    @property
    def shape(self) -> tuple[int, ...]:
        """Of the map."""
        return tuple(map(len, self.kept))

    @property
    def rows(self) -> int:
        """How many values of the first axis make a chunk."""
        inner = max(1, self.nodes // max(1, len(self.axes[0])))
        return min(len(self.axes[0]), max(1, self.chunk // inner))

    @property
    def chunks(self) -> int:
        """How many there are."""
        return ceil(len(self.axes[0]) / self.rows)

    def part(self, number: int) -> slice:
        """Where a chunk lies on the first axis."""
        return slice(self.rows * number, min(self.rows * (number + 1), len(self.axes[0])))

    @property
    def size(self) -> int:
        """Bytes of the whole map."""
        places = prod(self.shape)
        return sum(places * prod(v.shape) * np.dtype(v.dtype).itemsize for v in self.variables)

    def empty(self) -> Arrays:
        """Room for the map."""
        return {v.name: np.zeros(self.shape + v.shape, dtype=v.dtype) for v in self.variables}

    def settings(self) -> dict[str, Any]:
        """Everything that its results depend on, as plain values."""
        import krhpr

        robot = self.robot
        mode = self.mode if isinstance(self.mode, str | None) else np.asarray(self.mode).tolist()
        return {
            "format": FORMAT,
            "version": krhpr.__version__,
            "robot": robot.name,
            "identifier": robot.identifier,
            "geometry": {name: list(map(float, v)) for name, v in robot.geometry.fields.items()},
            "robot_limits": repr(robot.limits) if robot.limits else "",
            "limits": self.limits.settings(),
            "mode": mode or robot.default_mode,
            "kind": type(self).__name__,
            "indices": self.with_indices,
            "chunk": self.chunk,
            **self.redundancy.settings(),
            **self.family.settings(),
            "axes": [axis.settings() for axis in self.axes],
        }

    @property
    def fingerprint(self) -> str:
        """Of the settings."""
        return hashlib.sha256(json.dumps(self.settings(), sort_keys=True).encode()).hexdigest()[:16]

    def check(self) -> None:
        """Whether it can be made.

        Raises:
            WorkspaceError: why not.
        """
        expected = self.family.names
        given = tuple(axis.name for axis in self.axes)
        if given != expected:
            raise WorkspaceError(f"the axes are {', '.join(given)}; expected {', '.join(expected)}")
        self._demand_home()

    def _demand_home(self) -> None:
        """Bodies that are too near to one another at home are a mistake in the bodies."""
        p, Q = np.array([self.robot.home.p]), np.eye(3)[None]
        found = choose(self.examiner, self.redundancy, p, Q)
        if found.stops[0] != Stop.BODIES:
            return
        redundant = np.array(self.redundancy.candidates[:1])
        short = -float(self.examiner.examine(p, Q, redundant).values[Stop.BODIES][0])
        raise WorkspaceError(
            f"{self.robot.name}: {self.examiner.name(Stop.BODIES, int(found.which[0]))} already at home "
            f"(p = {p[0].tolist()}, redundant = {redundant[0].round(4).tolist()}): {short:.4g} m too near; "
            "make radii or the clearance smaller, or choose another working mode or other redundant "
            "coordinates"
        )

    def _indices(self, free: NDArray[np.bool_], p: Floats, Q: Floats, redundant: Floats) -> Floats:
        """At the free ones of n poses, NaN elsewhere."""
        found = np.full((len(free), 3), np.nan)
        found[free] = indices(self.examiner, p[free], Q[free], redundant[free])
        return found


@dataclass(frozen=True)
class BoundaryMap(Job):
    """How far each ray goes, along the last coordinate from its first value on, until a limit stops it.

    The first node beyond is not free: the boundary lies between it and the last free one, which is given.
    """

    tracing: Tracing = Tracing.BISECT
    coarse: int = 16
    """Steps between nodes that are looked at first, where it is bisected: none is skipped between two of them
    where margins could have gone to zero and back."""

    @property
    def kept(self) -> tuple[Axis, ...]:
        return self.axes[:-1]

    @property
    def nodes(self) -> int:
        return prod(map(len, self.axes))

    @property
    def variables(self) -> tuple[Variable, ...]:
        last = self.axes[-1]
        return (
            Variable("boundary", "float64", last.unit, f"{last.doc} of the last free node; NaN: none"),
            _STOPS,
            _WHICH,
            _REDUNDANT,
            *((_INDICES,) if self.with_indices else ()),
        )

    def settings(self) -> dict[str, Any]:
        return {**super().settings(), "tracing": str(self.tracing), "coarse": self.coarse}

    def make(self, number: int) -> Arrays:
        part = self.part(number)
        first, second, radial = (axis.values for axis in self.axes)
        shape = (len(first[part]), len(second))
        a, b = (x.ravel() for x in np.meshgrid(first[part], second, indexing="ij"))

        def look(rays: NDArray[np.intp], at: NDArray[np.intp]) -> Answer:
            p, Q = self.family.poses(a[rays], b[rays], radial[at])
            return choose(self.examiner, self.redundancy, p, Q, self.family.slopes)

        found = trace(look, len(a), radial, self.tracing, self.coarse)
        some = found.steps >= 0
        made: Arrays = {
            "boundary": np.where(some, radial[found.steps], np.nan),
            "stops": found.stops,
            "which": found.which,
            "redundant": found.redundant,
        }
        if self.with_indices:
            p, Q = self.family.poses(a, b, radial[np.maximum(found.steps, 0)])
            made["eta"] = self._indices(some, p, Q, found.redundant)
        return {name: array.reshape(shape + array.shape[1:]) for name, array in made.items()}


@dataclass(frozen=True)
class GridMap(Job):
    """What stops every node of a grid, if anything.

    With `orientations` (m, 3, 3) each node is a position, which allows one of them (reachable) or all
    (dexterous).
    """

    orientations: tuple[tuple[tuple[float, ...], ...], ...] = ()
    variant: Variant = Variant.REACHABLE

    @property
    def kept(self) -> tuple[Axis, ...]:
        return self.axes

    @property
    def nodes(self) -> int:
        return prod(map(len, self.axes))

    @property
    def variables(self) -> tuple[Variable, ...]:
        chosen = (_REDUNDANT,) if len(self.redundancy.candidates) > 1 else ()
        return (_STOPS, _WHICH, *chosen, *((_INDICES,) if self.with_indices else ()))

    def settings(self) -> dict[str, Any]:
        turned = np.array(self.orientations).tolist()
        return {**super().settings(), "orientations": turned, "variant": str(self.variant)}

    def check(self) -> None:
        super().check()
        if self.orientations and self.with_indices:
            raise WorkspaceError(
                "indices are those of one orientation; leave out `orientations` or `indices`"
            )

    def make(self, number: int) -> Arrays:
        part = self.part(number)
        shape = (len(self.axes[0].values[part]), *map(len, self.axes[1:]))
        made: Arrays = {v.name: np.zeros((prod(shape), *v.shape), dtype=v.dtype) for v in self.variables}
        for where, coordinates in self._batches(part, shape):
            p, Q = self.family.poses(*coordinates)
            answer = self._answer(p, Q)
            made["stops"][where], made["which"][where] = answer.stops, answer.which
            if "redundant" in made:
                made["redundant"][where] = answer.redundant
            if self.with_indices:
                made["eta"][where] = self._indices(answer.stops == Stop.NONE, p, Q, answer.redundant)
        return {name: array.reshape(shape + array.shape[1:]) for name, array in made.items()}

    def _answer(self, p: Floats, Q: Floats) -> Answer:
        if not self.orientations:
            return choose(self.examiner, self.redundancy, p, Q)
        turned = np.array(self.orientations)
        return over_orientations(self.examiner, self.redundancy, p, turned, self.variant)

    def _batches(self, part: slice, shape: tuple[int, ...]) -> Iterator[tuple[slice, list[Floats]]]:
        """The nodes of a chunk, a batch at a time."""
        values = [self.axes[0].values[part], *(axis.values for axis in self.axes[1:])]
        for first in range(0, prod(shape), BATCH):
            where = slice(first, min(first + BATCH, prod(shape)))
            places = np.unravel_index(np.arange(where.start, where.stop), shape)
            yield where, [value[place] for value, place in zip(values, places, strict=True)]


@dataclass(frozen=True)
class Workspace:
    """A map that has been made."""

    job: Job
    arrays: Mapping[str, NDArray[Any]]

    def __getitem__(self, name: str) -> NDArray[Any]:
        return self.arrays[name]

    @property
    def free(self) -> NDArray[np.bool_]:
        """Of a grid: which nodes belong to the workspace; of a boundary: which rays have any."""
        if isinstance(self.job, GridMap):
            return np.asarray(self.arrays["stops"] == Stop.NONE)
        return np.asarray(~np.isnan(self.arrays["boundary"]))

    def axis(self, name: str) -> Floats:
        """The values of a coordinate."""
        return next(axis.values for axis in self.job.axes if axis.name == name)

    def stopped_by(self) -> dict[str, float]:
        """The share of nodes, or of rays, that each kind of limit stops; the largest first."""
        stops, count = np.unique(self.arrays["stops"], return_counts=True)
        shares = {
            Stop(int(s)).words: float(n) / self.arrays["stops"].size
            for s, n in zip(stops, count, strict=True)
        }
        shares.pop(Stop.NONE.words, None)
        return dict(sorted(shares.items(), key=lambda item: -item[1]))

    def demand(self) -> Workspace:
        """The map itself, if anything in it is free.

        Raises:
            WorkspaceError: it is empty; it says which limits stop it, and one of them where.
        """
        if self.free.any():
            return self
        shares = ", ".join(f"{name} {share:.0%}" for name, share in self.stopped_by().items())
        place = tuple(0 for _ in self.arrays["stops"].shape)
        what = self.job.examiner.name(int(self.arrays["stops"][place]), int(self.arrays["which"][place]))
        at = ", ".join(f"{axis.name} = {axis.values[0]:g} {axis.unit}" for axis in self.job.axes)
        raise WorkspaceError(
            f"{self.job.robot.name}: the workspace is empty; limits that stop its nodes: {shares}; the "
            f"first, at {at}: {what}"
        )

    def dataset(self) -> Any:
        """As an xarray.Dataset with named dimensions, units, and the settings as attributes."""
        from krhpr.workspace.store import as_dataset

        return as_dataset(self)
