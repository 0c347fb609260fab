"""Stores: maps in zarr through xarray, chunk by chunk, so that an interrupted run goes on where it was."""

from __future__ import annotations

import json
import shutil
from collections.abc import Iterable, Iterator, Mapping
from math import prod
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from krhpr.errors import WorkspaceError
from krhpr.workspace.maps import Arrays, Job, Workspace

SETTINGS = "krhpr_settings"
"""The attribute with the settings, as JSON."""
DONE = "done"
"""The variable that says which chunks are there."""
SPARE = 0.05
"""Of the disk, which a store must leave free."""


def _modules() -> tuple[Any, Any]:
    try:
        import xarray
        import zarr
    except ImportError as missing:
        raise WorkspaceError(
            f"stores of workspaces need {missing.name}: pip install 'krhpr[workspace]'"
        ) from missing
    return xarray, zarr


def as_dataset(made: Workspace) -> Any:
    """A map as an xarray.Dataset."""
    xarray, _ = _modules()
    job = made.job
    dims = tuple(axis.name for axis in job.kept)
    return xarray.Dataset(
        {
            v.name: (dims + v.extra, made.arrays[v.name], {"units": v.unit, "long_name": v.doc})
            for v in job.variables
        },
        coords={
            axis.name: (axis.name, axis.values, {"units": axis.unit, "long_name": axis.doc})
            for axis in job.kept
        },
        attrs=_attributes(job),
    )


def _attributes(job: Job) -> dict[str, Any]:
    settings = job.settings()
    return {
        "title": f"Workspace of {job.robot.name}",
        "robot": settings["robot"],
        "version": settings["version"],
        "fingerprint": job.fingerprint,
        SETTINGS: json.dumps(settings, sort_keys=True),
    }


class _Stored(Mapping[str, NDArray[Any]]):
    """Variables of a store by name."""

    def __init__(self, root: Any, names: list[str]) -> None:
        self._root, self._names = root, names

    def __getitem__(self, name: str) -> NDArray[Any]:
        if name not in self._names:
            raise KeyError(name)
        return np.asarray(self._root[name][:])

    def __iter__(self) -> Iterator[str]:
        return iter(self._names)

    def __len__(self) -> int:
        return len(self._names)


class Store:
    """A map on disk.  One process writes; what is marked as done is whole."""

    def __init__(self, path: Path, job: Job) -> None:
        """Open the store of a job, or make it.

        Raises:
            WorkspaceError: the disk is too small, or there is a store of something else.
        """
        self.path, self.job = Path(path), job
        _, zarr = _modules()
        if self.path.exists() and any(self.path.iterdir() if self.path.is_dir() else [self.path]):
            self._root = self._opened(zarr)
        else:
            self._demand_room()
            self._root = self._made(zarr)

    def done(self) -> set[int]:
        """The chunks that are there."""
        return set(np.flatnonzero(self._root[DONE][:]).tolist())

    def put(self, number: int, arrays: Arrays) -> None:
        """Write a chunk, and then mark it."""
        part = self.job.part(number)
        for name, array in arrays.items():
            self._root[name][part] = array
        self._root[DONE][number] = 1

    def workspace(self) -> Workspace:
        """The map, of which each variable is read when it is asked for."""
        return Workspace(self.job, _Stored(self._root, [v.name for v in self.job.variables]))

    def _opened(self, zarr: Any) -> Any:
        try:
            root = zarr.open_group(self.path, mode="r+")
            before = json.loads(root.attrs[SETTINGS])
        except Exception as problem:
            raise WorkspaceError(
                f"{self.path}: no store of a workspace ({type(problem).__name__}); give a path "
                "where nothing is"
            ) from problem
        now = json.loads(json.dumps(self.job.settings(), sort_keys=True))
        if before != now:
            raise WorkspaceError(f"{self.path}: the store is of something else: {_difference(before, now)}")
        return root

    def _demand_room(self) -> None:
        folder = next(
            parent for parent in (self.path.absolute(), *self.path.absolute().parents) if parent.exists()
        )
        usage = shutil.disk_usage(folder)
        room = usage.free - SPARE * usage.total
        if self.job.size > room:
            raise WorkspaceError(
                f"{self.path}: the map has {prod(self.job.shape):,} places and takes up to "
                f"{self.job.size / 1e9:.1f} GB; the disk has room for {max(room, 0) / 1e9:.1f} GB: take "
                "larger steps, a smaller range, or another disk"
            )

    def _made(self, zarr: Any) -> Any:
        root = zarr.open_group(self.path, mode="w", attributes=_attributes(self.job))
        job = self.job
        for axis in job.kept:
            root.create_array(
                axis.name,
                data=axis.values,
                dimension_names=(axis.name,),
                attributes={"units": axis.unit, "long_name": axis.doc},
            )
        dims = tuple(axis.name for axis in job.kept)
        for v in job.variables:
            shape = job.shape + v.shape
            root.create_array(
                v.name,
                shape=shape,
                dtype=v.dtype,
                chunks=(job.rows, *shape[1:]),
                dimension_names=dims + v.extra,
                attributes={"units": v.unit, "long_name": v.doc},
            )
        root.create_array(
            DONE,
            shape=(job.chunks,),
            dtype="int8",
            chunks=(1,),
            dimension_names=("chunk",),
            attributes={"units": "1", "long_name": "1 where the chunk is there"},
        )
        return root


def _difference(before: dict[str, Any], now: dict[str, Any]) -> str:
    """The first settings that differ."""
    differ = [name for name in {**before, **now} if before.get(name) != now.get(name)]

    def text(value: Any) -> str:
        shown = json.dumps(value)
        return shown if len(shown) < 60 else f"{shown[:57]}..."

    told = [f"{name} {text(before.get(name))} there, {text(now.get(name))} here" for name in differ[:3]]
    rest = f", and {len(differ) - 3} more" if len(differ) > 3 else ""
    return f"{'; '.join(told)}{rest}.  Remove it, or give another path"


def open_store(path: Path) -> Any:
    """A store as an xarray.Dataset that is read when it is needed.

    Raises:
        WorkspaceError: there is none.
    """
    xarray, _ = _modules()
    try:
        found = xarray.open_zarr(path, consolidated=False)
    except Exception as problem:
        raise WorkspaceError(f"{path}: no store of a workspace ({type(problem).__name__})") from problem
    if SETTINGS not in found.attrs:
        raise WorkspaceError(f"{path}: no store of a workspace: the attribute {SETTINGS} is missing")
    return found


def missing(store: Store | None, job: Job) -> Iterable[int]:
    """The chunks that are still to be made."""
    there = store.done() if store is not None else set()
    return [number for number in range(job.chunks) if number not in there]
